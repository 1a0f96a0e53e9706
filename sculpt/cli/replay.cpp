// restroke replay: what a log says, evaluated, and what that took.

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <vector>

#include "implicit/errors.h"
#include "implicit/simd/dispatch.h"
#include "sculpt/cli/commands.h"
#include "sculpt/cli/replaying.h"

namespace restroke::cli {

namespace {

using Clock = std::chrono::steady_clock;

/// Microseconds; nearest ranks. All 0 without stamps.
struct StampTimes {
  double p50 = 0, p99 = 0, max = 0;
};

StampTimes timesOf(std::span<const float> seconds) {
  if (seconds.empty()) return {};
  std::vector<float> sorted(seconds.begin(), seconds.end());
  std::sort(sorted.begin(), sorted.end());
  const auto rank = [&](std::size_t percent) {
    const std::size_t index = (sorted.size() * percent + 99) / 100;
    return static_cast<double>(sorted[index - 1]) * 1e6;
  };
  return {rank(50), rank(99), rank(100)};
}

/// What the strokes on the path to the cursor amount to.
struct Totals {
  std::size_t strokes = 0, points = 0, misses = 0;
};

Totals totalsOf(const sculpt::History& history) {
  Totals totals;
  for (const sculpt::NodeId node : history.pathTo(history.cursor())) {
    ++totals.strokes;
    totals.misses += history.result(node).misses;
    const sculpt::Command command = history.command(node);
    if (const auto* stroke = std::get_if<sculpt::StrokeCommand>(&command))
      totals.points += stroke->stroke.points.size();
  }
  return totals;
}

bool equalsFromScratch(const sculpt::Document& document, const Execution& execution) {
  const points::SurfelModel& model = document.model();
  std::vector<implicit::Primitive> primitives;
  primitives.reserve(model.list().size());
  for (std::size_t i = 0; i < model.list().size(); ++i) primitives.push_back(model.list().at(i));
  points::SurfelModel scratch(model.sampling(), sculpt::clustersFor(document.header()));
  scratch.append(primitives, execution);
  scratch.rebuild(execution);
  return scratch.surfelCount() == model.surfelCount() &&
         scratch.stateHash(execution) == model.stateHash(execution);
}

}  // namespace

int runReplay(const ReplayCommandOptions& options) {
  const Execution execution = executionOf(options.common);
  sculpt::StrokeLog log = readLogNoting(options.log);
  overrideDensity(log, options.density);
  Output output(options.common);

  std::size_t differences = 0;
  sculpt::ReplayOptions replaying;
  replaying.file = options.log;
  replaying.document = {.recompute = options.recompute, .timeStamps = true};
  replaying.step = [&](std::size_t i, const sculpt::CommandReport& report) {
    if (!report.outcomeDiffers) return;
    ++differences;
    output.say(
        fmt::format("{}: the outcome made anew differs from the recorded one ({} stamps, {} misses now)\n",
                    sculpt::placeOf(log, options.log, i), report.primitivesAdded, report.misses));
  };
  const auto start = Clock::now();
  const sculpt::Document document = replayNoting(log, replaying, execution);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();

  const Totals totals = totalsOf(document.history());
  const StampTimes times = timesOf(document.stampSeconds());
  const points::SurfelModel& model = document.model();
  const std::string hash = hexHash(model.stateHash(execution));
  nlohmann::ordered_json json{{"primitives", model.list().size()},
                              {"strokes", totals.strokes},
                              {"stroke_points", totals.points},
                              {"surfels", model.surfelCount()},
                              {"misses", totals.misses},
                              {"state_hash", hash},
                              {"history_bytes", document.history().bytes()},
                              {"model_bytes", model.bytes().total()},
                              {"log_bytes", log.bytes},
                              {"seconds", seconds},
                              {"simd", implicit::simdLevelName()},
                              {"stamp_us", {{"p50", times.p50}, {"p99", times.p99}, {"max", times.max}}}};
  output.say(fmt::format("{} primitives of {} strokes ({} points, {} of them misses), {} surfels, state {}\n",
                         grouped(model.list().size()), grouped(totals.strokes), grouped(totals.points),
                         grouped(totals.misses), grouped(model.surfelCount()), hash));
  output.say(fmt::format("bytes: history {}, model {}, log {}\n", grouped(document.history().bytes()),
                         grouped(model.bytes().total()), grouped(log.bytes)));
  output.say(
      fmt::format("{:.3f} s ({}); a stamp takes {:.1f} us (median), {:.1f} us (99 %), {:.1f} us (most)\n",
                  seconds, implicit::simdLevelName(), times.p50, times.p99, times.max));
  if (options.recompute) {
    json["differences"] = differences;
    output.say(fmt::format("recompute: {} recorded outcomes differ\n", differences));
  }
  int status = 0;
  if (options.check) {
    const bool equal = equalsFromScratch(document, execution);
    json["check"] = equal;
    output.say(equal ? "check: incremental and from-scratch results are equal\n" : "");
    if (!equal) {
      Output::note(
          fmt::format("{}: the incremental result differs from the one made from scratch", options.log));
      status = 1;
    }
  }
  output.finish(json);
  return status;
}

}  // namespace restroke::cli
