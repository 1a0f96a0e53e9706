// What the kinds of volume cost (SPEC S13): side tests a second, a list of mixed kinds against one of
// spheres, and swept strokes against stamped ones. `bench_volumes --smoke` runs it small.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <vector>

#include "implicit/shape.h"
#include "points/surfel_model.h"
#include "sculpt/replay.h"
#include "sculpt/stroke_log.h"
#include "tests/bench/stamp_source.h"
#include "tests/support/random_volumes.h"

namespace restroke::bench {
namespace {

using Clock = std::chrono::steady_clock;
using implicit::Primitive;
using restroke::testing::Random;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Points in a box a fifth larger than the volume's ball; and points within 1 % of its size from the surface.
double sideTestsPerSecond(const implicit::Volume& volume, bool nearSurface, int rounds) {
  Random random(1);
  const implicit::SampleTable& samples = volume.samples(2048);
  const double size = volume.measures().radius;
  std::vector<implicit::LocalPoints> groups(256);
  for (implicit::LocalPoints& g : groups)
    for (std::size_t i = 0; i < implicit::kPatch; ++i) {
      DVec3 p = volume.measures().center + 1.2 * size * DVec3(random.inCube(1));
      if (nearSurface)
        p = DVec3(samples.position(static_cast<std::uint32_t>(random.below(samples.count())))) +
            0.01 * size * DVec3(random.inCube(1));
      g.x[i] = p.x;
      g.y[i] = p.y;
      g.z[i] = p.z;
    }
  std::uint32_t in = 0;
  const auto start = Clock::now();
  for (int r = 0; r < rounds; ++r)
    for (const implicit::LocalPoints& g : groups) in += volume.containsLanes(g, 0xFFFF, 0);
  const double seconds = secondsSince(start);
  if (in == 12345) fmt::print(" ");  // so that the loop is not taken out
  return static_cast<double>(rounds) * static_cast<double>(groups.size() * implicit::kPatch) / seconds;
}

struct Replayed {
  std::vector<double> stamps;  // microseconds each
  double seconds = 0;
  std::size_t surfels = 0, samples = 0;
};

Replayed replay(const std::vector<Primitive>& list, float density) {
  Replayed out;
  points::SurfelModel model({.density = density});
  for (const Primitive& p : list) {
    const auto start = Clock::now();
    model.append({&p, 1}, {.threads = 1});
    const double seconds = secondsSince(start);
    out.stamps.push_back(1e6 * seconds);
    out.seconds += seconds;
    out.samples += samplesOf(p.shape, implicit::sampleCount(p.shape, density)).count();
  }
  out.surfels = model.surfelCount();
  return out;
}

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

void row(const char* what, const Replayed& r, std::size_t primitives) {
  fmt::print(
      "  {:<28}{:>8} primitives {:>10} samples {:>9} surfels {:>8.1f} ms {:>7.1f} us median {:>7.1f} us 99 "
      "%\n",
      what, primitives, r.samples, r.surfels, 1e3 * r.seconds, quantile(r.stamps, 0.5),
      quantile(r.stamps, 0.99));
}

void sideTests(bool smoke) {
  fmt::print("Side tests, millions a second on one core ({})\n", nameOf(implicit::simdLevel()));
  fmt::print("  {:<18}{:>10}{:>14}\n", "kind", "anywhere", "near surface");
  for (const implicit::VolumeKind* kind : implicit::volumeKinds()) {
    const auto volume = kind->make(kind->examples().front());
    const int rounds = smoke ? 1 : 40;
    fmt::print("  {:<18}{:>10.1f}{:>14.1f}\n", kind->name, 1e-6 * sideTestsPerSecond(*volume, false, rounds),
               1e-6 * sideTestsPerSecond(*volume, true, rounds));
  }
}

// Every stamp becomes one of the tips by turns (null: stays a sphere), in a ball as large as the stamp's,
// turned at random.
std::vector<Primitive> tipped(const std::vector<Primitive>& spheres,
                              const std::vector<std::shared_ptr<const implicit::Volume>>& tips) {
  Random random(2);
  std::vector<Primitive> out{spheres.front()};
  for (std::size_t i = 1; i < spheres.size(); ++i) {
    const implicit::Sphere& ball = spheres[i].shape.ball();
    const auto& tip = tips[i % tips.size()];
    if (!tip) {
      out.push_back(spheres[i]);
      continue;
    }
    implicit::Pose pose;
    for (float& q : pose.rotation) q = random.between(-1, 1);
    pose.scale = ball.radius / static_cast<float>(tip->measures().radius);
    pose.position = ball.center;
    out.push_back({std::make_shared<const implicit::PosedVolume>(tip, pose), spheres[i].sign});
  }
  return out;
}

void mixedLists(bool smoke) {
  std::vector<Primitive> spheres = loadStamps().primitives;
  if (smoke) spheres.resize(std::min<std::size_t>(spheres.size(), 120));
  std::vector<std::shared_ptr<const implicit::Volume>> tips{nullptr};
  for (const implicit::VolumeKind* kind : implicit::volumeKinds())
    tips.push_back(kind->make(kind->examples().front()));
  const std::vector<Primitive> kinds = tipped(spheres, tips);
  const float density = smoke ? 1000 : 14000;
  (void)replay(spheres, density);  // makes the tables of directions
  (void)replay(kinds, density);
  std::vector<double> ratios;
  Replayed a, b;
  for (int run = 0; run < (smoke ? 1 : 5); ++run) {
    a = replay(spheres, density);
    b = replay(kinds, density);
    ratios.push_back(b.seconds / a.seconds);
  }
  fmt::print("\nA list of all kinds by turns against the same list of spheres, one thread\n");
  row("spheres", a, spheres.size());
  row("mixed", b, kinds.size());
  for (std::size_t i = 1; i < tips.size(); ++i) {
    const std::vector<Primitive> same = tipped(spheres, {tips[i]});
    (void)replay(same, density);
    row(std::string(tips[i]->kind().name).c_str(), replay(same, density), same.size());
  }
  fmt::print(
      "  mixed / spheres: {:.2f} times the time (median of {} runs; at most 4 is wanted), {:.2f} times a "
      "sample\n",
      quantile(ratios, 0.5), ratios.size(),
      quantile(ratios, 0.5) * static_cast<double>(a.samples) / static_cast<double>(b.samples));
}

// The strokes of the paper-scale example, which ships: smooth, as pens draw.
void sweeps(bool smoke) {
  const sculpt::StrokeLog log =
      sculpt::readLog(std::filesystem::path(RESTROKE_SOURCE_DIR) / "experiments/examples/paper-scale.log");
  fmt::print("\nStrokes of paper-scale.log on its sphere, each alone: stamped and swept\n");
  points::SurfelModel base({.density = 1000});
  base.append(std::vector<Primitive>{{log.header.base, implicit::Sign::Positive}});
  struct Way {
    const char* name;
    sculpt::Trace trace;
    float spacing;
  };
  std::size_t primitives[3] = {}, samples[3] = {}, number = 0;
  for (const Way& way : {Way{"stamps at 0.1 radii", sculpt::Trace::Stamps, 0.1f},
                         Way{"stamps at 0.25 radii", sculpt::Trace::Stamps, 0.25f},
                         Way{"sweep", sculpt::Trace::Sweep, 0.1f}}) {
    std::vector<Primitive> list;
    std::size_t strokes = 0;
    for (const sculpt::Command& command : log.commands) {
      const auto* stroke = std::get_if<sculpt::StrokeCommand>(&command);
      if (!stroke || (smoke && ++strokes > 5)) continue;
      sculpt::Brush brush = stroke->brush;
      brush.trace = way.trace;
      brush.spacing = way.spacing;
      const auto caster = retarget::makeCaster(retarget::Method::Exact, base, stroke->stroke.camera);
      const auto added =
          primitivesOf(sculpt::stampsAlong(stroke->stroke, brush, log.header.grid, *caster), brush);
      list.insert(list.end(), added.begin(), added.end());
    }
    const Replayed r = replay(list, smoke ? 1000 : 14000);
    row(way.name, r, list.size());
    primitives[number] = list.size();
    samples[number++] = r.samples;
  }
  for (std::size_t i = 0; i < 2; ++i)
    fmt::print(
        "  a sweep has {:.1f} times fewer primitives and {:.1f} times fewer samples than stamps at {} "
        "radii\n",
        static_cast<double>(primitives[i]) / static_cast<double>(primitives[2]),
        static_cast<double>(samples[i]) / static_cast<double>(samples[2]), i == 0 ? "0.1" : "0.25");
}

}  // namespace
}  // namespace restroke::bench

int main(int argc, char** argv) {
  const bool smoke = argc > 1 && std::strcmp(argv[1], "--smoke") == 0;
  restroke::bench::sideTests(smoke);
  restroke::bench::mixedLists(smoke);
  restroke::bench::sweeps(smoke);
  return 0;
}
