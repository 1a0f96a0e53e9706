#pragma once
// What the lines of bench_dexel's table are made of.

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace restroke::bench {

/// What a figure is to be; `atLeast`: of the ratio to the rival, else at most of the figure.
struct Goal {
  double limit = 0;
  bool atLeast = false;
};

/// A line of the table.
struct Figure {
  std::string what, unit;
  double value = 0;
  std::string rival = {};
  std::optional<double> rivalValue = {};  // in the same unit
  std::optional<Goal> goal = {};

  [[nodiscard]] std::optional<double> ratio() const {
    return rivalValue ? std::optional(*rivalValue / value) : std::nullopt;
  }
  [[nodiscard]] std::optional<bool> met() const {
    if (!goal) return std::nullopt;
    return goal->atLeast ? ratio().value_or(0) >= goal->limit : value <= goal->limit;
  }
};

struct Results {
  std::vector<Figure> figures;
  std::string list;
  std::size_t lines = 0, bytes = 0;  // of the ball's model
  double voxel = 0;                  // OpenVDB's
  std::vector<std::pair<bool, std::string>> checks;
};

/// Of meshes and on OpenGL: building models, cutting with a mesh, making meshes.
struct MeshSize {
  int resolution = 256;      ///< lines along the longest side
  int meshResolution = 200;  ///< cells of the meshes that are made
  int levels = 6;            ///< of subdivision of the ball that is built from: 32,768 triangles
  std::size_t rounds = 5, poses = 60;
};
void measureMeshes(const MeshSize& size, Results& results);

}  // namespace restroke::bench
