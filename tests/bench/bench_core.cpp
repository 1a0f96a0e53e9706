// The core's operations, one by one (Google Benchmark). `bench_core --benchmark_filter=Stamp` runs a part.

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "implicit/geometry/camera.h"
#include "implicit/ray_cast.h"
#include "implicit/side.h"
#include "points/surfel_model.h"
#include "tests/bench/stamp_source.h"

namespace restroke::bench {
namespace {

const StampSource& source() {
  static const StampSource s = loadStamps();
  return s;
}

points::SurfelModel modelOf(float cell) {
  points::SurfelModel model({.density = 14000}, {.cell = cell});
  model.append(source().primitives);
  return model;
}

// Cell size in thousandths of a model unit: why ClusterOptions::cell is 0.2 of the model's half size.
void Replay(benchmark::State& state) {
  for (auto _ : state)
    benchmark::DoNotOptimize(modelOf(static_cast<float>(state.range(0)) * 1e-3f).surfelCount());
  state.counters["stamp"] =
      benchmark::Counter(static_cast<double>(source().primitives.size()),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["cluster bytes/primitive"] =
      static_cast<double>(modelOf(static_cast<float>(state.range(0)) * 1e-3f).bytes().clusters) /
      static_cast<double>(source().primitives.size());
}
BENCHMARK(Replay)->Arg(30)->Arg(50)->Arg(70)->Arg(100)->Arg(150)->Arg(200)->Arg(400)->Unit(
    benchmark::kMillisecond);

// Exact rays through the pixels of a picture that the model fills: cell size in thousandths of a model unit;
// pixels scattered (0) or in row order (1); the whole list (0) or its first half (1). Made beforehand:
// castRay alone is measured.
void Rays(benchmark::State& state) {
  constexpr std::int32_t kWidth = 640, kHeight = 360, kRays = 20000;
  const points::SurfelModel model = modelOf(static_cast<float>(state.range(0)) * 1e-3f);
  const bool rows = state.range(1) != 0, half = state.range(2) != 0;
  const implicit::Sphere ball = model.list().boundingSphere();
  const Camera camera =
      frameSphere(ball.center, ball.radius, {.view = {-1, -1, -2}, .width = kWidth, .height = kHeight});
  std::vector<Ray> rays;
  for (std::int32_t i = 0; i < kRays; ++i) {
    // In row order, every third row and every fourth pixel: as many, and as many that hit.
    const std::int32_t x = i % (kWidth / 4), y = i / (kWidth / 4);
    rays.push_back(rayThrough(camera, rows ? ScreenPoint{64 * x + 8, (48 * y + 8) % (kHeight * kSubPixels)}
                                           : ScreenPoint{(i * 7919) % (kWidth * kSubPixels),
                                                         (i * 104729) % (kHeight * kSubPixels)}));
  }
  const implicit::Prefix prefix{half ? model.list().size() / 2 : model.list().size()};
  std::size_t i = 0, hits = 0;
  for (auto _ : state) {
    hits += implicit::castRay(model.list(), rays[i], prefix).has_value();
    i = i + 1 == rays.size() ? 0 : i + 1;
  }
  state.SetItemsProcessed(state.iterations());
  state.counters["hit share"] = static_cast<double>(hits) / static_cast<double>(state.iterations());
  state.SetLabel(fmt::format("{}, {}, {}", rows ? "row order" : "scattered",
                             half ? "half the list" : "whole list", implicit::simdLevelName()));
}
BENCHMARK(Rays)
    ->Args({50, 0, 0})
    ->Args({100, 0, 0})
    ->Args({400, 0, 0})
    ->Args({200, 0, 0})
    ->Args({200, 0, 1})
    ->Args({200, 1, 0})
    ->Args({200, 1, 1});

void Rebuild(benchmark::State& state) {
  points::SurfelModel model = modelOf(0.2f);
  for (auto _ : state) model.rebuild({.threads = static_cast<int>(state.range(0))});
}
BENCHMARK(Rebuild)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void UndoInTheMiddle(benchmark::State& state) {
  points::SurfelModel model = modelOf(0.2f);
  std::size_t stroke = 0, first = 1;
  for (auto _ : state) {
    const std::size_t n = source().strokes[stroke];
    model.remove(first, n, {.threads = 1});
    state.PauseTiming();
    model.insert(first, std::span(source().primitives).subspan(first, n));
    first += n;
    if (++stroke == source().strokes.size()) stroke = 0, first = 1;
    state.ResumeTiming();
  }
}
BENCHMARK(UndoInTheMiddle)->Unit(benchmark::kMicrosecond);

void Surfels(benchmark::State& state) {
  const points::SurfelModel model = modelOf(0.2f);
  for (auto _ : state) benchmark::DoNotOptimize(model.surfels({.threads = 1}).data());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(model.surfelCount()));
}
BENCHMARK(Surfels)->Unit(benchmark::kMillisecond);

void Sides(benchmark::State& state) {
  const points::SurfelModel model = modelOf(0.2f);
  std::vector<Point> points;
  for (const points::Surfel& s : model.surfels()) points.push_back(s.position + s.normal * 0.001f);
  std::vector<implicit::Side> sides(points.size());
  const bool batch = state.range(0) != 0;
  for (auto _ : state) {
    if (batch)
      sidesOf(model.list(), points, sides, {}, {.threads = 1});
    else
      for (std::size_t i = 0; i < points.size(); ++i) sides[i] = sideOf(model.list(), points[i]);
    benchmark::DoNotOptimize(sides.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points.size()));
  state.SetLabel(batch ? "batch" : "one by one");
}
BENCHMARK(Sides)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace restroke::bench

BENCHMARK_MAIN();
