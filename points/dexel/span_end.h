#pragma once
// Where a line enters or leaves a solid (SPEC D3, R2).

#include <cstdint>
#include <span>
#include <vector>

#include "points/dexel/packed_normal.h"

namespace restroke::points {

/// Numbers operations in the order in which they were applied; 0 is the initial solid.
enum class OperationId : std::uint32_t { Initial = 0, None = 0xffffffffu };

/// One end of a span.
struct SpanEnd {
  float depth = 0;  ///< parameter along the line, model units on lines of unit direction
  /// Outward normal of the solid; its flag: an operation has cut or added here.
  PackedNormal normal = 0;
  /// The operation that owns the material on the inner side, and the one that cleared the outer side; None
  /// where nothing ever did. Where an operation makes an end within a span (or a gap), what it does not know
  /// is taken from the nearer end of that span (or gap).
  OperationId inner = OperationId::None, outer = OperationId::None;

  [[nodiscard]] bool isCut() const { return (normal & kPackedFlag) != 0; }
  bool operator==(const SpanEnd&) const = default;
};

/// The ends of one line's spans: strictly ascending depths, entry and exit in turn.
using LineEnds = std::vector<SpanEnd>;

/// A stretch of a tool along a line, with the tool's own outward normals.
struct ToolSpan {
  float enter = 0, exit = 0;
  PackedNormal enterNormal = 0, exitNormal = 0;
};

/// Fills or clears a stretch of a line, in place; false when nothing changed. The span's normals are those
/// that the solid gets at its ends. General in the same way as applyToLine.
bool changeLine(LineEnds& line, const ToolSpan& span, bool fills, OperationId id);

enum class DexelOperation : std::uint8_t { Union, Subtraction, Intersection };

/// Applies a tool's spans (ascending, apart from each other) to a line, in place; false when nothing
/// changed. General interval operations (SPEC D4): a subtraction may split a span, a union may add one or
/// merge several. New ends take the tool's normal (turned around by a subtraction) and the flag. A span of
/// no length is never made; where an end of the tool meets one of the solid's, the solid's stays.
bool applyToLine(LineEnds& line, std::span<const ToolSpan> tool, DexelOperation operation, OperationId id);

}  // namespace restroke::points
