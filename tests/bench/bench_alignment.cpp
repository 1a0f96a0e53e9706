// How well and how fast retarget/alignment.h finds motions: tables for retarget/README.md.
//
//   bench_alignment [--whole|--patch] [--trials N] [--each] [NAME...]     meshes of data/meshes/closed, all
//   without a name; N trials for each
//                                                                         of four motions; --each prints
//                                                                         every trial
//   bench_alignment --smoke                                               plain shapes only
//
// Hypothesis: on shapes that determine the motion, a stroke carried by the estimated motion errs by less than
// 0.2 % of its length (median); with only a patch kept, and the rest deformed, at least nine of ten err by
// less than 1 %. Both sides are drawn independently. Shapes with symmetries are refused.
// Seconds are those of the processor, on one thread.

#include <fmt/format.h>

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>

#include "points/files/mesh_files.h"
#include "tests/support/alignment_trials.h"

namespace restroke::testing {
namespace {

using retarget::Alignment;
using retarget::AlignmentMode;
using retarget::AlignmentVerdict;
using retarget::OrientedPoint;

struct Row {
  std::vector<double> errors;  // of those found, per cent of the stroke
  std::vector<double> seconds, firmness, rivals, rms;
  std::array<int, 4> verdicts{};

  void add(const Alignment& a, double error, double time) {
    ++verdicts[static_cast<std::size_t>(a.verdict)];
    if (a.verdict == AlignmentVerdict::Found) errors.push_back(100 * error);

    seconds.push_back(time);
    firmness.push_back(a.firmness);
    rivals.push_back(a.rivalRatio);
    rms.push_back(a.relativeRms);
  }
};

double quantile(std::vector<double> values, double part) {
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1,
                         static_cast<std::size_t>(part * static_cast<double>(values.size())))];
}

void print(const std::string& name, const Row& row) {
  const auto within = std::count_if(row.errors.begin(), row.errors.end(), [](double e) { return e <= 1; });
  fmt::print(
      "| {} | {} | {} | {} | {} | {} | {} | {:.3f} | {:.3f} | {:.2e} | {:.2e} | {:.2f} | {:.2f} | {:.1e} | "
      "{:.2f} |\n",
      name, row.seconds.size(), row.verdicts[0], row.verdicts[1], row.verdicts[2], row.verdicts[3], within,
      quantile(row.errors, 0.5), quantile(row.errors, 0.95), quantile(row.firmness, 0),
      quantile(row.firmness, 0.5), quantile(row.rivals, 0), quantile(row.rivals, 0.5), quantile(row.rms, 0.5),
      quantile(row.seconds, 0.5));
  std::fflush(stdout);
}

enum class Printing : std::uint8_t { Tables, EachTrial };

struct Setting {
  AlignmentMode mode = AlignmentMode::Whole;
  int trials = 4;
  Printing printing = Printing::Tables;
};

void measure(const std::string& name, const SurfaceSampler& surface, const Setting& setting, Row& total) {
  const Extent extent = extentOf(surface.mesh());
  const double size = extent.size;
  const std::vector<OrientedPoint> dense = surface.draw(20000, 99);
  Row row;
  Random random{7};
  std::uint32_t seed = 1000;
  for (const TrialMotion kind : {TrialMotion::Shift, TrialMotion::Turn, TrialMotion::Scale, TrialMotion::All})
    for (int trial = 0; trial < setting.trials; ++trial) {
      const bool isWhole = setting.mode == AlignmentMode::Whole;
      const Similarity truth = trialMotion(kind, extent, random);
      const std::vector<Point> stroke = strokeOn(
          dense, size * static_cast<double>(isWhole ? random.between(0.3f, 1) : random.between(0.3f, 0.6f)),
          random);
      std::vector<OrientedPoint> before = surface.draw(isWhole ? 20000 : 60000, ++seed);
      std::vector<OrientedPoint> after = surface.draw(isWhole ? 15000 : 45000, ++seed);
      if (!isWhole) {
        const double radius = size * static_cast<double>(random.between(0.25f, 0.35f));
        const Point middle = stroke[stroke.size() / 2];
        before = retarget::patchAround(before, std::array{middle}, radius);
        Deformation deform{.center = DVec3(middle),
                           .axis = normalized(DVec3(random.inCube(1))),
                           .radius = radius,
                           .fade = 0.3 * size};
        after = deformedPoints(deform, after);
      }
      after = movedPoints(truth, after);
      const std::clock_t start = std::clock();
      const Alignment a = retarget::alignSurfels(before, after, {.mode = setting.mode});
      const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
      const double error = strokeError(stroke, a.motion, truth);
      if (setting.printing == Printing::EachTrial)
        fmt::print("   {} kind {} before {} error {:.4f} % rms {:.2e} firm {:.2e} rival {:.3f} {}: {}\n",
                   name, static_cast<int>(kind), before.size(), 100 * error, a.relativeRms, a.firmness,
                   a.rivalRatio, nameOf(a.verdict), a.reason);
      row.add(a, error, seconds);
      total.add(a, error, seconds);
    }
  print(name, row);
}

