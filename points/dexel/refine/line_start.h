#pragma once
// What is decided of a line before any step. Internal to points/dexel.

#include <algorithm>

#include "points/dexel/refine/line_painter.h"
#include "points/dexel/refine/model_cells.h"
#include "points/dexel/refine/steps_on_line.h"

namespace restroke::points {

/// Starts a line: undecided, but for what cells know of it (null: nothing is known).
inline void startLine(LinePainter& painter, const CutLine& line, const ModelCells* known) {
  if (!(line.from < line.to)) {
    painter.clear();
    return;
  }
  if (!known) {
    painter.start(line.from, line.to);
    return;
  }
  painter.startPieces();
  float begin = line.from;
  known->forStretches(line.ray, {static_cast<double>(line.from), static_cast<double>(line.to)},
                      [&](ModelCells::Kind kind, double, double exit) {
                        const float end = std::min(static_cast<float>(exit), line.to);
                        if (!(begin < end)) return;
                        painter.startPiece(begin, kind == ModelCells::Kind::Mixed ? LinePainter::kUndecided
                                                  : kind == ModelCells::Kind::Full
                                                      ? LinePainter::kKnownFull
                                                      : LinePainter::kKnownEmpty);
                        begin = end;
                      });
  painter.endPieces(line.to);
}

}  // namespace restroke::points
