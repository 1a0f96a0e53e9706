#include "tests/bench/openvdb_meshing.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <chrono>
#include <vector>

namespace restroke::bench {

OpenVdbMeshing meshThroughOpenVdb(const TriangleMesh& mesh, double voxel) {
  using Clock = std::chrono::steady_clock;
  const auto seconds = [](Clock::duration d) { return std::chrono::duration<double>(d).count(); };
  openvdb::initialize();
  std::vector<openvdb::Vec3s> vertices;
  std::vector<openvdb::Vec3I> triangles;
  for (const Point& p : mesh.vertices) vertices.emplace_back(p.x, p.y, p.z);
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  OpenVdbMeshing out;
  const auto begin = Clock::now();
  const auto transform = openvdb::math::Transform::createLinearTransform(voxel);
  const auto grid = openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*transform, vertices, triangles);
  const auto middle = Clock::now();
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid, points, quads, 0.0);
  out.toLevelSet = seconds(middle - begin);
  out.toMesh = seconds(Clock::now() - middle);
  out.quads = quads.size();
  return out;
}

}  // namespace restroke::bench
