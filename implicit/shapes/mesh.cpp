// The solid inside a closed triangle mesh. Side test: the triangles that a ray towards +x passes through,
// counted with their sign by exact predicates (geometry/exact_predicates.h): candidates may be collected in
// any way, and the side is the same bits everywhere. A coarse grid of distances to the surface answers for
// points far from it.

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "implicit/errors.h"
#include "implicit/geometry/disjoint_sets.h"
#include "implicit/geometry/exact_predicates.h"
#include "implicit/geometry/mesh_crossings.h"
#include "implicit/geometry/mesh_faults.h"
#include "implicit/geometry/triangle_tree.h"
#include "implicit/sampling/poisson.h"
#include "implicit/shapes/kinds.h"
#include "implicit/volume.h"

namespace restroke::implicit {

namespace {

// Least cosine between the normals of triangles that count as one smooth face when samples are shared out.
constexpr double kSmooth = 0.7;
// Cells of the grid of distances along its longest side.
constexpr int kLeastCells = 24, kMostCells = 48;

double squaredDistance(DVec3 p, DVec3 a, DVec3 b, DVec3 c) {
  // Ericson, "Real-time collision detection", 2005, section 5.1.5: by the region of the triangle that is
  // nearest.
  const DVec3 ab = b - a, ac = c - a, ap = p - a;
  const auto square = [](DVec3 v) { return dot(v, v); };
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return square(ap);
  const DVec3 bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return square(bp);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return square(ap - d1 / (d1 - d3) * ab);
  const DVec3 cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return square(cp);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return square(ap - d2 / (d2 - d6) * ac);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return square(bp - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b));
  const double sum = va + vb + vc;
  return square(ap - vb / sum * ab - vc / sum * ac);
}

double squaredDistance(const Box& box, DVec3 p) {
  double sum = 0;
  for (int a = 0; a < 3; ++a) {
    const double d =
        std::max({static_cast<double>(box.min[a]) - p[a], p[a] - static_cast<double>(box.max[a]), 0.0});
    sum += d * d;
  }
  return sum;
}

class MeshVolume final : public VolumeOf<MeshVolume> {
 public:
  explicit MeshVolume(VolumeParameters parameters)
      : VolumeOf(meshKind(), checked(std::move(parameters))),
        mesh_(this->parameters().mesh->mesh),
        tree_(mesh_) {
    bounds_ = boundsOf(mesh_);
    const DVec3 center(bounds_.center());
    double radius = 0;
    for (const auto& triangle : mesh_.triangles)
      for (const std::uint32_t v : triangle)
        radius = std::max(radius, length(DVec3(mesh_.vertices[v]) - center));
    double area = 0;
    normals_.reserve(mesh_.triangles.size());
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      const DVec3 n = cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
      const double l = length(n);
      area += l / 2;
      normals_.push_back(n / l);
    }
    const Vec3 size = bounds_.max - bounds_.min;
    setMeasures({.center = center,
                 .radius = radius,
                 .area = area,
                 .volume = restroke::volumeOf(mesh_),
                 .thickness = static_cast<double>(std::min({size.x, size.y, size.z}))});
    makeColumns();
    makeGrid();
  }

