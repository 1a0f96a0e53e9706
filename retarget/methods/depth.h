#pragma once
// The methods "depth" and "depth-cpu": the depth buffer of the drawn surfels, read at the stroke's points, as
// the paper does it (SPEC S7).

#include <memory>

#include "points/images/image.h"
#include "retarget/method.h"

namespace restroke::retarget {

/// Draws the prefix once with OpenGL. Drivers differ in the last bits, therefore the outcome is recorded in
/// the log. Throws InputError that names depth-cpu when no OpenGL context can be had.
[[nodiscard]] std::unique_ptr<Caster> makeDepthCaster(const CasterInput& input);

/// Draws the prefix once with the CPU renderer. Same bits everywhere.
[[nodiscard]] std::unique_ptr<Caster> makeDepthCpuCaster(const CasterInput& input);

/// Casts onto a depth image that the camera sees (of the camera's viewport; InternalError otherwise).
///
/// The depth is that of the pixel which holds the screen point; the place is the point of the ray through the
/// screen point itself that has this depth. A point outside the viewport, and one whose pixel shows no
/// surface, is a miss.
///
/// Error against the surface, where pixel and ray see the same piece of it: along the ray at most
///     footprint / sqrt(2) * slope + sag * sqrt(1 + slope^2),
/// footprint = depth * 2 halfHeight / height, the side of a pixel at that depth; slope = the tangent of the
/// angle between surface normal and ray; sag = radius^2 / (2 R), how far a surfel's disc stands off a sphere
/// of radius R. (First order in the footprint.) At silhouettes pixel and ray may see different pieces, and
/// discs overhang by up to their radius.
///
/// The normal is that of the plane through the pixel's surface point and one neighbour's in either direction,
/// the one nearer in depth (the ray's reverse where there is none): a difference of depths, good to some
/// degrees, and worth less the smaller a pixel is against the discs.
[[nodiscard]] std::unique_ptr<Caster> makeDepthImageCaster(points::DepthImage image, const Camera& camera);

}  // namespace restroke::retarget
