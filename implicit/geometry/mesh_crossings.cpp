#include "implicit/geometry/mesh_crossings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace restroke {

namespace {

void collect(const MeshUnderLines& under, const Ray& ray, std::vector<RayCrossing>& crossings) {
  // The ray's frame: its greatest direction becomes z, and x and y are sheared so that the ray is the z
  // axis.
  const DVec3 size(std::fabs(ray.direction.x), std::fabs(ray.direction.y), std::fabs(ray.direction.z));
  const int kz = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const int kx = (kz + 1) % 3, ky = (kz + 2) % 3;
  const double sx = ray.direction[kx] / ray.direction[kz], sy = ray.direction[ky] / ray.direction[kz],
               sz = 1 / ray.direction[kz];
  struct Seen {
    double x, y, z;
  };
  const auto seen = [&](Point v) {
    const DVec3 d = DVec3(v) - ray.origin;
    return Seen{d[kx] - sx * d[kz], d[ky] - sy * d[kz], sz * d[kz]};
  };
  // Which side of the edge the ray passes; when it passes through, as if it were moved by (e, e^2).
  const auto sideOf = [](const Seen& a, const Seen& b) {
    const double area = a.x * b.y - a.y * b.x;
    if (area != 0) return area > 0 ? 1 : -1;
    if (a.y != b.y) return a.y < b.y ? 1 : -1;
    return a.x == b.x ? 0 : a.x > b.x ? 1 : -1;
  };
  const double pad = under.radius * 1e-9;
  const auto misses = [&](const Box& box) {
    double enter = -std::numeric_limits<double>::max(), exit = -enter;
    for (int a = 0; a < 3; ++a) {
      const double lo = static_cast<double>(box.min[a]) - pad, hi = static_cast<double>(box.max[a]) + pad;
      const double o = ray.origin[a], d = ray.direction[a];
      if (d == 0) {
        if (o < lo || o > hi) return true;
        continue;
      }
      const double t0 = (lo - o) / d, t1 = (hi - o) / d;
      enter = std::max(enter, std::min(t0, t1));
      exit = std::min(exit, std::max(t0, t1));
    }
    return !(enter <= exit + 1e-9 * std::fabs(exit));
  };
  const auto nodes = under.tree.nodes();
  if (nodes.empty()) return;
  std::array<std::uint32_t, 128> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t n = stack[--depth];
    const TriangleTree::Node& node = nodes[n];
    if (misses(node.box)) continue;
    if (node.right != 0) {
      stack[depth++] = node.right;
      stack[depth++] = n + 1;
      continue;
    }
    for (const std::uint32_t t : under.tree.order().subspan(node.first, node.count)) {
      const auto& v = under.mesh.triangles[t];
      const Seen a = seen(under.mesh.vertices[v[0]]), b = seen(under.mesh.vertices[v[1]]),
                 c = seen(under.mesh.vertices[v[2]]);
      const int side = sideOf(a, b);
      if (side == 0 || sideOf(b, c) != side || sideOf(c, a) != side) continue;
      const double u = b.x * c.y - b.y * c.x, w = c.x * a.y - c.y * a.x, q = a.x * b.y - a.y * b.x;
      const double sum = u + w + q;
      crossings.push_back({sum != 0 ? (u * a.z + w * b.z + q * c.z) / sum : (a.z + b.z + c.z) / 3, t});
    }
  }
}

}  // namespace

void findCrossings(const MeshUnderLines& mesh, const Ray& ray, std::vector<RayCrossing>& crossings) {
  DVec3 origin = ray.origin;
  for (int attempt = 0; attempt < 8; ++attempt) {
    crossings.clear();
    collect(mesh, {origin, ray.direction}, crossings);
    if (crossings.size() % 2 == 0) break;
    // Rounding put an edge on different sides of the line: one beside it.
    const double aside = mesh.radius * 0x1p-44 * (attempt + 1);
    origin = ray.origin + DVec3(aside, -0.7 * aside, 0.4 * aside);
  }
  std::sort(crossings.begin(), crossings.end(), [](const RayCrossing& a, const RayCrossing& b) {
    return a.t != b.t ? a.t < b.t : a.triangle < b.triangle;
  });
}

}  // namespace restroke
