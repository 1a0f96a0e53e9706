#pragma once
// Which operations the lines of a tri-dexel know of in a zone (SPEC R4). Internal to points/dexel.

#include <cstddef>
#include <vector>

#include "points/dexel/refine/history.h"
#include "points/dexel/refine/zone.h"
#include "points/dexel/tri_dexel.h"

namespace restroke::points {

/// Which references of an end count.
enum class EndReferences : std::uint8_t {
  Trimming,  ///< of the two the later one: the operation that last trimmed the segment
  Both       ///< that of the material on the inner side, and what cleared the outer side
};

/// The operations of the ends that lie in the zone, ascending. `ids`: how many there are (DexelHistory). The
/// model must keep operations. O(ends in the zone's bounds + ids / 64).
[[nodiscard]] std::vector<OperationId> referencesIn(const TriDexel& model, const Zone& zone,
                                                    EndReferences references, std::size_t ids);

/// Where operations are wanted, and where lines are asked for them: the zone, or somewhat more.
struct AskedZone {
  const Zone& wanted;
  const Zone& asked;
};
/// The operations that ever changed one of the model's lines that pass through the zone, and whose bounds
/// meet it, ascending; of runs that histories name, the members that meet it. The document's model must keep
/// the histories of its lines. O(entries of those lines).
[[nodiscard]] std::vector<OperationId> changesIn(const TriDexelDocument& document, const AskedZone& zone,
                                                 const DexelHistory& history);

}  // namespace restroke::points
