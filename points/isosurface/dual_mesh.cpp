// Schaefer, Ju, Warren, "Manifold dual contouring", IEEE TVCG 2007, on a uniform grid: a vertex for each
// patch (cell_patches.cpp), placed by the tangent planes of its crossings (qef.cpp).
//
// Ju, Udeshi, "Intersection-free contouring on an octree grid", Pacific Graphics 2006, is where the safe
// triangles come from: a fan about the crossing on the edge, and a further vertex on the face between two
// cells. There they are used wherever a local test fails; here wherever triangles were found to meet, and the
// test is exact.

#include "points/isosurface/dual_mesh.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "implicit/errors.h"

namespace restroke::points {

namespace {

using implicit::Side;

// Vertices within a cell keep this distance from its boundary, in cells: those of neighbouring cells then
// differ.
constexpr double kInset = 0x1p-9;
// The crossings from which safe vertices are made keep this distance from the ends of their edges, in cells.
constexpr float kSafeInset = 0x1p-6f;
// A vertex leaves its cell only if the solid changes sides within this distance of its new place, in cells.
constexpr double kProbe = 0.125;
// Planes that a point misses by less than this (root mean square, in cells) have the point on them.
constexpr double kSamePlanes = 0.03;
// Two triangles of a quad that are bent more than this (cosine of the angle between their normals) are
// folded.
constexpr double kFolded = -0.7;

// The four cells around an edge along axis a, counter-clockwise seen from +a: offsets along a + 1 and a + 2.
constexpr std::array<std::array<int, 2>, 4> kAround{{{-1, -1}, {0, -1}, {0, 0}, {-1, 0}}};

GridIndex cellAround(const GridEdge& edge, int k) {
  GridIndex cell = edge.low;
  cell[static_cast<std::size_t>((edge.axis + 1) % 3)] += kAround[static_cast<std::size_t>(k)][0];
  cell[static_cast<std::size_t>((edge.axis + 2) % 3)] += kAround[static_cast<std::size_t>(k)][1];
  return cell;
}

// The edge's number within that cell.
int edgeWithin(const GridEdge& edge, int k) {
  return 4 * edge.axis - kAround[static_cast<std::size_t>(k)][0] -
         2 * kAround[static_cast<std::size_t>(k)][1];
}

// The face of that cell through which the next one is reached: towards +(a + 1), +(a + 2), -(a + 1), -(a +
// 2).
int faceAfter(const GridEdge& edge, int k) {
  return 2 * ((edge.axis + 1 + k % 2) % 3) + (k < 2 ? 1 : 0);
}

GridIndex across(GridIndex cell, int face) {
  cell[static_cast<std::size_t>(face / 2)] += face % 2 == 0 ? -1 : 1;
  return cell;
}

// Are all planes through this point?
bool meetAt(const Qef& qef, DVec3 place) {
  return qef.errorAt(place) <= kSamePlanes * kSamePlanes * qef.count();
}

template <class F>
void forRows(const SideGrid& grid, const F& f) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, grid.rows(), 16),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t row = range.begin(); row < range.end(); ++row) f(row);
                    });
}

GridIndex stepped(GridIndex i, int axis) {
  ++i[static_cast<std::size_t>(axis)];
  return i;
}

}  // namespace

DualMesh::DualMesh(const SideGrid& grid, const ContourSource& source) : grid_(grid) {
  RESTROKE_CHECK_LE(grid.edgeCount(), kMaxQuads);
  findCrossings(source);
  findPatches(source);
  placePatches();
  placeSharp(source);
  findQuads();
  splits_.assign(quads_.size(), Split::Diagonal02);
  chooseSplits(std::vector<bool>(quads_.size(), true));
}

