#pragma once
// A rival: the ordered list and its surfels without clusters. Whatever is near something is found by going
// through all primitives, 4, 8 or 16 at a time; what is found is tested with Restroke's own kernels. So the
// difference to Restroke is what the clusters are worth, and it grows with the list.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "implicit/primitive.h"
#include "implicit/simd/ball_kernels.h"
#include "tests/bench/brush_kernels.h"

namespace restroke::bench {

/// The surfels are those of points::SurfelModel, sample by sample. Spheres only.
class PlainList {
 public:
  explicit PlainList(float density);  ///< samples per square model unit

  /// Evaluates the stamp's samples against all primitives, and drops older samples in it. O(primitives).
  void append(const implicit::Primitive& primitive);
  /// Takes out the primitives at positions first .. first + count - 1, and evaluates again the patches of all
  /// others that reach into one of them.
  void remove(std::size_t first, std::size_t count);
  /// Evaluates every sample anew. O(primitives^2).
  void rebuild();

  [[nodiscard]] std::size_t surfelCount() const { return surfels_; }
  [[nodiscard]] std::size_t bytes() const;

  /// Parameter of the first crossing from outside to inside, as implicit::castRay. Every ray asks every
  /// primitive.
  [[nodiscard]] std::optional<double> castRay(const Ray& ray);

 private:
  struct Samples {
    const implicit::SampleTable* table = nullptr;
    std::vector<std::uint16_t> visible;
  };
  enum Column { kX, kY, kZ, kReach, kRadius2, kDropRadius2, kColumns };

  [[nodiscard]] implicit::SampledShape shapeOf(std::size_t i) const;
  [[nodiscard]] implicit::BallArrays arrays(std::size_t earlier) const;
  [[nodiscard]] BallColumns columns() const;
  void place(std::size_t i);
  void pad();
  void evaluate(std::size_t i);
  void countAgain();

  float density_;
  std::vector<implicit::Primitive> list_;
  std::vector<Samples> samples_;
  std::array<std::vector<float>, kColumns> columns_;
  std::vector<std::uint8_t> positive_;
  std::vector<const implicit::GriddedVolume*> volumes_;  // all null
  std::vector<std::uint32_t> found_;
  std::vector<std::uint16_t> blocks_;
  std::vector<RayInterval> intervals_;
  std::size_t surfels_ = 0;
};

}  // namespace restroke::bench
