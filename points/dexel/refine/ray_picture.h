#pragma once
// High definition: a picture from the rays of a camera, one or more a pixel (SPEC R3, R9).

#include "implicit/execution.h"
#include "implicit/geometry/camera.h"
#include "points/dexel/refine/line_replay.h"
#include "points/images/image.h"
#include "points/images/scene.h"

namespace restroke::points {

/// Most rays along each side of a pixel.
inline constexpr int kMostRaysAcross = 8;

/// The camera whose pixels' rays are `across` x `across` for each pixel of this one. Throws InputError when
/// that is not 1 to kMostRaysAcross, or its picture would be larger than a camera's may be.
[[nodiscard]] Camera withRays(Camera camera, int across);

/// What a camera sees of the dexels of its rays (raysOf(withRays(camera, across))): colour is the mean of a
/// pixel's rays, lit as by the CPU renderer (points/images/cpu_renderer.h), each by the normal of its first
/// end; depth, normal and primitive (the operation that made the end, 0 the initial solid) are those of the
/// ray in the pixel's middle, or just below and to the right of it. What subtractions made is drawn as
/// carved, what unions made as added. Where a ray enters the solid at the near plane the cut is seen, facing
/// the camera. Throws InputError as validateForImage, and InternalError when the sizes do not fit. Same
/// dexels, same bits. O(rays).
[[nodiscard]] RenderedImage pictureOf(const Dexels& rays, const Camera& camera,
                                      const RenderOptions& options = {}, const Execution& execution = {});

}  // namespace restroke::points
