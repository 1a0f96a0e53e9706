// restroke-experiment: the experiments as a program. Exit 0 done, 2 bad input or usage, 1 our fault.

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <memory>
#include <nlohmann/json.hpp>

#include "experiments/dexel.h"
#include "experiments/dexel/report.h"
#include "experiments/examples/example_logs.h"
#include "experiments/memory.h"
#include "experiments/output.h"
#include "experiments/refine.h"
#include "experiments/refine/report.h"
#include "experiments/refine/summary.h"
#include "experiments/retarget.h"
#include "experiments/retarget/report.h"
#include "experiments/retarget/summary.h"
#include "experiments/scaling.h"
#include "experiments/scaling/report.h"
#include "experiments/shipped.h"
#include "implicit/atomic_file.h"
#include "implicit/errors.h"
#include "sculpt/stroke_log.h"

namespace {

namespace fs = std::filesystem;
using namespace restroke;
using namespace restroke::experiments;

/// What every command understands.
struct Common {
  std::string json;
  Execution execution;
  std::unique_ptr<AtomicFile> jsonFile;

  void addTo(CLI::App& app) {
    app.add_option("--json", json,
                   "also write one JSON object here; - is standard output, and replaces the text");
    app.add_option("--threads", execution.threads,
                   "worker threads; 0, the default, takes all; never changes a result")
        ->check(CLI::Range(0, 4096));
  }
  /// A JSON file that cannot be written stops the work before it begins.
  void begin() {
    if (!json.empty() && json != "-") jsonFile = std::make_unique<AtomicFile>(json);
  }
  void say(const std::string& text) const {
    if (json != "-") fmt::print("{}", text);
  }
  /// Call it last.
  void finish(const nlohmann::ordered_json& object) {
    const std::string text = object.dump(2) + "\n";
    if (json == "-") fmt::print("{}", text);
    if (jsonFile) {
      jsonFile->write(std::string_view(text));
      jsonFile->commit();
    }
  }
};

/// A line on a terminal that says how far a log is, once it has taken a second; nothing when redirected.
class ProgressLine {
 public:
  explicit ProgressLine(std::string name) : name_(std::move(name)), terminal_(isatty(STDERR_FILENO) != 0) {}
  ~ProgressLine() {
    if (shown_) fmt::print(stderr, "\r\033[K");
  }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  void operator()(std::size_t done, std::size_t all) { (*this)("step", done, all); }
  void operator()(const std::string& what, std::size_t done, std::size_t all) {
    if (!terminal_ || std::chrono::steady_clock::now() - begun_ < std::chrono::seconds(1)) return;
    fmt::print(stderr, "\r{}: {} {} of {}\033[K", name_, what, done, all);
    std::fflush(stderr);
    shown_ = true;
  }

 private:
  std::string name_;
  bool terminal_, shown_ = false;
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

struct MemoryCommand {
  Common common;
  std::vector<std::string> logs;
  std::string out;
  bool smoke = false;
  MemoryOptions options;

  void addTo(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("memory", "what undo costs in memory, for every way of keeping history");
    command->add_option("logs", logs,
                        "stroke logs or stamp lists; without any, the shipped log of the paper's Table 2");
    command
        ->add_option("--out", out,
                     "folder for results.csv, results.json, manifest.json, figures, report.html")
        ->required();
    command->add_flag("--smoke", smoke, "a small size that takes seconds");
    command->add_option("--density", options.density,
                        "samples per square model unit, in place of the logs' own");
    command->add_option("--seed", options.seed, "of the walk that checks every history");
    common.addTo(*command);
    command->callback([this] { run(); });
  }

