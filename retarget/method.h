#pragma once
// How a stroke's screen points find the surface again (SPEC S7). One caster a stroke: it knows the camera and
// the shape as it is just before the stroke, and is asked for one place of the stroke after another.

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "implicit/geometry/camera.h"
#include "implicit/geometry/space_map.h"
#include "points/surfel_model.h"

namespace restroke::retarget {

/// Declared in the order of their names in messages.
enum class Method : std::uint8_t { Depth, DepthCpu, Embree, Exact, Fixed, Nearest, Mapped, Surface, Aligned };

/// "depth" (OpenGL depth buffer, as the paper has it), "depth-cpu" (depth buffer of the CPU renderer),
/// "embree", "exact", "fixed", "nearest", "mapped", "surface", "aligned".
[[nodiscard]] std::string_view nameOf(Method method);
/// Throws InputError that lists the names.
[[nodiscard]] Method methodNamed(std::string_view name);
/// True when the same log gives the same bits on every machine; false when the outcome depends on a driver,
/// on an instruction set or on a numerical solver, and is therefore recorded in the log (DESIGN invariant 5).
[[nodiscard]] bool isDeterministic(Method method);
/// True when a stroke that is applied again starts from where it was when it was first applied (Change).
[[nodiscard]] bool needsTrail(Method method);

/// A place on a stroke.
struct StrokePlace {
  // Not explicit: a screen point alone is a place, for casters that ask for no more.
  StrokePlace(ScreenPoint screenPoint, double alongStroke = 0)  // NOLINT(google-explicit-constructor)
      : screen(screenPoint), along(alongStroke) {}
  StrokePlace() = default;
  ScreenPoint screen;
  /// Number of the input point, counted from 0, plus the part of the way to the next one. Exact: a multiple
  /// of 2^-26.
  double along = 0;
  bool operator==(const StrokePlace&) const = default;
};

inline constexpr implicit::PrimitiveId kNoPrimitive{0xffffffff};

struct SurfaceHit {
  Point position{0};     ///< model units
  Vec3 normal{0, 0, 1};  ///< unit, out of the shape
  /// Whose boundary it is, where the method knows; an id of the list that was cast on.
  implicit::PrimitiveId primitive = kNoPrimitive;
  /// How much lengths have grown here since the stroke was first applied, where the method knows.
  float scale = 1;
  bool operator==(const SurfaceHit&) const = default;
};

/// Finds places of one stroke on one state of the shape.
class Caster {
 public:
  virtual ~Caster() = default;
  /// The surface point of the place, or nothing where the stroke misses the shape there.
  [[nodiscard]] virtual std::optional<SurfaceHit> cast(const StrokePlace& place) = 0;
  /// What cast(place) reads of the shape: what lies along this ray up to the hit, and nothing else. Nothing
  /// where it may read any of the shape.
  [[nodiscard]] virtual std::optional<Ray> readsAlong(const StrokePlace& place) const;
};

struct Trail;
class Owners;
class KeptDiscs;

/// What a method may know of the change since the stroke was first applied. All null: it is applied for the
/// first time, and methods that follow a change cast as `exact` does.
struct Change {
  const Trail* original = nullptr;  ///< where the stroke was when it was first applied
  const SpaceMap* map = nullptr;    ///< what the base went through since, where that is known
  const Owners* owners = nullptr;   ///< where the primitives are now that carried the original
  float scale = 1;                  ///< of `aligned`: how much the motion scales
};

/// What every method starts from. The model and what `change` points to must outlive the caster unchanged,
/// `discs` must outlive it.
struct CasterInput {
  const points::SurfelModel& model;
  /// The stroke's own camera; of `aligned`, the camera that the motion has moved (alignment.h).
  Camera camera;
  implicit::Prefix prefix = {};
  Execution execution = {};
  Change change = {};
  KeptDiscs* discs = nullptr;  ///< of `embree`: the scene kept from stroke to stroke; changes no result
};

/// A caster for the prefix of the model. Cost: `exact`, `fixed`, `mapped`, `surface`, `aligned` none; `depth`
/// draws the shape once, `embree` builds a scene of the prefix's surfels, or of what has changed of it with
/// CasterInput::discs, `nearest` a tree of them, and `surface` that tree at the first place that needs it.
[[nodiscard]] std::unique_ptr<Caster> makeCaster(Method method, const CasterInput& input);
/// The same for a method that only casts.
[[nodiscard]] std::unique_ptr<Caster> makeCaster(Method method, const points::SurfelModel& model,
                                                 const Camera& camera, implicit::Prefix prefix = {},
                                                 const Execution& execution = {});

}  // namespace restroke::retarget
