#pragma once
// An order of places in which neighbours are near each other.

#include <algorithm>
#include <cstdint>

#include "implicit/geometry/vec.h"

namespace restroke::implicit {

/// Morton code (G. M. Morton, "A computer oriented geodetic data base", IBM, 1966) of the unit cell in which
/// the place lies: the bits of its three indices, interleaved. Places beyond 2^20 in any direction count as
/// there.
[[nodiscard]] inline std::uint64_t mortonCode(Point p) {
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float clamped = std::clamp(p[axis], -0x1p20f, 0x1p20f - 1);
    std::uint64_t v = static_cast<std::uint64_t>(static_cast<std::int64_t>(clamped) + (1 << 20));
    v = (v | v << 32) & 0x1F00000000FFFFull;
    v = (v | v << 16) & 0x1F0000FF0000FFull;
    v = (v | v << 8) & 0x100F00F00F00F00Full;
    v = (v | v << 4) & 0x10C30C30C30C30C3ull;
    v = (v | v << 2) & 0x1249249249249249ull;
    code |= v << axis;
  }
  return code;
}

}  // namespace restroke::implicit
