// Scan conversion as for pictures, J. Foley, A. van Dam, S. Feiner and J. Hughes, Computer Graphics:
// Principles and Practice, 1990, section 3.6, but without rounding in what decides: H. Edelsbrunner and E.
// Muecke, Simulation of Simplicity, 1990, is how ties are broken.

#include "points/dexel/mesh_scan.h"

#include <algorithm>
#include <cmath>

#include "implicit/geometry/exact_predicates.h"

namespace restroke::points {

namespace {

// Of the column in which an edge meets a row. With u = 2^-53 and |t| <= 1: t = (v - a) / (b - a) is off by 3u
// of itself, the way along the edge by 5u of |b - a|, the sum by u of itself: 6u |b - a| + u max(|a|, |b|) at
// most, and terms of second order. The rest is for numbers too small to have all their digits.
constexpr double kEdgeError = 0x1p-50, kLeastEdgeError = 0x1p-900;

// No normal of a solid.
constexpr PackedNormal kNoNormal = 0xffffffffu;

// The first of ascending, about evenly spaced numbers that is not less than x.
class Lookup {
 public:
  explicit Lookup(std::span<const double> at) : at_(at) {
    if (at.size() > 1) perStep_ = static_cast<double>(at.size() - 1) / (at.back() - at.front());
  }
  [[nodiscard]] int firstFrom(double x) const {
    const auto size = static_cast<int>(at_.size());
    if (size == 0 || !(x > at_.front())) return 0;
    if (x > at_.back()) return size;
    auto i = static_cast<std::size_t>(std::min(static_cast<double>(size - 1), (x - at_.front()) * perStep_));
    while (i > 0 && at_[i - 1] >= x) --i;
    while (at_[i] < x) ++i;
    return static_cast<int>(i);
  }

 private:
  std::span<const double> at_;
  double perStep_ = 0;
};

}  // namespace

MeshScan::MeshScan(const LatticeMesh& mesh, const LineLattice& lattice) : mesh_(mesh), lattice_(lattice) {
  const Lookup columns(lattice.columns), rows(lattice.rows);
  places_.reserve(mesh.vertices.size());
  for (const DVec3& p : mesh.vertices) places_.push_back({columns.firstFrom(p.x), rows.firstFrom(p.y)});

  // The rows of a triangle are those from its lowest place to before its highest, and likewise the columns.
  struct Bands {
    int first, last;
  };
  const auto bandsOf = [&](const std::array<std::uint32_t, 3>& t) {
    const Place &a = places_[t[0]], &b = places_[t[1]], &c = places_[t[2]];
    const int first = std::min({a.row, b.row, c.row}), end = std::max({a.row, b.row, c.row});
    const bool isMissed =
        first == end || std::min({a.column, b.column, c.column}) == std::max({a.column, b.column, c.column});
    return isMissed ? Bands{0, -1} : Bands{first / kBandRows, (end - 1) / kBandRows};
  };
  bandBegin_.assign((lattice.rows.size() + kBandRows - 1) / kBandRows + 1, 0);
  std::vector<Bands> all;
  all.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const Bands& bands = all.emplace_back(bandsOf(t));
    for (int band = bands.first; band <= bands.last; ++band) ++bandBegin_[static_cast<std::size_t>(band) + 1];
  }
  for (std::size_t band = 1; band < bandBegin_.size(); ++band) bandBegin_[band] += bandBegin_[band - 1];
  triangles_.resize(bandBegin_.back());
  std::vector<std::size_t> next(bandBegin_.begin(), bandBegin_.end() - 1);
  for (std::uint32_t i = 0; i < all.size(); ++i)
    for (int band = all[i].first; band <= all[i].last; ++band)
      triangles_[next[static_cast<std::size_t>(band)]++] = i;
}

// Exactly: is the line before the edge, which runs from its lower to its higher end?
bool MeshScan::isBefore(int column, int row, std::uint32_t low, std::uint32_t high) const {
  const DVec3 &a = mesh_.vertices[low], &b = mesh_.vertices[high];
  const DVec2 line(lattice_.columns[static_cast<std::size_t>(column)],
                   lattice_.rows[static_cast<std::size_t>(row)]);
  return sideOfLine({a.x, a.y}, {b.x, b.y}, line) > 0;
}

