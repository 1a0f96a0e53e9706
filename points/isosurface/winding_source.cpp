// Generalised winding numbers as a solid: A. Jacobson, L. Kavan, O. Sorkine-Hornung, Robust Inside-Outside
// Segmentation using Generalized Winding Numbers, 2013. We differ in what comes after: they cut a volume into
// tetrahedra, here the boundary is meshed by dual contouring.

#include "points/isosurface/winding_source.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "implicit/errors.h"
#include "points/isosurface/isosurface.h"

namespace restroke::points {

namespace {

constexpr double kHalf = 0.5;
// Hits on a segment that are closer than this, in parts of it, are one: both triangles of an edge.
constexpr double kSameHit = 1e-6;
// The box is first widened by this part of its longest side: triangles that lie in a face of the box count
// nothing there, and would seem to be holes.
constexpr double kFirstMargin = 1.0 / 256;
// Points along each side of a face of the box where the winding number is looked at.
constexpr int kProbes = 17;

// No more points than this are asked one by one.
constexpr std::size_t kFewPoints = 16;
// Points in a box are taken to be on one side when no triangle is within this many of its longest sides and
// the winding numbers of its corners and middle differ from each other by less than kSure and from 1/2 by
// more. There the number is harmonic, and between points so close together cannot stray farther: on closed
// surfaces it is constant, and before holes it changes over the size of the hole.
constexpr double kClearance = 1, kSure = 0.2;

struct Hit {
  double t = 0;
  DVec3 normal{0};
};

// Where the segment passes through a triangle, if it does; edges are widened by rounding.
std::optional<Hit> hitOf(const std::array<DVec3, 3>& triangle, DVec3 from, DVec3 along) {
  const DVec3 ab = triangle[1] - triangle[0], ac = triangle[2] - triangle[0], n = cross(ab, ac);
  const double speed = dot(n, along), square = dot(n, n);
  if (speed == 0 || !(square > 0)) return std::nullopt;
  const double t = dot(n, triangle[0] - from) / speed;
  if (!(t >= 0 && t <= 1)) return std::nullopt;
  const DVec3 p = from + t * along - triangle[0];
  const double u = dot(cross(p, ac), n) / square, v = dot(cross(ab, p), n) / square;
  constexpr double kSlack = 1e-9;
  if (u < -kSlack || v < -kSlack || u + v > 1 + kSlack) return std::nullopt;
  return Hit{t, n / std::sqrt(square)};
}

double areaOf(const TriangleMesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const DVec3 a(mesh.vertices[t[0]]);
    area += length(cross(DVec3(mesh.vertices[t[1]]) - a, DVec3(mesh.vertices[t[2]]) - a)) / 2;
  }
  return area;
}

Box widened(const Box& box, double margin) {
  return {Point(DVec3(box.min) - DVec3(margin)), Point(DVec3(box.max) + DVec3(margin))};
}

}  // namespace

WindingSource::WindingSource(TriangleMesh mesh) : winding_(std::move(mesh)), tree_(winding_.mesh()) {
  const Box tight = boundsOf(winding_.mesh());
  if (winding_.mesh().triangles.empty()) return;
  const DVec3 size = DVec3(tight.max) - DVec3(tight.min);
  const double longest = std::max({size.x, size.y, size.z});
  if (!(longest > 0)) return;
  // At a distance d from all triangles the winding number is at most area / (4 pi d^2).
  const double enough = std::sqrt(areaOf(winding_.mesh()) / 6.28);
  double margin = longest * kFirstMargin;
  while (margin < enough && mostOn(widened(tight, margin)) >= kHalf - WindingNumber::kFastError) margin *= 2;
  bounds_ = widened(tight, margin);
}

double WindingSource::mostOn(const Box& box) const {
  const DVec3 low(box.min), size = DVec3(box.max) - low;
  double most = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 2 * kProbes * kProbes; ++i) {
      DVec3 at;
      at[axis] = i % 2;
      at[(axis + 1) % 3] = static_cast<double>(i / 2 % kProbes) / (kProbes - 1);
      at[(axis + 2) % 3] = static_cast<double>(i / 2 / kProbes) / (kProbes - 1);
      most = std::max(most, winding_.at(low + at * size));
    }
  return most;
}

void WindingSource::sides(std::span<const Point> points, std::span<implicit::Side> sides) const {
  std::vector<std::uint32_t> all(points.size());
  std::iota(all.begin(), all.end(), 0u);
  sidesAmong(points, all, sides);
}

void WindingSource::sidesAmong(std::span<const Point> points, std::span<std::uint32_t> chosen,
                               std::span<implicit::Side> sides) const {
  Box box;
  for (const std::uint32_t i : chosen) box.add({points[i], points[i]});
  const Vec3 size = box.max - box.min;
  const float longest = std::max({size.x, size.y, size.z});
  if (chosen.size() > kFewPoints && longest > 0) {
    if (const auto side = sideOfAll(box, kClearance * static_cast<double>(longest))) {
      for (const std::uint32_t i : chosen) sides[i] = *side;
      return;
    }
    const int axis = size.x == longest ? 0 : size.y == longest ? 1 : 2;
    const float middle = box.center()[axis];
    const auto half = std::partition(chosen.begin(), chosen.end(),
                                     [&](std::uint32_t i) { return points[i][axis] <= middle; });
    const auto count = static_cast<std::size_t>(half - chosen.begin());
    if (count > 0 && count < chosen.size()) {
      sidesAmong(points, chosen.first(count), sides);
      sidesAmong(points, chosen.subspan(count), sides);
      return;
    }
  }
  for (const std::uint32_t i : chosen) {
    const Point p = points[i];
    const bool within = p.x > bounds_.min.x && p.x < bounds_.max.x && p.y > bounds_.min.y &&
                        p.y < bounds_.max.y && p.z > bounds_.min.z && p.z < bounds_.max.z;
    sides[i] = within && winding_.isInside(DVec3(p)) ? implicit::Side::Inside : implicit::Side::Outside;
  }
}

