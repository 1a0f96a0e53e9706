#pragma once
// What a stroke log is made of (DESIGN invariants 7 and 8). One Command is one line.

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "implicit/primitive.h"
#include "retarget/method.h"
#include "retarget/stroke.h"
#include "sculpt/brush.h"

namespace restroke::sculpt {

/// First line of a log: all that its commands rest on.
struct LogHeader {
  int version = 1;
  std::string unit = "mm";  ///< mm, cm or m: what one model unit means in exports; changes no coordinate
  float density = 8000;     ///< samples per square model unit, finite, > 0
  float grid = 0x1p-16f;    ///< stamp centres are rounded to multiples of it (model units, a power of two)
  implicit::Shape base;     ///< the shape before the first stroke: one positive primitive
};

/// A stroke, as drawn. Re-projected whenever it is applied, from this input (SPEC S7).
struct StrokeCommand {
  retarget::Stroke stroke;
  Brush brush;
  retarget::Method method = retarget::Method::Exact;
  /// The recorded outcome, when the method is one whose result depends on the machine. Used by replay, remade
  /// by --recompute.
  std::optional<StrokeOutcome> outcome;
};

/// Primitives without input or camera (of a stamp list, or set by a script). They stay where they are.
struct FixedCommand {
  Mode mode = Mode::Add;
  std::vector<implicit::Sphere> stamps = {};
  std::vector<implicit::Shape> shapes = {};  ///< after the stamps: volumes of any other kind
  [[nodiscard]] std::size_t size() const { return stamps.size() + shapes.size(); }
};

struct UndoCommand {};
struct RedoCommand {};

using Command = std::variant<StrokeCommand, FixedCommand, UndoCommand, RedoCommand>;

}  // namespace restroke::sculpt