// A line on the edge counts as beyond it. In the row, where the line is thought to be moved up by less than
// to the side, the edge is met between its ends.
MeshScan::EdgeAt MeshScan::edgeAt(std::uint32_t low, std::uint32_t high, int row) const {
  const DVec3 &a = mesh_.vertices[low], &b = mesh_.vertices[high];
  const double t = (lattice_.rows[static_cast<std::size_t>(row)] - a.y) / (b.y - a.y);
  const auto [nearest, furthest] = std::minmax(a.z, b.z);
  EdgeAt at{0, a.x + t * (b.x - a.x), std::clamp(a.z + t * (b.z - a.z), nearest, furthest)};
  // It is met between its ends, so that only the columns between them are in question.
  const auto [least, most] = std::minmax(places_[low].column, places_[high].column);
  const double* const columns = lattice_.columns.data();
  int i = least;
  if (most - least > 8)
    i = static_cast<int>(std::lower_bound(columns + least, columns + most, at.column) - columns);
  else
    while (i < most && columns[i] < at.column) ++i;
  if (least < most) {
    const double error = kEdgeError * (std::fabs(a.x) + std::fabs(b.x)) + kLeastEdgeError;
    while (i > least && at.column - columns[i - 1] <= error && !isBefore(i - 1, row, low, high)) --i;
    while (i < most && columns[i] - at.column <= error && isBefore(i, row, low, high)) ++i;
  }
  at.firstColumn = i;
  return at;
}

void MeshScan::scanRow(std::uint32_t triangle, int row, RowCrossings& crossings) const {
  const auto& corners = mesh_.triangles[triangle];
  // The edges that the triangle runs along upwards and downwards, each from its lower end.
  std::array<std::uint32_t, 2> upwards{}, downwards{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t from = corners[i], to = corners[i == 2 ? 0 : i + 1];
    const bool startsBelow = places_[from].row <= row, endsBelow = places_[to].row <= row;
    if (startsBelow && !endsBelow) upwards = {from, to};
    if (!startsBelow && endsBelow) downwards = {to, from};
  }
  // Most triangles of a fine mesh are between the lines.
  const int column = places_[upwards[0]].column;
  if (column == places_[upwards[1]].column && column == places_[downwards[0]].column &&
      column == places_[downwards[1]].column)
    return;
  const EdgeAt up = edgeAt(upwards[0], upwards[1], row), down = edgeAt(downwards[0], downwards[1], row);
  // Counter-clockwise, as a triangle runs whose normal points to whoever looks back along the lines, the edge
  // on the left goes down.
  const bool leaves = down.firstColumn < up.firstColumn;
  const EdgeAt &left = leaves ? down : up, &right = leaves ? up : down;
  if (left.firstColumn == right.firstColumn) return;
  const double width = right.column - left.column;
  const double slope = width > 0 ? (right.depth - left.depth) / width : 0;
  const auto [nearest, furthest] = std::minmax(left.depth, right.depth);
  const auto first = static_cast<std::uint32_t>((row - crossings.firstRow) * crossings.width);
  for (int i = left.firstColumn; i < right.firstColumn; ++i) {
    double depth = left.depth + (lattice_.columns[static_cast<std::size_t>(i)] - left.column) * slope;
    depth = depth > nearest ? depth : nearest;
    depth = depth < furthest ? depth : furthest;
    // Of the two zeros always the same.
    const float rounded = static_cast<float>(depth) + 0.0f;
    crossings.found_.push_back({first + static_cast<std::uint32_t>(i), {rounded, triangle, leaves}});
  }
}

