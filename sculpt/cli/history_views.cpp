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

namespace {

// The drawing's measures, in its own units.
constexpr int kStep = 44, kRow = 50, kIcon = 30, kHalf = kIcon / 2, kGap = (kStep - kIcon) / 2, kMargin = 24;
/// Rows of more icons than this are folded: wider drawings are unreadable on a page.
constexpr int kColumns = 24;
constexpr const char *kPaper = "#3a3f47", *kRootFill = "#ffffff", *kAddFill = "#cf3b32",
                     *kCarveFill = "#3565c4", *kBaseFill = "#3f9b57", *kCursorFrame = "#ffd21f";
constexpr const char* kCancelledOpacity = "0.35";

/// Where an icon stands: column and row.
struct Place {
  int column = 0, row = 0;
};

struct Layout {
  std::vector<NodeId> order;  ///< parents before children
  std::vector<Place> places;  ///< by node
  int columns = 1, rows = 1;

  [[nodiscard]] int x(NodeId node) const { return kMargin + places[sculpt::indexOf(node)].column * kStep; }
  [[nodiscard]] int y(NodeId node) const { return kMargin + places[sculpt::indexOf(node)].row * kRow; }
};

/// Elder branches above younger ones; the eldest goes on in its parent's row. Where a row is full, it goes on
/// below itself, as text does.
Layout laidOut(const HistoryTree& tree) {
  struct Open {
    NodeId node;
    bool goesOn;  // in its parent's row
  };
  Layout layout;
  layout.places.resize(tree.size());
  std::vector<int> foldsTo(tree.size(), 1);  // the column to which the node's row comes back
  std::vector<Open> open{{sculpt::kRootNode, true}};
  while (!open.empty()) {
    const auto [node, goesOn] = open.back();
    open.pop_back();
    layout.order.push_back(node);
    if (node != sculpt::kRootNode) {
      const std::uint32_t up = sculpt::indexOf(tree.parent(node)), i = sculpt::indexOf(node);
      Place place{layout.places[up].column + 1, layout.places[up].row};
      foldsTo[i] = foldsTo[up];
      const bool full = place.column == kColumns;
      if (full) place.column = foldsTo[i];
      if (full || !goesOn) place.row = layout.rows++;
      // Not too far to the right: what is folded there would be folded again and again.
      if (!goesOn) foldsTo[i] = std::min(place.column, kColumns / 2);
      layout.places[i] = place;
      layout.columns = std::max(layout.columns, place.column + 1);
    }
    const std::vector<NodeId> next = childrenOf(tree, node);
    for (std::size_t i = next.size(); i-- > 0;) open.push_back({next[i], i == 0});
  }
  return layout;
}

/// From a node to its child. It turns between columns and between rows, where no icons are.
std::string link(const Layout& layout, NodeId parent, NodeId child, bool active) {
  const int fromX = layout.x(parent) + kIcon, fromY = layout.y(parent) + kHalf;
  const int toX = layout.x(child), toY = layout.y(child) + kHalf;
  const std::string style =
      active ? "stroke=\"#f2f2f2\" stroke-width=\"3.5\"" : "stroke=\"#9aa3ad\" stroke-width=\"1.5\"";
  std::string way = fmt::format("M{} {}", fromX, fromY);
  if (fromY != toY) way += fmt::format("H{}", fromX + kGap);
  if (toX < fromX) way += fmt::format("V{}H{}", toY - kRow / 2, toX - kGap);
  if (fromY != toY) way += fmt::format("V{}", toY);
  return fmt::format("<path d=\"{}H{}\" fill=\"none\" stroke-linejoin=\"round\" {}/>\n", way, toX, style);
}

struct Icon {
  int x = 0, y = 0;
  const char *fill = kRootFill, *ink = "#ffffff";
  std::string text = {};
  bool cancelled = false, cursor = false;
};

std::string drawn(const Icon& icon) {
  std::string svg = fmt::format(
      "<g opacity=\"{}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"5\" fill=\"{}\" "
      "stroke=\"#ffffff\" stroke-width=\"1\"/>",
      icon.cancelled ? kCancelledOpacity : "1", icon.x, icon.y, kIcon, kIcon, icon.fill);
  if (!icon.text.empty())
    svg += fmt::format("<text x=\"{}\" y=\"{}\" fill=\"{}\">{}</text>", icon.x + kHalf, icon.y + kHalf + 4,
                       icon.ink, icon.text);
  svg += "</g>";
  if (icon.cursor)
    svg += fmt::format(
        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"8\" fill=\"none\" stroke=\"{}\" "
        "stroke-width=\"4\"/>",
        icon.x - 4, icon.y - 4, kIcon + 8, kIcon + 8, kCursorFrame);
  return svg;
}

/// What icons mean, in one line whose widths are those of its words.
constexpr int kLegendWidth = 700;
std::string legend(int y) {
  struct Entry {
    Icon icon;
    const char* words;
    int width;
  };
  const Entry entries[] = {{{.fill = kRootFill}, "base", 90},
                           {{.fill = kAddFill}, "adds", 90},
                           {{.fill = kCarveFill}, "carves", 100},
                           {{.fill = kBaseFill}, "changes the base", 170},
                           {{.fill = kAddFill, .cancelled = true}, "cancelled", 120},
                           {{.fill = kPaper, .cursor = true}, "cursor", 100}};
  std::string svg = "<g text-anchor=\"start\" fill=\"#dfe3e8\">\n";
  int x = kMargin;
  for (const auto& [icon, words, width] : entries) {
    Icon placed = icon;
    placed.x = x;
    placed.y = y;
    svg += drawn(placed) +
           fmt::format("<text x=\"{}\" y=\"{}\">{}</text>\n", x + kIcon + 10, y + kHalf + 4, words);
    x += width;
  }
  return svg + "</g>\n";
}

}  // namespace

