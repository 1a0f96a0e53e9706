// restroke retarget: the strokes of a log on another base, each cast anew from its recorded input (SPEC S7).

#include <nlohmann/json.hpp>

#include "implicit/errors.h"
#include "sculpt/cli/commands.h"
#include "sculpt/cli/output.h"
#include "sculpt/cli/replaying.h"
#include "sculpt/cli/words.h"

namespace restroke::cli {

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
  if (!options.base.empty())
    log.header.base = sculpt::shapeNamed(options.base, repairNamed(options.repair), "--base", Output::note);
  log.header.base = transformed(log.header.base, options.transform);
  for (sculpt::Command& command : log.commands) {
    auto* stroke = std::get_if<sculpt::StrokeCommand>(&command);
    if (!stroke) continue;
    stroke->method = method;
    stroke->outcome.reset();
  }
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
