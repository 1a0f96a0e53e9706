#include "experiments/retarget/trials.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "implicit/errors.h"
#include "retarget/measures.h"

namespace restroke::experiments {
namespace {

using retarget::Method;

bool onlyLooks(Method method) {
  return method == Method::Depth || method == Method::DepthCpu || method == Method::Embree;
}

FoundMotion asked(std::span<const retarget::OrientedPoint> before, const points::SurfelModel& after,
                  const retarget::AlignmentOptions& options) {
  const retarget::Alignment found =
      retarget::alignSurfels(before, retarget::orientedPoints(after.surfels()), options);
  FoundMotion motion{.verdict = std::string(retarget::nameOf(found.verdict)), .motion = std::nullopt};
  if (found.verdict == retarget::AlignmentVerdict::Found) motion.motion = found.motion;
  return motion;
}

}  // namespace

std::vector<Method> methodsToTry(const RetargetOptions& options, std::vector<std::string>& notes) {
  std::vector<Method> methods{Method::Fixed,  Method::Nearest, Method::DepthCpu,
                              Method::Depth,  Method::Embree,  Method::Exact,
                              Method::Mapped, Method::Surface, Method::Aligned};
  const auto leaveOut = [&](const std::string& why) {
    std::erase(methods, Method::Depth);
    notes.push_back(why);
  };
  if (!options.openGl) {
    leaveOut("depth (OpenGL) was left out: depth-cpu draws the same depth");
    return methods;
  }
  try {
    const auto model = modelOf(implicit::Shape(), 100, {});
    (void)retarget::makeCaster(Method::Depth, *model, frameSphere(Point(0), 1));
  } catch (const InputError& error) {
    leaveOut(fmt::format("depth was left out: {}", error.what()));
  }
  return methods;
}

FoundMotion alignedWhole(const points::SurfelModel& before, const points::SurfelModel& after,
                         const retarget::AlignmentOptions& options) {
  return asked(retarget::orientedPoints(before.surfels()), after, options);
}

FoundMotion alignedPatch(const points::SurfelModel& before, const points::SurfelModel& after,
                         const PatchOf& patch, const retarget::AlignmentOptions& options) {
  const auto points = retarget::orientedPoints(before.surfels());
  return asked(retarget::patchAround(points, patch.stroke.hits(), patch.radius), after, options);
}

/// The list holds the base alone.
class Follower::BaseOwner final : public retarget::Owners {
 public:
  explicit BaseOwner(const points::SurfelModel& model) : model_(model) {}
  [[nodiscard]] std::optional<implicit::Primitive> find(retarget::OwnerKey owner) const override {
    return owner == retarget::OwnerKey{} ? std::optional(model_.list().at(0)) : std::nullopt;
  }

 private:
  const points::SurfelModel& model_;
};

Follower::Follower(const ChangedBase& base, Method method, const Execution& execution)
    : base_(base),
      method_(method),
      execution_(execution),
      owners_(std::make_shared<BaseOwner>(*base.model)) {}

bool Follower::fellBack() const {
  return method_ == Method::Aligned && !base_.motion->motion;
}

retarget::Caster& Follower::casterFor(const DrawnStroke& stroke) {
  if (onlyLooks(method_) && camera_ == stroke.stroke.camera) return *caster_;
  camera_ = stroke.stroke.camera;
  retarget::CasterInput input{
      .model = *base_.model,
      .camera = stroke.stroke.camera,
      .execution = execution_,
      .change = {.original = &stroke.trail, .map = base_.change->map.get(), .owners = owners_.get()}};
  Method method = method_;
  if (fellBack()) {
    method = Method::Exact;
  } else if (method_ == Method::Aligned) {
    input.camera = moved(*base_.motion->motion, input.camera);
    input.change.scale = static_cast<float>(base_.motion->motion->scale);
  }
  caster_.reset();
  caster_ = retarget::makeCaster(method, input);
  return *caster_;
}

retarget::Trail Follower::follow(const DrawnStroke& stroke) {
  return castAt(stroke.trail, casterFor(stroke));
}

retarget::Trail castAt(const retarget::Trail& original, retarget::Caster& caster) {
  retarget::Trail trail;
  trail.points.reserve(original.points.size());
  for (const retarget::TrailPoint& p : original.points)
    trail.points.push_back({p.place, caster.cast(p.place)});
  return trail;
}

OffSurface offSurface(const retarget::Trail& trail, const retarget::SurfaceDistance& surface) {
  OffSurface off;
  double squares = 0, count = 0;
  for (const retarget::TrailPoint& p : trail.points) {
    if (!p.hit) continue;
    const double d = surface.from(*p.hit).value_or(0);
    off.greatest = std::max(off.greatest, d);
    squares += d * d;
    ++count;
  }
  if (count > 0) off.rms = std::sqrt(squares / count);
  return off;
}

RetargetTrial measured(const DrawnStroke& stroke, const ChangedBase& base, const retarget::Trail& found,
                       double baseSize) {
  const retarget::Trail truth = retarget::mapped(stroke.trail, *base.change->map);
  const retarget::StrokeObservations seen = retarget::observe(
      {.result = found, .truth = &truth, .original = &stroke.trail, .camera = stroke.stroke.camera});
  const retarget::Measures m = retarget::summarise({&seen, 1});
  RetargetTrial trial;
  trial.places = seen.expected;
  trial.length = seen.trueLength;
  const double none = std::numeric_limits<double>::infinity();
  trial.rms = seen.errors.empty() ? none : m.errorRmsOfLength;
  trial.worst = seen.errors.empty() ? none : m.errorMaxOfLength;
  trial.lost = seen.expected > 0 ? m.missRate : 0;
  trial.surface = offSurface(found, *base.surface).greatest / baseSize;
  trial.stretch = 1 + m.lengthDrift;
  return trial;
}

}  // namespace restroke::experiments
