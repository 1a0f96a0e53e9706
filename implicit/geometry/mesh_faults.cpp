#include "implicit/geometry/mesh_faults.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "implicit/errors.h"
#include "implicit/geometry/disjoint_sets.h"
#include "implicit/geometry/exact_predicates.h"
#include "implicit/geometry/triangle_tree.h"
#include "implicit/parallel.h"

namespace restroke {
namespace {

/// One side of a triangle.
struct Side {
  std::uint32_t low, high;  ///< vertices
  std::uint32_t triangle;
  bool rising;  ///< the triangle runs from low to high
};

bool isSameEdge(const Side& a, const Side& b) {
  return a.low == b.low && a.high == b.high;
}

template <class Fault>
void note(MeshFaults::List<Fault>& list, const Fault& fault) {
  if (list.count++ < MeshFaults::kListed) list.first.push_back(fault);
}

class Inspector {
 public:
  explicit Inspector(const TriangleMesh& mesh) : mesh_(mesh), isDegenerate_(mesh.triangles.size()) {}

  MeshFaults run() {
    checkMesh(mesh_);
    faults_.empty = mesh_.triangles.empty();
    faults_.volume = volumeOf(mesh_);
    findDegenerate();
    const TriangleTree tree(mesh_);
    const std::vector<Side> sides = sidesInOrder();
    DisjointSets pieces(mesh_.triangles.size());
    lookAtEdges(sides, pieces);
    lookAtVertices(sides);
    findCrossings(tree);
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      if (pieces.find(t) == t && !isLine(t)) ++faults_.shellCount;
    if (faults_.none()) lookAtShells(tree, pieces);
    return std::move(faults_);
  }

  [[nodiscard]] MeshFaults::List<MeshFaults::Edge> oddEdges() const {
    MeshFaults::List<MeshFaults::Edge> odd;
    forEachEdge(sidesInOrder(), [&](const MeshFaults::Edge& edge, std::span<const Side>) {
      if (edge.triangles % 2 == 1) note(odd, edge);
    });
    return odd;
  }

 private:
  [[nodiscard]] Triangle cornersOf(std::uint32_t t) const {
    const auto& triangle = mesh_.triangles[t];
    return {mesh_.vertices[triangle[0]], mesh_.vertices[triangle[1]], mesh_.vertices[triangle[2]]};
  }
  [[nodiscard]] MeshFaults::Vertex vertex(std::uint32_t v) const { return {v, mesh_.vertices[v]}; }
  [[nodiscard]] MeshFaults::Face face(std::uint32_t t) const {
    const auto& triangle = mesh_.triangles[t];
    return {t, {vertex(triangle[0]), vertex(triangle[1]), vertex(triangle[2])}};
  }

  void findDegenerate() {
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      if (areCollinear(cornersOf(t))) {
        isDegenerate_[t] = true;
        note(faults_.degenerate, face(t));
      }
  }

  /// A triangle that names a vertex twice runs along an edge and back: a fault, but no border.
  [[nodiscard]] bool isLine(std::uint32_t t) const {
    const auto& [a, b, c] = mesh_.triangles[t];
    return a == b || b == c || c == a;
  }

  /// The sides of all triangles with three vertices, those of one edge together.
  [[nodiscard]] std::vector<Side> sidesInOrder() const {
    std::vector<Side> sides;
    sides.reserve(3 * mesh_.triangles.size());
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (isLine(t)) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = mesh_.triangles[t][i], b = mesh_.triangles[t][(i + 1) % 3];
        sides.push_back({std::min(a, b), std::max(a, b), t, a < b});
      }
    }
    const auto key = [](const Side& s) { return std::tuple(s.low, s.high, s.triangle, s.rising); };
    tbb::parallel_sort(sides, [&](const Side& a, const Side& b) { return key(a) < key(b); });
    return sides;
  }

  /// f(edge, sides that lie on it), in ascending order.
  template <class F>
  void forEachEdge(std::span<const Side> sides, const F& f) const {
    for (std::size_t first = 0, next = 0; first < sides.size(); first = next) {
      while (next < sides.size() && isSameEdge(sides[first], sides[next])) ++next;
      const auto around = sides.subspan(first, next - first);
      MeshFaults::Edge edge{{vertex(around[0].low), vertex(around[0].high)}, around.size()};
      if (around.size() == 1 && !around[0].rising) std::swap(edge.ends[0], edge.ends[1]);
      f(edge, around);
    }
  }

  void lookAtEdges(std::span<const Side> sides, DisjointSets& pieces) {
    forEachEdge(sides, [&](const MeshFaults::Edge& edge, std::span<const Side> around) {
      for (const Side& side : around) pieces.unite(around[0].triangle, side.triangle);
      if (around.size() == 1)
        note(faults_.borders, edge);
      else if (around.size() > 2)
        note(faults_.crowded, edge);
      else if (around[0].rising == around[1].rising)
        note(faults_.inconsistent, edge);
    });
  }

