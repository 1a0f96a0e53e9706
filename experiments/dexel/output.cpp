// What the dexel experiment writes: tables for people and for programs.

#include "experiments/output.h"

#include <fmt/format.h>

#include "experiments/dexel.h"
#include "experiments/dexel/report.h"
#include "experiments/dexel/slice.h"
#include "experiments/figures.h"

namespace restroke::experiments {
namespace {

// As coarse as the paper's figure, whose points one can count.
constexpr int kSliceResolution = 14;

template <class T>
Json orNull(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

void add(Json& row, const std::string& name, const Distances& distances, double cell) {
  for (const auto& [part, value] :
       {std::pair{"mean", distances.mean}, {"p99", distances.high}, {"max", distances.most}}) {
    row[fmt::format("{}_{}", name, part)] = value;
    row[fmt::format("{}_{}_cells", name, part)] = value / cell;
  }
}

Json rowOf(const DexelRow& row, const DexelOptions& options) {
  const DexelMeasured& m = row.measured;
  const bool isOne = m.representation == Representation::OneFamily;
  Json json = {{"source", row.source},
               {"primitives", row.primitives},
               {"representation", infoOf(m.representation).name},
               {"axis", isOne ? "z" : ""},
               {"resolution", row.resolution},
               {"points_x", m.counts[0]},
               {"points_y", m.counts[1]},
               {"points_z", m.counts[2]},
               {"cell", m.cell},
               {"lines", m.lines},
               {"elements", m.elements},
               {"bytes", m.bytes},
               {"bytes_without_operations", orNull(m.bytesWithoutOperations)},
               {"bytes_per_line", orNull(bytesPerLine(m))},
               {"bytes_per_end", orNull(bytesPerEnd(m))},
               {"random_points", options.points},
               {"wrong_points", m.wrongPoints},
               {"wrong_volume", m.wrongVolume},
               {"surface_samples", row.samples}};
  add(json, "coverage", m.coverage, m.cell);
  add(json, "accuracy", m.accuracy, m.cell);
  return json;
}

Json manifestOf(const DexelResults& results, const DexelOptions& options, const Setup& setup,
                const Provenance& p) {
  Json manifest = manifestHead(setup, p);
  manifest["options"] = {
      {"resolutions", options.resolutions},         {"points", options.points},
      {"samples_per_cell", options.samplesPerCell}, {"picture_resolution", options.pictureResolution},
      {"picture_size", options.pictureSize},        {"smoke", options.smoke}};
  addInputs(manifest, results.inputs);
  manifest["claims"] = jsonOf(claims(results));
  return manifest;
}

}  // namespace

std::vector<std::string> writeDexels(const DexelResults& results, const DexelOptions& options,
                                     const std::filesystem::path& out) {
  ResultFolder folder(out);
  const Setup setup{.experiment = "dexel", .options = describe(options), .seed = options.seed};
  const Provenance p = provenance();
  const Json rows =
      rowsOf(results.rows, originOf(setup, p), [&](const DexelRow& row) { return rowOf(row, options); });
  folder.write("results.csv", csvOf(rows));
  folder.write("results.json", rowsText(setup, rows));
  folder.write("manifest.json", manifestOf(results, options, setup, p).dump(1) + "\n");
  folder.write("figure1.csv", sliceTable(kSliceResolution));

  const auto drawn = [&](const std::string& name) {
    folder.note(name + ".png");
    folder.note(name + ".svg");
    return bytesOfFile(folder.at(name + ".svg"));
  };
  DexelImages images;
  drawFigure("figure1.py", {folder.at("figure1.csv").string(), folder.at("figure1").string()});
  images.figure1 = drawn("figure1");
  const std::vector<std::string> sources = sourcesOf(results);
  std::vector<std::string> arguments{folder.at("results.csv").string(), out.string()};
  arguments.insert(arguments.end(), sources.begin(), sources.end());
  drawFigure("dexel.py", arguments);
  for (const std::string& source : sources)
    images.figures.emplace_back(source, drawn(fmt::format("dexel-{}", source)));
  for (const DexelPicture& picture : results.pictures) {
    const RepresentationInfo& info = infoOf(picture.representation);
    const std::string name = fmt::format("{}-{}-{}.png", picture.source, picture.resolution, info.name);
    folder.write(name, picture.image);
    images.pictures.push_back(
        {picture.source,
         fmt::format("{}, n = {}: each element a disc as large as a cell", info.title, picture.resolution),
         bytesOfFile(folder.at(name))});
  }
  folder.write("report.html", dexelReport(results, images, setup, p));
  return folder.files();
}

}  // namespace restroke::experiments