std::string treeSvg(const History& history) {
  const Layout layout = laidOut(history.tree());
  std::vector<bool> onPath(history.size(), false);
  for (const NodeId node : history.pathTo(history.cursor())) onPath[sculpt::indexOf(node)] = true;
  const int width = std::max(2 * kMargin + (layout.columns - 1) * kStep + kIcon, kLegendWidth);
  const int legendY = kMargin + layout.rows * kRow + 10, height = legendY + kIcon + kMargin;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"DejaVu Sans, sans-serif\" font-size=\"13\" text-anchor=\"middle\">\n"
      "<title>History tree: {2} nodes, cursor at node {3}</title>\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"{4}\"/>\n",
      width, height, history.size(), sculpt::indexOf(history.cursor()), kPaper);
  // The path to the cursor lies on top of the others.
  for (const bool active : {false, true})
    for (const NodeId node : layout.order)
      if (node != sculpt::kRootNode && onPath[sculpt::indexOf(node)] == active)
        svg += link(layout, history.parent(node), node, active);
  for (const NodeId node : layout.order) {
    Icon icon{.x = layout.x(node),
              .y = layout.y(node),
              .ink = "#22262b",
              .text = fmt::format("{}", sculpt::indexOf(node)),
              .cursor = node == history.cursor()};
    std::string title = "0 base";
    if (node != sculpt::kRootNode) {
      const NodeText text = textOf(history, node);
      const bool changesBase = text.kind == NodeKind::Base || text.kind == NodeKind::Transform;
      icon.fill = changesBase ? kBaseFill : text.carves ? kCarveFill : kAddFill;
      icon.ink = "#ffffff";
      icon.cancelled = history.tree().isCancelled(node);
      title = lineOf(history, node).substr(2);
    }
    svg += fmt::format("<g><title>{}</title>{}</g>\n", title, drawn(icon));
  }
  return svg + legend(legendY) + "</svg>\n";
}

}  // namespace restroke::cli
