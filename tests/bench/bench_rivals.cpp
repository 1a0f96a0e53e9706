// One table: the same list of stamps through Restroke and through OpenVDB's CSG, in one run.
//
//   bench_rivals [LOG|STAMPS] [--smoke]

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstring>

#include "implicit/simd/dispatch.h"
#include "points/surfel_model.h"
#include "tests/bench/openvdb_csg.h"
#include "tests/bench/stamp_source.h"

namespace restroke::bench {
namespace {

using Clock = std::chrono::steady_clock;
constexpr float kDensity = 14000;
constexpr double kVoxel = 0.01;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double quantile(std::vector<double> v, double q) {
  if (v.empty()) return 0;
  std::sort(v.begin(), v.end());
  return v[static_cast<std::size_t>(q * static_cast<double>(v.size() - 1))];
}

struct Run {
  double seconds = 0;
  std::vector<double> stamps;  // microseconds
  std::size_t surfels = 0, bytes = 0;
};

Run replay(const std::vector<implicit::Primitive>& list) {
  Run run;
  points::SurfelModel model({.density = kDensity});
  const auto begin = Clock::now();
  for (std::size_t i = 0; i < list.size(); ++i) {
    const auto start = Clock::now();
    model.append(std::span(&list[i], 1));
    if (i > 0) run.stamps.push_back(1e6 * secondsSince(start));
  }
  run.seconds = secondsSince(begin);
  run.surfels = model.surfelCount();
  run.bytes = model.bytes().total();
  return run;
}

int main(int argc, char** argv) {
  std::filesystem::path file;
  bool smoke = false;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--smoke") == 0)
      smoke = true;
    else
      file = argv[i];
  }
  StampSource source = loadStamps(file);
  if (smoke) source.primitives.resize(std::min<std::size_t>(source.primitives.size(), 60));
  const Run cold = replay(source.primitives);  // makes the tables of sample directions as well
  std::vector<Run> runs;
  for (int i = 0; i < (smoke ? 1 : 5); ++i) runs.push_back(replay(source.primitives));
  std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.seconds < b.seconds; });
  const Run& ours = runs[runs.size() / 2];
  const OpenVdbResult vdb = replayWithOpenVdb(source.primitives, kVoxel);

  fmt::print(
      "{}: {} primitives, density {}, {} surfels; OpenVDB voxel {}, {} active voxels; Restroke on one thread "
      "with {}, OpenVDB on all\n",
      source.name, source.primitives.size(), kDensity, ours.surfels, kVoxel, vdb.activeVoxels,
      implicit::simdLevelName());
  fmt::print("{:<34}{:>12}{:>14}{:>10}\n", "", "Restroke", "OpenVDB CSG", "ratio");
  const auto row = [](const char* what, double a, double b) {
    fmt::print("{:<34}{:>12.2f}{:>14.2f}{:>9.1f}x\n", what, a, b, b / a);
  };
  row("stamp, median (us)", quantile(ours.stamps, 0.5), quantile(vdb.stampMicroseconds, 0.5));
  row("stamp, 99th percentile (us)", quantile(ours.stamps, 0.99), quantile(vdb.stampMicroseconds, 0.99));
  row("whole replay (ms)", 1e3 * ours.seconds, 1e3 * vdb.seconds);
  row("whole replay, first in process (ms)", 1e3 * cold.seconds, 1e3 * vdb.seconds);
  row("model (MB)", static_cast<double>(ours.bytes) / 1e6, static_cast<double>(vdb.bytes) / 1e6);
  return 0;
}

}  // namespace
}  // namespace restroke::bench

int main(int argc, char** argv) {
  return restroke::bench::main(argc, argv);
}
