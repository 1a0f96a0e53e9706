// SPEC S14: a scene that followed the shape answers rays as one built from nothing, and only what was touched
// is built again.

#include "retarget/methods/disc_scene.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "implicit/volume_kinds.h"
#include "retarget/methods/kept_discs.h"
#include "tests/retarget/test_shapes.h"
#include "tests/retarget/test_strokes.h"

namespace restroke::retarget {
namespace {

using implicit::Prefix;
using implicit::Primitive;
using implicit::Sign;

constexpr std::uint64_t kSeed = 20260811;

std::vector<Ray> grid(const Camera& camera, std::int32_t step) {
  std::vector<Ray> rays;
  for (const ScreenPoint p : screenGrid(camera, step)) rays.push_back(rayThrough(camera, p));
  return rays;
}

struct Comparison {
  std::size_t hits = 0, different = 0;
};

// Every answer of both, the discs behind the first one included, bit for bit.
Comparison compare(const DiscScene& a, const DiscScene& b, const std::vector<Ray>& rays) {
  Comparison c;
  for (const Ray& ray : rays) {
    auto from = static_cast<float>(ray.tMin);
    for (int layer = 0; layer < 3; ++layer) {
      const auto hitA = a.nearest(ray, from), hitB = b.nearest(ray, from);
      c.different += hitA.has_value() != hitB.has_value() ||
                     (hitA && (hitA->t != hitB->t || hitA->radius != hitB->radius));
      if (!hitA || !hitB) break;
      ++c.hits;
      from = std::nextafter(hitA->t, INFINITY);
    }
  }
  return c;
}

void expectAsFromNothing(DiscScene& kept, const points::SurfelModel& model, Prefix prefix) {
  static const std::vector<Ray> rays = grid(smallCamera(), 80);
  kept.update(model, prefix);
  DiscScene fresh;
  fresh.update(model, prefix);
  EXPECT_EQ(kept.discCount(), model.surfels(prefix).size());
  EXPECT_EQ(kept.discCount(), fresh.discCount());
  const Comparison c = compare(kept, fresh, rays);
  EXPECT_GT(c.hits, 1000u);
  EXPECT_EQ(c.different, 0u);
}

Primitive randomStamp(std::mt19937_64& random) {
  DVec3 p;
  do
    p = {static_cast<double>(uniform(random, -1000, 1000)), static_cast<double>(uniform(random, -1000, 1000)),
         static_cast<double>(uniform(random, -1000, 1000))};
  while (dot(p, p) < 1e4);
  p = p / std::sqrt(dot(p, p));
  // Some are larger than a cell, and cut.
  const auto radius = static_cast<float>(uniform(random, 20, random() % 8 == 0 ? 300 : 90)) / 1000;
  return {{Point(static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)), radius},
          random() % 3 == 0 ? Sign::Negative : Sign::Positive};
}

std::vector<Primitive> randomStroke(std::mt19937_64& random) {
  std::vector<Primitive> stroke;
  for (std::int64_t i = uniform(random, 1, 12); i > 0; --i) stroke.push_back(randomStamp(random));
  return stroke;
}

void randomEdit(points::SurfelModel& model, std::mt19937_64& random) {
  const auto size = static_cast<std::int64_t>(model.list().size());
  const auto at = static_cast<std::size_t>(uniform(random, 1, size));
  switch (random() % 3) {
    case 0:
      return model.append(randomStroke(random));
    case 1:
      return model.insert(at, randomStroke(random));
    default:
      return model.remove(at, std::min<std::size_t>(5, model.list().size() - at));
  }
}

TEST(DiscScene, AfterAnyWalkOfEditsItAnswersEveryRayAsOneBuiltFromNothing) {
  std::mt19937_64 random(kSeed);
  points::SurfelModel model = bumpyModel(3000);
  DiscScene whole, half;
  for (int step = 0; step < 40; ++step) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << ", step " << step);
    randomEdit(model, random);
    expectAsFromNothing(whole, model, {});
    expectAsFromNothing(half, model, {model.list().size() / 2});
    if (testing::Test::HasFailure()) return;
  }
}

