#pragma once
// Splats on the CPU: discs drawn with a depth test, perspective-correct at every pixel (SPEC S3, S7, S11).

#include <span>

#include "implicit/execution.h"
#include "implicit/geometry/camera.h"
#include "points/images/image.h"
#include "points/images/scene.h"

namespace restroke::points {

/// Depth of the nearest front-facing disc that each pixel centre's ray meets, between the camera's near and
/// far plane.
///
/// The ray is intersected with the disc's plane, and membership is decided in that plane; nothing is
/// interpolated. A disc facing away is not drawn: it is the far side of a solid, and seen only from inside
/// it. A disc that is not finite or has no size is left out. Of discs at equal depth the first is taken.
///
/// Depth is within 1e-5 of the exact intersection with the nearest disc (relative) unless the disc is seen at
/// a cosine under 0.01; how far a disc is from the surface that it stands for is the sampling's matter: at
/// most radius^2 / (2 R) along the normal on a sphere of radius R. Same surfels and camera, same bits,
/// whatever the machine and the number of threads.
///
/// Throws InputError when the camera is not valid or its viewport has more than kMaxPixels. O(surfels +
/// pixels covered).
[[nodiscard]] DepthImage renderDepth(std::span<const Surfel> surfels, const Camera& camera,
                                     const Execution& execution = {});

/// The picture with all layers. Depth, normal and ids are of the very disc that renderDepth finds. Colour is
/// shaded with the normals of all discs that lie within a disc's size behind the nearest, weighted smoothly
/// towards their rims, so that neither rims nor the sampling show. Same inputs, same bits, whatever the
/// number of threads. Throws InputError as renderDepth does, and for options out of range.
[[nodiscard]] RenderedImage render(const Scene& scene, const Camera& camera,
                                   const RenderOptions& options = {}, const Execution& execution = {});

}  // namespace restroke::points
