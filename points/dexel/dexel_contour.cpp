// Dual contouring (isosurface/dual_mesh.cpp) of Hermite data that is there already: three families of lines
// are the edges of a grid, and the ends of their spans its crossings with normals.

#include "points/dexel/dexel_contour.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace restroke::points {

namespace {

using implicit::Side;

// How far off, in cells, an end of an outvoted line may be.
constexpr double kNearOnLine = 0.5;
// Among ends this near, in cells, the nearest one is looked for.
constexpr double kNearOffLine = 1.0;

DexelGrid withLayerAround(const DexelGrid& grid) {
  DexelGrid::Parts parts = grid.parts();
  for (std::size_t a = 0; a < 3; ++a) {
    --parts.first[a];
    parts.counts[a] += 2;
  }
  return DexelGrid(parts);
}

// Calls f(enter, exit) for each span of a line.
template <class F>
void forSpans(const Dexels& dexels, std::size_t line, const F& f) {
  const Dexels::ConstHulls hulls = dexels.hulls();
  if (!(hulls.enter[line] <= hulls.exit[line])) return;
  if (hulls.more[line] == Dexels::kNoMore) {
    f(hulls.enter[line], hulls.exit[line]);
    return;
  }
  thread_local LineEnds ends;
  dexels.read(line, ends);
  for (std::size_t i = 0; i < ends.size(); i += 2) f(ends[i].depth, ends[i + 1].depth);
}

void setBits(std::uint64_t* row, int begin, int end) {
  constexpr std::uint64_t kAll = ~std::uint64_t{0};
  for (int w = begin / 64; w * 64 < end; ++w) {
    std::uint64_t bits = kAll;
    if (w * 64 < begin) bits &= kAll << begin % 64;
    if (w * 64 + 64 > end) bits &= kAll >> (64 - end % 64);
    row[w] |= bits;
  }
}

}  // namespace

TriDexelSource::TriDexelSource(const TriDexel& model)
    : model_(model), around_(withLayerAround(model.grid())) {}

Box TriDexelSource::bounds() const {
  Box box;
  for (const int count : model_.grid().counts())
    if (count == 0) return box;
  const GridCounts& n = around_.counts();
  box.add({around_.at({0, 0, 0}), around_.at({n[0] - 1, n[1] - 1, n[2] - 1})});
  return box;
}

GridSource::Grid TriDexelSource::grid() const {
  Grid out;
  out.cell = around_.cell();
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    out.coordinates[a].reserve(static_cast<std::size_t>(around_.counts()[a]));
    for (int i = 0; i < around_.counts()[a]; ++i) out.coordinates[a].push_back(around_.at(axis, i));
  }
  return out;
}

TriDexelSource::Range TriDexelSource::pointsWithin(int axis, float enter, float exit) const {
  const int begin = around_.firstFrom(axis, static_cast<double>(enter)),
            count = around_.counts()[static_cast<std::size_t>(axis)];
  int end = around_.firstFrom(axis, static_cast<double>(exit));
  while (end < count && around_.at(axis, end) == exit) ++end;
  return {begin, end};
}

// Each family has its say in bits of its own. A span along x sets its stretch of a row; along y or z it flips
// the bits where it begins and where it has ended, and what stands between follows from row to row.
void TriDexelSource::fillSides(std::size_t words, std::span<std::uint64_t> bits) const {
  const int nx = around_.counts()[0], ny = around_.counts()[1], nz = around_.counts()[2];
  std::vector<std::uint64_t> alongY(bits.size(), 0), alongZ(bits.size(), 0);
  const auto at = [&](int y, int z) {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(ny) + static_cast<std::size_t>(y)) * words;
  };
  const auto flip = [&](std::vector<std::uint64_t>& plane, std::size_t row, int x) {
    plane[row + static_cast<std::size_t>(x / 64)] ^= std::uint64_t{1} << x % 64;
  };
  const auto carry = [&](std::vector<std::uint64_t>& plane, std::size_t from, std::size_t to) {
    for (std::size_t w = 0; w < words; ++w) plane[to + w] ^= plane[from + w];
  };
  const auto layers = [&](int count, const auto& f) {
    tbb::parallel_for(tbb::blocked_range<int>(1, count - 1, 8), [&](const tbb::blocked_range<int>& range) {
      for (int i = range.begin(); i < range.end(); ++i) f(i);
    });
  };
  layers(nz, [&](int z) {
    const Dexels& rows = model_.family(0);
    for (int y = 1; y < ny - 1; ++y)
      forSpans(rows, rows.lineAt(y - 1, z - 1), [&](float enter, float exit) {
        const Range in = pointsWithin(0, enter, exit);
        if (in.begin < in.end) setBits(bits.data() + at(y, z), in.begin, in.end);
      });
    const Dexels& columns = model_.family(1);
    for (int x = 1; x < nx - 1; ++x)
      forSpans(columns, columns.lineAt(z - 1, x - 1), [&](float enter, float exit) {
        const Range in = pointsWithin(1, enter, exit);
        if (in.begin < ny) flip(alongY, at(in.begin, z), x);
        if (in.end < ny) flip(alongY, at(in.end, z), x);
      });
    for (int y = 1; y < ny; ++y) carry(alongY, at(y - 1, z), at(y, z));
  });
  layers(ny, [&](int y) {
    const Dexels& piles = model_.family(2);
    for (int x = 1; x < nx - 1; ++x)
      forSpans(piles, piles.lineAt(x - 1, y - 1), [&](float enter, float exit) {
        const Range in = pointsWithin(2, enter, exit);
        if (in.begin < nz) flip(alongZ, at(y, in.begin), x);
        if (in.end < nz) flip(alongZ, at(y, in.end), x);
      });
    for (int z = 1; z < nz; ++z) carry(alongZ, at(y, z - 1), at(y, z));
  });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, bits.size(), 4096),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i < range.end(); ++i)
                        bits[i] = (bits[i] & (alongY[i] | alongZ[i])) | (alongY[i] & alongZ[i]);
                    });
}