TEST(DiscScene, GoesFromOnePrefixToAnotherAndFromOneModelToAnother) {
  const points::SurfelModel bumpy = bumpyModel(3000), sphere = sphereModel(3000), dense = sphereModel(6000);
  DiscScene scene;
  for (const std::size_t count : {145u, 20u, 1u, 80u, 145u}) expectAsFromNothing(scene, bumpy, {count});
  for (const points::SurfelModel* model : {&sphere, &dense, &bumpy, &dense}) {
    SCOPED_TRACE(model->surfelCount());
    expectAsFromNothing(scene, *model, {});
  }
}

TEST(DiscScene, IsThatOfTheListWhileTheModelIsBeingEdited) {
  points::SurfelModel model = bumpyModel(3000);
  DiscScene scene;
  scene.update(model);
  std::mt19937_64 random(kSeed);
  model.beginEdits();
  model.remove(10, 30);
  model.insert(20, randomStroke(random));
  expectAsFromNothing(scene, model, {model.list().size()});
  expectAsFromNothing(scene, model, {25});
  model.endEdits();
  expectAsFromNothing(scene, model, {});
}

TEST(DiscScene, AShapeThatGrowsOrShrinksAHundredfoldIsCutAnew) {
  points::SurfelModel model = sphereModel(1000);
  DiscScene scene;
  scene.update(model);
  const std::size_t groups = scene.groupCount();
  const Primitive large{{{0, 0, -105}, 100}, Sign::Positive};
  points::SurfelModel both({.density = 2});
  both.append({&large, 1});
  const Primitive unit{{Point(0), 1}, Sign::Positive};
  both.append({&unit, 1});
  expectAsFromNothing(scene, both, {});
  EXPECT_LT(scene.groupCount(), 3 * groups);
  scene.update(model);
  EXPECT_EQ(scene.rebuiltGroups(), groups);
}

TEST(DiscScene, BuildsAgainOnlyTheGroupsThatAStrokeTouches) {
  points::SurfelModel model = bumpyModel(20000);
  DiscScene scene;
  scene.update(model);
  const std::size_t all = scene.rebuiltGroups();
  EXPECT_EQ(all, scene.groupCount());
  EXPECT_GT(all, 100u);
  scene.update(model);
  EXPECT_EQ(scene.rebuiltGroups(), 0u);

  // A stamp within the cell from (0.8, 0, -0.6) to (1, 0.2, -0.4), far from others: its own group, and those
  // of the base's patches that it reaches, which may be up to a patch beyond it.
  const Primitive stamp{{{0.85f, 0.1f, -0.5f}, 0.04f}, Sign::Positive};
  model.append({&stamp, 1});
  scene.update(model);
  EXPECT_GE(scene.rebuiltGroups(), 1u);
  EXPECT_LE(scene.rebuiltGroups(), 4u);
  model.remove(model.list().size() - 1, 1);
  scene.update(model);
  EXPECT_GE(scene.rebuiltGroups(), 1u);
  EXPECT_LE(scene.rebuiltGroups(), 4u);
  EXPECT_EQ(scene.groupCount(), all) << "no group stays behind without primitives";

  // In the middle of the list: what it changes is as near as before, though all later positions move.
  model.insert(1, {&stamp, 1});
  scene.update(model);
  EXPECT_LE(scene.rebuiltGroups(), 4u);
  // Within the shape it shows nothing and hides nothing.
  const Primitive buried{{{0, 0, -0.5f}, 0.05f}, Sign::Positive};
  model.append({&buried, 1});
  scene.update(model);
  EXPECT_EQ(scene.rebuiltGroups(), 0u);
}

