// restroke dexel refine: new lines where a model is looked at, and on them only the operations that matter.

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "implicit/simd/dispatch.h"
#include "points/dexel/dexel_contour.h"
#include "points/dexel/dexel_surfels.h"
#include "points/dexel/gl/gl_line_replay.h"
#include "points/dexel/refine/ray_picture.h"
#include "points/dexel/refine/refine.h"
#include "points/dexel/refine/refined_surfels.h"
#include "points/dexel/span_rods.h"
#include "points/files/mesh_files.h"
#include "points/files/point_files.h"
#include "points/images/cpu_renderer.h"
#include "points/images/png.h"
#include "sculpt/cli/commands.h"
#include "sculpt/cli/dexel_output.h"
#include "sculpt/cli/replaying.h"
#include "sculpt/cli/words.h"
#include "sculpt/cli/zone_words.h"

namespace restroke::cli {

namespace {

using Clock = std::chrono::steady_clock;
using points::RefinedModel;
using points::RefineMethod;
using points::TriDexel;
using points::TriDexelDocument;
using points::Zone;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

RefineMethod methodNamed(const std::string& name) {
  for (const RefineMethod method : points::kRefineMethods)
    if (name == nameOf(method)) return method;
  throw InputError(fmt::format("--method: \"{}\" must be document, ends, touching, clusters or all", name));
}

// What was asked for, found to be possible.
struct Request {
  Zone zone;
  Camera camera;
  bool rays;  ///< of the camera: the zone is its frustum
  points::NewLines lines;
  std::optional<points::ZoneGrid> grid;  ///< of three families
};

// What the view sees of the model, brought nearer.
Camera cameraOf(const DexelRefineOptions& o, const TriDexel& model, const Execution& execution) {
  if (!(o.zoom > 0) || !(o.zoom <= 1e6))
    throw InputError(fmt::format("--zoom: {} must be greater than 0 and at most 1,000,000", o.zoom));
  const auto [width, height] = sizeNamed(o.size);
  Camera camera = viewNamed(
      o.view,
      {.log = {}, .bounds = framed(surfelsOf(model, {}, execution)), .width = width, .height = height});
  camera.halfHeight = static_cast<float>(static_cast<double>(camera.halfHeight) / o.zoom);
  return camera;
}

Request requestOf(const DexelRefineOptions& o, const TriDexel& model, const Execution& execution) {
  const Camera camera = cameraOf(o, model, execution);
  Request out{zoneNamed(o.zone, camera), camera, false, {}, std::nullopt};
  out.lines = {.resolution = o.resolution, .cell = o.cell, .perPixel = o.perPixel};
  if (o.times) out.lines.among = points::NewLines::Among{model.grid(), *o.times};
  if (!o.direction.empty()) {
    const auto numbers = numbersIn(o.direction, ',');
    if (!numbers || numbers->size() != 3)
      throw InputError(fmt::format("--direction: \"{}\" must be three numbers x,y,z", o.direction));
    out.lines.direction = DVec3((*numbers)[0], (*numbers)[1], (*numbers)[2]);
  }
  if (const auto* seen = std::get_if<Camera>(&out.zone.shape())) {
    out.rays = true;
    out.camera = *seen;
    if (!o.resolution) out.lines.perPixel = true;
    if (o.samples != 1 || (!o.png.empty() && o.spans.empty())) {
      if (o.resolution)
        throw InputError(
            "--resolution: a picture of a frustum has its rays by the pixel; --size must be given");
      out.zone = Zone(points::withRays(*seen, o.samples));
    }
  } else if (o.samples != 1) {
    throw InputError("--samples: rays across a pixel are of frustums; the zone must be one");
  }
  out.grid = gridFor(out.zone, out.lines);
  return out;
}

void refuseOutput(const DexelRefineOptions& o, const Request& request) {
  if (o.out.empty()) return;
  const std::string ending = extensionOf(o.out);
  const bool points = ending == ".xyz" || (ending == ".ply" && !request.grid);
  if (ending == ".tridexel") {
    if (!request.grid || request.grid->isTurned())
      throw InputError(
          fmt::format("{}: a .tridexel file holds lines along x, y and z; the zone must be a box that is "
                      "not turned or a sphere, without --direction",
                      o.out));
  } else if (!points && !request.grid) {
    throw InputError(
        fmt::format("{}: a mesh needs lines in three directions; of these lines points can be "
                    "written, and the name must end in .xyz or .ply",
                    o.out));
  }
}

// Moves what was found in the grid's frame into the model's.
void intoModel(const points::ZoneGrid& grid, std::vector<points::Surfel>& surfels) {
  if (!grid.isTurned()) return;
  for (points::Surfel& surfel : surfels) {
    surfel.position = Point(grid.inModel(DVec3(surfel.position)));
    surfel.normal = Vec3(grid.directionInModel(DVec3(surfel.normal)));
  }
}

class Writer {
 public:
  Writer(const DexelRefineOptions& options, const Request& request, TriDexelDocument& document)
      : options_(options), request_(request), document_(document) {}

