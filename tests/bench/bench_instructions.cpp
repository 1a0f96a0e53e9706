// The core's operations, for tests/bench/instructions, which counts their instructions (callgrind). Without
// callgrind it only does the work.
//
//   bench_instructions [LOG|STAMPS]     prints a line for each operation: its name and how often it is done

#include <fmt/format.h>

#include <cstdio>
#include <span>
#include <vector>

#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#define RESTROKE_TELLS_CALLGRIND "tells callgrind"
#else
#define RESTROKE_TELLS_CALLGRIND "built without valgrind/callgrind.h"
#define CALLGRIND_START_INSTRUMENTATION static_cast<void>(0)
#define CALLGRIND_TOGGLE_COLLECT static_cast<void>(0)
#define CALLGRIND_DUMP_STATS_AT(name) static_cast<void>(name)
#endif

#include "implicit/errors.h"
#include "implicit/ray_cast.h"
#include "implicit/simd/dispatch.h"
#include "points/images/cpu_renderer.h"
#include "points/surfel_model.h"
#include "tests/bench/stamp_source.h"

namespace restroke::bench {
namespace {

using implicit::Primitive;
using points::SurfelModel;

constexpr float kDensity = 14000;
constexpr std::size_t kUndos = 12;
constexpr std::uint32_t kWidth = 1280, kHeight = 720;

// Counts what f does, and nothing else.
template <class F>
auto counted(const F& f) {
  CALLGRIND_TOGGLE_COLLECT;
  auto result = f();
  CALLGRIND_TOGGLE_COLLECT;
  return result;
}

// What was counted since the last report is this operation's.
void report(const char* operation, std::size_t times) {
  CALLGRIND_DUMP_STATS_AT(operation);
  fmt::print("{} {}\n", operation, times);
}

std::size_t stamp(SurfelModel& model, std::span<const Primitive> stamps) {
  for (const Primitive& one : stamps) model.append(std::span(&one, 1), {.threads = 1});
  return stamps.size();
}

// Undoes strokes that are spread over the list, each put back before the next.
std::size_t undoSome(SurfelModel& model, const StampSource& source) {
  std::size_t first = 1, done = 0;
  const std::size_t strokes = source.strokes.size();
  for (std::size_t s = 0; s < strokes; ++s) {
    const std::size_t count = source.strokes[s];
    if (s * kUndos / strokes != (s + 1) * kUndos / strokes) {
      done += counted([&] {
        model.remove(first, count, {.threads = 1});
        return std::size_t{1};
      });
      model.insert(first, std::span(source.primitives).subspan(first, count), {.threads = 1});
    }
    first += count;
  }
  return done;
}

// In pixel order, every 48th row and every 4th column: hits and misses as in the whole picture.
std::vector<Ray> someRays(const Camera& camera) {
  std::vector<Ray> rays;
  for (std::int32_t y = 24; y < static_cast<std::int32_t>(kHeight); y += 48)
    for (std::int32_t x = 2; x < static_cast<std::int32_t>(kWidth); x += 4)
      rays.push_back(rayThrough(camera, {x * kSubPixels, y * kSubPixels}));
  return rays;
}

int run(std::span<char* const> words) {
  if (words.size() > 1) throw InputError("one log or stamp list is taken");
  const std::filesystem::path shipped =
      std::filesystem::path(RESTROKE_SOURCE_DIR) / "experiments/examples/paper-scale.log";
  const StampSource source = loadStamps(words.empty() ? shipped : std::filesystem::path(words[0]));
  if (source.primitives.size() < 2)
    throw InputError(fmt::format("{}: a base and a stamp are needed", source.name));
  fmt::print("built by {}; simd {}; {}\n", RESTROKE_BENCH_COMPILER, implicit::simdLevelName(),
             RESTROKE_TELLS_CALLGRIND);

  SurfelModel model({.density = kDensity});
  model.append(std::span(source.primitives).first(1), {.threads = 1});
  CALLGRIND_START_INSTRUMENTATION;
  report("stamp", counted([&] { return stamp(model, std::span(source.primitives).subspan(1)); }));
  report("undo", undoSome(model, source));
  report("rebuild", counted([&] {
           model.rebuild({.threads = 1});
           return std::size_t{1};
         }));
  const implicit::Sphere around = model.list().boundingSphere();
  const Camera camera =
      frameSphere(around.center, around.radius, {.view = {-1, -1, -2}, .width = kWidth, .height = kHeight});
  const std::vector<Ray> rays = someRays(camera);
  std::size_t hits = 0;
  report("ray", counted([&] {
           for (const Ray& ray : rays) hits += implicit::castRay(model.list(), ray).has_value();
           return rays.size();
         }));
  report("picture", counted([&] {
           const std::vector<points::Surfel> surfels = model.surfels({.threads = 1});
           const points::RenderedImage image =
               points::render({.surfels = surfels}, camera,
                              {.samples = 1, .occlusion = points::Occlusion::None}, {.threads = 1});
           return image.pixels() / (std::size_t{kWidth} * kHeight);
         }));
  return hits > 0 ? 0 : 1;
}

}  // namespace
}  // namespace restroke::bench

int main(int argc, char** argv) {
  try {
    return restroke::bench::run(std::span(argv + 1, static_cast<std::size_t>(argc - 1)));
  } catch (const restroke::InputError& error) {
    fmt::print(stderr, "bench_instructions: {}\n", error.what());
    return 2;
  }
}
