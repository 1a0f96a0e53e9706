// Maps whose derivative is known: held to finite differences, and to what each map promises (SPEC X2).

#include "implicit/geometry/deformations.h"

#include <gtest/gtest.h>

#include "implicit/errors.h"
#include "implicit/geometry/det_math.h"

namespace restroke {
namespace {

/// A frame that is along no axis of the model.
DeformationFrame slantedFrame() {
  const DVec3 z = normalized(DVec3(0.3, -0.5, 0.8)), x = normalized(cross(DVec3(0, 1, 0), z));
  return {.origin = {0.2, -0.1, 0.4}, .axes = {x, cross(z, x), z}};
}

std::vector<std::shared_ptr<const SmoothMap>> allMaps() {
  const auto bend = std::make_shared<BendMap>(slantedFrame(), 0.6);
  const auto twist = std::make_shared<TwistMap>(slantedFrame(), -1.3);
  const auto bulge = std::make_shared<BulgeMap>(DVec3(0.1, 0.2, 0.3), 0.9, 1.4);
  const auto dent = std::make_shared<BulgeMap>(DVec3(-0.1, 0, 0.2), 1.1, -0.8);
  const auto affine = std::make_shared<AffineStep>(Affine{{2, 0.1, 0, 0, 1, 0.3, -0.2, 0, 0.7}, {1, 2, 3}});
  return {bend,
          twist,
          bulge,
          dent,
          affine,
          std::make_shared<ComposedMap>(
              std::vector<std::shared_ptr<const SmoothMap>>{bulge, affine, bend, twist, dent})};
}

std::vector<DVec3> places() {
  std::vector<DVec3> all;
  for (double x : {-0.7, 0.0, 0.45})
    for (double y : {-0.6, 0.1, 0.8})
      for (double z : {-0.8, 0.3, 0.7}) all.emplace_back(x, y, z);
  return all;
}

TEST(Deformations, TangentsAreTheDerivativesOfPoints) {
  constexpr double h = 1e-5;
  for (const auto& map : allMaps())
    for (const DVec3& p : places()) {
      const Affine tangent = map->tangentAt(p);
      for (int k = 0; k < 3; ++k) {
        DVec3 step(0);
        step[k] = h;
        const DVec3 difference = (map->point(p + step) - map->point(p - step)) / (2 * h);
        // Central differences err by h^2 times third derivatives of at most some hundreds.
        EXPECT_LT(length(difference - tangent.direction(step / h)), 1e-7);
      }
    }
}

TEST(Deformations, NormalsStayAtRightAnglesToMappedTangentsAndOnTheirSide) {
  constexpr double h = 1e-6;
  const DVec3 n = normalized(DVec3(0.4, 0.7, -0.2)), u = normalized(cross(n, DVec3(1, 0, 0))),
              v = cross(n, u);
  for (const auto& map : allMaps())
    for (const DVec3& p : places()) {
      const DVec3 mapped = normalized(map->normal(p, n));
      for (const DVec3& along : {u, v}) {
        const DVec3 tangent = (map->point(p + h * along) - map->point(p - h * along)) / (2 * h);
        EXPECT_LT(std::fabs(dot(mapped, tangent)), 1e-7 * length(tangent));
      }
      EXPECT_GT(dot(mapped, map->point(p + h * n) - map->point(p - h * n)), 0);
    }
}

TEST(Deformations, ScaleIsTheCubeRootOfTheChangeOfVolume) {
  for (const auto& map : allMaps())
    for (const DVec3& p : places())
      EXPECT_NEAR(std::pow(map->scaleAt(p), 3), std::fabs(map->tangentAt(p).determinant()), 1e-12);
  const TwistMap twist(slantedFrame(), 2);
  EXPECT_NEAR(twist.scaleAt({1, 2, 3}), 1, 1e-14);
}

TEST(Deformations, KeepSidesApartWhereTheyPromiseToBeOneToOne) {
  for (const auto& map : allMaps())
    for (const DVec3& p : places()) EXPECT_GT(map->tangentAt(p).determinant(), 0);
}

TEST(Deformations, ABendKeepsLengthsAlongItsAxisAndMakesACircleOfIt) {
  const DeformationFrame frame = slantedFrame();
  const double k = 0.5;
  const BendMap bend(frame, k);
  const DVec3 center = frame.toModel({1 / k, 0, 0});
  for (double z : {-2.0, -0.3, 0.0, 1.0}) {
    EXPECT_NEAR(length(bend.point(frame.toModel({0, 0, z})) - center), 1 / k, 1e-14);
    EXPECT_NEAR(length(bend.tangentAt(frame.toModel({0, 0, z})).direction(frame.axes[2])), 1, 1e-14);
  }
  // A quarter of the circle.
  EXPECT_LT(length(bend.point(frame.toModel({0, 0, kPi / 2 / k})) - frame.toModel({1 / k, 0, 1 / k})), 1e-14);
  EXPECT_EQ(bend.point(frame.origin), frame.origin);
}

TEST(Deformations, SmallOnesComeCloseToTheIdentityAndNoneIsIt) {
  const DVec3 p(0.4, 0.5, -0.6);
  EXPECT_EQ(BendMap(slantedFrame(), 0).point(p), p);
  EXPECT_EQ(TwistMap(slantedFrame(), 0).point(p), p);
  EXPECT_EQ(BulgeMap({0, 0, 0}, 1, 0).point(p), p);
  EXPECT_LT(length(BendMap(slantedFrame(), 1e-9).point(p) - p), 1e-8);
  EXPECT_LT(length(TwistMap(slantedFrame(), 1e-9).point(p) - p), 1e-8);
}

TEST(Deformations, ABulgeMovesNothingOutsideItsBall) {
  const BulgeMap bulge({0, 0, 0}, 1, 1.5);
  for (const DVec3& p : {DVec3(1, 0, 0), DVec3(0.8, 0.7, 0), DVec3(-3, 4, 5)}) {
    EXPECT_EQ(bulge.point(p), p);
    EXPECT_EQ(bulge.tangentAt(p), Affine{});
  }
  EXPECT_EQ(bulge.point({0, 0, 0}), DVec3(0));
  // Outwards along a radius the order is kept up to the greatest amplitude.
  double last = 0;
  for (int i = 1; i <= 1000; ++i) {
    const double now = bulge.point({i / 1000.0, 0, 0}).x;
    EXPECT_GT(now, last);
    last = now;
  }
}

TEST(Deformations, RefuseABulgeThatWouldFoldSpace) {
  EXPECT_THROW(BulgeMap({0, 0, 0}, 1, 1.6), InputError);
  EXPECT_THROW(BulgeMap({0, 0, 0}, 1, -1), InputError);
  EXPECT_THROW(BulgeMap({0, 0, 0}, 0, 0.1), InputError);
  EXPECT_THROW(BulgeMap({0, 0, 0}, 1, std::nan("")), InputError);
}

}  // namespace
}  // namespace restroke
