#pragma once
// How a stretch of a line is filled or cleared, wherever the line's ends are kept. Internal to points/dexel.

#include <cstddef>

#include "points/dexel/span_end.h"

namespace restroke::points {

/// Fills or clears `span` on a line; false when nothing changed. `Line` has size(), depth(i), get(i),
/// set(i, end), and replace(first, gone, fresh, count): ends first .. first + gone - 1 give way to `count`
/// others (at most 2).
///
/// The ends before the stretch stay, and those after it; between them there is a new one at each border
/// across which the side changes. The number of ends before a place tells the side there: odd is inside.
template <class Line>
bool changeStretch(Line&& line, const ToolSpan& span, bool fills, OperationId id) {
  if (!(span.enter < span.exit)) return false;
  // The parity of the numbers of ends after which the line is already as it shall be.
  const std::size_t done = fills ? 1 : 0, size = line.size();
  // An end at the border that turns the line to what it shall be: where the stretch begins it stays, where it
  // ends it goes.
  const auto countTo = [&](float depth, std::size_t n) {
    while (n < size && line.depth(n) < depth) ++n;
    return n < size && line.depth(n) == depth && (n + 1) % 2 == done ? n + 1 : n;
  };
  const std::size_t first = countTo(span.enter, 0), last = countTo(span.exit, first);
  if (first == last && first % 2 == done) return false;

  const auto newEnd = [&](std::size_t next, float depth, PackedNormal normal) {
    SpanEnd end{depth, normal | kPackedFlag, id, id};
    // Of the two ends around the place the nearer one tells what is on the other side.
    OperationId beyond = OperationId::None;
    if (size > 0) {
      const bool takesAfter =
          next == 0 || (next < size && line.depth(next) - depth < depth - line.depth(next - 1));
      const SpanEnd near = line.get(takesAfter ? next : next - 1);
      beyond = fills ? near.outer : near.inner;
    }
    (fills ? end.outer : end.inner) = beyond;
    return end;
  };
  SpanEnd fresh[2];
  std::size_t count = 0;
  if (first % 2 != done) fresh[count++] = newEnd(first, span.enter, span.enterNormal);
  if (last % 2 != done) fresh[count++] = newEnd(last, span.exit, span.exitNormal);
  line.replace(first, last - first, fresh, count);
  return true;
}

}  // namespace restroke::points
