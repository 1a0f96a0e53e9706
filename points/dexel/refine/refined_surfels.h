#pragma once
// What refined lines look like, whatever their directions.

#include <vector>

#include "points/dexel/refine/refine.h"
#include "points/surfel.h"

namespace restroke::points {

/// A surfel for each end of each line: its place, its normal, the operation that made it (as surfelsOf a
/// tri-dexel has it, points/dexel/dexel_surfels.h). Discs reach to the middle between neighbouring lines on
/// the plane through the end, but are no larger than 1.25 times the lines' spacing there: one family alone
/// leaves gaps where the surface runs along its lines. By family, row and column. O(lines + ends).
[[nodiscard]] std::vector<Surfel> surfelsOf(const RefinedModel& refined);

}  // namespace restroke::points
