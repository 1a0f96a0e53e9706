// What it costs to ask where a line is in the sweep of a cutter: nanoseconds a line, for each kind of cutter
// and of move, along each axis.
//
//   bench_toolpath [--smoke]

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string_view>
#include <vector>

#include "points/dexel/toolpath/swept_cutter.h"

namespace restroke::bench {
namespace {

using points::Cutter;
using points::PathElement;
using points::SolidSpan;
using points::SweptCutter;

// The least of several rounds over n x n lines through the bounds: others use the machine too.
double nanoseconds(const SweptCutter& sweep, int axis, int n, int rounds) {
  using Clock = std::chrono::steady_clock;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const DVec3 low(sweep.bounds().min), size = DVec3(sweep.bounds().max) - low;
  std::vector<SolidSpan> spans;
  double least = 1e300;
  for (int round = 0; round < rounds; ++round) {
    const auto start = Clock::now();
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        Ray line{DVec3(0), DVec3(0)};
        line.origin[u] = low[u] + size[u] * (i + 0.5) / n;
        line.origin[v] = low[v] + size[v] * (j + 0.5) / n;
        line.direction[axis] = 1;
        spans.clear();
        sweep.intersect(line, spans);
      }
    least = std::min(least, std::chrono::duration<double>(Clock::now() - start).count());
  }
  return least / n / n * 1e9;
}

PathElement arcOf(DVec3 to, int axis) {
  return {.kind = PathElement::Kind::Arc, .from = {10, 0, 0}, .to = to, .center = {0, 0, 0}, .axis = axis};
}

int run(bool smoke) {
  struct Move {
    const char* name;
    PathElement element;
  };
  const std::vector<Move> moves{{"level", {.from = {0, 0, 0}, .to = {4, 1, 0}}},
                                {"sloping", {.from = {0, 0, 0}, .to = {4, 1, -0.7}}},
                                {"plunge", {.from = {0, 0, 0}, .to = {0, 0, -3}}},
                                {"arc XY", arcOf({0, 10, 0}, 2)},
                                {"helix", arcOf({0, 10, 2}, 2)},
                                {"arc XZ", arcOf({0, 0, 10}, 1)}};
  struct Named {
    const char* name;
    Cutter cutter;
  };
  const std::vector<Named> cutters{
      {"flat", {.kind = Cutter::Kind::Flat, .radius = 1, .length = 5}},
      {"ball", {.kind = Cutter::Kind::Ball, .radius = 1, .length = 5}},
      {"bull nose", {.kind = Cutter::Kind::BullNose, .radius = 1, .length = 5, .cornerRadius = 0.3}}};
  fmt::print("nanoseconds a line, of lines through the sweep's box\n{:<10}{:<12}{:>8}{:>8}{:>8}\n", "move",
             "cutter", "x", "y", "z");
  for (const Move& move : moves)
    for (const Named& cutter : cutters) {
      const SweptCutter sweep(cutter.cutter, move.element);
      fmt::print("{:<10}{:<12}", move.name, cutter.name);
      for (int axis = 0; axis < 3; ++axis)
        fmt::print("{:>8.0f}", nanoseconds(sweep, axis, smoke ? 4 : 60, smoke ? 1 : 9));
      fmt::print("\n");
    }
  return 0;
}

}  // namespace
}  // namespace restroke::bench

int main(int argc, char** argv) {
  return restroke::bench::run(argc > 1 && std::string_view(argv[1]) == "--smoke");
}
