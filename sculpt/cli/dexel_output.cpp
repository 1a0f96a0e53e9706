// What a model says of itself.

#include "sculpt/cli/dexel_output.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include "implicit/simd/dispatch.h"
#include "points/dexel/refine/refine.h"
#include "points/dexel/refine/resultants.h"
#include "points/dexel/span_rods.h"
#include "sculpt/cli/replaying.h"

namespace restroke::cli {

namespace {

using points::TriDexel;
using points::TriDexelDocument;

// [[least x, y, z], [greatest x, y, z]]; null for an empty solid.
nlohmann::ordered_json boundsOf(const TriDexel& model) {
  const Box box = model.bounds();
  if (box.empty()) return nullptr;
  return {{box.min.x, box.min.y, box.min.z}, {box.max.x, box.max.y, box.max.z}};
}

std::string entriesIn(std::size_t count) {
  return fmt::format("{} {}", grouped(count), count == 1 ? "entry" : "entries");
}

}  // namespace

void checkDevice(const std::string& device) {
  if (device != "cpu" && device != "opengl")
    throw InputError(fmt::format("--device: \"{}\" must be cpu or opengl", device));
}

std::optional<int> familyNamed(const std::string& family) {
  if (family == "all") return std::nullopt;
  const std::size_t axis = std::string_view("xyz").find(family);
  if (family.size() != 1 || axis == std::string_view::npos)
    throw InputError(fmt::format("--family: \"{}\" must be x, y, z or all", family));
  return static_cast<int>(axis);
}

void appendRods(const TriDexel& model, std::optional<int> family, std::vector<points::Surfel>& out) {
  for (int axis = 0; axis < 3; ++axis)
    if (!family || *family == axis)
      appendRods(model.family(axis), points::familyOf({.grid = model.grid()}, axis),
                 {.radius = static_cast<float>(0.16 * model.grid().cell())}, out);
}

nlohmann::ordered_json mergedIf(bool isWanted, TriDexelDocument& document, const Output& output,
                                const Execution& execution) {
  if (!isWanted) return nlohmann::ordered_json::object();
  points::Resultants merged = points::resultantsOf(std::move(document), {}, execution);
  document = std::move(merged.document);
  const points::ResultantReport& r = merged.report;
  output.say(fmt::format(
      "merged: {} of {} stay; dropped: {} without effect, {} hidden, {} covered\n"
      "operations: {} bytes, {} before\n",
      grouped(r.operationsAfter), plural(r.operationsBefore, "operation"), grouped(r.withoutEffect),
      grouped(r.hidden), grouped(r.covered), grouped(r.documentBytesAfter), grouped(r.documentBytesBefore)));
  if (document.model.keepsHistory())
    output.say(fmt::format("histories: {} and {} bytes, {} and {} before; {} of {} together\n",
                           entriesIn(r.historyEntriesAfter), grouped(r.historyBytesAfter),
                           entriesIn(r.historyEntriesBefore), grouped(r.historyBytesBefore),
                           plural(r.runs, "run"), plural(r.operationsInRuns, "operation")));
  nlohmann::ordered_json json;
  json["resultants"] = {{"operations_before", r.operationsBefore},
                        {"operations_after", r.operationsAfter},
                        {"without_effect", r.withoutEffect},
                        {"hidden", r.hidden},
                        {"covered", r.covered},
                        {"referred", r.referred},
                        {"runs", r.runs},
                        {"operations_in_runs", r.operationsInRuns},
                        {"document_bytes_before", r.documentBytesBefore},
                        {"document_bytes_after", r.documentBytesAfter},
                        {"history_entries_before", r.historyEntriesBefore},
                        {"history_entries_after", r.historyEntriesAfter},
                        {"history_bytes_before", r.historyBytesBefore},
                        {"history_bytes_after", r.historyBytesAfter}};
  return json;
}

void report(Output& output, const DexelReport& report, const nlohmann::ordered_json& more) {
  const TriDexelDocument& document = report.document;
  const TriDexel& model = document.model;
  const std::size_t lines = model.grid().lineCount(), ends = model.endCount(), bytes = model.bytes();
  std::error_code error;
  const std::uintmax_t fileBytes = std::filesystem::file_size(report.file, error);
  const char* const initial = std::holds_alternative<std::monostate>(document.initial) ? "none"
                              : std::holds_alternative<TriangleMesh>(document.initial) ? "mesh"
                                                                                       : "primitives";
  const points::GridCounts& n = model.grid().counts();
  std::string kept;
  nlohmann::ordered_json history = nullptr;
  if (model.keepsHistory()) {
    const TriDexel::HistorySize size = model.historySize();
    kept = fmt::format("histories of lines: {}, {} bytes, {}\n", entriesIn(size.entries), grouped(size.bytes),
                       plural(document.runs.size(), "run"));
    history = {{"entries", size.entries}, {"bytes", size.bytes}, {"runs", document.runs.size()}};
  }
  const std::string cutters =
      document.cutters.empty() ? "" : ", " + plural(document.cutters.size(), "cutter");
  output.say(
      fmt::format("{}: {} x {} x {} lines {:.4g} apart ({}), {} span ends; volume {:.6g}\n"
                  "initial solid: {}; {}{}, {}\n{}"
                  "memory {} bytes, {:.1f} a line, {:.1f} an end; file {} bytes; {:.3f} s\n",
                  report.file, n[0], n[1], n[2], model.grid().cell(), plural(lines, "line"), grouped(ends),
                  model.volume(), initial, plural(document.tools.size(), "tool mesh"), cutters,
                  plural(document.operations.size(), "operation"), kept, grouped(bytes),
                  static_cast<double>(bytes) / static_cast<double>(lines),
                  ends == 0 ? 0.0 : static_cast<double>(bytes) / static_cast<double>(ends),
                  grouped(fileBytes), report.seconds));
  nlohmann::ordered_json json{{"file", report.file},
                              {"counts", {n[0], n[1], n[2]}},
                              {"cell", model.grid().cell()},
                              {"lines", lines},
                              {"ends", ends},
                              {"bounds", boundsOf(model)},
                              {"volume", model.volume()},
                              {"volumes", {model.volumeOf(0), model.volumeOf(1), model.volumeOf(2)}},
                              {"initial", initial},
                              {"tools", document.tools.size()},
                              {"cutters", document.cutters.size()},
                              {"operations", document.operations.size()},
                              {"history", history},
                              {"state_hash", hexHash(model.stateHash())},
                              {"simd", implicit::simdLevelName()},
                              {"model_bytes", bytes},
                              {"file_bytes", fileBytes}};
  json.update(more);
  json["seconds"] = report.seconds;
  output.finish(json);
}

}  // namespace restroke::cli
