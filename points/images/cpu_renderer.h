#pragma once
// Splats on the CPU: discs drawn with a depth test, perspective-correct at every pixel (SPEC S3, S7, S11).

#include <memory>
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

/// The layers of a picture that are made beside colour; those that are not are left empty, and cost nothing.
struct Layers {
  bool depth = true;
  bool normal = true;
  bool ids = true;  ///< primitive and stroke
};

/// Draws one picture after the other into the same memory, as a window does: after the first picture of a
/// size nothing large is allocated any more. One thread at a time may use it.
class CpuRenderer {
 public:
  explicit CpuRenderer(Layers layers = {});
  ~CpuRenderer();
  CpuRenderer(CpuRenderer&&) noexcept;
  CpuRenderer& operator=(CpuRenderer&&) noexcept;

  /// The bits of restroke::points::render, errors too. The picture is good until the next call.
  const RenderedImage& render(const Scene& scene, const Camera& camera, const RenderOptions& options = {},
                              const Execution& execution = {});
  /// The bits of restroke::points::renderDepth, errors too. The image is good until the next call.
  const DepthImage& renderDepth(std::span<const Surfel> surfels, const Camera& camera,
                                const Execution& execution = {});

 private:
  friend DepthImage restroke::points::renderDepth(std::span<const Surfel>, const Camera&, const Execution&);
  friend RenderedImage restroke::points::render(const Scene&, const Camera&, const RenderOptions&,
                                                const Execution&);
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace restroke::points
