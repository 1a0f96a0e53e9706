// First crossing of a ray with the shape of a signed list, cell by cell along the ray.
//
// Method: along a ray every primitive is an interval, and what the shape is at t is said by the last interval
// (in list order) that holds t. From the start, the next place where that can change is the exit of this last
// interval, or the entry of a later one; we jump from event to event until outside turns inside.
//
// All grids that the ray meets are walked at once, so that only primitives near the ray's present stretch are
// looked at: a stretch ends where any grid's cell does. In float32, 16 balls at a time, most are found to lie
// beside the stretch; the rest are intersected in double, a vector at a time with the very operations of
// intersect(Sphere, Ray). Both go from the tail of a cell's list, and end at a primitive that holds the whole
// stretch, since nothing before it shows. The traversal is Amanatides and Woo, "A fast voxel traversal
// algorithm for ray tracing", Eurographics 1987.

#include "implicit/ray_cast.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "implicit/simd/ray_kernels.h"

namespace restroke::implicit {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A primitive along the ray.
struct Interval {
  double enter, exit;
  PrimitiveList::Label label;
  std::uint32_t slot;
  bool positive;

  [[nodiscard]] bool holds(double t) const { return enter <= t && t < exit; }
};

// What about a ray does not change along it.
struct RayNumbers {
  explicit RayNumbers(const Ray& ray)
      : dd(dot(ray.direction, ray.direction)),
        inverse(1 / ray.direction.x, 1 / ray.direction.y, 1 / ray.direction.z) {}

  double dd;      // squared length of the direction
  DVec3 inverse;  // infinite where the direction has no such component
};

// Parameters between which the ray is in the box; enter > exit when it misses. The box is widened a little.
RayInterval clip(const Ray& ray, const DVec3& inverse, const Box& box, double pad) {
  double enter = ray.tMin, exit = ray.tMax;
  for (int a = 0; a < 3; ++a) {
    const double o = ray.origin[a];
    const double lo = static_cast<double>(box.min[a]) - pad, hi = static_cast<double>(box.max[a]) + pad;
    if (ray.direction[a] == 0) {
      if (o < lo || o > hi) return {1, 0};
      continue;
    }
    const double t0 = (lo - o) * inverse[a], t1 = (hi - o) * inverse[a];
    enter = std::max(enter, std::min(t0, t1));
    exit = std::min(exit, std::max(t0, t1));
  }
  return {enter, exit};
}

[[nodiscard]] double sumOfMagnitudes(DVec3 a) {
  return std::fabs(a.x) + std::fabs(a.y) + std::fabs(a.z);
}

// One grid's cells along the ray. Before and after the stretch in which the grid has anything, all of the way
// is one empty cell.
class CellWalk {
 public:
  // False when the ray misses all that the grid has.
  bool start(const ClusterGrid& grid, const Ray& ray, const RayNumbers& numbers) {
    const RayInterval in = clip(ray, numbers.inverse, grid.hull(), 1e-4 * static_cast<double>(grid.cell()));
    if (!(in.enter < in.exit)) return false;
    grid_ = &grid;
    exit_ = in.exit;
    end_ = ray.tMax;
    cellStart_ = ray.tMin;
    cellEnd_ = in.enter;
    stepsLeft_ = kBefore;
    sparse_ = false;
    slots_ = {};
    if (!(in.enter > ray.tMin)) next(ray, numbers);
    return true;
  }

  [[nodiscard]] double cellStart() const { return cellStart_; }
  [[nodiscard]] double cellEnd() const { return cellEnd_; }
  // Where the ray leaves what the grid has.
  [[nodiscard]] double exit() const { return exit_; }
  [[nodiscard]] const ClusterGrid& grid() const { return *grid_; }
  // The present cell's list. When sparse, all of the grid's lists count instead.
  [[nodiscard]] std::span<const std::uint32_t> slots() const { return slots_; }
  [[nodiscard]] bool sparse() const { return sparse_; }
  [[nodiscard]] bool empty() const { return slots_.empty() && !sparse_; }

