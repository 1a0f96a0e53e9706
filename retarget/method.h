#pragma once
// How a stroke's screen points find the surface again (SPEC S7). One caster a stroke: it knows the camera and
// the shape as it is just before the stroke, and is asked for one screen point after another.

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "implicit/geometry/camera.h"
#include "points/surfel_model.h"

namespace restroke::retarget {

enum class Method : std::uint8_t { Depth, DepthCpu, Embree, Exact };

/// "depth" (OpenGL depth buffer, as the paper has it), "depth-cpu" (depth buffer of the CPU renderer),
/// "embree", "exact".
[[nodiscard]] std::string_view nameOf(Method method);
/// Throws InputError that lists the names.
[[nodiscard]] Method methodNamed(std::string_view name);
/// True when the same log gives the same bits on every machine; false when the outcome depends on a driver or
/// on an instruction set, and is therefore recorded in the log (DESIGN invariant 5).
[[nodiscard]] bool isDeterministic(Method method);

struct SurfaceHit {
  Point position{0};     ///< model units
  Vec3 normal{0, 0, 1};  ///< unit, out of the shape
  bool operator==(const SurfaceHit&) const = default;
};

/// Casts screen points of one camera onto one state of the shape.
class Caster {
 public:
  virtual ~Caster() = default;
  /// The surface point seen at the screen point, or nothing where the ray misses the shape.
  [[nodiscard]] virtual std::optional<SurfaceHit> cast(ScreenPoint p) = 0;
};

/// A caster for the prefix of the model. The model must outlive it unchanged. Cost: `exact` none; `depth`
/// draws the shape once, `embree` builds a scene of the prefix's surfels.
[[nodiscard]] std::unique_ptr<Caster> makeCaster(Method method, const points::SurfelModel& model,
                                                 const Camera& camera, implicit::Prefix prefix = {},
                                                 const Execution& execution = {});

}  // namespace restroke::retarget
