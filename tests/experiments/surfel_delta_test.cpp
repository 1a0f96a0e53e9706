#include "experiments/backends/surfel_delta.h"

#include <gtest/gtest.h>

#include "experiments/random.h"
#include "implicit/errors.h"

namespace restroke::experiments {
namespace {

using points::Surfel;

Surfel randomSurfel(Random& random, std::uint32_t owner) {
  Surfel s;
  s.position = {static_cast<float>(random.unit()), static_cast<float>(random.unit()),
                static_cast<float>(random.unit())};
  s.normal = {static_cast<float>(random.between(-1, 1)), 0.0f, -0.0f};
  s.radius = static_cast<float>(random.unit());
  s.primitive = owner;
  s.sign = random.below(2) == 0 ? implicit::Sign::Positive : implicit::Sign::Negative;
  return s;
}

std::vector<Surfel> randomState(Random& random, std::size_t count) {
  std::vector<Surfel> state;
  for (std::size_t i = 0; i < count; ++i)
    state.push_back(randomSurfel(random, static_cast<std::uint32_t>(i / 7)));
  return state;
}

bool equal(const std::vector<Surfel>& a, const std::vector<Surfel>& b) {
  return a.size() == b.size() && difference(a, b).empty();
}

void expectBothWays(const std::vector<Surfel>& before, const std::vector<Surfel>& after) {
  const SurfelDelta delta = decompress(compress(difference(before, after)));
  std::vector<Surfel> state = before;
  applyForward(delta, state);
  EXPECT_TRUE(equal(state, after));
  applyBackward(delta, state);
  EXPECT_TRUE(equal(state, before));
}

TEST(SurfelDelta, OfEqualStatesIsEmpty) {
  Random random(1);
  const auto state = randomState(random, 50);
  EXPECT_TRUE(difference(state, state).empty());
  expectBothWays(state, state);
}

TEST(SurfelDelta, LeadsFromOneStateToTheOtherAndBack) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const auto before = randomState(random, random.below(200));
    std::vector<Surfel> after;
    for (const Surfel& s : before)
      if (random.below(3) != 0) after.push_back(s);
    for (std::uint64_t i = random.below(80); i-- > 0;) after.push_back(randomSurfel(random, 1000));
    expectBothWays(before, after);
  }
}

TEST(SurfelDelta, HoldsOnlyWhatWentAndWhatCame) {
  Random random(5);
  const auto before = randomState(random, 300);
  std::vector<Surfel> after = before;
  after.erase(after.begin() + 17);
  after.push_back(randomSurfel(random, 999));
  const SurfelDelta delta = difference(before, after);
  EXPECT_EQ(delta.removedAt, std::vector<std::uint32_t>{17});
  EXPECT_EQ(delta.removed.size(), 1u);
  EXPECT_EQ(delta.added.size(), 1u);
}

TEST(SurfelDelta, LeadsFromAndToNothing) {
  Random random(9);
  const auto state = randomState(random, 20);
  expectBothWays({}, state);
  expectBothWays(state, {});
  expectBothWays({}, {});
}

TEST(SurfelDelta, TellsZeroFromMinusZero) {
  Surfel plus, minus;
  plus.position.x = 0.0f;
  minus.position.x = -0.0f;
  EXPECT_FALSE(equal({plus}, {minus}));
}

TEST(SurfelDelta, RefusesBytesThatAreNotCompressed) {
  const std::vector<char> nonsense(40, 'x');
  EXPECT_THROW((void)decompress(nonsense), InternalError);
  EXPECT_THROW((void)decompress({}), InternalError);
}

}  // namespace
}  // namespace restroke::experiments
