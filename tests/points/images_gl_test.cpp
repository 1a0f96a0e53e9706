// The OpenGL splat renderer, against the CPU's: depths agree to the stated bound.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <latch>
#include <memory>
#include <thread>

#include "implicit/errors.h"
#include "points/images/cpu_renderer.h"
#include "points/images/gl_renderer.h"
#include "points/surfel_model.h"
#include "tests/points/image_support.h"

namespace restroke::points {
namespace {

using implicit::Sign;
using restroke::testing::Random;
using testing::ballSurfels;
using testing::cameraAt;

class GlRendererTest : public ::testing::Test {
 protected:
  void SetUp() override {
    try {
      renderer_ = std::make_unique<GlRenderer>();
    } catch (const InputError& error) {
      GTEST_SKIP() << "no OpenGL on this machine: " << error.what();
    }
  }
  GlRenderer& renderer() { return *renderer_; }

 private:
  std::unique_ptr<GlRenderer> renderer_;
};

std::vector<Surfel> sculpture(float density) {
  SurfelModel model({.density = density});
  Random random(3);
  std::vector<implicit::Primitive> list = {{{{0, 0, 0}, 1.0f}, Sign::Positive}};
  while (list.size() < 120) list.push_back(restroke::testing::randomPrimitive(random, list));
  model.append(list);
  return model.surfels();
}

// SPEC S7, the bound of gl_renderer.h: kGlDepthBound / cosine on the same disc, and few pixels with another
// one.
void compareDepth(GlRenderer& renderer, const std::vector<Surfel>& surfels, const Camera& camera,
                  double rimPart) {
  const RenderedImage cpu =
      render({.surfels = surfels}, camera, {.samples = 1, .occlusion = Occlusion::None});
  const DepthImage gl = renderer.renderDepth(surfels, camera);
  ASSERT_EQ(gl.depth.size(), cpu.depth.size());
  std::size_t covered = 0, differ = 0;
  for (std::size_t p = 0; p < gl.depth.size(); ++p) {
    const bool onCpu = std::isfinite(cpu.depth[p]), onGl = std::isfinite(gl.depth[p]);
    covered += onCpu;
    if (onCpu != onGl) ++differ;
    if (!onCpu || !onGl) continue;
    const DVec3 n(cpu.normal[3 * p], cpu.normal[3 * p + 1], cpu.normal[3 * p + 2]);
    const DVec3 d = testing::rayOfPixel(camera, p).direction;
    const double cosine = -dot(n, d) / length(d);
    const double depth = static_cast<double>(cpu.depth[p]);
    if (std::fabs(static_cast<double>(gl.depth[p]) - depth) > kGlDepthBound / cosine * depth) ++differ;
  }
  EXPECT_GT(covered, gl.depth.size() / 20);
  EXPECT_LE(static_cast<double>(differ), rimPart * static_cast<double>(covered));
}

TEST_F(GlRendererTest, DepthOfASculptureAgreesWithTheCpuToTheStatedBoundS7) {
  const std::vector<Surfel> surfels = sculpture(14000);
  compareDepth(renderer(), surfels, cameraAt(4, 640, 480), kGlRimPart);
  Camera inside = cameraAt(1.6f, 500, 500);  // part of the shape is beside and behind the camera
  inside.position = {0.3f, 0.2f, 1.5f};
  inside.halfHeight = 1.1f;
  compareDepth(renderer(), surfels, inside, kGlRimPart);
}

TEST_F(GlRendererTest, DepthOfDiscsOfAllSizesAgreesWithTheCpu) {
  Random random(11);
  const std::vector<Surfel> surfels = testing::randomSurfels(random, 400, 1.5f);
  // Much of this picture is rims, some of them of discs larger than the screen.
  compareDepth(renderer(), surfels, cameraAt(6, 300, 200), 10 * kGlRimPart);
  Camera among = cameraAt(0.1f, 300, 200);
  among.halfHeight = 1.2f;
  among.near = 0.05f;
  compareDepth(renderer(), surfels, among, 10 * kGlRimPart);
}

TEST_F(GlRendererTest, FarAwayDepthsKeepTheirPrecision) {
  // near / far is 1e-6 here: an integer depth buffer with the usual mapping would have no digits left.
  const std::vector<Surfel> surfels = ballSurfels({{0, 0, -9000}, 500}, 20000);
  Camera camera = cameraAt(0, 300, 300);
  camera.halfHeight = 0.07f;
  camera.near = 0.02f;
  camera.far = 20000;
  compareDepth(renderer(), surfels, camera, kGlRimPart);
}

TEST_F(GlRendererTest, AnEmptySceneIsEmptyEverywhere) {
  const Camera camera = cameraAt(4, 33, 21);
  for (const float z : renderer().renderDepth({}, camera).depth)
    ASSERT_EQ(z, std::numeric_limits<float>::infinity());
  EXPECT_EQ(renderer().renderColor({}, camera).rgba, std::vector<float>(4 * 33 * 21, 0.0f));
}

TEST_F(GlRendererTest, AViewportOfOnePixelSeesTheMiddle) {
  const std::vector<Surfel> surfels = ballSurfels({{0, 0, 0}, 1}, 20000);
  EXPECT_NEAR(renderer().renderDepth(surfels, cameraAt(4, 1, 1)).at(0, 0), 3.0, 0.001);
}

TEST_F(GlRendererTest, PicturesOfChangingSizesDoNotDisturbEachOther) {
  const std::vector<Surfel> surfels = ballSurfels({{0, 0, 0}, 1}, 3000);
  const DepthImage first = renderer().renderDepth(surfels, cameraAt(4, 120, 80));
  const ColorImage color = renderer().renderColor({.surfels = surfels}, cameraAt(4, 64, 64));
  (void)renderer().renderDepth(surfels, cameraAt(4, 50, 200));
  EXPECT_EQ(renderer().renderDepth(surfels, cameraAt(4, 120, 80)).depth, first.depth);
  EXPECT_EQ(renderer().renderColor({.surfels = surfels}, cameraAt(4, 64, 64)).rgba, color.rgba);
}

TEST_F(GlRendererTest, ThePictureHasTheLookOfTheCpus) {
  const std::vector<Surfel> surfels = sculpture(8000);
  const Camera camera = cameraAt(4, 240, 180);
  const RenderedImage cpu = render({.surfels = surfels}, camera, {.samples = 9});
  const ColorImage gl = renderer().renderColor({.surfels = surfels}, camera, {.samples = 9});
  ASSERT_EQ(gl.rgba.size(), cpu.rgba.size());
  double sum = 0;
  std::size_t far = 0;
  for (std::size_t i = 0; i < gl.rgba.size(); ++i) {
    const double difference = std::fabs(static_cast<double>(gl.rgba[i]) - static_cast<double>(cpu.rgba[i]));
    sum += difference;
    far += difference > 0.15;
  }
  EXPECT_LT(sum / static_cast<double>(gl.rgba.size()), 0.01);
  EXPECT_LT(static_cast<double>(far),
            0.02 * static_cast<double>(gl.rgba.size()));  // edges, whose samples differ
}

TEST_F(GlRendererTest, SeveralRenderersOnSeveralThreadsGiveTheSame) {
  const std::vector<Surfel> surfels = ballSurfels({{0, 0, 0}, 1}, 3000);
  const Camera camera = cameraAt(4, 100, 100);
  const DepthImage expected = renderer().renderDepth(surfels, camera);
  GlRenderer other;
  std::vector<DepthImage> results(4);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < results.size(); ++i)
    threads.emplace_back(
        [&, i] { results[i] = (i % 2 == 0 ? renderer() : other).renderDepth(surfels, camera); });
  for (std::thread& thread : threads) thread.join();
  for (const DepthImage& result : results) EXPECT_EQ(result.depth, expected.depth);
  EXPECT_FALSE(other.driver().empty());
}

// Draws on many threads, then ends the process while these threads end.
[[noreturn]] void drawAndExit() {
  static GlRenderer renderer;
  constexpr int kThreads = 48;
  std::latch drawn(kThreads);
  for (int i = 0; i < kThreads; ++i)
    std::thread([&] {
      static_cast<void>(renderer.renderDepth({}, cameraAt(4, 2, 2)));
      drawn.arrive_and_wait();
    }).detach();
  drawn.wait();
  std::exit(0);
}

// libEGL frees what it holds for each thread both when the thread ends and when the process does.
TEST_F(GlRendererTest, TheProcessMayEndWhileThreadsThatDrewEnd) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (int i = 0; i < 20; ++i) EXPECT_EXIT(drawAndExit(), ::testing::ExitedWithCode(0), "");
}

TEST_F(GlRendererTest, RefusesOptionsAndViewportsOutOfRange) {
  EXPECT_THROW((void)renderer().renderDepth({}, cameraAt(4, 0, 10)), InputError);
  EXPECT_THROW((void)renderer().renderDepth({}, cameraAt(4, 65536, 65536)), InputError);
  EXPECT_THROW((void)renderer().renderDepth({}, cameraAt(4, 65536, 1)),
               InputError);  // beyond what drivers allow
  EXPECT_THROW((void)renderer().renderColor({}, cameraAt(4, 10, 10), {.samples = 0}), InputError);
  // It still works afterwards.
  EXPECT_EQ(renderer().renderDepth({}, cameraAt(4, 2, 2)).depth.size(), 4u);
}

}  // namespace
}  // namespace restroke::points