  void next(const Ray& ray, const RayNumbers& numbers) {
    cellStart_ = cellEnd_;
    if (stepsLeft_ == kBefore) {
      enterGrid(ray, numbers);
    } else {
      step(nearestFace());
    }
    if (stepsLeft_ <= 0 || !(cellStart_ < exit_)) {
      leave();
    } else if (sparse_) {
      stepsLeft_ = 1;
      cellEnd_ = exit_;
    } else {
      endCell();
      slots_ = grid_->at(cell_);
    }
  }

  // The same, and on through empty cells as long as they end no later than `limit`.
  void nextBeyondEmpty(const Ray& ray, const RayNumbers& numbers, double limit) {
    do next(ray, numbers);
    while (slots_.empty() && cellEnd_ <= limit && stepsLeft_ > 0 && !sparse_);
  }

  // Takes the following cells into the present one as long as they have the same few primitives: the base of
  // a model is large beside its cells.
  void widen() {
    constexpr std::size_t kFew = 8;
    constexpr int kCells = 8;
    for (int i = 0; i < kCells && stepsLeft_ > 1 && stepsLeft_ != kBefore && !sparse_ && cellEnd_ < exit_ &&
                    slots_.size() <= kFew;
         ++i) {
      const Cell before = cell_;
      const int a = nearestFace();
      index(a) += step_[a];
      const std::span<const std::uint32_t> ahead = grid_->at(cell_);
      cell_ = before;
      if (!std::equal(slots_.begin(), slots_.end(), ahead.begin(), ahead.end())) return;
      step(a);
      endCell();
      slots_ = ahead;
    }
  }

 private:
  static constexpr std::int64_t kBefore = std::numeric_limits<std::int64_t>::max();

  [[nodiscard]] std::int32_t& index(int axis) { return axis == 0 ? cell_.x : axis == 1 ? cell_.y : cell_.z; }
  [[nodiscard]] int nearestFace() const {
    return faces_[0] <= faces_[1] ? (faces_[0] <= faces_[2] ? 0 : 2) : (faces_[1] <= faces_[2] ? 1 : 2);
  }
  void step(int axis) {
    faces_[axis] += delta_[axis];
    index(axis) += step_[axis];
    --stepsLeft_;
  }
  void endCell() {
    cellEnd_ = std::min(std::max(std::min(faces_[0], std::min(faces_[1], faces_[2])), cellStart_), exit_);
  }
  void leave() {
    stepsLeft_ = 0;
    sparse_ = false;
    slots_ = {};
    cellEnd_ = end_;
  }

  void enterGrid(const Ray& ray, const RayNumbers& numbers) {
    const double size = static_cast<double>(grid_->cell());
    const DVec3& d = ray.direction;
    const double steps = (exit_ - cellStart_) * sumOfMagnitudes(d) / size;
    // So many cells on the way that it is quicker to look through all that are in use: small primitives far
    // apart.
    sparse_ = steps > 4 * static_cast<double>(grid_->usedCells());
    if (sparse_) return;
    // And a few more for rounding: where t has too few digits left to tell cells apart (an origin absurdly far
    // away), the walk still ends.
    stepsLeft_ = static_cast<std::int64_t>(steps) + 12;
    cell_ = grid_->cellAt(ray.at(cellStart_));
    for (int a = 0; a < 3; ++a) {
      step_[a] = d[a] > 0 ? 1 : -1;
      delta_[a] = size * std::fabs(numbers.inverse[a]);
      faces_[a] = d[a] == 0
                      ? kInfinity
                      : ((index(a) + (d[a] > 0 ? 1 : 0)) * size - ray.origin[a]) * numbers.inverse[a];
    }
  }

  const ClusterGrid* grid_;
  double exit_, end_;  // where the ray leaves what the grid has, and where it ends
  double cellStart_, cellEnd_;
  double faces_[3], delta_[3];  // parameters of the next faces, and between two
  std::int32_t step_[3];
  Cell cell_;
  std::int64_t stepsLeft_;
  bool sparse_;
  std::span<const std::uint32_t> slots_;
};

// Memory that one thread's rays use one after the other.
struct Scratch {
  CellWalk walks[Clusters::kGrids];
  std::vector<Interval> own[Clusters::kGrids];  // of each walk's cell, but the first's
  std::vector<Interval> coarse, active;
  std::vector<std::uint32_t> near;
  RayBatch batch;
  // Volumes that were intersected already, which costs more than looking here.
  struct Seen {
    std::uint32_t slot;
    std::size_t first, end;
  };
  std::vector<Seen> seen;
  std::vector<RayInterval> intervals;
};

class Cast {
 public:
  Cast(const PrimitiveList& list, const Ray& ray, Prefix prefix, Scratch& scratch)
      : list_(list),
        ray_(ray),
        numbers_(ray),
        kernels_(rayKernels()),
        end_(list.labelEnd(prefix)),
        s_(scratch),
        t_(ray.tMin) {}

