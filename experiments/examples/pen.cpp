#include "experiments/examples/pen.h"

#include <algorithm>
#include <cmath>

#include "implicit/errors.h"
#include "implicit/ray_cast.h"
#include "sculpt/brush.h"

namespace restroke::experiments {
namespace {

constexpr double kTau = 6.283185307179586;
constexpr std::uint32_t kMillisecondsPerPoint = 8;  // a pen tablet's 125 reports a second

/// Taylor series about 0, for at most an eighth of a turn.
Turn smallTurn(double turns) {
  const double x = turns * kTau, y = x * x;
  Turn t;
  t.sin = x * (1 - y / 6 * (1 - y / 20 * (1 - y / 42 * (1 - y / 72 * (1 - y / 110 * (1 - y / 156))))));
  t.cos =
      1 - y / 2 * (1 - y / 12 * (1 - y / 30 * (1 - y / 56 * (1 - y / 90 * (1 - y / 132 * (1 - y / 182))))));
  return t;
}

std::int32_t rounded(double value) {
  return static_cast<std::int32_t>(std::floor(value + 0.5));
}

}  // namespace

Turn turn(double turns) {
  const double quarters = std::floor(turns * 4 + 0.5);
  const Turn t = smallTurn(turns - quarters / 4);
  switch (static_cast<long long>(quarters) & 3) {
    case 0:
      return t;
    case 1:
      return {-t.sin, t.cos};
    case 2:
      return {-t.cos, -t.sin};
    default:
      return {t.sin, -t.cos};
  }
}

Camera cameraAt(DVec3 from, DVec3 at, DVec3 up) {
  Camera c;
  c.position = Point(from);
  c.view = Vec3(normalized(at - from));
  c.up = Vec3(up);
  c.halfHeight = 0.3f;
  c.width = 1280;
  c.height = 960;
  c.near = 0.01f;
  c.far = 100.0f;
  return c;
}

std::vector<Aim> straight(DVec3 from, DVec3 to, int points) {
  std::vector<Aim> aims;
  for (int i = 0; i < points; ++i) {
    const double t = static_cast<double>(i) / (points - 1);
    aims.push_back({from * (1 - t) + to * t, 1});
  }
  return aims;
}

retarget::Stroke penStroke(const Camera& camera, std::span<const Aim> aims) {
  retarget::Stroke stroke;
  stroke.camera = camera;
  const CameraFrame frame = frameOf(camera);
  for (const Aim& aim : aims) {
    const Projection seen = project(frame, camera, aim.at);
    if (!(seen.depth > 0)) throw InternalError("examples: the pen is aimed at a point behind the camera");
    retarget::StrokePoint point;
    point.screen = {rounded(seen.x * kSubPixels), rounded(seen.y * kSubPixels)};
    point.time = kMillisecondsPerPoint * static_cast<std::uint32_t>(stroke.points.size());
    point.pressure = static_cast<std::uint16_t>(std::clamp(rounded(aim.pressure * retarget::kMaxPressure), 0,
                                                           static_cast<int>(retarget::kMaxPressure)));
    stroke.points.push_back(point);
  }
  return stroke;
}

Sculptor::Sculptor(const sculpt::LogHeader& header) : document_(header) {
  log_.header = header;
}

std::size_t Sculptor::draw(const Camera& camera, std::span<const Aim> aims, const sculpt::Brush& brush) {
  sculpt::StrokeCommand command;
  command.stroke = penStroke(camera, aims);
  command.brush = brush;
  return carryOut(std::move(command)).primitivesAdded;
}

void Sculptor::drawOn(const Camera& camera, std::span<const Aim> aims, const sculpt::Brush& brush) {
  if (draw(camera, aims, brush) == 0) throw InternalError("examples: a stroke missed the shape");
}

sculpt::CommandReport Sculptor::carryOut(sculpt::Command command) {
  sculpt::CommandReport report = document_.apply(command);
  if (sculpt::Consequences* consequences = sculpt::consequencesOf(command))
    consequences->recasts = report.recasts;
  log_.commands.emplace_back(std::move(command));
  return report;
}

bool Sculptor::drawUntil(const Camera& camera, std::span<const Aim> aims, const sculpt::Brush& brush,
                         std::size_t stamps) {
  const auto caster = retarget::makeCaster(retarget::Method::Exact, document_.model(), camera);
  const retarget::Stroke whole = penStroke(camera, aims);
  const auto count = [&](std::size_t points) {
    retarget::Stroke part = whole;
    part.points.resize(points);
    return sculpt::stampsAlong(part, brush, log_.header.grid, *caster).stamps.size();
  };
  // Stamps are set as the pen goes, so their number never falls with the number of points: the first place is
  // found by halving.
  std::size_t low = 0, high = whole.points.size();
  if (high == 0 || count(high) < stamps) return false;
  while (high - low > 1) {
    const std::size_t middle = low + (high - low) / 2;
    (count(middle) < stamps ? low : high) = middle;
  }
  if (count(high) != stamps) return false;
  RESTROKE_CHECK_EQ(draw(camera, aims.first(high), brush), stamps);
  return true;
}

DVec3 Sculptor::surfaceSeen(DVec3 from, DVec3 at) const {
  Ray ray;
  ray.origin = from;
  ray.direction = normalized(at - from);
  const auto hit = implicit::castRay(document_.model().list(), ray);
  if (!hit) throw InternalError("examples: the pen is aimed past the shape");
  return hit->position;
}

}  // namespace restroke::experiments
