#include "sculpt/cli/dexel_toolpath.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "points/dexel/solid_tool.h"
#include "points/dexel/toolpath/gcode.h"
#include "points/dexel/toolpath/pose_path.h"
#include "points/dexel/toolpath/swept_cutter.h"
#include "sculpt/cli/dexel_output.h"
#include "sculpt/text_file.h"
#include "sculpt/tools_file.h"

namespace restroke::cli {

namespace {

using points::Cutter;
using points::DexelOperation;
using points::OperationId;
using points::TriDexelDocument;
using sculpt::ToolsFile;

// One element, with what moves along it.
struct Move {
  points::PathElement element;
  std::uint32_t cutter = 0;  // in the document
  DexelOperation operation = DexelOperation::Subtraction;
  std::size_t line = 0;  // of the file; 0: not known
};

// What is known of a path before it is applied.
struct Path {
  std::vector<Move> moves;
  std::set<std::uint32_t> tools;  // by their numbers
  nlohmann::ordered_json notes;
};

// What f returns; sentences of InputErrors begin with the file's name, and the line where it is known.
template <class F>
auto inLine(const std::string& file, std::size_t line, const F& f) {
  try {
    return f();
  } catch (const InputError& error) {
    throw InputError(line == 0 ? fmt::format("{}: {}", file, error.what())
                               : fmt::format("{}: line {}: {}", file, line, error.what()));
  }
}

std::optional<DexelOperation> operationNamed(const std::string& mode) {
  if (mode.empty()) return std::nullopt;
  if (mode == "cut") return DexelOperation::Subtraction;
  if (mode == "add") return DexelOperation::Union;
  throw InputError(fmt::format("--mode: \"{}\" must be cut or add with --toolpath", mode));
}

// --tool with --toolpath; without it, the only one that there is.
std::optional<std::uint32_t> toolInHand(const std::string& word, const ToolsFile& tools) {
  if (word.empty()) {
    if (tools.tools.size() != 1) return std::nullopt;
    return tools.tools.begin()->first;
  }
  std::uint32_t number = 0;
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, number);
  if (error != std::errc() || stop != end)
    throw InputError(
        fmt::format("--tool: \"{}\" must be the number of a tool in --tools, as --toolpath is given", word));
  return number;
}

// The document's cutters by their tools' numbers and orientations.
class Cutters {
 public:
  Cutters(TriDexelDocument& document, const ToolsFile& tools) : document_(document), tools_(tools) {}

  // The number that the cutter has, or gets, in the document.
  std::uint32_t numberOf(std::uint32_t tool, const std::array<double, 9>& orientation) {
    const auto [at, isNew] = known_.try_emplace({tool, orientation}, 0);
    if (!isNew) return at->second;
    Cutter cutter = *selectedTool(tools_, tool).cutter;
    cutter.orientation = orientation;
    auto& all = document_.cutters;
    // Those of earlier runs.
    const auto same = std::find(all.begin(), all.end(), cutter);
    at->second = static_cast<std::uint32_t>(same - all.begin());
    if (same == all.end()) all.push_back(cutter);
    return at->second;
  }
  [[nodiscard]] bool adds(std::uint32_t tool) const { return selectedTool(tools_, tool).adds; }

 private:
  TriDexelDocument& document_;
  const ToolsFile& tools_;
  std::map<std::pair<std::uint32_t, std::array<double, 9>>, std::uint32_t> known_;
};

// A path file, and what the options make of its moves.
class PathReader {
 public:
  PathReader(const DexelApplyOptions& options, TriDexelDocument& document)
      : options_(options),
        tools_(sculpt::readToolsFile(options.tools)),
        mode_(operationNamed(options.mode)),
        inHand_(toolInHand(options.tool, tools_)),
        cutters_(document, tools_) {}

  Path read() {
    const std::string contents = sculpt::readTextFile(options_.toolpath);
    Path path;
    points::looksLikePoses(contents) ? readPoses(contents, path) : readGcode(contents, path);
    return path;
  }

