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
//   touching  Every operation that ever changed one of the model's lines through the zone, and meets the
//             zone, is replayed on the initial solid. Wrong only within operations that lie between those
//             lines, none of which any of the model's own lines has noticed. Needs a model that keeps its
//             lines' histories (Dexels::Options::history).
//   ends      Replays the operations on both sides of each end in the zone (widened by a cell) from nothing,
//             and then corrects what the model's cells know better: in a cell of its grid whose twelve edges
//             are all inside the solid the line is inside, and where all are outside it is outside. Elsewhere
//             nothing is promised: operations that no end in the zone refers to are missed, and what they
//             would have changed is wrong, by no more than those cells through whose edges the surface
//             passes. Time follows the ends in the zone, not the history.
//   document  As the document has it: the operation that last trimmed each end in the zone is replayed on an
//             approximation: where these only take away, on an upper one (all cells that are not outside),
//             so that the result contains the solid; where they only add, on a lower one (the cells that are
//             inside), so that the solid contains it; both but for what is thinner than a cell. The document
//             does not say what is to be done where both happen; here the lower one is taken, and nothing is
//             promised.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "points/dexel/refine/line_replay.h"

namespace restroke::points {

enum class RefineMethod : std::uint8_t { Document, Ends, Touching, Clusters, All };
inline constexpr RefineMethod kRefineMethods[] = {RefineMethod::Document, RefineMethod::Ends,
                                                  RefineMethod::Touching, RefineMethod::Clusters,
                                                  RefineMethod::All};
[[nodiscard]] std::string_view nameOf(RefineMethod method);

/// How new lines are laid; at most one of resolution, cell and among; with none, kDefaultLines.
struct NewLines {
  /// Lines along the zone's longest side, or of a frustum along the longer side of its picture; 1 to
  /// kMostLines.
  std::optional<int> resolution = std::nullopt;
  /// From line to line, model units (of a frustum refused), > 0.
  std::optional<double> cell = std::nullopt;
  /// Of an upright box or a ball: the lines of a model in the zone (the others are dropped), and between two
  /// of them times - 1 others along each axis; 1 to kMostLines.
  struct Among {
    DexelGrid grid;
    int times = 1;
  };
  std::optional<Among> among = std::nullopt;
  /// Of a frustum: one line a pixel of its camera.
  bool perPixel = false;
  /// Of a box or a ball: one family along this direction, in place of three along the zone's axes.
  std::optional<DVec3> direction = std::nullopt;
};

/// A grid in a frame of its own: that of a turned box has its origin in the box's middle, any other is the
/// model's.
struct ZoneGrid {
  DexelGrid grid;
  DVec3 origin{0};
  std::array<DVec3, 3> axes{DVec3{1, 0, 0}, DVec3{0, 1, 0}, DVec3{0, 0, 1}};
  [[nodiscard]] bool isTurned() const { return axes[0].x != 1 || axes[1].y != 1 || axes[2].z != 1; }
  [[nodiscard]] DVec3 directionInModel(DVec3 v) const {
    return v.x * axes[0] + v.y * axes[1] + v.z * axes[2];
  }
  [[nodiscard]] DVec3 inModel(DVec3 p) const { return origin + directionInModel(p); }
};

/// The lines of a grid along an axis, 0 to 2: column i and row j are those of DexelGrid, and a depth is the
/// coordinate along the axis in the grid's frame.
[[nodiscard]] LineFamily familyOf(const ZoneGrid& zone, int axis);

/// The grid of the three families for a box or a ball; nothing for a frustum, and where one direction is
/// asked for. Throws InputError as newLines.
[[nodiscard]] std::optional<ZoneGrid> gridFor(const Zone& zone, const NewLines& options);

/// The lines for a zone: the three families of its grid (depths are coordinates of the grid's frame), one
/// along a direction, or a frustum's rays. Throws InputError for options that are out of range or do not fit
/// the zone, and for lines that are too many.
[[nodiscard]] std::vector<LineFamily> newLines(const Zone& zone, const NewLines& options);

struct RefineOptions {
  RefineMethod method = RefineMethod::Ends;
  /// Ends are collected from the zone widened by so many of the model's cells, >= 0 (Ends; 0 for Document).
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