  std::optional<RayHit> run() {
    // The operations of intersect(Sphere, Ray) find nothing either where this is not so.
    if (!(numbers_.dd > 0 && numbers_.dd < kInfinity)) return std::nullopt;
    for (const ClusterGrid& grid : list_.clusters().grids())
      if (grid.size() > 0 && s_.walks[walks_].start(grid, ray_, numbers_)) ++walks_;
    if (walks_ == 0) return std::nullopt;
    length_ = std::sqrt(numbers_.dd);
    unit_ = ray_.direction * (1 / length_);
    // More than double arithmetic loses on the way to where anything may be.
    loss_ = 0x1p-46 * sumOfMagnitudes(ray_.origin);
    s_.seen.clear();
    s_.intervals.clear();
    if (walks_ > 1) {
      for (std::size_t i = 1; i < walks_; ++i) fillOwn(i);
      gatherCoarse();
    } else {
      s_.coarse.clear();
      coarseEnd_ = ray_.tMax;
    }
    CellWalk& fine = s_.walks[0];
    while (!stretch(std::min(fine.cellEnd(), coarseEnd_))) {
      if (!(t_ < ray_.tMax)) return std::nullopt;
      if (coarseEnd_ <= t_) moveCoarse();
      while (fine.cellEnd() <= t_ && t_ < ray_.tMax) {
        fine.nextBeyondEmpty(ray_, numbers_, quietTo_);
        t_ = fine.empty() && fine.cellEnd() <= quietTo_ ? fine.cellEnd() : fine.cellStart();
      }
      if (!(t_ < ray_.tMax)) return std::nullopt;
    }
    return hit_;
  }

 private:
  // Goes on to parameter `to`, beyond which other cells know more. True when the hit was found.
  bool stretch(double to) {
    const CellWalk& fine = s_.walks[0];
    const std::vector<Interval>* active = &s_.coarse;
    if (!fine.empty()) {
      s_.active.clear();
      collect(fine, {t_, to}, s_.coarse, s_.active);
      active = &s_.active;
    }
    const Interval* owner = ownerAt(*active, t_);
    if (event(owner)) return true;
    for (;;) {
      const double next = nextEvent(*active, owner);
      if (!(next < to)) {
        quietTo_ = fine.empty() ? std::min(next, coarseEnd_) : -kInfinity;
        t_ = to;
        return false;
      }
      t_ = next;
      owner = ownerAt(*active, t_);
      if (event(owner)) return true;
    }
  }

  // The last primitive at t; null for none. Intervals stand last in the list first.
  [[nodiscard]] static const Interval* ownerAt(const std::vector<Interval>& active, double t) {
    for (const Interval& i : active)
      if (i.holds(t)) return &i;
    return nullptr;
  }

