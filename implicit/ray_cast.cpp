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
// stretch, since nothing before it shows.

#include "implicit/ray_cast.h"

#include <algorithm>
#include <bit>
#include <vector>

#include "implicit/cell_walk.h"
#include "implicit/simd/ray_kernels.h"

namespace restroke::implicit {

namespace {

// A primitive along the ray.
struct Interval {
  double enter, exit;
  std::uint32_t slot;
  bool positive;
};

// Intervals, last in the list first. A vector whose appending asks for room once for many.
class Intervals {
 public:
  [[nodiscard]] const Interval* begin() const { return data_.data(); }
  [[nodiscard]] const Interval* end() const { return data_.data() + size_; }
  [[nodiscard]] Interval* begin() { return data_.data(); }
  [[nodiscard]] Interval* end() { return data_.data() + size_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  void clear() { size_ = 0; }
  // Room for so many more: where they go.
  [[nodiscard]] Interval* room(std::size_t count) {
    if (size_ + count > data_.size()) data_.resize(2 * (size_ + count));
    return data_.data() + size_;
  }
  // What was written there up to `end` counts from now on.
  void endAt(const Interval* end) { size_ = static_cast<std::size_t>(end - data_.data()); }
  void append(const Intervals& other) { endAt(std::copy(other.begin(), other.end(), room(other.size()))); }

 private:
  std::vector<Interval> data_;
  std::size_t size_ = 0;
};

// Memory that one thread's rays use one after the other.
struct Scratch {
  CellWalk walks[Clusters::kGrids];
  // Of the coarser grids: what each walk's cell has, and all together.
  Intervals own[Clusters::kGrids];
  std::span<const std::uint32_t> ownSlots[Clusters::kGrids];
  Intervals coarse;
  Intervals active;  // of the finest grid's cell and the others
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
        kernels_(rayKernels()),
        end_(list.labelEnd(prefix)),
        cuts_(prefix.count < list.size()),
        s_(scratch),
        t_(ray.tMin) {}

  std::optional<RayHit> run() {
    const DVec3 &o = ray_.origin, &d = ray_.direction;
    const double dd = dot(d, d);
    // The operations of intersect(Sphere, Ray) find nothing either where this is not so.
    if (!(dd > 0 && dd < kRayInfinity)) return std::nullopt;
    const RayAxes axes(ray_);
    for (const ClusterGrid& grid : list_.clusters().grids())
      if (grid.size() > 0 && s_.walks[walks_].start(grid, ray_, axes)) ++walks_;
    if (walks_ == 0) return std::nullopt;
    line_ = {o.x, o.y, o.z, d.x, d.y, d.z, dd};
    length_ = std::sqrt(dd);
    const DVec3 unit = d * (1 / length_);
    stretch_.dx = static_cast<float>(unit.x);
    stretch_.dy = static_cast<float>(unit.y);
    stretch_.dz = static_cast<float>(unit.z);
    // More than double arithmetic loses on the way to where anything may be.
    loss_ = static_cast<float>(0x1p-46 * sumOfMagnitudes(o));
    s_.seen.clear();
    s_.intervals.clear();
    return walk();
  }

 private:
  std::optional<RayHit> walk() {
    CellWalk& fine = s_.walks[0];
    for (std::size_t i = 1; i < walks_; ++i) fillOwn(i);
    gatherCoarse();
    arrive();
    while (!stretch(std::min(fine.cellEnd(), coarseEnd_))) {
      // On through cells that add nothing, as long as nothing changes.
      do {
        if (!(t_ < ray_.tMax)) return std::nullopt;
        if (coarseEnd_ <= t_) moveCoarse();
        if (fine.cellEnd() <= t_) {
          fine.next(quietTo_);
          t_ = std::max(t_, fine.cellStart());
        }
        arrive();
      } while (quiet_ && fine.cellEnd() <= quietTo_ && (t_ = fine.cellEnd(), true));
    }
    return hit_;
  }