TEST(DiscScene, FollowsVolumesThatAreNoSpheres) {
  const auto ring = [](std::array<float, 4> rotation) {
    return std::make_shared<const implicit::PosedVolume>(
        implicit::volumeKindNamed("torus").make({.values = {{0.3f}, {0.1f}}}),
        implicit::Pose{.position = {0, 0, 1.1f}, .rotation = rotation});
  };
  points::SurfelModel model = bumpyModel(3000);
  DiscScene scene;
  scene.update(model);
  // The second takes the slot of the first and has the same ball.
  for (const auto& volume : {ring({0, 0, 0, 1}), ring({0.6f, 0, 0, 0.8f})})
    for (const Sign sign : {Sign::Positive, Sign::Negative}) {
      const Primitive primitive{volume, sign};
      model.insert(3, {&primitive, 1});
      expectAsFromNothing(scene, model, {});
      model.remove(3, 1);
    }
  const Primitive before{ring({0, 0, 0, 1}), Sign::Positive}, after{ring({0.6f, 0, 0, 0.8f}), Sign::Positive};
  EXPECT_EQ(before.shape.ball(), after.shape.ball());
  for (const Primitive& primitive : {before, after}) {
    model.append({&primitive, 1});
    expectAsFromNothing(scene, model, {});
    model.remove(model.list().size() - 1, 1);
  }
}

TEST(DiscScene, OfNothingMeetsNoRay) {
  const Ray ray = rayThrough(smallCamera(), {2560, 1920});
  DiscScene scene;
  EXPECT_FALSE(scene.nearest(ray, 0));
  const points::SurfelModel nothing({.density = 1000}), sphere = sphereModel(1000);
  scene.update(sphere);
  EXPECT_TRUE(scene.nearest(ray, 0));
  for (const auto& [model, prefix] : {std::pair(&nothing, Prefix{}), std::pair(&sphere, Prefix{0})}) {
    scene.update(*model, prefix);
    EXPECT_FALSE(scene.nearest(ray, 0));
    EXPECT_EQ(scene.discCount(), 0u);
    EXPECT_EQ(scene.groupCount(), 0u);
    scene.update(sphere);
    EXPECT_TRUE(scene.nearest(ray, 0));
  }
}

TEST(DiscScene, SizeOfCellsAndThreadsChangeNoAnswer) {
  const points::SurfelModel model = bumpyModel(5000);
  DiscScene one;
  one.update(model, {}, {.threads = 1});
  for (const double cell : {0.03, 0.5, 1000.0}) {
    DiscScene other({.cell = cell});
    other.update(model, {}, {.threads = 8});
    EXPECT_EQ(other.discCount(), one.discCount());
    EXPECT_EQ(compare(one, other, grid(smallCamera(), 33)).different, 0u) << cell;
  }
}

TEST(KeptDiscs, CastersThatShareThemCastAsThoseThatBuildTheirOwn) {
  const auto screen = screenGrid(smallCamera(), 80);
  std::mt19937_64 random(kSeed);
  points::SurfelModel model = bumpyModel(3000);
  KeptDiscs kept;
  EXPECT_EQ(kept.take(), nullptr);
  for (int step = 0; step < 10; ++step) {
    randomEdit(model, random);
    for (const std::size_t count : {model.list().size(), model.list().size() / 2}) {
      const CasterInput own{.model = model, .camera = smallCamera(), .prefix = {count}};
      CasterInput shared = own;
      shared.discs = &kept;
      const auto first = makeCaster(Method::Embree, shared);
      const auto second = makeCaster(Method::Embree, shared);  // while the first has the scene
      const auto expected = castAll(*makeCaster(Method::Embree, own), screen);
      EXPECT_EQ(castAll(*first, screen), expected);
      EXPECT_EQ(castAll(*second, screen), expected);
    }
  }
  const auto scene = kept.take();
  ASSERT_NE(scene, nullptr);
  scene->update(model, {model.list().size() / 2});
  EXPECT_EQ(scene->rebuiltGroups(), 0u) << "it was left as the last caster had it";
}

}  // namespace
}  // namespace restroke::retarget
