// The paper's scale: 108 strokes with 3,426 stamps (SPEC S11), nine from each of twelve cameras:
// rosettes, each a curl with eight petals around it, alternately added and carved, as a hand with a pen would
// draw them.

#include <array>

#include "experiments/examples/example_logs.h"
#include "experiments/examples/pen.h"
#include "experiments/random.h"
#include "implicit/errors.h"

namespace restroke::experiments {
namespace {

constexpr std::size_t kStrokes = 108;
constexpr std::size_t kStamps = 3426;
constexpr std::size_t kPerCamera = 9;  // twelve cameras
constexpr int kTries = 40;

/// Corners of an icosahedron: twelve directions, evenly spread.
std::vector<DVec3> directions() {
  const double golden = (1 + std::sqrt(5.0)) / 2;
  std::vector<DVec3> out;
  for (const double a : {1.0, -1.0})
    for (const double b : {golden, -golden}) {
      out.push_back(normalized({a, b, 0}));
      out.push_back(normalized({0, a, b}));
      out.push_back(normalized({b, 0, a}));
    }
  return out;
}

/// How many stamps each stroke is to have: uneven, as in drawing, most in the curls, and kStamps in all.
std::vector<std::size_t> stampsPerStroke(Random& random) {
  std::vector<std::size_t> counts(kStrokes);
  std::size_t sum = 0;
  for (std::size_t i = 0; i < kStrokes; ++i)
    sum += counts[i] = i % kPerCamera == 0 ? 54 + random.below(16) : 22 + random.below(14);
  while (sum != kStamps) {
    const std::size_t i = random.below(kStrokes);
    if (i % kPerCamera == 0) continue;
    if (sum < kStamps) ++counts[i], ++sum;
    if (sum > kStamps && counts[i] > 12) --counts[i], --sum;
  }
  return counts;
}

/// One rosette: what the nine strokes of a camera have in common.
struct Rosette {
  double turned;  ///< of its first petal, turns
  double swirl;   ///< how far petals bend, turns; the sign is the direction
  double wave;    ///< of a petal's line, turns
  bool flipped;   ///< carved where others are added
};

/// The pen's way in the plane that the camera faces, and its pressure. A hand is never quite still.
std::vector<Aim> penWay(const CameraFrame& frame, std::span<const std::array<double, 3>> way,
                        Random& random) {
  std::vector<Aim> aims;
  for (const auto& [x, y, pressure] : way) {
    const double u = x + random.between(-0.0012, 0.0012), v = y + random.between(-0.0012, 0.0012);
    aims.push_back({frame.right * u + frame.up * v - frame.forward * std::sqrt(1 - u * u - v * v),
                    pressure + random.between(-0.02, 0.02)});
  }
  return aims;
}

/// A curl in the middle, from inside out.
std::vector<std::array<double, 3>> curl(const Rosette& rosette, double length) {
  std::vector<std::array<double, 3>> way;
  constexpr int kPoints = 90;
  // An Archimedean spiral of n turns and outer radius R is about pi n R long.
  const double outer = 0.17, turns = length / (3.14159 * outer);
  for (int i = 0; i <= kPoints; ++i) {
    const double t = static_cast<double>(i) / kPoints, away = outer * std::sqrt(t);
    const Turn at = turn(rosette.turned + (rosette.swirl < 0 ? -turns : turns) * std::sqrt(t));
    way.push_back({away * at.cos, away * at.sin, 0.45 + 0.55 * t});
  }
  return way;
}

/// A petal: outwards from the curl, bending and waving, pressed most in its middle.
std::vector<std::array<double, 3>> petal(const Rosette& rosette, int which, double length) {
  constexpr double kStep = 0.006;  // between two reports of the pen
  const int points = static_cast<int>(length / kStep) + 1;
  const double direction = rosette.turned + which / 8.0;
  double x = 0.23 * turn(direction).cos, y = 0.23 * turn(direction).sin;
  std::vector<std::array<double, 3>> way;
  for (int i = 0; i <= points; ++i) {
    const double t = static_cast<double>(i) / points;
    way.push_back({x, y, 0.3 + 0.7 * (4 * t * (1 - t))});
    const Turn heading =
        turn(direction - 0.3 * rosette.swirl + rosette.swirl * t + rosette.wave * turn(1.5 * t).sin);
    x += kStep * heading.cos;
    y += kStep * heading.sin;
  }
  return way;
}

}  // namespace

sculpt::StrokeLog paperScaleLog(std::uint64_t seed) {
  sculpt::LogHeader header;
  header.density = 18400;
  header.base = implicit::Sphere{.center = {0, 0, 0}, .radius = 1};
  Sculptor sculptor(header);
  Random random(seed);
  const std::vector<DVec3> from = directions();
  const std::vector<std::size_t> counts = stampsPerStroke(random);
  Rosette rosette{};
  for (std::size_t i = 0; i < kStrokes; ++i) {
    const DVec3 direction = from[i / kPerCamera];
    const int which = static_cast<int>(i % kPerCamera);
    if (which == 0)
      rosette = {.turned = random.unit(),
                 .swirl = random.between(0.15, 0.3) * (random.below(2) == 0 ? 1 : -1),
                 .wave = random.between(0.01, 0.05),
                 .flipped = random.below(3) == 0};
    // Near enough for a picture of the rosette, far enough to see all of it.
    const Camera camera =
        cameraAt(direction * 4.2, {0, 0, 0}, std::fabs(direction.y) < 0.8 ? DVec3{0, 1, 0} : DVec3{1, 0, 0});
    const bool carved = (which % 2 == 1) != rosette.flipped;
    // Few stamps make a stout petal, many a slender one: all are about equally long.
    const double length = which == 0 ? 1.05 : random.between(0.34, 0.40);
    sculpt::Brush brush;
    brush.spacing = 0.3f;
    brush.pressureToRadius = 0.8f;
    brush.mode = carved ? sculpt::Mode::Carve : sculpt::Mode::Add;
    bool drawn = false;
    for (int attempt = 0; attempt < kTries && !drawn; ++attempt) {
      // The mean pressure is near 0.75; the way is drawn longer than needed, and the pen lifted at the right
      // stamp.
      const double radius =
          length / (0.8 * static_cast<double>(brush.spacing) * static_cast<double>(counts[i]));
      brush.radius = static_cast<float>(std::floor(radius * 2048 * (1 - 0.02 * attempt) + 0.5)) / 2048;
      const auto way = which == 0 ? curl(rosette, 1.1 * length) : petal(rosette, which - 1, 1.1 * length);
      drawn = sculptor.drawUntil(camera, penWay(frameOf(camera), way, random), brush, counts[i]);
    }
    if (!drawn) throw InternalError(fmt::format("examples: no stroke of {} stamps was found", counts[i]));
  }
  return sculptor.log();
}

}  // namespace restroke::experiments