  // Takes up what the finest grid's present cell has.
  void arrive() {
    const CellWalk& fine = s_.walks[0];
    s_.active.clear();
    if (fine.sparse() || !fine.slots().empty()) collect(fine, fine.stretch(), s_.active);
    quiet_ = s_.active.empty();
    if (quiet_ || s_.coarse.empty()) return;
    const bool ordered = labelOf(*s_.coarse.begin()) < labelOf(*(s_.active.end() - 1));
    s_.active.append(s_.coarse);
    if (!ordered) order(s_.active);
  }

  [[nodiscard]] PrimitiveList::Label labelOf(const Interval& i) const { return list_.labels()[i.slot]; }

  // Not often needed, and long: out of the way of what is.
  [[gnu::noinline]] void order(Intervals& intervals) const {
    std::sort(intervals.begin(), intervals.end(),
              [&](const Interval& a, const Interval& b) { return labelOf(a) > labelOf(b); });
  }

  // Goes on to parameter `to`, beyond which other cells know more. True when the hit was found.
  bool stretch(double to) {
    const Intervals& active = quiet_ ? s_.coarse : s_.active;
    for (;;) {
      const Outlook at = look(active, t_);
      if (event(at.owner)) return true;
      if (!(at.next < to)) {
        next_ = at.next;
        settle();
        t_ = to;
        return false;
      }
      t_ = at.next;
    }
  }

