#include "retarget/measures.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "implicit/ray_cast.h"
#include "retarget/surface_distance.h"

namespace restroke::retarget {
namespace {

// A hit is hidden where the surface is met before it by more than this many pixels' footprint at its depth: a
// place on a surfel's disc is a little below the surface, and its place is rounded.
constexpr double kHiddenPixels = 2;
// Neighbours nearer than this part of their coordinates are not compared: rounding to float32 would show.
constexpr double kLeastStep = 0x1p-16;

double distance(const SurfaceHit& a, const SurfaceHit& b) {
  return length(DVec3(a.position) - DVec3(b.position));
}

double degreesBetween(const SurfaceHit& a, const SurfaceHit& b) {
  // Not by the arc cosine, which has no digits for small angles.
  const DVec3 m(a.normal), n(b.normal);
  return std::atan2(length(cross(m, n)), dot(m, n)) * (180 / 3.14159265358979323846);
}

bool isInputPoint(const TrailPoint& point) {
  return point.place.along == std::floor(point.place.along);
}

std::optional<SurfaceHit> hitAt(const Trail& trail, double along) {
  const auto point = trail.at(along);
  return point ? point->hit : std::nullopt;
}

/// `expected` null: a hit everywhere.
void countMisses(const Trail* expected, const Trail& result, StrokeObservations& seen) {
  for (const TrailPoint& point : (expected ? *expected : result).points) {
    if (!isInputPoint(point)) continue;
    ++seen.places;
    const bool mayHit = !expected || point.hit, isHit = hitAt(result, point.place.along).has_value();
    seen.expected += mayHit;
    seen.missed += mayHit && !isHit;
    seen.gained += !mayHit && isHit;
  }
}

void compareWithTruth(const Trail& truth, const Trail& result, StrokeObservations& seen) {
  const TrailPoint* before = nullptr;  // and the result there
  std::optional<SurfaceHit> resultBefore;
  for (const TrailPoint& point : truth.points) {
    const auto hit = hitAt(result, point.place.along);
    if (hit && point.hit && isInputPoint(point)) {
      seen.errors.push_back(distance(*hit, *point.hit));
      seen.normalErrors.push_back(degreesBetween(*hit, *point.hit));
    }
    if (before && before->hit && point.hit && resultBefore && hit) {
      seen.comparedTrueLength += distance(*before->hit, *point.hit);
      seen.comparedLength += distance(*resultBefore, *hit);
    }
    before = &point;
    resultBefore = hit;
  }
  const Polylines trueCurve = curveOf(truth), curve = curveOf(result);
  seen.trueLength = lengthOf(trueCurve);
  if (!trueCurve.empty() && !curve.empty()) seen.hausdorff = hausdorffDistance(trueCurve, curve);
}

void compareSteps(const Trail& original, const Trail& result, StrokeObservations& seen) {
  std::optional<SurfaceHit> before, resultBefore;
  for (const TrailPoint& point : original.points) {
    if (!isInputPoint(point)) continue;
    const auto hit = hitAt(result, point.place.along);
    if (before && resultBefore && point.hit && hit) {
      const double step = distance(*before, *point.hit);
      if (step > kLeastStep * length(DVec3(point.hit->position)))
        seen.stretches.push_back(distance(*resultBefore, *hit) / step);
    }
    before = point.hit;
    resultBefore = hit;
  }
}

/// The stroke's own camera.
class Screen {
 public:
  explicit Screen(const Camera& camera) : camera_(camera), frame_(frameOf(camera)) {}

  void look(ScreenPoint drawn, const SurfaceHit& hit, const RetargetedStroke& stroke,
            StrokeObservations& seen) const {
    const DVec3 p(hit.position);
    const Projection at = project(frame_, camera_, p);
    if (!(at.depth > 0)) {
      ++seen.behind;
      return;
    }
    const double dx = at.x - static_cast<double>(drawn.x) / kSubPixels,
                 dy = at.y - static_cast<double>(drawn.y) / kSubPixels;
    seen.drifts.push_back(std::sqrt(dx * dx + dy * dy));
    if (!stroke.model) return;
    const double footprint = at.depth * 2 * frame_.halfHeight / static_cast<double>(camera_.height);
    const DVec3 sight = p - frame_.position;
    // In parts of the way to the hit, of which the camera's near plane cuts off the first.
    const Ray ray{.origin = frame_.position,
                  .direction = sight,
                  .tMin = static_cast<double>(camera_.near) / at.depth,
                  .tMax = 1 - kHiddenPixels * footprint / length(sight)};
    if (ray.tMin < ray.tMax && implicit::castRay(stroke.model->list(), ray, stroke.prefix)) ++seen.hidden;
  }

