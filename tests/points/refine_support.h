#pragma once
// Histories and zones for tests of refinement.

#include <algorithm>
#include <limits>
#include <vector>

#include "points/dexel/refine/refine.h"
#include "tests/support/brute_force.h"
#include "tests/support/random_volumes.h"

namespace restroke::points::testing {

using implicit::Primitive;
using implicit::Sign;
using restroke::testing::Random;

inline TriDexelDocument::Operation operationOf(const Primitive& primitive) {
  return {primitive.sign == Sign::Positive ? DexelOperation::Union : DexelOperation::Subtraction,
          primitive.shape};
}

/// A base ball, then balls added and carved at random in the cube of half size 1.
struct DenseHistory {
  std::uint64_t seed = 1;
  std::size_t count = 1000;
  float least = 0.03f, most = 0.15f;  ///< radii
  unsigned adds = 50;                 ///< of a hundred
};
inline TriDexelDocument denseDocument(const DenseHistory& options) {
  Random random(options.seed);
  TriDexelDocument document;
  document.initial = std::vector<Primitive>{{{{0, 0, 0}, 0.75f}, Sign::Positive}};
  for (std::size_t i = 0; i < options.count; ++i) {
    const implicit::Shape ball(random.inCube(1), random.between(options.least, options.most));
    document.operations.push_back(
        operationOf({ball, random.below(100) < options.adds ? Sign::Positive : Sign::Negative}));
  }
  return document;
}

/// Applies the document's primitives to a model with so many lines.
inline void makeModel(TriDexelDocument& document, int resolution, Dexels::Options keep = {}) {
  std::vector<Primitive> all = std::get<std::vector<Primitive>>(document.initial);
  for (const auto& operation : document.operations)
    all.push_back({std::get<implicit::Shape>(operation.tool),
                   operation.operation == DexelOperation::Union ? Sign::Positive : Sign::Negative});
  Box box;
  for (const Primitive& primitive : all) box.add(boundsOf(primitive.shape));
  document.model = TriDexel(dexelGridFor(box, {.resolution = resolution}), keep);
  document.model.apply(all, OperationId::Initial);
}

/// Lengths of what is inside in one only, and in the second.
struct Difference {
  double tooMuch = 0, tooLittle = 0, length = 0;
  [[nodiscard]] double part() const { return (tooMuch + tooLittle) / length; }
};
inline void addDifference(Difference& sum, const Dexels& asked, const Dexels& truth) {
  LineEnds a, b;
  for (std::size_t line = 0; line < truth.lineCount(); ++line) {
    asked.read(line, a);
    truth.read(line, b);
    double at = 0;
    for (std::size_t i = 0, j = 0; i < a.size() || j < b.size();) {
      constexpr float kNever = std::numeric_limits<float>::infinity();
      const float nextA = i < a.size() ? a[i].depth : kNever, nextB = j < b.size() ? b[j].depth : kNever;
      const double next = static_cast<double>(std::min(nextA, nextB));
      if (j % 2 == 1) sum.length += next - at;
      if (i % 2 == 1 && j % 2 == 0) sum.tooMuch += next - at;
      if (i % 2 == 0 && j % 2 == 1) sum.tooLittle += next - at;
      at = next;
      if (static_cast<double>(nextA) == next) ++i;
      if (static_cast<double>(nextB) == next) ++j;
    }
  }
}
inline Difference difference(const RefinedModel& asked, const RefinedModel& truth) {
  Difference sum;
  for (std::size_t f = 0; f < truth.families.size(); ++f)
    addDifference(sum, asked.families[f].dexels, truth.families[f].dexels);
  return sum;
}
inline bool areEqual(const RefinedModel& a, const RefinedModel& b) {
  if (a.families.size() != b.families.size()) return false;
  for (std::size_t f = 0; f < a.families.size(); ++f)
    if (!(a.families[f].dexels == b.families[f].dexels)) return false;
  return true;
}

/// A turned box, a cube, a ball and a frustum about the origin and to one side.
inline std::vector<Zone> someZones() {
  const DVec3 u = normalized(DVec3(1, 2, 0.5)), v = normalized(cross(DVec3(0, 0, 1), u));
  Camera camera;
  camera.position = {0.4f, 0.3f, 2.5f};
  camera.view = {-0.1f, -0.2f, -1};
  camera.halfHeight = 0.2f;
  camera.width = 60;
  camera.height = 40;
  camera.near = 1.2f;
  camera.far = 3.0f;
  Box cube;
  cube.add({{-0.3f, 0.1f, -0.2f}, {0.5f, 0.9f, 0.6f}});
  return {Zone(OrientedBox{.center = {0.2, 0.1, 0.3}, .axes = {u, v, cross(u, v)}, .half = {0.5, 0.3, 0.4}}),
          Zone(orientedBoxOf(cube)), Zone(implicit::Sphere{{0.3f, -0.4f, 0.2f}, 0.45f}), Zone(camera)};
}

}  // namespace restroke::points::testing
