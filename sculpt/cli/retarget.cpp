// restroke retarget: the strokes of a log on another base, each cast anew from its recorded input (SPEC S7).

#include <map>
#include <nlohmann/json.hpp>

#include "implicit/errors.h"
#include "sculpt/base_change.h"
#include "sculpt/cli/commands.h"
#include "sculpt/cli/output.h"
#include "sculpt/cli/replaying.h"
#include "sculpt/cli/stroke_comparison.h"
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
  const sculpt::Document before =
      sculpt::replay(log, {.file = options.log, .document = {.keepTrails = true}}, execution);
  for (sculpt::Command& command : log.commands) {
    if (auto* stroke = std::get_if<sculpt::StrokeCommand>(&command)) {
      stroke->method = method;
      stroke->outcome.reset();
    } else if (sculpt::Consequences* consequences = sculpt::consequencesOf(command)) {
      consequences->recasts.clear();
    }
  }
  changeBase(log, options, method);
  Output output(options.common);

  struct Stroke {
    std::size_t index;  // of its command
    std::size_t pieces;
    double seconds;
  };
  std::map<sculpt::NodeId, Stroke> drawn;
  double seconds = 0;
  sculpt::ReplayOptions replaying{
      .file = options.log, .document = {.keepTrails = true}, .step = {}, .record = &log};
  replaying.step = [&](std::size_t i, const sculpt::CommandReport& report) {
    seconds += report.seconds;
    if (std::holds_alternative<sculpt::StrokeCommand>(log.commands[i]))
      drawn[report.node] = {i, report.pieces, report.seconds};
    for (const std::string& note : report.notes) Output::note(note);
  };
  const sculpt::Document document = replayNoting(log, replaying, execution);
  sculpt::writeLog(options.out, log);

  const StrokeComparison comparison(before, document, options, execution);
  nlohmann::ordered_json strokes = nlohmann::ordered_json::array();
  std::size_t points = 0, misses = 0, stamps = 0;
  for (const auto& [node, stroke] : drawn) {
    const sculpt::NodeResult result = document.history().result(node);
    const std::size_t count =
        std::get<sculpt::StrokeCommand>(log.commands[stroke.index]).stroke.points.size();
    nlohmann::ordered_json one{
        {"line", log.lines[stroke.index]}, {"node", sculpt::indexOf(node)}, {"points", count},
        {"misses", result.misses},         {"pieces", stroke.pieces},       {"stamps", result.stamps},
        {"seconds", stroke.seconds}};
    one["measures"] = comparison.of(node);
    strokes.push_back(std::move(one));
    points += count;
    misses += result.misses;
    stamps += result.stamps;
  }
  const nlohmann::ordered_json measures = comparison.overall();
  const std::string hash = hexHash(document.model().stateHash(execution));
  output.say(
      fmt::format("{}: {} strokes by {}, {} points, {} of them misses, {} stamps, {:.3f} s, state {}\n",
                  options.out, grouped(drawn.size()), options.method, grouped(points), grouped(misses),
                  grouped(stamps), seconds, hash));
  output.say(comparison.text());
  output.finish({{"method", options.method},
                 {"strokes", strokes},
                 {"overall",
                  {{"strokes", drawn.size()},
                   {"points", points},
                   {"misses", misses},
                   {"stamps", stamps},
                   {"seconds", seconds},
                   {"state_hash", hash},
                   {"measures", measures}}}});
  return 0;
}

}  // namespace restroke::cli
