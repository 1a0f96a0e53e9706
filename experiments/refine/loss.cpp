#include "experiments/refine/loss.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "experiments/random.h"
#include "experiments/text.h"
#include "implicit/errors.h"
#include "implicit/geometry/powers.h"

namespace restroke::experiments {
namespace {

using points::RefinedModel;
using points::RefineMethod;
using points::Zone;

// So few that what is only carved is not all gone.
constexpr double kFewDensity = 3;

RefineHistory named(RefineHistory history, std::string name) {
  history.name = std::move(name);
  return history;
}

RefineHistory mixedBlock(std::size_t operations, std::uint64_t seed) {
  return named(strewnBalls({.operations = operations, .seed = seed}), fmt::format("block-{}", operations));
}

double additionsOf(const RefineHistory& history) {
  const auto added =
      std::ranges::count(history.operations, implicit::Sign::Positive, &implicit::Primitive::sign);
  return static_cast<double>(added) /
         static_cast<double>(std::max<std::size_t>(1, history.operations.size()));
}

class Plans {
 public:
  Plans(const LossOptions& options, std::uint64_t seed) : options_(options), seed_(seed) {}

  std::vector<LossPlan> make(const std::vector<RefineHistory>& logs) {
    addLines(logs);
    addZoom();
    addFeature();
    addDensity();
    addAdditions();
    addThin();
    return std::move(plans_);
  }

 private:
  template <class F>
  void add(LossModel model, const F& history) {
    if (model.parts.empty()) model.parts = {options_.part};
    plans_.push_back({fmt::format("{} {:g}", infoOf(model.sweep).name, model.value), [model, history] {
                        LossModel made = model;
                        made.history = history();
                        return made;
                      }});
  }

  template <class F>
  void addAtAll(bool denseMixed, const F& history) {
    for (const int n : options_.resolutions)
      add({.sweep = LossSweep::Lines,
           .value = static_cast<double>(n),
           .history = {},
           .resolution = n,
           .parts = {},
           .denseMixed = denseMixed},
          history);
  }

  void addLines(const std::vector<RefineHistory>& logs) {
    const std::uint64_t seed = seed_;
    const std::size_t middle = options_.operations, few = middle * 3 / 10, many = middle * 2;
    addAtAll(true, [=] {
      return named(strewnBalls({.operations = few, .ground = Ground::Ball, .seed = seed}),
                   fmt::format("ball-{}", few));
    });
    for (const std::size_t count : {middle, many}) addAtAll(true, [=] { return mixedBlock(count, seed); });
    addAtAll(false, [=] { return named(milledBlock(middle, seed), fmt::format("milled-{}", middle)); });
    addAtAll(false, [=] {
      return named(
          strewnBalls(
              {.operations = middle, .density = 2, .additions = 1, .ground = Ground::Nothing, .seed = seed}),
          fmt::format("added-{}", middle));
    });
    for (const RefineHistory& log : logs) addAtAll(false, [=] { return log; });
  }

  void addZoom() {
    const std::uint64_t seed = seed_;
    const std::size_t operations = options_.operations;
    add({.sweep = LossSweep::Zoom,
         .history = {},
         .resolution = options_.resolutions.back(),
         .parts = options_.parts},
        [=] { return mixedBlock(operations, seed); });
    add({.sweep = LossSweep::Zoom,
         .history = {},
         .resolution = options_.resolutions.back(),
         .parts = options_.parts},
        [=] { return named(milledBlock(operations, seed), fmt::format("milled-{}", operations)); });
  }

  void addFeature() {
    const std::uint64_t seed = seed_;
    for (const double cells : options_.features) {
      const std::size_t operations =
          operationsFor(BallsOptions{}.density, cells / options_.featureLines, Ground::Block);
      add({.sweep = LossSweep::Feature,
           .value = cells,
           .history = {},
           .resolution = options_.featureLines,
           .parts = {}},
          [=] { return named(mixedBlock(operations, seed), "block"); });
    }
  }

