#include "tests/bench/cgal_corefinement.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <numbers>

namespace restroke::bench {
namespace {

namespace Pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// An icosahedron whose faces were split in four `level` times: 10 * 4^level + 2 points of the unit sphere.
class Icosphere {
 public:
  explicit Icosphere(int level) {
    const double g = std::numbers::phi;
    for (const double a : {-1.0, 1.0})
      for (const double b : {-g, g}) {
        add({0, a, b});
        add({a, b, 0});
        add({b, 0, a});
      }
    faces_ = hull();
    for (int i = 0; i < level; ++i) split();
  }

  [[nodiscard]] Mesh placed(const implicit::Sphere& ball) const {
    Mesh mesh;
    mesh.reserve(static_cast<unsigned>(points_.size()), static_cast<unsigned>(3 * faces_.size() / 2),
                 static_cast<unsigned>(faces_.size()));
    const DVec3 center(ball.center);
    std::vector<Mesh::Vertex_index> vertices;
    for (const DVec3& u : points_) {
      const DVec3 p = center + static_cast<double>(ball.radius) * u;
      vertices.push_back(mesh.add_vertex({p.x, p.y, p.z}));
    }
    for (const auto& f : faces_) mesh.add_face(vertices[f[0]], vertices[f[1]], vertices[f[2]]);
    return mesh;
  }

 private:
  using Face = std::array<std::size_t, 3>;

  std::size_t add(DVec3 p) {
    points_.push_back(p / length(p));
    return points_.size() - 1;
  }

  // The 20 triples of the icosahedron's points that are neighbours, turned outwards.
  [[nodiscard]] std::vector<Face> hull() const {
    const auto near = [&](std::size_t a, std::size_t b) { return dot(points_[a], points_[b]) > 0.4; };
    std::vector<Face> faces;
    for (std::size_t a = 0; a < 12; ++a)
      for (std::size_t b = a + 1; b < 12; ++b)
        for (std::size_t c = b + 1; c < 12; ++c) {
          if (!near(a, b) || !near(b, c) || !near(a, c)) continue;
          const bool outwards = dot(cross(points_[a], points_[b]), points_[c]) > 0;
          faces.push_back(outwards ? Face{a, b, c} : Face{a, c, b});
        }
    return faces;
  }

  void split() {
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> middles;
    const auto middle = [&](std::size_t a, std::size_t b) {
      const auto [at, isNew] = middles.try_emplace(std::minmax(a, b), points_.size());
      if (isNew) add(points_[a] + points_[b]);
      return at->second;
    };
    std::vector<Face> finer;
    finer.reserve(4 * faces_.size());
    for (const auto& [a, b, c] : faces_) {
      const std::size_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const Face& f : {Face{a, ab, ca}, Face{b, bc, ab}, Face{c, ca, bc}, Face{ab, bc, ca}})
        finer.push_back(f);
    }
    faces_ = std::move(finer);
  }

  std::vector<DVec3> points_;
  std::vector<Face> faces_;
};

// Splits after which an icosphere has about as many points as the ball has samples.
int levelFor(const implicit::Sphere& ball, double density) {
  const double radius = static_cast<double>(ball.radius);
  const double points = 4 * std::numbers::pi * radius * radius * density;
  return std::clamp(static_cast<int>(std::lround(std::log2(points / 10) / 2)), 1, 8);
}

class Corefinement {
 public:
  explicit Corefinement(double density) : density_(density) {}

  [[nodiscard]] Mesh meshOf(const implicit::Primitive& primitive) {
    const implicit::Sphere& ball = primitive.shape.ball();
    const int level = levelFor(ball, density_);
    return spheres_.try_emplace(level, level).first->second.placed(ball);
  }

  // False where CGAL refuses; the shape is then spoilt.
  bool apply(Mesh& shape, Mesh& ball, implicit::Sign sign) const {
    const auto checked = CGAL::parameters::throw_on_self_intersection(true);
    try {
      if (sign == implicit::Sign::Positive)
        return Pmp::corefine_and_compute_union(shape, ball, shape, checked);
      return Pmp::corefine_and_compute_difference(shape, ball, shape, checked);
    } catch (const Pmp::Corefinement::Self_intersection_exception&) {
      return false;
    }
  }

 private:
  double density_;
  std::map<int, Icosphere> spheres_;  // made once: of the stamps' meshes only the placing is timed
};

std::size_t bytesOf(const Mesh& mesh) {
  return mesh.num_vertices() * (sizeof(Kernel::Point_3) + sizeof(Mesh::Halfedge_index)) +
         mesh.num_halfedges() * (3 * sizeof(Mesh::Halfedge_index) + sizeof(Mesh::Vertex_index)) +
         mesh.num_faces() * sizeof(Mesh::Halfedge_index);
}

}  // namespace

CorefinementResult replayWithCorefinement(std::span<const implicit::Primitive> list,
                                          const CorefinementOptions& options) {
  CorefinementResult out;
  if (list.empty()) return out;
  Corefinement booleans(options.density);
  const auto begin = Clock::now();
  Mesh shape = booleans.meshOf(list[0]);
  out.seconds = secondsSince(begin);
  for (const implicit::Primitive& p : list.subspan(1)) {
    if (secondsSince(begin) > options.seconds) break;
    ++out.stamps;
    const Mesh before = shape;
    (void)booleans.meshOf(p);  // its icosphere is there
    const auto start = Clock::now();
    Mesh ball = booleans.meshOf(p);
    const bool done = booleans.apply(shape, ball, p.sign);
    const double seconds = secondsSince(start);
    if (done) {
      out.stampMicroseconds.push_back(1e6 * seconds);
      out.seconds += seconds;
    } else {
      ++out.skipped;
      shape = before;
    }
  }
  shape.collect_garbage();
  out.faces = shape.number_of_faces();
  out.bytes = bytesOf(shape);
  out.closed = CGAL::is_closed(shape);
  return out;
}

}  // namespace restroke::bench
