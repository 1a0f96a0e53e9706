#include "tests/bench/embree_discs.h"

#include "implicit/errors.h"
#include "retarget/methods/embree_api.h"

namespace restroke::bench {

struct EmbreeDiscs::Scene {
  RTCScene scene = nullptr;
};

namespace {

// One device for the process, whose scenes are built by the thread that asks.
RTCDevice device() {
  static const RTCDevice shared = rtcNewDevice("threads=1");
  if (shared == nullptr) throw InputError("Embree cannot be started");
  return shared;
}

float* buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::size_t floats, std::size_t n) {
  void* memory = rtcSetNewGeometryBuffer(geometry, type, 0, format, floats * sizeof(float), n);
  if (memory == nullptr) throw InputError("Embree has no memory for the discs");
  return static_cast<float*>(memory);
}

}  // namespace

EmbreeDiscs::EmbreeDiscs(std::span<const points::Surfel> surfels)
    : scene_(std::make_unique<Scene>(Scene{rtcNewScene(device())})) {
  const RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
  float* vertex = buffer(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, 4, surfels.size());
  float* normal = buffer(geometry, RTC_BUFFER_TYPE_NORMAL, RTC_FORMAT_FLOAT3, 3, surfels.size());
  for (const points::Surfel& s : surfels) {
    for (const float value : {s.position.x, s.position.y, s.position.z, s.radius}) *vertex++ = value;
    for (const float value : {s.normal.x, s.normal.y, s.normal.z}) *normal++ = value;
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_->scene);
  if (rtcGetDeviceError(device()) != RTC_ERROR_NONE)
    throw InputError("Embree cannot build the scene of all surfels");
}

EmbreeDiscs::~EmbreeDiscs() {
  rtcReleaseScene(scene_->scene);
}

std::optional<double> EmbreeDiscs::castRay(const Ray& ray) const {
  RTCRayHit query{};
  query.ray.org_x = static_cast<float>(ray.origin.x);
  query.ray.org_y = static_cast<float>(ray.origin.y);
  query.ray.org_z = static_cast<float>(ray.origin.z);
  query.ray.dir_x = static_cast<float>(ray.direction.x);
  query.ray.dir_y = static_cast<float>(ray.direction.y);
  query.ray.dir_z = static_cast<float>(ray.direction.z);
  query.ray.tnear = static_cast<float>(ray.tMin);
  query.ray.tfar = static_cast<float>(ray.tMax);
  query.ray.mask = ~0u;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  retarget::intersectOne(scene_->scene, query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return static_cast<double>(query.ray.tfar);
}

}  // namespace restroke::bench
