#pragma once
// Histories made to measure what refinement loses: the same seed, the same operations everywhere.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "implicit/execution.h"
#include "implicit/primitive.h"
#include "points/dexel/dexel_document.h"

namespace restroke::experiments {

/// What a model is, and what was done to it. Positive primitives are added, negative ones carved.
struct RefineHistory {
  std::string name;
  std::vector<implicit::Primitive> initial;     ///< the initial solid, in order
  std::vector<implicit::Primitive> operations;  ///< the first is operation 1
};

/// Holds all that is positive: what the model's lines have to cover.
[[nodiscard]] Box boundsOf(const RefineHistory& history);

/// Where balls are strewn, and what is there before.
enum class Ground : std::uint8_t {
  Block,    ///< a cube of side 1 from the origin, centres all over it
  Ball,     ///< a ball of radius 1 about the origin, centres all over it
  Nothing,  ///< nothing; centres all over the cube
};

/// Balls at random places, their radii evenly from a half to three halves of the mean one.
struct BallsOptions {
  std::size_t operations = 20'000;
  /// Mean number of operations that cover a point of the ground, > 0.
  double density = 8;
  double additions = 0.5;  ///< part of them, 0 to 1; the others carve
  Ground ground = Ground::Block;
  std::uint64_t seed = 1;
};
/// The mean radius that gives the density, model units.
[[nodiscard]] double meanRadiusOf(const BallsOptions& options);
/// How many operations of a mean radius give a density on that ground, at least 1.
[[nodiscard]] std::size_t operationsFor(double density, double meanRadius, Ground ground);
[[nodiscard]] RefineHistory strewnBalls(const BallsOptions& options);

/// Removals only, as by milling: a ball cutter in rows over a block of side 1 and height 1/2, first leaving
/// material, then down to a surface with hills and hollows; about `operations` of them, each a place of the
/// cutter, 0.3 radii after the last, the rows 0.7 radii apart.
[[nodiscard]] RefineHistory milledBlock(std::size_t operations, std::uint64_t seed);

/// What is thinner than the lines are apart.
enum class Thin : std::uint8_t {
  Plates,  ///< thin along one axis, 5 cells along the others
  Rods,    ///< thin across, 5 cells along an axis
  Grains   ///< balls
};
inline constexpr Thin kThins[] = {Thin::Plates, Thin::Rods, Thin::Grains};
[[nodiscard]] const char* nameOf(Thin thin);

struct ThinOptions {
  Thin thin = Thin::Rods;
  double thickness = 0.5;  ///< in cells, > 0
  int resolution = 64;     ///< of the lines whose cells these are: the model is a cube of side 1
  /// In the middles between the lines, across which they are thin; else anywhere.
  bool between = false;
  std::uint64_t seed = 1;
};
/// Thin features apart from each other, all along the axes: carved into one half of a cube of side 1, and
/// added in the other half, which is hollow.
[[nodiscard]] RefineHistory thinFeatures(const ThinOptions& options);

/// How a history grows when the zone stays where it is.
enum class Growth : std::uint8_t {
  /// The zone has the same operations, however many there are elsewhere: 430 that are near it, in time
  /// evenly among the others.
  Elsewhere,
  Deeper,  ///< balls of one mean radius, strewn over the same block: ever more of them on each other
  Finer    ///< balls that become smaller, so that each point is covered by 8 of them
};
inline constexpr Growth kGrowths[] = {Growth::Elsewhere, Growth::Deeper, Growth::Finer};
[[nodiscard]] const char* nameOf(Growth growth);
/// `near`: the zone and what is near it, for Elsewhere. operations >= 500.
[[nodiscard]] RefineHistory grownHistory(Growth growth, std::size_t operations, const Box& near,
                                         std::uint64_t seed);

/// What a model keeps beside its lines' ends.
enum class Kept : std::uint8_t {
  References,  ///< the operations on both sides of each end (R2)
  Histories    ///< and all that ever changed a line (R2b)
};
/// The history applied to the lines of a grid of `resolution` points along the longest side of its bounds.
/// Throws InputError as points::dexelGridFor does.
[[nodiscard]] points::TriDexelDocument documentOf(const RefineHistory& history, int resolution, Kept kept,
                                                  const Execution& execution = {});

}  // namespace restroke::experiments
