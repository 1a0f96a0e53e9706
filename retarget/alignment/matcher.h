#pragma once
// Iterated closest points: improves a motion, and says how good it is. Motions are in the clouds'
// coordinates.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "retarget/alignment/cloud.h"
#include "retarget/alignment/fit.h"
#include "retarget/alignment/nearest.h"

namespace restroke::retarget::alignment {

enum class Sampling : std::uint8_t {
  Coarse,  ///< against the other side's spread samples, and nearly the nearest of them
  Fine,    ///< against all of them
};

/// How much work is put into one motion.
struct Effort {
  std::size_t points = 150;  ///< of each side (mode Patch: of the patch)
  int rounds = 8;            ///< at most
  Sampling sampling = Sampling::Coarse;
};

class Matcher {
 public:
  /// The clouds must outlive it.
  Matcher(const Cloud& before, const Cloud& after, AlignmentMode mode);

  /// A motion near `start` that fits better. May wander off where there is none.
  [[nodiscard]] Similarity refined(const Similarity& start, const Effort& effort) const;

  /// Squared distance of each of the points from the other side along the normals, in RMS radii of the moved
  /// `before`; kMissSquared where it is farther, or where the normals disagree.
  [[nodiscard]] std::vector<double> squaredErrors(const Similarity& motion, const Effort& effort) const;
  static constexpr double kMissSquared = 0.01;

  /// A score for many starts: also tells apart what fits here and there by its normals. Less is better.
  [[nodiscard]] double roughScore(const Similarity& motion, const Effort& effort) const;

  [[nodiscard]] double firmness(const Similarity& motion, const Effort& effort) const;

  /// RMS distance of the points' two images, in RMS radii of the moved `before`.
  [[nodiscard]] double distance(const Similarity& a, const Similarity& b) const;

 private:
  /// Matches under the motion. Weight 0 where normals disagree.
  void match(const Similarity& motion, const Effort& effort, std::vector<Match>& matches) const;
  [[nodiscard]] StepFrame frameOf(const Similarity& motion) const;

  const Cloud& before_;
  const Cloud& after_;
  /// Of one side, by Sampling.
  using Trees = std::array<NearestSamples, 2>;
  [[nodiscard]] static Trees treesOf(const Cloud& cloud, double normalWeight);
  Trees nearestAfter_;
  std::optional<Trees> nearestBefore_;  // mode Whole
};

}  // namespace restroke::retarget::alignment
