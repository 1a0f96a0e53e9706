#pragma once
// The least-squares step of an alignment: the small motion that brings matched points together along their
// normals (Ceres).

#include <span>

#include "implicit/geometry/similarity.h"

namespace restroke::retarget::alignment {

/// Two points that are taken for the same place of the surface.
struct Match {
  DVec3 from{0};      ///< of `before`, moved so far
  DVec3 to{0};        ///< of `after`
  DVec3 normal{0};    ///< unit, half way between the two normals
  double cosine = 1;  ///< of the angle between them
  double weight = 1;
};

/// Where and in what units a step is computed, so that its seven unknowns count alike.
struct StepFrame {
  DVec3 center{0};    ///< of the moved `before`
  double radius = 1;  ///< its RMS radius
};

/// The motion, to be done after those so far, that minimises the sum of weight * (normal . (moved(from) -
/// to))^2. At most `iterations` Levenberg-Marquardt steps; the identity where there is nothing to go by.
[[nodiscard]] Similarity fittingStep(std::span<const Match> matches, const StepFrame& frame, int iterations);

/// Smallest eigenvalue of the mean of J^T J over the matches, J the derivative of a match's distance with
/// respect to turning (radians), scaling (logarithm) and moving (radii): how firmly the matches hold the
/// motion.
[[nodiscard]] double firmnessOf(std::span<const Match> matches, const StepFrame& frame);

}  // namespace restroke::retarget::alignment
