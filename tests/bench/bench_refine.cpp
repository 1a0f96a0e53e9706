// Refinement, one line a pixel: what each method takes on a log's tri-dexel, and the replay in OpenGL beside
// it. (Zooms against the length of the history: restroke experiment refine.)
//
//   bench_refine [LOG|STAMPS] [--smoke]

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/provenance.h"
#include "implicit/errors.h"
#include "points/dexel/gl/gl_line_replay.h"
#include "points/dexel/refine/refine.h"
#include "tests/bench/machine.h"
#include "tests/bench/stamp_source.h"

namespace restroke::bench {
namespace {

using points::RefineMethod;
using points::TriDexelDocument;

TriDexelDocument documentOf(const StampSource& source, int resolution) {
  TriDexelDocument document;
  document.initial = std::vector{source.primitives.front()};
  Box box;
  for (const implicit::Primitive& primitive : source.primitives) box.add(boundsOf(primitive.shape));
  for (std::size_t i = 1; i < source.primitives.size(); ++i)
    document.operations.push_back({source.primitives[i].sign == implicit::Sign::Positive
                                       ? points::DexelOperation::Union
                                       : points::DexelOperation::Subtraction,
                                   source.primitives[i].shape});
  document.model = points::TriDexel(points::dexelGridFor(box, {.resolution = resolution}),
                                    {.operations = true, .history = true});
  document.model.apply(source.primitives, points::OperationId::Initial);
  return document;
}

// Median of several turns, in milliseconds.
template <class F>
double milliseconds(int turns, const F& f) {
  std::vector<double> taken;
  for (int i = 0; i < turns; ++i) {
    const auto start = std::chrono::steady_clock::now();
    f();
    taken.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::sort(taken.begin(), taken.end());
  return taken[taken.size() / 2];
}

int run(const std::filesystem::path& file, bool smoke) {
  const StampSource source = loadStamps(file);
  fmt::print("{}", textOf(experiments::provenance()));
  const TriDexelDocument document = documentOf(source, smoke ? 32 : 128);
  const points::DexelHistory history(document);
  history.makeClusters();
  const implicit::Sphere ball{document.model.bounds().center(),
                              document.model.bounds().halfDiagonal() / 1.7f};
  Camera camera =
      frameSphere(ball.center, ball.radius,
                  {.view = {-0.35f, -0.25f, -1}, .width = smoke ? 64u : 1280u, .height = smoke ? 36u : 720u});
  const points::Zone zone(camera);
  const auto lines = newLines(zone, {.perPixel = true});
  const int turns = smoke ? 1 : 7;
  fmt::print("{}: {} operations; {} x {} pixels, one line each; medians of {}, milliseconds\n", source.name,
             document.operations.size(), camera.width, camera.height, turns);
  fmt::print("{:<24}{:>12}{:>12}{:>12}\n", "method", "operations", "1 thread", "2 threads");
  for (const RefineMethod method : points::kRefineMethods) {
    std::size_t ids = 0;
    double taken[2];
    for (const int threads : {1, 2})
      taken[threads - 1] = milliseconds(turns, [&] {
        ids = points::refine({document, history}, {zone, lines}, {.method = method}, {.threads = threads})
                  .ids.size();
      });
    fmt::print("{:<24}{:>12}{:>12.1f}{:>12.1f}\n", nameOf(method), ids, taken[0], taken[1]);
  }
  try {
    const points::GlDexelContext context;
    const double taken = milliseconds(std::min(turns, 3), [&] {
      (void)points::refine({document, history}, {zone, lines},
                           {.method = RefineMethod::Clusters, .replayer = points::GlLineReplay(context)},
                           {.threads = 2});
    });
    fmt::print("{:<24}{:>12}{:>12}{:>12.1f}   {}\n", "clusters, OpenGL", "", "", taken, context.driver());
  } catch (const InputError& error) {
    fmt::print("no OpenGL: {}\n", error.what());
  }
  return 0;
}

}  // namespace
}  // namespace restroke::bench

int main(int argc, char** argv) {
  std::filesystem::path file;
  bool smoke = false;
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--smoke")
      smoke = true;
    else
      file = argv[i];
  }
  try {
    return restroke::bench::run(file, smoke);
  } catch (const restroke::InputError& error) {
    fmt::print(stderr, "bench_refine: {}\n", error.what());
    return 2;
  }
}
