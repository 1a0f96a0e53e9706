// Very many primitives in one place (SPEC S4): the results are those of the definition, whatever the clusters
// leave out.

#include <gtest/gtest.h>

#include <algorithm>

#include "implicit/side.h"
#include "points/surfel_model.h"
#include "tests/support/brute_force.h"
#include "tests/support/random_volumes.h"

namespace restroke::points {
namespace {

using implicit::Primitive;
using implicit::Sign;
using testing::Random;

constexpr SamplingOptions kSampling{.density = 60};
constexpr implicit::ClusterOptions kOneCell{.cell = 16};  // everything is in its place
constexpr implicit::ClusterOptions kManyCells{.cell = 0.05f};

/// Stamps around the pole of the unit sphere, each on hundreds of others; `kind` 1 and 2 are all alike.
std::vector<Primitive> crowd(std::size_t count, std::uint64_t seed, int kind = 0) {
  Random random(seed);
  std::vector<Primitive> list{{{{0, 0, 0}, 1}, Sign::Positive}};
  while (list.size() < count) {
    Point c{random.between(-0.15f, 0.15f), random.between(-0.15f, 0.15f), 1};
    if (kind == 0) c = c * (1.0f / length(c));
    if (kind == 2) c = {0, 0, 1};
    const float radius = kind == 0 ? random.between(0.02f, 0.2f) : 0.1f;
    list.push_back({{c, radius}, random.below(2) == 0 ? Sign::Positive : Sign::Negative});
  }
  return list;
}

SurfelModel modelOf(const std::vector<Primitive>& list, const implicit::ClusterOptions& clusters) {
  SurfelModel model(kSampling, clusters);
  for (const Primitive& p : list) model.append({&p, 1});
  return model;
}

class Crowding : public ::testing::TestWithParam<int> {};

TEST_P(Crowding, S4SurfelsAreThoseOfTheDefinition) {
  const std::vector<Primitive> list = crowd(1300, 3, GetParam());
  SurfelModel model = modelOf(list, kOneCell);
  ASSERT_TRUE(model.list().clusters().crowded());
  const std::vector<Surfel> expected = testing::surfelsByDefinition(list, kSampling.density);
  for (const int threads : {0, 1, 3}) {  // 0: as the appends left it
    if (threads > 0) model.rebuild({.threads = threads});
    const std::vector<Surfel> found = model.surfels();
    ASSERT_EQ(found.size(), expected.size()) << threads;
    for (std::size_t i = 0; i < found.size(); ++i) {
      ASSERT_EQ(found[i].primitive, expected[i].primitive) << threads << ", surfel " << i;
      ASSERT_EQ(found[i].position, expected[i].position) << threads << ", surfel " << i;
    }
  }
}

TEST_P(Crowding, S4SidesAreThoseOfTheDefinition) {
  const std::vector<Primitive> list = crowd(900, 5, GetParam());
  const SurfelModel model = modelOf(list, kOneCell);
  Random random(1);
  std::vector<Point> points;
  for (int i = 0; i < 4000; ++i)
    points.push_back(Point(0, 0, 1) + random.inCube(i % 16 == 0 ? 0.3f : 0.003f) + random.inCube(0.2f));
  std::sort(points.begin(), points.end(), [](Point a, Point b) { return a.x < b.x; });
  for (const std::size_t prefix : {std::size_t{450}, list.size()}) {
    std::vector<implicit::Side> sides(points.size());
    sidesOf(model.list(), points, sides, {prefix});
    for (std::size_t i = 0; i < points.size(); ++i) {
      const implicit::Side expected = testing::sideByDefinition(list, points[i], prefix);
      ASSERT_EQ(sides[i], expected) << i;
      ASSERT_EQ(sideOf(model.list(), points[i], {prefix}), expected) << i;
    }
  }
}

TEST_P(Crowding, S6AnyWalkOfEditsEqualsFromScratch) {
  std::vector<Primitive> list = crowd(700, 7, GetParam());
  const std::vector<Primitive> spare = crowd(2000, 8, GetParam());
  SurfelModel model = modelOf(list, kOneCell);
  Random random(9);
  std::size_t next = 1;
  const auto insert = [&](std::size_t at, std::size_t count) {
    const auto from = spare.begin() + static_cast<std::ptrdiff_t>(next);
    const std::vector<Primitive> more(from, from + static_cast<std::ptrdiff_t>(count));
    next += count;
    model.insert(at, more);
    list.insert(list.begin() + static_cast<std::ptrdiff_t>(at), more.begin(), more.end());
  };
  const auto remove = [&](std::size_t first, std::size_t count) {
    model.remove(first, count);
    const auto from = list.begin() + static_cast<std::ptrdiff_t>(first);
    list.erase(from, from + static_cast<std::ptrdiff_t>(count));
  };
  const auto edit = [&] {
    const std::size_t count = 1 + random.below(12), place = 1 + random.below(list.size() - 100);
    switch (random.below(4)) {
      case 0:
        return insert(list.size(), count);
      case 1:
        return insert(place, count);
      case 2:
        return insert(place, 1);
      default:
        return remove(place, 8 * count);
    }
  };
  for (int step = 0; step < 24; ++step) {
    if (step % 4 == 3) {  // several at once
      model.beginEdits();
      for (int i = 0; i < 5; ++i) edit();
      model.endEdits();
    } else {
      edit();
    }
    SurfelModel scratch(kSampling, kManyCells);
    scratch.append(list);
    ASSERT_EQ(model.surfelCount(), scratch.surfelCount()) << step;
    ASSERT_EQ(model.stateHash(), scratch.stateHash()) << step;
  }
}

TEST_P(Crowding, PrefixSurfelsAreThoseOfTheShorterList) {
  const std::vector<Primitive> list = crowd(800, 11, GetParam());
  const SurfelModel model = modelOf(list, kOneCell);
  for (const std::size_t prefix : {std::size_t{300}, std::size_t{650}}) {
    const SurfelModel shorter =
        modelOf({list.begin(), list.begin() + static_cast<std::ptrdiff_t>(prefix)}, kManyCells);
    const std::vector<Surfel> found = model.surfels(implicit::Prefix{prefix}), expected = shorter.surfels();
    ASSERT_EQ(found.size(), expected.size()) << prefix;
    for (std::size_t i = 0; i < found.size(); ++i)
      ASSERT_EQ(found[i].position, expected[i].position) << prefix << ", surfel " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Stamps, Crowding, ::testing::Values(0, 1, 2), [](const auto& parameter) {
  return std::string(parameter.param == 0   ? "OfManySizesOnASphere"
                     : parameter.param == 1 ? "OfOneSizeInAPlane"
                                            : "InOnePlace");
});

TEST(Crowding, VolumesAmongTheSpheresGiveTheSameBitsWhateverTheClusters) {
  Random random(13);
  std::vector<Primitive> list = crowd(700, 15);
  for (int i = 0; i < 60; ++i) {
    const auto at = static_cast<std::ptrdiff_t>(1 + random.below(list.size() - 1));
    list.insert(list.begin() + at, testing::randomMixedPrimitive(random, {}));
  }
  SurfelModel crowded = modelOf(list, kOneCell), spread(kSampling, kManyCells);
  spread.append(list);
  EXPECT_EQ(crowded.stateHash(), spread.stateHash());
  crowded.remove(200, 150);
  spread.remove(200, 150);
  EXPECT_EQ(crowded.stateHash(), spread.stateHash());
}

TEST(Crowding, MemoryStaysBoundedWhereStampsCannotBeToldApart) {
  for (const int kind : {0, 1, 2}) {
    const SurfelModel model = modelOf(crowd(4000, 17, kind), kOneCell);
    EXPECT_LT(static_cast<double>(model.bytes().clusters) / 4000, 600) << kind;
  }
}

}  // namespace
}  // namespace restroke::points
