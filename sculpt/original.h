#pragma once
// Where a stroke was when it was first applied: what methods that follow a change start from (SPEC S7, S10).

#include <cstddef>
#include <memory>
#include <vector>

#include "implicit/geometry/space_map.h"
#include "retarget/alignment.h"
#include "retarget/trail.h"

namespace restroke::sculpt {

/// What a base went through on the way to a node: which one it is, and the transforms since.
struct BaseHistory {
  std::uint32_t node = 0;  ///< the history node that brought the base, 0: the log's header
  Affine since;
  bool operator==(const BaseHistory&) const = default;
};

/// Never changed once it is made; copies of a node share it.
struct Original {
  std::uint64_t shapeBefore = 0;  ///< hash of the list that it was cast on
  BaseHistory base;
  retarget::Trail trail = {};                       ///< of `fixed`, `nearest`, `surface`
  std::vector<retarget::OrientedPoint> patch = {};  ///< of `aligned`: surfels around the stroke, before it
  [[nodiscard]] std::size_t bytes() const {
    return sizeof(*this) + trail.points.capacity() * sizeof(retarget::TrailPoint) +
           patch.capacity() * sizeof(retarget::OrientedPoint);
  }
};

}  // namespace restroke::sculpt
