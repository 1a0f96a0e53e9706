#include "tests/bench/rivals_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "implicit/ray_cast.h"
#include "retarget/methods/disc_scene.h"
#include "tests/bench/embree_discs.h"
#include "tests/bench/leaf_brush.h"
#include "tests/bench/plain_list.h"

namespace restroke::bench {
namespace {

using Clock = std::chrono::steady_clock;
using Stroke = Task::Stroke;

// Undone in a round by rivals for which one undo takes long.
constexpr std::size_t kUndosARound = 2;

// Strokes that are spread over the list, others in each round.
std::vector<Stroke> someStrokes(const Task& task, std::size_t round) {
  std::vector<Stroke> some;
  for (std::size_t k = 0; k < kUndosARound && !task.strokes.empty(); ++k)
    some.push_back(task.strokes[(task.strokes.size() * (2 * k + 1) / (2 * kUndosARound) + 11 * round) %
                                task.strokes.size()]);
  return some;
}

void brushAllBut(LeafBrush& brush, const Task& task, Stroke without) {
  for (std::size_t i = 0; i < task.list.size(); ++i)
    if (i < without.first || i >= without.first + without.count) brush.stamp(task.list[i]);
}

// Times append for each primitive after the first.
template <class F>
double timeStamps(const Task& task, Column& column, const F& append) {
  std::vector<double> stamps;
  stamps.reserve(task.list.size());
  const auto begin = Clock::now();
  append(task.list[0]);
  for (std::size_t i = 1; i < task.list.size(); ++i) {
    const auto start = Clock::now();
    append(task.list[i]);
    stamps.push_back(1e6 * secondsSince(start));
  }
  const double milliseconds = 1e3 * secondsSince(begin);
  column.add(Row::Replay, milliseconds);
  column.add(Series::Stamps, std::move(stamps));
  return milliseconds;
}

Check checkGrids(const Task& task, const OpenVdbResult& csg) {
  double difference = 0;
  std::size_t voxels = 0;
  for (const auto loops : {LeafBrush::Loops::Plain, LeafBrush::Loops::Simd}) {
    LeafBrush brush(task.voxel, loops);
    brushAllBut(brush, task, {});
    difference = std::max(difference, brush.differenceFrom(*csg.grid));
    voxels = brush.activeVoxels();
  }
  return {difference < 1e-3,
          fmt::format(
              "the leaf brushes' distances are those of OpenVDB's CSG: at most {:.1g} voxels apart, over {} "
              "and {} voxels in the band",
              difference, voxels, csg.activeVoxels)};
}

Check checkSigns(const Task& task, const points::SurfelModel& model) {
  LeafBrush brush(task.voxel);
  brushAllBut(brush, task, {});
  brush.prune();
  const LeafBrush::Signs signs = brush.compareSigns(model.list(), 200000);
  return {
      signs.wrong == 0 && signs.asked > 100000,
      fmt::format("the leaf brush's signs are those of sideOf: at {} of {} random voxels more than a voxel "
                  "from the surface",
                  signs.asked - signs.wrong, signs.asked)};
}

Check checkPlainList(const Task& task, points::SurfelModel& model) {
  PlainList plain(task.density);
  for (const implicit::Primitive& p : task.list) plain.append(p);
  const std::size_t stamped = plain.surfelCount();
  plain.rebuild();
  const std::size_t rebuilt = plain.surfelCount(), ours = model.surfelCount();
  const Stroke stroke = task.strokes.empty() ? Stroke{1, 0} : task.strokes[task.strokes.size() / 2];
  plain.remove(stroke.first, stroke.count);
  model.remove(stroke.first, stroke.count);
  const bool undone = plain.surfelCount() == model.surfelCount();
  model.insert(stroke.first, std::span(task.list).subspan(stroke.first, stroke.count));
  return {stamped == ours && rebuilt == ours && undone,
          fmt::format(
              "the plain list has Restroke's {} surfels stamped ({}), rebuilt ({}), and after undo in the "
              "middle ({})",
              ours, stamped, rebuilt, undone ? "equal" : "not equal")};
}

Check checkPlainRays(const Task& task, const points::SurfelModel& model) {
  PlainList plain(task.density);
  for (const implicit::Primitive& p : task.list) plain.append(p);
  std::size_t asked = 0, equal = 0;
  for (std::size_t i = 0; i < task.rays.size(); i += 7) {
    const auto ours = implicit::castRay(model.list(), task.rays[i]);
    const auto theirs = plain.castRay(task.rays[i]);
    ++asked;
    equal += ours.has_value() == theirs.has_value() && (!ours || std::fabs(ours->t - *theirs) < 1e-9);
  }
  return {equal == asked,
          fmt::format("the plain list's rays hit what Restroke's do: {} of {}", equal, asked)};
}

// Discs stand out over silhouettes and lie a little off the surface: most rays agree, not all.
Check checkEmbree(const Task& task, const points::SurfelModel& model) {
  const EmbreeDiscs discs(model.surfels());
  std::size_t asked = 0, near = 0;
  for (std::size_t i = 0; i < task.rays.size(); i += 7) {
    const auto ours = implicit::castRay(model.list(), task.rays[i]);
    if (!ours) continue;
    const auto theirs = discs.castRay(task.rays[i]);
    ++asked;
    near += theirs && std::fabs(ours->t - *theirs) < 0.01;
  }
  return {asked > 0 && static_cast<double>(near) > 0.95 * static_cast<double>(asked),
          fmt::format("Embree's discs are hit within 0.01 of the exact place: {} of {}", near, asked)};
}

// Bit for bit, after every tenth stroke was undone and one came back elsewhere.
Check checkUpdatedEmbree(const Task& task) {
  points::SurfelModel model = modelOf(task);
  retarget::DiscScene updated, built;
  updated.update(model);
  for (std::size_t k = task.strokes.size(); k-- > 0;) {
    if (k % 10 != 0) continue;
    model.remove(task.strokes[k].first, task.strokes[k].count);
    updated.update(model);
  }
  if (!task.strokes.empty())
    model.append(std::span(task.list).subspan(task.strokes[0].first, task.strokes[0].count));
  updated.update(model);
  built.update(model);
  std::size_t equal = 0;
  for (const Ray& ray : task.rays) {
    const auto a = updated.nearest(ray, 0), b = built.nearest(ray, 0);
    equal += a.has_value() == b.has_value() && (!a || (a->t == b->t && a->radius == b->radius));
  }
  return {equal == task.rays.size() && updated.discCount() == model.surfelCount(),
          fmt::format("Embree's scene brought up to date answers as one built from nothing: {} of {} rays",
                      equal, task.rays.size())};
}

Check checkCorefinement(const CorefinementResult& corefined) {
  const std::size_t done = corefined.stampMicroseconds.size();
  return {
      corefined.closed && done > 0,
      fmt::format("CGAL's corefinement made {} of {} stamps (the others it refused) and a closed mesh of {} "
                  "faces",
                  done, corefined.stamps, corefined.faces)};
}

// The allocator rounds blocks up and has a header for each.
Check checkBytes(const Column& ours) {
  const std::optional<double> counted = ours.at(Row::ModelBytes), allocated = ours.at(Row::AllocatedBytes);
  if (!counted || !allocated) return {true, "the allocator does not say what it holds: nothing to compare"};
  return {*allocated < 1.15 * *counted + 0.02 && *allocated > 0.9 * *counted,
          fmt::format("the allocator holds what is counted: {:.3f} and {:.3f} MB", *allocated, *counted)};
}

}  // namespace

void measureLeafBrush(const Task& task, std::size_t round, Column& column) {
  const auto loops = column.level().empty() ? LeafBrush::Loops::Plain : LeafBrush::Loops::Simd;
  {
    LeafBrush brush(task.voxel, loops);
    const double milliseconds =
        timeStamps(task, column, [&](const implicit::Primitive& p) { brush.stamp(p); });
    // A level set has no other way to be built again, and the brush has one thread.
    column.add(Row::RebuildOne, milliseconds);
    column.add(Row::RebuildTwo, milliseconds);
    if (round == 0) {
      brush.prune();
      column.add(Row::ModelBytes, static_cast<double>(brush.bytes()) / 1e6);
    }
  }
  for (const Stroke& stroke : someStrokes(task, round)) {
    const auto start = Clock::now();
    LeafBrush brush(task.voxel, loops);
    brushAllBut(brush, task, stroke);
    column.add(Row::UndoMedian, 1e3 * secondsSince(start));
  }
}

void measurePlainList(const Task& task, std::size_t round, Column& column) {
  PlainList plain(task.density);
  (void)timeStamps(task, column, [&](const implicit::Primitive& p) { plain.append(p); });
  column.add(Row::ModelBytes, static_cast<double>(plain.bytes()) / 1e6);
  for (const Stroke& stroke : someStrokes(task, round)) {
    PlainList copy = plain;
    const auto start = Clock::now();
    copy.remove(stroke.first, stroke.count);
    column.add(Row::UndoMedian, 1e3 * secondsSince(start));
  }
  const auto start = Clock::now();
  plain.rebuild();
  column.add(Row::RebuildOne, 1e3 * secondsSince(start));
  // A tenth of the rays: in rows as they come.
  std::size_t rays = 0, hits = 0;
  const auto startOfRays = Clock::now();
  for (std::size_t first = 0; first < task.rays.size(); first += 12800)
    for (std::size_t i = first; i < std::min(first + 1280, task.rays.size()); ++i, ++rays)
      hits += plain.castRay(task.rays[i]).has_value();
  const double seconds = secondsSince(startOfRays);
  if (hits > 0) column.add(Row::Rays, static_cast<double>(rays) / seconds / 1e6);
}

OpenVdbResult measureOpenVdbCsg(const Task& task, Column& column) {
  OpenVdbResult result = replayWithOpenVdb(task.list, task.voxel);
  column.add(Series::Stamps, result.stampMicroseconds);
  column.add(Row::Replay, 1e3 * result.seconds);
  column.add(Row::RebuildTwo, 1e3 * result.seconds);  // replay, on all threads
  column.add(Row::UndoMedian,
             1e3 * result.seconds);  // replay without the stroke: as long, but for its stamps
  column.add(Row::ModelBytes, static_cast<double>(result.bytes) / 1e6);
  return result;
}

CorefinementResult measureCorefinement(const Task& task, double seconds, Column& column) {
  CorefinementResult result =
      replayWithCorefinement(std::span(task.list).first(std::min(task.list.size(), task.shortened + 1)),
                             {.density = static_cast<double>(task.density), .seconds = seconds});
  if (!result.stampMicroseconds.empty())
    column.add(Row::ShortStampMedian, quantile(result.stampMicroseconds, 0.5));
  column.add(Row::ModelBytes, static_cast<double>(result.bytes) / 1e6);
  return result;
}

void measureEmbree(const Task& task, double exactRays, Column& column) {
  const points::SurfelModel model = modelOf(task);
  const auto start = Clock::now();
  const EmbreeDiscs discs(model.surfels({.threads = 1}));
  const double build = secondsSince(start);
  std::size_t hits = 0;
  const auto startOfRays = Clock::now();
  for (const Ray& ray : task.rays) hits += discs.castRay(ray).has_value();
  const double rays = static_cast<double>(task.rays.size()) / secondsSince(startOfRays) / 1e6;
  if (hits == 0) return;
  column.add(Row::RayBuild, 1e3 * build);
  column.add(Row::Rays, rays);
  // Build pays off where rays / exact = build + rays / embree.
  if (rays > exactRays) column.add(Row::RayBreakEven, 1e3 * build / (1 / exactRays - 1 / rays));
}

void measureUpdatedEmbree(const Task& task, std::size_t round, Column& column) {
  constexpr Execution kOneThread{.threads = 1};
  points::SurfelModel model = modelOf(task);
  retarget::DiscScene scene;
  const auto timedUpdate = [&](Row row) {
    const auto start = Clock::now();
    scene.update(model, {}, kOneThread);
    column.add(row, 1e3 * secondsSince(start));
  };
  timedUpdate(Row::RayBuild);
  std::size_t hits = 0;
  const auto startOfRays = Clock::now();
  for (const Ray& ray : task.rays) hits += scene.nearest(ray, static_cast<float>(ray.tMin)).has_value();
  if (hits > 0)
    column.add(Row::Rays, static_cast<double>(task.rays.size()) / secondsSince(startOfRays) / 1e6);
  for (std::size_t k = round % 5; k < task.strokes.size(); k += 5) {
    const Stroke stroke = task.strokes[k];
    const std::span own = std::span(task.list).subspan(stroke.first, stroke.count);
    model.remove(stroke.first, stroke.count);
    timedUpdate(Row::RayUpdateUndo);
    model.append(own);
    timedUpdate(Row::RayUpdate);
    model.remove(model.list().size() - stroke.count, stroke.count);
    model.insert(stroke.first, own);
    scene.update(model, {}, kOneThread);
  }
}

std::vector<Check> checkRivals(const Task& task, const RivalsTable& table, const OpenVdbResult& csg,
                               const CorefinementResult& corefined) {
  points::SurfelModel model = modelOf(task);
  return {checkGrids(task, csg),        checkSigns(task, model),      checkPlainList(task, model),
          checkPlainRays(task, model),  checkEmbree(task, model),     checkUpdatedEmbree(task),
          checkCorefinement(corefined), checkBytes(table.ours.back())};
}

}  // namespace restroke::bench
