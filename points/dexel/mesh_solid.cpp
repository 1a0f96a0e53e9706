#include "points/dexel/mesh_solid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "implicit/errors.h"
#include "implicit/geometry/mesh_crossings.h"

namespace restroke::points {

namespace {

const TriangleMesh& checked(const TriangleMesh& mesh) {
  for (const Point& p : mesh.vertices)
    if (!isFinite(p)) throw InputError("a vertex of the mesh is not finite; it must be");
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle)
      if (v >= mesh.vertices.size())
        throw InputError(
            fmt::format("a triangle names vertex {} of {}; it must be there", v, mesh.vertices.size()));
  return mesh;
}

}  // namespace

MeshForLines::MeshForLines(const TriangleMesh& mesh)
    : mesh_(checked(mesh)), tree_(mesh), radius_(static_cast<double>(boundsOf(mesh).halfDiagonal())) {}

MeshSolid::MeshSolid(std::shared_ptr<const MeshForLines> mesh, const PoseMatrix& pose)
    : mesh_(std::move(mesh)) {
  checkPose(pose);
  // The pose is a rotation times a scale, nearly: its inverse proper, by cofactors.
  const DVec3 x(pose[0], pose[4], pose[8]), y(pose[1], pose[5], pose[9]), z(pose[2], pose[6], pose[10]);
  const double determinant = dot(x, cross(y, z));
  rows_[0] = cross(y, z) / determinant;
  rows_[1] = cross(z, x) / determinant;
  rows_[2] = cross(x, y) / determinant;
  translation_ = {pose[3], pose[7], pose[11]};
  Box box;
  for (const auto& triangle : mesh_->mesh().triangles)
    for (const std::uint32_t v : triangle) {
      const DVec3 p = posed(pose, DVec3(mesh_->mesh().vertices[v]));
      const double by = 0x1p-22 * std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
      box.add({Point(p - DVec3(by)), Point(p + DVec3(by))});
    }
  if (!box.empty() && (!isFinite(box.min) || !isFinite(box.max)))
    throw InputError("the pose takes the tool beyond what float32 can hold; it must not");
  setBounds(box);
}

void MeshSolid::intersect(const Ray& line, std::vector<SolidSpan>& spans) const {
  const auto intoMesh = [&](DVec3 v) { return DVec3(dot(rows_[0], v), dot(rows_[1], v), dot(rows_[2], v)); };
  const Ray ray{intoMesh(line.origin - translation_), intoMesh(line.direction)};
  thread_local std::vector<RayCrossing> crossings;
  const TriangleMesh& mesh = mesh_->mesh();
  findCrossings({mesh, mesh_->tree(), mesh_->radius()}, ray, crossings);
  if (crossings.size() % 2 != 0) return;
  // Out of the solid, in model space: a normal goes with the inverse's transpose, which is that of a rotation
  // but for its length. Against the line where it enters, along it where it leaves.
  const auto normalOf = [&](const RayCrossing& at, double side) {
    const auto& t = mesh.triangles[at.triangle];
    const DVec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
    const DVec3 n = cross(b - a, c - a);
    const DVec3 turned = n.x * rows_[0] + n.y * rows_[1] + n.z * rows_[2];
    const double size = length(turned);
    if (!(size > 0)) return Vec3(side * line.direction);
    return Vec3((dot(turned, line.direction) * side < 0 ? -1 : 1) / size * turned);
  };
  const std::size_t first = spans.size();
  for (std::size_t i = 0; i < crossings.size(); i += 2) {
    const RayCrossing &in = crossings[i], &out = crossings[i + 1];
    if (!(in.t < out.t)) continue;
    if (spans.size() > first && spans.back().exit == in.t) {
      spans.back().exit = out.t;
      spans.back().exitNormal = normalOf(out, 1);
      continue;
    }
    spans.push_back({in.t, out.t, normalOf(in, -1), normalOf(out, 1)});
  }
}

}  // namespace restroke::points
