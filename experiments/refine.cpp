#include "experiments/refine.h"

#include <fmt/ranges.h>

#include <algorithm>

#include "experiments/dexel.h"
#include "experiments/provenance.h"
#include "experiments/shipped.h"
#include "experiments/text.h"
#include "implicit/errors.h"
#include "points/dexel/dexel_grid.h"

namespace restroke::experiments {
namespace {

namespace fs = std::filesystem;

void validate(const RefinementOptions& options) {
  const LossOptions& loss = options.loss;
  for (const auto& [what, value, least, most] :
       {std::tuple{"new lines along the zone's side", loss.fineLines, 2, points::kMostLines},
        {"places", loss.places, 1, 1000},
        {"new lines along the zone's side", options.growth.fineLines, 2, points::kMostLines},
        {"repetitions", options.growth.repeats, 1, 1000},
        {"places of thin features", loss.thinPlaces, 1, 1000},
        {"places to be drawn", options.picturePlaces, 1, 1000}})
    if (value < least || value > most)
      throw InputError(fmt::format("{} {}; it must be {} to {}", value, what, least, most));
  if (loss.operations < kLeastGrowth || loss.operations > kMostGrowth)
    throw InputError(fmt::format("histories of {} operations; it must be {} to {}", loss.operations,
                                 kLeastGrowth, kMostGrowth));
  for (const std::size_t n : options.growth.operations)
    if (n < kLeastGrowth || n > kMostGrowth)
      throw InputError(fmt::format("a history that grows to {} operations; it must be {} to {}", n,
                                   kLeastGrowth, kMostGrowth));
}

/// The first primitive is the initial solid, the others are operations.
RefineHistory historyOf(DexelSource source) {
  RefineHistory history{.name = std::move(source.name), .initial = {}, .operations = {}};
  if (source.primitives.size() < 2)
    throw InputError(fmt::format("{}: no operation on an initial solid; there must be some", history.name));
  history.initial.push_back(source.primitives.front());
  history.operations.assign(source.primitives.begin() + 1, source.primitives.end());
  return history;
}

}  // namespace

RefinementOptions smokeSize(RefinementOptions options) {
  LossOptions& loss = options.loss;
  loss.resolutions = {16, 32};
  loss.operations = 1000;
  loss.fineLines = 24;
  loss.places = 2;
  loss.parts = {0.01, 0.1};
  loss.featureLines = 16;
  loss.features = {1, 2, 4};
  loss.densityLines = 32;
  loss.densities = {1, 4};
  loss.additions = {0, 0.5, 1};
  loss.thinLines = 32;
  loss.thicknesses = {0.5, 2};
  loss.thinPlaces = 3;
  GrowthOptions& growth = options.growth;
  growth.operations = {1000, 3000};
  growth.resolution = 48;
  growth.fineLines = 24;
  growth.repeats = 3;
  growth.plainSeconds = 0.2;
  options.pictureSize = std::min(options.pictureSize, 160u);
  options.picturePlaces = 2;
  options.smoke = true;
  return options;
}

std::string describe(const RefinementOptions& options) {
  const LossOptions& l = options.loss;
  const GrowthOptions& g = options.growth;
  return fmt::format(
      "resolutions={} operations={} fineLines={} places={} and {} part={} parts={} features={} of {} "
      "densities={} "
      "of "
      "radius {} at {} additions={} thicknesses={} of {} growth={} at {} fineLines={} part={} repeats={} "
      "plain={} for {} histories={} picture={} of {} seed={} smoke={}",
      fmt::join(l.resolutions, ","), l.operations, l.fineLines, l.places, l.thinPlaces, l.part,
      fmt::join(l.parts, ","), fmt::join(l.features, ","), l.featureLines, fmt::join(l.densities, ","),
      l.densityRadius, l.densityLines, fmt::join(l.additions, ","), fmt::join(l.thicknesses, ","),
      l.thinLines, fmt::join(g.operations, ","), g.resolution, g.fineLines, g.part, g.repeats, g.plainMost,
      g.plainSeconds, g.mostHistoryBytes, options.pictureSize, options.picturePlaces, options.seed,
      options.smoke);
}

std::vector<fs::path> defaultRefinementLogs(bool smoke) {
  if (smoke) return {shippedFile("examples/gallery.log")};
  return {shippedFile("examples/paper-scale.log"), shippedFile("examples/rabbit.log")};
}

RefinementResults measureRefinement(const std::vector<fs::path>& logs, const RefinementOptions& options,
                                    const Execution& execution, const RefinementProgress& progress) {
  validate(options);
  RefinementResults results;
  std::vector<RefineHistory> histories;
  for (const fs::path& log : logs) {
    results.inputs.emplace_back(log.filename().string(), hashOfFile(log));
    RefineHistory history = historyOf(sourceOf(log));
    history.name = untakenName(history.name, [&](std::string_view name) {
      return std::ranges::any_of(histories, [&](const RefineHistory& h) { return h.name == name; });
    });
    histories.push_back(std::move(history));
  }
  const std::vector<LossPlan> plans = lossPlans(options.loss, histories, options.seed);
  std::vector<PictureCase> cases;
  if (options.pictureSize > 0) cases = pictureCases(options.loss, options.seed);
  const std::size_t all =
      plans.size() + cases.size() + std::size(kGrowths) * options.growth.operations.size();
  std::size_t done = 0;
  const auto tell = [&](const std::string& what) {
    if (progress) progress(what + "; step", done++, all);
  };
  for (const LossPlan& plan : plans) {
    tell(plan.what);
    const LossModel model = plan.make();
    try {
      for (LossRow& row : measureLoss(model, options.loss, options.seed, execution))
        results.losses.push_back(std::move(row));
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", model.history.name, error.what()));
    }
  }
  for (const PictureCase& each : cases) {
    tell("picture of " + each.title);
    for (LossPicture& picture : drawLoss(each,
                                         {.size = options.pictureSize,
                                          .fineLines = options.loss.fineLines,
                                          .part = options.loss.part,
                                          .places = options.picturePlaces},
                                         options.seed, execution))
      results.pictures.push_back(std::move(picture));
  }
  for (const Growth growth : kGrowths)
    for (GrowthRow& row : measureGrowth(growth, options.growth, options.seed, execution, tell, results.notes))
      results.growths.push_back(std::move(row));
  return results;
}

}  // namespace restroke::experiments