void DualMesh::findCrossings(const ContourSource& source) {
  crossings_.resize(grid_.edgeCount());
  forRows(grid_, [&](std::size_t row) {
    for (int axis = 0; axis < 3; ++axis)
      grid_.forEdgesOf(axis, row, [&](std::size_t number, const GridEdge& edge) {
        const Point low = grid_.at(edge.low), high = grid_.at(stepped(edge.low, axis));
        const bool lowInside = grid_.inside(edge.low);
        const Crossing c = lowInside ? source.crossing(low, high) : source.crossing(high, low);
        EdgeCrossing& out = crossings_[number];
        const double from = static_cast<double>(low[axis]), to = static_cast<double>(high[axis]);
        // Whatever the source answers, the crossing is on the edge and has a direction.
        out.along =
            std::isfinite(c.position[axis]) ? std::clamp(c.position[axis], from, to) : (from + to) / 2;
        const double size = length(c.normal);
        DVec3 normal(0);
        normal[axis] = lowInside ? 1 : -1;
        if (std::isfinite(size) && size > 0) normal = c.normal / size;
        out.normal = Vec3(normal);
        const float inset = (high[axis] - low[axis]) * kSafeInset;
        out.safe = low;
        out.safe[axis] = std::clamp(static_cast<float>(out.along), low[axis] + inset, high[axis] - inset);
      });
  });
}

bool DualMesh::isCut(GridIndex cell) const {
  const std::uint8_t corners = grid_.cornersOf(cell);
  return corners != 0 && corners != 0xff;
}

DualMesh::CutCell DualMesh::readCell(GridIndex cell, const ContourSource& source) const {
  CutCell out{0, grid_.cornersOf(cell), 0, 0};
  const std::uint8_t ambiguous = isCheckerboard(out.corners) ? 0 : ambiguousFacesOf(out.corners);
  for (int face = 0; face < 6; ++face) {
    if ((ambiguous >> face & 1) == 0 || isCheckerboard(grid_.cornersOf(across(cell, face)))) continue;
    // The same point, bit for bit, from both cells.
    const int axis = face / 2;
    const Point low = grid_.at(cell), high = grid_.at({cell[0] + 1, cell[1] + 1, cell[2] + 1});
    Point center = low + (high - low) * 0.5f;
    center[axis] = face % 2 == 0 ? low[axis] : high[axis];
    Side side = Side::Outside;
    source.sides({&center, 1}, {&side, 1});
    if (side == Side::Inside) out.joinedFaces = static_cast<std::uint8_t>(out.joinedFaces | 1u << face);
  }
  out.doubleFaces = patchesOf(out.corners, out.joinedFaces).doubleFaces;
  return out;
}

void DualMesh::findPatches(const ContourSource& source) {
  cells_.resize(grid_.cellCount());
  forRows(grid_, [&](std::size_t row) {
    grid_.forCellsOf(row,
                     [&](std::size_t number, GridIndex cell) { cells_[number] = readCell(cell, source); });
  });
  std::uint32_t count = 0;
  for (CutCell& cell : cells_) {
    cell.firstPatch = count;
    count += patchesOf(cell.corners, cell.joinedFaces).count;
  }
  patches_.resize(count);
}

DVec3 DualMesh::centerOf(GridIndex cell) const {
  return (DVec3(grid_.at(cell)) + DVec3(grid_.at({cell[0] + 1, cell[1] + 1, cell[2] + 1}))) * 0.5;
}

DVec3 DualMesh::positionOf(const GridEdge& edge, const EdgeCrossing& crossing) const {
  DVec3 p(grid_.at(edge.low));
  p[edge.axis] = crossing.along;
  return p;
}

void DualMesh::placePatches() {
  forRows(grid_, [&](std::size_t row) {
    thread_local std::vector<std::uint32_t> numbers;  // of the row's patches, and their sums
    thread_local std::vector<DVec3> safeSums;
    numbers.clear();
    safeSums.clear();
    grid_.forCellsOf(row, [&](std::size_t number, GridIndex cell) {
      const CutCell& cut = cells_[number];
      const CellPatches topology = patchesOf(cut.corners, cut.joinedFaces);
      const DVec3 center = centerOf(cell);
      std::array<DVec3, 4> safeSum{};
      for (int e = 0; e < 12; ++e) {
        const std::uint8_t patch = topology.ofEdge[static_cast<std::size_t>(e)];
        if (patch == kNoPatch) continue;
        const int corner = lowCornerOf(e);
        const GridEdge edge{e / 4,
                            {cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2)}};
        const EdgeCrossing& crossing = crossings_[grid_.numberOf(edge)];
        patches_[cut.firstPatch + patch].qef.add((positionOf(edge, crossing) - center) / grid_.cell(),
                                                 DVec3(crossing.normal));
        safeSum[patch] += DVec3(crossing.safe);
      }
      for (std::uint8_t k = 0; k < topology.count; ++k) {
        patches_[cut.firstPatch + k].cell = cell;
        patches_[cut.firstPatch + k].isOnly = topology.count == 1;
        numbers.push_back(cut.firstPatch + k);
        safeSums.push_back(safeSum[k]);
      }
    });
    for (std::size_t i = 0; i < numbers.size(); i += Qef::kBatch) {
      // The last one stands in for what a batch lacks.
      Qef::Batch batch;
      for (std::size_t k = 0; k < Qef::kBatch; ++k)
        batch[k] = &patches_[numbers[std::min(i + k, numbers.size() - 1)]].qef;
      std::array<Qef::Minimum, Qef::kBatch> minima;
      Qef::minimaWithin(0.5 - kInset, batch, minima);
      for (std::size_t k = 0; k < std::min(Qef::kBatch, numbers.size() - i); ++k)
        placePatch(numbers[i + k], minima[k], safeSums[i + k]);
    }
  });
}

