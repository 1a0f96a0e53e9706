#pragma once
// How well a stroke was retargeted (SPEC X2).

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "retarget/polylines.h"
#include "retarget/trail.h"

namespace restroke::retarget {

/// One stroke, as a method put it on a shape. What is null is not measured.
struct RetargetedStroke {
  const Trail& result;
  /// Where each place of the stroke truly belongs, with the normal there; a miss where it belongs nowhere.
  const Trail* truth = nullptr;
  /// Where the stroke was when it was first applied.
  const Trail* original = nullptr;
  /// The camera that the stroke was drawn through.
  Camera camera;
  /// The shape that it was put on.
  const points::SurfelModel* model = nullptr;
  implicit::Prefix prefix = {};
  Execution execution = {};
};

/// What was observed of one stroke; from it Measures are made, of one stroke or of several together.
///
/// Compared are places, one by one: those at input points (whole `along`) of the truth, else of the original,
/// else of the result itself. The result is taken at the same place (Trail::at). A place that is a hit on one
/// side only is counted, and is in no figure that compares the two. With neither truth nor original every
/// place is expected to be a hit.
struct StrokeObservations {
  std::size_t places = 0;
  std::size_t expected = 0;              ///< hits of the truth, else of the original, else all places
  std::size_t missed = 0;                ///< expected, but the result misses
  std::size_t gained = 0;                ///< hits where a miss was expected
  std::vector<double> errors;            ///< distances from the true places, model units
  std::vector<double> normalErrors;      ///< degrees
  double trueLength = 0;                 ///< of the true curve
  double comparedTrueLength = 0;         ///< of its steps whose ends are hits on both sides
  double comparedLength = 0;             ///< of the same steps of the result
  std::optional<double> hausdorff = {};  ///< of the curves; nothing where one has no hits
  std::vector<double> surfaceDistances;  ///< of all hits of the result, model units
  std::vector<double> stretches;         ///< distances of neighbours, result to original
  std::vector<double> drifts;            ///< pixels between where it was drawn and where it now is seen
  std::size_t hidden = 0;                ///< hits behind another part of the surface
  std::size_t behind = 0;                ///< hits behind the camera
};

/// O(places) casts; with a model it draws up a tree of the prefix's surfels.
[[nodiscard]] StrokeObservations observe(const RetargetedStroke& stroke);

/// What a measure is of which nothing was observed: no truth, no hit on both sides, a single point where two
/// are needed.
inline constexpr double kNotObserved = std::numeric_limits<double>::quiet_NaN();

struct Measures {
  std::size_t strokes = 0, places = 0;
  std::size_t missed = 0, gained = 0;
  double missRate = kNotObserved;  ///< missed / expected hits

  // Against known truth, in model units; "OfLength" in lengths of the true curve (of several strokes, their
  // mean).
  double errorRms = kNotObserved, errorMax = kNotObserved;
  double errorRmsOfLength = kNotObserved, errorMaxOfLength = kNotObserved;
  double hausdorff = kNotObserved, hausdorffOfLength = kNotObserved;
  /// (length - true length) / true length, over the steps compared.
  double lengthDrift = kNotObserved;
  double normalErrorMean = kNotObserved, normalErrorMax = kNotObserved;  ///< degrees

  // Without.
  double surfaceDistanceRms = kNotObserved, surfaceDistanceMax = kNotObserved;  ///< as SurfaceDistance says
  /// 1: neighbours are as far apart as they were.
  double stretchMedian = kNotObserved, stretchMin = kNotObserved, stretchMax = kNotObserved;
  double driftRms = kNotObserved, driftMax = kNotObserved;  ///< pixels, of hits before the camera
  std::size_t hidden = 0, behind = 0;
};

/// Of the strokes together: every place counts the same, the greatest is the greatest of all, hausdorff that
/// of the worst stroke.
[[nodiscard]] Measures summarise(std::span<const StrokeObservations> strokes);

/// The trail's hits as a curve, a piece for each run between misses.
[[nodiscard]] Polylines curveOf(const Trail& trail);

}  // namespace restroke::retarget
