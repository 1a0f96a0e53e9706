#pragma once
// Solids that cut or add, one after the other, on the lines of a model (SPEC R8, D4).

#include <span>

#include "implicit/execution.h"
#include "points/dexel/tool_solid.h"
#include "points/dexel/tri_dexel.h"

namespace restroke::points {

/// One application of a solid.
struct SolidStep {
  const ToolSolid* solid = nullptr;
  DexelOperation operation = DexelOperation::Subtraction;
  OperationId id{};
};

/// Applies the steps in order. Where a line meets a solid is computed in double and rounded once; spans that
/// float32 rounds to nothing are left out, and those that it makes touch are one. What a union adds beyond
/// the grid is cut off at its outermost lines: growTo the solids' bounds first. The same bits for any number
/// of threads, and however the steps are divided among calls. O(lines in the solids' bounds), an intersection
/// O(all lines).
void apply(TriDexel& model, std::span<const SolidStep> steps, const Execution& execution = {});

}  // namespace restroke::points