  /// Takes the lines out of `refined`.
  void write(RefinedModel& refined, const Execution& execution) {
    if (!options_.spans.empty()) drawSpans(refined, execution);
    if (request_.rays) {
      writeRays(refined, execution);
    } else if (!request_.grid) {
      writePoints(surfelsOf(refined), execution);
    } else {
      writeModel(modelOn(*request_.grid, std::move(refined)), execution);
    }
  }

 private:
  [[nodiscard]] bool drawsSurface() const { return !options_.png.empty() && options_.spans.empty(); }

  // The model's own spans, the new ones and the zone's edges, in three colours.
  void drawSpans(const RefinedModel& refined, const Execution& execution) const {
    using implicit::Sign;
    const auto [width, height] = sizeNamed(options_.size);
    std::vector<points::Surfel> rods;
    appendRods(document_.model, familyNamed(options_.family), rods);
    const Camera camera =
        viewNamed(options_.spans, {.log = {},
                                   .bounds = framed(surfelsOf(document_.model, {}, execution)),
                                   .width = width,
                                   .height = height});
    const auto cell = static_cast<float>(document_.model.grid().cell());
    for (const points::RefinedFamily& family : refined.families)
      appendRods(family.dexels, family.lines.family, {.radius = 0.08f * cell, .primitive = 1}, rods);
    appendEdges(request_.zone, {.radius = 0.1f * cell, .sign = Sign::Negative}, rods);
    points::writePng(options_.png, points::render({.surfels = rods}, camera, {}, execution));
  }

  void writeRays(const RefinedModel& refined, const Execution& execution) {
    if (drawsSurface())
      points::writePng(options_.png, pictureOf(refined.families[0].dexels, request_.camera, {}, execution));
    if (!options_.out.empty()) writePointFile(surfelsOf(refined));
  }

  void writePointFile(const std::vector<points::Surfel>& surfels) const {
    if (extensionOf(options_.out) == ".xyz")
      points::writeXyz(options_.out, surfels);
    else
      points::writePly(options_.out, surfels, {.comments = {"Restroke span ends"}});
  }

  void writePoints(const std::vector<points::Surfel>& surfels, const Execution& execution) const {
    if (drawsSurface()) draw(surfels, execution);
    if (!options_.out.empty()) writePointFile(surfels);
  }

  void draw(const std::vector<points::Surfel>& surfels, const Execution& execution) const {
    const auto [width, height] = sizeNamed(options_.size);
    const Camera camera =
        viewNamed(options_.view, {.log = {}, .bounds = framed(surfels), .width = width, .height = height});
    points::writePng(options_.png, points::render({.surfels = surfels}, camera, {}, execution));
  }

