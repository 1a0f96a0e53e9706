#include "experiments/refine/growth.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <utility>

#include "experiments/refine/loss.h"
#include "experiments/text.h"
#include "implicit/errors.h"

namespace restroke::experiments {
namespace {

using points::RefinedModel;
using points::RefineMethod;

// The zone of all sizes is about here: away from the faces of the cube, so that it is as far from them
// whatever the balls' size.
constexpr DVec3 kMiddle{0.4, 0.55, 0.45};
// What is near the zone: wider than any method looks, which is two cells of the model.
constexpr double kNear = 0.03;
// What the history of a line takes for each operation that changed it.
constexpr double kBytesOfChange = 8;

template <class F>
double secondsOf(const F& f) {
  const auto begun = std::chrono::steady_clock::now();
  f();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

double medianOf(std::vector<double> values) {
  return quartilesOf(std::move(values)).median;
}

/// What the histories of a model's lines would take, from the areas of the balls.
double expectedHistoryBytes(const RefineHistory& history, double cell) {
  double lines = 0;
  for (const implicit::Primitive& p : history.operations) {
    const double r = static_cast<double>(p.shape.ball().radius) / cell;
    lines += 3 * 3.14159265 * r * r;
  }
  return lines * kBytesOfChange;
}

Box unitCube() {
  return {Point(0), Point(1)};
}

/// One size: the model, and each method's repetitions.
class Size {
 public:
  Size(const GrowthOptions& options, const Execution& execution) : options_(options), execution_(execution) {}

  std::vector<GrowthRow> measure(Growth growth, std::size_t operations, std::uint64_t seed,
                                 std::vector<std::string>& notes) {
    model_.growth = growth;
    model_.operations = operations;
    make(growth, operations, seed, notes);
    const points::Zone zone = zoneAt(unitCube(), options_.part, kMiddle);
    const auto lines = newLines(zone, {.resolution = options_.fineLines});
    const Reference reference(
        points::refine({document_, *history_}, {zone, lines}, {.method = RefineMethod::All}, execution_));
    model_.ids = reference.model().ids.size();
    model_.endsInZone = reference.ends();
    repeat(zone, reference);
    std::vector<GrowthRow> rows;
    const std::vector<double>& ends = totals_.at(endsAt());
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      if (totals_[k].empty()) continue;
      GrowthRow& row = rows_[k];
      std::vector<double> ratios;
      for (std::size_t i = 0; i < totals_[k].size(); ++i) ratios.push_back(totals_[k][i] / ends.at(i));
      row.repeats = totals_[k].size();
      row.seconds = quartilesOf(totals_[k]);
      row.byEnds = quartilesOf(ratios);
      row.collect = medianOf(collect_[k]);
      row.approximate = medianOf(approximate_[k]);
      row.replay = medianOf(replay_[k]);
      rows.push_back(row);
    }
    return rows;
  }

 private:
  static std::size_t endsAt() {
    const auto& methods = timedMethods();
    const auto at = std::ranges::find_if(
        methods, [](const TimedMethod& m) { return m.options.method == RefineMethod::Ends; });
    return static_cast<std::size_t>(at - methods.begin());
  }

  void make(Growth growth, std::size_t operations, std::uint64_t seed, std::vector<std::string>& notes) {
    const points::Zone zone = zoneAt(unitCube(), options_.part, kMiddle);
    const RefineHistory made = grownHistory(growth, operations, zone.widened(kNear).bounds(), seed);
    model_.modelSeconds =
        secondsOf([&] { document_ = documentOf(made, options_.resolution, Kept::References, execution_); });
    model_.modelBytes = document_.model.bytes();
    const double expected = expectedHistoryBytes(made, document_.model.grid().cell());
    keepsHistories_ = expected <= options_.mostHistoryBytes;
    if (keepsHistories_) {
      model_.historyModelSeconds =
          secondsOf([&] { document_ = documentOf(made, options_.resolution, Kept::Histories, execution_); });
      model_.historyModelBytes = document_.model.bytes();
    } else {
      notes.push_back(
          fmt::format("{}, {} operations: the histories of the lines would take about {:.1f} GB, so touching "
                      "was not timed",
                      nameOf(growth), grouped(operations), expected * 1e-9));
    }
    model_.historySeconds =
        secondsOf([&] { history_ = std::make_unique<points::DexelHistory>(document_, execution_); });
    model_.historyBytes = history_->bytes();
    model_.clusterSeconds = secondsOf([&] { history_->makeClusters(); });
  }

  /// Lines along the zone's side, where each line asks each operation.
  [[nodiscard]] int linesFor(const TimedMethod& method) const {
    int lines = options_.fineLines;
    const auto operations = static_cast<double>(method.byBounds ? model_.ids : model_.operations);
    while (method.asksEach() && lines > 8 && 3.0 * lines * lines * operations > options_.plainMost)
      lines /= 2;
    return lines;
  }

  void repeat(const points::Zone& zone, const Reference& reference) {
    const auto& methods = timedMethods();
    rows_.assign(methods.size(), model_);
    totals_.assign(methods.size(), {});
    collect_ = approximate_ = replay_ = totals_;
    std::vector<double> spent(methods.size());
    for (int turn = 0; turn < options_.repeats; ++turn)
      for (std::size_t k = 0; k < methods.size(); ++k) {
        const TimedMethod& method = methods[k];
        if (method.options.method == RefineMethod::Touching && !keepsHistories_) continue;
        // After n turns the next one takes about a further n-th.
        if (method.asksEach() && turn > 0 && spent[k] * (turn + 1) / turn > options_.plainSeconds) continue;
        const auto lines = newLines(zone, {.resolution = linesFor(method)});
        const double scale = countOf(reference.model()) / countOf(lines);
        RefinedModel refined;
        const double seconds = secondsOf([&] { refined = refineBy(method, zone, lines); });
        spent[k] += seconds;
        rows_[k].scale = scale;
        totals_[k].push_back(scale * seconds);
        collect_[k].push_back(scale * refined.times.collect);
        approximate_[k].push_back(scale * refined.times.approximate);
        replay_[k].push_back(scale * refined.times.replay);
        if (turn > 0) continue;
        if (scale == 1)
          judge(rows_[k], method, reference, refined);
        else
          judge(rows_[k], method,
                Reference(points::refine({document_, *history_}, {zone, lines}, {.method = RefineMethod::All},
                                         execution_)),
                refined);
      }
  }

  [[nodiscard]] RefinedModel refineBy(const TimedMethod& method, const points::Zone& zone,
                                      const std::vector<points::LineFamily>& lines) const {
    if (!method.byBounds)
      return points::refine({document_, *history_}, {zone, lines}, method.options, execution_);
    RefinedModel out;
    out.times.collect = secondsOf([&] { out.ids = history_->idsByBounds(zone); });
    out.times.replay = secondsOf([&] {
      for (const points::LineFamily& family : lines) {
        points::RefinedFamily refined;
        refined.lines = linesInZone(family, zone, execution_);
        refined.dexels = replayPlainly({*history_, out.ids}, refined.lines, execution_);
        out.families.push_back(std::move(refined));
      }
    });
    return out;
  }

  static double countOf(const RefinedModel& model) {
    std::vector<points::LineFamily> families;
    for (const points::RefinedFamily& family : model.families) families.push_back(family.lines.family);
    return countOf(families);
  }
  static double countOf(const std::vector<points::LineFamily>& families) {
    double count = 0;
    for (const points::LineFamily& family : families) count += 1.0 * family.width * family.height;
    return count;
  }

  void judge(GrowthRow& row, const TimedMethod& method, const Reference& reference,
             const RefinedModel& refined) const {
    const Differences differences = differencesOf(reference, refined, execution_);
    const Recall recall = recallOf(reference, refined.ids);
    row.method = method.name;
    row.collected = refined.ids.size();
    row.identical = differences.identical;
    if (reference.length() > 0) row.wrong = (differences.missing + differences.extra) / reference.length();
    row.sides = recall.sides;
    row.sidesMissed = recall.sidesMissed;
  }

  const GrowthOptions& options_;
  const Execution& execution_;
  points::TriDexelDocument document_;
  std::unique_ptr<points::DexelHistory> history_;
  bool keepsHistories_ = false;
  GrowthRow model_;
  std::vector<GrowthRow> rows_;  // by method
  std::vector<std::vector<double>> totals_, collect_, approximate_, replay_;
};

}  // namespace

std::vector<std::size_t> growthUpTo(std::size_t most) {
  std::vector<std::size_t> out;
  for (std::size_t n = 1000; n < most; n *= 10)
    for (const std::size_t each : {n, 3 * n})
      if (each < most) out.push_back(each);
  out.push_back(most);
  return out;
}

const std::vector<TimedMethod>& timedMethods() {
  using points::RefineOptions;
  static const std::vector<TimedMethod> methods{
      {"document", "document", {.method = RefineMethod::Document}},
      {"ends", "ends", {.method = RefineMethod::Ends}},
      {"touching", "touching", {.method = RefineMethod::Touching}},
      {"clusters", "clusters", {.method = RefineMethod::Clusters}},
      {"all", "all", {.method = RefineMethod::All}},
      {"all-by-bounds", "all, culled by bounds, line by line", {.method = RefineMethod::All}, true},
      {"all-plain", "all, plain", {.method = RefineMethod::All, .plain = true}},
  };
  return methods;
}

Quartiles quartilesOf(std::vector<double> values) {
  RESTROKE_CHECK_LT(0u, values.size());
  std::ranges::sort(values);
  const std::size_t last = values.size() - 1;
  return {values[last / 4], values[last / 2], values[last - last / 4]};
}

std::vector<GrowthRow> measureGrowth(Growth growth, const GrowthOptions& options, std::uint64_t seed,
                                     const Execution& execution,
                                     const std::function<void(const std::string&)>& told,
                                     std::vector<std::string>& notes) {
  std::vector<GrowthRow> rows;
  for (const std::size_t operations : options.operations) {
    told(fmt::format("{}, {} operations", nameOf(growth), grouped(operations)));
    for (GrowthRow& row : Size(options, execution).measure(growth, operations, seed, notes))
      rows.push_back(std::move(row));
  }
  return rows;
}

std::optional<double> powerOfGrowth(const std::vector<GrowthRow>& rows, Growth growth,
                                    const std::string& method, std::size_t from) {
  double count = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const GrowthRow& row : rows) {
    if (row.growth != growth || row.method != method || row.operations < from) continue;
    const double a = std::log(static_cast<double>(row.operations)), b = std::log(row.seconds.median);
    count += 1;
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
  }
  const double spread = count * xx - x * x;
  if (count < 2 || !(spread > 0)) return std::nullopt;
  return (count * xy - x * y) / spread;
}

}  // namespace restroke::experiments
