#include "retarget/method.h"

#include <fmt/format.h>

#include <array>
#include <string>

#include "implicit/errors.h"
#include "retarget/methods/depth.h"
#include "retarget/methods/embree.h"
#include "retarget/methods/exact.h"

namespace restroke::retarget {
namespace {

struct Entry {
  Method method;
  std::string_view name;
  bool deterministic;
};
constexpr std::array kMethods{
    Entry{Method::Depth, "depth", false},
    Entry{Method::DepthCpu, "depth-cpu", true},
    Entry{Method::Embree, "embree", false},
    Entry{Method::Exact, "exact", true},
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

std::unique_ptr<Caster> makeCaster(Method method, const points::SurfelModel& model, const Camera& camera,
                                   implicit::Prefix prefix, const Execution& execution) {
  const CasterInput input{model, camera, prefix, execution};
  switch (method) {
    case Method::Depth:
      return makeDepthCaster(input);
    case Method::DepthCpu:
      return makeDepthCpuCaster(input);
    case Method::Embree:
      return makeEmbreeCaster(input);
    case Method::Exact:
      return makeExactCaster(input);
  }
  throw InternalError(fmt::format("method {} has no caster", static_cast<int>(method)));
}

}  // namespace restroke::retarget
