#include "points/isosurface/meetings.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "implicit/geometry/exact_predicates.h"
#include "implicit/geometry/triangle_tree.h"

namespace restroke::points {

namespace {

using Corners = std::array<std::uint32_t, 3>;

Triangle triangleOf(const TriangleMesh& mesh, const Corners& c) {
  return {mesh.vertices[c[0]], mesh.vertices[c[1]], mesh.vertices[c[2]]};
}

// Surely no point of b in a's plane: most pairs of neighbours end here, without exact arithmetic. Coordinates
// are float32, so that the differences are exact to 2^-52 and the determinants err by a few of that.
bool surelyOnOneSide(const Triangle& a, const Triangle& b) {
  const DVec3 o(a[0]), u = DVec3(a[1]) - o, v = DVec3(a[2]) - o;
  const DVec3 n = cross(u, v);
  const DVec3 size(std::fabs(u.y * v.z) + std::fabs(u.z * v.y), std::fabs(u.z * v.x) + std::fabs(u.x * v.z),
                   std::fabs(u.x * v.y) + std::fabs(u.y * v.x));
  int side = 0;
  for (const Point p : b) {
    const DVec3 d = DVec3(p) - o;
    const double det = dot(n, d),
                 bound = 0x1p-46 * dot(size, DVec3(std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)));
    const int s = det > bound ? 1 : det < -bound ? -1 : 0;
    if (s == 0 || (side != 0 && s != side)) return false;
    side = s;
  }
  return true;
}

bool meetBadly(const TriangleMesh& mesh, Corners s, Corners t) {
  // Shared vertices to the front.
  std::size_t shared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto it = std::find(t.begin() + static_cast<std::ptrdiff_t>(shared), t.end(), s[i]);
    if (it == t.end()) continue;
    std::swap(s[i], s[shared]);
    std::swap(*it, t[shared]);
    ++shared;
  }
  const Triangle a = triangleOf(mesh, s), b = triangleOf(mesh, t);
  if (shared == 0 && (surelyOnOneSide(a, b) || surelyOnOneSide(b, a))) return false;
  if (shared == 3 || areCollinear(a) || areCollinear(b)) return true;
  if (shared == 2) return foldOnto({a[0], a[1]}, a[2], b[2]);
  if (shared == 1) return meet(a, Segment{b[1], b[2]}) || meet(b, Segment{a[1], a[2]});
  return meet(a, b);
}

// Where the chosen triangles are, in blocks of space: most others are near none of them.
class NearBlocks {
 public:
  explicit NearBlocks(const Box& bounds) : low_(bounds.min) {
    const Vec3 size = bounds.max - bounds.min;
    const float longest = std::max({size.x, size.y, size.z});
    scale_ = longest > 0 ? static_cast<float>(kBlocks) / longest : 0;
    if (!std::isfinite(scale_)) scale_ = 0;
    bits_.resize(static_cast<std::size_t>(kBlocks) * kBlocks * kBlocks);
  }
  void add(const Box& box) {
    forBlocks(box, [&](std::size_t block) {
      bits_[block] = true;
      return false;
    });
  }
  /// May the box touch one that was added?
  [[nodiscard]] bool isNear(const Box& box) const {
    return forBlocks(box, [&](std::size_t block) { return bits_[block]; });
  }

 private:
  static constexpr int kBlocks = 96;

  // Monotone, so that boxes with a point in common have a block in common.
  [[nodiscard]] int blockOf(float x, int axis) const {
    return static_cast<int>(std::clamp((x - low_[axis]) * scale_, 0.0f, static_cast<float>(kBlocks - 1)));
  }
  // Whether f says yes to a block that the box touches; the first one ends the walk.
  template <class F>
  bool forBlocks(const Box& box, const F& f) const {
    int from[3], to[3];
    for (int a = 0; a < 3; ++a) {
      from[a] = blockOf(box.min[a], a);
      to[a] = blockOf(box.max[a], a);
    }
    for (int z = from[2]; z <= to[2]; ++z)
      for (int y = from[1]; y <= to[1]; ++y)
        for (int x = from[0]; x <= to[0]; ++x)
          if (f((static_cast<std::size_t>(z) * kBlocks + static_cast<std::size_t>(y)) * kBlocks +
                static_cast<std::size_t>(x)))
            return true;
    return false;
  }

  Point low_;
  float scale_;
  std::vector<bool> bits_;
};

Box boxOf(const TriangleMesh& mesh, const Corners& corners) {
  Box box{mesh.vertices[corners[0]], mesh.vertices[corners[0]]};
  for (const std::uint32_t v : {corners[1], corners[2]})
    for (int a = 0; a < 3; ++a) {
      const float x = mesh.vertices[v][a];
      if (x < box.min[a]) box.min[a] = x;
      if (x > box.max[a]) box.max[a] = x;
    }
  return box;
}

}  // namespace

std::vector<std::array<std::uint32_t, 2>> meetingPairs(const TriangleMesh& mesh,
                                                       const std::vector<bool>& chosen) {
  // The tree is of the chosen ones: mostly they are few.
  TriangleMesh few;
  std::vector<std::uint32_t> numbers;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!chosen[t]) continue;
    few.triangles.push_back(mesh.triangles[t]);
    numbers.push_back(static_cast<std::uint32_t>(t));
  }
  if (numbers.empty()) return {};
  few.vertices = mesh.vertices;
  const TriangleTree tree(few);
  NearBlocks blocks(tree.nodes()[0].box);
  for (std::uint32_t n = 0; n < numbers.size(); ++n) blocks.add(tree.boxOf(n));
  const std::size_t count = mesh.triangles.size();
  constexpr std::size_t kChunk = 512;
  std::vector<std::vector<std::array<std::uint32_t, 2>>> found((count + kChunk - 1) / kChunk);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, found.size()),
                    [&](const tbb::blocked_range<std::size_t>& r) {
                      for (std::size_t chunk = r.begin(); chunk < r.end(); ++chunk)
                        for (std::size_t i = chunk * kChunk; i < std::min(count, (chunk + 1) * kChunk); ++i) {
                          const auto t = static_cast<std::uint32_t>(i);
                          const Corners& corners = mesh.triangles[t];
                          const Box box = boxOf(mesh, corners);
                          if (!blocks.isNear(box)) continue;
                          tree.forEachTouching(box, [&](std::uint32_t n) {
                            const std::uint32_t other = numbers[n];
                            // A pair of two chosen ones is tested once.
                            if (other == t || (chosen[t] && other < t)) return;
                            if (meetBadly(mesh, corners, mesh.triangles[other]))
                              found[chunk].push_back({std::min(t, other), std::max(t, other)});
                          });
                        }
                    });
  std::vector<std::array<std::uint32_t, 2>> pairs;
  for (const auto& chunk : found) pairs.insert(pairs.end(), chunk.begin(), chunk.end());
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace restroke::points
