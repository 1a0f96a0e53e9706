#pragma once
// What the process holds, and how much there is: whether a size can be tried, and what it took.

#include <cstddef>
#include <optional>

namespace restroke {

/// Bytes of this process in memory now; 0 where the system does not say (/proc/self/status).
[[nodiscard]] std::size_t residentBytes();
/// Most bytes in memory since resetPeak, or since the process began where the peak cannot be reset.
[[nodiscard]] std::size_t peakResidentBytes();
/// Gives freed memory back to the system, and lets the peak begin anew.
void resetPeak();
/// Bytes that can still be had: what the system says is available, or what the control group still allows,
/// whichever is less. Nothing where neither is told.
[[nodiscard]] std::optional<std::size_t> availableBytes();

}  // namespace restroke
