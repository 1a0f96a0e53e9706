#pragma once
// Shapes that moved, with the true motion, for tests and measurements of retarget/alignment.h.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "implicit/geometry/triangle_mesh.h"
#include "retarget/alignment.h"
#include "tests/support/brute_force.h"

namespace restroke::testing {

/// Middle and longest side of a shape's box.
struct Extent {
  DVec3 center{0};
  double size = 2;
};

inline Extent extentOf(const TriangleMesh& mesh) {
  const Box box = boundsOf(mesh);
  const Vec3 size = box.max - box.min;
  return {DVec3(box.center()), static_cast<double>(std::max({size.x, size.y, size.z}))};
}

/// Draws points of a mesh's surface, each place as likely as any other, with normals that go over smoothly
/// from triangle to triangle where these meet at less than 30 degrees.
class SurfaceSampler {
 public:
  explicit SurfaceSampler(TriangleMesh mesh) : mesh_(std::move(mesh)), normals_(mesh_.triangles.size()) {
    std::vector<DVec3> faces;  // normals of length twice the area
    std::vector<std::vector<std::uint32_t>> around(mesh_.vertices.size());
    double area = 0;
    for (const auto& t : mesh_.triangles) {
      const DVec3 a(mesh_.vertices[t[0]]), b(mesh_.vertices[t[1]]), c(mesh_.vertices[t[2]]);
      for (const std::uint32_t v : t) around[v].push_back(static_cast<std::uint32_t>(faces.size()));
      faces.push_back(cross(b - a, c - a));
      area += length(faces.back());
      areas_.push_back(area);
    }
    for (std::size_t k = 0; k < faces.size(); ++k)
      for (std::size_t corner = 0; corner < 3; ++corner)
        for (const std::uint32_t other : around[mesh_.triangles[k][corner]])
          if (dot(faces[k], faces[other]) >= 0.866 * length(faces[k]) * length(faces[other]))
            normals_[k][corner] += faces[other];
  }

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }

  [[nodiscard]] std::vector<retarget::OrientedPoint> draw(std::size_t count, std::uint32_t seed) const {
    Random random{seed};
    std::vector<retarget::OrientedPoint> points;
    while (points.size() < count) {
      const double at = static_cast<double>(random.between(0, 1)) * areas_.back();
      const auto k =
          static_cast<std::size_t>(std::lower_bound(areas_.begin(), areas_.end(), at) - areas_.begin());
      double u = static_cast<double>(random.between(0, 1)), v = static_cast<double>(random.between(0, 1));
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const std::size_t triangle = std::min(k, areas_.size() - 1);
      const auto& t = mesh_.triangles[triangle];
      const auto& n = normals_[triangle];
      const auto mix = [&](DVec3 a, DVec3 b, DVec3 c) { return (1 - u - v) * a + u * b + v * c; };
      const DVec3 normal = mix(n[0], n[1], n[2]);
      if (!(length(normal) > 0)) continue;
      points.push_back(
          {Point(mix(DVec3(mesh_.vertices[t[0]]), DVec3(mesh_.vertices[t[1]]), DVec3(mesh_.vertices[t[2]]))),
           Vec3(normalized(normal))});
    }
    return points;
  }

 private:
  TriangleMesh mesh_;
  std::vector<std::array<DVec3, 3>> normals_;  // of the triangles' corners, of any length
  std::vector<double> areas_;                  // running sums
};

/// A shape with symmetries, drawn from exactly.
enum class PlainShape : std::uint8_t { Ball, Torus, Shaft, Cube, Brick };

inline constexpr std::array kPlainShapes{PlainShape::Ball, PlainShape::Torus, PlainShape::Shaft,
                                         PlainShape::Cube, PlainShape::Brick};

inline const char* nameOf(PlainShape shape) {
  constexpr std::array kNames{"ball", "torus", "shaft", "cube", "brick"};
  return kNames[static_cast<std::size_t>(shape)];
}

