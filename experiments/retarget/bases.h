#pragma once
// The shapes that strokes are drawn on in the retargeting experiment.

#include <filesystem>
#include <string>
#include <vector>

#include "implicit/shape.h"

namespace restroke::experiments {

struct RetargetBase {
  std::string name;
  implicit::Shape shape;
  /// No turn takes it onto itself, so that the shape tells how it was moved. Known of the shape, not
  /// estimated.
  bool tellsMotion = true;
  std::string file = {};  ///< that it was read from; empty: made here
};

/// A sphere, an ellipsoid, a superellipsoid between box and ellipsoid, which hide some motions by their
/// symmetry, and a lump without any symmetry (the mesh of a ball with bulges).
/// `lumpEdge` is the length of its edges, model units.
[[nodiscard]] std::vector<RetargetBase> builtInBases(double lumpEdge = 0.1);

/// Meshes of a folder such as shared/data/meshes/closed, those of a fixed choice that are there: bunny, spot,
/// elephant, fandisk and knot1 (whose three lobes are alike).
[[nodiscard]] std::vector<RetargetBase> meshBases(const std::filesystem::path& folder);

}  // namespace restroke::experiments
