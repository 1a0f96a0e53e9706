#pragma once

#include <limits>

#include "implicit/geometry/vec.h"

namespace restroke {

/// Axis-parallel box, both faces included. A default box is empty (min > max) and takes anything added to it.
struct Box {
  Point min{std::numeric_limits<float>::infinity()};
  Point max{-std::numeric_limits<float>::infinity()};

  [[nodiscard]] bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
  /// The empty box has centre 0 and half diagonal 0.
  [[nodiscard]] Point center() const { return empty() ? Point(0) : (min + max) * 0.5f; }
  [[nodiscard]] float halfDiagonal() const { return empty() ? 0.0f : length(max - min) * 0.5f; }
  void add(const Box& other) {
    min = {std::fmin(min.x, other.min.x), std::fmin(min.y, other.min.y), std::fmin(min.z, other.min.z)};
    max = {std::fmax(max.x, other.max.x), std::fmax(max.y, other.max.y), std::fmax(max.z, other.max.z)};
  }
};

}  // namespace restroke
