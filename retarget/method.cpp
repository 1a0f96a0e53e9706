#include "retarget/method.h"

#include <fmt/format.h>

#include <array>
#include <string>

#include "implicit/errors.h"
#include "retarget/methods/depth.h"
#include "retarget/methods/embree.h"
#include "retarget/methods/exact.h"
#include "retarget/methods/followers.h"

namespace restroke::retarget {
namespace {

struct Entry {
  Method method;
  std::string_view name;
  bool deterministic;
  bool needsTrail = false;
};
constexpr std::array kMethods{
    Entry{Method::Depth, "depth", false},           Entry{Method::DepthCpu, "depth-cpu", true},
    Entry{Method::Embree, "embree", false},         Entry{Method::Exact, "exact", true},
    Entry{Method::Fixed, "fixed", true, true},      Entry{Method::Nearest, "nearest", true, true},
    Entry{Method::Mapped, "mapped", true, true},    Entry{Method::Surface, "surface", true, true},
    Entry{Method::Aligned, "aligned", false, true},
};

const Entry& entryOf(Method method) {
  for (const Entry& entry : kMethods)
    if (entry.method == method) return entry;
  throw InternalError(fmt::format("method {} has no name", static_cast<int>(method)));
}

}  // namespace

std::string_view nameOf(Method method) {
  return entryOf(method).name;
}

Method methodNamed(std::string_view name) {
  std::string names;
  for (const Entry& entry : kMethods) {
    if (entry.name == name) return entry.method;
    names += names.empty() ? "" : ", ";
    names += entry.name;
  }
  throw InputError(fmt::format("method '{}' is not known; the methods are {}", name, names));
}

bool isDeterministic(Method method) {
  return entryOf(method).deterministic;
}

bool needsTrail(Method method) {
  return entryOf(method).needsTrail;
}

std::optional<Ray> Caster::readsAlong(const StrokePlace&) const {
  return std::nullopt;
}

std::unique_ptr<Caster> makeCaster(Method method, const CasterInput& input) {
  switch (method) {
    case Method::Depth:
      return makeDepthCaster(input);
    case Method::DepthCpu:
      return makeDepthCpuCaster(input);
    case Method::Embree:
      return makeEmbreeCaster(input);
    case Method::Exact:
    case Method::Aligned:  // the camera is the aligned one already
      return makeExactCaster(input);
    case Method::Fixed:
      return makeFixedCaster(input);
    case Method::Mapped:
      return makeMappedCaster(input);
    case Method::Nearest:
      return makeNearestCaster(input);
    case Method::Surface:
      return makeSurfaceCaster(input);
  }
  throw InternalError(fmt::format("method {} has no caster", static_cast<int>(method)));
}

std::unique_ptr<Caster> makeCaster(Method method, const points::SurfelModel& model, const Camera& camera,
                                   implicit::Prefix prefix, const Execution& execution) {
  return makeCaster(method, {.model = model, .camera = camera, .prefix = prefix, .execution = execution});
}

}  // namespace restroke::retarget
