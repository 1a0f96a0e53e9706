#pragma once
// A ring about an arc, as lines see it. Internal to points/dexel/toolpath.

#include <vector>

#include "points/dexel/toolpath/arc_path.h"
#include "points/dexel/toolpath/line_math.h"

namespace restroke::points {

/// Appends where a line is within `tube` of the circle of radius `circle` about the z axis, and in the wedge
/// of the arc (of which nothing but that counts): up to four stretches, ascending. The tube may be thicker
/// than the circle. Coordinates are in the arc's u, v, w, from the centre of the circle; `direction` is of
/// length 1.
///
/// Ends are the roots of a polynomial of degree 4, found between those of its derivative, then brought nearer
/// by the distance itself: within 1e-9 of circle + tube, but for lines that touch.
void appendRing(const ArcPath& wedge, double circle, double tube, DVec3 origin, DVec3 direction,
                std::vector<lines::Stretch>& stretches);

/// Appends the parts of a stretch that are in the wedge of the arc: up to two. New ends have the face kSide.
void appendInWedge(const ArcPath& wedge, lines::Flat2 origin, lines::Flat2 direction,
                   const lines::Stretch& stretch, std::vector<lines::Stretch>& parts);

}  // namespace restroke::points
