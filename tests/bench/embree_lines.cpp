#include "tests/bench/embree_lines.h"

#include <chrono>
#include <cmath>

#include "implicit/errors.h"
#include "retarget/methods/embree_api.h"

namespace restroke::bench {
namespace {

std::size_t crossingsOn(RTCScene scene, RTCRayHit& query) {
  std::size_t count = 0;
  for (;; ++count) {
    query.ray.tfar = 1e30f;
    query.ray.mask = ~0u;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    retarget::intersectOne(scene, query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return count;
    query.ray.tnear = std::nextafter(query.ray.tfar, 1e30f);
  }
}

}  // namespace

EmbreeLines castLines(const TriangleMesh& mesh, const points::DexelGrid& grid) {
  using Clock = std::chrono::steady_clock;
  EmbreeLines out;
  RTCDevice device = rtcNewDevice("threads=1");
  if (device == nullptr) throw InputError("Embree cannot be started");
  const auto begin = Clock::now();
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertex = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
  for (const Point& p : mesh.vertices)
    for (int a = 0; a < 3; ++a) *vertex++ = p[a];
  auto* index = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) *index++ = v;
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  const Box box = boundsOf(mesh);
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int row = 0; row < grid.height(axis); ++row)
      for (int column = 0; column < grid.width(axis); ++column) {
        RTCRayHit query{};
        float* const origin = &query.ray.org_x;
        origin[axis] = box.min[axis] - box.halfDiagonal();
        origin[u] = grid.at(u, column);
        origin[v] = grid.at(v, row);
        (&query.ray.dir_x)[axis] = 1;
        out.crossings += crossingsOn(scene, query);
      }
  }
  out.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
  return out;
}

}  // namespace restroke::bench
