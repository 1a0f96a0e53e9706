#include "points/dexel/refine/hidden_operations.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "implicit/clusters.h"
#include "implicit/parallel.h"
#include "points/dexel/refine/history.h"

namespace restroke::points {

namespace {

using implicit::Primitive;
using implicit::Shape;
using implicit::Sign;
using implicit::Sphere;

constexpr double kBallMargin = 0x1p-18, kVolumeMargin = 0x1p-16;
// Eighths of eighths ...: a part of the solid that is a sixteenth of it is covered by one operation, or the
// solid counts as not covered.
constexpr int kDeepest = 4;
// Intersections that are asked whether they hide something; they are few.
constexpr std::size_t kMostIntersections = 8;
// Of those that touch a cell so many are asked, where very many lie on each other.
constexpr std::size_t kMostAsked = 1024;
// Questions whether one operation decides one part, for all parts of an operation; what takes more counts as
// not covered.
constexpr std::size_t kMostQuestions = std::size_t{1} << 15;

double farthest(const Box& box) {
  double most = 0;
  for (int a = 0; a < 3; ++a)
    most = std::max(
        {most, std::fabs(static_cast<double>(box.min[a])), std::fabs(static_cast<double>(box.max[a]))});
  return most;
}

// All there is, in order: the initial solid's primitives, then the operations.
class Steps {
 public:
  explicit Steps(const TriDexelDocument& document) {
    const DexelGrid& grid = document.model.grid();
    for (int a = 0; a < 3; ++a) {
      const int last = grid.counts()[static_cast<std::size_t>(a)];
      reach_ = std::max({reach_, std::fabs(static_cast<double>(grid.at(a, 0))),
                         std::fabs(static_cast<double>(grid.at(a, last)))});
    }
    const std::size_t count = document.operations.size();
    if (const auto* mesh = std::get_if<TriangleMesh>(&document.initial))
      add(DexelOperation::Union, nullptr, boundsOf(*mesh));
    if (const auto* primitives = std::get_if<std::vector<Primitive>>(&document.initial))
      for (const Primitive& primitive : *primitives)
        add(primitive.sign == Sign::Positive ? DexelOperation::Union : DexelOperation::Subtraction,
            &primitive.shape, boundsOf(primitive.shape));
    first_ = operations_.size();
    // Whatever is no shape is posed, or swept, by the history.
    std::optional<DexelHistory> history;
    for (std::size_t i = 0; i < count; ++i) {
      const TriDexelDocument::Operation& operation = document.operations[i];
      if (const auto* shape = std::get_if<Shape>(&operation.tool)) {
        add(operation.operation, shape, boundsOf(*shape));
        continue;
      }
      if (!history) history.emplace(document);
      std::vector<HistoryStep> steps;
      history->stepsOf(static_cast<OperationId>(i + 1), steps);
      add(operation.operation, nullptr, steps.front().solid->bounds());
    }
  }

  [[nodiscard]] std::size_t size() const { return operations_.size(); }
  /// Of the first operation.
  [[nodiscard]] std::size_t first() const { return first_; }
  [[nodiscard]] DexelOperation operation(std::size_t i) const { return operations_[i]; }
  [[nodiscard]] const Box& box(std::size_t i) const { return boxes_[i]; }
  /// Holds the solid.
  [[nodiscard]] const Sphere& ball(std::size_t i) const { return balls_[i]; }
  [[nodiscard]] implicit::ClusterMembers members() const { return {labels_, balls_, isBall_}; }
  [[nodiscard]] float medianRadius() const {
    std::vector<float> radii;
    for (std::size_t i = 0; i < size(); i += 1 + size() / 1024) radii.push_back(balls_[i].radius);
    if (radii.empty()) return 1;
    const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
    std::nth_element(radii.begin(), middle, radii.end());
    return *middle > 0 ? *middle : 1;
  }

