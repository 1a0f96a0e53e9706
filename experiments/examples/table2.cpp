// Table 2's eight strokes as a lion: a curly mane, two carved eyes with pupils, a nose, a smile, the tip of a
// tongue.

#include "experiments/examples/example_logs.h"
#include "experiments/examples/pen.h"
#include "experiments/paper_table.h"
#include "implicit/errors.h"

namespace restroke::experiments {
namespace {

using sculpt::Brush;
using sculpt::Mode;

/// A point of the unit sphere's front, seen from far away at (x, y).
DVec3 front(double x, double y) {
  return {x, y, std::sqrt(std::fmax(0.0, 1 - x * x - y * y))};
}

/// Curls around the face: a ring on which the pen circles outwards.
std::vector<Aim> mane() {
  constexpr double kCurls = 15, kRing = 0.745, kCurl = 0.125;
  constexpr int kPoints = 1400;
  std::vector<Aim> aims;
  for (int i = 0; i <= kPoints; ++i) {
    const double along =
        0.25 + 1.04 * i / kPoints;  // a little more than a turn: the pen is lifted when it has its stamps
    const Turn ring = turn(along), curl = turn(-along * kCurls);
    const double out = kRing + kCurl * curl.cos, side = kCurl * curl.sin;
    aims.push_back(
        {front(out * ring.cos - side * ring.sin, out * ring.sin + side * ring.cos), 0.85 + 0.15 * curl.sin});
  }
  return aims;
}

/// The mouth of a cat: two bows that meet below the nose.
std::vector<Aim> smile() {
  constexpr int kPoints = 240;
  std::vector<Aim> aims;
  for (int i = 0; i <= kPoints; ++i) {
    const double t = 2.0 * i / kPoints - 1;  // -1 to 1
    const Turn bow = turn(0.5 * (t < 0 ? t + 1 : t));
    aims.push_back({front(0.33 * t, -0.27 - 0.15 * bow.sin + 0.06 * t * t), 0.9});
  }
  return aims;
}

}  // namespace

sculpt::StrokeLog table2Log() {
  sculpt::LogHeader header;
  header.base = implicit::Sphere{.center = {0, 0, 0}, .radius = 1};
  Sculptor sculptor(header);
  const Camera camera = cameraAt({0.5, 0.35, 4.6}, {0, 0, 0});

  struct Drawn {
    std::vector<Aim> aims;
    Brush brush;
  };
  const auto dab = [](double x, double y, double radius, Mode mode) {
    return Drawn{{{front(x, y)}}, {.radius = static_cast<float>(radius), .mode = mode}};
  };
  const Drawn strokes[] = {
      {mane(), {.radius = 0.085f, .spacing = 0.43f, .pressureToRadius = 0.5f, .mode = Mode::Add}},
      dab(-0.26, 0.19, 0.16, Mode::Carve),
      dab(0.26, 0.19, 0.16, Mode::Carve),
      dab(-0.25, 0.17, 0.085, Mode::Add),
      dab(0.25, 0.17, 0.085, Mode::Add),
      dab(0, -0.1, 0.13, Mode::Add),
      {smile(), {.radius = 0.035f, .spacing = 0.29f, .mode = Mode::Carve}},
      dab(0.0, -0.36, 0.075, Mode::Add),
  };
  for (std::size_t i = 0; i < kPaperTable2.size(); ++i)
    if (!sculptor.drawUntil(camera, strokes[i].aims, strokes[i].brush, kPaperTable2[i].stamps))
      throw InternalError(
          fmt::format("examples: stroke {} of table2 has no {} stamps", i + 1, kPaperTable2[i].stamps));
  return sculptor.log();
}

}  // namespace restroke::experiments
