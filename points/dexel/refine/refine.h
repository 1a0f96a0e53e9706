#pragma once
// Refining a tri-dexel where it is looked at: new lines, and on them only the operations that matter there
// (SPEC R3-R6). After N. Montana, M. Monteil, R. Nosenzo, A. Lieutier, "Designing a modeled volume
// represented by dexels", US 2013/0116983 (the "document").
//
// What each method guarantees, of the lines within the zone:
//
//   all       The model: every operation is replayed. O(operations x lines), or, culled by bounds,
//             O(operations) and then those that meet the zone.
//   clusters  The same bits: the operations whose bounds meet the zone, from clusters that were made
//             beforehand. O(what meets the zone).
//   touching  Every operation that ever changed one of the model's lines through the zone (widened by a
//             cell), and meets the zone, is replayed on the initial solid. Wrong only within operations that
//             lie between those lines, none of which any of the model's own lines has noticed. Needs a model
//             that keeps its lines' histories (Dexels::Options::history).
//   ends      Replays the operations on both sides of each end in the zone (widened by a cell) from nothing,
//             and then corrects what the model's cells know better: in a cell of its grid whose twelve edges
//             are all inside the solid the line is inside, and where all are outside it is outside. So a
//             hollow or a grain within such a cell is lost. Elsewhere nothing is promised: operations that no
//             end in the zone refers to are missed, and what they would have changed is wrong. Time follows
//             the ends in the zone, not the history.
//   document  As the document has it: the operation that last trimmed each end in the zone is replayed on an
//             approximation: where these only take away, on an upper one (all cells that are not outside),
//             so that the result contains the solid; where they only add, on a lower one (the cells that are
//             inside), so that the solid contains it; both but for what is thinner than a cell. The document
//             does not say what is to be done where both happen; here the lower one is taken, and nothing is
//             promised.

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "points/dexel/refine/line_replay.h"
#include "points/dexel/refine/new_lines.h"
#include "points/dexel/tri_dexel.h"

namespace restroke::points {

enum class RefineMethod : std::uint8_t { Document, Ends, Touching, Clusters, All };
inline constexpr RefineMethod kRefineMethods[] = {RefineMethod::Document, RefineMethod::Ends,
                                                  RefineMethod::Touching, RefineMethod::Clusters,
                                                  RefineMethod::All};
[[nodiscard]] std::string_view nameOf(RefineMethod method);

struct RefineOptions {
  RefineMethod method = RefineMethod::Ends;
  /// Ends and lines are asked in the zone widened by so many of the model's cells, >= 0 (Ends, Touching; 0
  /// for Document).
  double widening = 1;
  /// Ends: correct by the model's cells.
  bool corrected = true;
  /// All: each line asks each operation, as the definition has it (no result depends on it).
  bool plain = false;
  /// What replays lines, `replay` (line_replay.h) where it is empty; GlLineReplay does it on a graphics card.
  LineReplayer replayer = {};
};

struct RefinedFamily {
  LinesInZone lines;
  Dexels dexels;
};

struct RefinedModel {
  std::vector<RefinedFamily> families;
  std::vector<OperationId> ids;  ///< that were replayed, ascending
  /// Seconds.
  struct Times {
    double collect = 0;      ///< finding the operations
    double approximate = 0;  ///< the model's cells in the zone, and what they correct
    double replay = 0;
    [[nodiscard]] double all() const { return collect + approximate + replay; }
  } times;
  /// Inside the zone: mean over the families of the length in the solid times the lines' spacing squared;
  /// nothing for rays, which spread.
  [[nodiscard]] std::optional<double> volume() const;
};

/// Of the families' sizes and all their ends, bit for bit. O(lines + ends).
[[nodiscard]] std::uint64_t stateHash(const RefinedModel& refined);

/// The model on a zone's grid, whose three families were refined. Coordinates are those of the grid's frame.
[[nodiscard]] TriDexel modelOn(const ZoneGrid& grid, RefinedModel refined);

/// A model with its past; both must outlive the call, and the history be the document's.
struct RefineSource {
  const TriDexelDocument& document;
  const DexelHistory& history;
};
/// Where, and on which lines.
struct RefineTarget {
  const Zone& zone;
  std::vector<LineFamily> lines;
};

/// The model on new lines, within the zone. Throws InputError when the method needs what the model does not
/// keep (operations at its ends, histories of its lines), or an option is out of range. The same bits for any
/// number of threads.
[[nodiscard]] RefinedModel refine(const RefineSource& source, const RefineTarget& target,
                                  const RefineOptions& options = {}, const Execution& execution = {});

}  // namespace restroke::points
