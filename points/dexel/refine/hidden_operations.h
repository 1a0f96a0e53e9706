#pragma once
// Operations of a document without which it is the same (SPEC R7). Internal to points/dexel.
//
// Why a result does not change, on any line. An operation fills or clears the stretches where the line is in
// its solid; whatever it does elsewhere, the line has the ends that it had.
//
// - Without effect: all of the operation's stretch is already what it makes of it, as an earlier operation of
//   the same kind holds it and none of the other kind between them meets it; or it takes away where nothing
//   ever was. The line is the same right after it, to the last bit.
// - Hidden, covered: later operations hold the solid with room to spare. Until they come the line differs
// only
//   within the operation's stretch, as ends outside it depend on what is outside it; each of them makes the
//   inside of its own stretch, borders excluded, what it would have been. So once all have come, nothing is
//   left of the difference: the same depths, normals and flags. (What an end takes over from its neighbours,
//   SpanEnd::inner and outer, may differ.) The later ones may themselves be hidden or covered by still later
//   ones, which then hold this one too.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "implicit/execution.h"
#include "points/dexel/dexel_document.h"

namespace restroke::points {

enum class OperationVerdict : std::uint8_t {
  Needed,         ///< as far as is known
  WithoutEffect,  ///< it changes nothing
  Hidden,         ///< one later operation decides all that it decides
  Covered         ///< several do, together
};

struct HiddenOperations {
  std::vector<OperationVerdict> verdicts;  ///< of document.operations
  std::vector<implicit::Sphere> balls;     ///< hold the solids of document.operations
  /// Of operation i, hidden or covered: the indices covers[coverBegin[i]] to covers[coverBegin[i + 1] - 1] of
  /// the later operations that decide together what it decides; these may be hidden or covered themselves.
  std::vector<std::uint32_t> coverBegin, covers;
};

/// Looks at each operation; those with isKept[i] != 0 are needed, whatever hides them. What is called needed
/// may be hidden nevertheless: solids are known by balls about them, and as what hides only balls and volumes
/// count (implicit::Volume::clearance), of an intersection the outside.
///
/// Containment is to a margin of 2^-18 (volumes: 2^-16) of the greatest coordinate, so that float32 tells
/// borders apart on lines whose depths are less than 16 times the coordinates of the model and its
/// operations.
///
/// The same for any number of threads. O(operations x those that touch the same cluster cell, at most some
/// thousands). Throws InputError as DexelHistory does.
[[nodiscard]] HiddenOperations hiddenOperations(const TriDexelDocument& document,
                                                std::span<const std::uint8_t> isKept,
                                                const Execution& execution = {});

}  // namespace restroke::points
