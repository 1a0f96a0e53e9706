#pragma once
// Pen strokes that other programs recorded become a stroke log on a base that fills the drawing's area.

#include <cstdint>
#include <filesystem>
#include <memory>

#include "sculpt/stroke_log.h"

namespace restroke::sculpt {

enum class PenMode : std::uint8_t {
  Add,
  Carve,
  Alternate
};  ///< Alternate: add, carve, add, ... stroke by stroke

struct PenOptions {
  implicit::Shape base;  ///< the shape that is drawn on
  PenMode mode = PenMode::Add;
  Trace trace = Trace::Stamps;                       ///< of the brush
  std::shared_ptr<const implicit::Volume> tip = {};  ///< of the brush; null: a ball
  /// Of the brush, model units, > 0; 0 takes kDefaultRadius of the half diagonal of the base's bounding box.
  float radius = 0;
  float density = 0;  ///< of the header, samples per square model unit, > 0; 0 takes densityFor(base)
  /// The base's silhouette spans this much of the drawing's shorter side, > 0; 0 takes kDefaultFill.
  float fill = 0;
};

/// Part of the base's half diagonal that a brush's radius is: 0.087 for a sphere of radius 1 (half diagonal
/// sqrt 3).
inline constexpr float kDefaultRadius = 0.05f;

/// A base that just fits into the drawing (1) leaves the drawing's corners, and much of an oblong one, beside
/// it; one that covers it all (sqrt 2 of a square) squeezes strokes at its middle. Measured on pen drawings
/// in sculpt/README.md.
inline constexpr float kDefaultFill = 1.25f;

/// Reads a JSON object {"width": W, "height": H, "strokes": [{"points": [[x, y, seconds, pressure], ...]},
/// ...]}; x to the right, y down, in pixels; pressure 0 to 1. Other keys are ignored: such files carry notes
/// of many kinds. The camera looks along -z at the base and has the drawing's size as its viewport. Positions
/// are rounded to 1/16 pixel, times to milliseconds since the stroke's first point, pressures to 1/1023;
/// halves are rounded up. Brush: the default one with the options' radius; method: exact.
///
/// Throws InputError "FILE: PATH is VALUE, but must be RULE" for anything else: a missing or wrong field, a
/// size that is not 1 to 65,536, no strokes, a stroke without points, coordinates beyond a million pixels,
/// times that run backwards.
[[nodiscard]] StrokeLog readPenStrokes(const std::filesystem::path& file, const PenOptions& options = {});

}  // namespace restroke::sculpt
