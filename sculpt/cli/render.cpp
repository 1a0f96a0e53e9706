// restroke render: pictures of the shape at a log's end.

#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "implicit/errors.h"
#include "points/images/cpu_renderer.h"
#include "points/images/exr.h"
#include "points/images/gl_renderer.h"
#include "points/images/png.h"
#include "sculpt/cli/commands.h"
#include "sculpt/cli/replaying.h"
#include "sculpt/cli/words.h"

namespace restroke::cli {

namespace {

// Renderers write their files whole; a second rename puts both pictures in place only once both are complete.
std::unique_ptr<AtomicFile> staged(const std::string& path) {
  return path.empty() ? nullptr : std::make_unique<AtomicFile>(path);
}

}  // namespace

int runRender(const RenderCommandOptions& options) {
  const Execution execution = executionOf(options.common);
  if (options.png.empty() && options.exr.empty())
    throw InputError("render: neither --png nor --exr is given, but a picture needs a file");
  if (options.renderer != "cpu" && options.renderer != "opengl")
    throw InputError(fmt::format("--renderer: \"{}\" must be cpu or opengl", options.renderer));
  const bool opengl = options.renderer == "opengl";
  if (opengl && !options.exr.empty())
    throw InputError("--exr: the layers come from the CPU renderer, and need --renderer cpu");
  const auto [width, height] = sizeNamed(options.size);
  sculpt::StrokeLog log = readLogNoting(options.log);
  overrideDensity(log, options.density);
  Output output(options.common);
  const auto png = staged(options.png), exr = staged(options.exr);

  const sculpt::Document document = replayNoting(log, {.file = options.log}, execution);
  const implicit::PrimitiveList& list = document.model().list();
  const std::vector<points::Surfel> surfels = document.model().surfels(execution);
  const Camera camera =
      viewNamed(options.view, {.log = log, .bounds = framed(surfels), .width = width, .height = height});
  const std::vector<std::uint32_t> nodes = document.nodeOfPrimitive();
  const points::Scene scene{.surfels = surfels, .strokeOfPrimitive = nodes, .list = &list};

  if (opengl) {
    points::GlRenderer renderer;
    points::writePng(png->temporary(), points::toDisplay(renderer.renderColor(scene, camera)));
  } else {
    const points::RenderedImage image = points::render(scene, camera, {}, execution);
    if (png) points::writePng(png->temporary(), image);
    if (exr) points::writeExr(exr->temporary(), image, camera);
  }
  nlohmann::ordered_json json{{"width", width}, {"height", height}, {"surfels", surfels.size()}};
  if (png) png->commit(), json["png"] = options.png;
  if (exr) exr->commit(), json["exr"] = options.exr;
  output.say(fmt::format("{} x {} pixels, {} surfels:{}{}\n", width, height, grouped(surfels.size()),
                         png ? " " + options.png : "", exr ? " " + options.exr : ""));
  output.finish(json);
  return 0;
}

}  // namespace restroke::cli
