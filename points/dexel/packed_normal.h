#pragma once
// A unit normal and two flags in 32 bits.

#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "implicit/geometry/vec.h"

namespace restroke::points {

/// The octahedral map (Z. Cigolle, S. Donow, D. Evangelakos, M. Mara, M. McGuire, Q. Meyer, A Survey of
/// Efficient Representations for Independent Unit Vectors, Journal of Computer Graphics Techniques 3, 2014)
/// in 15 + 15 bits: off by at most kPackedNormalError, and turned around without any loss. Bits 30 and 31 are
/// the owner's. Single float32 operations in a fixed order: the same bits on every machine.
using PackedNormal = std::uint32_t;

inline constexpr PackedNormal kPackedFlag = 0x80000000u;
/// Radians between a normal and what is unpacked, at most.
inline constexpr double kPackedNormalError = 2e-4;

namespace octahedral {
inline constexpr int kMost = 16383;

struct Folded {
  int u, v;
};
/// From the lower half of the octahedron's net to the coordinates below it, and back.
[[nodiscard]] inline Folded fold(Folded f) {
  const int u = (kMost - std::abs(f.v)) * (f.u < 0 ? -1 : 1);
  const int v = (kMost - std::abs(f.u)) * (f.v < 0 ? -1 : 1);
  return {u, v};
}
[[nodiscard]] inline bool isLower(Folded f) {
  return std::abs(f.u) + std::abs(f.v) > kMost;
}
[[nodiscard]] inline PackedNormal pack(Folded f) {
  return static_cast<std::uint32_t>(f.u + kMost) | static_cast<std::uint32_t>(f.v + kMost) << 15;
}
[[nodiscard]] inline Folded unpack(PackedNormal packed) {
  return {static_cast<int>(packed & 0x7fffu) - kMost, static_cast<int>(packed >> 15 & 0x7fffu) - kMost};
}
}  // namespace octahedral

/// `n` of any length but 0, finite. Without branches, as the kernels do it (simd/span_kernels.inc).
[[nodiscard]] inline PackedNormal packNormal(Vec3 n) {
  const float scale =
      static_cast<float>(octahedral::kMost) / (std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z));
  const auto round = [scale](float x) { return static_cast<int>(x * scale + std::copysign(0.5f, x)); };
  const octahedral::Folded upper{round(n.x), round(n.y)}, lower = octahedral::fold(upper);
  return octahedral::pack(n.z < 0 ? lower : upper);
}

/// Unit.
[[nodiscard]] inline Vec3 unpackNormal(PackedNormal packed) {
  octahedral::Folded f = octahedral::unpack(packed);
  const int z = octahedral::kMost - std::abs(f.u) - std::abs(f.v);
  if (z < 0) f = octahedral::fold(f);
  const Vec3 n{static_cast<float>(f.u), static_cast<float>(f.v), static_cast<float>(z)};
  return n / length(n);
}

/// The opposite normal; the owner's bits stay. Exact.
[[nodiscard]] inline PackedNormal turnedAround(PackedNormal packed) {
  octahedral::Folded f = octahedral::unpack(packed);
  const bool lower = octahedral::isLower(f);
  if (lower) f = octahedral::fold(f);
  f = {-f.u, -f.v};
  // What lies on the border between the halves is itself below.
  if (!lower && std::abs(f.u) + std::abs(f.v) < octahedral::kMost) f = octahedral::fold(f);
  return octahedral::pack(f) | (packed & 0xc0000000u);
}

}  // namespace restroke::points
