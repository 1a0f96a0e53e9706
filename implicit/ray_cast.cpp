// First crossing of a ray with the shape of a signed list, cell by cell along the ray.
//
// Method: along a ray every primitive is an interval, and what the shape is at t is said by the last interval
// (in list order) that holds t. From the start, the next place where that can change is the exit of this last
// interval, or the entry of a later one; we jump from event to event until outside turns inside. The walk
// visits the cells of the finest grid in order, so that only primitives near the ray's present stretch are
// intersected; the few of the coarser grids are intersected once. The traversal is Amanatides and Woo, "A
// fast voxel traversal algorithm for ray tracing", Eurographics 1987.

#include "implicit/ray_cast.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <vector>

namespace restroke::implicit {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Interval {
  double enter, exit;
  PrimitiveList::Label label;
  std::uint32_t slot;
  bool positive;
};

// Parameters between which the ray is in the box; enter > exit when it misses. The box is widened a little.
RayInterval clip(const Ray& ray, const Box& box, double pad) {
  double enter = -kInfinity, exit = kInfinity;
  for (int a = 0; a < 3; ++a) {
    const double o = ray.origin[a], d = ray.direction[a];
    const double lo = static_cast<double>(box.min[a]) - pad, hi = static_cast<double>(box.max[a]) + pad;
    if (d == 0) {
      if (o < lo || o > hi) return {1, 0};
      continue;
    }
    const double t0 = (lo - o) / d, t1 = (hi - o) / d;
    enter = std::max(enter, std::min(t0, t1));
    exit = std::min(exit, std::max(t0, t1));
  }
  return {enter, exit};
}

// Calls visit(cell, tIn, tOut) for the grid's cells along the ray between the parameters, until it returns
// true.
template <class F>
void walkCells(const ClusterGrid& grid, const Ray& ray, double tIn, double tOut, const F& visit) {
  const double size = static_cast<double>(grid.cell());
  Cell cell = grid.cellAt(ray.at(tIn));
  const Cell last = grid.cellAt(ray.at(tOut));
  // The number of faces between the first and the last cell, and a few more for rounding: where t has too few
  // digits left to tell cells apart (an origin absurdly far away), the walk still ends.
  std::int64_t stepsLeft = 8 + std::llabs(std::int64_t{last.x} - cell.x) +
                           std::llabs(std::int64_t{last.y} - cell.y) +
                           std::llabs(std::int64_t{last.z} - cell.z);
  std::int32_t* index[3] = {&cell.x, &cell.y, &cell.z};
  double next[3], delta[3];
  std::int32_t step[3];
  for (int a = 0; a < 3; ++a) {
    const double o = ray.origin[a], d = ray.direction[a];
    step[a] = d > 0 ? 1 : -1;
    delta[a] = d == 0 ? kInfinity : size / std::fabs(d);
    next[a] = d == 0 ? kInfinity : ((*index[a] + (d > 0 ? 1 : 0)) * size - o) / d;
  }
  double t = tIn;
  while (t < tOut && stepsLeft-- > 0) {
    const int a = next[0] <= next[1] ? (next[0] <= next[2] ? 0 : 2) : (next[1] <= next[2] ? 1 : 2);
    const double out = std::min(std::max(next[a], t), tOut);
    if (visit(cell, t, out)) return;
    t = out;
    next[a] += delta[a];
    *index[a] += step[a];
  }
}

// Whether there are so many cells on the way that it is quicker to look through all that are in use: small
// primitives far apart.
bool isSparse(const ClusterGrid& grid, const Ray& ray, double tIn, double tOut) {
  const Cell first = grid.cellAt(ray.at(tIn)), last = grid.cellAt(ray.at(tOut));
  const double steps = std::fabs(static_cast<double>(last.x) - first.x) +
                       std::fabs(static_cast<double>(last.y) - first.y) +
                       std::fabs(static_cast<double>(last.z) - first.z);
  return steps > 4 * static_cast<double>(grid.usedCells());
}

// Memory that one thread's rays use one after the other.
struct Scratch {
  std::vector<Interval> coarse, active;
  std::vector<RayInterval> intervals;
};

class Walk {
 public:
  Walk(const PrimitiveList& list, const Ray& ray, Prefix prefix, Scratch& scratch)
      : list_(list),
        ray_(ray),
        end_(list.labelEnd(prefix)),
        t_(ray.tMin),
        coarse_(scratch.coarse),
        active_(scratch.active),
        intervals_(scratch.intervals) {
    coarse_.clear();
  }

  std::optional<RayHit> run() {
    const std::vector<ClusterGrid>& grids = list_.clusters().grids();
    const std::size_t finest = list_.clusters().finestInUse();
    const RayInterval fineStretch = stretchIn(grids[finest]);
    const bool fineIsCoarse = fineStretch.enter < fineStretch.exit &&
                              isSparse(grids[finest], ray_, fineStretch.enter, fineStretch.exit);
    for (std::size_t g = fineIsCoarse ? finest : finest + 1; g < grids.size(); ++g) collectCoarse(grids[g]);
    std::sort(coarse_.begin(), coarse_.end(), [](const Interval& a, const Interval& b) {
      return a.label != b.label ? a.label < b.label : a.enter < b.enter;
    });
    coarse_.erase(std::unique(coarse_.begin(), coarse_.end(),
                              [](const Interval& a, const Interval& b) {
                                return a.label == b.label && a.enter == b.enter;
                              }),
                  coarse_.end());
    double tStart = ray_.tMin, tEnd = ray_.tMin;
    const ClusterGrid& fine = grids[finest];
    if (!fineIsCoarse && fineStretch.enter < fineStretch.exit) {
      tStart = fineStretch.enter;
      tEnd = fineStretch.exit;
    }
    // Before, in and after the fine grid's extent.
    if (tStart > ray_.tMin && stretch({}, tStart)) return hit_;
    if (tEnd > tStart)
      walkCells(fine, ray_, tStart, tEnd, [&](Cell cell, double, double out) {
        const std::span<const std::uint32_t> slots = fine.at(cell);
        return stretch(slots, out);
      });
    if (!hit_ && t_ < ray_.tMax) stretch({}, ray_.tMax);
    return hit_;
  }