  [[nodiscard]] bool inside(DVec3 p, double dilation) const {
    const double c = knownClearance(p);
    if (c > dilation) return false;
    if (c < 0) return true;
    if (encloses(p)) return true;
    return dilation > 0 && distanceWithin(p, dilation) <= dilation;
  }
  [[nodiscard]] double clearance(DVec3 p) const override {
    const double known = knownClearance(p);
    if (std::fabs(known) > 3 * cell_) return known;  // nearer, half a cell more or less matters
    const double distance = std::sqrt(nearest(p, std::numeric_limits<double>::max()).squared);
    return encloses(p) ? -distance : distance;
  }
  [[nodiscard]] DVec3 outwardNormal(DVec3 p) const override {
    return normals_[nearest(p, std::numeric_limits<double>::max()).triangle];
  }
  /// As geometry/mesh_crossings.h: ends are exact to a few units in the last place of the coordinates.
  void intersect(const Ray& ray, std::vector<RayInterval>& intervals) const override {
    std::vector<RayCrossing> crossings;
    findCrossings({mesh_, tree_, measures().radius}, ray, crossings);
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
      const double enter = crossings[i].t, exit = crossings[i + 1].t;
      if (!intervals.empty() && i > 0 && enter <= intervals.back().exit)
        intervals.back().exit = exit;  // it only passed from one piece to the next
      else if (enter < exit)
        intervals.push_back({enter, exit});
    }
  }
  [[nodiscard]] double support(DVec3 direction) const override {
    double most = -std::numeric_limits<double>::max();
    for (const auto& triangle : mesh_.triangles)
      for (const std::uint32_t v : triangle) most = std::max(most, dot(DVec3(mesh_.vertices[v]), direction));
    return most;
  }

 protected:
  [[nodiscard]] SampleTable makeSamples(std::uint32_t count) const override {
    const std::vector<std::uint32_t> regions = smoothRegions();
    std::vector<SurfaceTriangle> triangles;
    triangles.reserve(mesh_.triangles.size());
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      triangles.push_back({corner(t, 0), corner(t, 1), corner(t, 2), normals_[t], regions[t]});
    return SampleTable(samplePoisson(triangles, count));
  }
  [[nodiscard]] std::size_t ownBytes() const override {
    return (distances_.capacity() + firstInColumn_.capacity() + inColumns_.capacity()) * sizeof(float) +
           normals_.capacity() * sizeof(DVec3) +
           mesh_.triangles.size() * (sizeof(Box) + sizeof(std::uint32_t)) +
           tree_.nodes().size() * (sizeof(TriangleTree::Node) + sizeof(std::uint32_t));
  }

 private:
  static VolumeParameters checked(VolumeParameters parameters) {
    if (!parameters.mesh) throw InputError("a mesh lacks its triangles; it must name a file or have them");
    const MeshFaults faults = faultsOf(parameters.mesh->mesh);
    if (!faults.none())
      throw InputError(
          fmt::format("{} is no boundary of a solid: {}; every edge must be shared by two triangles that "
                      "face out and meet nothing else (--repair winding makes a solid of it)",
                      parameters.mesh->file.empty() ? "the mesh" : parameters.mesh->file, describe(faults)));
    return parameters;
  }
  [[nodiscard]] DVec3 corner(std::uint32_t t, std::size_t k) const {
    return DVec3(mesh_.vertices[mesh_.triangles[t][k]]);
  }
  [[nodiscard]] Triangle triangleAt(std::uint32_t t) const {
    const auto& v = mesh_.triangles[t];
    return {mesh_.vertices[v[0]], mesh_.vertices[v[1]], mesh_.vertices[v[2]]};
  }

  // By the grid: what the middle of p's cell knows, less the way there. 0 close to the surface.
  [[nodiscard]] double knownClearance(DVec3 p) const {
    int cell[3];
    double outside = 0;  // squared distance from the grid's box, which holds the mesh
    for (int a = 0; a < 3; ++a) {
      const double at = (p[a] - low_[a]) * cellsPerUnit_;
      const double beyond = std::max({low_[a] - p[a], p[a] - (low_[a] + cells_[a] * cell_), 0.0});
      outside += beyond * beyond;
      cell[a] = static_cast<int>(std::clamp(at, 0.0, static_cast<double>(cells_[a] - 1)));
    }
    if (outside > 0) return std::sqrt(outside);
    const double known = distances_[indexOf(cell[0], cell[1], cell[2])];
    const double way = length(p - middleOf(cell[0], cell[1], cell[2]));
    return known > 0 ? std::max(known - way, 0.0) : std::min(known + way, 0.0);
  }
  [[nodiscard]] bool encloses(DVec3 p) const {
    const double y = (p.y - columnLow_[0]) * columnsPerUnit_[0],
                 z = (p.z - columnLow_[1]) * columnsPerUnit_[1];
    if (!(y >= 0 && y < columns_[0] && z >= 0 && z < columns_[1])) return false;
    const std::size_t column =
        static_cast<std::size_t>(z) * static_cast<std::size_t>(columns_[0]) + static_cast<std::size_t>(y);
    int winding = 0;
    for (std::uint32_t k = firstInColumn_[column]; k < firstInColumn_[column + 1]; ++k) {
      const std::uint32_t t = inColumns_[k];
      const Box& box = tree_.boxOf(t);
      if (static_cast<double>(box.max.x) < p.x || static_cast<double>(box.min.y) > p.y ||
          static_cast<double>(box.max.y) < p.y || static_cast<double>(box.min.z) > p.z ||
          static_cast<double>(box.max.z) < p.z)
        continue;
      const Triangle triangle = triangleAt(t);
      winding += crossingOf(triangle, p);
      if (static_cast<double>(box.min.x) <= p.x && isOn(triangle, p)) return true;
    }
    return winding != 0;
  }
  // Which triangles a ray towards +x may meet, by the square of y and z that it starts in. Rounding is
  // monotone, so that a triangle is listed wherever a point in its box is looked up.
  void makeColumns() {
    const Vec3 size = bounds_.max - bounds_.min;
    const double longest = static_cast<double>(std::max(size.y, size.z));
    const double along = std::clamp(std::sqrt(static_cast<double>(mesh_.triangles.size())), 16.0, 1024.0);
    for (int a = 0; a < 2; ++a) {
      columnLow_[a] = static_cast<double>(bounds_.min[a + 1]);
      columnsPerUnit_[a] = along / longest;
      columns_[a] = static_cast<int>(static_cast<double>(size[a + 1]) * columnsPerUnit_[a] * (1 + 1e-6)) + 1;
    }
    firstInColumn_.assign(static_cast<std::size_t>(columns_[0]) * static_cast<std::size_t>(columns_[1]) + 1,
                          0);
    const auto forColumns = [&](std::uint32_t t, const auto& f) {
      int lo[2], hi[2];
      for (int a = 0; a < 2; ++a) {
        const auto columnOf = [&](float v) {
          return static_cast<int>((static_cast<double>(v) - columnLow_[a]) * columnsPerUnit_[a]);
        };
        lo[a] = columnOf(tree_.boxOf(t).min[a + 1]);
        hi[a] = columnOf(tree_.boxOf(t).max[a + 1]);
      }
      for (int z = lo[1]; z <= hi[1]; ++z)
        for (int y = lo[0]; y <= hi[0]; ++y)
          f(static_cast<std::size_t>(z) * static_cast<std::size_t>(columns_[0]) +
            static_cast<std::size_t>(y));
    };
    const auto count = static_cast<std::uint32_t>(mesh_.triangles.size());
    for (std::uint32_t t = 0; t < count; ++t)
      forColumns(t, [&](std::size_t column) { ++firstInColumn_[column + 1]; });
    std::partial_sum(firstInColumn_.begin(), firstInColumn_.end(), firstInColumn_.begin());
    inColumns_.resize(firstInColumn_.back());
    std::vector<std::uint32_t> next(firstInColumn_.begin(), firstInColumn_.end() - 1);
    for (std::uint32_t t = 0; t < count; ++t)
      forColumns(t, [&](std::size_t column) { inColumns_[next[column]++] = t; });
  }

  struct Nearest {
    std::uint32_t triangle = 0;
    double squared = std::numeric_limits<double>::max();
  };
  // The nearest triangle, if one is nearer than `most`.
  [[nodiscard]] Nearest nearest(DVec3 p, double most) const {
    Nearest best;
    if (most < 1e150) best.squared = most * most * (1 + 1e-12);
    const auto nodes = tree_.nodes();
    std::array<std::uint32_t, 128> stack;  // a tree that halves is at most 32 deep
    std::size_t size = 0;
    stack[size++] = 0;
    while (size > 0) {
      const std::uint32_t n = stack[--size];
      const TriangleTree::Node& node = nodes[n];
      if (squaredDistance(node.box, p) >= best.squared) continue;
      if (node.right == 0) {
        for (const std::uint32_t t : tree_.order().subspan(node.first, node.count)) {
          const double d = squaredDistance(p, corner(t, 0), corner(t, 1), corner(t, 2));
          if (d < best.squared) best = {t, d};
        }
        continue;
      }
      // The nearer child is looked at first.
      const bool leftFirst =
          squaredDistance(nodes[n + 1].box, p) <= squaredDistance(nodes[node.right].box, p);
      stack[size++] = leftFirst ? node.right : n + 1;
      stack[size++] = leftFirst ? n + 1 : node.right;
    }
    return best;
  }
  [[nodiscard]] double distanceWithin(DVec3 p, double most) const {
    return std::sqrt(nearest(p, most).squared);
  }

  // Regions of triangles that meet smoothly, numbered from 0.
  [[nodiscard]] std::vector<std::uint32_t> smoothRegions() const {
    DisjointSets regions(mesh_.triangles.size());
    struct Edge {
      std::uint32_t from, to, triangle;
    };
    std::vector<Edge> edges;
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = mesh_.triangles[t][k], b = mesh_.triangles[t][(k + 1) % 3];
        edges.push_back({std::min(a, b), std::max(a, b), t});
      }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
      return std::tie(a.from, a.to, a.triangle) < std::tie(b.from, b.to, b.triangle);
    });
    for (std::size_t i = 0; i + 1 < edges.size(); ++i)
      if (edges[i].from == edges[i + 1].from && edges[i].to == edges[i + 1].to &&
          dot(normals_[edges[i].triangle], normals_[edges[i + 1].triangle]) > kSmooth)
        regions.unite(edges[i].triangle, edges[i + 1].triangle);
    std::vector<std::uint32_t> numbers(mesh_.triangles.size());
    std::uint32_t count = 0;
    for (std::uint32_t t = 0; t < numbers.size(); ++t) {
      const std::uint32_t root = regions.find(t);
      numbers[t] = root == t ? count++ : numbers[root];  // a root is the first of its region
    }
    return numbers;
  }

  [[nodiscard]] std::size_t indexOf(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(cells_[1]) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(cells_[0]) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] DVec3 middleOf(int x, int y, int z) const {
    return low_ + cell_ * DVec3(x + 0.5, y + 0.5, z + 0.5);
  }

  void makeGrid() {
    // As many cells as triangles, about, so that a cell holds few.
    const DVec3 size(bounds_.max - bounds_.min);
    const double longest = std::max({size.x, size.y, size.z});
    const int along = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(mesh_.triangles.size()))),
                                 kLeastCells, kMostCells);
    cell_ = longest / along * 1.000001;
    cellsPerUnit_ = 1 / cell_;
    low_ = DVec3(bounds_.min) - DVec3(longest * 2e-7);
    for (int a = 0; a < 3; ++a) cells_[a] = std::max(1, static_cast<int>(size[a] / cell_) + 1);
    distances_.resize(static_cast<std::size_t>(cells_[0]) * static_cast<std::size_t>(cells_[1]) *
                      static_cast<std::size_t>(cells_[2]));
    tbb::parallel_for(0, cells_[2], [&](int z) {
      for (int y = 0; y < cells_[1]; ++y)
        for (int x = 0; x < cells_[0]; ++x) {
          const DVec3 p = middleOf(x, y, z);
          // Rounded towards 0, so that float32 promises no more than was measured.
          const double d = std::sqrt(nearest(p, std::numeric_limits<double>::max()).squared) * (1 - 1e-6);
          distances_[indexOf(x, y, z)] = static_cast<float>(encloses(p) ? -d : d);
        }
    });
  }

  const TriangleMesh& mesh_;
  TriangleTree tree_;
  Box bounds_;
  std::vector<DVec3> normals_;
  // Squares of y and z, row by row: the triangles above each.
  double columnLow_[2] = {0, 0}, columnsPerUnit_[2] = {1, 1};
  int columns_[2] = {1, 1};
  std::vector<std::uint32_t> firstInColumn_, inColumns_;
  // Signed distances from the middles of cells to the surface.
  std::vector<float> distances_;
  DVec3 low_{0};
  double cell_ = 1, cellsPerUnit_ = 1;
  int cells_[3] = {1, 1, 1};
};

