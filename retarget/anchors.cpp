#include "retarget/anchors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "implicit/geometry/powers.h"
#include "implicit/geometry/triangle_tree.h"

namespace restroke::retarget {
namespace {

using implicit::PosedVolume;
using implicit::Shape;
using implicit::VolumeParameters;

/// A shape's own frame, and its extent there.
class Frame {
 public:
  explicit Frame(const Shape& shape) : shape_(shape), origin_(shape.ball().center) {
    scale_ = static_cast<double>(shape.ball().radius);
    const PosedVolume* posed = shape.volume();
    if (!posed) return;
    origin_ = DVec3(posed->pose().position);
    scale_ = static_cast<double>(posed->pose().scale);
    for (int axis = 0; axis < 3; ++axis) {
      DVec3 direction(0);
      direction[axis] = 1;
      const double high = posed->volume().support(direction), low = -posed->volume().support(-direction);
      center_[axis] = (low + high) / 2;
      half_[axis] = (high - low) / 2;
    }
  }

  [[nodiscard]] const Shape& shape() const { return shape_; }
  [[nodiscard]] double scale() const { return scale_; }  ///< of the frame, in model units
  [[nodiscard]] DVec3 center() const { return center_; }
  [[nodiscard]] DVec3 half() const { return half_; }

  [[nodiscard]] DVec3 toLocal(DVec3 p) const {
    return shape_.volume() ? shape_.volume()->toLocal(p) : (p - origin_) / scale_;
  }
  [[nodiscard]] DVec3 toModel(DVec3 p) const {
    return shape_.volume() ? shape_.volume()->toModel(p) : origin_ + scale_ * p;
  }
  /// Directions keep their length but for the frame's scale.
  [[nodiscard]] DVec3 directionToLocal(DVec3 v) const {
    return shape_.volume() ? toLocal(origin_ + v) - toLocal(origin_) : v;
  }
  [[nodiscard]] DVec3 directionToModel(DVec3 v) const {
    return shape_.volume() ? toModel(v) - toModel(DVec3(0)) : v;
  }

 private:
  Shape shape_;
  DVec3 origin_;
  double scale_ = 1;
  DVec3 center_{0}, half_{1};  // of the volume's box in its own frame
};

SurfaceHit hitOf(DVec3 position, DVec3 normal, double scale) {
  SurfaceHit hit;
  hit.position = Point(position);
  hit.normal = Vec3(normalized(normal));
  hit.scale = static_cast<float>(scale);
  return hit;
}

/// Where the boundary is met along the shape's normal at a place close to it, nearest to the place.
std::optional<DVec3> ontoBoundary(const Shape& shape, DVec3 p) {
  const DVec3 normal = outwardNormal(shape, p);
  std::vector<RayInterval> intervals;
  intersect(shape, {.origin = p, .direction = normal}, intervals);
  std::optional<double> nearest;
  for (const RayInterval& interval : intervals)
    for (const double t : {interval.enter, interval.exit})
      if (!nearest || std::fabs(t) < std::fabs(*nearest)) nearest = t;
  if (!nearest) return std::nullopt;
  return p + *nearest * normal;
}

/// Coordinates are the own frame's, in parts of the extent.
class FrameCoordinates final : public SurfaceCoordinates {
 public:
  /// `affine`: parts of the extent take one boundary onto the other.
  enum class Fit : std::uint8_t { Affine, ThenOntoBoundary };
  FrameCoordinates(const Shape& former, const Shape& present, Fit fit)
      : former_(former), present_(present), fit_(fit), stretch_(present_.half() / former_.half()) {
    scale_ = present_.scale() / former_.scale() * powerOf(stretch_.x * stretch_.y * stretch_.z, 1.0 / 3);
  }

  std::optional<SurfaceHit> carry(const SurfaceHit& hit) const override {
    const DVec3 was = former_.toLocal(DVec3(hit.position));
    const DVec3 wasNormal = former_.directionToLocal(DVec3(hit.normal));
    const DVec3 is = present_.toModel(present_.center() + (was - former_.center()) * stretch_);
    const DVec3 normal = present_.directionToModel(wasNormal / stretch_);
    if (fit_ == Fit::Affine) return hitOf(is, normal, scale_);
    const auto position = ontoBoundary(present_.shape(), is);
    if (!position) return std::nullopt;
    const DVec3 outward = outwardNormal(present_.shape(), *position);
    return hitOf(*position, dot(outward, normal) < 0 ? -outward : outward, scale_);
  }

 private:
  Frame former_, present_;
  Fit fit_;
  DVec3 stretch_;
  double scale_ = 1;
};

/// The nearest point of a triangle, as weights of its corners.
std::array<double, 3> nearestWeights(DVec3 p, const std::array<DVec3, 3>& corners) {
  // Ericson, "Real-time collision detection", 2005, section 5.1.5: by the region of the triangle that is
  // nearest.
  const auto& [a, b, c] = corners;
  const DVec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
               d6 = dot(ac, cp);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double t = d1 / (d1 - d3);
    return {1 - t, t, 0};
  }
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double t = d2 / (d2 - d6);
    return {1 - t, 0, t};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - t, t};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

DVec3 weighted(const std::array<DVec3, 3>& corners, const std::array<double, 3>& weights) {
  return weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
}

/// Twice the area, towards the triangle's front.
DVec3 areaVector(const std::array<DVec3, 3>& corners) {
  return cross(corners[1] - corners[0], corners[2] - corners[0]);
}

double squaredDistance(const Box& box, DVec3 p) {
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = static_cast<double>(box.min[axis]), high = static_cast<double>(box.max[axis]);
    const double d = p[axis] < low ? low - p[axis] : p[axis] > high ? p[axis] - high : 0;
    sum += d * d;
  }
  return sum;
}

