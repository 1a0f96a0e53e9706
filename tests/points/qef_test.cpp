// Where planes meet.

#include "points/isosurface/qef.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/support/brute_force.h"

namespace restroke::points {
namespace {

using restroke::testing::Random;

void expectNear(DVec3 a, DVec3 b, double tolerance) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "axis " << i;
}

TEST(Qef, OnePlaneKeepsTheMeanMovedOntoIt) {
  Qef qef;
  const DVec3 n = normalized(DVec3(1, 2, -1));
  qef.add({0.1, 0.2, 0.3}, n);
  expectNear(qef.minimum().position, {0.1, 0.2, 0.3}, 1e-15);
  EXPECT_EQ(qef.minimum().rank, 1);
}

TEST(Qef, TwoPlanesMeetInALineAtThePointNearestTheMean) {
  Qef qef;
  qef.add({0.2, -0.3, 0.1}, {1, 0, 0});
  qef.add({-0.4, 0.1, 0.3}, {0, 1, 0});
  expectNear(qef.minimum().position, {0.2, 0.1, 0.2}, 1e-15);
  EXPECT_EQ(qef.minimum().rank, 2);
  EXPECT_NEAR(qef.errorAt(qef.minimum().position), 0, 1e-15);
}

TEST(Qef, ThreePlanesMeetInAPointInAnyOrientation) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const DVec3 corner(random.inCube(0.4f));
    const DVec3 a = normalized(DVec3(random.inCube(1))), b = normalized(cross(a, DVec3(random.inCube(1)))),
                c = cross(a, b);
    Qef qef;
    qef.add(corner + b * 0.3 - c * 0.2, a);
    qef.add(corner - a * 0.1 + c * 0.4, b);
    qef.add(corner + a * 0.2 + b * 0.2, c);
    EXPECT_EQ(qef.minimum().rank, 3);
    expectNear(qef.minimum().position, corner, 1e-12);
    expectNear(qef.minimumWithin(0.5).position, corner, 1e-12);
  }
}

TEST(Qef, NearlyParallelPlanesAreOne) {
  Qef qef;
  qef.add({-0.3, 0, 0}, normalized(DVec3(0.1, 0, 1)));
  qef.add({0.3, 0, 0}, normalized(DVec3(-0.1, 0, 1)));
  EXPECT_EQ(qef.minimum().rank, 1);
  EXPECT_NEAR(qef.minimum().position.x, 0, 1e-15);
}

TEST(Qef, WithinACubeItIsTheBestOfADenseSearch) {
  Random random(5);
  int beyond = 0;
  for (int i = 0; i < 100; ++i) {
    Qef qef;
    for (int k = 0; k < 4; ++k) qef.add(DVec3(random.inCube(0.5f)), normalized(DVec3(random.inCube(1))));
    const DVec3 best = qef.minimumWithin(0.5).position, free = qef.minimum().position;
    for (int a = 0; a < 3; ++a) EXPECT_LE(std::fabs(best[a]), 0.5);
    if (qef.minimum().rank < 3) continue;  // the search knows nothing of dropped directions
    if (std::fabs(free.x) > 0.5 || std::fabs(free.y) > 0.5 || std::fabs(free.z) > 0.5) ++beyond;
    double least = 1e9;
    for (int x = 0; x <= 20; ++x)
      for (int y = 0; y <= 20; ++y)
        for (int z = 0; z <= 20; ++z)
          least = std::min(least, qef.errorAt(DVec3(x, y, z) / 20.0 - DVec3(0.5)));
    EXPECT_LE(qef.errorAt(best), least + 0.01) << i;
  }
  EXPECT_GT(beyond, 20);
}

TEST(Qef, SeveralAtOnceHaveTheBitsOfEachAlone) {
  Random random(5);
  for (int trial = 0; trial < 2000; ++trial) {
    std::array<Qef, Qef::kBatch> qefs;
    Qef::Batch batch;
    for (std::size_t i = 0; i < Qef::kBatch; ++i) {
      // Axis-parallel planes, equal ones, and any.
      for (std::size_t planes = 1 + random.below(6); planes > 0; --planes) {
        DVec3 n(0);
        if (random.below(3) == 0)
          n[static_cast<int>(random.below(3))] = random.below(2) == 0 ? 1 : -1;
        else
          n = normalized(DVec3(random.inCube(1)) + DVec3(0, 0, 1e-3));
        const DVec3 p(random.inCube(0.5f));
        qefs[i].add(p, n);
        if (random.below(4) == 0) qefs[i].add(p, n);
      }
      batch[i] = &qefs[i];
    }
    std::array<Qef::Minimum, Qef::kBatch> minima;
    Qef::minimaWithin(0.4, batch, minima);
    for (std::size_t i = 0; i < Qef::kBatch; ++i) {
      const Qef::Minimum one = qefs[i].minimumWithin(0.4);
      ASSERT_EQ(minima[i].position, one.position);
      ASSERT_EQ(minima[i].rank, one.rank);
    }
  }
}

}  // namespace
}  // namespace restroke::points
