#pragma once
// The method "embree": rays against the surfels as oriented discs, then onto the exact surface (SPEC S7).

#include <memory>

#include "retarget/method.h"

namespace restroke::retarget {

/// Builds an Embree scene of the prefix's surfels (DiscScene), O(surfels log surfels), and has it as long as
/// the caster lives; with CasterInput::discs only what has changed since the last caster is built.
///
/// Discs that face away are passed through. A disc hit at ray parameter t says only how far to look: the hit
/// is the first exact crossing (implicit::castRay) in front of t + kDiscReach disc radii. Where there is none
/// (a disc's rim stands out over a silhouette) the ray goes on to the next disc; none left is a miss.
///
/// So every hit equals that of `exact` bit for bit, and wherever `exact` misses this misses too. The two
/// differ in one way only: `exact` may hit where the ray finds no disc, in a gap of the sampling, in a crease
/// between two primitives or on a rim that no disc reaches over, or on a piece of surface too small to hold a
/// sample. Whether a ray meets a disc's rim depends on the instruction set that Embree chooses, therefore the
/// outcome is recorded in the log.
///
/// Throws InputError when Embree cannot be started or has no memory.
[[nodiscard]] std::unique_ptr<Caster> makeEmbreeCaster(const CasterInput& input);

/// How far behind a disc the exact crossing may lie, in radii of the disc along the ray. A disc lies within
/// radius^2 / (2 R) of the sphere of radius R that it is tangent to; seen at a slant that is longer along the
/// ray. Where it is longer than this, the next disc takes over.
inline constexpr double kDiscReach = 4;

}  // namespace restroke::retarget
