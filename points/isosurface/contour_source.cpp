#include "points/isosurface/contour_source.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "implicit/errors.h"
#include "implicit/ray_cast.h"

namespace restroke::points {

namespace {

using implicit::PrimitiveId;
using implicit::PrimitiveList;
using implicit::RayHit;
using implicit::Side;

// The primitive that decides about p, as sideOf finds it; nothing where none contains p.
std::optional<PrimitiveId> deciderAt(const PrimitiveList& list, Point p, implicit::Prefix prefix) {
  const PrimitiveList::Label end = list.labelEnd(prefix);
  std::optional<PrimitiveId> decider;
  for (const implicit::ClusterGrid& grid : list.clusters().grids()) {
    if (grid.size() == 0) continue;
    for (const std::uint32_t slot : grid.at(grid.cellAt(DVec3(p)))) {
      const PrimitiveId id{slot};
      if (list.labelOf(id) < end && contains(list[id].shape, p) &&
          (!decider || list.labelOf(*decider) < list.labelOf(id)))
        decider = id;
    }
  }
  return decider;
}

double largestCoordinate(Point p) {
  return static_cast<double>(std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}));
}

}  // namespace

void ListSource::sides(std::span<const Point> points, std::span<Side> sides) const {
  implicit::sidesOf(list_, points, sides, prefix_, {.threads = 1});
}

Crossing ListSource::crossing(Point inside, Point outside) const {
  const DVec3 from(outside), along = DVec3(inside) - from;
  // The float32 tests at the ends may be wrong by some units in the last place; the ray looks that far
  // beyond.
  const double slack =
      0x1p-20 * std::max(largestCoordinate(inside), largestCoordinate(outside)) / length(along);
  Ray ray{from, along, -slack, 1 + slack};
  std::optional<RayHit> last;
  // Each hit is an entry; the last one is the nearest to the inside end. A segment that crosses the surface
  // more often than this is not resolved by the grid in any way.
  constexpr int kMostEntries = 64;
  for (int i = 0; i < kMostEntries; ++i) {
    const std::optional<RayHit> hit = implicit::castRay(list_, ray, prefix_);
    if (!hit) break;
    last = hit;
    ray.tMin = hit->t;
  }
  if (!last) return bisect(inside, outside);
  return {ray.at(std::clamp(last->t, 0.0, 1.0)), last->normal};
}

Crossing ListSource::bisect(Point inside, Point outside) const {
  // Until float32 has no point between the two.
  Point in = inside, out = outside;
  for (;;) {
    const Point middle(Point((DVec3(in) + DVec3(out)) * 0.5));
    if (middle == in || middle == out) break;
    (sideOf(list_, middle, prefix_) == Side::Inside ? in : out) = middle;
  }
  // Outside, either a carving decides that does not reach the inside point: then the surface is its. Or the
  // boundary is that of what decides inside.
  const std::optional<PrimitiveId> inner = deciderAt(list_, in, prefix_);
  const std::optional<PrimitiveId> outer = deciderAt(list_, out, prefix_);
  const DVec3 position(in);
  if (outer && !contains(list_[*outer].shape, in))
    return {position, -outwardNormal(list_[*outer].shape, position)};
  RESTROKE_CHECK_EQ(inner.has_value(), true);
  return {position, outwardNormal(list_[*inner].shape, position)};
}

}  // namespace restroke::points
