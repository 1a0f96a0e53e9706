// The program restroke. Exit 0 done, 2 bad input or usage (one sentence on standard error), 1 our fault.
// The only file that includes CLI11, which takes seconds to compile.

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string_view>

#include "implicit/errors.h"
#include "sculpt/cli/commands.h"
#include "sculpt/shape_text.h"

namespace {

using namespace restroke;
using namespace restroke::cli;

constexpr int kBadInput = 2, kOurFault = 1;

struct AllOptions {
  ImportOptions import;
  ReplayCommandOptions replay;
  RenderCommandOptions render;
  ExportOptions exporting;
  HistoryCommandOptions history;
  RetargetOptions retarget;
  DexelBuildOptions dexelBuild;
  DexelApplyOptions dexelApply;
  DexelInfoOptions dexelInfo;
  DexelRenderOptions dexelRender;
  DexelRefineOptions dexelRefine;
  ExportOptions dexelExport;
};

void addCommon(CLI::App* command, CommonOptions& common) {
  command
      ->add_option("--json", common.json,
                   "also write one JSON object here; - is standard output, and replaces the text")
      ->type_name("FILE");
  command
      ->add_option("--threads", common.threads,
                   "worker threads; 0, the default, takes all; never changes a result")
      ->check(CLI::Range(0, 4096))
      ->type_name("N");
}

constexpr const char* kShapes =
    "sphere (radius 1), sphere:x,y,z,r, KIND:NAME=NUMBER,... (restroke kinds lists them) or a mesh file";

CLI::App* addImport(CLI::App& app, ImportOptions& o) {
  CLI::App* c = app.add_subcommand("import", "make a stroke log of pen strokes or of a stamp list");
  c->add_option("source", o.source, "pen strokes (JSON) or a stamp list")->required();
  c->add_option("--base", o.base, std::string("what is drawn on: ") + kShapes);
  c->add_option("--radius", o.radius,
                "brush radius in model units; default 0.05 of the base's half diagonal");
  c->add_option("--mode", o.mode, "add (default), carve or alternate");
  c->add_option("--tip", o.tip,
                "the brush's tip, in brush radii: ball (default), KIND:NAME=NUMBER,... or a mesh file");
  c->add_option("--trace", o.trace,
                "stamps (default), or sweep: round cones from bend to bend in place of many balls");
  c->add_option("--repair", o.repair, "winding: what to make of a mesh that is no boundary of a solid");
  c->add_option("--density", o.density, "samples per square model unit; default about 100,000 on the base");
  c->add_option("--fill", o.fill,
                "how much of the drawing's shorter side the base's silhouette spans, default 1.25");
  c->add_option("--out", o.out, "log to write")->required();
  addCommon(c, o.common);
  return c;
}

CLI::App* addReplay(CLI::App& app, ReplayCommandOptions& o) {
  CLI::App* c = app.add_subcommand("replay", "evaluate a log, and measure it");
  c->add_option("log", o.log, "stroke log or stamp list")->required();
  c->add_option("--density", o.density, "samples per square model unit, in place of the header's");
  c->add_flag("--check", o.check, "compare with a result made from scratch; exit 1 if they differ");
  c->add_flag("--recompute", o.recompute, "make recorded outcomes anew, and report differences");
  addCommon(c, o.common);
  return c;
}

CLI::App* addRender(CLI::App& app, RenderCommandOptions& o) {
  CLI::App* c = app.add_subcommand("render", "draw the shape at a log's end");
  c->add_option("log", o.log, "stroke log or stamp list")->required();
  c->add_option(
      "--view", o.view,
      "front, back, left, right, top, bottom, three-quarter (default), stroke:N or px,py,pz:vx,vy,vz");
  c->add_option("--size", o.size, "WxH in pixels, default 1280x960");
  c->add_option("--renderer", o.renderer, "cpu (default) or opengl");
  c->add_option("--density", o.density, "samples per square model unit, in place of the header's");
  c->add_option("--png", o.png, "picture to write");
  c->add_option("--exr", o.exr, "picture with layers to write: RGBA, Z, N.X/Y/Z, id.primitive, id.stroke");
  addCommon(c, o.common);
  return c;
}

CLI::App* addExport(CLI::App& app, ExportOptions& o) {
  CLI::App* c = app.add_subcommand("export", "write the shape as a mesh or as points with normals");
  c->footer(
      ".stl, .obj, .amf and .3mf get a mesh, .xyz gets points with normals. .ply gets points (with "
      "--resolution or\n"
      "--cell, or when the source is a mesh file: a mesh). Coordinates are kept, but for --scale.");
  c->add_option(
       "source", o.source,
       "stroke log or stamp list, a mesh file (STL, PLY, OBJ, OFF, 3MF, AMF), whose triangles are kept, or a "
       "tri-dexel, which has the mesh of its lines")
      ->required();
  c->add_option("--out", o.out, "file that ends in .stl, .ply, .xyz, .obj, .amf or .3mf")->required();
  c->add_flag("--ascii", o.ascii, "STL or PLY as text");
  c->add_option("--resolution", o.resolution,
                "of a mesh: cells along the shape's longest side, 1 to 4096, default 128");
  c->add_option("--cell", o.cell, "of a mesh: side of a cell in model units, in place of --resolution");
  c->add_option(
      "--unit", o.unit,
      "mm, cm or m: what a coordinate of 1 means, where the format can say it (not STL, XYZ); default the "
      "log's; of a mesh file mm, whatever it says");
  c->add_option("--scale", o.scale, "factor for all coordinates, default 1");
  c->add_option("--density", o.density, "samples per square model unit, in place of the header's");
  addCommon(c, o.common);
  return c;
}

CLI::App* addHistory(CLI::App& app, HistoryCommandOptions& o) {
  CLI::App* c = app.add_subcommand("history", "show a log's history tree, go through it, and edit it");
  c->footer(
      "show                       the tree; --svg draws it\n"
      "undo, redo, goto N         move the cursor\n"
      "cancel N, restore N        node N contributes nothing, or contributes again; with --branch all that "
      "descends from it too\n"
      "move N --to M              node N and its branch, or with --single N alone, become a child of node M, "
      "ahead of the cursor\n"
      "copy N --to M              the same with a copy\n"
      "base SHAPE                 another base under all strokes\n"
      "transform \"WORDS\"          of the base: \"translate x y z; rotate ax ay az degrees; scale s\"\n"
      "Each but show appends one line to the log.");
  c->add_option("log", o.log, "stroke log")->required();
  c->add_option("action", o.action, "show, undo, redo, goto, cancel, restore, move, copy, base or transform")
      ->required();
  c->add_option("argument", o.argument, "a node's number, a base, or the words of a transform");
  c->add_option("--to", o.to, "of move and copy: the node that it is to follow")->type_name("M");
  c->add_flag("--single", o.single, "of move and copy: the one node; its children go to its parent");
  c->add_flag("--branch", o.branch, "of cancel and restore: all that descends from the node as well");
  c->add_option("--repair", o.repair,
                "of base: winding, what to make of a mesh that is no boundary of a solid");
  c->add_option("--svg", o.svg, "of show: drawing to write")->type_name("FILE");
  addCommon(c, o.common);
  return c;
}

CLI::App* addRetarget(CLI::App& app, RetargetOptions& o) {
  CLI::App* c = app.add_subcommand("retarget", "cast a log's strokes anew, also onto another base");
  c->add_option("log", o.log, "stroke log")->required();
  c->add_option("--base", o.base, std::string("in place of the log's base: ") + kShapes);
  c->add_option("--repair", o.repair, "winding: what to make of a mesh that is no boundary of a solid");
  c->add_option("--transform", o.transform,
                "of the base: \"translate x y z; rotate ax ay az degrees; scale s\", left to right");
  c->add_option("--method", o.method,
                "exact (default), embree, depth, depth-cpu, fixed, nearest, mapped, surface or aligned");
  c->add_flag("--surface-distance", o.surfaceDistance,
              "also measure how far strokes are from the surface (a tree of all surfels for each stroke)");
  c->add_option("--out", o.out, "log to write")->required();
  addCommon(c, o.common);
  return c;
}

constexpr const char* kResultants =
    "merge the history: without operations that decide nothing, and with runs of operations in the lines' "
    "histories; says what that saves";

struct DexelCommands {
  CLI::App *build, *apply, *info, *render, *refine, *exporting;
};

CLI::App* addDexelRefine(CLI::App& group, DexelRefineOptions& o) {
  CLI::App* c = group.add_subcommand(
      "refine", "look closer: new lines in a zone, and on them only the operations that matter there");
  c->footer(
      "all (default)    all operations that meet the zone, found by asking each: exact\n"
      "clusters         the same, found by clusters, which a program that goes on running keeps: exact\n"
      "touching         all that ever changed a line through the zone (of a model built with --history)\n"
      "ends             those at the ends in the zone, on both sides, and what the model's cells know\n"
      "document         the one that last trimmed each end, on an approximation (US 2013/0116983)");
  c->add_option("model", o.model, "tri-dexel")->required();
  c->add_option("--zone", o.zone,
                "box:x,y,z,x,y,z (two corners; with ,qx,qy,qz,qw turned about its middle), sphere:x,y,z,r, "
                "frustum (what --view sees) or frustum:near,far")
      ->required();
  c->add_option("--method", o.method, "see below");
  c->add_option("--resolution", o.resolution, "lines along the zone's longest side, 1 to 8192, default 128");
  c->add_option("--cell", o.cell, "from line to line in model units, in place of --resolution");
  c->add_option("--times", o.times,
                "in their place: the model's own lines in the zone, and so many for each; 1: those alone");
  c->add_option("--direction", o.direction, "x,y,z: one family of lines along it, in place of three");
  c->add_flag("--per-pixel", o.perPixel, "of a frustum: one line a pixel (also without --resolution)");
  c->add_option("--widen", o.widening,
                "of ends and touching: ask so many of the model's cells around, default 1");
  c->add_option("--view", o.view,
                "front, back, left, right, top, bottom, three-quarter (default) or px,py,pz:vx,vy,vz");
  c->add_option("--size", o.size, "WxH in pixels, default 1280x960");
  c->add_option("--zoom", o.zoom, "of a frustum: so many times larger about the picture's middle");
  c->add_option("--samples", o.samples, "of a frustum's picture: rays along each side of a pixel, 1 to 8");
  c->add_option("--device", o.device, "cpu (default) or opengl: where operations are replayed");
  c->add_option(
      "--out", o.out,
      "what was refined: .tridexel (lines along x, y, z), a mesh (.stl, .ply, .obj, .3mf, .amf) or points "
      "(.xyz)");
  c->add_option(
      "--spans", o.spans,
      "a view: the picture shows the spans as rods from there, the new ones, the zone's edges, and the "
      "model's own along --family");
  c->add_option("--family", o.family, "with --spans: x, y, z (default) or all");
  c->add_option("--png", o.png, "picture: of a frustum by its rays, of other zones by the ends");
  addCommon(c, o.common);
  return c;
}

DexelCommands addDexel(CLI::App& app, AllOptions& options) {
  CLI::App* group = app.add_subcommand("dexel", "solids as spans on three families of lines");
  group->require_subcommand(1);

  DexelBuildOptions& b = options.dexelBuild;
  CLI::App* build = group->add_subcommand("build", "make a tri-dexel of a log, a stamp list or a mesh");
  build
      ->add_option("source", b.source,
                   "stroke log, stamp list, mesh file, or CAMotics project, of which the workpiece is taken")
      ->required();
  build->add_option("--resolution", b.resolution, "lines along the longest side, 1 to 8192, default 128");
  build->add_option("--cell", b.cell, "from line to line in model units, in place of --resolution");
  build->add_option("--repair", b.repair, "winding: what to make of a mesh that is no boundary of a solid");
  build->add_option("--device", b.device, "cpu (default), or opengl: a mesh is sampled by drawing it");
  build->add_flag("--history", b.history, "lines keep every operation that changes them, from now on");
  build->add_flag("--resultants", b.resultants, kResultants);
  build->add_option("--out", b.out, "tri-dexel to write")->required();
  addCommon(build, b.common);

  DexelApplyOptions& a = options.dexelApply;
  CLI::App* apply = group->add_subcommand(
      "apply", "cut with a tool, or add it, in one pose after the other or along a path");
  apply->add_option("model", a.model, "tri-dexel")->required();
  apply->add_option(
      "--tool", a.tool,
      std::string("the tool: ") + kShapes + "; with --toolpath the number of a tool in --tools");
  apply->add_option(
      "--poses", a.poses,
      "one pose a line: 16 numbers, a 4 x 4 matrix row by row; without, the tool is where it is");
  apply->add_option("--toolpath", a.toolpath,
                    "G-code, or poses between which the cutter sweeps: each element is an operation");
  apply->add_option("--tools", a.tools, "of --toolpath: what the cutters are, a CAMotics project (JSON)");
  apply->add_option(
      "--mode", a.mode,
      "cut (default; of --toolpath what --tools says), add, or intersect: keep what is within the tool");
  apply->add_option("--device", a.device, "cpu (default), or opengl: a mesh tool is sampled by drawing it");
  apply->add_flag("--resultants", a.resultants, kResultants);
  apply->add_option("--out", a.out, "tri-dexel to write")->required();
  addCommon(apply, a.common);

  CLI::App* info = group->add_subcommand("info", "what a tri-dexel holds");
  info->add_option("model", options.dexelInfo.model, "tri-dexel")->required();
  addCommon(info, options.dexelInfo.common);

  DexelRenderOptions& r = options.dexelRender;
  CLI::App* render =
      group->add_subcommand("render", "draw a tri-dexel: what was cut or added in other colours");
  render->add_option("model", r.model, "tri-dexel")->required();
  render->add_option("--view", r.view,
                     "front, back, left, right, top, bottom, three-quarter (default) or px,py,pz:vx,vy,vz");
  render->add_option("--size", r.size, "WxH in pixels, default 1280x960");
  render->add_option("--renderer", r.renderer, "cpu (default) or opengl");
  render->add_option("--family", r.family, "x, y or z: the ends of one family of lines only; default all");
  render->add_flag("--spans", r.spans, "the spans as rods");
  render->add_option("--png", r.png, "picture to write")->required();
  addCommon(render, r.common);

  CLI::App* refine = addDexelRefine(*group, options.dexelRefine);
  return {build, apply, info, render, refine, addExport(*group, options.dexelExport)};
}

int runProgram(int argc, char** argv) {
  CLI::App app("Restroke: sculpting with strokes that can be replayed on anything.", "restroke");
  app.require_subcommand(1);
  AllOptions options;
  const CLI::App* import = addImport(app, options.import);
  const CLI::App* replay = addReplay(app, options.replay);
  const CLI::App* render = addRender(app, options.render);
  const CLI::App* exporting = addExport(app, options.exporting);
  const CLI::App* history = addHistory(app, options.history);
  const CLI::App* retarget = addRetarget(app, options.retarget);
  const DexelCommands dexel = addDexel(app, options);
  const CLI::App* kinds = app.add_subcommand("kinds", "list the kinds of volume that bases and tips may be");
  // For the list of commands only: main hands its arguments on before anything is parsed.
  app.add_subcommand("experiment",
                     "measure: memory, retarget, scaling, dexel, refine (starts restroke-experiment)");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    throw InputError(fmt::format("{}; --help lists what there is", error.what()));
  }
  if (*import) return runImport(options.import);
  if (*replay) return runReplay(options.replay);
  if (*render) return runRender(options.render);
  if (*exporting) return runExport(options.exporting);
  if (*history) return runHistory(options.history);
  if (*retarget) return runRetarget(options.retarget);
  if (*dexel.build) return runDexelBuild(options.dexelBuild);
  if (*dexel.apply) return runDexelApply(options.dexelApply);
  if (*dexel.info) return runDexelInfo(options.dexelInfo);
  if (*dexel.render) return runDexelRender(options.dexelRender);
  if (*dexel.refine) return runDexelRefine(options.dexelRefine);
  if (*dexel.exporting) return runExport(options.dexelExport);
  if (*kinds) {
    fmt::print("{:<18}a ball about any point; its radius is the base's or the brush's\n{}", "sphere",
               sculpt::describeKinds());
    return 0;
  }
  throw InternalError("a subcommand that does nothing");
}

}  // namespace

int main(int argc, char** argv) {
  // Full files and closed pipes are to be errors of write, so that they get their sentence and temporaries
  // are removed.
  (void)std::signal(SIGXFSZ, SIG_IGN);
  (void)std::signal(SIGPIPE, SIG_IGN);
  try {
    if (argc > 1 && std::string_view(argv[1]) == "experiment") becomeExperiment(argv + 1);
    return runProgram(argc, argv);
  } catch (const InputError& error) {
    fmt::print(stderr, "restroke: {}\n", error.what());
    return kBadInput;
  } catch (const std::bad_alloc&) {
    fmt::print(
        stderr,
        "restroke: the memory of this machine does not suffice, but must hold all samples and strokes\n");
    return kBadInput;
  } catch (const std::exception& error) {
    fmt::print(stderr, "restroke: our fault: {}\n", error.what());
    return kOurFault;
  }
}
