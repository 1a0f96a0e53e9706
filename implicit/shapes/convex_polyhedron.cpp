// Convex polyhedron: the hull of points. Qhull (Barber, Dobkin, Huhdanpaa, "The quickhull algorithm for
// convex hulls", ACM Transactions on Mathematical Software 22, 1996) tells which points make a face; the
// faces' planes are computed here, so that what decides a side does not depend on its version. Side test: the
// greatest of the distances to the planes.

#include <libqhull_r/qhull_ra.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "implicit/errors.h"
#include "implicit/sampling/poisson.h"
#include "implicit/shapes/kinds.h"
#include "implicit/shapes/ray_intervals.h"

namespace restroke::implicit {

namespace {

constexpr std::size_t kMostPoints = 4096;

struct Plane {
  DVec3 normal;
  double offset;  // dot(normal, p) <= offset inside
};

// Index triples of the hull's triangulated facets, in no particular orientation. Empty when there is no
// volume.
std::vector<std::array<std::size_t, 3>> hullTriangles(std::vector<double>& coordinates) {
  qhT state;
  qhT* const qh = &state;
  std::FILE* const nowhere = std::fopen("/dev/null", "w");
  if (!nowhere) throw InternalError("/dev/null cannot be opened");
  qh_zero(qh, nowhere);
  char options[] = "qhull Qt";
  std::vector<std::array<std::size_t, 3>> triangles;
  const int failed = qh_new_qhull(qh, 3, static_cast<int>(coordinates.size() / 3), coordinates.data(), False,
                                  options, nowhere, nowhere);
  if (!failed) {
    facetT* facet;
    FORALLfacets {
      std::array<std::size_t, 3> triangle{};
      std::size_t n = 0;
      vertexT *vertex, **vertexp;
      FOREACHvertex_(facet->vertices) {
        if (n < 3) triangle[n] = static_cast<std::size_t>(qh_pointid(qh, vertex->point));
        ++n;
      }
      if (n == 3) triangles.push_back(triangle);
    }
  }
  qh_freeqhull(qh, !qh_ALL);
  int left = 0, total = 0;
  qh_memfreeshort(qh, &left, &total);
  std::fclose(nowhere);
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

class ConvexPolyhedron final : public VolumeOf<ConvexPolyhedron> {
 public:
  explicit ConvexPolyhedron(VolumeParameters parameters)
      : VolumeOf(convexPolyhedronKind(), std::move(parameters)) {
    const std::vector<float>& values = this->parameters().values[0];
    if (values.size() % 3 != 0 || values.size() < 12 || values.size() > 3 * kMostPoints)
      throw InputError(fmt::format("a convexPolyhedron has {} coordinates; it must have 4 to {} points of 3",
                                   values.size(), kMostPoints));
    std::vector<double> coordinates(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isfinite(values[i]))
        throw InputError(
            fmt::format("point {} of a convexPolyhedron is not finite; all coordinates must be", i / 3 + 1));
      coordinates[i] = static_cast<double>(values[i]);
    }
    build(coordinates);
  }

  [[nodiscard]] double clearance(DVec3 p) const override {
    double most = -std::numeric_limits<double>::max();
    for (const Plane& plane : planes_) most = std::max(most, dot(plane.normal, p) - plane.offset);
    return most;
  }
  [[nodiscard]] bool inside(DVec3 p, double dilation) const {
    for (const Plane& plane : planes_)
      if (!(dot(plane.normal, p) - plane.offset <= dilation)) return false;
    return true;
  }
  [[nodiscard]] DVec3 outwardNormal(DVec3 p) const override {
    const auto distance = [&](const Plane& plane) { return dot(plane.normal, p) - plane.offset; };
    return std::max_element(planes_.begin(), planes_.end(),
                            [&](const Plane& a, const Plane& b) { return distance(a) < distance(b); })
        ->normal;
  }
  /// Exact but for rounding: the ray is cut by each plane.
  void intersect(const Ray& ray, std::vector<RayInterval>& intervals) const override {
    double enter = -std::numeric_limits<double>::max(), exit = std::numeric_limits<double>::max();
    for (const Plane& plane : planes_) {
      const double slope = dot(plane.normal, ray.direction);
      const double distance = dot(plane.normal, ray.origin) - plane.offset;
      if (slope == 0) {
        if (distance > 0) return;
      } else if (slope < 0) {
        enter = std::max(enter, -distance / slope);
      } else {
        exit = std::min(exit, -distance / slope);
      }
    }
    if (enter < exit) intervals.push_back({enter, exit});
  }
  [[nodiscard]] double support(DVec3 direction) const override {
    double most = -std::numeric_limits<double>::max();
    for (const DVec3& v : corners_) most = std::max(most, dot(v, direction));
    return most;
  }

 protected:
  [[nodiscard]] SampleTable makeSamples(std::uint32_t count) const override {
    return SampleTable(samplePoisson(triangles_, count));
  }
  [[nodiscard]] std::size_t ownBytes() const override {
    return planes_.capacity() * sizeof(Plane) + corners_.capacity() * sizeof(DVec3) +
           triangles_.capacity() * sizeof(SurfaceTriangle);
  }

 private:
  void build(std::vector<double>& coordinates) {
    const auto point = [&](std::size_t i) {
      return DVec3(coordinates[3 * i], coordinates[3 * i + 1], coordinates[3 * i + 2]);
    };
    const auto facets = hullTriangles(coordinates);
    std::vector<std::size_t> used;
    DVec3 middle(0);
    for (const auto& facet : facets) used.insert(used.end(), facet.begin(), facet.end());
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (const std::size_t i : used) {
      corners_.push_back(point(i));
      middle += point(i) / static_cast<double>(used.size());
    }
    double size = 0;
    for (const DVec3& v : corners_) size = std::max(size, length(v - middle));
    double area = 0, volume = 0;
    for (const auto& facet : facets) {
      DVec3 a = point(facet[0]), b = point(facet[1]), c = point(facet[2]);
      DVec3 n = cross(b - a, c - a);
      const double doubled = length(n);
      if (!(doubled > 1e-12 * size * size)) continue;  // a sliver: its neighbours have its plane
      n = n / doubled;
      if (dot(n, a - middle) < 0) {
        std::swap(b, c);
        n = -n;
      }
      // A plane that no corner passes cuts nothing off, however roundly its normal was computed.
      double offset = dot(n, a);
      for (const DVec3& v : corners_) offset = std::max(offset, dot(n, v));
      area += doubled / 2;
      volume += dot(a - middle, n) * doubled / 6;
      const auto known = std::find_if(planes_.begin(), planes_.end(), [&](const Plane& plane) {
        return dot(plane.normal, n) > 1 - 1e-14 && std::fabs(plane.offset - offset) <= 1e-12 * size;
      });
      triangles_.push_back({a, b, c, n, static_cast<std::uint32_t>(known - planes_.begin())});
      if (known == planes_.end()) planes_.push_back({n, offset});
    }
    // Its width across each face; the smallest is its thickness, and 0 when the points lie in a plane.
    double thickness = std::numeric_limits<double>::max();
    for (const Plane& plane : planes_) {
      double depth = 0;
      for (const DVec3& v : corners_) depth = std::max(depth, plane.offset - dot(plane.normal, v));
      thickness = std::min(thickness, depth);
    }
    if (planes_.size() < 4 || !(thickness > 1e-9 * size))
      throw InputError(
          "the points of a convexPolyhedron lie in a plane, on a line or in one place; their hull "
          "must have a volume");
    setMeasures({.center = middle, .radius = size, .area = area, .volume = volume, .thickness = thickness});
  }

  std::vector<Plane> planes_;
  std::vector<DVec3> corners_;
  std::vector<SurfaceTriangle> triangles_;
};

}  // namespace

const VolumeKind& convexPolyhedronKind() {
  static const VolumeKind kind{.name = "convexPolyhedron",
                               .summary = "the convex hull of points",
                               .parameters = {{.name = "points",
                                               .meaning = "4 to 4,096 of them, not all in one plane",
                                               .form = ParameterInfo::Form::Points}},
                               .make = [](const VolumeParameters& p) -> std::shared_ptr<const Volume> {
                                 return std::make_shared<ConvexPolyhedron>(p);
                               },
                               .examples =
                                   [] {
                                     // A dodecahedron, a tetrahedron off the origin, a wedge, a plate of
                                     // coplanar points.
                                     const float g = 0.618034f, h = g * g;
                                     std::vector<float> dodecahedron;
                                     for (const float x : {-g, g})
                                       for (const float y : {-g, g})
                                         for (const float z : {-g, g})
                                           dodecahedron.insert(dodecahedron.end(), {x, y, z});
                                     for (const float a : {-h, h})
                                       for (const float b : {-1.0f, 1.0f})
                                         dodecahedron.insert(dodecahedron.end(), {0, a, b, a, b, 0, b, 0, a});
                                     std::vector<float> plate;
                                     for (int i = 0; i < 5; ++i)
                                       for (int j = 0; j < 4; ++j)
                                         for (const float z : {0.0f, 0.02f})
                                           plate.insert(plate.end(), {0.25f * static_cast<float>(i),
                                                                      0.25f * static_cast<float>(j), z});
                                     return std::vector<VolumeParameters>{
                                         {{dodecahedron}},
                                         {{{3, 0, 0, 4, 0, 0, 3, 1, 0, 3.2f, 0.2f, 0.9f}}},
                                         {{{-1, 0, 0, 1, 0, 0, -1, 1, 0, 1, 1, 0, -1, 0, 0.2f, 1, 0, 0.2f}}},
                                         {{plate}}};
                                   }};
  return kind;
}

}  // namespace restroke::implicit
