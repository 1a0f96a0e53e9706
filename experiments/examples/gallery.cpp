// One of each kind of volume on a plate, and beside each the hollow that it leaves when it is carved.

#include <cmath>
#include <vector>

#include "experiments/examples/example_logs.h"
#include "implicit/volume.h"

namespace restroke::experiments {
namespace {

constexpr int kColumns = 4;
constexpr float kColumnWidth = 2.4f, kRowDepth = 4.4f;

/// The volume at a size of about 1, its middle at the place, tilted so that more than one side shows.
implicit::Shape placed(const std::shared_ptr<const implicit::Volume>& volume, DVec3 middle) {
  implicit::Pose pose;
  const implicit::VolumeMeasures& m = volume->measures();
  pose.scale = static_cast<float>(0.95 / m.radius);
  pose.rotation = implicit::rotationTo({0.25, 1, 0.35}, {1, 0, -0.4});
  // The rotation alone, then the move that brings the volume's middle to the place.
  pose.position = Point(middle);
  const implicit::PosedVolume turned(volume, pose);
  pose.position = Point(middle - (turned.toModel(m.center) - middle));
  return std::make_shared<const implicit::PosedVolume>(volume, pose);
}

}  // namespace

sculpt::StrokeLog galleryLog() {
  const auto kinds = implicit::volumeKinds();
  const auto shown = static_cast<int>(kinds.size()) + 1;  // and the sphere
  const int rows = (shown + kColumns - 1) / kColumns;
  const float width = kColumns * kColumnWidth, depth = static_cast<float>(rows) * kRowDepth;

  sculpt::StrokeLog log;
  log.header.density = 1500;
  log.header.base = std::make_shared<const implicit::PosedVolume>(
      implicit::volumeKindNamed("box").make({{{width / 2}, {0.6f}, {depth / 2}, {0.12f}}}),
      implicit::Pose{.position = {0, -0.6f, 0}});
  for (int i = 0; i < shown; ++i) {
    const double x = static_cast<double>(kColumnWidth) * (i % kColumns - (kColumns - 1) / 2.0);
    const double z = static_cast<double>(kRowDepth) * (i / kColumns - (rows - 1) / 2.0);
    for (const sculpt::Mode mode : {sculpt::Mode::Add, sculpt::Mode::Carve}) {
      const bool adds = mode == sculpt::Mode::Add;
      const DVec3 middle(x, adds ? 0.75 : 0.1, z + (adds ? -1.0 : 1.1));
      sculpt::FixedCommand command{.mode = mode};
      if (i == 0)
        command.stamps.push_back({Point(middle), 0.8f});
      else {
        const implicit::VolumeKind& kind = *kinds[static_cast<std::size_t>(i - 1)];
        command.shapes.push_back(placed(kind.make(kind.examples().front()), middle));
      }
      log.commands.emplace_back(std::move(command));
    }
  }
  return log;
}

}  // namespace restroke::experiments