  /// Is the closed ball within what step i decides, with room to spare?
  [[nodiscard]] bool decides(std::size_t i, DVec3 center, double radius) const {
    const Shape* const shape = shapes_[i];
    if (!shape) return false;
    const bool outside = operations_[i] == DexelOperation::Intersection;
    if (shape->isSphere()) {
      const Sphere& own = balls_[i];
      const DVec3 d = center - DVec3(own.center);
      const double room = outside ? static_cast<double>(own.radius) + margins_[i] + radius
                                  : static_cast<double>(own.radius) - margins_[i] - radius;
      const double squared = d.x * d.x + d.y * d.y + d.z * d.z;
      return outside ? squared >= room * room : room >= 0 && squared <= room * room;
    }
    const implicit::PosedVolume& volume = *shape->volume();
    const double clearance =
        volume.volume().clearance(volume.toLocal(center)) * static_cast<double>(volume.pose().scale);
    return outside ? clearance >= radius + margins_[i] : clearance <= -radius - margins_[i];
  }
  /// Is what ball k has in a cube within what step i decides? Of a ball i with centre c and radius R: for p
  /// in ball k, with centre a and radius r, |p - c|^2 <= r^2 + 2 (p - a)(a - c) + |a - c|^2, the middle one
  /// of which is linear in p. So balls that are nearly the same decide half of each other's rim, each.
  [[nodiscard]] bool decidesPart(std::size_t i, std::size_t k, DVec3 center, double half) const {
    if (decides(i, center, half * 1.7320508075688774)) return true;
    if (isBall_[i] == 0 || operations_[i] == DexelOperation::Intersection) return false;
    const DVec3 a(balls_[k].center), by = a - DVec3(balls_[i].center);
    const auto r = static_cast<double>(balls_[k].radius);
    const double room = static_cast<double>(balls_[i].radius) - margins_[i],
                 most = dot(center - a, by) + half * (std::fabs(by.x) + std::fabs(by.y) + std::fabs(by.z));
    return room > 0 && r * r + 2 * most + dot(by, by) <= room * room;
  }
  [[nodiscard]] bool isSame(std::size_t i, std::size_t k) const {
    return shapes_[i] && shapes_[k] && balls_[i] == balls_[k] && *shapes_[i] == *shapes_[k];
  }
  /// False only if the solids have no point in common, with room to spare.
  [[nodiscard]] bool mayMeet(std::size_t i, std::size_t k) const {
    const double margin = std::max(margins_[i], margins_[k]);
    const Box &a = boxes_[i], &b = boxes_[k];
    for (int c = 0; c < 3; ++c)
      if (static_cast<double>(a.min[c]) > static_cast<double>(b.max[c]) + margin ||
          static_cast<double>(b.min[c]) > static_cast<double>(a.max[c]) + margin)
        return false;
    const DVec3 d = DVec3(balls_[i].center) - DVec3(balls_[k].center);
    const double most =
        static_cast<double>(balls_[i].radius) + static_cast<double>(balls_[k].radius) + margin;
    return d.x * d.x + d.y * d.y + d.z * d.z <= most * most;
  }
  /// The box, and what is so near that it may count as meeting it.
  [[nodiscard]] Box boxAround(std::size_t i) const {
    const auto by = static_cast<float>(2 * margins_[i]);
    return {boxes_[i].min - Vec3(by), boxes_[i].max + Vec3(by)};
  }

 private:
  void add(DexelOperation operation, const Shape* shape, const Box& box) {
    labels_.push_back(labels_.size());
    operations_.push_back(operation);
    shapes_.push_back(shape);
    boxes_.push_back(box);
    const bool isBall = shape && shape->isSphere();
    isBall_.push_back(isBall ? 1 : 0);
    Sphere ball{Point(0), 0};
    if (isBall)
      ball = shape->ball();
    else if (!box.empty())
      ball = {box.center(), box.halfDiagonal() * (1 + 0x1p-20f)};
    balls_.push_back(ball);
    const double most = std::max(reach_, box.empty() ? 0 : farthest(box));
    margins_.push_back(most * (isBall ? kBallMargin : kVolumeMargin));
  }