  void addDensity() {
    const std::uint64_t seed = seed_;
    for (const double density : options_.densities) {
      const std::size_t operations =
          operationsFor(density, options_.densityRadius / options_.densityLines, Ground::Block);
      add({.sweep = LossSweep::Density,
           .value = density,
           .history = {},
           .resolution = options_.densityLines,
           .parts = {}},
          [=] {
            return named(strewnBalls({.operations = operations, .density = density, .seed = seed}), "block");
          });
    }
  }

  void addAdditions() {
    const std::uint64_t seed = seed_;
    const std::size_t operations = options_.operations;
    for (const double part : options_.additions)
      add({.sweep = LossSweep::Additions,
           .value = part,
           .history = {},
           .resolution = options_.densityLines,
           .parts = {}},
          [=] {
            return named(
                strewnBalls(
                    {.operations = operations, .density = kFewDensity, .additions = part, .seed = seed}),
                fmt::format("block-{}", operations));
          });
  }

  void addThin() {
    for (const Thin thin : kThins)
      for (const bool between : {false, true}) {
        if (thin == Thin::Plates && between) continue;  // one family meets them wherever they are
        for (const double thickness : options_.thicknesses) {
          const ThinOptions made{.thin = thin,
                                 .thickness = thickness,
                                 .resolution = options_.thinLines,
                                 .between = between,
                                 .seed = seed_};
          add({.sweep = LossSweep::Thin,
               .value = thickness,
               .history = {},
               .resolution = options_.thinLines,
               .parts = {}},
              [=] { return thinFeatures(made); });
        }
      }
  }