 private:
  Camera camera_;
  CameraFrame frame_;
};

struct Summary {
  std::size_t count = 0;
  double squares = 0, sum = 0;
  double least = kNotObserved, most = kNotObserved;

  void add(const std::vector<double>& values) {
    for (const double value : values) {
      squares += value * value;
      sum += value;
      // Comparisons with NaN are false.
      if (!(least <= value)) least = value;
      if (!(most >= value)) most = value;
      ++count;
    }
  }
  [[nodiscard]] double mean() const { return count > 0 ? sum / static_cast<double>(count) : kNotObserved; }
  [[nodiscard]] double rms() const {
    return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : kNotObserved;
  }
};

double medianOf(std::vector<double> values) {
  if (values.empty()) return kNotObserved;
  const std::size_t half = values.size() / 2;
  std::sort(values.begin(), values.end());
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

}  // namespace

Polylines curveOf(const Trail& trail) {
  Polylines curve;
  bool drawing = false;
  for (const TrailPoint& point : trail.points) {
    if (point.hit) {
      if (!drawing) curve.emplace_back();
      curve.back().push_back(DVec3(point.hit->position));
    }
    drawing = point.hit.has_value();
  }
  return curve;
}

StrokeObservations observe(const RetargetedStroke& stroke) {
  StrokeObservations seen;
  const Trail* expected = stroke.truth ? stroke.truth : stroke.original;
  countMisses(expected, stroke.result, seen);
  if (stroke.truth) compareWithTruth(*stroke.truth, stroke.result, seen);
  if (stroke.original) compareSteps(*stroke.original, stroke.result, seen);

  if (stroke.model) {
    const SurfaceDistance surface(*stroke.model, stroke.prefix, stroke.execution);
    for (const TrailPoint& point : stroke.result.points)
      if (const auto away = point.hit ? surface.from(*point.hit) : std::nullopt)
        seen.surfaceDistances.push_back(*away);
  }
  const Screen screen(stroke.camera);
  for (const TrailPoint& point : (expected ? *expected : stroke.result).points) {
    if (!isInputPoint(point)) continue;
    if (const auto hit = hitAt(stroke.result, point.place.along))
      screen.look(point.place.screen, *hit, stroke, seen);
  }
  return seen;
}

Measures summarise(std::span<const StrokeObservations> strokes) {
  Summary errors, normals, distances, stretches, drifts;
  std::vector<double> allStretches;
  std::size_t expected = 0, withLength = 0;
  double trueLength = 0, comparedTrue = 0, compared = 0, hausdorff = kNotObserved;
  Measures m;
  m.strokes = strokes.size();
  for (const StrokeObservations& s : strokes) {
    m.places += s.places;
    m.missed += s.missed;
    m.gained += s.gained;
    m.hidden += s.hidden;
    m.behind += s.behind;
    expected += s.expected;
    errors.add(s.errors);
    normals.add(s.normalErrors);
    distances.add(s.surfaceDistances);
    stretches.add(s.stretches);
    drifts.add(s.drifts);
    allStretches.insert(allStretches.end(), s.stretches.begin(), s.stretches.end());
    trueLength += s.trueLength;
    withLength += s.trueLength > 0;
    comparedTrue += s.comparedTrueLength;
    compared += s.comparedLength;
    if (s.hausdorff && !(hausdorff >= *s.hausdorff)) hausdorff = *s.hausdorff;
  }
  m.missRate = expected > 0 ? static_cast<double>(m.missed) / static_cast<double>(expected) : kNotObserved;
  m.errorRms = errors.rms();
  m.errorMax = errors.most;
  m.hausdorff = hausdorff;
  const double meanLength = withLength > 0 ? trueLength / static_cast<double>(withLength) : kNotObserved;
  m.errorRmsOfLength = m.errorRms / meanLength;
  m.errorMaxOfLength = m.errorMax / meanLength;
  m.hausdorffOfLength = m.hausdorff / meanLength;
  m.lengthDrift = comparedTrue > 0 ? (compared - comparedTrue) / comparedTrue : kNotObserved;
  m.normalErrorMean = normals.mean();
  m.normalErrorMax = normals.most;
  m.surfaceDistanceRms = distances.rms();
  m.surfaceDistanceMax = distances.most;
  m.stretchMedian = medianOf(std::move(allStretches));
  m.stretchMin = stretches.least;
  m.stretchMax = stretches.most;
  m.driftRms = drifts.rms();
  m.driftMax = drifts.most;
  return m;
}

}  // namespace restroke::retarget
