#pragma once
// Solids for the tests of isosurfaceOf, and measures of its meshes.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "implicit/geometry/exact_predicates.h"
#include "implicit/geometry/mesh_faults.h"
#include "implicit/volume_kinds.h"
#include "points/isosurface/contour_source.h"
#include "tests/support/brute_force.h"

namespace restroke::points::testing {

using implicit::Side;
using restroke::testing::Random;

/// A solid given by values of points: a point (x, y, z) of n[0] x n[1] x n[2] is at (x + 0.5, y + 0.5, z +
/// 0.5), which is where a grid of cells of 1 asks. Everything else is as the nearest of them.
class BitSource : public ContourSource {
 public:
  /// Where crossings are on their edges, and which way they face.
  enum class Crossings { Middle, Random, AtEnds };

  BitSource(std::array<int, 3> size, std::vector<bool> bits, Crossings crossings = Crossings::Middle)
      : size_(size), bits_(std::move(bits)), crossings_(crossings) {}

  [[nodiscard]] Box bounds() const override {
    return {Point(0),
            {static_cast<float>(size_[0]), static_cast<float>(size_[1]), static_cast<float>(size_[2])}};
  }
  [[nodiscard]] bool inside(Point p) const {
    std::size_t index = 0;
    for (int a = 2; a >= 0; --a) {
      const int n = size_[static_cast<std::size_t>(a)];
      if (!(p[a] >= 0 && p[a] < static_cast<float>(n))) return false;
      index = index * static_cast<std::size_t>(n) + static_cast<std::size_t>(p[a]);
    }
    return bits_[index];
  }
  void sides(std::span<const Point> points, std::span<Side> sides) const override {
    for (std::size_t i = 0; i < points.size(); ++i)
      sides[i] = inside(points[i]) ? Side::Inside : Side::Outside;
  }
  [[nodiscard]] Crossing crossing(Point from, Point to) const override {
    const DVec3 a(from), b(to);
    if (crossings_ == Crossings::Middle) return {(a + b) * 0.5, b - a};
    std::uint64_t seed = 0;
    for (const double x : {a.x, a.y, a.z, b.x, b.y, b.z})
      seed = seed * 1000003 + static_cast<std::uint64_t>(x * 4 + 64);
    Random random(seed);
    const double t = crossings_ == Crossings::AtEnds ? static_cast<double>(random.below(2))
                                                     : static_cast<double>(random.between(0, 1));
    return {a + (b - a) * t, DVec3(random.inCube(1)) + (b - a) * 0.7};
  }

 private:
  std::array<int, 3> size_;
  std::vector<bool> bits_;
  Crossings crossings_;
};

/// A box in any orientation, in double precision.
class BoxSource : public ContourSource {
 public:
  BoxSource(DVec3 center, std::array<DVec3, 3> axes, DVec3 half)
      : center_(center), axes_(axes), half_(half) {}

  /// A box whose axes are as a random rotation says; the first of all is not turned.
  static BoxSource random(std::uint64_t seed, DVec3 half) {
    if (seed == 0) return {DVec3(0), {DVec3(1, 0, 0), DVec3(0, 1, 0), DVec3(0, 0, 1)}, half};
    Random random(seed);
    const DVec3 a = normalized(DVec3(random.inCube(1))), b = normalized(cross(a, DVec3(random.inCube(1))));
    return {DVec3(random.inCube(0.1f)), {a, b, cross(a, b)}, half};
  }

  [[nodiscard]] Box bounds() const override {
    Box box;
    for (int c = 0; c < 8; ++c) {
      const Point p(corner(c));
      box.add({p, p});
    }
    return box;
  }
  [[nodiscard]] DVec3 corner(int c) const {
    return at({(c & 1) != 0 ? 1.0 : -1.0, (c & 2) != 0 ? 1.0 : -1.0, (c & 4) != 0 ? 1.0 : -1.0});
  }
  /// From local coordinates, each face at -1 or 1.
  [[nodiscard]] DVec3 at(DVec3 local) const {
    DVec3 p = center_;
    for (int a = 0; a < 3; ++a) p += axes_[static_cast<std::size_t>(a)] * (local[a] * half_[a]);
    return p;
  }
  void sides(std::span<const Point> points, std::span<Side> sides) const override {
    for (std::size_t i = 0; i < points.size(); ++i) {
      bool inside = true;
      for (int a = 0; a < 3; ++a)
        inside = inside &&
                 std::fabs(dot(DVec3(points[i]) - center_, axes_[static_cast<std::size_t>(a)])) <= half_[a];
      sides[i] = inside ? Side::Inside : Side::Outside;
    }
  }
  [[nodiscard]] Crossing crossing(Point inside, Point outside) const override {
    const DVec3 from(inside), along = DVec3(outside) - from;
    Crossing best;
    double least = 2;
    for (int a = 0; a < 3; ++a) {
      const DVec3 axis = axes_[static_cast<std::size_t>(a)];
      const double speed = dot(along, axis), start = dot(from - center_, axis);
      if (speed == 0) continue;
      const double sign = speed > 0 ? 1 : -1, t = (sign * half_[a] - start) / speed;
      if (t < least) {
        least = t;
        best = {from + along * t, axis * sign};
      }
    }
    return best;
  }