  void run() {
    if (!(options.density >= 0))
      throw InputError(fmt::format("--density: {}; it must be positive", options.density));
    std::vector<fs::path> files(logs.begin(), logs.end());
    if (files.empty()) files.push_back(shippedFile("examples/table2.log"));
    const MemoryOptions sized = smoke ? smokeSize(options) : options;
    // What is wrong with an input or an output is said before the work begins, and leaves nothing behind.
    for (const fs::path& file : files) (void)sculpt::readLog(file);
    common.begin();
    makeFolder(out);
    std::vector<MemoryLog> measured;
    for (const fs::path& file : files) {
      ProgressLine line(file.filename().string());
      measured.push_back(measureMemory(file, sized, common.execution,
                                       [&line](std::size_t done, std::size_t all) { line(done, all); }));
    }
    makeNamesUnique(measured);
    const std::vector<std::string> written = writeMemory(measured, sized, out);

    nlohmann::ordered_json object = {
        {"experiment", "memory"}, {"out", out}, {"smoke", smoke}, {"files", written}};
    object["logs"] = nlohmann::ordered_json::array();
    for (const MemoryLog& log : measured) {
      common.say(memoryTable(log) + "\n");
      nlohmann::ordered_json bytes;
      for (const MemoryRow& row : log.steps.back().rows) bytes[row.backend] = row.bytes;
      object["logs"].push_back({{"log", log.name},
                                {"steps", log.steps.size() - 1},
                                {"strokes", log.strokes},
                                {"stamps", log.stamps},
                                {"surfels", log.steps.back().surfels},
                                {"density", log.density},
                                {"bytes", bytes}});
    }
    common.say(fmt::format("report: {}\n", (fs::path(out) / "report.html").string()));
    common.finish(object);
  }
};

struct RetargetCommand {
  Common common;
  std::vector<std::string> logs;
  std::string out;
  bool smoke = false, noOpenGl = false;
  RetargetOptions options;

  void addTo(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "retarget", "how well each method puts strokes back where they belong on a changed base");
    command->add_option(
        "logs", logs,
        "stroke logs; without any, pen strokes on bases of several kinds: the shipped ones, and "
        "strokes and meshes of ../shared/data where they are there");
    command
        ->add_option("--out", out,
                     "folder for results.csv, results.json, trials.csv, edits.csv, manifest.json, figures, "
                     "pictures, report.html")
        ->required();
    command->add_flag("--smoke", smoke, "a small size that takes seconds");
    command->add_option("--strokes", options.strokes, "strokes on each base, default 16; 0 takes all")
        ->type_name("N");
    command->add_option("--samples", options.samples, "surfels of a base, default 15,000")
        ->check(CLI::Range(500, 1'000'000))
        ->type_name("N");
    command->add_flag("--no-opengl", noOpenGl, "leave out the method depth, which draws with OpenGL");
    command->add_option("--seed", options.seed, "of directions, axes and alignments");
    common.addTo(*command);
    command->callback([this] { run(); });
  }

  void run() {
    options.openGl = !noOpenGl;
    const RetargetOptions sized = smoke ? smokeSize(options) : options;
    const RetargetInput input = defaultInput({logs.begin(), logs.end()});
    // What is wrong with an input or an output is said before the work begins, and leaves nothing behind.
    for (const fs::path& file : input.logs) (void)sculpt::readLog(file);
    common.begin();
    makeFolder(out);
    RetargetResults results;
    {
      ProgressLine line("retarget");
      results = measureRetarget(
          input, sized, common.execution,
          [&line](const std::string& what, std::size_t done, std::size_t all) { line(what, done, all); });
    }
    const std::vector<std::string> written = writeRetarget(results, sized, out);

    common.say(retargetTable(results) + "\n");
    for (const std::string& sentence : adviceOf(results)) common.say(sentence + "\n");
    nlohmann::ordered_json object = {
        {"experiment", "retarget"}, {"out", out}, {"smoke", smoke}, {"files", written}};
    object["bases"] = results.subjects.size();
    object["cases"] = results.cases.size();
    object["trials"] = results.trials.size();
    object["advice"] = adviceOf(results);
    object["claims"] = jsonOf(claims(results));
    object["notes"] = results.notes;
    common.say(fmt::format("report: {}\n", (fs::path(out) / "report.html").string()));
    common.finish(object);
  }
};

struct ScalingCommand {
  Common common;
  std::vector<std::string> logs;
  std::string out;
  bool smoke = false;
  std::size_t mostSurfels = 100'000'000;
  std::vector<std::string> sweeps;
  ScalingOptions options;