  double reach_ = 0;  // greatest coordinate of the grid
  std::size_t first_ = 0;
  std::vector<std::uint64_t> labels_;
  std::vector<DexelOperation> operations_;
  std::vector<const Shape*> shapes_;  // null: known by its box only
  std::vector<Box> boxes_;
  std::vector<Sphere> balls_;
  std::vector<std::uint8_t> isBall_;
  std::vector<double> margins_;
};

class Search {
 public:
  explicit Search(const TriDexelDocument& document)
      : steps_(document), clusters_({.cell = steps_.medianRadius()}), hasNoEffect_(steps_.size()) {
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      if (i >= steps_.first() && changesNothing(i)) {
        hasNoEffect_[i] = 1;
        continue;
      }
      if (steps_.operation(i) == DexelOperation::Intersection)
        intersections_.push_back(i);
      else if (!steps_.box(i).empty())
        clusters_.insert(static_cast<std::uint32_t>(i), steps_.box(i), steps_.members());
    }
  }

  [[nodiscard]] const Steps& steps() const { return steps_; }
  [[nodiscard]] bool hasNoEffect(std::size_t i) const { return hasNoEffect_[i] != 0; }

  /// The later steps that decide together what step i does; none where these are not found.
  void coversOf(std::size_t i, std::vector<std::uint32_t>& covers) const {
    covers.clear();
    if (steps_.operation(i) == DexelOperation::Intersection) return;
    const Sphere& ball = steps_.ball(i);
    const DVec3 center(ball.center);
    const auto radius = static_cast<double>(ball.radius);
    if (const auto one = laterThat(i, center, radius)) {
      covers.push_back(*one);
      return;
    }
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const DVec3 d(x, y, z);
          const double l = std::sqrt(dot(d, d));
          if (!laterThat(i, l > 0 ? center + d * (radius / l) : center, 0)) return;
        }
    if (!coverParts(i, covers)) covers.clear();
    std::sort(covers.begin(), covers.end());
  }

 private:
  // Calls f(list) for the lists of the cells at a point, of all grids, until it returns false.
  template <class F>
  void forListsAt(DVec3 p, const F& f) const {
    for (const implicit::ClusterGrid& grid : clusters_.grids())
      if (grid.size() != 0 && !f(grid.at(grid.cellAt(p)))) return;
  }

  // Right after it, all is as right before it.
  [[nodiscard]] bool changesNothing(std::size_t k) const {
    const DexelOperation kind = steps_.operation(k);
    if (kind == DexelOperation::Intersection) return false;
    if (steps_.box(k).empty()) return true;
    const Sphere& ball = steps_.ball(k);
    // The last of the same kind that holds it.
    std::optional<std::size_t> holder;
    forListsAt(DVec3(ball.center), [&](std::span<const std::uint32_t> list) {
      const std::size_t end = list.size() - std::min(list.size(), kMostAsked);
      for (std::size_t n = list.size(); n > end; --n) {
        const std::uint32_t i = list[n - 1];
        if (holder && i <= *holder) break;
        if (steps_.operation(i) != kind) {
          if (steps_.mayMeet(i, k)) break;
        } else if (steps_.isSame(i, k) ||
                   steps_.decides(i, DVec3(ball.center), static_cast<double>(ball.radius))) {
          holder = i;
          break;
        }
      }
      return true;
    });
    const bool clears = kind == DexelOperation::Subtraction;
    if (!holder && !clears) return false;
    if (holder && !clears && !intersections_.empty() && intersections_.back() > *holder) return false;
    if (!holder && steps_.operation(0) == DexelOperation::Union && steps_.mayMeet(0, k)) return false;
    // None of the other kind since then; of a subtraction that nothing holds, none at all.
    bool isFree = true;
    clusters_.forListsIn(steps_.boxAround(k), implicit::Clusters::Wanted::All,
                         [&](std::span<const std::uint32_t> list) {
                           std::size_t left = kMostAsked;
                           for (std::size_t n = list.size(); n > 0 && isFree; --n) {
                             const std::uint32_t i = list[n - 1];
                             if (holder && i <= *holder) break;
                             if (left-- == 0 || (steps_.operation(i) != kind && steps_.mayMeet(i, k)))
                               isFree = false;
                           }
                         });
    return isFree;
  }

  // A step after i that decides the closed ball, if one is found.
  [[nodiscard]] std::optional<std::uint32_t> laterThat(std::size_t i, DVec3 center, double radius) const {
    return laterWhere(i, center, [&](std::size_t j) { return steps_.decides(j, center, radius); });
  }

