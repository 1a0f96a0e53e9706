// What every kind of volume owes (SPEC S1, S3, S13): the same suite for whatever volume_kinds.cpp lists, on
// each kind's own examples. The oracles are the side test, random lines and the plain definitions of S2 and
// S3.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "implicit/clearance_grid.h"
#include "implicit/errors.h"
#include "implicit/near_balls.h"
#include "implicit/shape.h"
#include "implicit/shapes/kinds.h"
#include "points/surfel_model.h"
#include "tests/support/random_volumes.h"

namespace restroke::implicit {
namespace {

using testing::Random;

class VolumeConformance : public ::testing::TestWithParam<const VolumeKind*> {
 protected:
  static const VolumeKind& kind() { return *GetParam(); }
  /// Calls f(volume) for each example of the kind.
  template <class F>
  static void forExamples(const F& f) {
    const std::vector<VolumeParameters> examples = kind().examples();
    ASSERT_FALSE(examples.empty());
    for (std::size_t i = 0; i < examples.size(); ++i) {
      SCOPED_TRACE(::testing::Message() << kind().name << ", example " << i);
      f(*kind().make(examples[i]));
    }
  }
};

/// A random line that meets the volume's ball, all such lines being equally likely (Santalo, "Integral
/// geometry and geometric probability", 1976): its crossings with any surface in the ball are spread evenly
/// over it.
Ray randomLine(Random& random, const VolumeMeasures& ball) {
  const auto direction = [&] {
    for (;;) {
      const DVec3 d(random.inCube(1));
      const double l = length(d);
      if (l <= 1 && l > 0.01) return d / l;
    }
  };
  const DVec3 d = direction();
  for (;;) {
    const DVec3 other = direction(), across = cross(d, other);
    const double l = length(across);
    if (l < 0.1) continue;
    const DVec3 u = across / l, v = cross(d, u);
    const auto a = static_cast<double>(random.between(-1, 1)), b = static_cast<double>(random.between(-1, 1));
    if (a * a + b * b > 1) continue;
    const DVec3 through = ball.center + ball.radius * (a * u + b * v);
    return {through - 3 * ball.radius * d, d, 0, 6 * ball.radius};
  }
}

/// Points spread evenly over the surface, by random lines; and how many lines it took.
struct Crossings {
  std::vector<DVec3> points;
  int lines = 0;
};
Crossings crossingsOf(const Volume& volume, std::size_t atLeast, std::uint64_t seed) {
  Random random(seed);
  Crossings out;
  std::vector<RayInterval> in;
  while (out.points.size() < atLeast && out.lines < 4'000'000) {
    const Ray ray = randomLine(random, volume.measures());
    ++out.lines;
    in.clear();
    volume.intersect(ray, in);
    for (const RayInterval& i : in) {
      out.points.push_back(ray.at(i.enter));
      out.points.push_back(ray.at(i.exit));
    }
  }
  return out;
}

DVec3 randomIn(Random& random, const VolumeMeasures& ball) {
  return ball.center + DVec3(random.inCube(1)) * ball.radius;
}

TEST_P(VolumeConformance, S13BatchEqualsScalarOnEveryBit) {
  forExamples([](const Volume& volume) {
    Random random(1);
    const SampleTable& samples = volume.samples(320);
    for (int round = 0; round < 300; ++round) {
      LocalPoints points;
      for (std::size_t i = 0; i < kPatch; ++i) {
        // Anywhere, on the surface, and a hair off it.
        DVec3 p = randomIn(random, volume.measures());
        if (round % 2) {
          const auto k = static_cast<std::uint32_t>(random.below(samples.count()));
          p = DVec3(samples.position(k)) +
              static_cast<double>(random.between(-1e-6f, 1e-6f)) * DVec3(samples.normal(k));
        }
        points.x[i] = p.x;
        points.y[i] = p.y;
        points.z[i] = p.z;
      }
      for (const double dilation : {0.0, 1e-6, 1e-3 * volume.measures().thickness}) {
        const auto lanes = static_cast<std::uint32_t>(random.below(0x10000));
        const std::uint32_t in = volume.containsLanes(points, lanes, dilation);
        for (std::size_t i = 0; i < kPatch; ++i)
          ASSERT_EQ(
              (in >> i & 1) != 0,
              (lanes >> i & 1) != 0 && volume.contains({points.x[i], points.y[i], points.z[i]}, dilation));
      }
    }
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(volume.contains({nan, 0, 0}, 0));
    EXPECT_FALSE(volume.contains({0, 0, nan}, 0));
  });
}

// What the kernels look up in a grid before they ask the volume is right in every lane, near the surface and
// beyond the grid.
TEST_P(VolumeConformance, S13LookingUpCellsChangesNoSideOnAnySimdLevel) {
  forExamples([](const Volume& example) {
    Random random(12);
    const auto volume = example.kind().make(example.parameters());
    const Shape shape = testing::randomlyPosed(random, volume);
    ASSERT_EQ(*volume->cells(), nullptr);
    volume->countAsked(static_cast<std::uint32_t>(kMostGridCells));
    ASSERT_NE(*volume->cells(), nullptr);
    const Sphere& ball = shape.ball();
    PrimitiveList list{ClusterOptions{}};
    list.insert(0, {shape, Sign::Positive});
    NearBalls near;
    near.gather(list, dropBall(shape), std::numeric_limits<PrimitiveList::Label>::max());
    const SampleTable& samples = samplesOf(shape, 1024);
    const SampledShape placed = sampled(shape, samples);
    std::size_t decided = 0, asked = 0;
    for (int round = 0; round < 200; ++round) {
      float x[kPatch], y[kPatch], z[kPatch];
      for (std::size_t i = 0; i < kPatch; ++i) {
        Point p = ball.center + random.inCube(1.5f * ball.radius);
        if (round % 2) {
          const auto k = static_cast<std::uint32_t>(random.below(samples.count()));
          const PlacedSample s = placedSample(placed, k);
          p = s.position + random.between(-0.1f, 0.1f) * ball.radius * s.normal;
        }
        x[i] = p.x;
        y[i] = p.y;
        z[i] = p.z;
      }
      const DropBall sphere{ball.center.x, ball.center.y, ball.center.z, 3 * ball.radius, 0, nullptr};
      for (const SimdLevel level : supportedSimdLevels()) {
        const std::uint32_t in = ballKernels(level).insideLanes({x, y, z, 0xFFFF, sphere}, near.arrays());
        for (std::size_t i = 0; i < kPatch; ++i)
          ASSERT_EQ((in >> i & 1) != 0, contains(shape, {x[i], y[i], z[i]}))
              << nameOf(level) << " at " << x[i] << ' ' << y[i] << ' ' << z[i];
      }
    }
    // Dropping: a sphere's samples, some of them in it.
    const Shape other(ball.center + 0.3f * ball.radius * Vec3(1, 0, 0), 0.7f * ball.radius);
    const SampleTable& directions = samplesOf(other, 1024);
    const SampledShape around = sampled(other, directions);
    for (const SimdLevel level : supportedSimdLevels()) {
      std::vector<std::uint16_t> masks(directions.patches(), 0xFFFF);
      (void)ballKernels(level).dropSamples(around, dropBall(shape), masks.data());
      for (std::uint32_t k = 0; k < directions.count(); ++k)
        ASSERT_EQ((masks[k / kPatch] >> k % kPatch & 1) == 0, drops(shape, placedSample(around, k).position))
            << nameOf(level) << ", sample " << k;
    }
    // The cells themselves, by the definition.
    const GridGeometry grid(*volume);
    const std::vector<std::int8_t> sides = sidesOfCells(*volume);
    ASSERT_EQ(sides.size(), grid.cells());
    for (int k = 0; k < 20000; ++k) {
      const std::size_t cell = random.below(sides.size());
      const auto nx = static_cast<std::size_t>(grid.size[0]), ny = static_cast<std::size_t>(grid.size[1]);
      const DVec3 corner(static_cast<double>(cell % nx), static_cast<double>(cell / nx % ny),
                         static_cast<double>(cell / nx / ny));
      const DVec3 within = (DVec3(random.inCube(1)) + DVec3(1)) * 0.5;
      ++asked;
      if (sides[cell] == 0) continue;
      ++decided;
      const double dilation = sides[cell] > 0 ? 0.5 * kGridMargin * grid.cell : 0;
      ASSERT_EQ(volume->contains(grid.low + grid.cell * (corner + within), dilation), sides[cell] < 0);
    }
    std::printf("%-16s %.0f %% of cells decided\n", std::string(example.kind().name).c_str(),
                100.0 * static_cast<double>(decided) / static_cast<double>(asked));
  });
}

TEST_P(VolumeConformance, S4ClearanceNeverPromisesTooMuch) {
  forExamples([](const Volume& volume) {
    Random random(2);
    const double size = volume.measures().radius, rounding = 1e-12 * size;
    for (int k = 0; k < 20000; ++k) {
      const DVec3 p = randomIn(random, volume.measures());
      const double c = volume.clearance(p);
      for (int j = 0; j < 4; ++j) {
        // Anywhere in the ball that is promised, its rim above all.
        const DVec3 way(random.inCube(1));
        if (!(length(way) > 0.01)) continue;
        const double part = j == 0 ? 0 : j == 1 ? static_cast<double>(random.between(0, 1)) : 1;
        const double dilation = j == 2 && c > 0 ? 1e-3 * volume.measures().thickness : 0;
        const double reach = std::fabs(c) - dilation - rounding;
        if (!(reach > 0)) continue;
        const DVec3 q = p + part * reach / length(way) * way;
        ASSERT_EQ(volume.contains(q, dilation), c < 0) << "clearance " << c;
      }
    }
  });
}

TEST_P(VolumeConformance, S3SamplesLieOnTheSurfaceAndTheirNormalsPointOut) {
  forExamples([](const Volume& volume) {
    Random random(3);
    for (const std::uint32_t wanted : {16u, 160u, 2048u}) {
      const SampleTable& samples = volume.samples(wanted);
      ASSERT_EQ(samples.count() % kPatch, 0u);
      EXPECT_NEAR(samples.count(), wanted, 0.1 * wanted + 16);
      for (int pose = 0; pose < 3; ++pose) {
        const Shape shape = testing::randomlyPosed(random, volume.kind().make(volume.parameters()));
        const SampledShape placed = sampled(shape, samples);
        const float off = shape.volume()->keepOffset();
        for (std::uint32_t i = 0; i < samples.count(); ++i) {
          const PlacedSample s = placedSample(placed, i);
          ASSERT_NEAR(length(s.normal), 1, 1e-5);
          // Neither inside nor outside beyond rounding.
          ASSERT_TRUE(contains(shape, s.position - off * s.normal)) << "sample " << i;
          ASSERT_FALSE(contains(shape, s.keep)) << "sample " << i;
          ASSERT_TRUE(drops(shape, s.position)) << "sample " << i;
        }
      }
    }
  });
}

// All samples of the shape as the kernels place them, patch by patch, against placedSample.
void expectPlacedAsByDefinition(const Shape& shape, bool positive) {
  const SampleTable& samples = samplesOf(shape, 320);
  SampledShape placed = sampled(shape, samples);
  placed.positive = positive;
  for (const SimdLevel level : supportedSimdLevels())
    for (std::uint32_t patch = 0; patch < samples.patches(); ++patch) {
      PlacedPatch rows;
      ballKernels(level).placePatch(placed, patch, rows);
      for (std::uint32_t k = 0; k < kPatch; ++k) {
        const PlacedSample s = placedSample(placed, patch * static_cast<std::uint32_t>(kPatch) + k);
        const Vec3 n = positive ? s.normal : -s.normal;
        const float expected[] = {s.position.x, s.position.y, s.position.z, n.x, n.y, n.z};
        // Not EXPECT_EQ of floats, which takes the two zeros for one.
        ASSERT_EQ(std::memcmp(&rows.row[k], expected, sizeof(expected)), 0)
            << nameOf(level) << ", patch " << patch << ", sample " << k;
      }
    }
}

TEST_P(VolumeConformance, X1SamplesArePlacedWithTheSameBitsOnEverySimdLevel) {
  forExamples([](const Volume& example) {
    Random random(21);
    for (int pose = 0; pose < 8; ++pose)
      expectPlacedAsByDefinition(testing::randomlyPosed(random, example.kind().make(example.parameters())),
                                 pose % 2 == 0);
  });
}

TEST(SphereConformance, X1SamplesArePlacedWithTheSameBitsOnEverySimdLevel) {
  Random random(22);
  for (int k = 0; k < 50; ++k)
    expectPlacedAsByDefinition({random.inCube(k % 3 == 0 ? 0.0f : 4), random.between(0.01f, 3)}, k % 2 == 0);
}

TEST_P(VolumeConformance, S3SamplesAreSpreadEvenly) {
  forExamples([](const Volume& volume) {
    const Crossings truth = crossingsOf(volume, 20000, 4);
    ASSERT_GE(truth.points.size(), 10000u);
    const double size = volume.measures().radius, area = volume.measures().area;
    // Area: crossings per line (Cauchy and Crofton).
    const double measured =
        static_cast<double>(truth.points.size()) / truth.lines * 2 * 3.14159265 * size * size;
    EXPECT_NEAR(measured / area, 1, 0.04);
    for (const std::uint32_t wanted : {320u, 2048u}) {
      const SampleTable& samples = volume.samples(wanted);
      // Discrepancy: balls of random place and size hold their share.
      Random random(5);
      double worst = 0;
      for (int k = 0; k < 200; ++k) {
        const DVec3 c = truth.points[random.below(truth.points.size())];
        const double r = size * static_cast<double>(random.between(0.1f, 1.2f));
        double share = 0, expected = 0;
        for (std::uint32_t i = 0; i < samples.count(); ++i)
          share += length(DVec3(samples.position(i)) - c) <= r;
        for (const DVec3& p : truth.points) expected += length(p - c) <= r;
        worst = std::max(
            worst, std::fabs(share / samples.count() - expected / static_cast<double>(truth.points.size())));
      }
      // Of samples drawn at random the greatest would be near 1.5 / sqrt(n). What the crossings themselves
      // are off by is 0.012.
      EXPECT_LT(worst, 0.012 + 1.1 / std::sqrt(static_cast<double>(samples.count()))) << wanted;
      // Gaps, in units of the root of the area per sample; discs of 0.95 of it overlap.
      double gap = 0, within = 0;
      const double spacing = std::sqrt(area / samples.count());
      for (std::size_t k = 0; k < truth.points.size(); k += 20) {
        double nearest = std::numeric_limits<double>::max();
        for (std::uint32_t i = 0; i < samples.count(); ++i)
          nearest = std::min(nearest, length(DVec3(samples.position(i)) - truth.points[k]));
        gap = std::max(gap, nearest / spacing);
        within += nearest <= 0.95 * spacing;
      }
      // The tip of a needle is a line: its share of the samples leaves gaps along it.
      EXPECT_LT(gap, 2.2) << wanted;
      EXPECT_GT(within / std::ceil(static_cast<double>(truth.points.size()) / 20.0), 0.98) << wanted;
      RecordProperty("discrepancy", std::to_string(worst));
      std::printf("%-16s %5u samples: discrepancy %.4f, largest gap %.2f spacings\n",
                  std::string(volume.kind().name).c_str(), samples.count(), worst, gap);
    }
  });
}

TEST_P(VolumeConformance, S7RayIntervalsAgreeWithDenseSideTests) {
  forExamples([](const Volume& volume) {
    Random random(6);
    const double size = volume.measures().radius, near = size * 0x1p-20;
    std::vector<RayInterval> in;
    for (int k = 0; k < 400; ++k) {
      Ray ray = randomLine(random, volume.measures());
      if (k % 4 == 0) {  // not a unit vector
        ray.direction *= 3.5;
        ray.tMax /= 3.5;
      }
      if (k % 5 == 0) {  // along an axis
        ray.direction = DVec3(k % 3 == 0, k % 3 == 1, k % 3 == 2);
        ray.origin = randomIn(random, volume.measures()) - 3 * size * ray.direction;
      }
      in.clear();
      volume.intersect(ray, in);
      for (std::size_t i = 0; i < in.size(); ++i) {
        ASSERT_LE(in[i].enter, in[i].exit);
        if (i > 0) {
          ASSERT_LT(in[i - 1].exit, in[i].enter);
        }
      }
      const double speed = length(ray.direction);
      for (int j = 0; j < 1000; ++j) {
        const double t = ray.tMax * (j + 0.5) / 1000;
        bool inside = false, undecided = false;
        for (const RayInterval& i : in) {
          inside = inside || (i.enter <= t && t <= i.exit);
          undecided = undecided || std::min(std::fabs(t - i.enter), std::fabs(t - i.exit)) * speed < near;
        }
        if (undecided || std::fabs(volume.clearance(ray.at(t))) < near) continue;
        ASSERT_EQ(volume.contains(ray.at(t), 0), inside) << "line " << k << " at " << t;
      }
    }
  });
}

TEST_P(VolumeConformance, S4BoundsHoldTheVolumeTightly) {
  forExamples([](const Volume& volume) {
    Random random(7);
    const std::vector<DVec3> points = crossingsOf(volume, 4000, 8).points;
    const VolumeMeasures& m = volume.measures();
    for (int k = 0; k < 50; ++k) {
      const DVec3 d = normalized(DVec3(random.inCube(1)) + DVec3(1e-3, 0, 0));
      double most = -1e9;
      for (const DVec3& p : points) most = std::max(most, dot(p, d));
      ASSERT_GE(volume.support(d), most - 1e-9 * m.radius);
      ASSERT_LE(volume.support(d), most + 0.12 * m.radius);
      ASSERT_LE(volume.support(d), dot(m.center, d) + m.radius * (1 + 1e-9));
    }
    const Shape shape = testing::randomlyPosed(random, volume.kind().make(volume.parameters()));
    const Box box = boundsOf(shape);
    const SampledShape placed = sampled(shape, volume.samples(1024));
    for (std::uint32_t i = 0; i < volume.samples(1024).count(); ++i) {
      const Point p = placedSample(placed, i).position;
      ASSERT_TRUE(p.x >= box.min.x && p.y >= box.min.y && p.z >= box.min.z);
      ASSERT_TRUE(p.x <= box.max.x && p.y <= box.max.y && p.z <= box.max.z);
      ASSERT_LE(length(p - shape.ball().center), shape.ball().radius);
    }
  });
}

TEST_P(VolumeConformance, S1MonteCarloVolumeMatchesTheFormula) {
  forExamples([](const Volume& volume) {
    Random random(9);
    // In the box, so that thin volumes are hit.
    DVec3 lo, hi;
    for (int a = 0; a < 3; ++a) {
      DVec3 d(0);
      d[a] = 1;
      hi[a] = volume.support(d);
      lo[a] = -volume.support(-d);
    }
    constexpr int kPoints = 200'000;
    double in = 0;
    for (int k = 0; k < kPoints; ++k) {
      const DVec3 u = (DVec3(random.inCube(1)) + DVec3(1)) * 0.5;
      in += volume.contains(lo + u * (hi - lo), 0);
    }
    const double box = (hi.x - lo.x) * (hi.y - lo.y) * (hi.z - lo.z), part = in / kPoints;
    const double error =
        4.5 * std::sqrt(part * (1 - part) / kPoints) * box;  // one in 100,000 fails by chance
    EXPECT_NEAR(part * box, volume.measures().volume, error + 1e-6 * box);
    // And by the divergence theorem over the samples.
    const SampleTable& samples = volume.samples(16384);
    double flux = 0;
    for (std::uint32_t i = 0; i < samples.count(); ++i)
      flux += dot(DVec3(samples.position(i)) - volume.measures().center, DVec3(samples.normal(i)));
    EXPECT_NEAR(flux / 3 * volume.measures().area / samples.count() / volume.measures().volume, 1, 0.03);
  });
}

TEST_P(VolumeConformance, S3OnCoincidentBoundariesOneOwnerSurvives) {
  forExamples([](const Volume& volume) {
    Random random(10);
    const Shape shape = testing::randomlyPosed(random, volume.kind().make(volume.parameters()));
    const float density = static_cast<float>(2000 / areaOf(shape));
    points::SurfelModel model({.density = density});
    model.append(std::vector<Primitive>{{shape, Sign::Positive}});
    const std::size_t alone = model.surfelCount();
    EXPECT_EQ(alone, samplesOf(shape, sampleCount(shape, density)).count());
    model.append(std::vector<Primitive>{{shape, Sign::Positive}});  // pasted on itself
    EXPECT_EQ(model.surfelCount(), alone);
    for (const points::Surfel& s : model.surfels()) ASSERT_EQ(s.primitive, 1u);
    model.append(std::vector<Primitive>{{shape, Sign::Negative}});  // carved of exactly what was added
    EXPECT_EQ(model.surfelCount(), 0u);
    model.remove(2, 1);
    EXPECT_EQ(model.surfelCount(), alone);
  });
}

TEST_P(VolumeConformance, S13NumbersThatAreNotFiniteOrNotPositiveAreRefused) {
  const float inf = std::numeric_limits<float>::infinity();
  for (const VolumeParameters& example : kind().examples())
    for (std::size_t p = 0; p < example.values.size(); ++p)
      for (const float wrong : {std::nanf(""), inf, -inf, -1.0f}) {
        VolumeParameters parameters = example;
        if (parameters.values[p].empty()) continue;
        if (wrong == -1.0f && kind().parameters[p].form != ParameterInfo::Form::Number) continue;
        parameters.values[p][0] = wrong;
        try {
          (void)kind().make(parameters);
          FAIL() << kind().name << "." << kind().parameters[p].name << " = " << wrong << " was taken";
        } catch (const InputError& error) {
          EXPECT_NE(std::string(error.what()).find(kind().name), std::string::npos) << error.what();
        }
      }
}

INSTANTIATE_TEST_SUITE_P(All, VolumeConformance,
                         ::testing::ValuesIn(volumeKinds().begin(), volumeKinds().end()),
                         [](const auto& test) { return std::string(test.param->name); });

// Legs of swept strokes: one place each, and their samples are made again rather than held.
TEST(RoundCone, S13SamplesOfALegAreNotHeldAndComeAgainBitForBit) {
  const auto legOf = [](float length) { return roundConeKind().make({{{0.5f}, {0.4f}, {length}}}); };
  const auto leg = legOf(1.25f);
  const Shape shape(std::make_shared<const PosedVolume>(leg, Pose{}));
  EXPECT_FALSE(keepsSamples(shape));
  const std::size_t bytes = leg->bytes();
  const SampleTable& first = samplesOf(shape, 480);
  std::vector<Vec3> positions, normals;
  for (std::uint32_t i = 0; i < first.count(); ++i) {
    positions.push_back(first.position(i));
    normals.push_back(first.normal(i));
  }
  EXPECT_EQ(&samplesOf(shape, 480), &first);  // still remembered
  EXPECT_EQ(leg->bytes(), bytes);
  for (std::size_t k = 0; k < 2 * kRecentSamples; ++k)
    (void)legOf(2 + 0.1f * static_cast<float>(k))->samples(160);
  const SampleTable& again = samplesOf(shape, 480);
  ASSERT_EQ(again.count(), positions.size());
  for (std::uint32_t i = 0; i < again.count(); ++i) {
    ASSERT_EQ(again.position(i), positions[i]);
    ASSERT_EQ(again.normal(i), normals[i]);
  }
  // A tip stands in many places, and keeps what it made.
  const Shape other(std::make_shared<const PosedVolume>(leg, Pose{.position = {1, 0, 0}}));
  EXPECT_TRUE(keepsSamples(other));
  (void)samplesOf(other, 480);
  EXPECT_GT(leg->bytes(), bytes);
}

// They are not sorted: the rings that they come in are about as compact as sorting makes patches, on a needle
// a third larger, since few fit around it.
TEST(RoundCone, S4PatchesAreCompact) {
  for (const VolumeParameters& example : roundConeKind().examples()) {
    const auto volume = roundConeKind().make(example);
    const SampleTable& rings = volume->samples(1920);
    std::vector<SurfaceSample> samples;
    for (std::uint32_t i = 0; i < rings.count(); ++i)
      samples.push_back({DVec3(rings.position(i)), DVec3(rings.normal(i))});
    const SampleTable sorted(samples);
    double inRings = 0, inSorted = 0;
    for (std::uint32_t p = 0; p < rings.patches(); ++p) {
      inRings += static_cast<double>(rings.tree().level[0].radius[p]);
      inSorted += static_cast<double>(sorted.tree().level[0].radius[p]);
    }
    EXPECT_LT(inRings, 1.4 * inSorted);
  }
}

TEST(MixedLists, S3S6EveryWalkOfEditsEqualsTheDefinition) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Random random(seed);
    constexpr float kDensity = 60;
    points::SurfelModel model({.density = kDensity});
    std::vector<Primitive> plain;
    for (int step = 0; step < 60; ++step) {
      const std::size_t action = random.below(4);
      if (action == 0 && plain.size() > 2) {
        const std::size_t first = random.below(plain.size()), n = 1 + random.below(plain.size() - first);
        model.remove(first, std::min<std::size_t>(n, 3), {.threads = 1 + static_cast<int>(random.below(2))});
        plain.erase(plain.begin() + static_cast<std::ptrdiff_t>(first),
                    plain.begin() + static_cast<std::ptrdiff_t>(first + std::min<std::size_t>(n, 3)));
      } else {
        const std::size_t at = action == 1 ? random.below(plain.size() + 1) : plain.size();
        const Primitive p = testing::randomMixedPrimitive(random, plain);
        model.insert(at, std::vector<Primitive>{p});
        plain.insert(plain.begin() + static_cast<std::ptrdiff_t>(at), p);
      }
      if (step % 5 != 4) continue;
      const std::vector<points::Surfel> truth = testing::surfelsByDefinition(plain, kDensity);
      const std::vector<points::Surfel> mine = model.surfels();
      ASSERT_EQ(mine.size(), truth.size()) << "seed " << seed << " step " << step;
      for (std::size_t i = 0; i < truth.size(); ++i) {
        ASSERT_EQ(mine[i].position, truth[i].position)
            << "seed " << seed << " step " << step << " surfel " << i;
        ASSERT_EQ(mine[i].normal, truth[i].normal);
        ASSERT_EQ(mine[i].primitive, truth[i].primitive);
      }
      const std::uint64_t hash = model.stateHash();
      model.rebuild({.threads = 2});
      ASSERT_EQ(model.stateHash(), hash);
    }
  }
}

TEST(MixedLists, X1EverySimdLevelGivesTheSameState) {
  const SimdLevel before = simdLevel();
  Random random(11);
  std::vector<Primitive> plain{{Sphere{}, Sign::Positive}};
  for (int i = 0; i < 80; ++i) plain.push_back(testing::randomMixedPrimitive(random, plain));
  std::uint64_t hash = 0;
  for (const SimdLevel level : supportedSimdLevels()) {
    useSimdLevel(level);
    points::SurfelModel model({.density = 200});
    model.append(plain);
    if (hash == 0) hash = model.stateHash();
    EXPECT_EQ(model.stateHash(), hash) << nameOf(level);
  }
  useSimdLevel(before);
}

}  // namespace
}  // namespace restroke::implicit