  struct Outlook {
    const Interval* owner;  // the last primitive at t; null for none
    double next;            // the first parameter after t where that changes
  };
  [[nodiscard]] static Outlook look(const Intervals& active, double t) {
    double next = kRayInfinity;
    for (const Interval& i : active) {
      if (i.enter > t) {
        next = std::min(next, i.enter);
      } else if (t < i.exit) {
        return {&i, std::min(next, i.exit)};
      }
    }
    return {nullptr, next};
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

  // The coarser grids.

  // Of one coarser grid: those are all.
  [[nodiscard]] Intervals& ownOf(std::size_t i) { return walks_ == 2 ? s_.coarse : s_.own[i]; }

  void fillOwn(std::size_t i) {
    const CellWalk& w = s_.walks[i];
    Intervals& own = ownOf(i);
    own.clear();
    s_.ownSlots[i] = w.slots();
    // A few are looked for all along the way: the next cell may well have the same ones, since the base of a
    // model is large beside its cells.
    RayInterval along = w.stretch();
    if (w.slots().size() <= kFew) along.exit = w.exit();
    if (w.sparse() || !w.slots().empty()) collect(w, along, own);
  }

  void moveCoarse() {
    bool same = true;
    for (std::size_t i = 1; i < walks_; ++i) {
      CellWalk& w = s_.walks[i];
      if (w.cellEnd() > t_) continue;
      while (w.cellEnd() <= t_) w.next();
      if (w.slots().size() <= kFew && CellWalk::sameSlots(w.slots(), s_.ownSlots[i])) {
        w.widen(kFew);
      } else {
        fillOwn(i);
        same = false;
      }
    }
    if (!same) {
      gatherCoarse();
      return;
    }
    endCoarse();
    settle();
  }

  // What the last look has found holds as long as nothing is added.
  void settle() { quietTo_ = quiet_ ? std::min(next_, coarseEnd_) : -kRayInfinity; }

  void endCoarse() {
    coarseEnd_ = ray_.tMax;
    quietTo_ = -kRayInfinity;
    for (std::size_t i = 1; i < walks_; ++i) coarseEnd_ = std::min(coarseEnd_, s_.walks[i].cellEnd());
  }

  void gatherCoarse() {
    endCoarse();
    if (walks_ == 2) return;
    s_.coarse.clear();
    for (std::size_t i = 1; i < walks_; ++i) s_.coarse.append(s_.own[i]);
    order(s_.coarse);
  }

  // What lies along a stretch.

  // The part of a long list that belongs to the prefix. A short one is taken whole: where primitives are
  // looked at one by one, those after the prefix are passed over.
  [[nodiscard]] std::span<const std::uint32_t> cut(std::span<const std::uint32_t> slots) const {
    if (!cuts_ || slots.size() <= RayBatch::kSize || inPrefix(slots.back())) return slots;
    const auto end =
        std::partition_point(slots.begin(), slots.end(), [&](std::uint32_t slot) { return inPrefix(slot); });
    return {slots.begin(), end};
  }
  [[nodiscard]] bool inPrefix(std::uint32_t slot) const { return list_.labels()[slot] < end_; }

  void aim(RayInterval along) {
    const DVec3 middle = ray_.at(0.5 * (along.enter + along.exit));
    stretch_.x = static_cast<float>(middle.x);
    stretch_.y = static_cast<float>(middle.y);
    stretch_.z = static_cast<float>(middle.z);
    stretch_.half = static_cast<float>(0.5 * (along.exit - along.enter) * length_);
    stretch_.pad =
        0x1p-19f * (std::fabs(stretch_.x) + std::fabs(stretch_.y) + std::fabs(stretch_.z) + stretch_.half) +
        loss_;
  }

  // Appends to `out` what may own any of the stretch, last in the list first: of the walk's present cell.
  void collect(const CellWalk& walk, RayInterval along, Intervals& out) {
    if (walk.sparse()) {
      collectAll(walk.grid(), along, out);
      return;
    }
    std::span<const std::uint32_t> slots = cut(walk.slots());
    if (slots.size() <= kFew / 2) {  // quicker than to ask which
      for (std::size_t i = slots.size(); i-- > 0;)
        if ((!cuts_ || inPrefix(slots[i])) && intersectOne(slots[i], along, out)) return;
      return;
    }
    aim(along);
    const float* balls = &list_.balls().data()->center.x;
    bool covered = false;
    while (!slots.empty() && !covered) {
      const std::size_t n = std::min(slots.size(), RayBatch::kSize);
      const std::span<const std::uint32_t> last = slots.last(n);
      slots = slots.first(slots.size() - n);
      if (const std::uint64_t met = kernels_.meeting(stretch_, balls, last.data(), n); met != 0)
        covered = intersectAll(last, met, along, out);
    }
  }

  [[gnu::noinline]] void collectAll(const ClusterGrid& grid, RayInterval along, Intervals& out) {
    aim(along);
    const float* balls = &list_.balls().data()->center.x;
    std::vector<std::uint32_t>& near = s_.near;
    near.clear();
    constexpr std::int32_t kFar = 2'100'000'000;  // beyond any cell
    grid.forListsBetween({-kFar, -kFar, -kFar}, {kFar, kFar, kFar},
                         [&](std::span<const std::uint32_t> slots) {
                           slots = cut(slots);
                           for (std::size_t i = 0; i < slots.size(); i += RayBatch::kSize) {
                             const std::size_t n = std::min(RayBatch::kSize, slots.size() - i);
                             for (std::uint64_t met = kernels_.meeting(stretch_, balls, slots.data() + i, n);
                                  met != 0; met &= met - 1)
                               near.push_back(slots[i + static_cast<std::size_t>(std::countr_zero(met))]);
                           }
                         });
    std::sort(near.begin(), near.end(),
              [&](std::uint32_t a, std::uint32_t b) { return list_.labels()[a] < list_.labels()[b]; });
    near.erase(std::unique(near.begin(), near.end()), near.end());  // they are in several cells
    bool covered = false;
    for (std::size_t left = near.size(); left > 0 && !covered;) {
      const std::size_t n = std::min(RayBatch::kSize, left);
      left -= n;
      covered = intersectAll({near.data() + left, n}, ~std::uint64_t{0} >> (RayBatch::kSize - n), along, out);
    }
  }

  // The same for those of the slots (at most RayBatch::kSize, in list order) whose bit is set. True when one
  // of them holds all of the stretch: nothing before it shows.
  bool intersectAll(std::span<const std::uint32_t> slots, std::uint64_t bits, RayInterval along,
                    Intervals& out) {
    RayBatch& batch = s_.batch;
    std::uint32_t met[RayBatch::kSize];
    std::size_t n = 0;
    while (bits != 0) {
      const int top = 63 - std::countl_zero(bits);
      bits ^= std::uint64_t{1} << top;
      const std::uint32_t slot = slots[static_cast<std::size_t>(top)];
      if (cuts_ && !inPrefix(slot)) continue;
      const Sphere& ball = list_.balls()[slot];
      met[n] = slot;
      batch.x[n] = static_cast<double>(ball.center.x);
      batch.y[n] = static_cast<double>(ball.center.y);
      batch.z[n] = static_cast<double>(ball.center.z);
      batch.r[n] = static_cast<double>(ball.radius);
      ++n;
    }
    kernels_.intersect(line_, batch, n);
    Interval* to = out.room(n);
    bool covered = false;
    for (std::size_t i = 0; i < n && !covered; ++i) {
      *to = {batch.enter[i], batch.exit[i], met[i], list_.isPositive(met[i])};
      const PosedVolume* volume = list_.volumeIn(met[i]);
      if (!volume) {
        covered = holdsAll(*to, along);
        to += meets(*to, along) ? 1 : 0;
      } else if (to->enter <= to->exit) {  // the line meets the ball around it
        out.endAt(to);
        covered = addVolume(*volume, *to, along, out);
        to = out.room(n - i);
      }
    }
    out.endAt(to);
    return covered;
  }

  // The same for one.
  bool intersectOne(std::uint32_t slot, RayInterval along, Intervals& out) {
    const std::optional<RayInterval> in = intersect(list_.balls()[slot], ray_);
    if (!in) return false;
    const Interval interval{in->enter, in->exit, slot, list_.isPositive(slot)};
    if (const PosedVolume* volume = list_.volumeIn(slot)) return addVolume(*volume, interval, along, out);
    return append(interval, along, out);
  }

  [[gnu::noinline]] bool addVolume(const PosedVolume& volume, Interval interval, RayInterval along,
                                   Intervals& out) {
    bool covered = false;
    for (const RayInterval& in : intervalsOf(interval.slot, volume)) {
      interval.enter = in.enter;
      interval.exit = in.exit;
      covered = append(interval, along, out) || covered;
    }
    return covered;
  }

  static bool append(const Interval& i, RayInterval along, Intervals& out) {
    Interval* to = out.room(1);
    *to = i;
    out.endAt(to + (meets(i, along) ? 1 : 0));
    return holdsAll(i, along);
  }

  static bool meets(const Interval& i, RayInterval along) {
    return (i.exit >= along.enter) & (i.enter <= along.exit);
  }
  static bool holdsAll(const Interval& i, RayInterval along) {
    return (i.enter <= along.enter) & (i.exit > along.exit);
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

  // Lists as short as this are dealt with at once.
  static constexpr std::size_t kFew = 8;

  const PrimitiveList& list_;
  const Ray& ray_;
  const RayKernels& kernels_;
  PrimitiveList::Label end_;
  bool cuts_;  // something is after the prefix
  Scratch& s_;
  std::size_t walks_ = 0;  // how many grids the ray meets, finest first
  RayLine line_;
  RayStretch stretch_;
  double length_;  // of the direction
  float loss_;
  double t_;
  double coarseEnd_;    // where the first of the coarser grids' cells ends
  bool quiet_ = false;  // the finest grid's present cell adds nothing
  double quietTo_;      // while that is so, nothing changes up to here
  double next_;         // the next place where something changes, as far as was looked
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