 private:
  void add(std::uint32_t slot, std::vector<Interval>& to) const {
    const PrimitiveList::Label label = list_.labels()[slot];
    const Primitive& p = list_[PrimitiveId{slot}];
    const bool positive = p.sign == Sign::Positive;
    if (p.shape.isSphere()) {
      if (const auto in = intersect(p.shape.ball(), ray_))
        to.push_back({in->enter, in->exit, label, slot, positive});
      return;
    }
    // The ball around it is asked first: most rays miss.
    if (!intersect(p.shape.ball(), ray_)) return;
    intervals_.clear();
    p.shape.volume()->intersect(ray_, intervals_);
    for (const RayInterval& in : intervals_) to.push_back({in.enter, in.exit, label, slot, positive});
  }

  // Between which parameters the ray is where the grid has anything; empty where it is not.
  [[nodiscard]] RayInterval stretchIn(const ClusterGrid& grid) const {
    if (grid.size() == 0) return {0, 0};
    const RayInterval in = clip(ray_, grid.hull(), 1e-4 * static_cast<double>(grid.cell()));
    return {std::max(in.enter, ray_.tMin), std::min(in.exit, ray_.tMax)};
  }

  void collectCoarse(const ClusterGrid& grid) {
    const RayInterval in = stretchIn(grid);
    if (!(in.enter < in.exit)) return;
    const auto addAll = [&](std::span<const std::uint32_t> slots) {
      for (const std::uint32_t slot : slots) {
        if (list_.labels()[slot] >= end_) break;
        add(slot, coarse_);
      }
    };
    if (isSparse(grid, ray_, in.enter, in.exit)) {
      constexpr std::int32_t kFar = 2'100'000'000;  // beyond any cell
      grid.forListsBetween({-kFar, -kFar, -kFar}, {kFar, kFar, kFar}, addAll);
      return;
    }
    walkCells(grid, ray_, in.enter, in.exit, [&](Cell cell, double, double) {
      addAll(grid.at(cell));
      return false;
    });
  }

  // The last primitive at t; an interval holds its entry and not its exit. Null for none.
  [[nodiscard]] const Interval* ownerAt(double t) const {
    const Interval* owner = nullptr;
    for (const Interval& i : active_)
      if (i.enter <= t && t < i.exit && (!owner || i.label > owner->label)) owner = &i;
    return owner;
  }

  // Goes on to parameter `to`, beyond which other cells know more. True when the hit was found.
  bool stretch(std::span<const std::uint32_t> slots, double to) {
    active_.clear();
    for (const Interval& i : coarse_)
      if (i.exit >= t_ && i.enter <= to) active_.push_back(i);
    for (const std::uint32_t slot : slots) {
      if (list_.labels()[slot] >= end_) break;
      add(slot, active_);
    }
    const Interval* owner = ownerAt(t_);
    if (event(owner)) return true;
    for (;;) {
      double next = owner ? owner->exit : kInfinity;
      for (const Interval& i : active_)
        if (i.enter > t_ && i.enter < next && (!owner || i.label > owner->label)) next = i.enter;
      if (!(next < to)) break;
      t_ = next;
      owner = ownerAt(t_);
      if (event(owner)) return true;
    }
    t_ = to;
    return false;
  }

  // Takes the state at t_; true when it has turned from outside to inside there.
  bool event(const Interval* owner) {
    const bool inside = owner && owner->positive;
    const bool crossed = started_ && inside && !inside_;
    if (crossed) {
      // Either the owner begins here, or a carving that hid it ends here: then that one's boundary is the
      // surface.
      const bool uncovered = !previous_.positiveOrNone && owner->enter != t_;
      RayHit hit;
      hit.t = t_;
      hit.position = ray_.at(t_);
      const std::uint32_t slot = uncovered ? previous_.slot : owner->slot;
      const DVec3 normal = outwardNormal(list_[PrimitiveId{slot}].shape, hit.position);
      hit.normal = uncovered ? -normal : normal;
      hit.primitive = PrimitiveId{slot};
      hit_ = hit;
    }
    started_ = true;
    inside_ = inside;
    previous_ = {owner ? owner->slot : 0, !owner || owner->positive};
    return crossed;
  }

  struct Previous {
    std::uint32_t slot = 0;
    bool positiveOrNone = true;
  };

  const PrimitiveList& list_;
  const Ray& ray_;
  PrimitiveList::Label end_;
  double t_;
  bool started_ = false, inside_ = false;
  Previous previous_;
  std::vector<Interval>&coarse_, &active_;
  std::vector<RayInterval>& intervals_;
  std::optional<RayHit> hit_;
};

}  // namespace

std::optional<RayHit> castRay(const PrimitiveList& list, const Ray& ray, Prefix prefix) {
  if (list.empty() || !(ray.tMin < ray.tMax)) return std::nullopt;
  thread_local Scratch scratch;
  return Walk(list, ray, prefix, scratch).run();
}

}  // namespace restroke::implicit