// The end nearest p of all families' ends within reach: position and normal.
std::optional<Crossing> TriDexelSource::nearestEnd(DVec3 p) const {
  const DexelGrid& grid = model_.grid();
  const double reach = kNearOffLine * grid.cell();
  double least = reach * reach;
  std::optional<Crossing> nearest;
  thread_local LineEnds ends;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const Dexels& dexels = model_.family(axis);
    const int uBegin = grid.firstFrom(u, p[u] - reach), uEnd = grid.firstFrom(u, p[u] + reach),
              vBegin = grid.firstFrom(v, p[v] - reach), vEnd = grid.firstFrom(v, p[v] + reach);
    for (int row = vBegin; row < vEnd; ++row)
      for (int column = uBegin; column < uEnd; ++column) {
        const double du = static_cast<double>(grid.at(u, column)) - p[u],
                     dv = static_cast<double>(grid.at(v, row)) - p[v], off = du * du + dv * dv;
        if (!(off < least)) continue;
        const std::size_t line = dexels.lineAt(column, row);
        if (dexels.isEmpty(line)) continue;
        dexels.read(line, ends);
        for (const SpanEnd& end : ends) {
          const double d = static_cast<double>(end.depth) - p[axis];
          if (!(off + d * d < least)) continue;
          least = off + d * d;
          Crossing found;
          found.position[axis] = static_cast<double>(end.depth);
          found.position[u] = static_cast<double>(grid.at(u, column));
          found.position[v] = static_cast<double>(grid.at(v, row));
          found.normal = DVec3(unpackNormal(end.normal));
          nearest = found;
        }
      }
  }
  return nearest;
}

void TriDexelSource::sides(std::span<const Point> points, std::span<Side> sides) const {
  const DexelGrid& grid = model_.grid();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const DVec3 p(points[i]);
    bool inside = false;
    if (const std::optional<Crossing> end = nearestEnd(p)) {
      inside = !(dot(p - end->position, end->normal) > 0);
    } else {
      GridCounts at{};
      for (int a = 0; a < 3; ++a) at[static_cast<std::size_t>(a)] = grid.firstFrom(a, p[a] - grid.cell() / 2);
      inside = model_.isInside(at);
    }
    sides[i] = inside ? Side::Inside : Side::Outside;
  }
}

Crossing TriDexelSource::crossing(Point inside, Point outside) const {
  const DexelGrid& grid = model_.grid();
  const int axis = inside.x != outside.x ? 0 : inside.y != outside.y ? 1 : 2;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const bool up = outside[axis] > inside[axis];
  const double from = static_cast<double>(inside[axis]), to = static_cast<double>(outside[axis]);
  const Dexels& dexels = model_.family(axis);
  thread_local LineEnds ends;
  dexels.read(dexels.lineAt(grid.firstFrom(u, static_cast<double>(inside[u])),
                            grid.firstFrom(v, static_cast<double>(inside[v]))),
              ends);
  // Of the ends where the line leaves the solid on its way, the first one; if there is none, the nearest.
  const SpanEnd* best = nullptr;
  double least = kNearOnLine * grid.cell();
  for (std::size_t k = 0; k < ends.size() / 2; ++k) {
    const SpanEnd& end = up ? ends[2 * k + 1] : ends[ends.size() - 2 - 2 * k];
    const double depth = static_cast<double>(end.depth), low = std::min(from, to), high = std::max(from, to);
    const double beyond = std::max({0.0, low - depth, depth - high});
    if (!(beyond < least)) continue;
    best = &end;
    least = beyond;
    if (beyond == 0) break;
  }
  Crossing out{DVec3(inside), DVec3(0)};
  if (best) {
    out.position[axis] = static_cast<double>(best->depth);
    out.normal = DVec3(unpackNormal(best->normal));
    return out;
  }
  out.position[axis] = (from + to) / 2;
  const std::optional<Crossing> near = nearestEnd(out.position);
  if (near && near->normal[axis] * (up ? 1 : -1) > 0) {
    out.position[axis] -= dot(out.position - near->position, near->normal) / near->normal[axis];
    out.normal = near->normal;
  } else {
    out.normal[axis] = up ? 1 : -1;
  }
  return out;
}

Isosurface isosurfaceOf(const TriDexel& model, const Execution& execution) {
  return isosurfaceOf(TriDexelSource(model), execution);
}

}  // namespace restroke::points
