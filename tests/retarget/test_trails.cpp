#include "tests/retarget/test_trails.h"

namespace restroke::retarget {

Trail trailAlong(const points::SurfelModel& model, const Camera& camera, int count) {
  const auto caster = makeCaster(Method::Exact, model, camera);
  TrailRecorder recorder(*caster);
  const auto width = static_cast<std::int32_t>(camera.width) * kSubPixels,
             height = static_cast<std::int32_t>(camera.height) * kSubPixels;
  for (int i = 0; i < count; ++i) {
    const ScreenPoint screen{width / 8 + width * 3 / 4 * i / count, height / 3 + height / 3 * i / count};
    static_cast<void>(recorder.cast({screen, static_cast<double>(i)}));
  }
  return recorder.take();
}

}  // namespace restroke::retarget
