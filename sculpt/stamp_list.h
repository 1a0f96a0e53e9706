#pragma once
// Stamp lists: spheres in model units as plain text, without cameras.

#include <string_view>

#include "sculpt/stroke_log.h"

namespace restroke::sculpt {

/// Reads a stamp list: one line `B x y z r` (the base), then for each stroke `S sign count` (1 adds, -1
/// carves) and `count` lines `x y z r`. CR LF line ends, blank lines at the end and a missing last newline
/// are accepted. The strokes become FixedCommands; the density is densityFor(base). Throws InputError that
/// names `file` and the line.
[[nodiscard]] StrokeLog parseStampList(std::string_view text, std::string_view file);

/// Samples per square model unit that give a base about 100,000 of them, with two significant digits.
[[nodiscard]] float densityFor(const implicit::Shape& base);

}  // namespace restroke::sculpt
