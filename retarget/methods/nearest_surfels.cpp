// Exact search in a k-d tree: S. Arya and D. Mount, "Algorithms for fast vector quantization", 1993, as
// FLANN's KDTreeSingleIndex has it (M. Muja and D. Lowe, 2009). It computes in float32, and which of two
// nearly equal neighbours it finds depends on how its tree was cut. We therefore give it a bound a little
// wider than the best so far, so that it proposes every surfel that may be as near, and compare in double.

#include "retarget/methods/nearest_surfels.h"

#include <flann/algorithms/dist.h>
#include <flann/algorithms/kdtree_single_index.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace restroke::retarget {
namespace {

// FLANN's squares and the bounds of its boxes are sums and differences of float32 squares, none larger than
// twice the result: each level of the tree adds at most 2^-22 of it, and no tree has 2^9 levels.
constexpr double kSlack = 1 + 0x1p-12;
// Squares below this lose digits.
constexpr double kSmallest = static_cast<double>(std::numeric_limits<float>::min());

double squaredDistance(Point a, Point b) {
  const DVec3 d = DVec3(a) - DVec3(b);
  return dot(d, d);
}

/// What FLANN fills: the best candidate by our own measure.
class BestCandidate final : public flann::ResultSet<float> {
 public:
  BestCandidate(const std::vector<points::Surfel>& surfels, Point p) : surfels_(surfels), p_(p) {}
  [[nodiscard]] bool full() const override { return index_ < surfels_.size(); }
  void addPoint(float, std::size_t index) override {
    const double squared = squaredDistance(surfels_[index].position, p_);
    if (squared > squared_ || (squared == squared_ && index > index_)) return;
    squared_ = squared;
    index_ = index;
    bound_ = static_cast<float>(squared * kSlack + kSmallest);
  }
  [[nodiscard]] float worstDist() const override { return bound_; }
  [[nodiscard]] std::size_t index() const { return index_; }

 private:
  const std::vector<points::Surfel>& surfels_;
  Point p_;
  double squared_ = std::numeric_limits<double>::infinity();
  std::size_t index_ = std::numeric_limits<std::size_t>::max();
  float bound_ = std::numeric_limits<float>::infinity();
};

}  // namespace

struct NearestSurfels::Tree {
  using Index = flann::KDTreeSingleIndex<flann::L2_Simple<float>>;

  explicit Tree(const std::vector<points::Surfel>& surfels) : coordinates(coordinatesOf(surfels)) {
    index.buildIndex(flann::Matrix<float>(coordinates.data(), surfels.size(), 3));
  }
  static std::vector<float> coordinatesOf(const std::vector<points::Surfel>& surfels) {
    std::vector<float> all;
    all.reserve(3 * surfels.size());
    for (const points::Surfel& s : surfels)
      for (const float x : {s.position.x, s.position.y, s.position.z}) all.push_back(x);
    return all;
  }

  std::vector<float> coordinates;  // the index refers to them
  Index index{flann::KDTreeSingleIndexParams(10, true)};
};

NearestSurfels::NearestSurfels(std::vector<points::Surfel> surfels) : surfels_(std::move(surfels)) {
  if (!surfels_.empty()) tree_ = std::make_unique<const Tree>(surfels_);
}

NearestSurfels::~NearestSurfels() = default;

std::optional<std::uint32_t> NearestSurfels::nearest(Point p) const {
  if (!tree_) return std::nullopt;
  BestCandidate best(surfels_, p);
  const float query[3] = {p.x, p.y, p.z};
  tree_->index.findNeighbors(best, query, flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED));
  return static_cast<std::uint32_t>(best.index());
}

DVec3 nearestOnDisc(const points::Surfel& surfel, DVec3 p) {
  const DVec3 center(surfel.position), normal = normalized(DVec3(surfel.normal));
  const DVec3 across = (p - center) - dot(p - center, normal) * normal;
  const double distance = length(across), radius = static_cast<double>(surfel.radius);
  return distance <= radius ? center + across : center + radius / distance * across;
}

std::optional<SurfaceHit> nearestHit(const NearestSurfels& surfels, const implicit::PrimitiveList& list,
                                     Point p) {
  const auto index = surfels.nearest(p);
  if (!index) return std::nullopt;
  const points::Surfel& surfel = surfels.surfels()[*index];
  return SurfaceHit{Point(nearestOnDisc(surfel, DVec3(p))), surfel.normal, list.idAt(surfel.primitive)};
}

}  // namespace restroke::retarget
