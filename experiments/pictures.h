#pragma once
// Pictures of shapes for reports.

#include <span>

#include "implicit/geometry/camera.h"
#include "points/images/png.h"
#include "sculpt/stroke_log.h"

namespace restroke::experiments {

/// A ball that holds every surfel it has been shown, about a centre that is given.
struct PictureBall {
  Point center{0};
  float radius = 0;
  void add(std::span<const points::Surfel> surfels);
};

/// From where the log's first stroke was seen (from the front and a little above, if it has no stroke), so
/// that the ball fills a square picture.
[[nodiscard]] Camera pictureCamera(const sculpt::StrokeLog& log, const PictureBall& ball, std::uint32_t size);

/// The scene drawn on the CPU, ready for the screen.
[[nodiscard]] points::DisplayImage drawPicture(const points::Scene& scene, const Camera& camera,
                                               const Execution& execution = {});

}  // namespace restroke::experiments
