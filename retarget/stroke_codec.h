#pragma once
// Stroke points packed without loss: about two bytes a point instead of sixteen. Format, byte by byte:
// retarget/README.md.

#include <cstdint>
#include <span>
#include <vector>

#include "retarget/stroke.h"

namespace restroke::retarget {

/// Which of the optional channels are packed. A channel that is left out comes back as its default: time 0,
/// pressure kMaxPressure. Which ones were packed stands in the bytes.
struct PackedChannels {
  bool time = true;
  bool pressure = true;
};

/// Appends the packed points to `out`. Any number of points, none included; the order of times does not
/// matter. Throws InputError, and leaves `out` as it was, when a packed value is out of StrokePoint's range
/// or there are 2^31 points or more. Same points, same bytes. O(n), some tens of nanoseconds a point.
void encodePoints(std::span<const StrokePoint> points, std::vector<std::uint8_t>& out,
                  PackedChannels channels = {});

/// Unpacks what one encodePoints call wrote at the beginning of `in`, and moves `in` behind it. Throws
/// InputError, and leaves `in` as it was, when the bytes end early or are not what encodePoints could have
/// written a value of. Takes at most 128 bytes of memory for each byte of `in`, whatever the bytes say. O(n).
[[nodiscard]] std::vector<StrokePoint> decodePoints(std::span<const std::uint8_t>& in);

}  // namespace restroke::retarget
