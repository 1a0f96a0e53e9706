#include "implicit/geometry/triangle_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "implicit/errors.h"

namespace restroke {

TriangleTree::TriangleTree(const TriangleMesh& mesh) {
  RESTROKE_CHECK_LT(mesh.triangles.size(), std::size_t{std::numeric_limits<std::uint32_t>::max()} / 2);
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  boxes_.reserve(count);
  for (const auto& triangle : mesh.triangles) {
    Box box;
    for (const std::uint32_t v : triangle) box.add({mesh.vertices[v], mesh.vertices[v]});
    boxes_.push_back(box);
  }
  order_.resize(count);
  std::iota(order_.begin(), order_.end(), 0u);
  if (count > 0) build(0, count);
}

void TriangleTree::build(std::uint32_t first, std::uint32_t count) {
  const auto begin = order_.begin() + first, end = begin + count;
  Node node;
  node.first = first;
  node.count = count;
  for (auto t = begin; t != end; ++t) node.box.add(boxes_[*t]);
  const std::size_t self = nodes_.size();
  nodes_.push_back(node);
  skip_.push_back(0);
  if (count > kLeafTriangles) {
    const Vec3 size = node.box.max - node.box.min;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    // Ties go by the triangle's number, so that which triangles go left is one answer only; the order in
    // which nth_element leaves them does not matter, since leaves sort theirs.
    const auto key = [&](std::uint32_t t) {
      return std::pair(static_cast<double>(boxes_[t].min[axis]) + static_cast<double>(boxes_[t].max[axis]),
                       t);
    };
    const std::uint32_t half = count / 2;
    std::nth_element(begin, begin + half, end,
                     [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    build(first, half);
    nodes_[self].right = static_cast<std::uint32_t>(nodes_.size());
    build(first + half, count - half);
  } else {
    std::sort(begin, end);
  }
  skip_[self] = static_cast<std::uint32_t>(nodes_.size());
}

}  // namespace restroke