  const LossOptions& options_;
  std::uint64_t seed_;
  std::vector<LossPlan> plans_;
};

}  // namespace

const std::vector<RefineVariant>& refineVariants() {
  using points::RefineOptions;
  static const std::vector<RefineVariant> variants{
      {"document", "document", {.method = RefineMethod::Document}},
      {"ends", "ends", {.method = RefineMethod::Ends}},
      {"ends-not-widened", "ends, the zone not widened", {.method = RefineMethod::Ends, .widening = 0}},
      {"ends-widened-by-2",
       "ends, the zone widened by 2 cells",
       {.method = RefineMethod::Ends, .widening = 2}},
      {"ends-uncorrected", "ends, without correction", {.method = RefineMethod::Ends, .corrected = false}},
      {"touching", "touching", {.method = RefineMethod::Touching}},
      {"clusters", "clusters", {.method = RefineMethod::Clusters}},
  };
  return variants;
}

const LossSweepInfo& infoOf(LossSweep sweep) {
  static constexpr std::array<LossSweepInfo, 6> kInfos{{
      {"lines", "How fine the model’s lines are", "lines along the longest side"},
      {"zoom", "How far one zooms in", "part of the volume"},
      {"feature", "How large features are", "mean radius in cells"},
      {"density", "How dense the history is", "operations that cover a point"},
      {"additions", "What is added, and what is carved", "part of additions"},
      {"thin", "Features thinner than a cell", "thickness in cells"},
  }};
  return kInfos.at(static_cast<std::size_t>(sweep));
}

std::vector<LossPlan> lossPlans(const LossOptions& options, const std::vector<RefineHistory>& logs,
                                std::uint64_t seed) {
  return Plans(options, seed).make(logs);
}

std::optional<double> LossRow::wrong() const {
  if (!(length > 0)) return std::nullopt;
  return (differences.missing + differences.extra) / length;
}

std::optional<double> LossRow::wrongVolume() const {
  if (!(length > 0)) return std::nullopt;
  return (differences.extra - differences.missing) / length;
}

Zone zoneAt(const Box& box, double part, DVec3 place) {
  const DVec3 low(box.min), high(box.max), size = high - low;
  const double half = powerOf(part * size.x * size.y * size.z, 1.0 / 3) / 2;
  points::OrientedBox zone;
  for (int a = 0; a < 3; ++a) {
    zone.half[a] = std::min(half, size[a] / 2);
    zone.center[a] = std::clamp(place[a], low[a] + zone.half[a], high[a] - zone.half[a]);
  }
  return Zone(zone);
}

std::vector<DVec3> placesOnSurface(const points::TriDexel& model, int count, std::uint64_t seed) {
  if (model.endCount() == 0) throw InputError("the history ends with nothing; a solid must be there");
  std::vector<DVec3> places;
  Random random(seed);
  points::LineEnds ends;
  while (places.size() < static_cast<std::size_t>(count)) {
    const int axis = static_cast<int>(random.below(3));
    const points::Dexels& dexels = model.family(axis);
    const std::size_t line = random.below(dexels.lineCount());
    const std::uint64_t which = random.next();
    dexels.read(line, ends);
    if (ends.empty()) continue;
    const auto width = static_cast<std::size_t>(dexels.width());
    DVec3 p;
    p[axis] = static_cast<double>(ends[which % ends.size()].depth);
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    p[u] = static_cast<double>(model.grid().at(u, static_cast<int>(line % width)));
    p[v] = static_cast<double>(model.grid().at(v, static_cast<int>(line / width)));
    places.push_back(p);
  }
  return places;
}

std::vector<DVec3> placesOfOperations(const RefineHistory& history, int count, std::uint64_t seed) {
  RESTROKE_CHECK_LT(0u, history.operations.size());
  std::vector<DVec3> places;
  Random random(seed);
  for (int i = 0; i < count; ++i)
    places.emplace_back(history.operations[random.below(history.operations.size())].shape.ball().center);
  return places;
}

std::vector<LossRow> measureLoss(const LossModel& model, const LossOptions& options, std::uint64_t seed,
                                 const Execution& execution) {
  const points::TriDexelDocument document =
      documentOf(model.history, model.resolution, Kept::Histories, execution);
  const points::DexelHistory history(document, execution);
  const Box box = boundsOf(model.history);
  // Surface that no line has seen is not to be left out.
  const std::vector<DVec3> places = model.sweep == LossSweep::Thin
                                        ? placesOfOperations(model.history, options.thinPlaces, seed)
                                        : placesOnSurface(document.model, options.places, seed);
  std::size_t lineHistories = 0;
  for (int axis = 0; axis < 3; ++axis) lineHistories += document.model.family(axis).histories().bytes();
  std::vector<LossRow> rows;
  for (const double part : model.parts)
    for (std::size_t place = 0; place < places.size(); ++place) {
      const Zone zone = zoneAt(box, part, places[place]);
      const auto lines = newLines(zone, {.resolution = options.fineLines});
      const Reference reference(
          points::refine({document, history}, {zone, lines}, {.method = RefineMethod::All}, execution));
      LossRow row{.sweep = model.sweep,
                  .value = model.sweep == LossSweep::Zoom ? part : model.value,
                  .history = model.history.name,
                  .denseMixed = model.denseMixed,
                  .operations = model.history.operations.size(),
                  .additions = additionsOf(model.history),
                  .ids = reference.model().ids.size(),
                  .resolution = model.resolution,
                  .cell = document.model.grid().cell(),
                  .fineCell = length(lines.front().originStep),
                  .part = part,
                  .place = static_cast<int>(place),
                  .modelBytes = document.model.bytes() - lineHistories,
                  .lineHistoryBytes = lineHistories,
                  .method = {},
                  .collected = 0,
                  .length = reference.length(),
                  .ends = reference.ends(),
                  .recall = {},
                  .differences = {}};
      for (const RefineVariant& variant : refineVariants()) {
        const RefinedModel refined =
            points::refine({document, history}, {zone, lines}, variant.options, execution);
        row.method = variant.name;
        row.collected = refined.ids.size();
        row.recall = recallOf(reference, refined.ids);
        row.differences = differencesOf(reference, refined, execution);
        rows.push_back(row);
      }
    }
  return rows;
}

}  // namespace restroke::experiments