void MeshScan::scan(int band, RowCrossings& crossings) const {
  crossings.firstRow = band * kBandRows;
  const int end = std::min(static_cast<int>(lattice_.rows.size()), crossings.firstRow + kBandRows);
  crossings.rows = end - crossings.firstRow;
  crossings.width = static_cast<int>(lattice_.columns.size());
  crossings.found_.clear();
  for (std::size_t k = bandBegin_[static_cast<std::size_t>(band)];
       k < bandBegin_[static_cast<std::size_t>(band) + 1]; ++k) {
    const auto& t = mesh_.triangles[triangles_[k]];
    const int a = places_[t[0]].row, b = places_[t[1]].row, c = places_[t[2]].row;
    const int last = std::min(end, std::max({a, b, c}));
    for (int row = std::max(crossings.firstRow, std::min({a, b, c})); row < last; ++row)
      scanRow(triangles_[k], row, crossings);
  }

  // By line; triangles are in ascending order, and stay so.
  auto& begin = crossings.begin;
  const std::size_t lines =
      static_cast<std::size_t>(crossings.rows) * static_cast<std::size_t>(crossings.width);
  begin.assign(lines + 2, 0);
  for (const auto& found : crossings.found_) ++begin[found.line + 2];
  for (std::size_t line = 2; line < begin.size(); ++line) begin[line] += begin[line - 1];
  crossings.all.resize(crossings.found_.size());
  for (const auto& found : crossings.found_) crossings.all[begin[found.line + 1]++] = found.crossing;
  begin.pop_back();
  for (std::size_t line = 0; line < lines; ++line) {
    const auto of = std::span(crossings.all).subspan(begin[line], begin[line + 1] - begin[line]);
    if (of.size() == 2) {
      if (of[1].depth < of[0].depth) std::swap(of[0], of[1]);
    } else if (of.size() > 2) {
      std::sort(of.begin(), of.end(), [](const LineCrossing& a, const LineCrossing& b) {
        return a.depth != b.depth ? a.depth < b.depth : a.triangle < b.triangle;
      });
    }
  }
}

FaceNormals::FaceNormals(std::span<const DVec3> vertices,
                         std::span<const std::array<std::uint32_t, 3>> triangles) {
  normals_.reserve(triangles.size());
  for (const auto& t : triangles) {
    const DVec3 &a = vertices[t[0]], n = cross(vertices[t[1]] - a, vertices[t[2]] - a);
    const double size = std::max({std::fabs(n.x), std::fabs(n.y), std::fabs(n.z)});
    // Float32 has no room for the normals of very small triangles.
    normals_.push_back(size > 0 ? packNormal(Vec3(n / size)) : kNoNormal);
  }
}

PackedNormal FaceNormals::of(const LineCrossing& crossing, bool leaves, PackedNormal along) const {
  const PackedNormal normal = normals_[crossing.triangle];
  if (normal == kNoNormal) return leaves ? along : turnedAround(along);
  return crossing.leaves == leaves ? normal : turnedAround(normal);
}

void findSpans(std::span<const LineCrossing> crossings, const FaceNormals& normals, PackedNormal along,
               ParitySpans& out) {
  out.spans.clear();
  out.isOdd = crossings.size() % 2 == 1;
  out.overlaps = false;
  if (out.isOdd) return;
  int winding = 0, least = 0, most = 0;
  bool isInside = false;
  for (std::size_t i = 0, end = 0; i < crossings.size(); i = end) {
    while (end < crossings.size() && crossings[end].depth == crossings[i].depth)
      winding += crossings[end++].leaves ? -1 : 1;
    least = std::min(least, winding);
    most = std::max(most, winding);
    if ((end - i) % 2 == 0) continue;
    // One that faces as the end does, if there is one.
    std::size_t chosen = i;
    while (chosen < end && crossings[chosen].leaves != isInside) ++chosen;
    if (chosen == end) chosen = i;
    const PackedNormal normal = normals.of(crossings[chosen], isInside, along);
    if (isInside) {
      out.spans.back().exit = crossings[i].depth;
      out.spans.back().exitNormal = normal;
    } else {
      out.spans.push_back({.enter = crossings[i].depth, .enterNormal = normal});
    }
    isInside = !isInside;
  }
  out.overlaps = most - least > 1;
}

}  // namespace restroke::points
