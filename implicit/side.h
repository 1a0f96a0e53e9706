#pragma once
// The side of points with respect to a whole list (SPEC S2, S4).

#include <span>

#include "implicit/execution.h"
#include "implicit/primitive_list.h"

namespace restroke::implicit {

/// Side of `p` (model units) by the tail-first test: the last primitive of the prefix that contains the point
/// decides by its sign; none means Outside. A boundary belongs to its primitive. Empty list: Outside. NaN:
/// Outside. O(primitives in p's clusters). Same list, same bits.
[[nodiscard]] Side sideOf(const PrimitiveList& list, Point p, Prefix prefix = {});

/// The same for many points: sides[i] is sideOf(list, points[i], prefix), bit for bit. The spans have equal
/// size. Points that are neighbours in the array should be neighbours in space: they then share their walk of
/// the list.
void sidesOf(const PrimitiveList& list, std::span<const Point> points, std::span<Side> sides,
             Prefix prefix = {}, const Execution& execution = {});

}  // namespace restroke::implicit
