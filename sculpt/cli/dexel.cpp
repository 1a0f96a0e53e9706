// restroke dexel build, info, render: tri-dexels of logs and meshes, what they hold, what they look like.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "implicit/atomic_file.h"
#include "implicit/errors.h"
#include "points/dexel/dexel_surfels.h"
#include "points/dexel/gl/gl_tri_dexel.h"
#include "points/dexel/mesh_dexels.h"
#include "points/dexel/tridexel_file.h"
#include "points/files/mesh_files.h"
#include "points/images/cpu_renderer.h"
#include "points/images/gl_renderer.h"
#include "points/images/png.h"
#include "sculpt/cli/commands.h"
#include "sculpt/cli/dexel_output.h"
#include "sculpt/cli/replaying.h"
#include "sculpt/cli/sources.h"
#include "sculpt/cli/words.h"
#include "sculpt/tools_file.h"

namespace restroke::cli {

namespace {

using Clock = std::chrono::steady_clock;
using points::OperationId;
using points::TriDexel;
using points::TriDexelDocument;

// What was noticed about a mesh's lines, for the report.
struct MeshNotes {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  std::string text;
};

void refuseOddLines(const points::GlTriDexel& model, const std::string& file) {
  const points::OddLines odd = model.oddLines();
  if (odd.count == 0) return;
  const points::OddLines::Place& first = odd.first.front();
  const int u = (first.family + 1) % 3, v = (first.family + 2) % 3;
  throw InputError(
      fmt::format("{}: {} pass through the mesh an odd number of times, the first along {} at {} = {:.6g}, "
                  "{} = {:.6g}; the "
                  "mesh must be closed, or --repair winding be given",
                  file, plural(odd.count, "line"), "xyz"[first.family], "xyz"[u],
                  static_cast<double>(model.grid().at(u, first.column)), "xyz"[v],
                  static_cast<double>(model.grid().at(v, first.row))));
}

// The same model by drawing the mesh. What it is compared with, and where it differs: gl_tri_dexel.h.
TriDexel drawn(const TriangleMesh& solid, const points::DexelGrid& grid, const std::string& file) {
  const points::GlDexelContext context;
  points::GlTriDexel model(context, grid);
  model.peel(points::GlMesh(context, solid));
  refuseOddLines(model, file);
  return model.download();
}

TriDexelDocument ofMesh(const DexelBuildOptions& o, const TriangleMesh& mesh, MeshNotes& notes) {
  const Execution execution = executionOf(o.common);
  const auto repair = repairNamed(o.repair) == sculpt::Repair::Winding ? points::MeshRepair::Winding
                                                                       : points::MeshRepair::None;
  const points::MeshModelOptions options{.lines = {.resolution = o.resolution, .cell = o.cell},
                                         .repair = repair};
  points::MeshModel made = named(o.source, [&] { return points::meshModelOf(mesh, options, execution); });
  if (made.repaired != points::Repaired::Way::None)
    Output::note(fmt::format("{}: {}: {}", o.source, describe(made.faults),
                             made.repaired == points::Repaired::Way::TurnedAround
                                 ? "the mesh was turned around"
                                 : "the mesh was made anew where its winding number is at least 1/2"));
  if (const std::size_t count = made.lines.overlapping.count(); count != 0)
    Output::note(fmt::format("{}: surfaces overlap on {}; what two of them share counts as outside", o.source,
                             describe(made.lines.overlapping)));
  notes.json["repaired"] = made.repaired != points::Repaired::Way::None;
  notes.json["overlapping_lines"] = made.lines.overlapping.count();
  TriDexelDocument document;
  document.initial = std::move(made.solid);
  document.model = o.device == "opengl"
                       ? drawn(std::get<TriangleMesh>(document.initial), made.model.grid(), o.source)
                       : std::move(made.model);
  if (o.history) document.model.startHistory();
  return document;
}

// The base is the initial solid, and each stamp an operation (SPEC X1: one log drives every back end).
TriDexelDocument ofLog(const DexelBuildOptions& o) {
  if (!o.repair.empty()) throw InputError(fmt::format("{}: is a log, but --repair is of meshes", o.source));
  if (o.device != "cpu")
    throw InputError(
        fmt::format("{}: is a log, whose lines are exact, but --device opengl draws meshes", o.source));
  const Execution execution = executionOf(o.common);
  const sculpt::StrokeLog log = readLogNoting(o.source);
  const sculpt::Document replayed = replayNoting(log, {.file = o.source}, execution);
  const implicit::PrimitiveList& list = replayed.model().list();
  const points::DexelGrid grid = named(o.source, [&] {
    return points::dexelGridFor(list.bounds(), {.resolution = o.resolution, .cell = o.cell});
  });
  TriDexelDocument document;
  document.initial = std::vector{list.at(0)};
  for (std::size_t i = 1; i < list.size(); ++i) {
    const implicit::Primitive primitive = list.at(i);
    document.operations.push_back({primitive.sign == implicit::Sign::Positive
                                       ? points::DexelOperation::Union
                                       : points::DexelOperation::Subtraction,
                                   primitive.shape});
  }
  document.model = triDexelOf(list, grid, {.lines = {.history = o.history}}, execution);
  return document;
}

}  // namespace

int runDexelBuild(const DexelBuildOptions& options) {
  const auto start = Clock::now();
  checkDevice(options.device);
  Output output(options.common);
  const SourceKind kind = sourceKindOf(options.source);
  if (kind == SourceKind::TriDexel)
    throw InputError(
        fmt::format("{}: is a tri-dexel, but a log, a stamp list or a mesh must be given", options.source));
  MeshNotes notes;
  TriDexelDocument document =
      kind == SourceKind::Mesh      ? ofMesh(options, points::readMesh(options.source), notes)
      : kind == SourceKind::Project ? ofMesh(options, stockOf(sculpt::readToolsFile(options.source)), notes)
                                    : ofLog(options);
  notes.json.update(mergedIf(options.resultants, document, output, executionOf(options.common)));
  points::writeTriDexel(options.out, document);
  report(output, {options.out, document, std::chrono::duration<double>(Clock::now() - start).count()},
         notes.json);
  return 0;
}

int runDexelInfo(const DexelInfoOptions& options) {
  const auto start = Clock::now();
  Output output(options.common);
  const TriDexelDocument document = points::readTriDexel(options.model);
  report(output, {options.model, document, std::chrono::duration<double>(Clock::now() - start).count()},
         nlohmann::ordered_json::object());
  return 0;
}

int runDexelRender(const DexelRenderOptions& options) {
  if (options.renderer != "cpu" && options.renderer != "opengl")
    throw InputError(fmt::format("--renderer: \"{}\" must be cpu or opengl", options.renderer));
  const std::optional<int> family = familyNamed(options.family);
  const auto [width, height] = sizeNamed(options.size);
  const Execution execution = executionOf(options.common);
  Output output(options.common);
  AtomicFile png(options.png);
  const TriDexelDocument document = points::readTriDexel(options.model);
  std::vector<points::Surfel> surfels;
  if (options.spans)
    appendRods(document.model, family, surfels);
  else
    surfels = surfelsOf(document.model, {.family = family}, execution);
  // All families together are framed alike, whichever is drawn.
  const implicit::Sphere bounds =
      framed(family || options.spans ? surfelsOf(document.model, {}, execution) : surfels);
  const Camera camera =
      viewNamed(options.view, {.log = {}, .bounds = bounds, .width = width, .height = height});
  const points::Scene scene{.surfels = surfels};
  if (options.renderer == "opengl") {
    points::GlRenderer renderer;
    points::writePng(png.temporary(), points::toDisplay(renderer.renderColor(scene, camera)));
  } else {
    points::writePng(png.temporary(), points::render(scene, camera, {}, execution));
  }
  png.commit();
  output.say(
      fmt::format("{} x {} pixels, {}: {}\n", width, height, plural(surfels.size(), "surfel"), options.png));
  output.finish({{"width", width}, {"height", height}, {"surfels", surfels.size()}, {"png", options.png}});
  return 0;
}

}  // namespace restroke::cli
