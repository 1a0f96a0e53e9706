// What it costs to edit the history in the middle (SPEC S8, DESIGN invariant 6): cancelling each stroke of
// the log of the paper's scale, its followers retargeted where needed, beside replaying the log from its
// start and beside rebuilding the surfels alone; and the same on logs of up to 10,000 strokes.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sculpt/cli/history_views.h"
#include "sculpt/pen_strokes.h"
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

void cancelEach(const std::string& name, const sculpt::StrokeLog& log, bool smoke) {
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
  fmt::print("{}: {} strokes, {} primitives, {} surfels, one thread, microseconds\n", name,
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

void cancelEachOf(bool smoke) {
  const std::filesystem::path examples = RESTROKE_SOURCE_DIR "/experiments/examples";
  cancelEach("paper-scale.log", sculpt::readLog(examples / "paper-scale.log"), smoke);
  if (smoke) return;
  cancelEach("rabbit.log", sculpt::readLog(examples / "rabbit.log"), smoke);
  // Real drawings, whose strokes cross and lie on each other.
  const std::filesystem::path strokes = RESTROKE_SHARED_DIR "/data/strokes";
  for (const char* name : {"excalidraw_valentine.json", "excalidraw_line_drawings.json"})
    if (std::filesystem::exists(strokes / name))
      cancelEach(name,
                 sculpt::readPenStrokes(strokes / name, {.base = {}, .mode = sculpt::PenMode::Alternate}),
                 smoke);
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

void growth(const std::vector<std::size_t>& lengths, std::FILE* csv) {
  const char* columns = "strokes,replay_us,cancel_us,cancel_p99_us,goto_us,undo_us,show_us_per_node";
  if (csv) fmt::print(csv, "{}\n", columns);
  fmt::print("microseconds, medians of 100; goto: ten strokes back\n");
  fmt::print("{:>8} {:>12} {:>8} {:>12} {:>8} {:>8} {:>14}\n", "strokes", "replay", "cancel", "cancel, 99 %",
             "goto", "undo", "show, a node");
  for (const std::size_t strokes : lengths) {
    const auto log = spreadLog(strokes);
    std::optional<Document> made;
    const double replay = microseconds([&] { made = sculpt::replay(log, {}, {.threads = 1}); });
    Document& document = *made;
    std::vector<double> cancel, jump, undo, show;
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
    for (int i = 0; i < 3; ++i)
      show.push_back(microseconds([&] { (void)cli::treeText(document.history()); }) /
                     static_cast<double>(document.history().size()));
    fmt::print("{:>8} {:>12.0f} {:>8.0f} {:>12.0f} {:>8.0f} {:>8.0f} {:>14.2f}\n", strokes, replay,
               rank(cancel, 0.5), rank(cancel, 0.99), rank(jump, 0.5), rank(undo, 0.5), rank(show, 0.5));
    if (csv)
      fmt::print(csv, "{},{},{},{},{},{},{}\n", strokes, replay, rank(cancel, 0.5), rank(cancel, 0.99),
                 rank(jump, 0.5), rank(undo, 0.5), rank(show, 0.5));
  }
}

}  // namespace
}  // namespace restroke::bench

// bench_edits [--smoke | --csv FILE]
int main(int argc, char** argv) {
  const bool smoke = argc > 1 && std::strcmp(argv[1], "--smoke") == 0;
  std::FILE* csv = argc > 2 && std::strcmp(argv[1], "--csv") == 0 ? std::fopen(argv[2], "w") : nullptr;
  restroke::bench::cancelEachOf(smoke);
  restroke::bench::growth(
      smoke ? std::vector<std::size_t>{100} : std::vector<std::size_t>{100, 300, 1000, 3000, 10000}, csv);
  if (csv) std::fclose(csv);
}
