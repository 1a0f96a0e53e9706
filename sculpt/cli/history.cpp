// restroke history: the tree of a log, moves of its cursor, and edits of the tree (SPEC S8). Each of these
// appends one line to the log; what follows from it is found first, so that a log can always be replayed.

#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "implicit/atomic_file.h"
#include "implicit/errors.h"
#include "sculpt/base_change.h"
#include "sculpt/cli/commands.h"
#include "sculpt/cli/history_views.h"
#include "sculpt/cli/replaying.h"
#include "sculpt/cli/words.h"

namespace restroke::cli {

namespace {

using sculpt::Extent;
using sculpt::NodeId;

/// Stamps depend on the samples only where a method looks at them.
bool needsSamples(const sculpt::StrokeLog& log) {
  using retarget::Method;
  for (const sculpt::Command& command : log.commands) {
    const auto* stroke = std::get_if<sculpt::StrokeCommand>(&command);
    if (stroke && stroke->method != Method::Exact && stroke->method != Method::Fixed &&
        stroke->method != Method::Mapped)
      return true;
  }
  return false;
}

/// Replayed with as few samples as give the same stamps.
sculpt::Document replayLightly(sculpt::StrokeLog& log, const HistoryCommandOptions& options) {
  if (!needsSamples(log)) log.header.density = 1e-6f;
  return replayNoting(log, {.file = options.log}, executionOf(options.common));
}

void show(const HistoryCommandOptions& options, sculpt::StrokeLog& log) {
  Output output(options.common);
  std::optional<AtomicFile> svg;
  if (!options.svg.empty()) svg.emplace(options.svg);
  const sculpt::Document document = replayLightly(log, options);
  if (svg) {
    svg->write(treeSvg(document.history()));
    svg->commit();
  }
  output.say(treeText(document.history()));
  output.finish(treeJson(document.history()));
}

NodeId nodeNamed(const HistoryCommandOptions& options, const std::string& text, const std::string& what) {
  std::uint32_t number = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || error != std::errc{} || rest != text.data() + text.size())
    throw InputError(
        fmt::format("history {}: {} is \"{}\", but must be the number of a node (history show "
                    "numbers them)",
                    options.action, what, text));
  return NodeId{number};
}

sculpt::Command commandNamed(const HistoryCommandOptions& options) {
  const std::string& action = options.action;
  const auto takesNone = [&](bool given, const char* what) {
    if (given)
      throw InputError(fmt::format("history {}: {} is given, but has no meaning here", action, what));
  };
  const bool places = action == "move" || action == "copy";
  takesNone(!places && !options.to.empty(), "--to");
  takesNone(!places && options.single, "--single");
  takesNone(action != "cancel" && action != "restore" && options.branch, "--branch");
  takesNone(action != "base" && !options.repair.empty(), "--repair");
  takesNone(!options.svg.empty(), "--svg");
  if (action == "undo" || action == "redo") {
    takesNone(!options.argument.empty(), "an argument");
    if (action == "undo") return sculpt::UndoCommand{};
    return sculpt::RedoCommand{};
  }
  if (action == "base")
    return sculpt::BaseCommand{
        {}, sculpt::shapeNamed(options.argument, repairNamed(options.repair), "history base", Output::note)};
  if (action == "transform")
    return sculpt::TransformCommand{
        {}, sculpt::matrixOf(sculpt::affineNamed(options.argument, "history transform"))};
  const NodeId node = nodeNamed(options, options.argument, "the node");
  if (action == "goto") return sculpt::GotoCommand{{}, node};
  if (action == "cancel")
    return sculpt::CancelCommand{{}, node, options.branch ? Extent::Branch : Extent::Single};
  if (action == "restore")
    return sculpt::RestoreCommand{{}, node, options.branch ? Extent::Branch : Extent::Single};
  const NodeId to = nodeNamed(options, options.to, "--to");
  const Extent extent = options.single ? Extent::Single : Extent::Branch;
  if (action == "move") return sculpt::MoveCommand{{}, node, to, extent};
  return sculpt::CopyCommand{node, to, extent};
}

/// What became of the log, in words.
std::string sayingOf(const HistoryCommandOptions& options, const sculpt::History& history, NodeId before,
                     std::size_t nodesBefore) {
  const std::uint32_t cursor = sculpt::indexOf(history.cursor());
  const std::string& action = options.action;
  std::string text;
  if (action == "cancel" || action == "restore")
    text = fmt::format("node {}{} is {}", options.argument, options.branch ? " with its branch" : "",
                       action == "cancel" ? "cancelled" : "restored");
  else if (action == "move")
    text = fmt::format("node {}{} follows node {}", options.argument,
                       options.single ? " alone" : " with its branch", options.to);
  else if (action == "copy")
    text = history.size() == nodesBefore + 1
               ? fmt::format("a copy of node {}, node {}, follows node {}", options.argument, nodesBefore,
                             options.to)
               : fmt::format("copies of node {} and its branch, nodes {} to {}, follow node {}",
                             options.argument, nodesBefore, history.size() - 1, options.to);
  else if (action == "base" || action == "transform")
    text =
        fmt::format("node {} {}", cursor, action == "base" ? "brings another base" : "transforms the base");
  const std::string where =
      history.cursor() == before
          ? fmt::format("the cursor is at node {}", cursor)
          : fmt::format("the cursor went from node {} to node {}", sculpt::indexOf(before), cursor);
  return text.empty() ? where : text + "; " + where;
}

void change(const HistoryCommandOptions& options, sculpt::StrokeLog& log) {
  sculpt::Command command = commandNamed(options);
  Output output(options.common);
  nlohmann::ordered_json json{{"action", options.action}};
  std::string saying;
  const auto report = [&](const sculpt::History& history, NodeId before, std::size_t nodesBefore) {
    json["from"] = sculpt::indexOf(before);
    json["cursor"] = sculpt::indexOf(history.cursor());
    json["nodes"] = history.size();
    saying = fmt::format("{}: {}", options.log, sayingOf(options, history, before, nodesBefore));
  };
  const bool moves = options.action == "undo" || options.action == "redo" || options.action == "goto";
  try {
    if (moves && !needsSamples(log)) {
      // Nothing can go wrong and nothing is to be recorded: no shape is needed.
      sculpt::History history = sculpt::historyOf(log, options.log);
      const NodeId before = history.cursor();
      history.edit(command);
      report(history, before, history.size());
    } else {
      sculpt::Document document = replayLightly(log, options);
      const NodeId before = document.history().cursor();
      const std::size_t nodesBefore = document.history().size();
      sculpt::CommandReport done = document.apply(command);
      report(document.history(), before, nodesBefore);
      if (sculpt::Consequences* consequences = sculpt::consequencesOf(command))
        consequences->recasts = std::move(done.recasts);
      json["retargeted"] = done.retargeted;
      json["changed"] = done.changed;
      json["notes"] = done.notes;
      if (done.retargeted > 0)
        saying += fmt::format("; {} cast anew, {} of them changed", plural(done.retargeted, "stroke"),
                              done.changed);
      for (const std::string& note : done.notes) Output::note(note);
    }
  } catch (const InputError& error) {
    const std::string_view sentence = error.what();
    if (sentence.starts_with(options.log)) throw;  // it is a line of the log that is wrong
    throw InputError(fmt::format("{}: {}", options.log, sentence));
  }
  sculpt::appendToLog(options.log, command);
  output.say(saying + "\n");
  output.finish(json);
}

}  // namespace

int runHistory(const HistoryCommandOptions& options) {
  constexpr std::string_view kActions[] = {"show",    "undo", "redo", "goto", "cancel",
                                           "restore", "move", "copy", "base", "transform"};
  if (std::find(std::begin(kActions), std::end(kActions), options.action) == std::end(kActions))
    throw InputError(
        fmt::format("history: \"{}\" is not an action, but must be show, undo, redo, goto, cancel, "
                    "restore, move, copy, base or transform",
                    options.action));
  sculpt::StrokeLog log = readLogNoting(options.log);
  refuseStampList(log, options.log, "history");
  if (options.action == "show")
    show(options, log);
  else
    change(options, log);
  return 0;
}

}  // namespace restroke::cli