/// Shapes that do not determine the motion: what is said of them.
void measurePlain(PlainShape shape, const Setting& setting) {
  Row row;
  Random random{7};
  std::uint32_t seed = 1000;
  for (int trial = 0; trial < 4 * setting.trials; ++trial) {
    const bool isWhole = setting.mode == AlignmentMode::Whole;
    const Similarity truth = trialMotion(TrialMotion::All, {}, random);
    std::vector<OrientedPoint> before = drawPlain(shape, isWhole ? 20000 : 60000, ++seed);
    const std::vector<OrientedPoint> after =
        movedPoints(truth, drawPlain(shape, isWhole ? 15000 : 45000, ++seed));
    const std::vector<Point> stroke = strokeOn(before, 1, random);
    if (!isWhole)
      before = retarget::patchAround(before, std::array{stroke[stroke.size() / 2]},
                                     2 * static_cast<double>(random.between(0.25f, 0.35f)));
    const std::clock_t start = std::clock();
    const Alignment a = retarget::alignSurfels(before, after, {.mode = setting.mode});
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    if (setting.printing == Printing::EachTrial)
      fmt::print("   {} rms {:.2e} firm {:.2e} rival {:.3f} {}: {}\n", nameOf(shape), a.relativeRms,
                 a.firmness, a.rivalRatio, nameOf(a.verdict), a.reason);
    row.add(a, strokeError(stroke, a.motion, truth), seconds);
  }
  print(nameOf(shape), row);
}

}  // namespace
}  // namespace restroke::testing

int main(int argc, char** argv) {
  using namespace restroke::testing;
  Setting setting;
  std::vector<AlignmentMode> modes{AlignmentMode::Whole, AlignmentMode::Patch};
  std::vector<std::string> names;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "--trials" && k + 1 < argc)
      setting.trials = std::atoi(argv[++k]);
    else if (word == "--each")
      setting.printing = Printing::EachTrial;
    else if (word == "--whole")
      modes = {AlignmentMode::Whole};
    else if (word == "--patch")
      modes = {AlignmentMode::Patch};
    else if (word == "--smoke")
      setting.trials = 0;
    else
      names.push_back(word);
  }
  const std::filesystem::path folder = std::filesystem::path(RESTROKE_SHARED_DIR) / "data/meshes/closed";
  if (setting.trials < 1) {
    setting.trials = 1;
    names = {};
  } else if (!std::filesystem::exists(folder)) {
    fmt::print("no meshes: {} is not there\n", folder.string());
    names = {};
  } else if (names.empty()) {
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
  }
  for (const AlignmentMode mode : modes) {
    setting.mode = mode;
    fmt::print(
        "\n{}\n| shape | trials | found | symmetric | featureless | no fit | within 1 % | median error % | "
        "95th % | least "
        "firmness | median firmness | least rival | median rival | rms | seconds |\n",
        mode == AlignmentMode::Whole ? "Whole shapes" : "Patches");
    Row total;
    for (const std::string& name : names)
      measure(name, SurfaceSampler(restroke::points::readMesh(folder / name)), setting, total);
    if (!names.empty()) print("all meshes", total);
    for (const PlainShape shape : kPlainShapes) measurePlain(shape, setting);
  }
}
