// What all methods promise (SPEC S7), and `exact` against the sphere's own formula.

#include "retarget/method.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "implicit/errors.h"
#include "tests/retarget/test_shapes.h"

namespace restroke::retarget {
namespace {

constexpr Method kWithoutOpenGl[] = {Method::DepthCpu, Method::Embree, Method::Exact};

TEST(Method, NamesAndMethodsAreOneToOne) {
  for (const Method method : {Method::Depth, Method::DepthCpu, Method::Embree, Method::Exact})
    EXPECT_EQ(methodNamed(nameOf(method)), method);
  EXPECT_EQ(nameOf(Method::DepthCpu), "depth-cpu");
}

TEST(Method, UnknownNameIsRejectedWithTheNames) {
  for (const char* name : {"", "Exact", "depthcpu"}) try {
      static_cast<void>(methodNamed(name));
      ADD_FAILURE() << name;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()),
                "method '" + std::string(name) +
                    "' is not known; the methods are depth, depth-cpu, embree, exact, "
                    "fixed, nearest, mapped, surface, aligned");
    }
}

TEST(Method, DriversAndInstructionSetsMakeOutcomesThatAreRecorded) {
  EXPECT_TRUE(isDeterministic(Method::Exact));
  EXPECT_TRUE(isDeterministic(Method::DepthCpu));
  for (const Method method : {Method::Fixed, Method::Nearest, Method::Mapped, Method::Surface})
    EXPECT_TRUE(isDeterministic(method)) << nameOf(method);
  EXPECT_FALSE(isDeterministic(Method::Aligned));
  EXPECT_FALSE(isDeterministic(Method::Depth));
  EXPECT_FALSE(isDeterministic(Method::Embree));
}

TEST(Method, ExactHitsTheSphereWhereItsFormulaSays) {
  const auto model = sphereModel(500);
  const Camera camera = smallCamera();
  const auto caster = makeCaster(Method::Exact, model, camera);
  std::size_t hits = 0, misses = 0;
  for (const ScreenPoint p : screenGrid(camera, 37)) {
    const auto truth = unitSphereAt(rayThrough(camera, p));
    const auto hit = caster->cast(p);
    ASSERT_EQ(hit.has_value(), truth.has_value()) << p.x << ", " << p.y;
    ++(hit ? hits : misses);
    if (!hit) continue;
    EXPECT_LT(length(DVec3(hit->position) - truth->place), 1e-6);
    EXPECT_LT(length(DVec3(hit->normal) - truth->place), 1e-6);
  }
  EXPECT_GT(hits, 1000u);
  EXPECT_GT(misses, 1000u);
}

TEST(Method, NoneHitsAnEmptyShape) {
  const points::SurfelModel nothing({.density = 500});
  const auto sphere = sphereModel(500);
  for (const Method method : kWithoutOpenGl) {
    EXPECT_FALSE(makeCaster(method, nothing, smallCamera())->cast(ScreenPoint{2560, 1920})) << nameOf(method);
    EXPECT_FALSE(makeCaster(method, sphere, smallCamera(), {.count = 0})->cast(ScreenPoint{2560, 1920}))
        << nameOf(method);
    EXPECT_TRUE(makeCaster(method, sphere, smallCamera())->cast(ScreenPoint{2560, 1920})) << nameOf(method);
  }
}

TEST(Method, EachSeesAPrefixAsTheListThatHasOnlyThat) {
  const auto whole = bumpyModel(3000);
  for (const std::size_t count : {std::size_t{1}, std::size_t{20}, std::size_t{77}}) {
    points::SurfelModel part({.density = 3000});
    std::vector<implicit::Primitive> primitives;
    for (std::size_t i = 0; i < count; ++i) primitives.push_back(whole.list().at(i));
    part.append(primitives);
    const auto screen = screenGrid(smallCamera(), 61);
    for (const Method method : kWithoutOpenGl) {
      const auto ofPrefix = castAll(*makeCaster(method, whole, smallCamera(), {.count = count}), screen);
      EXPECT_EQ(ofPrefix, castAll(*makeCaster(method, part, smallCamera()), screen))
          << nameOf(method) << " " << count;
      EXPECT_NE(ofPrefix, castAll(*makeCaster(method, whole, smallCamera()), screen))
          << nameOf(method) << " " << count;
    }
  }
}

TEST(Method, ACarvedHollowIsHitAtItsBottomWithTheNormalOutOfTheShape) {
  auto model = sphereModel(20000);
  const implicit::Primitive hollow{{{0, 0, 1}, 0.25f}, implicit::Sign::Negative};
  model.append({&hollow, 1});
  const ScreenPoint middle{160 * kSubPixels + 8, 120 * kSubPixels + 8};
  for (const Method method : kWithoutOpenGl) {
    const auto hit = makeCaster(method, model, smallCamera())->cast(middle);
    ASSERT_TRUE(hit) << nameOf(method);
    EXPECT_NEAR(static_cast<double>(hit->position.z), 0.75, 0.003) << nameOf(method);
    EXPECT_GT(static_cast<double>(hit->normal.z), 0.95) << nameOf(method);
  }
}

TEST(Method, TheNearAndFarPlanesBoundTheRay) {
  const auto model = sphereModel(2000);
  const ScreenPoint middle{2560, 1920};
  Camera nearCut = smallCamera(), farCut = smallCamera();
  nearCut.near = 3.5f;  // within the ball: the ray would have to leave first
  farCut.far = 2.9f;    // before the ball
  for (const Method method : kWithoutOpenGl) {
    EXPECT_FALSE(makeCaster(method, model, nearCut)->cast(middle)) << nameOf(method);
    EXPECT_FALSE(makeCaster(method, model, farCut)->cast(middle)) << nameOf(method);
  }
}

TEST(Method, ThreadsChangeNothing) {
  const auto model = bumpyModel(3000);
  const auto screen = screenGrid(smallCamera(), 61);
  for (const Method method : kWithoutOpenGl)
    EXPECT_EQ(castAll(*makeCaster(method, model, smallCamera(), {}, {.threads = 1}), screen),
              castAll(*makeCaster(method, model, smallCamera(), {}, {.threads = 8}), screen))
        << nameOf(method);
}

}  // namespace
}  // namespace restroke::retarget
