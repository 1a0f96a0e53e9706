// What the refine experiment writes: tables for people and for programs.

#include "experiments/output.h"

#include <fmt/format.h>

#include <algorithm>

#include "experiments/figures.h"
#include "experiments/refine.h"
#include "experiments/refine/report.h"
#include "experiments/refine/summary.h"

namespace restroke::experiments {
namespace {

template <class T>
Json orNull(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json cellsOf(const std::optional<double>& distance, double cell) {
  return distance ? Json(*distance / cell) : Json(nullptr);
}

Json rowOf(const LossRow& row) {
  const Differences& d = row.differences;
  return {{"sweep", infoOf(row.sweep).name},
          {"value", row.value},
          {"history", row.history},
          {"dense_mixed", row.denseMixed},
          {"operations", row.operations},
          {"additions", row.additions},
          {"resolution", row.resolution},
          {"cell", row.cell},
          {"fine_cell", row.fineCell},
          {"part", row.part},
          {"place", row.place},
          {"model_bytes", row.modelBytes},
          {"line_history_bytes", row.lineHistoryBytes},
          {"ids_in_zone", row.ids},
          {"method", row.method},
          {"replayed", row.collected},
          {"reference_length", row.length},
          {"reference_ends", row.ends},
          {"trimming", row.recall.trimming},
          {"trimming_missed", row.recall.trimmingMissed},
          {"sides", row.recall.sides},
          {"sides_missed", row.recall.sidesMissed},
          {"ends_missed", row.recall.endsMissed},
          {"missing", d.missing},
          {"extra", d.extra},
          {"wrong", orNull(row.wrong())},
          {"wrong_volume", orNull(row.wrongVolume())},
          {"farthest_lost", orNull(d.toJudged)},
          {"farthest_lost_cells", cellsOf(d.toJudged, row.cell)},
          {"farthest_added", orNull(d.toReference)},
          {"farthest_added_cells", cellsOf(d.toReference, row.cell)},
          {"identical", d.identical}};
}

Json rowOf(const GrowthRow& row) {
  return {{"growth", nameOf(row.growth)},
          {"operations", row.operations},
          {"method", row.method},
          {"seconds", row.seconds.median},
          {"seconds_p25", row.seconds.low},
          {"seconds_p75", row.seconds.high},
          {"collect", row.collect},
          {"approximate", row.approximate},
          {"replay", row.replay},
          {"repeats", row.repeats},
          {"scale", row.scale},
          {"by_ends", row.byEnds.median},
          {"by_ends_p25", row.byEnds.low},
          {"by_ends_p75", row.byEnds.high},
          {"replayed", row.collected},
          {"identical", row.identical},
          {"wrong", orNull(row.wrong)},
          {"sides", row.sides},
          {"sides_missed", row.sidesMissed},
          {"ids_in_zone", row.ids},
          {"ends_in_zone", row.endsInZone},
          {"model_bytes", row.modelBytes},
          {"history_model_bytes", orNull(row.historyModelBytes)},
          {"step_bytes", row.historyBytes},
          {"model_seconds", row.modelSeconds},
          {"history_model_seconds", orNull(row.historyModelSeconds)},
          {"step_seconds", row.historySeconds},
          {"cluster_seconds", row.clusterSeconds}};
}

Json manifestOf(const RefinementResults& results, const RefinementOptions& options, const Setup& setup,
                const Provenance& p) {
  Json manifest = manifestHead(setup, p);
  const LossOptions& loss = options.loss;
  const GrowthOptions& growth = options.growth;
  manifest["options"] = {{"resolutions", loss.resolutions},
                         {"operations", loss.operations},
                         {"fine_lines", loss.fineLines},
                         {"places", loss.places},
                         {"part", loss.part},
                         {"parts", loss.parts},
                         {"growth", growth.operations},
                         {"growth_resolution", growth.resolution},
                         {"growth_fine_lines", growth.fineLines},
                         {"repeats", growth.repeats},
                         {"picture_size", options.pictureSize},
                         {"smoke", options.smoke}};
  addInputs(manifest, results.inputs);
  manifest["claims"] = jsonOf(claims(results));
  manifest["notes"] = results.notes;
  return manifest;
}

/// The figures there is something to draw for.
std::vector<std::string> figuresFor(const RefinementResults& results) {
  std::vector<std::string> names;
  for (const LossSweep sweep : kLossSweeps)
    if (std::ranges::any_of(results.losses, [&](const LossRow& row) { return row.sweep == sweep; }))
      names.emplace_back(infoOf(sweep).name);
  if (!results.growths.empty()) names.emplace_back("time");
  return names;
}

}  // namespace

std::vector<std::string> writeRefinement(const RefinementResults& results, const RefinementOptions& options,
                                         const std::filesystem::path& out) {
  ResultFolder folder(out);
  const Setup setup{.experiment = "refine", .options = describe(options), .seed = options.seed};
  const Provenance p = provenance();
  const Json losses =
      rowsOf(results.losses, originOf(setup, p), [](const LossRow& row) { return rowOf(row); });
  const Json times =
      rowsOf(results.growths, originOf(setup, p), [](const GrowthRow& row) { return rowOf(row); });
  folder.write("results.csv", csvOf(losses));
  folder.write("results.json", rowsText(setup, losses));
  folder.write("times.csv", csvOf(times));
  folder.write("times.json", rowsText(setup, times));
  folder.write("manifest.json", manifestOf(results, options, setup, p).dump(1) + "\n");

  RefinementImages images;
  const std::vector<std::string> names = figuresFor(results);
  std::vector<std::string> arguments{folder.at("results.csv").string(), folder.at("times.csv").string(),
                                     out.string()};
  arguments.insert(arguments.end(), names.begin(), names.end());
  drawFigure("refine.py", arguments);
  for (const std::string& name : names) {
    folder.note(fmt::format("refine-{}.png", name));
    folder.note(fmt::format("refine-{}.svg", name));
    images.figures.emplace_back(name, bytesOfFile(folder.at(fmt::format("refine-{}.svg", name))));
  }
  for (const LossPicture& picture : results.pictures) {
    const std::string name = fmt::format("lost-{}-{}.png", picture.slug, picture.method),
                      slice = fmt::format("lost-{}-{}-slice.png", picture.slug, picture.method);
    folder.write(name, picture.surface);
    folder.write(slice, picture.slice);
    images.pictures.push_back({picture.history,
                               picture.method == "all"
                                   ? "all: the model"
                                   : fmt::format("{}: {:.3g} % wrong", picture.method, 100 * picture.wrong),
                               bytesOfFile(folder.at(name)), bytesOfFile(folder.at(slice))});
  }
  folder.write("report.html", refinementReport(results, images, setup, p));
  return folder.files();
}

}  // namespace restroke::experiments