  void writeModel(TriDexel model, const Execution& execution) {
    const points::ZoneGrid& grid = *request_.grid;
    if (drawsSurface()) {
      std::vector<points::Surfel> surfels = surfelsOf(model, {}, execution);
      intoModel(grid, surfels);
      draw(surfels, execution);
    }
    if (options_.out.empty()) return;
    const std::string ending = extensionOf(options_.out);
    if (ending == ".tridexel") {
      document_.model = std::move(model);
      points::writeTriDexel(options_.out, document_);
    } else if (ending == ".xyz") {
      std::vector<points::Surfel> surfels = surfelsOf(model, {.ends = points::DexelEnds::All}, execution);
      intoModel(grid, surfels);
      points::writeXyz(options_.out, surfels);
    } else {
      points::Isosurface made = points::isosurfaceOf(model, execution);
      if (grid.isTurned())
        for (Point& p : made.mesh.vertices) p = Point(grid.inModel(DVec3(p)));
      points::writeMesh(options_.out, made.mesh, {.unit = points::LengthUnit::Millimetre});
    }
  }

  const DexelRefineOptions& options_;
  const Request& request_;
  TriDexelDocument& document_;
};

}  // namespace

int runDexelRefine(const DexelRefineOptions& options) {
  const auto start = Clock::now();
  checkDevice(options.device);
  const RefineMethod method = methodNamed(options.method);
  const Execution execution = executionOf(options.common);
  Output output(options.common);
  TriDexelDocument document = points::readTriDexel(options.model);
  const double reading = secondsSince(start);
  if (!options.spans.empty() && options.png.empty())
    throw InputError("--spans: is a view for a picture; --png must be given");
  const Request request = requestOf(options, document.model, execution);
  refuseOutput(options, request);
  const auto opening = Clock::now();
  const points::DexelHistory history =
      named(options.model, [&] { return points::DexelHistory(document, execution); });
  if (method == RefineMethod::Clusters) history.makeClusters();
  const double opened = secondsSince(opening);
  const std::vector<points::LineFamily> lines = newLines(request.zone, request.lines);
  RefinedModel refined = named(options.model, [&] {
    return points::refine({document, history}, {request.zone, lines},
                          {.method = method, .widening = options.widening}, execution);
  });

  std::size_t inZone = 0, ends = 0;
  for (const points::RefinedFamily& family : refined.families) {
    inZone += family.lines.count();
    ends += family.dexels.endCount();
  }
  const auto volume = refined.volume();
  nlohmann::ordered_json json{{"model", options.model},
                              {"method", nameOf(method)},
                              {"zone", options.zone},
                              {"zone_volume", request.zone.volume()},
                              {"families", refined.families.size()},
                              {"lines", inZone},
                              {"ends", ends},
                              {"operations", history.idCount() - 1},
                              {"collected", refined.ids.size()},
                              {"simd", implicit::simdLevelName()}};
  json["volume"] = volume ? nlohmann::ordered_json(*volume) : nlohmann::ordered_json(nullptr);
  std::string text = fmt::format(
      "{}: {} in the zone, {} span ends; {} of {} replayed ({})\n", options.model, plural(inZone, "line"),
      grouped(ends), plural(refined.ids.size(), "operation"), grouped(history.idCount()), nameOf(method));
  const RefinedModel::Times times = refined.times;
  json["state_hash"] = hexHash(stateHash(refined));
  Writer(options, request, document).write(refined, execution);
  for (const std::string* file : {&options.out, &options.png})
    if (!file->empty()) text += fmt::format("{}\n", *file);
  output.say(
      text +
      fmt::format("{:.3f} s to read, {:.3f} s to prepare the history, {:.3f} s to refine (collect {:.3f}, "
                  "approximate {:.3f}, replay {:.3f})\n",
                  reading, opened, times.all(), times.collect, times.approximate, times.replay));
  if (!options.out.empty()) json["out"] = options.out;
  if (!options.png.empty()) json["png"] = options.png;
  json["seconds_read"] = reading;
  json["seconds_history"] = opened;
  json["seconds_collect"] = times.collect;
  json["seconds_approximate"] = times.approximate;
  json["seconds_replay"] = times.replay;
  json["seconds"] = secondsSince(start);
  output.finish(json);
  return 0;
}

}  // namespace restroke::cli
