// A. Jacobson, L. Kavan, O. Sorkine-Hornung, Robust Inside-Outside Segmentation using Generalized Winding
// Numbers, 2013, section 4 (the sum of solid angles; each by A. van Oosterom and J. Strackee, The Solid Angle
// of a Plane Triangle, 1983). G. Barill et al., Fast Winding Numbers for Soups and Clouds, 2018, section 3:
// what is far away is replaced by a Taylor expansion, here up to second derivatives. We differ in the tree
// (halves by the median instead of an octree) and in the arctangent, which is our own, so that results do not
// depend on the platform's.

#include "implicit/geometry/winding_number.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "implicit/geometry/det_math.h"

namespace restroke {
namespace {

/// A cluster is expanded when the point is farther from its centre than this many radii. 2 is what the paper
/// uses.
constexpr double kFar = 2;

/// Pairs jk of Cluster::second.
constexpr std::array<std::array<int, 2>, 6> kPairs = {{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};

std::array<DVec3, 3> cornersOf(const TriangleMesh& mesh, std::uint32_t triangle) {
  const auto& t = mesh.triangles[triangle];
  return {DVec3(mesh.vertices[t[0]]), DVec3(mesh.vertices[t[1]]), DVec3(mesh.vertices[t[2]])};
}

DVec3 areaOf(const std::array<DVec3, 3>& t) {
  return cross(t[1] - t[0], t[2] - t[0]) * 0.5;
}

}  // namespace

WindingNumber::WindingNumber(TriangleMesh mesh) : mesh_(std::move(mesh)), tree_(mesh_) {
  clusters_.reserve(tree_.nodes().size());
  for (const auto& node : tree_.nodes()) clusters_.push_back(clusterOf(node));
}

WindingNumber::Cluster WindingNumber::clusterOf(const TriangleTree::Node& node) const {
  const auto triangles = tree_.order().subspan(node.first, node.count);
  Cluster c;
  double total = 0;
  DVec3 weighted(0);
  for (const std::uint32_t t : triangles) {
    const auto corners = cornersOf(mesh_, t);
    const double weight = length(areaOf(corners));
    total += weight;
    weighted += (corners[0] + corners[1] + corners[2]) * (weight / 3);
  }
  c.center = total > 0 ? weighted / total : DVec3(node.box.center());
  double furthest = 0;
  for (const std::uint32_t t : triangles) {
    const auto corners = cornersOf(mesh_, t);
    const DVec3 area = areaOf(corners);
    const std::array<DVec3, 3> d = {corners[0] - c.center, corners[1] - c.center, corners[2] - c.center};
    for (const DVec3& corner : d) furthest = std::max(furthest, dot(corner, corner));
    // Over a triangle the mean of d is that of its corners, and the mean of d_j d_k is a twelfth of the sum
    // of the corners' d_j d_k and of the products of the sums.
    const DVec3 sum = d[0] + d[1] + d[2];
    c.area += area;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) c.first[i][j] += area[i] * sum[j] / 3;
    for (std::size_t jk = 0; jk < kPairs.size(); ++jk) {
      const auto [j, k] = kPairs[jk];
      const double products = d[0][j] * d[0][k] + d[1][j] * d[1][k] + d[2][j] * d[2][k] + sum[j] * sum[k];
      const double mean = products / (j == k ? 24 : 12);
      for (int i = 0; i < 3; ++i) c.second[i][jk] += area[i] * mean;
    }
  }
  c.radius = std::sqrt(furthest);
  return c;
}

/// The field of a small piece of area at a point is n . R / (4 pi |R|^3), R the way from the point to the
/// piece; expanded about the centre.
double WindingNumber::farWinding(const Cluster& c, DVec3 away) {
  const double square = dot(away, away), distance = std::sqrt(square);
  const DVec3 u = away / distance;  // so that no power of a large or small distance leaves the range
  const auto& M = c.first;
  const double trace = M[0][0] + M[1][1] + M[2][2];
  double along = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) along += u[i] * M[i][j] * u[j];
  // Contracted with 15 u_i u_j u_k - 3 (delta_ij u_k + delta_ik u_j + delta_jk u_i).
  double second = 0;
  for (int i = 0; i < 3; ++i)
    for (std::size_t jk = 0; jk < kPairs.size(); ++jk) {
      const auto [j, k] = kPairs[jk];
      const double deltas = (i == j ? u[k] : 0) + (i == k ? u[j] : 0) + (j == k ? u[i] : 0);
      second += c.second[i][jk] * (15 * u[i] * u[j] * u[k] - 3 * deltas);
    }
  return (dot(c.area, u) + (trace - 3 * along) / distance + second / square) / square / (4 * kPi);
}

/// Solid angle of a triangle over 4 pi: positive where p is behind it.
double WindingNumber::windingOf(std::uint32_t triangle, DVec3 p) const {
  const auto corners = cornersOf(mesh_, triangle);
  const DVec3 a = corners[0] - p, b = corners[1] - p, c = corners[2] - p;
  // Not a . (b x c), which loses its digits far away.
  const double volume = dot(a, cross(corners[1] - corners[0], corners[2] - corners[0]));
  if (volume == 0) return 0;
  const double la = length(a), lb = length(b), lc = length(c);
  const double below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  return detAtan2(volume, below) / (2 * kPi);
}

double WindingNumber::at(DVec3 p) const {
  double winding = 0;
  // Left before right, so that the sum has one order. The tree halves counts that are below 2^31: 32 levels.
  std::array<std::uint32_t, 64> stack{};
  std::size_t size = tree_.nodes().empty() ? 0 : 1;
  while (size > 0) {
    const std::uint32_t n = stack[--size];
    const TriangleTree::Node& node = tree_.nodes()[n];
    const Cluster& cluster = clusters_[n];
    const DVec3 away = cluster.center - p;
    if (dot(away, away) > kFar * kFar * cluster.radius * cluster.radius) {
      winding += farWinding(cluster, away);
    } else if (node.right == 0) {
      for (const std::uint32_t t : tree_.order().subspan(node.first, node.count)) winding += windingOf(t, p);
    } else {
      stack[size++] = node.right;
      stack[size++] = n + 1;
    }
  }
  return winding;
}

double WindingNumber::exactAt(DVec3 p) const {
  double winding = 0;
  for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) winding += windingOf(t, p);
  return winding;
}

bool WindingNumber::isInside(DVec3 p) const {
  const double fast = at(p);
  if (fast > 0.5 + kFastError) return true;
  if (fast < 0.5 - kFastError) return false;
  return exactAt(p) > 0.5;
}

}  // namespace restroke