// Strictly within the cell, however float32 rounds.
Point DualMesh::within(GridIndex cell, Point p) const {
  const Point low = grid_.at(cell), high = grid_.at({cell[0] + 1, cell[1] + 1, cell[2] + 1});
  for (int a = 0; a < 3; ++a)
    p[a] = std::clamp(p[a], std::nextafter(low[a], high[a]), std::nextafter(high[a], low[a]));
  return p;
}

void DualMesh::placePatch(std::uint32_t number, const Qef::Minimum& best, DVec3 safeSum) {
  Patch& patch = patches_[number];
  patch.rank = static_cast<std::uint8_t>(best.rank);
  patch.at[1] = within(patch.cell, Point(centerOf(patch.cell) + best.position * grid_.cell()));
  patch.at[2] = within(patch.cell, Point(safeSum / static_cast<double>(patch.qef.count())));
}

// Where a patch's planes meet, when that is in another cell. An edge of the solid may come so close to a grid
// edge that its tip pokes through a face into a cell with no corner inside, of which nothing else is known:
// up to half a cell of a right-angled edge would be lost. Or the other cell sees fewer of the planes, as
// beside a corner.
std::optional<DualMesh::Claim> DualMesh::claimOf(std::uint32_t number, const ContourSource& source) const {
  const Patch& patch = patches_[number];
  if (patch.rank < 2) return std::nullopt;
  const DVec3 place = patch.qef.minimum().position, outwards = patch.qef.normals();
  Claim claim{patch.cell, patch.rank, 0, number, centerOf(patch.cell) + place * grid_.cell()};
  for (int a = 0; a < 3; ++a) {
    const double beyond = std::max(0.0, std::fabs(place[a]) - 0.5);
    if (!(beyond < 1) || (beyond > 0 && beyond < kInset))
      return std::nullopt;  // too far; as good as in the cell
    int& target = claim.target[static_cast<std::size_t>(a)];
    target += place[a] < -0.5 ? -1 : place[a] > 0.5 ? 1 : 0;
    if (target < 0 || target > grid_.points()[static_cast<std::size_t>(a)] - 2) return std::nullopt;
    claim.distance += beyond * beyond;
  }
  const double size = length(outwards);
  if (claim.target == patch.cell || !(size > 0)) return std::nullopt;
  const DVec3 step = outwards * (kProbe * grid_.cell() / size);
  const std::array<Point, 2> probes{Point(claim.place - step), Point(claim.place + step)};
  std::array<Side, 2> sides{};
  source.sides(probes, sides);
  if (sides[0] != Side::Inside || sides[1] != Side::Outside) return std::nullopt;
  return claim;
}