std::optional<implicit::Side> WindingSource::sideOfAll(const Box& box, double clear) const {
  for (int a = 0; a < 3; ++a)
    if (box.min[a] <= bounds_.min[a] || box.max[a] >= bounds_.max[a]) return std::nullopt;
  bool touched = false;
  tree_.forEachTouching(widened(box, clear), [&](std::uint32_t) { touched = true; });
  if (touched) return std::nullopt;
  double least = winding_.at(DVec3(box.center())), most = least;
  for (int c = 0; c < 8 && most - least < kSure; ++c) {
    const DVec3 corner(static_cast<double>((c & 1) != 0 ? box.max.x : box.min.x),
                       static_cast<double>((c & 2) != 0 ? box.max.y : box.min.y),
                       static_cast<double>((c & 4) != 0 ? box.max.z : box.min.z));
    const double w = winding_.at(corner);
    least = std::min(least, w);
    most = std::max(most, w);
  }
  if (most - least >= kSure) return std::nullopt;
  if (least > kHalf + kSure) return implicit::Side::Inside;
  if (most < kHalf - kSure) return implicit::Side::Outside;
  return std::nullopt;
}

Crossing WindingSource::crossing(Point inside, Point outside) const {
  const DVec3 from(inside), to(outside), along = to - from;
  const TriangleMesh& mesh = winding_.mesh();
  std::vector<Hit> hits;
  Box box{inside, inside};
  box.add({outside, outside});
  tree_.forEachTouching(box, [&](std::uint32_t t) {
    const auto& v = mesh.triangles[t];
    const auto hit = hitOf(
        {DVec3(mesh.vertices[v[0]]), DVec3(mesh.vertices[v[1]]), DVec3(mesh.vertices[v[2]])}, from, along);
    if (hit) hits.push_back(*hit);
  });
  // Of triangles at the same place the order is that of their normals.
  std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) {
    return std::tie(a.t, a.normal.x, a.normal.y, a.normal.z) <
           std::tie(b.t, b.normal.x, b.normal.y, b.normal.z);
  });
  hits.erase(
      std::unique(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) { return b.t - a.t <= kSameHit; }),
      hits.end());
  // Between two hits the winding number is smooth. The first stretch whose middle is outside ends the search:
  // it is left by the hit before it, or passed smoothly on either side of that.
  const double step = length(along) / 4;
  const auto isIn = [&](double t) { return winding_.at(from + t * along) >= kHalf; };
  double before = 0;  // inside
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const bool last = i + 1 == hits.size();
    const double t = hits[i].t, after = last ? 1 : (t + hits[i + 1].t) / 2;
    if (!last && isIn(after)) {
      before = after;
      continue;
    }
    const double in = std::max(before, t - kSameHit), out = std::min(after, t + kSameHit);
    if (in > before && !isIn(in)) return bisect(from + before * along, from + in * along, step);
    if (out < after && isIn(out)) return bisect(from + out * along, from + after * along, step);
    const DVec3 n = hits[i].normal;
    return {from + t * along, dot(n, along) < 0 ? -n : n};
  }
  return bisect(from, to, step);
}

Crossing WindingSource::bisect(DVec3 inside, DVec3 outside, double step) const {
  const DVec3 along = outside - inside;
  for (int i = 0; i < 16; ++i) {  // to a few hundred-thousandths of a cell, below the fast number's error
    const DVec3 middle = (inside + outside) * kHalf;
    (winding_.at(middle) >= kHalf ? inside : outside) = middle;
  }
  // Differences over half a cell, so that the steps of the fast number do not show.
  const DVec3 p = (inside + outside) * kHalf;
  DVec3 normal(0);
  for (int a = 0; a < 3; ++a) {
    DVec3 d(0);
    d[a] = step;
    normal[a] = winding_.at(p - d) - winding_.at(p + d);
  }
  // A triangle within the step adds its jump; what then faces back says nothing about the hole.
  const double l = length(normal);
  if (l > 0 && dot(normal, along) > 0) return {p, normal / l};
  return {p, normalized(along)};
}

Repaired repairByWinding(const TriangleMesh& mesh, const RepairOptions& options, const Execution& execution) {
  Repaired repaired{.mesh = mesh, .faults = faultsOf(mesh, execution)};
  if (repaired.faults.none()) return repaired;
  if (repaired.faults.inwards) {
    repaired.way = Repaired::Way::TurnedAround;
    for (auto& t : repaired.mesh.triangles) std::swap(t[1], t[2]);
    return repaired;
  }
  const WindingSource source(mesh);
  repaired.way = Repaired::Way::Remeshed;
  repaired.mesh = {};
  if (!source.bounds().empty())
    repaired.mesh = isosurfaceOf(source, {.resolution = options.resolution}, execution).mesh;
  if (repaired.mesh.triangles.empty())
    throw InputError(
        fmt::format("no solid can be made of this mesh: at resolution {} no point has a generalised winding "
                    "number above 1/2; wrong is that {}",
                    options.resolution, describe(repaired.faults)));
  return repaired;
}

}  // namespace restroke::points
