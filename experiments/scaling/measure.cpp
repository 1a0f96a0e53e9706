#include "experiments/scaling/measure.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "experiments/pictures.h"
#include "experiments/provenance.h"
#include "experiments/random.h"
#include "experiments/retarget/summary.h"
#include "implicit/errors.h"
#include "implicit/process_memory.h"
#include "implicit/ray_cast.h"
#include "points/images/cpu_renderer.h"

namespace restroke::experiments {
namespace {

using implicit::Primitive;
using points::SurfelModel;

class Clock {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count();
  }

 private:
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

template <class F>
double secondsOf(const F& f) {
  const Clock clock;
  f();
  return clock.seconds();
}

/// Times f once, and again while that is soon done, five times at most.
template <class F>
double medianSeconds(double patience, const F& f) {
  const Clock all;
  std::vector<double> times;
  do times.push_back(secondsOf(f));
  while (times.size() < 5 && all.seconds() + times.back() < patience);
  return quantile(std::move(times), 0.5);
}

/// Stamps whose neighbours are counted, and how many tests that may take.
constexpr std::size_t kCountedStamps = 256;
constexpr std::size_t kCountedTests = 400'000'000;

/// One list in a model, and where its strokes begin.
class Subject {
 public:
  Subject(const Layout& layout, const MeasureOptions& options, const Execution& execution)
      : layout_(layout), options_(options), execution_(execution), model_({.density = layout.density}) {
    out_.bases = layout.bases.size();
    out_.strokes = layout.strokes;
    out_.density = layout.density;
    replay();
  }

  Measured run() {
    const std::uint64_t state = model_.stateHash(execution_);
    out_.stateHash = hex(state);
    timeStamps();
    timeUndo();
    demand(state, "strokes were taken out of the middle and put back");
    timeRebuild();
    demand(state, "a rebuild");
    castRays();
    draw();
    out_.bytes = model_.bytes();
    out_.peakResident = peakResidentBytes();
    return out_;
  }

 private:
  void demand(std::uint64_t state, const char* what) const {
    if (model_.stateHash(execution_) != state)
      throw InternalError(fmt::format("scaling: with {} primitives, the state after {} is not the one before",
                                      model_.list().size(), what));
  }

  void replay() {
    out_.baseSeconds = secondsOf([&] { model_.append(layout_.bases, execution_); });
    first_.reserve(layout_.strokes + 1);
    out_.leastRadius = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < layout_.strokes; ++k) {
      const std::vector<Primitive> stroke = layout_.stroke(k);
      for (const Primitive& p : stroke) {
        const auto radius = static_cast<double>(p.shape.ball().radius);
        out_.leastRadius = std::min(out_.leastRadius, radius);
        out_.mostRadius = std::max(out_.mostRadius, radius);
      }
      first_.push_back(model_.list().size());
      out_.replay += secondsOf([&] { model_.append(stroke, execution_); });
    }
    first_.push_back(model_.list().size());
    out_.primitives = model_.list().size();
    out_.surfels = model_.surfelCount();
    out_.resident = residentBytes();
    countNeighbours();
  }

  /// By the definition: the distance of middles is less than the sum of radii. The indices that are measured
  /// here have no part in it.
  void countNeighbours() {
    const std::size_t n = model_.list().size(), stamps = n - out_.bases;
    const std::size_t wanted = std::clamp<std::size_t>(kCountedTests / n, 16, kCountedStamps);
    Random random(options_.seed);
    std::vector<std::pair<std::size_t, std::size_t>> counted;  // position, number met
    for (std::size_t i = 0; i < wanted; ++i)
      counted.emplace_back(out_.bases + static_cast<std::size_t>(random.below(stamps)), 0);
    for (std::size_t j = 0; j < n; ++j) {
      const implicit::Sphere other = model_.list().at(j).shape.ball();
      for (auto& [i, met] : counted) {
        const implicit::Sphere own = model_.list().at(i).shape.ball();
        const Vec3 apart = other.center - own.center;
        const float reach = other.radius + own.radius;
        met += j != i && dot(apart, apart) < reach * reach;
      }
    }
    std::size_t sum = 0, most = 0;
    for (const auto& [i, met] : counted) {
      sum += met;
      most = std::max(most, met);
    }
    out_.met = static_cast<double>(sum) / static_cast<double>(counted.size());
    out_.metMost = static_cast<double>(most);
  }

  void appendTimed(const std::vector<Primitive>& stroke, std::vector<double>& times) {
    for (const Primitive& p : stroke) times.push_back(secondsOf([&] { model_.append({&p, 1}, execution_); }));
  }

  /// On the whole list, stroke by stroke, each taken away again; or, where there are no further strokes, the
  /// last ones of the list.
  void timeStamps() {
    std::vector<double> times;
    const Clock clock;
    if (layout_.endless) {
      for (std::size_t k = layout_.strokes;
           times.size() < options_.stamps && (times.empty() || clock.seconds() < options_.patience); ++k) {
        const std::vector<Primitive> stroke = layout_.stroke(k);
        appendTimed(stroke, times);
        model_.remove(out_.primitives, stroke.size(), execution_);
      }
    } else {
      std::size_t k = layout_.strokes - 1;
      while (k > layout_.strokes / 2 && out_.primitives - first_[k] < options_.stamps) --k;
      model_.remove(first_[k], out_.primitives - first_[k], execution_);
      for (; k < layout_.strokes; ++k) appendTimed(layout_.stroke(k), times);
    }
    out_.timedStamps = times.size();
    out_.stampMedian = 1e6 * quantile(times, 0.5);
    out_.stampHigh = 1e6 * quantile(times, 0.99);
  }