// No two vertices in one cell: those of neighbours that saw the same tip would be the same point. The best
// claim on a cell without a vertex moves its patch there; on a cell with one that knows less, it moves that
// one.
void DualMesh::placeSharp(const ContourSource& source) {
  std::vector<std::uint32_t> sharp;
  for (std::uint32_t p = 0; p < patches_.size(); ++p)
    if (patches_[p].rank >= 2) sharp.push_back(p);
  std::vector<std::optional<Claim>> claims(sharp.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sharp.size(), 256),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i < range.end(); ++i)
                        claims[i] = claimOf(sharp[i], source);
                    });
  std::map<GridIndex, Claim> best;
  for (const std::optional<Claim>& claim : claims) {
    if (!claim) continue;
    const auto [it, isFirst] = best.emplace(claim->target, *claim);
    const auto merit = [](const Claim& c) { return std::tuple(-c.rank, c.distance, c.patch); };
    if (!isFirst && merit(*claim) < merit(it->second)) it->second = *claim;
  }
  for (const auto& [cell, claim] : best) {
    if (!isCut(cell)) {
      patches_[claim.patch].at[0] = within(cell, Point(claim.place));
      patches_[claim.patch].place = VertexPlace::NextCell;
      continue;
    }
    const CutCell& cut = cells_[grid_.numberOf(cell)];
    if (patchesOf(cut.corners, cut.joinedFaces).count != 1) continue;
    Patch& patch = patches_[cut.firstPatch];
    if (patch.rank < claim.rank && meetAt(patch.qef, (claim.place - centerOf(cell)) / grid_.cell()))
      patch.at[1] = within(cell, Point(claim.place));
  }
}

Point DualMesh::positionOf(std::uint32_t patch) const {
  const Patch& p = patches_[patch];
  return p.at[p.place == VertexPlace::NextCell ? 0 : p.place == VertexPlace::MeanCone ? 2 : 1];
}

void DualMesh::findQuads() {
  quads_.resize(grid_.edgeCount());
  doubleSides_.resize(grid_.edgeCount());
  forRows(grid_, [&](std::size_t row) {
    for (int axis = 0; axis < 3; ++axis)
      grid_.forEdgesOf(axis, row, [&](std::size_t number, const GridEdge& edge) {
        Quad& quad = quads_[number];
        std::array<std::uint8_t, 4> doubleFaces{};
        for (std::size_t k = 0; k < 4; ++k) {
          const int i = static_cast<int>(k);
          const CutCell& cell = cells_[grid_.numberOf(cellAround(edge, i))];
          doubleFaces[k] = cell.doubleFaces;
          quad[k] =
              cell.firstPatch +
              patchesOf(cell.corners, cell.joinedFaces).ofEdge[static_cast<std::size_t>(edgeWithin(edge, i))];
        }
        const bool outwards = grid_.inside(edge.low);
        for (std::size_t k = 0; k < 4; ++k) {
          const int face = faceAfter(edge, static_cast<int>(k));
          if ((doubleFaces[k] >> face & 1) != 0 && (doubleFaces[(k + 1) % 4] >> (face ^ 1) & 1) != 0)
            doubleSides_[number] =
                static_cast<std::uint8_t>(doubleSides_[number] | 1u << (outwards ? k : 3 - k));
        }
        if (!outwards) std::swap(quad[1], quad[3]);
      });
  });
}

void DualMesh::chooseSplits(const std::vector<bool>& chosen) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, quads_.size(), 256),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t q = range.begin(); q < range.end(); ++q)
                        if (chosen[q] && splits_[q] != Split::Fan) splits_[q] = chooseDiagonal(quads_[q]);
                    });
}

// The diagonal whose middle is nearer to the planes around: along a sharp edge, not across it.
DualMesh::Split DualMesh::chooseDiagonal(const Quad& quad) const {
  std::array<DVec3, 4> p;
  for (std::size_t i = 0; i < 4; ++i) p[i] = DVec3(positionOf(quad[i]));
  struct Choice {
    double error = 0, bend = 0, squaredLength = 0;
  };
  const auto choiceOf = [&](std::size_t i) {
    const DVec3 a = p[i], b = p[(i + 1) % 4], c = p[(i + 2) % 4], d = p[(i + 3) % 4];
    Choice choice;
    for (const std::uint32_t patch : quad)
      choice.error +=
          patches_[patch].qef.errorAt(((a + c) * 0.5 - centerOf(patches_[patch].cell)) / grid_.cell());
    const DVec3 n = cross(b - a, c - a), m = cross(c - a, d - a);
    const double sizes = length(n) * length(m);
    choice.bend = sizes > 0 ? dot(n, m) / sizes : -2;
    choice.squaredLength = dot(c - a, c - a) / (grid_.cell() * grid_.cell());
    return choice;
  };
  const Choice first = choiceOf(0), second = choiceOf(1);
  const bool firstFolds = first.bend < kFolded, secondFolds = second.bend < kFolded;
  if (firstFolds != secondFolds) return firstFolds ? Split::Diagonal13 : Split::Diagonal02;
  // Below this (in squared cells) both are as good as on the surface.
  constexpr double kSame = 1e-6;
  if (std::fabs(first.error - second.error) > kSame)
    return first.error < second.error ? Split::Diagonal02 : Split::Diagonal13;
  return second.squaredLength < first.squaredLength ? Split::Diagonal13 : Split::Diagonal02;
}

