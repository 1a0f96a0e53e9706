// A sphere's samples: near-uniform, compact in patches, the same everywhere (SPEC S3).

#include "implicit/shapes/sphere_samples.h"

#include <gtest/gtest.h>

#include <cmath>

#include "implicit/errors.h"
#include "implicit/shape.h"
#include "tests/support/brute_force.h"

namespace restroke::implicit {
namespace {

TEST(SphereSamples, AreUnitVectorsOfEqualAreaWithSmallGaps) {
  for (const std::uint32_t n : {16u, 160u, 1024u, 20480u}) {
    const SampleTable& table = sphereSamples(n);
    ASSERT_EQ(table.count(), n);
    DVec3 sum(0);
    for (std::uint32_t i = 0; i < n; ++i) {
      EXPECT_NEAR(length(table.position(i)), 1, 2e-7);
      sum += DVec3(table.position(i));
    }
    EXPECT_LT(length(sum) / n, 2.0 / n);
    // Discrepancy: caps of random centre and size hold their share of the samples, within the lattice's known
    // order n^(-3/4).
    testing::Random random(n);
    double worst = 0;
    for (int k = 0; k < 300; ++k) {
      Vec3 axis = random.inCube(1);
      axis = axis * (1.0f / std::fmax(length(axis), 0.05f));
      const float height = random.between(-1, 1);
      double inside = 0;
      for (std::uint32_t i = 0; i < n; ++i) inside += dot(axis, table.position(i)) >= height * length(axis);
      worst = std::fmax(worst, std::fabs(inside / n - (1 - static_cast<double>(height)) / 2));
    }
    EXPECT_LT(worst, 2.0 * std::pow(static_cast<double>(n), -0.75)) << n;
    // Gaps: no place on the sphere is farther than 0.95 of the root of the area per sample from a sample.
    const double area = 4 * 3.14159265358979 / n;
    for (int k = 0; k < 200; ++k) {
      Vec3 p = random.inCube(1);
      p = p * (1.0f / std::fmax(length(p), 0.05f));
      p = p * (1.0f / length(p));
      double nearest = 9;
      for (std::uint32_t i = 0; i < n; ++i)
        nearest = std::fmin(nearest, static_cast<double>(length(table.position(i) - p)));
      EXPECT_LT(nearest, 0.95 * std::sqrt(area)) << n;
    }
  }
}

TEST(SphereSamples, EveryBoundOfTheTreeHoldsItsSamplesAndIsSmall) {
  const SampleTable& table = sphereSamples(20480);
  const PatchTree& tree = table.tree();
  std::uint32_t run = kPatch;
  for (int l = 0; l < tree.levels; ++l, run *= kPatch) {
    double sum = 0;
    for (std::uint32_t i = 0; i < table.count(); ++i) {
      const std::uint32_t node = i / run;
      const Vec3 c(tree.level[l].x[node], tree.level[l].y[node], tree.level[l].z[node]);
      EXPECT_LE(length(table.position(i) - c), tree.level[l].radius[node]);
    }
    for (std::uint32_t node = 0; node < tree.level[l].count; ++node)
      sum +=
          static_cast<double>(tree.level[l].radius[node]) * static_cast<double>(tree.level[l].radius[node]);
    // The discs' areas add up to a few times the sphere's.
    EXPECT_LT(3.14159 * sum, 4 * 3.14159 * 4) << "level " << l;
  }
  EXPECT_LE(tree.level[tree.levels - 1].count, kPatch);
}

TEST(SphereSamples, CountsClimbALadderWithStepsOfAThirtySecond) {
  std::uint32_t before = 0;
  for (float r = 0.01f; r < 8; r *= 1.01f) {
    const std::uint32_t n = sampleCount(Sphere{{}, r}, 5000);
    const double wanted = 5000 * 4 * 3.14159265 * static_cast<double>(r) * static_cast<double>(r);
    EXPECT_EQ(n % kPatch, 0u);
    EXPECT_GE(n, before);
    EXPECT_LE(std::fabs(n - wanted), std::fmax(16.0, wanted / 64)) << r;
    before = n;
  }
  EXPECT_EQ(sampleCount(Sphere{{}, 1e-4f}, 1), kPatch);
  EXPECT_THROW((void)sampleCount(Sphere{{}, 100}, 1e6f), InputError);
}

TEST(SphereSamples, X1FirstDirectionsAreTheseBits) {
  // What every machine and compiler must make; the state hashes of the shipped logs rest on it.
  const SampleTable& table = sphereSamples(160);
  double sum = 0;
  for (std::uint32_t i = 0; i < 160; ++i)
    sum += static_cast<double>(table.position(i).x) * (i + 1) +
           static_cast<double>(table.position(i).y) * (2 * i + 1) +
           static_cast<double>(table.position(i).z) * (3 * i + 1);
  EXPECT_EQ(fmt::format("{:a}", sum), "0x1.13009cd62e4p+13");
}

TEST(SphereTolerance, KeepsItsOrderAgainstRounding) {
  for (const Sphere& s : {Sphere{{0, 0, 0}, 1}, Sphere{{900, 0, 0}, 0.06f}, Sphere{{0, -3, 1}, 1e-3f}}) {
    const SphereTolerance t = toleranceOf(s);
    EXPECT_GT(t.dropRadius, s.radius);
    EXPECT_GT(t.keepRadius, t.dropRadius);
    EXPECT_GT(t.slack, t.keepRadius - s.radius);
  }
}

}  // namespace
}  // namespace restroke::implicit
