// Tri-dexels against their rivals, in one run: one table, and beside each figure what it is to reach.
// README.md beside this file says how to read it.
//
//   bench_dexel [LOG|STAMPS] [--smoke] [--json FILE]
//
// Exit 1 when a result is not what it has to be.

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <span>
#include <string_view>

#include "experiments/random.h"
#include "experiments/text.h"
#include "implicit/errors.h"
#include "implicit/primitive_list.h"
#include "implicit/side.h"
#include "implicit/simd/dispatch.h"
#include "points/dexel/tri_dexel.h"
#include "tests/bench/dexel_figures.h"
#include "tests/bench/machine.h"
#include "tests/bench/openvdb_csg.h"
#include "tests/bench/restroke_runs.h"
#include "tests/bench/stamp_source.h"

namespace restroke::bench {
namespace {

using Clock = std::chrono::steady_clock;
using implicit::Primitive;
using implicit::Sign;
using points::DexelGrid;
using points::DexelOperation;
using points::OperationId;
using points::TriDexel;

constexpr Execution kOneThread{.threads = 1}, kTwoThreads{.threads = 2};

struct Arguments {
  std::filesystem::path list, json;
  bool smoke = false;
};

/// What the smoke size makes less of.
struct Size {
  int resolution = 258;                      // 3 x 258 x 258 lines are 199,692
  std::size_t rounds = 5;                    // of small balls
  std::size_t places = 400;                  // random ones
  std::size_t booleans = 60;                 // of whole models, each kind
  std::size_t primitives = ~std::size_t{0};  // of the list
  MeshSize meshes = {};
};
constexpr Size kSmoke{
    .resolution = 32,
    .rounds = 1,
    .places = 20,
    .booleans = 3,
    .primitives = 60,
    .meshes = {.resolution = 32, .meshResolution = 24, .levels = 3, .rounds = 1, .poses = 5}};

Arguments parse(std::span<char* const> words) {
  Arguments out;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string_view word = words[i];
    if (word == "--smoke") {
      out.smoke = true;
    } else if (word == "--json") {
      if (i + 1 == words.size()) throw InputError("--json needs a file");
      out.json = words[++i];
    } else if (word.starts_with("-") || !out.list.empty()) {
      throw InputError(fmt::format(
          "unknown argument '{}'; usage: bench_dexel [LOG|STAMPS] [--smoke] [--json FILE]", word));
    } else {
      out.list = word;
    }
  }
  return out;
}

Primitive ball(DVec3 center, double radius, Sign sign = Sign::Positive) {
  return {implicit::Sphere{Point(center), static_cast<float>(radius)}, sign};
}

TriDexel modelOf(const Primitive& primitive, const DexelGrid& grid) {
  TriDexel model(grid);
  model.apply({&primitive, 1}, OperationId::Initial);
  return model;
}

constexpr double kSmallRadius = 0.1;

/// Centres on the unit sphere, a quarter of a radius apart: a circle about (1, 1, 1). The grid ends where the
/// ball does; no tool here is cut off by that.
std::vector<DVec3> strokePlaces() {
  const DVec3 axis = normalized(DVec3(1, 1, 1)), u = normalized(DVec3(1, -1, 0)), v = cross(axis, u);
  constexpr double kAngle = 0.43;
  const auto count = static_cast<std::size_t>(2 * M_PI * std::sin(kAngle) / (kSmallRadius / 4));
  std::vector<DVec3> places;
  for (std::size_t i = 0; i < count; ++i) {
    const double turn = 2 * M_PI * static_cast<double>(i) / static_cast<double>(count);
    places.push_back(std::cos(kAngle) * axis + std::sin(kAngle) * (std::cos(turn) * u + std::sin(turn) * v));
  }
  return places;
}

std::vector<DVec3> randomPlaces(std::size_t count) {
  experiments::Random random(1);
  std::vector<DVec3> places;
  while (places.size() < count) {
    const DVec3 p(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
    const double r = length(p);
    if (r > 1 || r < 0.1) continue;
    const DVec3 on = p / r;
    if (std::fmax(std::fabs(on.x), std::fmax(std::fabs(on.y), std::fabs(on.z))) <= 1 - kSmallRadius)
      places.push_back(on);
  }
  return places;
}

void measureSmallBalls(const DexelGrid& grid, const Size& size, Results& results) {
  const TriDexel start = modelOf(ball({0, 0, 0}, 1), grid);
  results.lines = grid.lineCount();
  results.bytes = start.bytes();
  for (const Sign sign : {Sign::Negative, Sign::Positive})
    for (const bool random : {false, true}) {
      const std::vector<DVec3> places = random ? randomPlaces(size.places) : strokePlaces();
      Column column("tri-dexel");
      for (std::size_t round = 0; round < size.rounds; ++round) {
        TriDexel model = start;
        std::vector<double> times;
        for (std::size_t i = 0; i < places.size(); ++i) {
          const Primitive tool = ball(places[i], kSmallRadius, sign);
          const auto begin = Clock::now();
          model.apply({&tool, 1}, static_cast<OperationId>(i + 1), kOneThread);
          times.push_back(1e6 * secondsSince(begin));
        }
        column.add(Series::Stamps, std::move(times));
      }
      const std::string what = fmt::format("{} a ball of radius {:g}, {}, 1 thread",
                                           sign == Sign::Positive ? "unite with" : "subtract", kSmallRadius,
                                           random ? "at random places" : "along a stroke");
      results.figures.push_back(
          {.what = what + ", median", .unit = "us", .value = *column.at(Row::StampMedian), .goal = Goal{20}});
      results.figures.push_back(
          {.what = what + ", 99th percentile", .unit = "us", .value = *column.at(Row::StampP99)});
    }
}

void measureWholeModels(const DexelGrid& grid, const Size& size, Results& results) {
  const DVec3 beside(0.3, 0.2, 0.1);
  const TriDexel one = modelOf(ball({0, 0, 0}, 1), grid), other = modelOf(ball(beside, 0.6), grid);
  const double otherVolume = 4.0 / 3 * M_PI * 0.6 * 0.6 * 0.6, oneVolume = 4.0 / 3 * M_PI;
  // The other ball is within the first: what comes of it is known.
  const auto expected = [&](DexelOperation operation) {
    switch (operation) {
      case DexelOperation::Union:
        return oneVolume;
      case DexelOperation::Subtraction:
        return oneVolume - otherVolume;
      case DexelOperation::Intersection:
        return otherVolume;
    }
    return 0.0;
  };
  // Another one crosses its surface.
  const TriDexel crossing = modelOf(ball({0.5, 0.3, 0.1}, 0.9), grid);
  for (const auto& [operation, name] : {std::pair{DexelOperation::Union, "unite with"},
                                        {DexelOperation::Subtraction, "subtract"},
                                        {DexelOperation::Intersection, "intersect with"}}) {
    std::vector<double> times;
    for (std::size_t i = 0; i < size.booleans; ++i) {
      TriDexel model = one;
      const auto begin = Clock::now();
      model.apply(crossing, operation, static_cast<OperationId>(1), kTwoThreads);
      times.push_back(1e3 * secondsSince(begin));
    }
    results.figures.push_back({.what = fmt::format("{} another model, 2 threads, median", name),
                               .unit = "ms",
                               .value = quantile(std::move(times), 0.5),
                               .rival = "the paper: GTX 660, with display",
                               .rivalValue = 3,
                               .goal = Goal{1.3}});
    TriDexel model = one;
    model.apply(other, operation, static_cast<OperationId>(1), kTwoThreads);
    const double volume = model.volume(), wanted = expected(operation);
    results.checks.emplace_back(
        std::fabs(volume - wanted) < grid.cell() * wanted,
        fmt::format("{} a ball inside has the volume {:.4f}; {:.4f} were to be", name, volume, wanted));
  }
}

StampSource stampsOf(const Arguments& arguments, const Size& size) {
  StampSource source = loadStamps(arguments.list);
  for (const Primitive& p : source.primitives)
    if (!p.shape.isSphere())
      throw InputError(
          fmt::format("{}: holds a primitive that is no sphere; the rival stamps spheres only", source.name));
  if (source.primitives.size() > size.primitives) source.primitives.resize(size.primitives);
  return source;
}

/// Stamp by stamp, as they come from a pen.
TriDexel replay(const std::vector<Primitive>& primitives, const DexelGrid& grid) {
  TriDexel model(grid);
  for (std::size_t i = 0; i < primitives.size(); ++i)
    model.apply({&primitives[i], 1}, static_cast<OperationId>(i), kOneThread);
  return model;
}

void measureReplay(const StampSource& source, const Size& size, Results& results) {
  implicit::PrimitiveList list;
  list.insert(0, source.primitives);
  const DexelGrid grid = points::dexelGridFor(list.bounds(), {.resolution = size.resolution});
  std::vector<double> times, atOnce;
  for (std::size_t round = 0; round < size.rounds; ++round) {
    const auto begin = Clock::now();
    const TriDexel model = replay(source.primitives, grid);
    times.push_back(1e3 * secondsSince(begin));
    const auto again = Clock::now();
    (void)triDexelOf(list, grid, {}, kTwoThreads);
    atOnce.push_back(1e3 * secondsSince(again));
  }
  // As bench_rivals has it; lines are as far apart or closer.
  results.voxel = std::fmax(Task{}.voxel, grid.cell());
  const OpenVdbResult csg = replayWithOpenVdb(source.primitives, results.voxel);
  results.figures.push_back({.what = fmt::format("replay of {}, {} stamps on {} lines, one by one, 1 thread",
                                                 source.name, source.primitives.size() - 1, grid.lineCount()),
                             .unit = "ms",
                             .value = quantile(std::move(times), 0.5),
                             .rival = "OpenVDB CSG, all threads",
                             .rivalValue = 1e3 * csg.seconds});
  results.figures.push_back({.what = "replay of the same, the whole list at once, 2 threads",
                             .unit = "ms",
                             .value = quantile(std::move(atOnce), 0.5),
                             .rival = "OpenVDB CSG, all threads",
                             .rivalValue = 1e3 * csg.seconds,
                             .goal = Goal{100, true}});

  const TriDexel model = replay(source.primitives, grid);
  results.checks.emplace_back(model == triDexelOf(list, grid),
                              "stamp by stamp gives the tri-dexel of the whole list, bit for bit");
  experiments::Random random(2);
  constexpr std::size_t kAsked = 100'000;
  std::size_t right = 0;
  for (std::size_t i = 0; i < kAsked; ++i) {
    points::GridCounts at;
    for (std::size_t a = 0; a < 3; ++a)
      at[a] = static_cast<int>(random.below(static_cast<std::uint64_t>(grid.counts()[a])));
    right += model.isInside(at) == (sideOf(list, grid.at(at)) == implicit::Side::Inside);
  }
  results.checks.emplace_back(
      right > kAsked - kAsked / 1000,
      fmt::format("the replayed model has the list's side at {} of {} random grid points", right, kAsked));
}

Results measure(const StampSource& source, const Size& size) {
  Results results;
  results.list = source.name;
  const Primitive whole = ball({0, 0, 0}, 1);
  const DexelGrid grid = points::dexelGridFor(boundsOf(whole.shape), {.resolution = size.resolution});
  measureSmallBalls(grid, size, results);
  measureWholeModels(grid, size, results);
  measureReplay(source, size, results);
  measureMeshes(size.meshes, results);
  return results;
}

std::string goalText(const Figure& figure) {
  if (!figure.goal) return "";
  return figure.goal->atLeast ? fmt::format("at least {:g} times", figure.goal->limit)
                              : fmt::format("at most {:g} {}", figure.goal->limit, figure.unit);
}

std::string textOfTable(const Results& results) {
  std::vector<std::vector<std::string>> lines{{"", "tri-dexel", "rival", "ratio", "target", "met", ""}};
  for (const Figure& figure : results.figures) {
    const std::optional<double> ratio = figure.ratio();
    lines.push_back({fmt::format("{} ({})", figure.what, figure.unit), fmt::format("{:.3f}", figure.value),
                     figure.rivalValue ? fmt::format("{:.3f}", *figure.rivalValue) : "-",
                     ratio ? fmt::format("{:.1f}x", *ratio) : "-", goalText(figure),
                     !figure.met()   ? ""
                     : *figure.met() ? "yes"
                                     : "no",
                     figure.rival});
  }
  return experiments::alignedTable(lines, 1);
}

nlohmann::ordered_json jsonOf(const Results& results, const experiments::Provenance& origin) {
  using Json = nlohmann::ordered_json;
  Json out = bench::jsonOf(origin);
  out["simd"] = implicit::simdLevelName();
  out["list"] = results.list;
  out["lines"] = results.lines;
  out["bytes"] = results.bytes;
  out["voxel"] = results.voxel;
  out["figures"] = Json::array();
  for (const Figure& figure : results.figures) {
    Json row = {{"what", figure.what}, {"unit", figure.unit}, {"value", figure.value}};
    if (figure.rivalValue) {
      row["rival"] = figure.rival;
      row["rival_value"] = *figure.rivalValue;
      row["ratio"] = *figure.ratio();
    }
    if (figure.goal) {
      row["limit"] = figure.goal->limit;
      row["at_least"] = figure.goal->atLeast;
      row["met"] = *figure.met();
    }
    out["figures"].push_back(std::move(row));
  }
  out["checks"] = Json::array();
  for (const auto& [holds, sentence] : results.checks)
    out["checks"].push_back({{"holds", holds}, {"sentence", sentence}});
  return out;
}

int run(std::span<char* const> words) {
  const Arguments arguments = parse(words);
  const Size size = arguments.smoke ? kSmoke : Size{};
  const Results results = measure(stampsOf(arguments, size), size);
  const experiments::Provenance origin = experiments::provenance();
  fmt::print(
      "{}A ball of radius 1 on {} lines, {:.2f} MB; {} kernels; OpenVDB at voxel {:.3g}\nMedians; ratios: "
      "how many times the rival takes as long{}\n\n{}\n",
      textOf(origin), experiments::grouped(results.lines), static_cast<double>(results.bytes) * 1e-6,
      implicit::simdLevelName(), results.voxel, arguments.smoke ? "; targets are for the full size" : "",
      textOfTable(results));
  bool hold = true;
  for (const auto& [holds, sentence] : results.checks) {
    fmt::print("{}: {}\n", holds ? "holds" : "DOES NOT HOLD", sentence);
    hold = hold && holds;
  }
  if (!arguments.json.empty()) writeFile(arguments.json, jsonOf(results, origin).dump(1) + "\n");
  return hold ? 0 : 1;
}

}  // namespace
}  // namespace restroke::bench

int main(int argc, char** argv) {
  try {
    return restroke::bench::run(std::span(argv + 1, static_cast<std::size_t>(argc - 1)));
  } catch (const restroke::InputError& error) {
    fmt::print(stderr, "bench_dexel: {}\n", error.what());
    return 2;
  }
}