/// Points of radius 1 (ball), radii 1 and 0.4 (torus), radius 0.6 and half height 1 (shaft), half sides 1
/// (cube) or 1, 0.7 and 0.5 (brick), each place as likely as any other.
inline std::vector<retarget::OrientedPoint> drawPlain(PlainShape shape, std::size_t count,
                                                      std::uint32_t seed) {
  Random random{seed};
  const auto uniform = [&](double a, double b) {
    return static_cast<double>(random.between(static_cast<float>(a), static_cast<float>(b)));
  };
  const auto onCircle = [&] {
    for (;;) {
      const double x = uniform(-1, 1), y = uniform(-1, 1), d = x * x + y * y;
      if (d > 1e-4 && d <= 1) return DVec3(x, y, 0) / std::sqrt(d);
    }
  };
  const auto inDisc = [&] {
    for (;;) {
      const DVec3 p(uniform(-1, 1), uniform(-1, 1), 0);
      if (dot(p, p) <= 1) return p;
    }
  };
  const auto one = [&]() -> std::pair<DVec3, DVec3> {
    switch (shape) {
      case PlainShape::Ball: {
        const double z = uniform(-1, 1);
        const DVec3 n = std::sqrt(1 - z * z) * onCircle() + DVec3(0, 0, z);
        return {n, n};
      }
      case PlainShape::Torus:
        for (;;) {
          const DVec3 out = onCircle(), tube = onCircle(), n = tube.x * out + DVec3(0, 0, tube.y);
          if (uniform(0, 1.4) <= 1 + 0.4 * tube.x) return {out + 0.4 * n, n};
        }
      case PlainShape::Shaft: {
        const double z = uniform(-1, 1);
        // The two caps are 0.6 / (0.6 + 2) of the area.
        if (uniform(0, 2.6) < 0.6)
          return {0.6 * inDisc() + DVec3(0, 0, z < 0 ? -1 : 1), {0, 0, z < 0 ? -1 : 1}};
        const DVec3 n = onCircle();
        return {0.6 * n + DVec3(0, 0, z), n};
      }
      case PlainShape::Cube:
      case PlainShape::Brick:
        break;
    }
    const DVec3 half = shape == PlainShape::Cube ? DVec3(1) : DVec3(1, 0.7, 0.5);
    const double areas[3] = {half.y * half.z, half.z * half.x, half.x * half.y};
    const double pick = uniform(0, areas[0] + areas[1] + areas[2]);
    const int axis = pick < areas[0] ? 0 : pick < areas[0] + areas[1] ? 1 : 2;
    DVec3 p(uniform(-half.x, half.x), uniform(-half.y, half.y), uniform(-half.z, half.z)), n(0);
    n[axis] = p[axis] < 0 ? -1 : 1;
    p[axis] = n[axis] * half[axis];
    return {p, n};
  };
  std::vector<retarget::OrientedPoint> points;
  for (std::size_t k = 0; k < count; ++k) {
    const auto [p, n] = one();
    points.push_back({Point(p), Vec3(normalized(n))});
  }
  return points;
}

/// A polyline of about that length on the surface of which `points` are a dense sampling: steps along the
/// tangent plane, each drawn back to the surface.
inline std::vector<Point> strokeOn(const std::vector<retarget::OrientedPoint>& points, double strokeLength,
                                   Random& random) {
  constexpr int kSteps = 24;
  retarget::OrientedPoint here = points[random.below(static_cast<std::uint32_t>(points.size()))];
  DVec3 direction(random.inCube(1));
  std::vector<Point> stroke{here.position};
  for (int k = 0; k < kSteps; ++k) {
    const DVec3 normal(here.normal);
    direction -= dot(direction, normal) * normal;
    while (!(length(direction) > 1e-3)) {  // over a sharp edge
      direction = DVec3(random.inCube(1));
      direction -= dot(direction, normal) * normal;
    }
    direction = normalized(direction);
    const DVec3 wanted = DVec3(here.position) + (strokeLength / kSteps) * direction;
    const auto nearest = std::min_element(points.begin(), points.end(), [&](const auto& a, const auto& b) {
      const DVec3 da = DVec3(a.position) - wanted, db = DVec3(b.position) - wanted;
      return dot(da, da) < dot(db, db);
    });
    const DVec3 n(nearest->normal);
    here = {Point(wanted - dot(wanted - DVec3(nearest->position), n) * n), nearest->normal};
    stroke.push_back(here.position);
  }
  return stroke;
}

