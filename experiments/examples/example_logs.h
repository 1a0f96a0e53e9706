#pragma once
// The logs that ship with the project, drawn by program. Same program, same bytes, on every machine.

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "sculpt/stroke_log.h"

namespace restroke::experiments {

/// A lion's face in eight strokes with the stamps of the paper's Table 2: 454, 1, 1, 1, 1, 1, 96, 1 (SPEC
/// S12).
[[nodiscard]] sculpt::StrokeLog table2Log();

/// The paper's scale: 108 strokes, 3,426 stamps in all, about 280,000 surfels (SPEC S11). Pen-like strokes
/// with pressure, added and carved, from twelve cameras around the sphere. The seed decides where they go,
/// never how many there are.
[[nodiscard]] sculpt::StrokeLog paperScaleLog(std::uint64_t seed = 1);

/// A rabbit's head in the spirit of the paper's figure 10 (a) and (b): the foundation, then carved eyes and
/// mouth and a nose (SPEC S9).
[[nodiscard]] sculpt::StrokeLog rabbitLog();

/// A state that the worked example of the paper's figure 10 passes through.
struct Figure10Stage {
  char name = 'a';             ///< a to e, as in the paper
  std::size_t commands = 0;    ///< of the log's, from the first: what is there when they are done
  sculpt::NodeId cursor{};     ///< where they leave the cursor
  std::string_view what = {};  ///< in a few words
  bool operator==(const Figure10Stage&) const = default;
};
struct Figure10 {
  sculpt::StrokeLog log;
  std::array<Figure10Stage, 5> stages;
};
/// The paper's figure 10 as one log (SPEC S9): a rabbit-like head (a); its face carved and added (b); all of
/// that undone, and another series added in its place (c); the undone strokes copied behind it and redone
/// (d); a series in the middle cancelled, and the order of strokes changed (e).
[[nodiscard]] Figure10 figure10();
/// A line for each stage, as in figure10-stages.txt.
[[nodiscard]] std::string stagesText(const Figure10& figure);

/// One of each kind of volume (SPEC S13) on a plate, and beside each the hollow that it carves.
[[nodiscard]] sculpt::StrokeLog galleryLog();

/// "table2", "paper-scale", "rabbit", "figure10" or "gallery". Throws InputError that lists the names.
[[nodiscard]] sculpt::StrokeLog exampleLog(std::string_view name);

}  // namespace restroke::experiments
