#pragma once
// Volumes of every kind at random places, for tests that mix them.

#include <memory>
#include <vector>

#include "implicit/shape.h"
#include "tests/support/brute_force.h"

namespace restroke::testing {

/// Turned at random, scaled by 0.1 to 10, about the origin.
inline implicit::Shape randomlyPosed(Random& random, std::shared_ptr<const implicit::Volume> volume) {
  implicit::Pose pose;
  pose.position = random.inCube(2);
  for (float& q : pose.rotation) q = random.between(-1, 1);
  pose.scale = random.below(2) == 0 ? random.between(0.1f, 1) : random.between(1, 10);
  return std::make_shared<const implicit::PosedVolume>(std::move(volume), pose);
}

/// A brush-like primitive of any kind on the unit sphere, now and then coincident with an earlier one.
inline Primitive randomMixedPrimitive(Random& random, const std::vector<Primitive>& list) {
  const auto kinds = implicit::volumeKinds();
  const std::size_t choice = random.below(kinds.size() + 1);
  if (choice == kinds.size() || (!list.empty() && random.below(8) == 0)) return randomPrimitive(random, list);
  const std::vector<implicit::VolumeParameters> examples = kinds[choice]->examples();
  const auto volume = kinds[choice]->make(examples[random.below(examples.size())]);
  implicit::Pose pose;
  const Point c = random.inCube(1);
  pose.position = c * (1.0f / std::fmax(length(c), 0.05f));
  for (float& q : pose.rotation) q = random.between(-1, 1);
  pose.scale = random.between(0.1f, 0.5f) / static_cast<float>(volume->measures().radius);
  return {std::make_shared<const implicit::PosedVolume>(volume, pose),
          random.below(2) == 0 ? Sign::Positive : Sign::Negative};
}

}  // namespace restroke::testing