inline double lengthOf(const std::vector<Point>& stroke) {
  double sum = 0;
  for (std::size_t k = 1; k < stroke.size(); ++k) sum += length(DVec3(stroke[k]) - DVec3(stroke[k - 1]));
  return sum;
}

/// RMS distance of the points' images under the two motions, as part of the stroke's length after `truth`.
inline double strokeError(const std::vector<Point>& stroke, const Similarity& estimate,
                          const Similarity& truth) {
  double sum = 0;
  for (const Point p : stroke) {
    const DVec3 d = moved(estimate, DVec3(p)) - moved(truth, DVec3(p));
    sum += dot(d, d);
  }
  return std::sqrt(sum / static_cast<double>(stroke.size())) / (lengthOf(stroke) * truth.scale);
}

inline std::vector<retarget::OrientedPoint> movedPoints(const Similarity& m,
                                                        std::vector<retarget::OrientedPoint> points) {
  for (auto& p : points)
    p = {Point(moved(m, DVec3(p.position))), Vec3(normalized(turned(m.rotation, DVec3(p.normal))))};
  return points;
}

enum class TrialMotion : std::uint8_t { None, Shift, Turn, Scale, All };

/// Shift by half the size, turn by 45 degrees, scale by 1.5, in or about random directions and the shape's
/// centre.
inline Similarity trialMotion(TrialMotion kind, const Extent& extent, Random& random) {
  const auto axis = [&] {
    DVec3 v(random.inCube(1));
    while (!(length(v) > 0.1)) v = DVec3(random.inCube(1));
    return normalized(v);
  };
  const bool isAll = kind == TrialMotion::All;
  const DVec3 center = extent.center;
  Similarity m;
  if (kind == TrialMotion::Turn || isAll) m.rotation = rotationAbout(axis(), std::sqrt(2.0) - 1);
  if (kind == TrialMotion::Scale || isAll) m.scale = 1.5;
  m.translation = center - m.scale * turned(m.rotation, center);
  if (kind == TrialMotion::Shift || isAll) m.translation += 0.5 * extent.size * axis();
  return m;
}

/// A smooth change of everything farther than `radius` from `center`: there space is twisted about an axis
/// through the centre, the more the farther along it, and swells; both set in within `fade`.
struct Deformation {
  DVec3 center{0}, axis{0, 0, 1};
  double radius = 1, fade = 1, turn = 0.8, swelling = 0.3;

  [[nodiscard]] DVec3 operator()(DVec3 p) const {
    const DVec3 d = p - center;
    const double t = std::clamp((length(d) - radius) / fade, 0.0, 1.0), w = t * t * (3 - 2 * t);
    if (w == 0) return p;
    const double angle = w * turn * std::clamp(dot(d, axis) / (radius + fade), -3.0, 3.0);
    return center + (1 + swelling * w) * turned(rotationAbout(axis, std::tan(0.5 * angle)), d);
  }
};

inline std::vector<retarget::OrientedPoint> deformedPoints(const Deformation& deform,
                                                           std::vector<retarget::OrientedPoint> points) {
  const double h = 1e-4 * deform.radius;
  for (auto& p : points) {
    const DVec3 at(p.position), n(p.normal);
    const DVec3 u = normalized(cross(n, std::fabs(n.x) < 0.8 ? DVec3(1, 0, 0) : DVec3(0, 1, 0))),
                v = cross(n, u);
    const DVec3 du = deform(at + h * u) - deform(at - h * u), dv = deform(at + h * v) - deform(at - h * v);
    p = {Point(deform(at)), Vec3(normalized(cross(du, dv)))};
  }
  return points;
}

}  // namespace restroke::testing
