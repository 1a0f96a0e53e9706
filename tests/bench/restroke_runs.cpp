#include "tests/bench/restroke_runs.h"

#include <malloc.h>

#include <algorithm>
#include <optional>
#include <thread>

#include "implicit/errors.h"
#include "implicit/ray_cast.h"
#include "points/images/cpu_renderer.h"
#include "tests/experiments/counted_allocation.h"

namespace restroke::bench {
namespace {

using Clock = std::chrono::steady_clock;

double castAll(const Task& task, const points::SurfelModel& model, implicit::Prefix prefix) {
  std::size_t hits = 0;
  const auto start = Clock::now();
  for (const Ray& ray : task.rays) hits += implicit::castRay(model.list(), ray, prefix).has_value();
  const double seconds = secondsSince(start);
  RESTROKE_CHECK_LT(std::size_t{0}, hits);
  return static_cast<double>(task.rays.size()) / seconds / 1e6;
}

void measureUndo(const Task& task, points::SurfelModel& model, Column& column) {
  std::vector<double> milliseconds;
  for (const Task::Stroke& stroke : task.strokes) {
    const auto start = Clock::now();
    model.remove(stroke.first, stroke.count, {.threads = 1});
    milliseconds.push_back(1e3 * secondsSince(start));
    model.insert(stroke.first, std::span(task.list).subspan(stroke.first, stroke.count));
  }
  if (!milliseconds.empty()) column.add(Series::Undos, std::move(milliseconds));
}

// As a window draws: picture after picture into the same memory, colour and depth. The third counts.
void measurePicture(const Task& task, const points::SurfelModel& model, Column& column) {
  points::CpuRenderer renderer({.normal = false, .ids = false});
  std::vector<points::Surfel> surfels;
  double expanded = 0, drawn = 0;
  for (int i = 0; i < 3; ++i) {
    const auto start = Clock::now();
    model.surfels(surfels, {.threads = 2});
    expanded = 1e3 * secondsSince(start);
    const points::RenderedImage& image =
        renderer.render({.surfels = surfels}, task.camera,
                        {.samples = 1, .occlusion = points::Occlusion::None}, {.threads = 2});
    drawn = 1e3 * secondsSince(start);
    RESTROKE_CHECK_EQ(image.width, task.camera.width);
  }
  column.add(Row::Expand, expanded);
  column.add(Row::Picture, drawn);
}

void append(points::SurfelModel& model, const implicit::Primitive& primitive) {
  model.append(std::span(&primitive, 1), {.threads = 1});
}

std::size_t inUse() {
  const struct mallinfo2 now = mallinfo2();
  return now.uordblks + now.hblkhd;
}

}  // namespace

Task makeTask(std::string name, std::vector<implicit::Primitive> list,
              const std::vector<std::size_t>& strokes) {
  Task task;
  task.name = std::move(name);
  task.list = std::move(list);
  std::size_t first = 1;
  for (const std::size_t count : strokes) {
    if (first >= task.list.size()) break;
    const std::size_t end = std::min(count, task.list.size() - first);
    if (end > 0) task.strokes.push_back({first, end});
    first += end;
  }
  implicit::PrimitiveList all;
  all.insert(0, task.list);
  const implicit::Sphere around = all.boundingSphere();
  task.camera =
      frameSphere(around.center, around.radius, {.view = {-1, -1, -2}, .width = 1280, .height = 720});
  for (std::int32_t y = 4; y < 720; y += 8)
    for (std::int32_t x = 0; x < 1280; ++x)
      task.rays.push_back(
          rayThrough(task.camera, {x * kSubPixels + kSubPixels / 2, y * kSubPixels + kSubPixels / 2}));
  return task;
}

points::SurfelModel modelOf(const Task& task) {
  points::SurfelModel model({.density = task.density});
  for (const implicit::Primitive& p : task.list) append(model, p);
  return model;
}

double replaySeconds(const Task& task) {
  const auto start = Clock::now();
  const points::SurfelModel model = modelOf(task);
  return secondsSince(start);
}

void measureRestroke(const Task& task, Column& column) {
  points::SurfelModel model({.density = task.density});
  std::vector<double> stamps;
  stamps.reserve(task.list.size());
  const auto begin = Clock::now();
  append(model, task.list[0]);
  for (std::size_t i = 1; i < task.list.size(); ++i) {
    const auto start = Clock::now();
    append(model, task.list[i]);
    stamps.push_back(1e6 * secondsSince(start));
  }
  column.add(Row::Replay, 1e3 * secondsSince(begin));
  column.add(Series::ShortStamps, {stamps.begin(), stamps.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                                        stamps.size(), task.shortened))});
  column.add(Series::Stamps, std::move(stamps));

  for (const int threads : {1, 2}) {
    const auto start = Clock::now();
    model.rebuild({.threads = threads});
    column.add(threads == 1 ? Row::RebuildOne : Row::RebuildTwo, 1e3 * secondsSince(start));
  }
  measureUndo(task, model, column);
  column.add(Row::Rays, castAll(task, model, {}));
  column.add(Row::PrefixRays, castAll(task, model, {task.list.size() / 2}));
  measurePicture(task, model, column);
}

void measureBytes(const Task& task, Column& column) {
  (void)modelOf(task);  // the tables of sample directions, which all models of the process share
  std::optional<points::SurfelModel> model;
  const std::size_t before = inUse();
  std::thread([&] { model.emplace(modelOf(task)); }).join();
  const std::size_t after = inUse();
  const points::ModelBytes bytes = model->bytes();
  column.add(Row::ModelBytes, static_cast<double>(bytes.total()) / 1e6);
  column.add(Row::BytesPerSurfel,
             static_cast<double>(bytes.surfels) / static_cast<double>(model->surfelCount()));
  column.add(Row::BytesPerPrimitive,
             static_cast<double>(bytes.list + bytes.clusters) / static_cast<double>(task.list.size()));
  if (experiments::kCountsAllocation)
    column.add(Row::AllocatedBytes, static_cast<double>(after - before) / 1e6);
}

}  // namespace restroke::bench
