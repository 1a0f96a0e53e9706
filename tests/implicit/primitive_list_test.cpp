#include "implicit/primitive_list.h"

#include <gtest/gtest.h>

#include "implicit/errors.h"
#include "tests/support/brute_force.h"

namespace restroke::implicit {
namespace {

Primitive sphere(float x, float r = 0.1f) {
  return {{{x, 0, 0}, r}, Sign::Positive};
}

TEST(PrimitiveList, EmptyListHasEmptyBounds) {
  const PrimitiveList list;
  EXPECT_TRUE(list.empty());
  EXPECT_TRUE(list.bounds().empty());
}

TEST(PrimitiveList, IdsStayWhilePositionsMove) {
  PrimitiveList list;
  const PrimitiveId a = list.append(sphere(1)), b = list.append(sphere(2));
  const PrimitiveId c = list.insert(1, sphere(3));
  EXPECT_EQ(list.positionOf(a), 0u);
  EXPECT_EQ(list.positionOf(c), 1u);
  EXPECT_EQ(list.positionOf(b), 2u);
  list.remove(a);
  EXPECT_EQ(list.positionOf(c), 0u);
  EXPECT_EQ(list[b], sphere(2));
  EXPECT_EQ(list.at(0), sphere(3));
}

TEST(PrimitiveList, KeepsItsOrderThroughInsertionsThatRunOutOfLabels) {
  PrimitiveList list;
  std::vector<Primitive> plain;
  testing::Random random(1);
  for (int i = 0; i < 3000; ++i) {
    const bool atOnePlace = i % 3 != 0;
    const std::size_t at = atOnePlace ? plain.size() / 2 : random.below(plain.size() + 1);
    const Primitive p = sphere(static_cast<float>(i) * 0.001f);
    list.insert(at, p);
    plain.insert(plain.begin() + static_cast<std::ptrdiff_t>(at), p);
  }
  ASSERT_EQ(list.size(), plain.size());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    ASSERT_EQ(list.at(i), plain[i]);
    ASSERT_EQ(list.positionOf(list.idAt(i)), i);
  }
}

TEST(PrimitiveList, BoundsHoldPositivePrimitivesOfThePrefix) {
  PrimitiveList list;
  list.append(sphere(0, 1));
  list.append({{{10, 0, 0}, 1}, Sign::Negative});
  list.append(sphere(5, 1));
  EXPECT_NEAR(list.bounds().max.x, 6, 1e-4);
  EXPECT_NEAR(list.bounds(Prefix{2}).max.x, 1, 1e-4);
  EXPECT_TRUE(list.bounds(Prefix{0}).empty());
  EXPECT_NEAR(list.boundingSphere().center.x, 2.5, 1e-5);
  EXPECT_NEAR(list.boundingSphere().radius, 3.5, 1e-5);
  EXPECT_EQ(list.boundingSphere(Prefix{0}).radius, 0);
}

TEST(PrimitiveList, S4ClusterListsHoldExactlyWhatTouches) {
  PrimitiveList list({.cell = 0.2f});
  testing::Random random(2);
  std::vector<Primitive> plain;
  for (int i = 0; i < 300; ++i) {
    plain.push_back(testing::randomPrimitive(random, plain));
    list.append(plain.back());
  }
  for (int k = 0; k < 2000; ++k) {
    const Point p = random.inCube(1.5f);
    std::vector<bool> listed(plain.size(), false);
    list.clusters().forListsIn({p, p}, Clusters::Wanted::All, [&](std::span<const std::uint32_t> slots) {
      for (const std::uint32_t s : slots) listed[list.positionOf(PrimitiveId{s})] = true;
      for (std::size_t i = 1; i < slots.size(); ++i)
        EXPECT_LT(list.positionOf(PrimitiveId{slots[i - 1]}), list.positionOf(PrimitiveId{slots[i]}));
    });
    for (std::size_t i = 0; i < plain.size(); ++i)
      EXPECT_TRUE(listed[i] || !contains(plain[i].shape, p)) << i;
  }
}

TEST(PrimitiveList, RefusesWhatCannotBeSampled) {
  PrimitiveList list;
  EXPECT_THROW(list.append(sphere(0, 0)), InputError);
  EXPECT_THROW(list.append(sphere(std::nanf(""))), InputError);
  EXPECT_THROW(list.append(sphere(2e6f)), InputError);
  EXPECT_THROW(list.append(sphere(1000, 0.01f)), InputError);
  EXPECT_EQ(list.size(), 0u);
}

}  // namespace
}  // namespace restroke::implicit
