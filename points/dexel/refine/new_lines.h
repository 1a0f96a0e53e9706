#pragma once
// Lines for a zone: denser, in another direction, fewer, up to one a pixel and beyond (SPEC R3).

#include <array>
#include <optional>
#include <vector>

#include "points/dexel/dexel_grid.h"
#include "points/dexel/line_family.h"
#include "points/dexel/refine/zone.h"

namespace restroke::points {

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

}  // namespace restroke::points
