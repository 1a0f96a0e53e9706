// The CPU pictures at every SIMD level: the same bits, and those of the formulas taken one by one (SPEC S11,
// X1).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "implicit/errors.h"
#include "implicit/simd/dispatch.h"
#include "points/images/cpu_renderer.h"
#include "points/surfel_model.h"
#include "tests/points/image_support.h"
#include "tests/points/picture_oracle.h"

namespace restroke::points {
namespace {

using implicit::Sign;
using implicit::SimdLevel;
using restroke::testing::Random;
using testing::cameraAt;
using testing::OraclePicture;
using testing::oraclePicture;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr RenderOptions kPlain = {.samples = 1, .occlusion = Occlusion::None};

/// Calls f at every level that this processor has, and puts the level back.
void atEveryLevel(const std::function<void()>& f) {
  const SimdLevel before = implicit::simdLevel();
  for (const SimdLevel level : implicit::supportedSimdLevels()) {
    SCOPED_TRACE(implicit::nameOf(level));
    implicit::useSimdLevel(level);
    f();
  }
  implicit::useSimdLevel(before);
}

/// The first place where the bits differ.
template <class T>
::testing::AssertionResult sameBits(const std::vector<T>& a, const std::vector<T>& b) {
  if (a.size() != b.size()) return ::testing::AssertionFailure() << a.size() << " and " << b.size();
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::memcmp(&a[i], &b[i], sizeof(T)) != 0)
      return ::testing::AssertionFailure() << "at " << i << ": " << a[i] << " and " << b[i];
  return ::testing::AssertionSuccess();
}

void expectSame(const RenderedImage& a, const RenderedImage& b) {
  EXPECT_TRUE(sameBits(a.rgba, b.rgba));
  EXPECT_TRUE(sameBits(a.depth, b.depth));
  EXPECT_TRUE(sameBits(a.normal, b.normal));
  EXPECT_TRUE(sameBits(a.primitive, b.primitive));
  EXPECT_TRUE(sameBits(a.stroke, b.stroke));
}

/// Discs that a renderer may stumble over, among others.
std::vector<Surfel> awkwardSurfels(Random& random, std::size_t count) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Surfel> surfels = testing::randomSurfels(random, count, 1.5f);
  for (std::size_t i = 0; i < surfels.size(); i += 3) {
    Surfel& s = surfels[i];
    switch (random.below(12)) {
      case 0:
        s.position[static_cast<int>(random.below(3))] = random.below(2) == 0 ? nan : kInfinity;
        break;
      case 1:
        s.normal[static_cast<int>(random.below(3))] = random.below(2) == 0 ? nan : -kInfinity;
        break;
      case 2:
        s.radius = random.below(2) == 0 ? nan : kInfinity;
        break;
      case 3:
        s.radius = random.below(2) == 0 ? 0.0f : -s.radius;
        break;
      case 4:
        s.normal = Vec3(0);
        break;
      case 5:  // edge-on for a camera on the z axis
        s.normal = {1, 0, 0};
        s.position.x = random.below(2) == 0 ? 0.0f : random.between(-1e-4f, 1e-4f);
        break;
      case 6:  // far larger than the picture
        s.radius = random.between(10.0f, 1e5f);
        break;
      case 7:  // between pixels
        s.radius = 1e-5f;
        break;
      case 8:  // axis-aligned, as many are
        s.normal = {0, 0, 1};
        s.position.x = s.position.y = 0;
        break;
      case 9:  // the same again, at the same depth
        if (i > 0) s = surfels[i - 1];
        break;
      case 10:  // far beside and far behind
        s.position = s.position * 1000.0f;
        break;
      default:  // at the camera
        s.position = {0, 0, random.between(3.9f, 4.1f)};
    }
  }
  return surfels;
}

std::vector<Camera> awkwardCameras() {
  std::vector<Camera> cameras = {cameraAt(4, 97, 71), cameraAt(0.1f, 66, 130), cameraAt(4, 1, 1),
                                 cameraAt(2, 200, 3)};
  cameras[1].halfHeight = 1.2f;
  cameras.push_back(cameraAt(6, 130, 65));
  cameras.back().near = 5.5f;
  cameras.back().far = 6.5f;
  cameras.push_back(cameraAt(3, 65, 64));
  cameras.back().position = {1.5f, -2.0f, 2.5f};
  cameras.back().view = {-2.0f, 2.5f, -3.0f};
  cameras.back().up = {0.3f, 0.1f, 1.0f};
  cameras.push_back(cameraAt(4, 90, 60));
  cameras.back().halfHeight = 0.02f;  // most discs are beside the picture
  return cameras;
}

TEST(PictureKernels, DepthAndColourHaveTheBitsOfTheFormulasAtEveryLevelAndThreadCountX1) {
  Random random(2024);
  for (const Camera& camera : awkwardCameras()) {
    const std::vector<Surfel> surfels = awkwardSurfels(random, 301);
    const Scene scene = {.surfels = surfels};
    const OraclePicture expected = oraclePicture(scene, camera);
    const auto covered = std::count_if(expected.depth.begin(), expected.depth.end(),
                                       [](float depth) { return std::isfinite(depth); });
    EXPECT_GT(covered, 0);
    SCOPED_TRACE(fmt::format("{} x {}", camera.width, camera.height));
    atEveryLevel([&] {
      for (const int threads : {1, 2, 8}) {
        EXPECT_TRUE(sameBits(renderDepth(surfels, camera, {.threads = threads}).depth, expected.depth));
        const RenderedImage image = render(scene, camera, kPlain, {.threads = threads});
        EXPECT_TRUE(sameBits(image.depth, expected.depth));
        EXPECT_TRUE(sameBits(image.rgba, expected.rgba));
      }
    });
  }
}

