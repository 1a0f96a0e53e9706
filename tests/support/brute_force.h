#pragma once
// The definitions of SPEC S2 and S3, written as plainly as they read: the oracle of the core's tests.

#include <cstdint>
#include <vector>

#include "implicit/primitive_list.h"
#include "points/surfel.h"

namespace restroke::testing {

using implicit::Primitive;
using implicit::Side;
using implicit::Sign;
using implicit::Sphere;

/// S2, from the front: every primitive in turn.
inline Side sideByDefinition(const std::vector<Primitive>& list, Point p, std::size_t prefix) {
  Side side = Side::Outside;
  for (std::size_t i = 0; i < prefix && i < list.size(); ++i)
    if (contains(list[i].shape, p)) side = list[i].sign == Sign::Positive ? Side::Inside : Side::Outside;
  return side;
}

/// S3 for every sample of every primitive.
inline std::vector<points::Surfel> surfelsByDefinition(const std::vector<Primitive>& list, float density) {
  std::vector<points::Surfel> out;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const implicit::Shape& shape = list[i].shape;
    const auto& table = implicit::samplesOf(shape, implicit::sampleCount(shape, density));
    const implicit::SampledShape samples = implicit::sampled(shape, table);
    const bool positive = list[i].sign == Sign::Positive;
    for (std::uint32_t k = 0; k < table.count(); ++k) {
      const implicit::PlacedSample sample = implicit::placedSample(samples, k);
      const Side side = sideByDefinition(list, sample.keep, i);
      if (side == (positive ? Side::Inside : Side::Outside)) continue;
      const Point p = sample.position;
      bool dropped = false;
      for (std::size_t j = i + 1; j < list.size() && !dropped; ++j) dropped = drops(list[j].shape, p);
      if (!dropped)
        out.push_back(
            {p, positive ? sample.normal : -sample.normal, 0, static_cast<std::uint32_t>(i), list[i].sign});
    }
  }
  return out;
}

/// A small generator whose numbers are the same everywhere (SplitMix64; Steele, Lea, Flood, OOPSLA 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ull);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  }
  /// 0 to n - 1.
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(bits() % n); }
  float between(float a, float b) { return a + (b - a) * static_cast<float>(bits() >> 40) * 0x1p-24f; }
  Point inCube(float half) { return {between(-half, half), between(-half, half), between(-half, half)}; }

 private:
  std::uint64_t state_;
};

/// A brush-like sphere on the unit sphere's surface, now and then a large, tiny, repeated or concentric one.
inline Primitive randomPrimitive(Random& random, const std::vector<Primitive>& list) {
  const Sign sign = random.below(2) == 0 ? Sign::Positive : Sign::Negative;
  const std::size_t kind = random.below(10);
  if (kind < 2 && !list.empty()) {  // coincident with an earlier one
    Primitive p = list[random.below(list.size())];
    p.sign = sign;
    return p;
  }
  Point c = random.inCube(1);
  if (kind < 8) c = c * (1.0f / std::fmax(length(c), 0.01f));
  const float radius = kind == 8   ? random.between(0.3f, 1.2f)
                       : kind == 9 ? random.between(0.002f, 0.02f)
                                   : random.between(0.05f, 0.2f);
  return {{c, radius}, sign};
}

}  // namespace restroke::testing
