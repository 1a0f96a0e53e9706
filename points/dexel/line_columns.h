#pragma once
// The lines of a family as columns of a `.tridexel` file's body (tridexel_file.h has the format). Internal to
// points/dexel.

#include <cstddef>

#include "points/dexel/dexels.h"
#include "points/dexel/file_bytes.h"

namespace restroke::points {

void putLines(ByteWriter& out, const Dexels& dexels);

/// Lines of width x height; operations are at most `lastOperation`. Throws InputError for what breaks a rule.
[[nodiscard]] Dexels getLines(ByteReader& in, int width, int height, std::uint32_t lastOperation);

}  // namespace restroke::points
