#pragma once
// The subcommands of the program restroke: options in, work done. main.cpp makes the options from the command
// line; whatever goes wrong is thrown (InputError: exit 2).

#include <optional>
#include <string>

namespace restroke::cli {

/// What every subcommand understands.
struct CommonOptions {
  std::string
      json;  ///< file for one JSON object, "-" for standard output (instead of the text), empty for none
  int threads = 0;  ///< 0 takes all
};

struct ImportOptions {
  CommonOptions common;
  std::string source;  ///< pen strokes (JSON) or a stamp list
  std::optional<std::string> base, mode, tip, trace;
  std::string repair;
  std::optional<float> radius, density, fill;
  std::string out;
};

struct ReplayCommandOptions {
  CommonOptions common;
  std::string log;
  std::optional<float> density;
  bool check = false;
  bool recompute = false;
};

struct RenderCommandOptions {
  CommonOptions common;
  std::string log;
  std::string view = "three-quarter";
  std::string size = "1280x960";
  std::string renderer = "cpu";
  std::optional<float> density;
  std::string png, exr;
};

struct ExportOptions {
  CommonOptions common;
  std::string source;  ///< log, stamp list or mesh file
  std::optional<float> density;
  bool ascii = false;
  std::optional<int> resolution;    ///< of a mesh; at most one of the two
  std::optional<double> cell;       ///< of a mesh, in model units
  std::optional<std::string> unit;  ///< in place of the log's
  double scale = 1;
  std::string out;  ///< its ending says what is written
};

struct HistoryCommandOptions {
  CommonOptions common;
  std::string log;
  std::string action;
  std::string argument;  ///< a node's number, a base, or the words of a transform
  std::string to;        ///< of move and copy: a node's number
  bool single = false;   ///< of move and copy: the one node
  bool branch = false;   ///< of cancel and restore: all that descends from it as well
  std::string repair;    ///< of base
  std::string svg;       ///< of show
};

struct RetargetOptions {
  CommonOptions common;
  std::string log;
  std::string base, transform, repair;
  std::string method = "exact";
  bool surfaceDistance = false;  ///< measure it: a tree of all surfels for each stroke
  std::string out;
};

struct DexelBuildOptions {
  CommonOptions common;
  std::string source;  ///< log, stamp list, mesh file or CAMotics project
  std::optional<int> resolution;
  std::optional<double> cell;
  std::string repair;
  std::string device = "cpu";  ///< or opengl
  bool history = false;        ///< lines keep every operation that changed them
  bool resultants = false;     ///< the history is merged
  std::string out;
};

struct DexelApplyOptions {
  CommonOptions common;
  std::string model;
  std::string tool;      ///< a mesh file, or a shape in words; with a tool path the number of a tool
  std::string poses;     ///< file of poses; empty: the tool as it is
  std::string toolpath;  ///< G-code or poses between which a cutter sweeps; empty: none
  std::string tools;     ///< of a tool path: what its cutters are
  std::string mode;      ///< empty: cut, or what the tools file says
  std::string device = "cpu";
  bool resultants = false;  ///< the history is merged
  std::string out;
};

struct DexelInfoOptions {
  CommonOptions common;
  std::string model;
};

struct DexelRenderOptions {
  CommonOptions common;
  std::string model;
  std::string view = "three-quarter";
  std::string size = "1280x960";
  std::string renderer = "cpu";
  std::string family = "all";  ///< or x, y, z
  bool spans = false;          ///< as rods
  std::string png;
};

struct DexelRefineOptions {
  CommonOptions common;
  std::string model;
  std::string zone;
  std::string method = "all";
  std::optional<int> resolution, times;
  std::optional<double> cell;
  std::string direction;  ///< "x,y,z"; empty: three families
  bool perPixel = false;
  double widening = 1;
  std::string view = "three-quarter";
  std::string size = "1280x960";
  double zoom = 1;
  int samples = 1;  ///< rays across a pixel
  std::string device = "cpu";
  std::string out, png;
  std::string spans;         ///< view of a picture of the spans as rods; empty: none
  std::string family = "z";  ///< of the model's own spans in it
};

/// Each returns the exit status: 0, or 1 where a check found a difference.
int runImport(const ImportOptions& options);
int runReplay(const ReplayCommandOptions& options);
int runRender(const RenderCommandOptions& options);
int runExport(const ExportOptions& options);
int runHistory(const HistoryCommandOptions& options);
int runRetarget(const RetargetOptions& options);
int runDexelBuild(const DexelBuildOptions& options);
int runDexelApply(const DexelApplyOptions& options);
int runDexelInfo(const DexelInfoOptions& options);
int runDexelRender(const DexelRenderOptions& options);
int runDexelRefine(const DexelRefineOptions& options);

/// Becomes the program restroke-experiment that lies beside this one, with the arguments behind "experiment".
/// Returns only by throwing InputError when there is none.
[[noreturn]] void becomeExperiment(char** arguments);

}  // namespace restroke::cli
