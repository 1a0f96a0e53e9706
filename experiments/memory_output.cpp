// What the memory experiment writes: tables for people and for programs.

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "experiments/figures.h"
#include "experiments/memory.h"
#include "experiments/provenance.h"
#include "experiments/report.h"
#include "experiments/text.h"
#include "implicit/atomic_file.h"
#include "implicit/errors.h"

namespace restroke::experiments {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// What one line of results.csv and one object of results.json say: the same, under the same names.
Json rowOf(const MemoryLog& log, const MemoryStep& step, const MemoryRow& row) {
  return {{"log", log.name},
          {"step", step.step},
          {"command", step.command},
          {"backend", row.backend},
          {"title", row.title},
          {"measured", row.measured},
          {"bytes", row.bytes},
          {"state_bytes", row.stateBytes},
          {"stamps", step.stamps},
          {"primitives", step.primitives},
          {"surfels", step.surfels},
          {"undo_in_order", row.abilities.undoInOrder},
          {"undo_anywhere", row.abilities.undoAnywhere},
          {"branch", row.abilities.branch},
          {"retarget", row.abilities.retarget},
          {"density", log.density},
          {"input_hash", log.hash}};
}

Json originOf(const Provenance& p, const MemoryOptions& options) {
  return {{"revision", p.revision},
          {"dirty", p.dirty},
          {"compiler", p.compiler},
          {"options_hash", hexHash(describe(options))},
          {"seed", options.seed}};
}

std::string csvOf(const Json& rows) {
  std::string text;
  if (rows.empty()) return text;
  const auto line = [&](auto field) {
    std::string out;
    for (const auto& item : rows.front().items()) {
      if (!out.empty()) out += ',';
      out += field(item.key());
    }
    text += out;
    text += '\n';
  };
  line([](const std::string& key) { return csvField(key); });
  for (const Json& row : rows)
    line([&](const std::string& key) {
      const Json& value = row[key];
      return csvField(value.is_string() ? value.get<std::string>() : value.dump());
    });
  return text;
}

std::string dumpLines(const Json& object) {
  return object.dump(1) + "\n";
}

/// Rows, one a line: short for programs, and a difference between two files shows which row it is in.
std::string rowsText(const Json& rows) {
  std::string text = "{\"experiment\": \"memory\", \"rows\": [\n";
  for (std::size_t i = 0; i < rows.size(); ++i) text += rows[i].dump() + (i + 1 < rows.size() ? ",\n" : "\n");
  return text + "]}\n";
}

Json manifestOf(const std::vector<MemoryLog>& logs, const MemoryOptions& options, const Provenance& p) {
  Json manifest = {{"experiment", "memory"}};
  manifest.update(originOf(p, options));
  manifest["flags"] = p.flags;
  manifest["cpu"] = p.cpu;
  manifest["processors"] = p.processors;
  manifest["system"] = p.system;
  manifest["options"] = {{"density", options.density},
                         {"walk_steps", options.walkSteps},
                         {"pictures", options.pictures},
                         {"picture_size", options.pictureSize}};
  manifest["hash"] = "XXH3, 64 bit";
  manifest["inputs"] = Json::array();
  for (const MemoryLog& log : logs)
    manifest["inputs"].push_back({{"log", log.name},
                                  {"file", log.file.filename().string()},
                                  {"hash", log.hash},
                                  {"strokes", log.strokes},
                                  {"stamps", log.stamps},
                                  {"density", log.density},
                                  {"walked", log.walked}});
  return manifest;
}

std::string yesNo(bool able) {
  return able ? "yes" : "-";
}

std::string pictureName(const MemoryLog& log, const MemoryPicture& picture) {
  return fmt::format("{}-step-{:03}.png", log.name, picture.step);
}

constexpr std::size_t kTextRows = 16;

}  // namespace

