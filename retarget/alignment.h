#pragma once
// The motion of a shape, or of a part of it, estimated from its surfels before and after (SPEC S10): a
// stroke's camera moves along, and the stroke finds the part on which it was drawn.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "implicit/geometry/similarity.h"
#include "points/surfel.h"

namespace restroke::retarget {

/// A point of a surface.
struct OrientedPoint {
  Point position{0};     ///< model units
  Vec3 normal{0, 0, 1};  ///< unit, out of the shape
  bool operator==(const OrientedPoint&) const = default;
};

[[nodiscard]] std::vector<OrientedPoint> orientedPoints(std::span<const points::Surfel> surfels);

/// Those of the points that lie within `radius` (model units) of a point of the stroke: the part of the shape
/// that carries it. In the points' order. O(points * stroke).
[[nodiscard]] std::vector<OrientedPoint> patchAround(std::span<const OrientedPoint> points,
                                                     std::span<const Point> stroke, double radius);

enum class AlignmentMode : std::uint8_t {
  Whole,  ///< both are whole shapes: each must be found in the other
  Patch,  ///< `before` is a part, to be found somewhere in `after`, whose rest may have changed in any way
};

struct AlignmentOptions {
  AlignmentMode mode = AlignmentMode::Whole;
  /// Points of each side that are matched in the last steps, at least 50; each is matched against at most ten
  /// times as many of the other side. More cost in proportion and err less.
  std::uint32_t points = 2000;
  std::uint64_t seed = 1;  ///< of the choice of these points
};

enum class AlignmentVerdict : std::uint8_t {
  Found,
  Symmetric,    ///< two motions that take the stroke to different places fit almost equally well
  Featureless,  ///< the shape slides along itself (ball, plane, shaft): no motion is better than its
                ///< neighbours
  NoFit,        ///< no motion takes the one onto the other
};

/// "found", "symmetric", "featureless", "no fit".
[[nodiscard]] std::string_view nameOf(AlignmentVerdict verdict);

struct Alignment {
  AlignmentVerdict verdict = AlignmentVerdict::NoFit;
  /// Takes `before` onto `after`. With Symmetric and Featureless the smallest motion of those that fit, with
  /// NoFit the one that fits best: for inspection, not for use.
  Similarity motion;
  double rms = 0;          ///< how far the one's points are from the other's surface, model units of `after`
  double relativeRms = 0;  ///< the same, divided by the RMS radius of the moved `before`
  /// Smallest eigenvalue of the normalised Hessian: 0 where the shape slides along itself, about 0.1 for a
  /// shape that holds every motion firmly.
  double firmness = 0;
  /// RMS of the best motion elsewhere, divided by that of this one; 1 for symmetric shapes. Infinite where
  /// there is none.
  double rivalRatio = 0;
  std::string reason;  ///< one sentence
};

/// Estimates the similarity motion that takes `before` onto `after`.
///
/// Where every point of `before` is in `after`, bit for bit, nothing has moved: the motion is the identity,
/// whatever the shape, and the verdict is Found. (In mode Whole they must be as many, too.)
///
/// The order of the points matters little but not nothing, their density not. Scales from 1/4 to 4 are
/// looked for. Mirror images are different shapes. Fewer than 50 points on a side: NoFit. Not finite: throws
/// InputError. Equal arguments, equal result on one machine; other machines and compilers may differ in the
/// last digits, so that whoever keeps a log records the outcome (DESIGN invariant 5). One thread.
///
/// Not promised: that the motion is right where `after` is another shape than `before` all over; that a rival
/// which the search did not try is noticed. retarget/README.md has the measured errors and costs.
[[nodiscard]] Alignment alignSurfels(std::span<const OrientedPoint> before,
                                     std::span<const OrientedPoint> after,
                                     const AlignmentOptions& options = {});

}  // namespace restroke::retarget