  // The first parameter after t_ where the last primitive changes from `owner`.
  [[nodiscard]] double nextEvent(const std::vector<Interval>& active, const Interval* owner) const {
    double next = owner ? owner->exit : kInfinity;
    const Interval* const end = owner ? owner : active.data() + active.size();
    for (const Interval* i = active.data(); i != end; ++i)
      if (i->enter > t_ && i->enter < next) next = i->enter;
    return next;
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

  // The coarser grids: of each, what its present cell adds, and all of them together.

  void fillOwn(std::size_t walk) {
    CellWalk& w = s_.walks[walk];
    s_.own[walk].clear();
    w.widen();
    if (!w.empty()) collect(w, {w.cellStart(), w.cellEnd()}, {}, s_.own[walk]);
  }

  void moveCoarse() {
    for (std::size_t i = 1; i < walks_; ++i) {
      CellWalk& w = s_.walks[i];
      if (w.cellEnd() > t_) continue;
      while (w.cellEnd() <= t_) w.next(ray_, numbers_);
      fillOwn(i);
    }
    gatherCoarse();
  }

  void gatherCoarse() {
    coarseEnd_ = ray_.tMax;
    quietTo_ = -kInfinity;
    s_.coarse.clear();
    std::size_t parts = 0;
    for (std::size_t i = 1; i < walks_; ++i) {
      coarseEnd_ = std::min(coarseEnd_, s_.walks[i].cellEnd());
      if (s_.own[i].empty()) continue;
      ++parts;
      s_.coarse.insert(s_.coarse.end(), s_.own[i].begin(), s_.own[i].end());
    }
    if (parts > 1)
      std::sort(s_.coarse.begin(), s_.coarse.end(), [](const Interval& a, const Interval& b) {
        return a.label != b.label ? a.label > b.label : a.enter < b.enter;
      });
  }

  // Appends to `out` what may own any of the stretch: of the walk's present cell and of `others`, last in the
  // list first.
  void collect(const CellWalk& walk, RayInterval along, std::span<const Interval> others,
               std::vector<Interval>& out) {
    Merge merge{along, others, out};
    if (walk.sparse())
      collectAll(walk.grid(), merge);
    else
      collect(walk.slots(), merge);
    if (!merge.covered) merge.takeOthers(0);
  }

  struct Merge {
    RayInterval along;
    std::span<const Interval> others;  // those not yet taken
    std::vector<Interval>& out;
    bool covered = false;  // all of the stretch is held by something taken: nothing before it shows

    void take(const Interval& i) {
      if (!(i.exit >= along.enter && i.enter <= along.exit)) return;
      out.push_back(i);
      covered = covered || (i.enter <= along.enter && i.exit > along.exit);
    }
    // Those after `label` in the list.
    void takeOthers(PrimitiveList::Label label) {
      while (!others.empty() && others.front().label > label && !covered) {
        take(others.front());
        others = others.subspan(1);
      }
    }
  };

  // The part of a cell's list that belongs to the prefix.
  [[nodiscard]] std::span<const std::uint32_t> inPrefix(std::span<const std::uint32_t> slots) const {
    if (end_ == std::numeric_limits<PrimitiveList::Label>::max()) return slots;
    const std::span<const PrimitiveList::Label> labels = list_.labels();
    if (slots.empty() || labels[slots.back()] < end_) return slots;
    const auto end = std::partition_point(slots.begin(), slots.end(),
                                          [&](std::uint32_t slot) { return labels[slot] < end_; });
    return {slots.begin(), end};
  }

  [[nodiscard]] RayStretch stretchOf(RayInterval along) const {
    const DVec3 middle = ray_.at(0.5 * (along.enter + along.exit));
    const double half = 0.5 * (along.exit - along.enter) * length_;
    const double size = sumOfMagnitudes(middle) + half;
    const auto f = [](double a) { return static_cast<float>(a); };
    return {f(middle.x),
            f(middle.y),
            f(middle.z),
            f(unit_.x),
            f(unit_.y),
            f(unit_.z),
            f(half),
            f(0x1p-19 * size + loss_)};
  }

  [[nodiscard]] const float* balls() const { return &list_.balls().data()->x; }

  void collect(std::span<const std::uint32_t> slots, Merge& merge) {
    slots = inPrefix(slots);
    const RayStretch stretch = stretchOf(merge.along);
    std::uint32_t near[RayBatch::kSize];
    while (!slots.empty() && !merge.covered) {
      const std::size_t n = std::min(slots.size(), RayBatch::kSize);
      const std::span<const std::uint32_t> last = slots.last(n);
      slots = slots.first(slots.size() - n);
      const std::size_t met = kernels_.meeting(stretch, balls(), last.data(), n, near);
      if (met > 0) intersectAll({near, met}, merge);
    }
  }

  void collectAll(const ClusterGrid& grid, Merge& merge) {
    const RayStretch stretch = stretchOf(merge.along);
    std::vector<std::uint32_t>& near = s_.near;
    near.clear();
    constexpr std::int32_t kFar = 2'100'000'000;  // beyond any cell
    grid.forListsBetween({-kFar, -kFar, -kFar}, {kFar, kFar, kFar}, [&](std::span<const std::uint32_t> slots) {
      slots = inPrefix(slots);
      const std::size_t before = near.size();
      near.resize(before + slots.size());
      near.resize(before + kernels_.meeting(stretch, balls(), slots.data(), slots.size(), near.data() + before));
    });
    std::sort(near.begin(), near.end(),
              [&](std::uint32_t a, std::uint32_t b) { return list_.labels()[a] > list_.labels()[b]; });
    near.erase(std::unique(near.begin(), near.end()), near.end());  // they are in several cells
    for (std::size_t i = 0; i < near.size() && !merge.covered; i += RayBatch::kSize)
      intersectAll({near.data() + i, std::min(RayBatch::kSize, near.size() - i)}, merge);
  }

  // At most RayBatch::kSize of them, last in the list first.
  void intersectAll(std::span<const std::uint32_t> slots, Merge& merge) {
    RayBatch& batch = s_.batch;
    for (std::size_t i = 0; i < slots.size(); ++i) {
      const Sphere& ball = list_[PrimitiveId{slots[i]}].shape.ball();
      batch.x[i] = static_cast<double>(ball.center.x);
      batch.y[i] = static_cast<double>(ball.center.y);
      batch.z[i] = static_cast<double>(ball.center.z);
      batch.r[i] = static_cast<double>(ball.radius);
    }
    const DVec3 &o = ray_.origin, &d = ray_.direction;
    kernels_.intersect({o.x, o.y, o.z, d.x, d.y, d.z, numbers_.dd}, batch, slots.size());
    for (std::size_t i = 0; i < slots.size() && !merge.covered; ++i) {
      if (!(batch.enter[i] <= batch.exit[i])) continue;  // it misses
      const Primitive& p = list_[PrimitiveId{slots[i]}];
      const PrimitiveList::Label label = list_.labels()[slots[i]];
      merge.takeOthers(label);
      if (merge.covered) return;
      Interval interval{batch.enter[i], batch.exit[i], label, slots[i], p.sign == Sign::Positive};
      if (p.shape.isSphere()) {
        merge.take(interval);
        continue;
      }
      for (const RayInterval& in : intervalsOf(slots[i], *p.shape.volume())) {
        interval.enter = in.enter;
        interval.exit = in.exit;
        merge.take(interval);
      }
    }
  }

  [[nodiscard]] std::span<const RayInterval> intervalsOf(std::uint32_t slot, const PosedVolume& volume) {
    for (const Scratch::Seen& seen : s_.seen)
      if (seen.slot == slot) return {s_.intervals.data() + seen.first, s_.intervals.data() + seen.end};
    const std::size_t first = s_.intervals.size();
    volume.intersect(ray_, s_.intervals);
    s_.seen.push_back({slot, first, s_.intervals.size()});
    return {s_.intervals.data() + first, s_.intervals.data() + s_.intervals.size()};
  }

  struct Previous {
    std::uint32_t slot = 0;
    bool positiveOrNone = true;
  };

  const PrimitiveList& list_;
  const Ray& ray_;
  const RayNumbers numbers_;
  double length_ = 0;  // of the direction
  DVec3 unit_{0};
  double loss_ = 0;
  const RayKernels& kernels_;
  PrimitiveList::Label end_;
  Scratch& s_;
  std::size_t walks_ = 0;  // how many grids the ray meets, finest first
  double t_;
  double coarseEnd_ = 0;  // where the first of the coarser grids' cells ends
  double quietTo_ = 0;    // as far as the finest grid's cells are empty, nothing changes up to here
  bool started_ = false, inside_ = false;
  Previous previous_;
  std::optional<RayHit> hit_;
};

}  // namespace

std::optional<RayHit> castRay(const PrimitiveList& list, const Ray& ray, Prefix prefix) {
  if (list.empty() || !(ray.tMin < ray.tMax)) return std::nullopt;
  thread_local Scratch scratch;
  return Cast(list, ray, prefix, scratch).run();
}

}  // namespace restroke::implicit