// The other edge of the two whose quads share the side between the cells `side` and `side` + 1 around an
// edge.
std::uint32_t DualMesh::partnerAcross(const GridEdge& edge, int side) const {
  const GridIndex cell = cellAround(edge, side);
  const CutCell& cut = cells_[grid_.numberOf(cell)];
  const int other = otherEnd(
      cut.corners, cut.joinedFaces,
      {static_cast<std::uint8_t>(faceAfter(edge, side)), static_cast<std::uint8_t>(edgeWithin(edge, side))});
  const int corner = lowCornerOf(other);
  return static_cast<std::uint32_t>(grid_.numberOf(
      GridEdge{other / 4, {cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2)}}));
}

DualMesh::Triangles DualMesh::triangles() const {
  Triangles out;
  TriangleMesh& mesh = out.mesh;
  // The fans one after the other, as they number their vertices; where each quad's triangles begin.
  struct Fan {
    std::uint32_t quad;
    GridEdge edge;
  };
  std::vector<std::vector<Fan>> fansOfRows(3 * grid_.rows());
  forRows(grid_, [&](std::size_t row) {
    for (int axis = 0; axis < 3; ++axis)
      grid_.forEdgesOf(axis, row, [&](std::size_t number, const GridEdge& edge) {
        const auto q = static_cast<std::uint32_t>(number);
        if (isFan(q)) fansOfRows[static_cast<std::size_t>(axis) * grid_.rows() + row].push_back({q, edge});
      });
  });
  mesh.vertices.resize(patches_.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, patches_.size(), 4096),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i < range.end(); ++i)
                        mesh.vertices[i] = positionOf(static_cast<std::uint32_t>(i));
                    });
  const auto newVertex = [&](Point p) {
    mesh.vertices.push_back(p);
    return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  };
  using Corners = std::array<std::uint32_t, 3>;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> onFaces;  // by the two crossed edges
  std::vector<std::uint32_t> fans, fanEnds;  // the fans' quads, and where their triangles end in the next
  std::vector<Corners> fanTriangles;
  for (const std::vector<Fan>& ofRow : fansOfRows)
    for (const auto& [q, edge] : ofRow) {
      const Quad& quad = quads_[q];
      const std::uint32_t middle = newVertex(crossings_[q].safe);
      for (int i = 0; i < 4; ++i) {
        const std::uint32_t from = quad[static_cast<std::size_t>(i)],
                            to = quad[static_cast<std::size_t>((i + 1) % 4)];
        if (!isCone(from) && !isCone(to) && (doubleSides_[q] >> i & 1) == 0) {
          fanTriangles.push_back({middle, from, to});
          continue;
        }
        const std::uint32_t other = partnerAcross(edge, grid_.inside(edge.low) ? i : 3 - i);
        const auto [it, isNew] = onFaces.emplace(std::minmax(q, other), 0);
        if (isNew) it->second = newVertex((crossings_[q].safe + crossings_[other].safe) * 0.5f);
        fanTriangles.push_back({middle, from, it->second});
        fanTriangles.push_back({middle, it->second, to});
      }
      fans.push_back(q);
      fanEnds.push_back(static_cast<std::uint32_t>(fanTriangles.size()));
    }
  // Quads between fans have two triangles each.
  const std::size_t count = 2 * (quads_.size() - fans.size()) + fanTriangles.size();
  mesh.triangles.resize(count);
  out.quad.resize(count);
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, quads_.size(), 4096),
      [&](const tbb::blocked_range<std::size_t>& range) {
        auto fan = static_cast<std::size_t>(
            std::lower_bound(fans.begin(), fans.end(), static_cast<std::uint32_t>(range.begin())) -
            fans.begin());
        std::size_t fanAt = fan > 0 ? fanEnds[fan - 1] : 0, at = 2 * (range.begin() - fan) + fanAt;
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          const auto q = static_cast<std::uint32_t>(i);
          const std::size_t first = at;
          if (fan < fans.size() && fans[fan] == q) {
            for (; fanAt < fanEnds[fan]; ++fanAt) mesh.triangles[at++] = fanTriangles[fanAt];
            ++fan;
          } else {
            const Quad& quad = quads_[q];
            const std::size_t k = splits_[q] == Split::Diagonal02 ? 0 : 1;
            mesh.triangles[at++] = {quad[k], quad[k + 1], quad[k + 2]};
            mesh.triangles[at++] = {quad[k], quad[k + 2], quad[(k + 3) % 4]};
          }
          std::fill(out.quad.begin() + static_cast<std::ptrdiff_t>(first),
                    out.quad.begin() + static_cast<std::ptrdiff_t>(at), q);
        }
      });
  return out;
}

