#include "points/dexel/span_end.h"

#include <algorithm>
#include <limits>

#include "points/dexel/change_line.h"

namespace restroke::points {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct EndsOfVector {
  LineEnds& ends;
  [[nodiscard]] std::size_t size() const { return ends.size(); }
  [[nodiscard]] float depth(std::size_t i) const { return ends[i].depth; }
  [[nodiscard]] SpanEnd get(std::size_t i) const { return ends[i]; }
  void replace(std::size_t first, std::size_t gone, const SpanEnd* fresh, std::size_t count) {
    const auto at = ends.begin() + static_cast<std::ptrdiff_t>(first);
    if (count > gone)
      ends.insert(at, count - gone, SpanEnd{});
    else
      ends.erase(at, at + static_cast<std::ptrdiff_t>(gone - count));
    std::copy(fresh, fresh + count, ends.begin() + static_cast<std::ptrdiff_t>(first));
  }
};

}  // namespace

bool changeLine(LineEnds& line, const ToolSpan& span, bool fills, OperationId id) {
  return changeStretch(EndsOfVector{line}, span, fills, id);
}

bool applyToLine(LineEnds& line, std::span<const ToolSpan> tool, DexelOperation operation, OperationId id) {
  bool changed = false;
  if (operation != DexelOperation::Intersection) {
    const bool fills = operation == DexelOperation::Union;
    for (const ToolSpan& span : tool) {
      const PackedNormal enter = fills ? span.enterNormal : turnedAround(span.enterNormal);
      const PackedNormal exit = fills ? span.exitNormal : turnedAround(span.exitNormal);
      changed |= changeLine(line, {span.enter, span.exit, enter, exit}, fills, id);
    }
    return changed;
  }
  // What is between the tool's spans is cleared.
  ToolSpan before{.exit = -kInfinity};
  for (const ToolSpan& span : tool) {
    changed |= changeLine(line, {before.exit, span.enter, before.exitNormal, span.enterNormal}, false, id);
    before = span;
  }
  return changeLine(line, {before.exit, kInfinity, before.exitNormal, 0}, false, id) || changed;
}

}  // namespace restroke::points
