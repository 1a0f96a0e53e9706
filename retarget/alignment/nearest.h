#pragma once
// Nearest neighbours among oriented points (FLANN).

#include <memory>
#include <span>
#include <vector>

#include "retarget/alignment/cloud.h"

namespace restroke::retarget::alignment {

/// Answers which sample lies nearest to a place and direction, by the distance
/// sqrt(|position difference|^2 + weight^2 |normal difference|^2). In float32; of equal ones always the
/// same.
class NearestSamples {
 public:
  NearestSamples(std::span<const Sample> samples, double normalWeight);
  ~NearestSamples();
  NearestSamples(NearestSamples&&) noexcept;
  NearestSamples& operator=(NearestSamples&&) noexcept;

  struct Answer {
    std::vector<std::size_t> index;
    std::vector<float> squaredDistance;
  };
  /// A sample for each query that is at most 1 + slack times as far as the nearest. O(log samples) each where
  /// samples are near.
  void find(std::span<const Sample> queries, float slack, Answer& answer) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace restroke::retarget::alignment
