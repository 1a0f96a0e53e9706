#include "sculpt/cli/history_views.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>

#include "implicit/errors.h"
#include "sculpt/base_change.h"
#include "sculpt/cli/output.h"

namespace restroke::cli {

namespace {

using sculpt::History;
using sculpt::HistoryTree;
using sculpt::NodeId;
using sculpt::NodeKind;

/// What is said of a node.
struct NodeText {
  NodeKind kind = NodeKind::Stroke;
  bool carves = false;
  std::string method;      ///< of a stroke
  std::size_t points = 0;  ///< of a stroke
  std::string shape;       ///< of a base
};

NodeText textOf(const History& history, NodeId node) {
  NodeText text;
  text.kind = history.kind(node);
  const sculpt::Command command = history.command(node);
  if (const auto* stroke = std::get_if<sculpt::StrokeCommand>(&command)) {
    text.carves = stroke->brush.mode == sculpt::Mode::Carve;
    text.method = retarget::nameOf(stroke->method);
    text.points = stroke->stroke.points.size();
  } else if (const auto* fixed = std::get_if<sculpt::FixedCommand>(&command)) {
    text.carves = fixed->mode == sculpt::Mode::Carve;
  } else if (const auto* base = std::get_if<sculpt::BaseCommand>(&command)) {
    text.shape = base->base.isSphere() ? "sphere" : base->base.volume()->volume().kind().name;
  }
  return text;
}

char markOf(const NodeText& text) {
  switch (text.kind) {
    case NodeKind::Base:
      return 'b';
    case NodeKind::Transform:
      return 't';
    default:
      return text.carves ? '-' : '+';
  }
}

std::string lineOf(const History& history, NodeId node) {
  const NodeText text = textOf(history, node);
  const bool cancelled = history.tree().isCancelled(node);
  std::string line = fmt::format("{} {}", cancelled ? 'x' : markOf(text), sculpt::indexOf(node));
  if (text.kind == NodeKind::Base) {
    line += fmt::format(" base becomes a {}", text.shape);
  } else if (text.kind == NodeKind::Transform) {
    line += " base is transformed";
  } else {
    const sculpt::NodeResult result = history.result(node);
    line += text.kind == NodeKind::Fixed ? std::string(" fixed stamps")
                                         : fmt::format(" {}, {}", text.method, plural(text.points, "point"));
    line += fmt::format(", {}", result.stamps == 0 ? "no stamps" : plural(result.stamps, "stamp"));
    if (result.misses > 0) line += fmt::format(", {}", plural(result.misses, "miss"));
  }
  if (cancelled) line += " (cancelled)";
  return line;
}

std::vector<NodeId> childrenOf(const HistoryTree& tree, NodeId node) {
  std::vector<NodeId> children;
  for (NodeId child = tree.firstChild(node); child != sculpt::kRootNode; child = tree.nextSibling(child))
    children.push_back(child);
  return children;
}

}  // namespace

std::string treeText(const History& history) {
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
    out += entry.node == sculpt::kRootNode
               ? fmt::format("{} o 0 base\n", cursor)
               : fmt::format("{} {}{}\n", cursor, entry.lead, lineOf(history, entry.node));
    const std::vector<NodeId> next = childrenOf(history.tree(), entry.node);
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

nlohmann::ordered_json treeJson(const History& history) {
  nlohmann::ordered_json nodes = nlohmann::ordered_json::array();
  nodes.push_back({{"node", 0}, {"parent", nullptr}, {"kind", "base"}, {"cancelled", false}});
  for (std::uint32_t i = 1; i < history.size(); ++i) {
    const NodeId node{i};
    const NodeText text = textOf(history, node);
    nlohmann::ordered_json one{{"node", i}, {"parent", sculpt::indexOf(history.parent(node))}};
    if (text.kind == NodeKind::Base) {
      one["kind"] = "base";
      one["shape"] = text.shape;
    } else if (text.kind == NodeKind::Transform) {
      one["kind"] = "transform";
      one["matrix"] = std::get<sculpt::TransformCommand>(history.command(node)).matrix;
    } else {
      const bool fixed = text.kind == NodeKind::Fixed;
      one["kind"] = fixed ? "fixed" : "stroke";
      one["mode"] = text.carves ? "carve" : "add";
      one["method"] = fixed ? "fixed" : text.method;
      one["points"] = text.points;
      one["stamps"] = history.result(node).stamps;
      one["misses"] = history.result(node).misses;
    }
    one["cancelled"] = history.tree().isCancelled(node);
    nodes.push_back(std::move(one));
  }
  return {{"cursor", sculpt::indexOf(history.cursor())}, {"nodes", nodes}};
}

std::string treeSvg(const History& history) {
  constexpr int kStep = 44, kRow = 48, kIcon = 30, kMargin = 24;
  // Elder branches above younger ones; the eldest goes on in its parent's row.
  struct Place {
    int column = 0, row = 0;
  };
  std::vector<Place> places(history.size());
  int rows = 0, columns = 0;
  std::vector<NodeId> order;
  std::vector<std::pair<NodeId, bool>> open{{sculpt::kRootNode, true}};  // and whether it goes on in a row
  while (!open.empty()) {
    const auto [node, goesOn] = open.back();
    open.pop_back();
    order.push_back(node);
    Place& place = places[sculpt::indexOf(node)];
    if (node != sculpt::kRootNode) {
      const Place& parent = places[sculpt::indexOf(history.parent(node))];
      place = {parent.column + 1, goesOn ? parent.row : ++rows};
      columns = std::max(columns, place.column);
    }
    const std::vector<NodeId> next = childrenOf(history.tree(), node);
    for (std::size_t i = next.size(); i-- > 0;) open.emplace_back(next[i], i == 0);
  }

  std::vector<bool> onPath(history.size(), false);
  for (const NodeId node : history.pathTo(history.cursor())) onPath[sculpt::indexOf(node)] = true;
  const auto x = [&](NodeId node) { return kMargin + places[sculpt::indexOf(node)].column * kStep; };
  const auto y = [&](NodeId node) { return kMargin + places[sculpt::indexOf(node)].row * kRow; };
  const int width = 2 * kMargin + columns * kStep + kIcon, height = 2 * kMargin + rows * kRow + kIcon;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"DejaVu Sans, sans-serif\" font-size=\"12\" text-anchor=\"middle\">\n"
      "<title>History tree: {2} nodes, cursor at node {3}</title>\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"#3a3f47\"/>\n",
      width, height, history.size(), sculpt::indexOf(history.cursor()));
  const auto out = std::back_inserter(svg);
  constexpr int kHalf = kIcon / 2;
  for (const NodeId node : order) {
    if (node == sculpt::kRootNode) continue;
    const NodeId parent = history.parent(node);
    const bool active = onPath[sculpt::indexOf(node)];
    fmt::format_to(out, "<path d=\"M{} {}V{}H{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"/>\n",
                   x(parent) + kHalf, y(parent) + kHalf, y(node) + kHalf, x(node) + kHalf,
                   active ? "#f2f2f2" : "#9aa3ad", active ? 3.5 : 1.5);
  }
  for (const NodeId node : order) {
    const char *fill = "#ffffff", *ink = "#22262b";
    std::string title = "0 base";
    bool cancelled = false;
    if (node != sculpt::kRootNode) {
      const NodeText text = textOf(history, node);
      const bool changesBase = text.kind == NodeKind::Base || text.kind == NodeKind::Transform;
      fill = changesBase ? "#3f9b57" : text.carves ? "#3565c4" : "#cf3b32";
      ink = "#ffffff";
      title = lineOf(history, node).substr(2);
      cancelled = history.tree().isCancelled(node);
    }
    fmt::format_to(out, "<g><title>{}</title>", title);
    // The tree shines through a cancelled icon, not the line behind it.
    fmt::format_to(out, "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"5\" fill=\"#3a3f47\"/>",
                   x(node), y(node), kIcon, kIcon);
    fmt::format_to(
        out,
        "<g opacity=\"{}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"5\" fill=\"{}\" "
        "stroke=\"#ffffff\" stroke-width=\"1\"/><text x=\"{}\" y=\"{}\" fill=\"{}\">{}</text></g>",
        cancelled ? "0.35" : "1", x(node), y(node), kIcon, kIcon, fill, x(node) + kHalf, y(node) + kHalf + 4,
        ink, sculpt::indexOf(node));
    if (node == history.cursor())
      fmt::format_to(out,
                     "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"8\" fill=\"none\" "
                     "stroke=\"#ffd21f\" stroke-width=\"4\"/>",
                     x(node) - 4, y(node) - 4, kIcon + 8, kIcon + 8);
    svg += "</g>\n";
  }
  return svg + "</svg>\n";
}

}  // namespace restroke::cli