TEST(PictureKernels, ASculptureHasTheBitsOfTheFormulas) {
  SurfelModel model({.density = 1500});
  Random random(5);
  std::vector<implicit::Primitive> list = {{{{0, 0, 0}, 1.0f}, Sign::Positive}};
  for (int i = 0; i < 60; ++i) list.push_back(restroke::testing::randomPrimitive(random, list));
  model.append(list);
  const std::vector<Surfel> surfels = model.surfels();
  const Camera camera = cameraAt(4, 160, 120);
  const OraclePicture expected = oraclePicture({.surfels = surfels}, camera);
  atEveryLevel([&] {
    EXPECT_TRUE(sameBits(renderDepth(surfels, camera).depth, expected.depth));
    EXPECT_TRUE(sameBits(render({.surfels = surfels}, camera, kPlain).rgba, expected.rgba));
  });
}

TEST(PictureKernels, PicturesWithAllOptionsHaveTheSameBitsAtEveryLevelX1) {
  SurfelModel model({.density = 6000});
  Random random(6);
  std::vector<implicit::Primitive> list = {{{{0, 0, 0}, 1.0f}, Sign::Positive}};
  for (int i = 0; i < 40; ++i) list.push_back(restroke::testing::randomPrimitive(random, list));
  model.append(list);
  const std::vector<Surfel> surfels = model.surfels();
  std::vector<std::uint32_t> strokes(list.size());
  for (std::size_t i = 0; i < strokes.size(); ++i) strokes[i] = static_cast<std::uint32_t>(i / 5);
  const Camera camera = cameraAt(4, 301, 222);
  for (const implicit::PrimitiveList* known :
       {static_cast<const implicit::PrimitiveList*>(nullptr), &model.list()}) {
    const Scene scene = {.surfels = surfels, .strokeOfPrimitive = strokes, .list = known};
    const RenderedImage expected = render(scene, camera, {}, {.threads = 1});
    atEveryLevel([&] {
      for (const int threads : {1, 3}) expectSame(render(scene, camera, {}, {.threads = threads}), expected);
    });
  }
}

TEST(CpuRenderer, DrawsOnePictureAfterTheOtherIntoTheSameMemoryWithoutATraceOfTheLast) {
  Random random(11);
  CpuRenderer renderer;
  const std::vector<Surfel> many = awkwardSurfels(random, 9000), few = awkwardSurfels(random, 20), none;
  // A picture of the same kind leaves alone what it knows to be empty; one of another kind does not.
  for (const RenderOptions& options : {kPlain, RenderOptions{}, kPlain})
    for (const Camera& camera : {cameraAt(4, 200, 150), cameraAt(4, 70, 40), cameraAt(40, 200, 150)})
      for (const std::vector<Surfel>* surfels : {&few, &many, &none, &few}) {
        const Scene scene = {.surfels = *surfels};
        expectSame(renderer.render(scene, camera, options), render(scene, camera, options));
        EXPECT_TRUE(
            sameBits(renderer.renderDepth(*surfels, camera).depth, renderDepth(*surfels, camera).depth));
      }
}

TEST(CpuRenderer, MemoryIsUsedAgainForPicturesOfTheSameSize) {
  Random random(12);
  const std::vector<Surfel> surfels = awkwardSurfels(random, 500);
  CpuRenderer renderer;
  const float* const rgba = renderer.render({.surfels = surfels}, cameraAt(4, 90, 70), kPlain).rgba.data();
  EXPECT_EQ(renderer.render({.surfels = surfels}, cameraAt(5, 90, 70), kPlain).rgba.data(), rgba);
}

TEST(CpuRenderer, LayersThatAreNotWantedAreEmptyAndChangeNoOther) {
  Random random(13);
  const std::vector<Surfel> surfels = awkwardSurfels(random, 500);
  const Scene scene = {.surfels = surfels};
  const Camera camera = cameraAt(4, 90, 70);
  const RenderedImage all = render(scene, camera);
  CpuRenderer bare({.depth = false, .normal = false, .ids = false});
  const RenderedImage& colour = bare.render(scene, camera);
  EXPECT_TRUE(sameBits(colour.rgba, all.rgba));
  EXPECT_TRUE(colour.depth.empty());
  EXPECT_TRUE(colour.normal.empty());
  EXPECT_TRUE(colour.primitive.empty());
  EXPECT_TRUE(colour.stroke.empty());
  CpuRenderer window({.normal = false, .ids = false});
  EXPECT_TRUE(sameBits(window.render(scene, camera).depth, all.depth));
  CpuRenderer picker({.depth = false, .normal = false});
  EXPECT_TRUE(sameBits(picker.render(scene, camera).primitive, all.primitive));
}

}  // namespace
}  // namespace restroke::points