bool DualMesh::isFan(std::uint32_t quad) const {
  if (splits_[quad] == Split::Fan || doubleSides_[quad] != 0) return true;
  for (const std::uint32_t patch : quads_[quad])
    if (isCone(patch)) return true;
  return false;
}

// The argument for quads that need no test. Let the cells around an edge e have one patch each, whose vertex
// is in its cell; let the segment between the vertices of two neighbours cross their common face, in f; and
// let the diagonal of the quad pass e on the side of vertex d through the triangle (e, d), and the other
// three vertices' triangle meet e between its ends. All of it is to be strictly so. Then the quad lies in the
// four tetrahedra (e, v, v') of neighbours v, v', and touches their boundary only in those segments and
// within e. Of such a tetrahedron the half in a cell is the cone from the cell's vertex over the triangle (e,
// f) of its boundary. These triangles overlap for no two edges of a cell: f is one point for each face, since
// both cells beside it have but one patch, and faces that are crossed twice by the same two patches make
// fans. So no two such quads meet but where they share vertices and sides.
bool DualMesh::isInOrder(std::uint32_t number, const GridEdge& edge) const {
  if (splits_[number] == Split::Fan || doubleSides_[number] != 0) return false;
  Quad quad = quads_[number];
  if (!grid_.inside(edge.low)) std::swap(quad[1], quad[3]);  // as kAround has them
  for (const std::uint32_t v : quad)
    if (patches_[v].place != VertexPlace::InCell || !patches_[v].isOnly) return false;
  const int u = (edge.axis + 1) % 3, v = (edge.axis + 2) % 3;
  const auto a = static_cast<std::size_t>(edge.axis);
  GridIndex before = edge.low, after = edge.low;
  for (std::size_t i = 0; i < 3; ++i) {
    if (i != a) --before[i];
    ++after[i];
  }
  // In cells, from the edge's lower end.
  const DVec3 origin(grid_.at(edge.low));
  const double scale = 1 / grid_.cell();
  const DVec3 least = (DVec3(grid_.at(before)) - origin) * scale,
              most = (DVec3(grid_.at(after)) - origin) * scale;
  const double top = most[edge.axis];
  struct Local {
    double x, y, z;
  };
  std::array<Local, 4> p;
  for (std::size_t k = 0; k < 4; ++k) {
    const DVec3 d = (DVec3(positionOf(quad[k])) - origin) * scale;
    p[k] = {d[u], d[v], d[edge.axis]};
  }
  // Far more than rounding, in cells: the coordinates are float32 numbers, of which a cell has 64 or more.
  constexpr double kSure = 1e-9;
  const auto between = [](double low, double x, double high) { return x > low + kSure && x < high - kSure; };
  // The faces between the cells k and k + 1: towards -y, +x, +y, -x.
  for (std::size_t k = 0; k < 4; ++k) {
    const Local &s = p[k], &t = p[(k + 1) % 4];
    const bool isAcrossX = k % 2 == 0;
    const double from = isAcrossX ? s.x : s.y, to = isAcrossX ? t.x : t.y;
    if (!(std::fabs(to - from) > 1e-6)) return false;
    const double part = from / (from - to);
    const double along = isAcrossX ? s.y + part * (t.y - s.y) : s.x + part * (t.x - s.x),
                 z = s.z + part * (t.z - s.z);
    const double low = k == 0   ? least[v]
                       : k == 3 ? least[u]
                                : 0,
                 high = k == 1   ? most[u]
                        : k == 2 ? most[v]
                                 : 0;
    if (!between(low, along, high) || !between(0, z, top)) return false;
  }
  const auto area = [](const Local& s, const Local& t) { return s.x * t.y - s.y * t.x; };
  const std::size_t i = splits_[number] == Split::Diagonal02 ? 0 : 1;
  const Local &s = p[i], &t = p[i + 2];
  const double side = area(s, t);
  // Counter-clockwise the vertices are s, p[i + 1], t, p[i + 3]: the diagonal passes the edge on the side of
  // d.
  const Local &next = p[i + 1], &last = p[(i + 3) % 4];
  const Local &d = side > 0 ? next : last, &other = side > 0 ? last : next;
  const double ws = area(other, t), wt = area(s, other), wo = -side, sum = ws + wt + wo;
  if (!(std::fabs(sum) > 1e-6)) return false;
  if (!between(0, (ws * s.z + wt * t.z + wo * other.z) / sum, top)) return false;
  const double cut = area(s, d), whole = cut - area(t, d);
  if (!(std::fabs(whole) > 1e-6)) return false;
  const double part = cut / whole;
  if (!between(0, part, 1)) return false;
  const Local w{s.x + part * (t.x - s.x), s.y + part * (t.y - s.y), s.z + part * (t.z - s.z)};
  const double size = d.x * d.x + d.y * d.y;
  if (!(size > 1e-6)) return false;
  const double out = (w.x * d.x + w.y * d.y) / size;
  return between(0, out, 1) && between(out * d.z, w.z, out * d.z + (1 - out) * top);
}

