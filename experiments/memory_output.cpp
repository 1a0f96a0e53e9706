// What the memory experiment writes: tables for people and for programs.

#include <fmt/format.h>

#include <algorithm>

#include "experiments/figures.h"
#include "experiments/memory.h"
#include "experiments/output.h"
#include "experiments/report.h"
#include "experiments/text.h"

namespace restroke::experiments {
namespace {

namespace fs = std::filesystem;

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

Setup setupOf(const MemoryOptions& options) {
  return {.experiment = "memory", .options = describe(options), .seed = options.seed};
}

Json manifestOf(const std::vector<MemoryLog>& logs, const MemoryOptions& options, const Provenance& p) {
  Json manifest = manifestHead(setupOf(options), p);
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

std::vector<std::string> writeMemory(const std::vector<MemoryLog>& logs, const MemoryOptions& options,
                                     const fs::path& out) {
  ResultFolder folder(out);
  const Setup setup = setupOf(options);
  const Provenance origin = provenance();
  Json rows = Json::array();
  for (const MemoryLog& log : logs)
    for (const MemoryStep& step : log.steps)
      for (const MemoryRow& row : step.rows) {
        Json line = rowOf(log, step, row);
        line.update(originOf(setup, origin));
        rows.push_back(std::move(line));
      }
  folder.write("results.csv", csvOf(rows));
  folder.write("results.json", rowsText(setup, rows));
  folder.write("manifest.json", manifestOf(logs, options, origin).dump(1) + "\n");
  for (const MemoryLog& log : logs)
    for (const MemoryPicture& picture : log.pictures) folder.write(pictureName(log, picture), picture.image);

  // The paper's figure is drawn from its own strokes where they are among the logs, else from the first log.
  const auto paper = std::ranges::find_if(logs, &MemoryLog::paperTable2);
  const MemoryLog& first = paper != logs.end() ? *paper : logs.front();
  std::vector<std::string> prefixes;
  for (const MemoryLog& log : logs) {
    prefixes.push_back(&log == &first ? std::string("figure12") : "figure12-" + log.name);
    if (log.steps.size() < 2) continue;
    drawFigure("figure12.py",
               {folder.at("results.csv").string(), log.name, folder.at(prefixes.back()).string()});
    for (const char* ending : {"-linear.png", "-linear.svg", "-log.png", "-log.svg"})
      folder.note(prefixes.back() + ending);
  }
  std::vector<LogImages> images;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    LogImages& of = images.emplace_back();
    for (const MemoryPicture& picture : logs[i].pictures)
      of.pngs.push_back(bytesOfFile(folder.at(pictureName(logs[i], picture))));
    if (logs[i].steps.size() < 2) continue;
    of.linearSvg = bytesOfFile(folder.at(prefixes[i] + "-linear.svg"));
    of.logarithmicSvg = bytesOfFile(folder.at(prefixes[i] + "-log.svg"));
  }
  folder.write("report.html", memoryReport(logs, images, setup, origin));
  return folder.files();
}

}  // namespace restroke::experiments
