// What the scaling experiment writes: tables for people and for programs.

#include "experiments/output.h"

#include <fmt/format.h>

#include <algorithm>

#include "experiments/figures.h"
#include "experiments/scaling.h"
#include "experiments/scaling/report.h"

namespace restroke::experiments {
namespace {

Json orNull(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json rowOf(const ScalingRow& row, const ScalingResults& results) {
  const Measured& m = row.measured;
  return {{"sweep", infoOf(row.sweep).name},
          {"source", row.source},
          {"parameter", infoOf(row.sweep).parameter},
          {"value", row.value},
          {"primitives", m.primitives},
          {"bases", m.bases},
          {"strokes", m.strokes},
          {"surfels", m.surfels},
          {"density", m.density},
          {"least_radius", m.leastRadius},
          {"most_radius", m.mostRadius},
          {"met", m.met},
          {"met_most", m.metMost},
          {"stamps_timed", m.timedStamps},
          {"stamp_us_p50", m.stampMedian},
          {"stamp_us_p99", m.stampHigh},
          {"replay_s", m.replay},
          {"bases_s", m.baseSeconds},
          {"undone", m.undone},
          {"undo_ms_p50", m.undoMedian},
          {"undo_ms_p99", m.undoHigh},
          {"rebuild_1_ms", m.rebuildOne},
          {"rebuild_ms", m.rebuild},
          {"rays", m.rays},
          {"ray_hits", m.rayHits},
          {"rays_per_s", m.raysASecond},
          {"rays_per_s_prefix", m.raysPrefixed},
          {"listing_ms", orNull(m.listing)},
          {"picture_ms", orNull(m.picture)},
          {"list_bytes", m.bytes.list},
          {"cluster_bytes", m.bytes.clusters},
          {"surfel_bytes", m.bytes.surfels},
          {"scratch_bytes", m.bytes.scratch},
          {"table_bytes", m.bytes.tables},
          {"bytes_per_primitive", bytesPerPrimitive(m)},
          {"bytes_per_surfel", bytesPerSurfel(m)},
          {"resident_bytes", m.resident},
          {"peak_resident_bytes", m.peakResident},
          {"state_hash", m.stateHash},
          {"simd", results.simd},
          {"threads", results.threads}};
}

Json manifestOf(const ScalingResults& results, const ScalingOptions& options, const Setup& setup,
                const Provenance& p) {
  Json manifest = manifestHead(setup, p);
  manifest["simd"] = results.simd;
  manifest["threads"] = results.threads;
  manifest["options"] = {{"most", options.most},
                         {"surfels", options.surfels},
                         {"crowd", options.crowd},
                         {"spread_primitives", options.spreadPrimitives},
                         {"stamps", options.measure.stamps},
                         {"undos", options.measure.undos},
                         {"patience", options.measure.patience},
                         {"picture", {options.measure.width, options.measure.height}},
                         {"smoke", options.smoke}};
  addInputs(manifest, results.inputs);
  manifest["claims"] = jsonOf(claims(results));
  manifest["notes"] = results.notes;
  return manifest;
}

}  // namespace

std::vector<std::string> writeScaling(const ScalingResults& results, const ScalingOptions& options,
                                      const std::filesystem::path& out) {
  ResultFolder folder(out);
  const Setup setup{.experiment = "scaling", .options = describe(options), .seed = options.seed};
  const Provenance p = provenance();
  const Json rows =
      rowsOf(results.rows, originOf(setup, p), [&](const ScalingRow& row) { return rowOf(row, results); });
  folder.write("results.csv", csvOf(rows));
  folder.write("results.json", rowsText(setup, rows));
  folder.write("manifest.json", manifestOf(results, options, setup, p).dump(1) + "\n");

  ScalingImages images;
  for (const ScalingRow& row : results.rows)
    for (const auto& [image, part] : {std::pair{&row.measured.whole, "whole"}, {&row.measured.part, "part"}})
      if (*image) {
        const std::string name =
            fmt::format("{}-{}-{}.png", infoOf(row.sweep).name, row.measured.primitives, part);
        folder.write(name, **image);
        images.pictures.push_back({row.sweep, part, bytesOfFile(folder.at(name))});
      }
  // The first two sweeps share one figure: both count primitives.
  std::vector<std::string> figures;
  for (const ScalingRow& row : results.rows)
    if (const std::string figure(figureOf(row.sweep)); std::ranges::find(figures, figure) == figures.end())
      figures.push_back(figure);
  if (!figures.empty()) {
    std::vector<std::string> arguments{folder.at("results.csv").string(), out.string()};
    arguments.insert(arguments.end(), figures.begin(), figures.end());
    drawFigure("scaling.py", arguments);
  }
  for (const std::string& figure : figures) {
    const std::string name = fmt::format("scaling-{}", figure);
    folder.note(name + ".png");
    folder.note(name + ".svg");
    images.figures.emplace_back(figure, bytesOfFile(folder.at(name + ".svg")));
  }
  folder.write("report.html", scalingReport(results, images, setup, p));
  return folder.files();
}

}  // namespace restroke::experiments
