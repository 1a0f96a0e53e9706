#pragma once
// Restroke's own measurements for the rivals' table.

#include <chrono>
#include <string>
#include <vector>

#include "implicit/geometry/camera.h"
#include "points/surfel_model.h"
#include "tests/bench/rivals_table.h"

namespace restroke::bench {

/// What everyone does: the same list, the same rays, the same picture.
struct Task {
  std::string name;
  std::vector<implicit::Primitive> list;  ///< the base first; spheres only
  struct Stroke {
    std::size_t first = 0, count = 0;
  };
  std::vector<Stroke> strokes;
  float density = 14000;      ///< samples per square model unit
  double voxel = 0.01;        ///< of level sets, model units
  std::size_t shortened = 0;  ///< stamps that are given to rivals too slow for the whole list
  Camera camera;              ///< 1280 x 720, framing the model
  std::vector<Ray> rays;      ///< in pixel order, of every eighth row
};
[[nodiscard]] Task makeTask(std::string name, std::vector<implicit::Primitive> list,
                            const std::vector<std::size_t>& strokes);

[[nodiscard]] inline double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Adds one repetition of everything, at the SIMD level in use, on one thread unless the row says otherwise.
void measureRestroke(const Task& task, Column& column);

/// Seconds of one replay, stamp by stamp.
[[nodiscard]] double replaySeconds(const Task& task);

/// Counted bytes, and the allocator's: growth of what is in use (mallinfo2) while a thread of its own makes
/// the model, whose caches are given back when it ends. Nothing is added where a sanitizer hides the
/// allocator.
void measureBytes(const Task& task, Column& column);

/// The model of the whole list.
[[nodiscard]] points::SurfelModel modelOf(const Task& task);

}  // namespace restroke::bench
