#include <fmt/format.h>

#include "implicit/errors.h"
#include "points/images/gl_renderer.h"
#include "retarget/methods/depth.h"

namespace restroke::retarget {
namespace {

/// One context for the process, made when it is first asked for: making one takes tens of milliseconds, and
/// calls from several threads wait for each other in it. A failure is tried again by the next call.
points::GlRenderer& sharedRenderer() {
  try {
    static points::GlRenderer renderer;
    return renderer;
  } catch (const InputError& error) {
    throw InputError(fmt::format("method depth: {}; the method depth-cpu does without OpenGL", error.what()));
  }
}

}  // namespace

std::unique_ptr<Caster> makeDepthCaster(const CasterInput& input) {
  // The renderer first: where there is none, nothing else is worth the work.
  points::GlRenderer& renderer = sharedRenderer();
  const auto surfels = input.model.surfels(input.prefix, input.execution);
  return makeDepthImageCaster(renderer.renderDepth(surfels, input.camera), input.camera);
}

}  // namespace restroke::retarget
