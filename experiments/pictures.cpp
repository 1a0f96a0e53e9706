#include "experiments/pictures.h"

#include <cmath>
#include <variant>

#include "points/images/cpu_renderer.h"

namespace restroke::experiments {

void PictureBall::add(std::span<const points::Surfel> surfels) {
  for (const points::Surfel& s : surfels) radius = std::fmax(radius, length(s.position - center));
}

Camera pictureCamera(const sculpt::StrokeLog& log, const PictureBall& ball, std::uint32_t size) {
  Vec3 view(-0.35f, -0.25f, -1.0f);
  for (const sculpt::Command& command : log.commands)
    if (const auto* stroke = std::get_if<sculpt::StrokeCommand>(&command)) {
      view = stroke->stroke.camera.view;
      break;
    }
  return frameSphere(ball.center, ball.radius, {.view = view, .width = size, .height = size, .fill = 0.94f});
}

points::DisplayImage drawPicture(const points::Scene& scene, const Camera& camera,
                                 const Execution& execution) {
  return points::toDisplay(points::render(scene, camera, {}, execution));
}

}  // namespace restroke::experiments
