#pragma once
// Operations replayed on lines, line by line and in parallel (SPEC R5, R6).

#include <functional>
#include <span>
#include <vector>

#include "points/dexel/dexels.h"
#include "points/dexel/line_family.h"
#include "points/dexel/refine/history.h"
#include "points/dexel/refine/zone.h"

namespace restroke::points {

/// A family of lines, each cut to where it is in a zone: to depths from[line] < to[line], or, where it
/// misses the zone, from = +infinity and to = -infinity. By rows, as Dexels::lineAt has it.
struct LinesInZone {
  LineFamily family;
  std::vector<float> from, to;
  /// Lines that meet the zone.
  [[nodiscard]] std::size_t count() const;
};
[[nodiscard]] LinesInZone linesInZone(const LineFamily& family, const Zone& zone,
                                      const Execution& execution = {});

class ModelCells;

/// What is known of lines beside the operations; what is not null must outlive the call.
struct ReplayBasis {
  /// What a place is that no operation decides: of the family's size, by depth and normal.
  const Dexels* start = nullptr;
  /// Cells that decide before any operation does: in full ones lines are inside, in empty ones outside.
  const ModelCells* known = nullptr;
};

/// What is replayed; it must outlive the call.
struct ReplayInput {
  const DexelHistory& history;
  /// Ascending, each once; Initial stands for the initial solid.
  std::span<const OperationId> ids;
  ReplayBasis basis = {};
};

/// What the lines hold after the operations. Each counts where it is in the zone, so that nothing beyond it
/// matters: with all operations that meet the zone the result is that of all operations, bit for bit.
///
/// The operations are replayed from the last to the first, each on what none after it has filled or cleared
/// (SPEC S4): what is hidden costs next to nothing, and a line is done when all of it is decided. A place
/// that no operation decides is outside, or as ReplayBasis says.
///
/// Of each end `inner` and `outer` are the operations that decide what is right before and behind it (None:
/// the basis, or none), and the normal is that of the later one; the flag is set where that is an
/// operation. Where the solid goes on beyond the zone there is an end at its border: the normal along the
/// line, the flag clear, `outer` None. Depths are the exact intervals of the operations' solids, in double,
/// rounded once. The same bits for any number of threads. O(lines that the operations' bounds meet on the
/// family's raster, as long as they are not decided).
[[nodiscard]] Dexels replay(const ReplayInput& input, const LinesInZone& lines,
                            const Execution& execution = {});

/// What replays: `replay`, or another engine with the same result (gl/gl_line_replay.h).
using LineReplayer = std::function<Dexels(const ReplayInput&, const LinesInZone&, const Execution&)>;

/// The same result by its definition, of an input without a basis: each line asks each operation. O(lines x
/// operations).
[[nodiscard]] Dexels replayPlainly(const ReplayInput& input, const LinesInZone& lines,
                                   const Execution& execution = {});

}  // namespace restroke::points
