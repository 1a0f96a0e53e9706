// What a picture costs while sculpting, without a graphics card (SPEC S11: edited and drawn at 60 frames a
// second): 1280 x 720 pixels of the shared list of stamps, at every SIMD level and with one and two threads.
// The rival is OpenGL on whatever driver EGL finds, which is Mesa's software driver where there is no card.
//
//   bench_picture [--smoke] [LOG|STAMPS]

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "implicit/errors.h"
#include "implicit/geometry/camera.h"
#include "implicit/simd/dispatch.h"
#include "points/images/cpu_renderer.h"
#include "points/images/gl_renderer.h"
#include "points/surfel_model.h"
#include "tests/bench/stamp_source.h"

namespace restroke::bench {
namespace {

constexpr points::RenderOptions kPlain = {.samples = 1, .occlusion = points::Occlusion::None};
/// What a window needs.
constexpr points::Layers kWindow = {.depth = true, .normal = false, .ids = false};

struct Size {
  std::uint32_t width = 1280, height = 720;
  int rounds = 15;
  std::size_t stamps = 400;  ///< of the end of the list, one a frame
};

struct Times {
  double wall = 0, cpu = 0;  ///< milliseconds, medians
};

double cpuMilliseconds() {
  std::timespec t = {};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

Times timed(int rounds, const std::function<void()>& f) {
  f();  // memory that is kept, tables
  std::vector<double> wall, cpu;
  for (int i = 0; i < rounds; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const double cpuStart = cpuMilliseconds();
    f();
    cpu.push_back(cpuMilliseconds() - cpuStart);
    wall.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  return {median(wall), median(cpu)};
}

std::string cell(const Times& times) {
  return fmt::format("{:8.2f} ({:6.2f})", times.wall, times.cpu);
}

struct Subject {
  StampSource source;
  points::SurfelModel model{{.density = 14000}};
  std::vector<points::Surfel> surfels;
  Camera camera;
};

/// Stamps the end of the list, one a frame: append, surfels, picture.
Times frames(const Subject& subject, const Size& size, const Execution& execution) {
  const std::span<const implicit::Primitive> all = subject.source.primitives;
  const std::size_t drawn = std::min(size.stamps, all.size() - 1);
  points::SurfelModel model(subject.model.sampling());
  model.append(all.first(all.size() - drawn));
  points::CpuRenderer renderer(kWindow);
  std::vector<points::Surfel> surfels;
  std::size_t next = all.size() - drawn;
  return timed(static_cast<int>(drawn) - 1, [&] {
    model.append(all.subspan(next++, 1), execution);
    model.surfels(surfels, execution);
    renderer.render({.surfels = surfels}, subject.camera, kPlain, execution);
  });
}

void printRow(const Subject& subject, const Size& size, const Execution& execution) {
  const points::Scene scene = {.surfels = subject.surfels};
  points::CpuRenderer renderer(kWindow), all;
  std::vector<points::Surfel> listed;
  const Times surfels = timed(size.rounds, [&] { subject.model.surfels(listed, execution); });
  const Times depth =
      timed(size.rounds, [&] { renderer.renderDepth(subject.surfels, subject.camera, execution); });
  const Times window = timed(size.rounds, [&] { renderer.render(scene, subject.camera, kPlain, execution); });
  const Times layers = timed(size.rounds, [&] { all.render(scene, subject.camera, kPlain, execution); });
  const Times smooth =
      timed(size.rounds / 4 + 1, [&] { renderer.render(scene, subject.camera, {}, execution); });
  const Times frame = frames(subject, size, execution);
  fmt::print("{:<7} {:7} {} {} {} {} {} {} {:6.0f}\n", implicit::simdLevelName(), execution.threads,
             cell(surfels), cell(depth), cell(window), cell(layers), cell(smooth), cell(frame),
             1e3 / frame.wall);
}

void printOpenGl(const Subject& subject, const Size& size) {
  try {
    points::GlRenderer renderer;
    const points::Scene scene = {.surfels = subject.surfels};
    const int rounds = size.rounds / 4 + 1;
    const Times depth = timed(rounds, [&] { (void)renderer.renderDepth(subject.surfels, subject.camera); });
    const Times color = timed(rounds, [&] { (void)renderer.renderColor(scene, subject.camera, kPlain); });
    const Times smooth = timed(rounds, [&] { (void)renderer.renderColor(scene, subject.camera); });
    fmt::print("{:<7} {:>7} {:>17} {} {} {:>17} {}\n", "OpenGL", "", "", cell(depth), cell(color), "",
               cell(smooth));
    fmt::print("OpenGL is {}\n", renderer.driver());
  } catch (const InputError& error) {
    fmt::print("no OpenGL: {}\n", error.what());
  }
}

/// The pictures of all levels and thread counts must have the same bits; false, with a sentence, where not.
bool agree(const Subject& subject) {
  std::optional<points::RenderedImage> first;
  for (const implicit::SimdLevel level : implicit::supportedSimdLevels())
    for (const int threads : {1, 2}) {
      implicit::useSimdLevel(level);
      points::RenderedImage image =
          points::render({.surfels = subject.surfels}, subject.camera, kPlain, {.threads = threads});
      if (!first)
        first = std::move(image);
      else if (image.rgba != first->rgba || image.depth != first->depth) {
        fmt::print("{} with {} threads draws another picture\n", implicit::nameOf(level), threads);
        return false;
      }
    }
  return true;
}

}  // namespace
}  // namespace restroke::bench

int main(int argc, char** argv) {
  using namespace restroke;
  using namespace restroke::bench;
  const bool smoke = argc > 1 && std::strcmp(argv[1], "--smoke") == 0;
  const int fileAt = smoke ? 2 : 1;
  Size size;
  if (smoke) size = {.width = 160, .height = 90, .rounds = 1, .stamps = 4};
  try {
    Subject subject;
    subject.source = loadStamps(argc > fileAt ? argv[fileAt] : "");
    if (smoke) subject.source.primitives.resize(std::min<std::size_t>(subject.source.primitives.size(), 60));
    subject.model.append(subject.source.primitives);
    subject.surfels = subject.model.surfels();
    const implicit::Sphere ball = subject.model.list().boundingSphere();
    subject.camera = frameSphere(ball.center, ball.radius,
                                 {.view = {-1, -1, -2}, .width = size.width, .height = size.height});
    fmt::print("{}: {} primitives, {} surfels, {} x {} pixels\n", subject.source.name,
               subject.source.primitives.size(), subject.surfels.size(), size.width, size.height);
    fmt::print(
        "ms: median (CPU time of all threads). \"colour\" has one sample a pixel and depth, \"layers\" "
        "normals and ids too, \"smooth\" is with the default options;\n\"frame\" is a stamp, surfels() "
        "and \"colour\"\n");
    fmt::print("{:<7} {:>7} {:>17} {:>17} {:>17} {:>17} {:>17} {:>17} {:>6}\n", "SIMD", "threads",
               "surfels()", "depth", "colour", "layers", "smooth", "frame", "1/s");
    for (const implicit::SimdLevel level : implicit::supportedSimdLevels())
      for (const int threads : {1, 2}) {
        implicit::useSimdLevel(level);
        printRow(subject, size, {.threads = threads});
      }
    printOpenGl(subject, size);
    return agree(subject) ? 0 : 1;
  } catch (const InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