  // A step after i of which f is true, that touches the cell around a place.
  template <class F>
  [[nodiscard]] std::optional<std::uint32_t> laterWhere(std::size_t i, DVec3 place, const F& f) const {
    std::optional<std::uint32_t> found;
    forListsAt(place, [&](std::span<const std::uint32_t> list) {
      const std::size_t end = list.size() - std::min(list.size(), kMostAsked);
      for (std::size_t n = list.size(); n > end && list[n - 1] > i; --n)
        if (f(list[n - 1])) {
          found = list[n - 1];
          return false;
        }
      return true;
    });
    for (std::size_t n = intersections_.size(), left = kMostIntersections;
         !found && n > 0 && left > 0 && intersections_[n - 1] > i; --n, --left)
      if (f(intersections_[n - 1])) found = static_cast<std::uint32_t>(intersections_[n - 1]);
    return found;
  }

  struct Part {
    DVec3 center{0};
    double half = 0;
    int depth = 0;
  };

  // Is each part of step i's ball decided by a later step?
  [[nodiscard]] bool coverParts(std::size_t i, std::vector<std::uint32_t>& covers) const {
    const Sphere& ball = steps_.ball(i);
    const DVec3 center(ball.center);
    const auto radius = static_cast<double>(ball.radius);
    std::vector<Part> left = {{center, radius, 0}};
    std::size_t questions = 0;
    while (!left.empty()) {
      if (questions > kMostQuestions) return false;
      const Part part = left.back();
      left.pop_back();
      double squared = 0;  // of the distance from the part to the ball's centre
      for (int a = 0; a < 3; ++a) {
        const double d = std::max(std::fabs(part.center[a] - center[a]) - part.half, 0.0);
        squared += d * d;
      }
      if (squared > radius * radius * (1 + 1e-9)) continue;
      const auto decidesIt = [&](std::size_t j) { return steps_.decidesPart(j, i, part.center, part.half); };
      if (std::any_of(covers.rbegin(), covers.rend(), decidesIt)) continue;
      if (const auto cover = laterWhere(i, part.center, decidesIt)) {
        covers.push_back(*cover);
        continue;
      }
      if (part.depth == kDeepest) return false;
      for (unsigned eighth = 0; eighth < 8; ++eighth) {
        const double h = part.half / 2;
        const DVec3 by((eighth & 1) != 0 ? h : -h, (eighth & 2) != 0 ? h : -h, (eighth & 4) != 0 ? h : -h);
        left.push_back({part.center + by, h, part.depth + 1});
      }
    }
    return true;
  }

  Steps steps_;
  implicit::Clusters clusters_;  // of the steps with an effect that have bounds
  std::vector<std::size_t> intersections_;
  std::vector<std::uint8_t> hasNoEffect_;
};

}  // namespace

HiddenOperations hiddenOperations(const TriDexelDocument& document, std::span<const std::uint8_t> isKept,
                                  const Execution& execution) {
  const Search search(document);
  const std::size_t first = search.steps().first(), count = document.operations.size();
  std::vector<std::vector<std::uint32_t>> covers(count);
  HiddenOperations out;
  out.verdicts.assign(count, OperationVerdict::Needed);
  inArena(execution, [&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count), [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t i = range.begin(); i < range.end(); ++i) {
            if (isKept[i] != 0) continue;
            if (search.hasNoEffect(first + i)) {
              out.verdicts[i] = OperationVerdict::WithoutEffect;
              continue;
            }
            search.coversOf(first + i, covers[i]);
            if (!covers[i].empty())
              out.verdicts[i] = covers[i].size() == 1 ? OperationVerdict::Hidden : OperationVerdict::Covered;
          }
        });
  });
  out.balls.reserve(count);
  out.coverBegin.reserve(count + 1);
  for (std::size_t i = 0; i < count; ++i) {
    out.balls.push_back(search.steps().ball(first + i));
    out.coverBegin.push_back(static_cast<std::uint32_t>(out.covers.size()));
    for (const std::uint32_t step : covers[i]) out.covers.push_back(step - static_cast<std::uint32_t>(first));
  }
  out.coverBegin.push_back(static_cast<std::uint32_t>(out.covers.size()));
  return out;
}

}  // namespace restroke::points
