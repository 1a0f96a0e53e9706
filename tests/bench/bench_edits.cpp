// What it costs to edit the history in the middle (SPEC S8, DESIGN invariant 6): cancelling each stroke of
// the log of the paper's scale, its followers retargeted where needed, beside replaying the log from its
// start and beside rebuilding the surfels alone; and the same on logs of up to 10,000 strokes.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <vector>

#include "sculpt/replay.h"

namespace restroke::bench {
namespace {

using sculpt::Document;
using sculpt::NodeId;
using Clock = std::chrono::steady_clock;

double microseconds(const std::function<void()>& work) {
  const auto start = Clock::now();
  work();
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

double rank(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

void paperScale(bool smoke) {
  const auto log = sculpt::readLog(RESTROKE_SOURCE_DIR "/experiments/examples/paper-scale.log");
  constexpr Execution kOne{.threads = 1};
  Document document = sculpt::replay(log, {}, kOne);
  std::vector<double> replay, rebuild, cancel, restore, jump;
  std::vector<double> retargeted, changed;
  const int rounds = smoke ? 1 : 5;
  for (int i = 0; i < rounds; ++i) {
    replay.push_back(microseconds([&] { (void)sculpt::replay(log, {}, kOne); }));
    points::SurfelModel model(document.model().sampling(), sculpt::clustersFor(document.header()));
    std::vector<implicit::Primitive> primitives;
    for (std::size_t k = 0; k < document.model().list().size(); ++k)
      primitives.push_back(document.model().list().at(k));
    model.append(primitives, kOne);
    rebuild.push_back(microseconds([&] { model.rebuild({.threads = 2}); }));
    for (std::uint32_t node = 1; node < document.history().size(); ++node) {
      sculpt::CommandReport report;
      cancel.push_back(
          microseconds([&] { report = document.apply(sculpt::CancelCommand{{}, NodeId{node}}); }));
      retargeted.push_back(static_cast<double>(report.retargeted));
      changed.push_back(static_cast<double>(report.changed));
      restore.push_back(microseconds([&] { document.apply(sculpt::RestoreCommand{{}, NodeId{node}}); }));
    }
  }
  const double median = rank(cancel, 0.5);
  fmt::print("{} strokes, {} primitives, {} surfels, one thread, microseconds\n",
             document.history().size() - 1, document.model().list().size(), document.model().surfelCount());
  fmt::print("  replay from the start   {:>10.0f}   {:>6.1f} times a cancel\n", rank(replay, 0.5),
             rank(replay, 0.5) / median);
  fmt::print("  rebuild, 2 threads      {:>10.0f}   {:>6.1f} times a cancel\n", rank(rebuild, 0.5),
             rank(rebuild, 0.5) / median);
  fmt::print("  cancel, median          {:>10.0f}   (99 %: {:.0f})\n", median, rank(cancel, 0.99));
  fmt::print("  restore, median         {:>10.0f}   (99 %: {:.0f})\n", rank(restore, 0.5),
             rank(restore, 0.99));
  fmt::print("  followers cast anew: median {:.0f}, most {:.0f}; changed: median {:.0f}, most {:.0f}\n",
             rank(retargeted, 0.5), rank(retargeted, 1), rank(changed, 0.5), rank(changed, 1));
  fmt::print("  bytes: history {}, model {}, kept to avoid casting {}\n\n", document.history().bytes(),
             document.model().bytes().total(), document.cacheBytes());
}

/// Strokes side by side all over a ball that is as large as they need.
sculpt::StrokeLog spreadLog(std::size_t strokes) {
  sculpt::StrokeLog log;
  const double radius = std::sqrt(static_cast<double>(strokes) / 100);
  log.header.base = implicit::Sphere{{}, static_cast<float>(radius)};
  log.header.density = 400;
  for (std::size_t i = 0; i < strokes; ++i) {
    // Golden-ratio lattice; each stroke from its own camera above its place.
    const double z = 1 - (2.0 * static_cast<double>(i * 7919 % strokes) + 1) / static_cast<double>(strokes);
    const double turn = 2.399963229728653 * static_cast<double>(i * 7919 % strokes);
    const double flat = std::sqrt(1 - z * z);
    const DVec3 out(flat * std::cos(turn), flat * std::sin(turn), z);
    sculpt::StrokeCommand command;
    command.stroke.camera =
        frameSphere(Point(radius * out), 0.4f, {.view = Vec3(-out), .width = 400, .height = 400});
    command.brush.radius = 0.06f;
    for (int k = 0; k <= 20; ++k)
      command.stroke.points.push_back(
          {.screen = {16 * (100 + 10 * k), 16 * (200 + (k % 3))}, .time = static_cast<std::uint32_t>(8 * k)});
    log.commands.emplace_back(command);
  }
  return log;
}

void growth(bool smoke) {
  fmt::print("strokes   replay ms   cancel us: median   99 %   goto 10 back us: median   undo us: median\n");
  for (const std::size_t strokes : {std::size_t{100}, std::size_t{1000}, std::size_t{10000}}) {
    if (smoke && strokes > 100) break;
    const auto log = spreadLog(strokes);
    const auto start = Clock::now();
    Document document = sculpt::replay(log, {}, {.threads = 1});
    const double replay = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    std::vector<double> cancel, jump, undo;
    for (std::size_t i = 0; i < 100; ++i) {
      const NodeId node{static_cast<std::uint32_t>(1 + i * strokes / 100)};
      cancel.push_back(microseconds([&] { document.apply(sculpt::CancelCommand{{}, node}); }));
      document.apply(sculpt::RestoreCommand{{}, node});
      const NodeId last = document.history().cursor();
      jump.push_back(
          microseconds([&] { document.apply(sculpt::GotoCommand{{}, NodeId{sculpt::indexOf(last) - 10}}); }));
      document.apply(sculpt::GotoCommand{{}, last});
      undo.push_back(microseconds([&] { document.apply(sculpt::UndoCommand{}); }));
      document.apply(sculpt::RedoCommand{});
    }
    fmt::print("{:>7}   {:>9.0f}   {:>17.0f}   {:>4.0f}   {:>23.0f}   {:>15.0f}\n", strokes, replay,
               rank(cancel, 0.5), rank(cancel, 0.99), rank(jump, 0.5), rank(undo, 0.5));
  }
}

}  // namespace
}  // namespace restroke::bench

int main(int argc, char** argv) {
  const bool smoke = argc > 1 && std::strcmp(argv[1], "--smoke") == 0;
  restroke::bench::paperScale(smoke);
  restroke::bench::growth(smoke);
}