  void addTo(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("scaling", "how the cost of stamps, undo, rays and pictures grows");
    command->add_option("logs", logs,
                        "stroke logs or stamp lists that are sampled ever more densely; without any, the "
                        "shipped list of the paper's size");
    command
        ->add_option("--out", out,
                     "folder for results.csv, results.json, manifest.json, figures, pictures, report.html")
        ->required();
    command->add_flag("--smoke", smoke, "a small size that takes seconds");
    command
        ->add_option("--most", options.most,
                     "primitives of the largest list, default 1,000,000; where memory allows 10,000,000")
        ->check(CLI::Range(1000, 100'000'000))
        ->type_name("N");
    command->add_option("--most-surfels", mostSurfels, "surfels of the densest sampling, default 100,000,000")
        ->check(CLI::Range(10'000, 1'000'000'000))
        ->type_name("N");
    command->add_option("--sweep", sweeps, "only this one; may be given several times; default all")
        ->check(CLI::IsMember({"extent", "detail", "surfels", "crowding", "spread"}))
        ->type_name("NAME");
    command->add_option("--seed", options.seed, "of strokes and rays");
    common.addTo(*command);
    command->callback([this] { run(); });
  }

  void run() {
    if (!sweeps.empty())
      std::erase_if(options.sweeps, [this](Sweep sweep) {
        return std::ranges::find(sweeps, infoOf(sweep).name) == sweeps.end();
      });
    std::erase_if(options.surfels, [this](std::size_t n) { return n > mostSurfels; });
    const ScalingOptions sized = smoke ? smokeSize(options) : options;
    std::vector<fs::path> files(logs.begin(), logs.end());
    if (files.empty()) files = defaultScalingLogs();
    // What is wrong with an input or an output is said before the work begins, and leaves nothing behind.
    for (const fs::path& file : files) (void)listLayout(file);
    common.begin();
    makeFolder(out);
    ScalingResults results;
    {
      ProgressLine line("scaling");
      results = measureScaling(
          files, sized, common.execution,
          [&line](const std::string& what, std::size_t done, std::size_t all) { line(what, done, all); });
    }
    const std::vector<std::string> written = writeScaling(results, sized, out);

    common.say(scalingTable(results));
    nlohmann::ordered_json object = {
        {"experiment", "scaling"}, {"out", out}, {"smoke", smoke}, {"files", written}};
    object["rows"] = results.rows.size();
    object["claims"] = jsonOf(claims(results));
    object["notes"] = results.notes;
    common.say(fmt::format("report: {}\n", (fs::path(out) / "report.html").string()));
    common.finish(object);
  }
};

struct DexelCommand {
  Common common;
  std::vector<std::string> logs;
  std::string out;
  bool smoke = false;
  int most = 256;
  DexelOptions options;

  void addTo(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "dexel", "memory and error of voxels, of one family of dexels and of three, by resolution");
    command->add_option("logs", logs,
                        "stroke logs or stamp lists, whose solids are measured besides a ball; without any, "
                        "shipped ones");
    command
        ->add_option("--out", out,
                     "folder for results.csv, results.json, manifest.json, figures, pictures, report.html")
        ->required();
    command->add_flag("--smoke", smoke, "a small size that takes seconds");
    command->add_option("--most", most, "lines along the longest side at the finest resolution, default 256")
        ->check(CLI::Range(kLeastDexelResolution, kMostDexelResolution))
        ->type_name("N");
    command
        ->add_option("--points", options.points, "random points whose sides are compared, default 1,000,000")
        ->check(CLI::Range(1, 1'000'000'000))
        ->type_name("N");
    command->add_option("--seed", options.seed, "of the random points");
    common.addTo(*command);
    command->callback([this] { run(); });
  }

  void run() {
    options.resolutions.clear();
    for (int n = std::min(16, most); n <= most; n *= 2) options.resolutions.push_back(n);
    const DexelOptions sized = smoke ? smokeSize(options) : options;
    std::vector<fs::path> files(logs.begin(), logs.end());
    if (files.empty()) files = defaultDexelLogs(smoke);
    // What is wrong with an input or an output is said before the work begins, and leaves nothing behind.
    for (const fs::path& file : files) (void)sculpt::readLog(file);
    common.begin();
    makeFolder(out);
    DexelResults results;
    {
      ProgressLine line("dexel");
      results = measureDexels(
          files, sized, common.execution,
          [&line](const std::string& what, std::size_t done, std::size_t all) { line(what, done, all); });
    }
    const std::vector<std::string> written = writeDexels(results, sized, out);

    common.say(dexelTable(results));
    nlohmann::ordered_json object = {
        {"experiment", "dexel"}, {"out", out}, {"smoke", smoke}, {"files", written}};
    object["rows"] = results.rows.size();
    object["claims"] = jsonOf(claims(results));
    common.say(fmt::format("report: {}\n", (fs::path(out) / "report.html").string()));
    common.finish(object);
  }
};

struct RefineCommand {
  Common common;
  std::vector<std::string> logs;
  std::string out;
  bool smoke = false;
  std::size_t most = 1'000'000;
  RefinementOptions options;