/// Coordinates are a triangle and weights of its corners.
class MeshCoordinates final : public SurfaceCoordinates {
 public:
  MeshCoordinates(const Shape& former, const Shape& present)
      : former_(former), present_(present), tree_(meshOf(former_)) {}

  static const TriangleMesh& meshOf(const Frame& frame) {
    return frame.shape().volume()->volume().parameters().mesh->mesh;
  }

  std::optional<SurfaceHit> carry(const SurfaceHit& hit) const override {
    const DVec3 was = former_.toLocal(DVec3(hit.position));
    const std::uint32_t triangle = nearestTriangle(was);
    const auto before = cornersOf(former_, triangle), now = cornersOf(present_, triangle);
    const auto weights = nearestWeights(was, before);
    const DVec3 beforeArea = areaVector(before), nowArea = areaVector(now);
    const double beforeSize = length(beforeArea), nowSize = length(nowArea);
    if (!(beforeSize > 0) || !(nowSize > 0)) return std::nullopt;
    const double growth = std::sqrt(nowSize / beforeSize);
    const DVec3 off = was - weighted(before, weights);
    const double distance = dot(off, beforeArea) < 0 ? -length(off) : length(off);
    const DVec3 front = nowArea / nowSize;
    const bool behind = dot(former_.directionToLocal(DVec3(hit.normal)), beforeArea) < 0;
    return hitOf(present_.toModel(weighted(now, weights) + distance * growth * front),
                 present_.directionToModel(behind ? -front : front),
                 growth * present_.scale() / former_.scale());
  }

 private:
  static std::array<DVec3, 3> cornersOf(const Frame& frame, std::uint32_t triangle) {
    const TriangleMesh& mesh = meshOf(frame);
    const auto& t = mesh.triangles[triangle];
    return {DVec3(mesh.vertices[t[0]]), DVec3(mesh.vertices[t[1]]), DVec3(mesh.vertices[t[2]])};
  }

  [[nodiscard]] std::uint32_t nearestTriangle(DVec3 p) const {
    std::uint32_t best = std::numeric_limits<std::uint32_t>::max();
    double least = std::numeric_limits<double>::infinity();
    const auto nodes = tree_.nodes();
    std::vector<std::uint32_t> waiting{0};
    while (!waiting.empty()) {
      const std::uint32_t n = waiting.back();
      waiting.pop_back();
      const auto& node = nodes[n];
      // A little wider than the best, since rounding may let a box seem farther than what is in it.
      if (squaredDistance(node.box, p) > least * (1 + 0x1p-40)) continue;
      if (node.right == 0) {
        for (const std::uint32_t t : tree_.order().subspan(node.first, node.count)) {
          const auto corners = cornersOf(former_, t);
          const DVec3 off = p - weighted(corners, nearestWeights(p, corners));
          const double squared = dot(off, off);
          if (squared < least || (squared == least && t < best)) {
            least = squared;
            best = t;
          }
        }
        continue;
      }
      const bool leftFirst =
          squaredDistance(nodes[n + 1].box, p) <= squaredDistance(nodes[node.right].box, p);
      waiting.push_back(leftFirst ? node.right : n + 1);
      waiting.push_back(leftFirst ? n + 1 : node.right);
    }
    return best;
  }

  Frame former_, present_;
  TriangleTree tree_;
};

bool isEllipsoid(const Shape& shape) {
  return shape.isSphere() || shape.volume()->volume().kind().name == "ellipsoid";
}

bool haveAsManyValues(const VolumeParameters& a, const VolumeParameters& b) {
  return std::equal(a.values.begin(), a.values.end(), b.values.begin(), b.values.end(),
                    [](const auto& x, const auto& y) { return x.size() == y.size(); });
}

}  // namespace

void setAnchors(Trail& trail, const implicit::PrimitiveList& list,
                const std::function<OwnerKey(implicit::PrimitiveId)>& ownerOf) {
  for (TrailPoint& point : trail.points) {
    point.anchor.reset();
    if (point.hit && point.hit->primitive != kNoPrimitive)
      point.anchor = Anchor{ownerOf(point.hit->primitive), list[point.hit->primitive].shape};
  }
}

std::unique_ptr<const SurfaceCoordinates> SurfaceCoordinates::between(const Shape& former,
                                                                      const Shape& present) {
  using Fit = FrameCoordinates::Fit;
  if (isEllipsoid(former) && isEllipsoid(present))
    return std::make_unique<FrameCoordinates>(former, present, Fit::Affine);
  if (former.isSphere() || present.isSphere()) return nullptr;
  const implicit::Volume &was = former.volume()->volume(), &is = present.volume()->volume();
  if (&was.kind() != &is.kind()) return nullptr;
  if (&was == &is || was.parameters() == is.parameters())
    return std::make_unique<FrameCoordinates>(former, present, Fit::Affine);
  const auto &wasMesh = was.parameters().mesh, &isMesh = is.parameters().mesh;
  if (wasMesh && isMesh) {
    if (wasMesh->mesh.triangles != isMesh->mesh.triangles ||
        wasMesh->mesh.vertices.size() != isMesh->mesh.vertices.size())
      return nullptr;
    return std::make_unique<MeshCoordinates>(former, present);
  }
  if (!haveAsManyValues(was.parameters(), is.parameters())) return nullptr;
  return std::make_unique<FrameCoordinates>(former, present, Fit::ThenOntoBoundary);
}

}  // namespace restroke::retarget
