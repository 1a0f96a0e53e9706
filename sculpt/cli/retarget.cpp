// restroke retarget: the strokes of a log on another base, each cast anew from its recorded input (SPEC S7).

#include <nlohmann/json.hpp>

#include "implicit/errors.h"
#include "sculpt/base_change.h"
#include "sculpt/cli/commands.h"
#include "sculpt/cli/output.h"
#include "sculpt/cli/replaying.h"
#include "sculpt/cli/words.h"

namespace restroke::cli {

namespace {

/// Methods that only cast need no more than the new base under the log. Those that follow a change must see
/// it happen: they get it as commands at the log's end.
void changeBase(sculpt::StrokeLog& log, const RetargetOptions& options, retarget::Method method) {
  const bool follows = retarget::needsTrail(method);
  const auto append = [&](sculpt::Command command) {
    log.commands.push_back(std::move(command));
    log.lines.push_back(log.lines.empty() ? 2 : log.lines.back() + 1);
  };
  if (!options.base.empty()) {
    const implicit::Shape base =
        sculpt::shapeNamed(options.base, repairNamed(options.repair), "--base", Output::note);
    if (follows)
      append(sculpt::BaseCommand{{}, base});
    else
      log.header.base = base;
  }
  if (options.transform.empty()) return;
  const Affine map = sculpt::affineNamed(options.transform, "--transform");
  if (follows)
    append(sculpt::TransformCommand{{}, sculpt::matrixOf(map)});
  else
    log.header.base = sculpt::mappedShape(log.header.base, map, "--transform");
}

}  // namespace

int runRetarget(const RetargetOptions& options) {
  const retarget::Method method = [&] {
    try {
      return retarget::methodNamed(options.method);
    } catch (const InputError& error) {
      throw InputError(fmt::format("--method: {}", error.what()));
    }
  }();
  const Execution execution = executionOf(options.common);
  sculpt::StrokeLog log = readLogNoting(options.log);
  refuseStampList(log, options.log, "retarget");
  for (sculpt::Command& command : log.commands) {
    auto* stroke = std::get_if<sculpt::StrokeCommand>(&command);
    if (!stroke) continue;
    stroke->method = method;
    stroke->outcome.reset();
  }
  changeBase(log, options, method);
  Output output(options.common);

  nlohmann::ordered_json strokes = nlohmann::ordered_json::array();
  std::size_t points = 0, misses = 0, stamps = 0;
  double seconds = 0;
  std::vector<std::pair<std::size_t, sculpt::NodeId>> nodes;  // command and its node
  sculpt::ReplayOptions replaying;
  replaying.file = options.log;
  replaying.step = [&](std::size_t i, const sculpt::CommandReport& report) {
    const auto* stroke = std::get_if<sculpt::StrokeCommand>(&log.commands[i]);
    if (!stroke) return;
    nodes.emplace_back(i, report.node);
    const std::size_t count = stroke->stroke.points.size();
    strokes.push_back({{"line", log.lines[i]},
                       {"node", static_cast<std::uint32_t>(report.node)},
                       {"points", count},
                       {"misses", report.misses},
                       {"pieces", report.pieces},
                       {"stamps", report.primitivesAdded},
                       {"seconds", report.seconds}});
    points += count;
    misses += report.misses;
    stamps += report.primitivesAdded;
    seconds += report.seconds;
  };
  const sculpt::Document document = replayNoting(log, replaying, execution);
  // The history knows the outcomes that have to be recorded.
  for (const auto& [index, node] : nodes) log.commands[index] = document.history().command(node);
  sculpt::writeLog(options.out, log);

  const std::string hash = hexHash(document.model().stateHash(execution));
  output.say(
      fmt::format("{}: {} strokes by {}, {} points, {} of them misses, {} stamps, {:.3f} s, state {}\n",
                  options.out, grouped(nodes.size()), options.method, grouped(points), grouped(misses),
                  grouped(stamps), seconds, hash));
  output.finish({{"method", options.method},
                 {"strokes", strokes},
                 {"overall",
                  {{"strokes", nodes.size()},
                   {"points", points},
                   {"misses", misses},
                   {"stamps", stamps},
                   {"seconds", seconds},
                   {"state_hash", hash}}}});
  return 0;
}

}  // namespace restroke::cli
