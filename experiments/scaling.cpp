#include "experiments/scaling.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <thread>

#include "experiments/provenance.h"
#include "experiments/shipped.h"
#include "experiments/text.h"
#include "implicit/errors.h"
#include "implicit/process_memory.h"
#include "implicit/shape.h"
#include "implicit/simd/dispatch.h"

namespace restroke::experiments {
namespace {

namespace fs = std::filesystem;

// Of a list whose like was not measured yet: sphere, clusters, and the samples of the paper's stamps.
constexpr double kGuessedBytes = 700;
// Of what is to be had, the part that a model may take.
constexpr double kModelPart = 0.85;

std::string gigabytes(double bytes) {
  return fmt::format("{:.1f} GB", bytes * 1e-9);
}

/// One list to be measured.
struct Trial {
  Sweep sweep = Sweep::Extent;
  std::string source;
  double value = 0;
  std::size_t primitives = 0;             // about
  std::function<Layout()> layout;         // made when its turn has come
  std::optional<std::size_t> bytes = {};  // that the model will take, where it is known
};

std::vector<std::size_t> decades(std::size_t from, std::size_t most) {
  std::vector<std::size_t> sizes;
  for (std::size_t n = from; n <= most; n *= 10) sizes.push_back(n);
  return sizes;
}

/// Surfels that a list has at a density, by replaying it.
std::size_t surfelsAt(const Layout& layout, float density, const Execution& execution) {
  points::SurfelModel model({.density = density});
  model.append(layout.bases, execution);
  for (std::size_t k = 0; k < layout.strokes; ++k) model.append(layout.stroke(k), execution);
  return model.surfelCount();
}

std::vector<double> capsOf(const ScalingOptions& options) {
  if (options.smoke) return {2, 0.4, 0.1};
  return {2, 0.8, 0.4, 0.2, 0.1};
}

std::vector<double> spreadsOf(const ScalingOptions& options) {
  if (options.smoke) return {1, 100, 10'000};
  return {1, 10, 100, 1000, 10'000};
}

bool wants(const ScalingOptions& options, Sweep sweep) {
  return std::ranges::find(options.sweeps, sweep) != options.sweeps.end();
}

std::vector<Trial> madeTrials(const ScalingOptions& options) {
  std::vector<Trial> trials;
  const std::uint64_t seed = options.seed;
  for (const std::size_t n : decades(1000, options.most))
    trials.push_back({Sweep::Extent, {}, static_cast<double>(n), n, [=] { return extentLayout(n, seed); }});
  for (const std::size_t n : decades(1000, options.most))
    trials.push_back({Sweep::Detail, {}, static_cast<double>(n), n, [=] { return detailLayout(n, seed); }});
  const std::size_t crowd = options.crowd, many = options.spreadPrimitives;
  for (const double cap : capsOf(options))
    trials.push_back({Sweep::Crowding, {}, cap, crowd, [=] { return crowdedLayout(crowd, cap, seed); }});
  for (const double spread : spreadsOf(options))
    trials.push_back({Sweep::Spread, {}, spread, many, [=] { return spreadLayout(many, spread, seed); }});
  std::erase_if(trials, [&](const Trial& trial) { return !wants(options, trial.sweep); });
  return trials;
}

/// Tables of samples take about 16 bytes a sample where they are spheres'; each primitive's own bits, a
/// seventh of a byte.
std::size_t bytesOfSampling(const Layout& layout) {
  double samples = 0, greatest = 0;
  const auto add = [&](const implicit::Primitive& p) {
    const double n = areaOf(p.shape) * static_cast<double>(layout.density);
    samples += n;
    greatest = std::max(greatest, n);
  };
  std::ranges::for_each(layout.bases, add);
  for (std::size_t k = 0; k < layout.strokes; ++k) std::ranges::for_each(layout.stroke(k), add);
  return static_cast<std::size_t>(samples / 7 + greatest * 40);
}

void addSurfelTrials(const fs::path& log, const ScalingOptions& options, const Execution& execution,
                     std::vector<Trial>& trials) {
  const Layout list = listLayout(log);
  float density = list.density;
  std::size_t there = surfelsAt(list, density, execution), primitives = list.bases.size();
  for (std::size_t k = 0; k < list.strokes; ++k) primitives += list.stroke(k).size();
  for (const std::size_t target : options.surfels) {
    const auto scaled = [&] {
      return static_cast<float>(static_cast<double>(density) * static_cast<double>(target) /
                                static_cast<double>(there));
    };
    // Few samples are not in proportion to the density (16 are the least): once more from close by.
    density = scaled();
    if (target < kPaperSurfels) {
      there = std::max<std::size_t>(1, surfelsAt(list, density, execution));
      density = scaled();
    }
    there = target;
    Layout layout = list;
    layout.density = density;
    trials.push_back({Sweep::Surfels, log.filename().string(), static_cast<double>(target), primitives,
                      [layout] { return layout; }, bytesOfSampling(layout)});
  }
}

std::string nameOf(const Trial& trial) {
  return fmt::format("{}{}{}, {} {}", infoOf(trial.sweep).name, trial.source.empty() ? "" : " of ",
                     trial.source, infoOf(trial.sweep).parameter,
                     trial.value < 1000 ? fmt::format("{:g}", trial.value)
                                        : grouped(static_cast<std::uint64_t>(trial.value)));
}

/// Why the trial cannot be tried; empty when it can.
std::string hindrance(const Trial& trial, const Layout& layout, double bytesPerPrimitive) {
  try {
    for (const implicit::Primitive& p : layout.bases) (void)implicit::sampleCount(p.shape, layout.density);
    for (std::size_t k = 0; !layout.endless && k < layout.strokes; ++k)
      for (const implicit::Primitive& p : layout.stroke(k))
        (void)implicit::sampleCount(p.shape, layout.density);
  } catch (const InputError& error) {
    return error.what();
  }
  double needed = bytesPerPrimitive * static_cast<double>(trial.primitives);
  if (trial.bytes) needed += static_cast<double>(*trial.bytes);
  const auto available = availableBytes();
  if (available && needed > kModelPart * static_cast<double>(*available))
    return fmt::format("the model would take about {}, and {} are to be had", gigabytes(needed),
                       gigabytes(static_cast<double>(*available)));
  return {};
}

/// Of the largest list of the first two sweeps that is drawn at all, whole and in part.
bool wantsPortrait(const Trial& trial, const ScalingOptions& options) {
  const std::vector<std::size_t> sizes = decades(1000, std::min<std::size_t>(options.most, 1'000'000));
  return (trial.sweep == Sweep::Extent || trial.sweep == Sweep::Detail) &&
         trial.value == static_cast<double>(sizes.back());
}

}  // namespace

ScalingOptions smokeSize(ScalingOptions options) {
  options.most = std::min<std::size_t>(options.most, 10'000);
  std::erase_if(options.surfels, [](std::size_t n) { return n > 100'000; });
  options.crowd = std::min<std::size_t>(options.crowd, 2000);
  options.spreadPrimitives = std::min<std::size_t>(options.spreadPrimitives, 1000);
  options.measure.stamps = std::min<std::size_t>(options.measure.stamps, 200);
  options.measure.undos = std::min<std::size_t>(options.measure.undos, 8);
  options.measure.patience = std::min(options.measure.patience, 0.1);
  options.measure.width = std::min(options.measure.width, 320u);
  options.measure.height = std::min(options.measure.height, 180u);
  options.smoke = true;
  return options;
}

std::string describe(const ScalingOptions& options) {
  const MeasureOptions& m = options.measure;
  std::vector<std::string_view> sweeps;
  for (const Sweep sweep : options.sweeps) sweeps.push_back(infoOf(sweep).name);
  return fmt::format(
      "sweeps={} most={} surfels={} crowd={} spreadPrimitives={} stamps={} undos={} patience={} "
      "picture={}x{} "
      "seed={} "
      "smoke={}",
      fmt::join(sweeps, ","), options.most, fmt::join(options.surfels, ","), options.crowd,
      options.spreadPrimitives, m.stamps, m.undos, m.patience, m.width, m.height, options.seed,
      options.smoke);
}

const SweepInfo& infoOf(Sweep sweep) {
  static constexpr std::array<SweepInfo, 5> kInfos{{
      {"extent", "primitives", "More surface: pebbles of 1,000 stamps each"},
      {"detail", "primitives", "More detail: one sphere, a brush that shrinks, samples that grow denser"},
      {"surfels", "surfels", "More surfels: the same list, sampled more densely"},
      {"crowding", "cap", "More crowding: the same strokes on a smaller cap"},
      {"spread", "spread", "More spread: radii from 1 : 1 to 1 : 10,000 in one list"},
  }};
  return kInfos.at(static_cast<std::size_t>(sweep));
}

std::vector<fs::path> defaultScalingLogs() {
  return {shippedFile("examples/paper-scale.log")};
}

ScalingResults measureScaling(const std::vector<fs::path>& logs, const ScalingOptions& options,
                              const Execution& execution, const ScalingProgress& progress) {
  ScalingResults results;
  results.simd = implicit::simdLevelName();
  results.threads = execution.threads > 0
                        ? execution.threads
                        : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  results.width = options.measure.width;
  results.height = options.measure.height;
  std::vector<Trial> trials = madeTrials(options);
  for (const fs::path& log : logs) {
    if (!wants(options, Sweep::Surfels)) break;
    results.inputs.emplace_back(log.filename().string(), hashOfFile(log));
    // Last: the tables of dense samplings stay in memory.
    addSurfelTrials(log, options, execution, trials);
  }

  double bytesPerPrimitive = kGuessedBytes;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const Trial& trial = trials[i];
    if (progress) progress(nameOf(trial), i, trials.size());
    if (i == 0 || trials[i - 1].sweep != trial.sweep) bytesPerPrimitive = kGuessedBytes;
    const Layout layout = trial.layout();
    if (const std::string reason = hindrance(trial, layout, bytesPerPrimitive); !reason.empty()) {
      results.notes.push_back(fmt::format("{}: {}", nameOf(trial), reason));
      continue;
    }
    MeasureOptions how = options.measure;
    how.seed = options.seed;
    how.portrait = wantsPortrait(trial, options);
    ScalingRow row{trial.sweep, trial.source, trial.value, measure(layout, how, execution)};
    if (!row.measured.leftOut.empty())
      results.notes.push_back(fmt::format("{}: {}", nameOf(trial), row.measured.leftOut));
    if (!trial.bytes)
      bytesPerPrimitive =
          static_cast<double>(row.measured.bytes.total()) / static_cast<double>(row.measured.primitives);
    results.rows.push_back(std::move(row));
  }
  return results;
}

}  // namespace restroke::experiments
