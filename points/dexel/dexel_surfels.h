#pragma once
// What a tri-dexel looks like: surfels from the ends of its spans (SPEC D7).

#include <cstdint>
#include <optional>
#include <vector>

#include "implicit/execution.h"
#include "points/dexel/tri_dexel.h"
#include "points/surfel.h"

namespace restroke::points {

/// Which ends become surfels.
enum class DexelEnds : std::uint8_t {
  /// To be looked at: of three families, each part of the surface by those that see it well (axis and normal
  /// at least half as close as for the best family).
  Seen,
  All  ///< to be exported: every end there is
};

struct DexelSurfelOptions {
  /// Of one family only, 0 to 2, all its ends; nothing: of all three. A family alone has no ends on faces
  /// along its lines, and too few on faces nearly so.
  std::optional<int> family = std::nullopt;
  DexelEnds ends = DexelEnds::Seen;
};

/// A surfel for each end: its place and normal. The discs of neighbouring lines overlap, and those beside an
/// edge of the solid reach it: the three families together leave no gaps in what is no thinner than a cell.
///
/// `primitive` and `sign` are those of the operation that made the end, so that kindOf (images/scene.h)
/// colours what subtractions have cut as carved, what unions have added as added, and what is left of the
/// initial solid (operation 0) as base. A model without operations knows cut from uncut only: cut ends are
/// negative. By family, row and column; the same bits for any number of threads. Throws InputError when the
/// family is out of range. O(lines + ends).
[[nodiscard]] std::vector<Surfel> surfelsOf(const TriDexel& model, const DexelSurfelOptions& options = {},
                                            const Execution& execution = {});

}  // namespace restroke::points