  /// Strokes from the second and third quarter of the list, spread evenly.
  void timeUndo() {
    const std::size_t from = layout_.strokes / 4, to = std::max(from + 1, layout_.strokes * 3 / 4);
    const std::size_t wanted = std::min(options_.undos, to - from);
    std::vector<double> times;
    const Clock clock;
    for (std::size_t i = 0; i < wanted && (i == 0 || clock.seconds() < options_.patience); ++i) {
      // Neither in order nor one beside the last: what one has read does not warm the next one's memory.
      const std::size_t k = from + (i * 7919 % wanted) * (to - from) / wanted;
      const std::size_t first = first_[k], count = first_[k + 1] - first;
      times.push_back(secondsOf([&] { model_.remove(first, count, execution_); }));
      model_.insert(first, layout_.stroke(k), execution_);
    }
    out_.undone = times.size();
    out_.undoMedian = 1e3 * quantile(times, 0.5);
    out_.undoHigh = 1e3 * quantile(times, 0.99);
  }

  void timeRebuild() {
    out_.rebuildOne = 1e3 * medianSeconds(options_.patience, [&] { model_.rebuild({.threads = 1}); });
    out_.rebuild = 1e3 * medianSeconds(options_.patience, [&] { model_.rebuild(execution_); });
  }

  [[nodiscard]] Camera camera(std::uint32_t width, std::uint32_t height) const {
    const implicit::Sphere around = model_.list().boundingSphere();
    return frameSphere(around.center, around.radius,
                       {.view = layout_.view, .width = width, .height = height, .fill = layout_.fill});
  }

  struct Cast {
    std::size_t rays = 0, hits = 0;
    double seconds = 0;
  };
  [[nodiscard]] Cast cast(implicit::Prefix prefix) const {
    // Between clock readings, which cost as much as a ray, and at most.
    constexpr std::size_t kBatch = 32, kMost = 100'000;
    const Camera from = camera(options_.width, options_.height);
    Random random(options_.seed);
    Cast out;
    const Clock clock;
    while (out.rays < kMost && (out.rays == 0 || clock.seconds() < options_.patience / 4)) {
      for (std::size_t i = 0; i < kBatch; ++i) {
        const auto pixel = [&](std::uint32_t side) {
          return static_cast<std::int32_t>(random.below(std::uint64_t{side} * kSubPixels));
        };
        const std::int32_t x = pixel(from.width), y = pixel(from.height);
        out.hits += implicit::castRay(model_.list(), rayThrough(from, {x, y}), prefix).has_value();
      }
      out.rays += kBatch;
    }
    out.seconds = clock.seconds();
    return out;
  }

  void castRays() {
    const Cast whole = cast({}), prefixed = cast({.count = out_.primitives / 2});
    out_.rays = whole.rays;
    out_.rayHits = static_cast<double>(whole.hits) / static_cast<double>(whole.rays);
    out_.raysASecond = static_cast<double>(whole.rays) / whole.seconds;
    out_.raysPrefixed = static_cast<double>(prefixed.rays) / prefixed.seconds;
  }

  void draw() {
    const std::size_t needed = out_.surfels * kDrawingBytes;
    if (const auto available = availableBytes(); available && needed > *available) {
      out_.leftOut = fmt::format(
          "no picture of {} surfels: drawing takes about {:.1f} GB, and {:.1f} GB are to be had",
          out_.surfels, static_cast<double>(needed) * 1e-9, static_cast<double>(*available) * 1e-9);
      return;
    }
    std::vector<points::Surfel> surfels;
    out_.listing = 1e3 * medianSeconds(options_.patience / 2, [&] { model_.surfels(surfels, execution_); });
    const Camera from = camera(options_.width, options_.height);
    const points::Scene scene{.surfels = surfels};
    // As a window draws: colour and depth, one picture after the other into the same memory.
    points::CpuRenderer renderer({.normal = false, .ids = false});
    const points::RenderOptions plain{.samples = 1, .occlusion = points::Occlusion::None};
    out_.picture = 1e3 * medianSeconds(options_.patience / 2,
                                       [&] { (void)renderer.render(scene, from, plain, execution_); });
    if (options_.portrait) portray(surfels);
  }

  /// The whole, and its middle eight times as large.
  void portray(std::span<const points::Surfel> surfels) {
    std::vector<std::uint32_t> strokes(out_.primitives, 1);
    std::fill_n(strokes.begin(), out_.bases, 0);
    const points::Scene scene{.surfels = surfels, .strokeOfPrimitive = strokes};
    Camera from = camera(options_.width, options_.height);
    out_.whole = drawPicture(scene, from, execution_);
    from.halfHeight /= 8;
    out_.part = drawPicture(scene, from, execution_);
  }

  const Layout& layout_;
  const MeasureOptions& options_;
  const Execution& execution_;
  SurfelModel model_;
  std::vector<std::size_t> first_;  // position of each stroke's first stamp, and the end
  Measured out_;
};

}  // namespace

Measured measure(const Layout& layout, const MeasureOptions& options, const Execution& execution) {
  resetPeak();
  return Subject(layout, options, execution).run();
}

}  // namespace restroke::experiments