  /// The triangles about a vertex are one fan when their corners there hang together through common edges.
  void lookAtVertices(std::span<const Side> sides) {
    DisjointSets corners(3 * mesh_.triangles.size());
    const auto cornerAt = [&](std::uint32_t t, std::uint32_t v) {
      const auto& triangle = mesh_.triangles[t];
      return 3 * t + (triangle[0] == v ? 0u : triangle[1] == v ? 1u : 2u);
    };
    for (std::size_t i = 1; i < sides.size(); ++i)
      if (isSameEdge(sides[i - 1], sides[i]))
        for (const std::uint32_t v : {sides[i].low, sides[i].high})
          corners.unite(cornerAt(sides[i - 1].triangle, v), cornerAt(sides[i].triangle, v));
    constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> fan(mesh_.vertices.size(), kNone);
    std::vector<bool> pinched(mesh_.vertices.size());
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (isLine(t)) continue;
      for (const std::uint32_t v : mesh_.triangles[t]) {
        const std::uint32_t here = corners.find(cornerAt(t, v));
        if (fan[v] == kNone) fan[v] = here;
        if (fan[v] != here) pinched[v] = true;
      }
    }
    for (std::uint32_t v = 0; v < pinched.size(); ++v)
      if (pinched[v]) note(faults_.pinched, vertex(v));
  }

  /// Do two triangles meet other than in the vertices or the edge that they share?
  [[nodiscard]] bool cross(std::uint32_t one, std::uint32_t other) const {
    const auto& a = mesh_.triangles[one];
    const auto& b = mesh_.triangles[other];
    std::vector<std::pair<std::size_t, std::size_t>> shared;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        if (a[i] == b[j]) shared.emplace_back(i, j);
    const Triangle p = cornersOf(one), q = cornersOf(other);
    if (shared.empty()) return meet(p, q);
    if (shared.size() == 1) {
      // What is common to both is convex and holds the shared vertex; if it holds more, it reaches the side
      // opposite to that vertex in one triangle or in the other.
      const auto [i, j] = shared[0];
      return meet(p, Segment{q[(j + 1) % 3], q[(j + 2) % 3]}) ||
             meet(q, Segment{p[(i + 1) % 3], p[(i + 2) % 3]});
    }
    if (shared.size() == 2) {
      const auto [i0, j0] = shared[0];
      const auto [i1, j1] = shared[1];
      return foldOnto({p[i0], p[i1]}, p[3 - i0 - i1], q[3 - j0 - j1]);
    }
    return true;
  }

  void findCrossings(const TriangleTree& tree) {
    constexpr std::size_t kBlock = 256;
    const std::size_t count = mesh_.triangles.size();
    struct Found {
      std::size_t count = 0;
      std::vector<std::pair<std::uint32_t, std::uint32_t>> first;
    };
    std::vector<Found> blocks((count + kBlock - 1) / kBlock);
    const auto search = [&](std::uint32_t t, Found& found) {
      std::vector<std::uint32_t> others;
      tree.forEachTouching(tree.boxOf(t), [&](std::uint32_t u) {
        if (u > t && !isDegenerate_[u] && cross(t, u)) others.push_back(u);
      });
      std::sort(others.begin(), others.end());
      found.count += others.size();
      for (const std::uint32_t u : others)
        if (found.first.size() < MeshFaults::kListed) found.first.emplace_back(t, u);
    };
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks.size()), [&](const auto& range) {
      for (std::size_t b = range.begin(); b != range.end(); ++b)
        for (std::size_t t = b * kBlock; t < std::min(count, (b + 1) * kBlock); ++t)
          if (!isDegenerate_[t]) search(static_cast<std::uint32_t>(t), blocks[b]);
    });
    for (const Found& found : blocks) {
      for (const auto& [t, u] : found.first)
        if (faults_.crossings.first.size() < MeshFaults::kListed)
          faults_.crossings.first.push_back({face(t), face(u)});
      faults_.crossings.count += found.count;
    }
  }

  /// Shells do not meet here, so that all of a shell is on the same side of each other one.
  void lookAtShells(const TriangleTree& tree, DisjointSets& pieces) {
    std::vector<double> six(mesh_.triangles.size());  // of each shell's first triangle: 6 times its volume
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      const std::uint32_t shell = pieces.find(t);
      const Triangle corners = cornersOf(t);
      const DVec3 origin(mesh_.vertices[mesh_.triangles[shell][0]]);
      const DVec3 a = DVec3(corners[0]) - origin, b = DVec3(corners[1]) - origin,
                  c = DVec3(corners[2]) - origin;
      six[shell] += dot(a, restroke::cross(b, c));
    }
    bool allInwards = true;
    for (std::uint32_t shell = 0; shell < mesh_.triangles.size(); ++shell) {
      if (pieces.find(shell) != shell) continue;
      const Point p = mesh_.vertices[mesh_.triangles[shell][0]];
      Box ray{p, p};
      ray.max.x = std::numeric_limits<float>::max();
      std::int64_t around = 0;
      tree.forEachTouching(ray, [&](std::uint32_t t) {
        if (pieces.find(t) != shell) around += crossingOf(cornersOf(t), p);
      });
      // Winding numbers behind and before a triangle differ by one; outside the shell it is that of the
      // others.
      const std::int64_t before = six[shell] > 0 ? around : around - 1;
      if (before != 0) note(faults_.shells, MeshFaults::Shell{face(shell), before + 1, before});
      allInwards = allInwards && before == -1;
    }
    faults_.inwards = allInwards && !faults_.empty;
    if (faults_.inwards) faults_.shells = {};
  }

  const TriangleMesh& mesh_;
  std::vector<bool> isDegenerate_;
  MeshFaults faults_;
};

