#include "sculpt/aligned_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "implicit/errors.h"
#include "implicit/geometry/similarity.h"

namespace restroke::sculpt {

namespace {

using retarget::AlignmentMode;
using retarget::AlignmentVerdict;
using retarget::OrientedPoint;

/// How far around a stroke its patch reaches, in parts of the model's half size: less and it slides along
/// itself, more and what has changed elsewhere pulls at it.
constexpr double kPatchReach = 0.3;

/// Samples of a base that is matched as a whole.
constexpr double kBaseSamples = 4000;
/// The other side is sampled at another density, so that no sample lies where one of the first side does:
/// neighbouring samples must not be taken for the same place.
constexpr double kOtherSamples = 5300;

std::vector<OrientedPoint> samplesOf(const implicit::Shape& shape, double count) {
  const double density = count / implicit::areaOf(shape);
  points::SurfelModel model({.density = static_cast<float>(density)}, {.cell = 0.2f * shape.ball().radius});
  const implicit::Primitive primitive{shape, implicit::Sign::Positive};
  model.append({&primitive, 1}, {.threads = 1});
  return retarget::orientedPoints(model.surfels({.threads = 1}));
}

std::vector<OrientedPoint> surfelsBefore(const StrokeSite& site) {
  return retarget::orientedPoints(site.model.surfels({site.prefix}, site.execution));
}

/// Every k-th, so that at most `limit` are left.
std::vector<OrientedPoint> thinned(const std::vector<OrientedPoint>& points, std::size_t limit) {
  if (points.size() <= limit) return points;
  std::vector<OrientedPoint> few;
  few.reserve(limit);
  for (std::size_t i = 0; i < limit; ++i) few.push_back(points[i * points.size() / limit]);
  return few;
}

AlignedView along(const retarget::Alignment& alignment, const Camera& camera) {
  return {moved(alignment.motion, camera), static_cast<float>(alignment.motion.scale), {}};
}

}  // namespace

std::vector<OrientedPoint> patchBefore(const retarget::Trail& trail, const Brush& brush,
                                       const StrokeSite& site) {
  std::vector<Point> stroke;
  for (const retarget::TrailPoint& point : trail.points)
    if (point.hit) stroke.push_back(point.hit->position);
  if (stroke.empty()) return {};
  const double size = static_cast<double>(site.model.list().boundingSphere({site.prefix}).radius);
  const double reach = std::max(kPatchReach * size, 2 * static_cast<double>(brush.radius));
  std::vector<OrientedPoint> patch =
      thinned(retarget::patchAround(surfelsBefore(site), stroke, reach), kPatchPoints);
  patch.shrink_to_fit();
  return patch;
}

AlignedView alignedView(const Original& original, const StrokeCommand& stroke, const StrokeSite& site,
                        const BaseSource& source) {
  const Camera& camera = stroke.stroke.camera;
  std::string reason;
  if (original.base != site.base) {
    const auto whole =
        retarget::alignSurfels(samplesOf(source.bases.shapeOf(source.history, original.base), kBaseSamples),
                               samplesOf(source.bases.shapeOf(source.history, site.base), kOtherSamples),
                               {.mode = AlignmentMode::Whole});
    if (whole.verdict == AlignmentVerdict::Found) return along(whole, camera);
    reason = fmt::format("the base: {}; ", whole.reason);
  }
  const auto patch =
      retarget::alignSurfels(original.patch, surfelsBefore(site), {.mode = AlignmentMode::Patch});
  if (patch.verdict == AlignmentVerdict::Found) return along(patch, camera);
  return {camera, 1,
          fmt::format(
              "aligned: no motion is known, so the stroke is cast from its own camera ({}the patch around "
              "it: {})",
              reason, patch.reason)};
}

}  // namespace restroke::sculpt