// Meshes that are made rather than read: a star's prism and a trefoil knot.
std::shared_ptr<const MeshSource> starPrism() {
  auto source = std::make_shared<MeshSource>();
  TriangleMesh& mesh = source->mesh;
  // Ten corners around, far and near by turns; on a circle of radius 1 in steps of a tenth of a turn.
  const double cosine[10] = {
      1,  0.8090169943749475,  0.30901699437494745,  -0.30901699437494745, -0.8090169943749475,
      -1, -0.8090169943749475, -0.30901699437494745, 0.30901699437494745,  0.8090169943749475};
  const double sine[10] = {
      0, 0.5877852522924731,  0.9510565162951535,  0.9510565162951535,  0.5877852522924731,
      0, -0.5877852522924731, -0.9510565162951535, -0.9510565162951535, -0.5877852522924731};
  for (const float z : {-0.3f, 0.3f})
    for (int i = 0; i < 10; ++i) {
      const double r = i % 2 == 0 ? 0.9 : 0.42;
      mesh.vertices.emplace_back(static_cast<float>(r * cosine[i]), static_cast<float>(r * sine[i]), z);
    }
  mesh.vertices.emplace_back(0.0f, 0.0f, -0.3f);
  mesh.vertices.emplace_back(0.0f, 0.0f, 0.3f);
  for (std::uint32_t i = 0; i < 10; ++i) {
    const std::uint32_t j = (i + 1) % 10;
    mesh.triangles.push_back({20, j, i});
    mesh.triangles.push_back({21, 10 + i, 10 + j});
    mesh.triangles.push_back({i, j, 10 + j});
    mesh.triangles.push_back({i, 10 + j, 10 + i});
  }
  return source;
}

}  // namespace

const VolumeKind& meshKind() {
  static const VolumeKind kind{
      .name = "mesh",
      .summary = "the solid inside a closed triangle mesh, from an STL, PLY, OBJ, OFF, 3MF or AMF file",
      .parameters = {{.name = "mesh",
                      .meaning = "the boundary of a solid: closed, facing out, meeting itself nowhere",
                      .form = ParameterInfo::Form::Mesh}},
      .make = [](const VolumeParameters& p) -> std::shared_ptr<const Volume> {
        return std::make_shared<MeshVolume>(p);
      },
      .examples = [] { return std::vector<VolumeParameters>{{{{}}, starPrism()}}; }};
  return kind;
}

}  // namespace restroke::implicit