 private:
  void add(Path& path, const points::PathElement& element, std::uint32_t tool,
           const std::array<double, 9>& orientation, std::size_t line) {
    Move move{.element = element, .line = line};
    move.cutter = inLine(options_.toolpath, line, [&] { return cutters_.numberOf(tool, orientation); });
    move.operation =
        mode_.value_or(cutters_.adds(tool) ? DexelOperation::Union : DexelOperation::Subtraction);
    path.tools.insert(tool);
    path.moves.push_back(move);
  }

  void readGcode(const std::string& contents, Path& path) {
    const points::GcodeProgram program = points::parseGcode(contents, options_.toolpath, {.tool = inHand_});
    for (const points::GcodeElement& e : program.elements)
      add(path, e.element, e.tool, Cutter{}.orientation, e.line);
    path.notes = {{"format", "gcode"}, {"still", program.still}, {"approaches", program.approaches}};
  }

  void readPoses(const std::string& contents, Path& path) {
    if (!inHand_)
      throw InputError(fmt::format("--tool: must be given, as poses name no tool; {} has the tools {}",
                                   options_.tools, numbersOf(tools_)));
    const auto poses = points::parsePoses(contents, options_.toolpath);
    const points::PosePath steps = named(options_.toolpath, [&] { return points::posePathOf(poses); });
    for (const auto& step : steps.steps)
      add(path, step.element, *inHand_, steps.orientations[step.orientation], 0);
    if (steps.turns > 0)
      Output::note(
          fmt::format("{}: the tool turns between poses {}: it is placed anew there, without a sweep",
                      options_.toolpath, steps.turns == 1 ? "once" : plural(steps.turns, "time")));
    path.notes = {
        {"format", "poses"}, {"poses", poses.size()}, {"still", steps.still}, {"turns", steps.turns}};
  }

  const DexelApplyOptions& options_;
  ToolsFile tools_;
  std::optional<DexelOperation> mode_;
  std::optional<std::uint32_t> inHand_;
  Cutters cutters_;
};

void applyMoves(const std::vector<Move>& moves, const DexelApplyOptions& options,
                TriDexelDocument& document) {
  // So many at a time that threads have enough to do, and few enough for the bar to move.
  constexpr std::size_t kBatch = 256;
  Progress progress("apply", moves.size());
  std::vector<std::unique_ptr<points::SweptCutter>> solids;
  std::vector<points::SolidStep> steps;
  for (std::size_t first = 0; first < moves.size(); first += kBatch) {
    const std::size_t end = std::min(moves.size(), first + kBatch);
    solids.clear();
    steps.clear();
    Box added;
    for (std::size_t i = first; i < end; ++i) {
      const Move& move = moves[i];
      solids.push_back(inLine(options.toolpath, move.line, [&] {
        return std::make_unique<points::SweptCutter>(document.cutters[move.cutter], move.element);
      }));
      document.operations.push_back({move.operation, points::CutterMove{move.cutter, move.element}});
      const auto id = static_cast<OperationId>(static_cast<std::uint32_t>(document.operations.size()));
      steps.push_back({solids.back().get(), move.operation, id});
      if (move.operation == DexelOperation::Union) added.add(solids.back()->bounds());
    }
    document.model.growTo(added);
    apply(document.model, steps, executionOf(options.common));
    progress.update(end);
  }
}

}  // namespace

void checkToolpathOptions(const DexelApplyOptions& options) {
  if (options.toolpath.empty()) {
    if (!options.tools.empty())
      throw InputError("--tools: says what the cutters of a --toolpath are, which is not given");
    if (options.tool.empty())
      throw InputError("--tool: must be given, or --toolpath; --help lists what there is");
    return;
  }
  if (!options.poses.empty()) throw InputError("--poses and --toolpath: one of them must be given, not both");
  if (options.device != "cpu")
    throw InputError("--toolpath: sweeps are intersected with lines, but --device opengl draws meshes");
  if (options.tools.empty())
    throw InputError("--toolpath: --tools must be given too, a file that says what the cutters are");
}

nlohmann::ordered_json applyToolpath(const DexelApplyOptions& options, TriDexelDocument& document) {
  const Path path = PathReader(options, document).read();
  applyMoves(path.moves, options, document);
  nlohmann::ordered_json json{
      {"toolpath", options.toolpath}, {"elements", path.moves.size()}, {"tool_numbers", path.tools}};
  json.update(path.notes);
  return json;
}

}  // namespace restroke::cli
