#include "implicit/side.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "implicit/errors.h"
#include "implicit/near_balls.h"
#include "implicit/parallel.h"

namespace restroke::implicit {

Side sideOf(const PrimitiveList& list, Point p, Prefix prefix) {
  const PrimitiveList::Label end = list.labelEnd(prefix);
  const std::span<const PrimitiveList::Label> labels = list.labels();
  PrimitiveList::Label last = 0;  // label of the last primitive found that contains p
  Side side = Side::Outside;
  for (const ClusterGrid& grid : list.clusters().grids()) {
    if (grid.size() == 0) continue;
    const std::span<const std::uint32_t> slots = grid.at(grid.cellAt(DVec3(p)));
    auto it = slots.end();
    if (!slots.empty() && labels[slots.back()] >= end)
      it = std::partition_point(slots.begin(), slots.end(), [&](std::uint32_t s) { return labels[s] < end; });
    while (it != slots.begin()) {
      const std::uint32_t slot = *--it;
      if (labels[slot] < last) break;
      const Primitive& primitive = list[PrimitiveId{slot}];
      if (contains(primitive.shape, p)) {
        last = labels[slot];
        side = primitive.sign == Sign::Positive ? Side::Inside : Side::Outside;
        break;
      }
    }
  }
  return side;
}

namespace {

// Points that lie this close together (as a fraction of the cell size) share one gathering of the primitives
// around them.
constexpr float kShare = 2.0f;

void sidesOfGroup(const PrimitiveList& list, std::span<const Point> points, Side* sides, Prefix prefix) {
  Box box;
  bool finite = true;
  for (const Point p : points) {
    box.add({p, p});
    finite = finite && isFinite(p);
  }
  const float radius = box.halfDiagonal();
  const ClusterGrid& finest = list.clusters().grids()[list.clusters().finestInUse()];
  if (!finite || points.size() < 2 || radius > kShare * finest.cell()) {
    for (std::size_t i = 0; i < points.size(); ++i) sides[i] = sideOf(list, points[i], prefix);
    return;
  }
  thread_local NearBalls near;
  const Point c = box.center();
  const DropBall sphere{c.x, c.y, c.z, radius * 1.0001f + length(c) * 0x1p-20f, 0, nullptr};
  near.gather(list, sphere, list.labelEnd(prefix));
  float x[kPatch] = {}, y[kPatch] = {}, z[kPatch] = {};
  for (std::size_t i = 0; i < points.size(); ++i) {
    x[i] = points[i].x;
    y[i] = points[i].y;
    z[i] = points[i].z;
  }
  const std::uint32_t inside =
      ballKernels().insideLanes({x, y, z, (1u << points.size()) - 1, sphere}, near.arrays());
  for (std::size_t i = 0; i < points.size(); ++i)
    sides[i] = (inside >> i & 1) != 0 ? Side::Inside : Side::Outside;
}

}  // namespace

void sidesOf(const PrimitiveList& list, std::span<const Point> points, std::span<Side> sides, Prefix prefix,
             const Execution& execution) {
  RESTROKE_CHECK_EQ(points.size(), sides.size());
  const std::size_t groups = (points.size() + kPatch - 1) / kPatch;
  inArena(execution, [&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, groups, 64),
                      [&](const tbb::blocked_range<std::size_t>& r) {
                        for (std::size_t g = r.begin(); g < r.end(); ++g) {
                          const std::size_t first = g * kPatch, n = std::min(kPatch, points.size() - first);
                          sidesOfGroup(list, points.subspan(first, n), sides.data() + first, prefix);
                        }
                      });
  });
}

}  // namespace restroke::implicit
