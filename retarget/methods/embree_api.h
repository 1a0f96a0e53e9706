#pragma once
// Embree 3 (Debian 12) and Embree 4 (Debian 13) behind one call.

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace restroke::retarget {

/// Nearest hit of one ray; geomID stays RTC_INVALID_GEOMETRY_ID where there is none.
inline void intersectOne(RTCScene scene, RTCRayHit& query) {
#if RTC_VERSION_MAJOR >= 4
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  rtcIntersect1(scene, &query, &arguments);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &query);
#endif
}

}  // namespace restroke::retarget