 private:
  DVec3 center_;
  std::array<DVec3, 3> axes_;
  DVec3 half_;
};

/// A ball with every kind of volume added to it in one place and carved from it in another, all turned at
/// random.
inline implicit::PrimitiveList shapeOfAllKinds() {
  Random random(8);
  implicit::PrimitiveList list;
  list.append({implicit::Sphere{}, implicit::Sign::Positive});
  const auto kinds = implicit::volumeKinds();
  const std::size_t count = 2 * kinds.size();
  for (std::size_t i = 0; i < count; ++i) {
    const implicit::VolumeKind& kind = *kinds[i / 2];
    const auto volume = kind.make(kind.examples().front());
    // Along a spiral on the ball, in golden angles.
    const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(count);
    const double r = std::sqrt(1 - z * z), angle = 2.399963229728653 * static_cast<double>(i);
    implicit::Pose pose;
    pose.position = Point(DVec3(r * std::cos(angle), r * std::sin(angle), z));
    for (float& q : pose.rotation) q = random.between(-1, 1);
    pose.scale = static_cast<float>(0.3 / static_cast<double>(volume->measures().radius));
    list.append({std::make_shared<const implicit::PosedVolume>(volume, pose),
                 i % 2 == 0 ? implicit::Sign::Positive : implicit::Sign::Negative});
  }
  return list;
}

/// V - E + F. Edges are counted as pairs of vertices, whoever uses them.
inline std::int64_t eulerCharacteristic(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) ++edges[std::minmax(t[i], t[(i + 1) % 3])];
  return static_cast<std::int64_t>(mesh.vertices.size()) - static_cast<std::int64_t>(edges.size()) +
         static_cast<std::int64_t>(mesh.triangles.size());
}

/// How often the mesh winds around a point.
inline int windingNumber(const TriangleMesh& mesh, Point p) {
  int winding = 0;
  for (const auto& t : mesh.triangles)
    winding += crossingOf({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]}, p);
  return winding;
}

/// Distance of a point from a triangle (Ericson, "Real-time collision detection", section 5.1.5).
inline double distanceFrom(DVec3 p, DVec3 a, DVec3 b, DVec3 c) {
  const DVec3 ab = b - a, ac = c - a;
  const double d1 = dot(ab, p - a), d2 = dot(ac, p - a), d3 = dot(ab, p - b), d4 = dot(ac, p - b),
               d5 = dot(ab, p - c), d6 = dot(ac, p - c);
  if (d1 <= 0 && d2 <= 0) return length(p - a);
  if (d3 >= 0 && d4 <= d3) return length(p - b);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return length(p - (a + ab * (d1 / (d1 - d3))));
  if (d6 >= 0 && d5 <= d6) return length(p - c);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return length(p - (a + ac * (d2 / (d2 - d6))));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return length(p - (b + (c - b) * ((d4 - d3) / (d4 - d3 + d5 - d6))));
  return length(p - (a + ab * (vb / (va + vb + vc)) + ac * (vc / (va + vb + vc))));
}

/// Distance of a point from a mesh; `reach` where it is more.
inline double distanceFrom(const TriangleMesh& mesh, DVec3 p, double reach) {
  double least = reach;
  for (const auto& t : mesh.triangles) {
    const DVec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
    bool isNear = true;
    for (int i = 0; i < 3; ++i)
      isNear = isNear && std::min({a[i], b[i], c[i]}) <= p[i] + least &&
               std::max({a[i], b[i], c[i]}) >= p[i] - least;
    if (isNear) least = std::min(least, distanceFrom(p, a, b, c));
  }
  return least;
}

}  // namespace restroke::points::testing