std::string memoryTable(const MemoryLog& log) {
  std::string text =
      fmt::format("{}: {} strokes, {} stamps, {} surfels at density {}\n\n", log.name, log.strokes,
                  grouped(log.stamps), grouped(log.steps.back().surfels), log.density);
  std::vector<std::vector<std::string>> lines;
  std::vector<std::string> head = {"step", "stamps"};
  for (const MemoryRow& row : log.steps.front().rows) head.push_back(row.backend);
  lines.push_back(head);
  for (const std::size_t i : thinned(log.steps.size(), kTextRows)) {
    const MemoryStep& step = log.steps[i];
    std::vector<std::string> line = {std::to_string(step.step), grouped(step.stamps)};
    for (const MemoryRow& row : step.rows) line.push_back(grouped(row.bytes));
    lines.push_back(std::move(line));
  }
  text += alignedTable(lines) + "\n";

  lines = {{"back end", "undo in order", "undo anywhere", "branch", "retarget", ""}};
  for (const MemoryRow& row : log.steps.back().rows) {
    if (!row.measured) continue;
    lines.push_back({row.backend, yesNo(row.abilities.undoInOrder), yesNo(row.abilities.undoAnywhere),
                     yesNo(row.abilities.branch), yesNo(row.abilities.retarget), row.title});
  }
  text += alignedTable(lines, 6);
  if (log.walked > 0)
    text += fmt::format(
        "\nEvery back end was walked {} steps back and forth at random and restored each state bit for "
        "bit.\n",
        log.walked);
  return text;
}

void makeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder))
    throw InputError(fmt::format("{}: cannot be made a folder ({}); --out names the folder for the results",
                                 folder.string(), error ? error.message() : "a file is in its place"));
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    throw InputError(
        fmt::format("{}: nothing can be written there ({}); --out names the folder for the results",
                    folder.string(), std::strerror(errno)));
}

std::vector<std::string> writeMemory(const std::vector<MemoryLog>& logs, const MemoryOptions& options,
                                     const fs::path& out) {
  makeFolder(out);
  std::vector<std::string> files;
  const auto write = [&](const std::string& name, const std::string& bytes) {
    writeFileAtomically(out / name, std::string_view(bytes));
    files.push_back(name);
  };

  const Provenance origin = provenance();
  Json rows = Json::array();
  for (const MemoryLog& log : logs)
    for (const MemoryStep& step : log.steps)
      for (const MemoryRow& row : step.rows) {
        Json line = rowOf(log, step, row);
        line.update(originOf(origin, options));
        rows.push_back(std::move(line));
      }
  write("results.csv", csvOf(rows));
  write("results.json", rowsText(rows));
  write("manifest.json", dumpLines(manifestOf(logs, options, origin)));
  for (const MemoryLog& log : logs)
    for (const MemoryPicture& picture : log.pictures) {
      files.push_back(pictureName(log, picture));
      points::writePng(out / files.back(), picture.image);
    }

  // The paper's figure is drawn from its own strokes where they are among the logs, else from the first log.
  const auto paper = std::ranges::find_if(logs, &MemoryLog::paperTable2);
  const MemoryLog& first = paper != logs.end() ? *paper : logs.front();
  std::vector<std::string> prefixes;
  for (const MemoryLog& log : logs) {
    prefixes.push_back(&log == &first ? std::string("figure12") : "figure12-" + log.name);
    if (log.steps.size() < 2) continue;
    drawFigure("figure12.py", {(out / "results.csv").string(), log.name, (out / prefixes.back()).string()});
    for (const char* ending : {"-linear.png", "-linear.svg", "-log.png", "-log.svg"})
      files.push_back(prefixes.back() + ending);
  }
  std::vector<LogImages> images;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    LogImages& of = images.emplace_back();
    for (const MemoryPicture& picture : logs[i].pictures)
      of.pngs.push_back(bytesOfFile(out / pictureName(logs[i], picture)));
    if (logs[i].steps.size() < 2) continue;
    of.linearSvg = bytesOfFile(out / (prefixes[i] + "-linear.svg"));
    of.logarithmicSvg = bytesOfFile(out / (prefixes[i] + "-log.svg"));
  }
  write(
      "report.html",
      memoryReport(logs, images, {.options = describe(options), .hash = hexHash(describe(options))}, origin));
  return files;
}

}  // namespace restroke::experiments