// Words -----------------------------------------------------------------------------------------------------

/// How many of each kind a sentence names.
constexpr std::size_t kNamed = 3;

std::string text(Point p) {
  return fmt::format("({}, {}, {})", p.x, p.y, p.z);
}
std::string text(const MeshFaults::Vertex& v) {
  return fmt::format("{} at {}", v.index, text(v.position));
}
std::string text(const MeshFaults::Edge& e) {
  return fmt::format("{}-{} from {} to {}", e.ends[0].index, e.ends[1].index, text(e.ends[0].position),
                     text(e.ends[1].position));
}
std::string text(const MeshFaults::Face& f) {
  return fmt::format("{} at {}, {}, {}", f.triangle, text(f.corners[0].position), text(f.corners[1].position),
                     text(f.corners[2].position));
}
std::string text(const MeshFaults::FacePair& pair) {
  return fmt::format("{} and {} near {}", pair[0].triangle, pair[1].triangle,
                     text(pair[0].corners[0].position));
}
std::string text(const MeshFaults::Shell& s) {
  return fmt::format("that of triangle {} near {}, with winding number {} behind it and {} before it",
                     s.face.triangle, text(s.face.corners[0].position), s.behind, s.before);
}

/// "2 edges belong to one triangle only: a, b", or "one edge belongs to one triangle only: a".
template <class Fault>
void say(std::vector<std::string>& parts, const MeshFaults::List<Fault>& list, const char* one,
         const char* many) {
  if (list.count == 0) return;
  std::string part = list.count == 1 ? std::string(one) : fmt::format("{} {}", list.count, many);
  for (std::size_t i = 0; i < std::min(kNamed, list.first.size()); ++i)
    part += (i == 0 ? ": " : "; ") + text(list.first[i]);
  if (list.count > kNamed) part += "; ...";
  parts.push_back(part);
}

}  // namespace

void checkMesh(const TriangleMesh& mesh) {
  constexpr std::size_t kMost = std::size_t{1} << 30;
  if (mesh.triangles.size() > kMost)
    throw InputError(fmt::format("{} triangles; up to {} can be looked at", mesh.triangles.size(), kMost));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (v >= mesh.vertices.size())
        throw InputError(fmt::format("triangle {} names vertex {}, but the mesh has {} vertices, from 0 on",
                                     t, v, mesh.vertices.size()));
      const Point p = mesh.vertices[v];
      if (!isFinite(p))
        throw InputError(
            fmt::format("vertex {} is at ({}, {}, {}); coordinates are finite numbers", v, p.x, p.y, p.z));
    }
}

MeshFaults::List<MeshFaults::Edge> oddEdgesOf(const TriangleMesh& mesh, const Execution& execution) {
  checkMesh(mesh);
  MeshFaults::List<MeshFaults::Edge> odd;
  inArena(execution, [&] { odd = Inspector(mesh).oddEdges(); });
  return odd;
}

MeshFaults faultsOf(const TriangleMesh& mesh, const Execution& execution) {
  std::optional<MeshFaults> faults;
  inArena(execution, [&] { faults = Inspector(mesh).run(); });
  return std::move(*faults);
}

std::string describe(const MeshFaults& faults) {
  std::vector<std::string> parts;
  if (faults.empty) parts.emplace_back("it has no triangles");
  say(parts, faults.borders, "one edge belongs to one triangle only", "edges belong to one triangle only");
  say(parts, faults.crowded, "one edge belongs to more than two triangles",
      "edges belong to more than two triangles");
  say(parts, faults.inconsistent, "the two triangles of one edge are wound in opposite senses",
      "edges have two triangles that are wound in opposite senses");
  say(parts, faults.degenerate, "one triangle has no area", "triangles have no area");
  say(parts, faults.pinched, "one vertex joins surfaces that touch only there",
      "vertices join surfaces that touch only there");
  say(parts, faults.crossings, "one pair of triangles meets other than in a shared vertex or edge",
      "pairs of triangles meet other than in a shared vertex or edge");
  say(parts, faults.shells, "one shell is inside out or inside another",
      "shells are inside out or inside others");
  if (faults.inwards)
    parts.push_back(
        fmt::format("it is inside out, all triangles face inwards (signed volume {})", faults.volume));
  if (parts.empty()) return "nothing is wrong";
  std::string all = parts[0];
  for (std::size_t i = 1; i < parts.size(); ++i) all += ", and " + parts[i];
  return all;
}

}  // namespace restroke
