#pragma once
// Strokes drawn on a bare base, and where they are on it: what every trial with known truth starts from.

#include <memory>
#include <string>
#include <vector>

#include "experiments/retarget.h"
#include "experiments/retarget/bases.h"
#include "points/surfel_model.h"
#include "retarget/trail.h"
#include "sculpt/stroke_log.h"

namespace restroke::experiments {

/// A stroke, and where it met the base.
struct DrawnStroke {
  std::string source;  ///< file
  retarget::Stroke stroke;
  sculpt::Brush brush;
  retarget::Trail trail;  ///< by `exact` on the bare base, with anchors

  /// Where it hit, in order.
  [[nodiscard]] std::vector<Point> hits() const;
};

/// A base with its strokes.
struct Drawing {
  RetargetSubject subject;
  implicit::Shape base;
  std::unique_ptr<const points::SurfelModel> model;  ///< of the base alone
  std::vector<DrawnStroke> strokes;
};

/// A list of one shape. About `samples` surfels.
[[nodiscard]] std::unique_ptr<const points::SurfelModel> modelOf(const implicit::Shape& shape, double samples,
                                                                 const Execution& execution);

/// The trail of a stroke that is cast exactly onto a model of the base alone, with anchors.
[[nodiscard]] retarget::Trail trailOn(const points::SurfelModel& model, const retarget::Stroke& stroke,
                                      const sculpt::Brush& brush);

/// Draws pen strokes, seen from a camera that frames the base.
[[nodiscard]] Drawing drawPens(const RetargetBase& base, const std::vector<std::filesystem::path>& pens,
                               const RetargetOptions& options, const Execution& execution);
/// Draws a log's strokes on its own bare base.
[[nodiscard]] Drawing drawLog(const std::filesystem::path& file, const sculpt::StrokeLog& log,
                              const RetargetOptions& options, const Execution& execution);

}  // namespace restroke::experiments
