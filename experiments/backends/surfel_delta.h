#pragma once
// The difference between two states of the surfels, one stroke apart.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "points/surfel.h"

namespace restroke::experiments {

/// Surfels stand in list order, and a stroke appends primitives, so it takes out some surfels anywhere and
/// adds others at the end. Both contents are held: one to go back, the other to go ahead.
struct SurfelDelta {
  std::vector<std::uint32_t> removedAt;  ///< indices in the state before, increasing
  std::vector<points::Surfel> removed;   ///< what stood there
  std::vector<points::Surfel> added;     ///< at the end of the state after
  [[nodiscard]] bool empty() const { return removed.empty() && added.empty(); }
};

/// applyForward(difference(before, after), before) is `after` for any two states; the delta is small when
/// they are one stroke apart. O(before + after).
[[nodiscard]] SurfelDelta difference(std::span<const points::Surfel> before,
                                     std::span<const points::Surfel> after);

/// Turns the state before into the state after, and back.
void applyForward(const SurfelDelta& delta, std::vector<points::Surfel>& state);
void applyBackward(const SurfelDelta& delta, std::vector<points::Surfel>& state);

/// The delta as zstd bytes (level 3). Fields are stored in columns, index and owner as differences: zstd
/// finds more there than in whole surfels.
[[nodiscard]] std::vector<char> compress(const SurfelDelta& delta);
/// Throws InternalError when the bytes are not what compress() gave.
[[nodiscard]] SurfelDelta decompress(std::span<const char> bytes);

}  // namespace restroke::experiments
