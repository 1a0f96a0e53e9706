#pragma once
// Operations replayed on lines, line by line and in parallel (SPEC R5, R6).

#include <span>
#include <vector>

#include "points/dexel/dexels.h"
#include "points/dexel/line_family.h"
#include "points/dexel/refine/history.h"
#include "points/dexel/refine/zone.h"

namespace restroke::points {

/// A family of lines, each cut to where it is in a zone: to depths from[line] <= to[line], or, where it
/// misses the zone, from = +infinity and to = -infinity. By rows, as Dexels::lineAt has it.
struct LinesInZone {
  LineFamily family;
  std::vector<float> from, to;
  /// Lines that meet the zone.
  [[nodiscard]] std::size_t count() const;
};
[[nodiscard]] LinesInZone linesInZone(const LineFamily& family, const Zone& zone,
                                      const Execution& execution = {});

/// What the lines hold after the operations `ids` (ascending, each once; Initial stands for the initial
/// solid), which are replayed in order, each cut to the zone first. So nothing beyond the zone matters, the
/// references of ends included: with all operations that meet the zone the result is that of all operations,
/// bit for bit.
///
/// Ends are those of change_line.h; where the solid goes on beyond the zone there is an end at its border:
/// the normal along the line, the flag clear, `outer` None. The same bits for any number of threads.
/// O(lines that the operations' bounds meet, on the family's raster).
[[nodiscard]] Dexels replay(const DexelHistory& history, std::span<const OperationId> ids,
                            const LinesInZone& lines, const Execution& execution = {});

/// The same on lines that already hold something: `dexels` (of the family's size, cut to the zone) is changed
/// in place. Borders are left as the operations make them: closeAtBorders when all is done.
void replayOn(Dexels& dexels, const DexelHistory& history, std::span<const OperationId> ids,
              const LinesInZone& lines, const Execution& execution = {});

/// Ends at the borders of the zone, as replay promises them. O(lines).
void closeAtBorders(Dexels& dexels, const LinesInZone& lines);

/// The same result as replay by its definition: each line asks each operation. O(lines x operations).
[[nodiscard]] Dexels replayPlainly(const DexelHistory& history, std::span<const OperationId> ids,
                                   const LinesInZone& lines, const Execution& execution = {});

}  // namespace restroke::points
