// What the retargeting experiment writes: tables for people and for programs.

#include "experiments/output.h"

#include <fmt/format.h>

#include <cmath>

#include "experiments/figures.h"
#include "experiments/retarget.h"
#include "experiments/retarget/report.h"
#include "experiments/retarget/summary.h"

namespace restroke::experiments {
namespace {

/// JSON and CSV have no word for infinite.
Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json rowOf(const RetargetSummary& s) {
  return {{"base", s.base},
          {"change", infoOf(s.kind).name},
          {"strength", s.strength},
          {"unit", infoOf(s.kind).unit},
          {"method", retarget::nameOf(s.method)},
          {"trials", s.trials},
          {"median_rms", finite(s.medianRms)},
          {"p95_rms", finite(s.highRms)},
          {"worst", finite(s.worst)},
          {"followed", s.followed},
          {"lost", s.lost},
          {"surface", s.surface},
          {"stretch", finite(s.stretch)},
          {"fell_back", s.fellBack},
          {"exact_image", s.exactImage},
          {"chord_error", s.chordError}};
}

Json rowOf(const RetargetTrial& t, const RetargetResults& results) {
  const RetargetCase& of = results.cases[t.changeCase];
  return {{"base", results.subjects[of.subject].name},
          {"change", infoOf(of.kind).name},
          {"strength", of.strength},
          {"stroke", t.stroke},
          {"source", t.source},
          {"method", retarget::nameOf(t.method)},
          {"verdict", of.verdict},
          {"fell_back", t.fellBack},
          {"places", t.places},
          {"length", t.length},
          {"rms", finite(t.rms)},
          {"worst", finite(t.worst)},
          {"lost", t.lost},
          {"surface", t.surface},
          {"stretch", finite(t.stretch)},
          {"exact_image", of.exactImage},
          {"chord_error", of.chordError}};
}

Json rowOf(const RetargetEdit& e) {
  return {{"log", e.log},
          {"edit", e.edit},
          {"kind", e.kind},
          {"stroke", e.stroke},
          {"method", retarget::nameOf(e.method)},
          {"fell_back", e.fellBack},
          {"places", e.places},
          {"lost", e.lost},
          {"surface", finite(e.surface)},
          {"drift", finite(e.drift)},
          {"stretch", finite(e.stretch)}};
}

Json rowOf(const EditSummary& s) {
  return {{"log", s.log},
          {"kind", s.kind},
          {"method", retarget::nameOf(s.method)},
          {"strokes", s.strokes},
          {"surface", finite(s.surface)},
          {"drift", finite(s.drift)},
          {"stretch", finite(s.stretch)},
          {"lost", s.lost},
          {"fell_back", s.fellBack}};
}

Json manifestOf(const RetargetResults& results, const RetargetOptions& options, const Setup& setup,
                const Provenance& p) {
  Json manifest = manifestHead(setup, p);
  manifest["options"] = {{"strokes", options.strokes},
                         {"samples", options.samples},
                         {"alignment_points", options.alignmentPoints},
                         {"patch_strokes", options.patchStrokes},
                         {"edge", options.edge},
                         {"triangles", options.triangles},
                         {"log_strokes", options.logStrokes},
                         {"picture_size", options.pictureSize},
                         {"opengl", options.openGl},
                         {"smoke", options.smoke}};
  addInputs(manifest, results.inputs);
  manifest["methods"] = Json::array();
  for (const retarget::Method method : results.methods)
    manifest["methods"].push_back(retarget::nameOf(method));
  manifest["bases"] = Json::array();
  for (const RetargetSubject& s : results.subjects)
    manifest["bases"].push_back({{"base", s.name},
                                 {"tells_motion", s.tellsMotion},
                                 {"size", s.size},
                                 {"strokes", s.strokes},
                                 {"beside", s.beside},
                                 {"surfels", s.surfels}});
  manifest["verdicts"] = Json::array();
  for (const RetargetCase& c : results.cases)
    manifest["verdicts"].push_back({{"base", results.subjects[c.subject].name},
                                    {"change", infoOf(c.kind).name},
                                    {"strength", c.strength},
                                    {"verdict", c.verdict}});
  manifest["notes"] = results.notes;
  return manifest;
}

std::string pictureName(const RetargetPictures& row, std::size_t i) {
  std::string word = row.pictures[i].first;
  word = word.substr(0, word.find(':'));
  return fmt::format("{}-{}.png", row.name, word);
}

}  // namespace

std::vector<std::string> writeRetarget(const RetargetResults& results, const RetargetOptions& options,
                                       const std::filesystem::path& out) {
  ResultFolder folder(out);
  const Setup setup{.experiment = "retarget", .options = describe(options), .seed = options.seed};
  const Provenance p = provenance();
  const Json origin = originOf(setup, p);
  const Json rows = rowsOf(summaries(results), origin, [](const RetargetSummary& s) { return rowOf(s); });
  folder.write("results.csv", csvOf(rows));
  folder.write("results.json", rowsText(setup, rows));
  folder.write("trials.csv", csvOf(rowsOf(results.trials, origin,
                                          [&](const RetargetTrial& t) { return rowOf(t, results); })));
  folder.write("edits.csv",
               csvOf(rowsOf(results.edits, origin, [](const RetargetEdit& e) { return rowOf(e); })));
  folder.write("edits.json", rowsText(setup, rowsOf(editSummaries(results), origin,
                                                    [](const EditSummary& s) { return rowOf(s); })));
  folder.write("manifest.json", manifestOf(results, options, setup, p).dump(1) + "\n");

  ReportImages images;
  for (const RetargetPictures& row : results.pictures) {
    auto& pngs = images.rows.emplace_back();
    for (std::size_t i = 0; i < row.pictures.size(); ++i) {
      folder.write(pictureName(row, i), row.pictures[i].second);
      pngs.push_back(bytesOfFile(folder.at(pictureName(row, i))));
    }
  }
  for (const auto& [group, name] :
       {std::pair{kTelling, "errors-telling"}, {kSymmetric, "errors-symmetric"}}) {
    bool any = false;
    for (const RetargetSubject& s : results.subjects) any = any || s.tellsMotion == (group == kTelling);
    if (!any) continue;
    drawFigure("retarget_errors.py", {folder.at("results.csv").string(), group, folder.at(name).string()});
    for (const char* ending : {".png", ".svg"}) folder.note(std::string(name) + ending);
    (group == kTelling ? images.tellingSvg : images.symmetricSvg) =
        bytesOfFile(folder.at(std::string(name) + ".svg"));
  }
  folder.write("report.html", retargetReport(results, images, setup, p));
  return folder.files();
}

}  // namespace restroke::experiments
