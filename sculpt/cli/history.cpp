// restroke history: the tree of a log, and moves of its cursor.

#include <nlohmann/json.hpp>
#include <vector>

#include "implicit/errors.h"
#include "sculpt/cli/commands.h"
#include "sculpt/cli/replaying.h"

namespace restroke::cli {

namespace {

using sculpt::NodeId;

std::uint32_t numberOf(NodeId node) {
  return static_cast<std::uint32_t>(node);
}

/// What one line of the tree says.
struct NodeText {
  bool fixed = false, carves = false;
  std::string method;  ///< "fixed" for fixed stamps
  std::size_t points = 0;
};

NodeText textOf(const sculpt::History& history, NodeId node) {
  const sculpt::Command command = history.command(node);
  if (const auto* stroke = std::get_if<sculpt::StrokeCommand>(&command))
    return {.carves = stroke->brush.mode == sculpt::Mode::Carve,
            .method = std::string(retarget::nameOf(stroke->method)),
            .points = stroke->stroke.points.size()};
  return {.fixed = true,
          .carves = std::get<sculpt::FixedCommand>(command).mode == sculpt::Mode::Carve,
          .method = "fixed"};
}

std::string plural(std::size_t count, const char* word) {
  return fmt::format("{} {}{}", grouped(count), word,
                     count == 1 ? "" : (std::string_view(word) == "miss" ? "es" : "s"));
}

/// Strokes stand below each other; only where the tree branches is there a step to the right.
std::string treeText(const sculpt::History& history) {
  std::vector<std::vector<NodeId>> children(history.size());
  for (std::uint32_t i = 1; i < history.size(); ++i)
    children[numberOf(history.parent(NodeId{i}))].push_back(NodeId{i});
  struct Entry {
    NodeId node;
    std::string lead, below;  // before this node, and before what follows it
  };
  std::string out;
  std::vector<Entry> open{{sculpt::kRootNode, "", ""}};
  while (!open.empty()) {
    const Entry entry = std::move(open.back());
    open.pop_back();
    const char* cursor = entry.node == history.cursor() ? ">" : " ";
    if (entry.node == sculpt::kRootNode) {
      out += fmt::format("{} o 0 base\n", cursor);
    } else {
      const NodeText text = textOf(history, entry.node);
      const sculpt::NodeResult result = history.result(entry.node);
      out += fmt::format("{} {}{} {} {}", cursor, entry.lead, text.carves ? "-" : "+", numberOf(entry.node),
                         text.method);
      if (!text.fixed) out += fmt::format(", {}", plural(text.points, "point"));
      out += fmt::format(", {}", result.stamps == 0 ? "no stamps" : plural(result.stamps, "stamp"));
      if (result.misses > 0) out += fmt::format(", {}", plural(result.misses, "miss"));
      out += "\n";
    }
    const std::vector<NodeId>& next = children[numberOf(entry.node)];
    for (std::size_t i = next.size(); i-- > 0;) {
      if (next.size() == 1)
        open.push_back({next[i], entry.below, entry.below});
      else if (i + 1 == next.size())
        open.push_back({next[i], entry.below + "└─", entry.below + "  "});
      else
        open.push_back({next[i], entry.below + "├─", entry.below + "│ "});
    }
  }
  return out;
}

nlohmann::ordered_json treeJson(const sculpt::History& history) {
  nlohmann::ordered_json nodes = nlohmann::ordered_json::array();
  nodes.push_back({{"node", 0}, {"parent", nullptr}, {"kind", "base"}});
  for (std::uint32_t i = 1; i < history.size(); ++i) {
    const NodeText text = textOf(history, NodeId{i});
    const sculpt::NodeResult result = history.result(NodeId{i});
    nodes.push_back({{"node", i},
                     {"parent", numberOf(history.parent(NodeId{i}))},
                     {"kind", text.fixed ? "fixed" : "stroke"},
                     {"mode", text.carves ? "carve" : "add"},
                     {"method", text.method},
                     {"points", text.points},
                     {"stamps", result.stamps},
                     {"misses", result.misses}});
  }
  return {{"cursor", numberOf(history.cursor())}, {"nodes", nodes}};
}

/// Stamps depend on the samples only where a method looks at them and no outcome is recorded.
bool needsSamples(const sculpt::StrokeLog& log) {
  for (const sculpt::Command& command : log.commands)
    if (const auto* stroke = std::get_if<sculpt::StrokeCommand>(&command);
        stroke && stroke->method != retarget::Method::Exact && !stroke->outcome)
      return true;
  return false;
}

void show(const HistoryCommandOptions& options, sculpt::StrokeLog log) {
  if (!needsSamples(log)) log.header.density = 1e-6f;
  Output output(options.common);
  const sculpt::Document document = sculpt::replay(log, {.file = options.log}, executionOf(options.common));
  output.say(treeText(document.history()));
  output.finish(treeJson(document.history()));
}

void move(const HistoryCommandOptions& options, const sculpt::StrokeLog& log) {
  const sculpt::History history = sculpt::historyOf(log, options.log);
  const NodeId before = history.cursor();
  const bool undo = options.action == "undo";
  const NodeId after = undo ? history.parent(before) : history.redoTarget(before);
  if (after == before)
    throw InputError(
        fmt::format("{}: {}", options.log, undo ? sculpt::kNothingToUndo : sculpt::kNothingToRedo));
  Output output(options.common);
  sculpt::appendToLog(options.log,
                      undo ? sculpt::Command(sculpt::UndoCommand{}) : sculpt::Command(sculpt::RedoCommand{}));
  output.say(fmt::format("{}: the cursor went from node {} to node {}\n", options.log, numberOf(before),
                         numberOf(after)));
  output.finish({{"from", numberOf(before)}, {"cursor", numberOf(after)}});
}

}  // namespace

int runHistory(const HistoryCommandOptions& options) {
  if (options.action != "show" && options.action != "undo" && options.action != "redo")
    throw InputError(
        fmt::format("history: \"{}\" is not an action, but must be show, undo or redo", options.action));
  sculpt::StrokeLog log = readLogNoting(options.log);
  refuseStampList(log, options.log, "history");
  if (options.action == "show")
    show(options, std::move(log));
  else
    move(options, log);
  return 0;
}

}  // namespace restroke::cli