std::vector<bool> DualMesh::doubtfulQuads() const {
  std::vector<std::uint8_t> inOrder(quads_.size());
  forRows(grid_, [&](std::size_t row) {
    for (int axis = 0; axis < 3; ++axis)
      grid_.forEdgesOf(axis, row, [&](std::size_t number, const GridEdge& edge) {
        inOrder[number] = isInOrder(static_cast<std::uint32_t>(number), edge) ? 1 : 0;
      });
  });
  std::vector<bool> doubtful(quads_.size());
  for (std::size_t q = 0; q < quads_.size(); ++q) doubtful[q] = inOrder[q] == 0;
  return doubtful;
}

std::vector<bool> DualMesh::makeSafer(const Triangles& triangles, std::span<const TrianglePair> pairs) {
  // All decisions are about the mesh as it was, whatever the order of the pairs.
  std::vector<bool> fans(quads_.size()), moves(patches_.size());
  for (const TrianglePair& pair : pairs) {
    const auto forVertices = [&](const auto& f) {
      for (const std::uint32_t t : pair)
        for (const std::uint32_t v : triangles.mesh.triangles[t])
          if (v < patches_.size()) f(v);
    };
    VertexPlace least = VertexPlace::MeanCone;
    forVertices([&](std::uint32_t v) { least = std::min(least, patches_[v].place); });
    const std::array<std::uint32_t, 2> quads{triangles.quad[pair[0]], triangles.quad[pair[1]]};
    if (!(isFan(quads[0]) && isFan(quads[1])))
      for (const std::uint32_t q : quads) fans[q] = true;
    else if (least != VertexPlace::MeanCone)
      forVertices([&](std::uint32_t v) { moves[v] = moves[v] || patches_[v].place == least; });
  }
  for (std::size_t v = 0; v < patches_.size(); ++v)
    if (moves[v]) patches_[v].place = static_cast<VertexPlace>(static_cast<int>(patches_[v].place) + 1);
  std::vector<bool> changed(quads_.size());
  for (std::size_t q = 0; q < quads_.size(); ++q) {
    changed[q] = fans[q];
    for (const std::uint32_t v : quads_[q]) changed[q] = changed[q] || moves[v];
    if (fans[q]) splits_[q] = Split::Fan;
  }
  chooseSplits(changed);
  // A pair for which nothing was left to do counts as well: it is to be found again.
  for (const TrianglePair& pair : pairs)
    for (const std::uint32_t t : pair) changed[triangles.quad[t]] = true;
  return changed;
}

std::size_t DualMesh::count(VertexPlace place) const {
  return static_cast<std::size_t>(
      std::count_if(patches_.begin(), patches_.end(), [&](const Patch& p) { return p.place == place; }));
}

std::size_t DualMesh::fans() const {
  std::size_t count = 0;
  for (std::uint32_t q = 0; q < quads_.size(); ++q) count += isFan(q) ? 1 : 0;
  return count;
}

}  // namespace restroke::points
