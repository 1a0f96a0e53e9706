// Rays against surfels: S. Rusinkiewicz and M. Levoy, QSplat, 2000, and G. Schaufler and H. W. Jensen, Ray
// tracing point sampled geometry, 2000, let discs stand for the surface. We use them only to know that there
// is a surface, and about where; place and normal come from the list.

#include "retarget/methods/embree.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "implicit/errors.h"
#include "implicit/parallel.h"
#include "retarget/methods/embree_api.h"
#include "retarget/methods/exact.h"

namespace restroke::retarget {
namespace {

[[noreturn]] void fail(RTCDevice device, const char* step) {
  throw InputError(
      fmt::format("method embree: {} failed (Embree error {}); the methods exact and depth-cpu do without",
                  step, static_cast<int>(rtcGetDeviceError(device))));
}

/// One device for the process: making one starts Embree's machinery, and scenes of one device share it.
RTCDevice sharedDevice() {
  static const RTCDevice device = rtcNewDevice(nullptr);
  if (device == nullptr) fail(nullptr, "starting Embree");
  return device;
}

/// Embree's copy of the discs' shape has these beside it, to tell faces apart and to know how far to look.
struct Disc {
  Vec3 normal;
  float radius;
};

/// Rejects discs that face away: the far side of a solid.
void keepFrontFaces(const RTCFilterFunctionNArguments* arguments) {
  const auto& discs = *static_cast<const std::vector<Disc>*>(arguments->geometryUserPtr);
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] == 0) continue;
    const Vec3 normal = discs[RTCHitN_primID(arguments->hit, arguments->N, i)].normal;
    const Vec3 direction{RTCRayN_dir_x(arguments->ray, arguments->N, i),
                         RTCRayN_dir_y(arguments->ray, arguments->N, i),
                         RTCRayN_dir_z(arguments->ray, arguments->N, i)};
    if (!(dot(normal, direction) < 0)) arguments->valid[i] = 0;
  }
}

class EmbreeCaster final : public Caster {
 public:
  explicit EmbreeCaster(const CasterInput& input)
      : list_(input.model.list()),
        camera_(input.camera),
        prefix_(input.prefix),
        scene_(rtcNewScene(sharedDevice())) {
    if (scene_ == nullptr) fail(sharedDevice(), "making a scene");
    try {
      build(input.model.surfels(input.prefix, input.execution), input.execution);
    } catch (...) {
      rtcReleaseScene(scene_);
      throw;
    }
  }
  ~EmbreeCaster() override { rtcReleaseScene(scene_); }
  EmbreeCaster(const EmbreeCaster&) = delete;
  EmbreeCaster& operator=(const EmbreeCaster&) = delete;

  std::optional<SurfaceHit> cast(const StrokePlace& place) override {
    const ScreenPoint p = place.screen;
    const Ray ray = rayThrough(camera_, p);
    const double directionLength = length(ray.direction);
    RTCRayHit query{};
    query.ray.org_x = static_cast<float>(ray.origin.x);
    query.ray.org_y = static_cast<float>(ray.origin.y);
    query.ray.org_z = static_cast<float>(ray.origin.z);
    query.ray.dir_x = static_cast<float>(ray.direction.x);
    query.ray.dir_y = static_cast<float>(ray.direction.y);
    query.ray.dir_z = static_cast<float>(ray.direction.z);
    query.ray.tnear = static_cast<float>(ray.tMin);
    query.ray.mask = ~0u;
    for (;;) {
      query.ray.tfar = static_cast<float>(ray.tMax);
      query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      intersectOne(scene_, query);
      if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
      const double reach =
          kDiscReach * static_cast<double>(discs_[query.hit.primID].radius) / directionLength;
      Ray bounded = ray;
      bounded.tMax = std::fmin(ray.tMax, static_cast<double>(query.ray.tfar) + reach);
      if (const auto hit = implicit::castRay(list_, bounded, prefix_)) return rounded(*hit);
      query.ray.tnear = std::nextafter(query.ray.tfar, std::numeric_limits<float>::infinity());
    }
  }

 private:
  void build(const std::vector<points::Surfel>& surfels, const Execution& execution) {
    // In robust mode rays do not slip between neighbouring boxes of the tree.
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    if (!surfels.empty()) addDiscs(surfels);
    inArena(execution, [&] { rtcCommitScene(scene_); });
    if (const RTCError error = rtcGetDeviceError(sharedDevice()); error != RTC_ERROR_NONE)
      throw InputError(fmt::format("method embree: building the scene of {} surfels failed (Embree error {})",
                                   surfels.size(), static_cast<int>(error)));
  }

  void addDiscs(const std::vector<points::Surfel>& surfels) {
    const RTCGeometry geometry = rtcNewGeometry(sharedDevice(), RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), surfels.size()));
    auto* normals = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), surfels.size()));
    if (vertices == nullptr || normals == nullptr) {
      rtcReleaseGeometry(geometry);
      fail(sharedDevice(), "taking memory for the discs");
    }
    discs_.reserve(surfels.size());
    for (const points::Surfel& s : surfels) {
      for (const float value : {s.position.x, s.position.y, s.position.z, s.radius}) *vertices++ = value;
      for (const float value : {s.normal.x, s.normal.y, s.normal.z}) *normals++ = value;
      discs_.push_back({s.normal, s.radius});
    }
    rtcSetGeometryUserData(geometry, &discs_);
    rtcSetGeometryIntersectFilterFunction(geometry, keepFrontFaces);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
  }

  const implicit::PrimitiveList& list_;
  Camera camera_;
  implicit::Prefix prefix_;
  std::vector<Disc> discs_;
  RTCScene scene_;
};

}  // namespace

std::unique_ptr<Caster> makeEmbreeCaster(const CasterInput& input) {
  return std::make_unique<EmbreeCaster>(input);
}

}  // namespace restroke::retarget