  void addTo(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "refine", "what refining dexels by the operations at their ends misses, and what it saves");
    command->add_option("logs", logs,
                        "stroke logs or stamp lists, whose first primitive is the initial solid, measured "
                        "besides made histories; without any, shipped ones");
    command
        ->add_option("--out", out,
                     "folder for results.csv, results.json, times.csv, times.json, manifest.json, figures, "
                     "pictures, report.html")
        ->required();
    command->add_flag("--smoke", smoke, "a small size that takes seconds");
    command->add_option("--most", most, "operations of the longest history that is timed, default 1,000,000")
        ->check(CLI::Range(std::size_t{1000}, kMostGrowth))
        ->type_name("N");
    command
        ->add_option("--lines", options.loss.fineLines,
                     "new lines along the zone's side, in each of three families, default 128")
        ->check(CLI::Range(8, 2048))
        ->type_name("N");
    command->add_option("--places", options.loss.places, "zones of each size in each model, default 4")
        ->check(CLI::Range(1, 1000))
        ->type_name("N");
    command->add_option("--seed", options.seed, "of histories and zones");
    common.addTo(*command);
    command->callback([this] { run(); });
  }

  void run() {
    options.growth.fineLines = options.loss.fineLines;
    options.growth.operations = growthUpTo(most);
    const RefinementOptions sized = smoke ? smokeSize(options) : options;
    std::vector<fs::path> files(logs.begin(), logs.end());
    if (files.empty()) files = defaultRefinementLogs(smoke);
    // What is wrong with an input or an output is said before the work begins, and leaves nothing behind.
    for (const fs::path& file : files) (void)sculpt::readLog(file);
    common.begin();
    makeFolder(out);
    RefinementResults results;
    {
      ProgressLine line("refine");
      results = measureRefinement(
          files, sized, common.execution,
          [&line](const std::string& what, std::size_t done, std::size_t all) { line(what, done, all); });
    }
    const std::vector<std::string> written = writeRefinement(results, sized, out);

    common.say(refinementTable(results));
    nlohmann::ordered_json object = {
        {"experiment", "refine"}, {"out", out}, {"smoke", smoke}, {"files", written}};
    object["rows"] = results.losses.size();
    object["times"] = results.growths.size();
    object["claims"] = jsonOf(claims(results));
    object["notes"] = results.notes;
    common.say(fmt::format("report: {}\n", (fs::path(out) / "report.html").string()));
    common.finish(object);
  }
};

struct ExampleCommand {
  Common common;
  std::string name, out;

  void addTo(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("example", "makes one of the example logs that ship with the project");
    command->add_option("name", name, "table2, paper-scale, rabbit, figure10 or gallery")->required();
    command->add_option("--out", out, "the log to write")->required();
    common.addTo(*command);
    command->callback([this] { run(); });
  }

  void run() {
    common.begin();
    const sculpt::StrokeLog log = exampleLog(name);
    sculpt::writeLog(out, log);
    common.say(fmt::format("{}: {} commands\n", out, log.commands.size()));
    common.finish({{"example", name}, {"out", out}, {"commands", log.commands.size()}});
  }
};

int runProgram(int argc, char** argv) {
  CLI::App app("Experiments on sculpting with strokes that can be replayed.", "restroke-experiment");
  app.require_subcommand(1);
  MemoryCommand memory;
  RetargetCommand retarget;
  ScalingCommand scaling;
  DexelCommand dexel;
  RefineCommand refine;
  ExampleCommand example;
  memory.addTo(app);
  retarget.addTo(app);
  scaling.addTo(app);
  dexel.addTo(app);
  refine.addTo(app);
  example.addTo(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::CallForAllHelp& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "restroke-experiment: {}; --help lists what there is\n", error.what());
    return 2;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return runProgram(argc, argv);
  } catch (const InputError& error) {
    fmt::print(stderr, "restroke-experiment: {}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "restroke-experiment: our fault: {}\n", error.what());
    return 1;
  }
}
