#pragma once
// What the tests of tri-dexels in OpenGL share: models of random lines, and crossings with a mesh by exact
// predicates.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "implicit/errors.h"
#include "implicit/geometry/exact_predicates.h"
#include "points/dexel/gl/gl_tri_dexel.h"
#include "tests/support/brute_force.h"

namespace restroke::points::testing {

/// Skips where there is no OpenGL 4.3. One context serves all tests: its programs are made once.
class GlDexelTest : public ::testing::Test {
 protected:
  void SetUp() override {
    static std::string sentence;
    if (!context() && sentence.empty()) {
      try {
        context().emplace();
      } catch (const InputError& error) {
        sentence = error.what();
      }
    }
    if (!context()) GTEST_SKIP() << "no OpenGL 4.3 on this machine: " << sentence;
  }
  static GlDexelContext& gl() { return *context(); }

 private:
  static std::optional<GlDexelContext>& context() {
    static std::optional<GlDexelContext> shared;
    return shared;
  }
};

/// A grid of so many points along the axes, at whole numbers from 0.
inline DexelGrid wholeGrid(GridCounts counts) {
  return DexelGrid(DexelGrid::Parts{DVec3{0}, 1.0, {}, counts});
}

/// Ends at small whole numbers, so that they often meet, some below 0; any normals, flags and operations.
inline LineEnds randomLine(restroke::testing::Random& random, int most) {
  LineEnds ends;
  auto at = static_cast<float>(random.below(20)) - 12;
  for (std::size_t i = 2 * random.below(static_cast<std::size_t>(most) + 1); i > 0; --i) {
    at += 1 + static_cast<float>(random.below(3));
    Vec3 n = random.inCube(1);
    if (random.below(3) == 0) n = {0, random.below(2) == 0 ? 1.0f : -1.0f, 0};
    if (random.below(4) == 0) n.z = 0;
    if (n == Vec3(0)) n.x = 1;
    ends.push_back({at, packNormal(n) | (random.below(2) == 0 ? kPackedFlag : 0),
                    static_cast<OperationId>(random.below(9)), static_cast<OperationId>(random.below(9))});
  }
  return ends;
}

inline TriDexel randomModel(restroke::testing::Random& random, const DexelGrid& grid, int most) {
  TriDexel model(grid);
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t line = 0; line < model.family(axis).lineCount(); ++line)
      model.family(axis).write(line, randomLine(random, most));
  return model;
}

/// The definition: applyToLine on every line.
inline TriDexel appliedLineByLine(TriDexel model, const TriDexel& tool, DexelOperation operation,
                                  OperationId id) {
  LineEnds ends, toolEnds;
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t line = 0; line < model.family(axis).lineCount(); ++line) {
      model.family(axis).read(line, ends);
      tool.family(axis).read(line, toolEnds);
      std::vector<ToolSpan> spans;
      for (std::size_t i = 0; i < toolEnds.size(); i += 2)
        spans.push_back({toolEnds[i].depth, toolEnds[i + 1].depth, toolEnds[i].normal & ~kPackedFlag,
                         toolEnds[i + 1].normal & ~kPackedFlag});
      applyToLine(ends, spans, operation, id);
      model.family(axis).write(line, ends);
    }
  return model;
}

/// A crossing by the exact predicates; its depth is off by less than a float32 number has room for.
struct Crossing {
  long double depth = 0;
  std::uint32_t triangle = 0;
};

/// Crossings of each line of a family, ascending.
inline std::vector<std::vector<Crossing>> exactCrossings(const TriangleMesh& mesh, const DexelGrid& grid,
                                                         int axis) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const auto width = static_cast<std::size_t>(grid.width(axis));
  std::vector<std::vector<Crossing>> lines(width * static_cast<std::size_t>(grid.height(axis)));
  const double before = static_cast<double>(boundsOf(mesh).min[axis]) - 1;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    Triangle turned;  // so that the family's axis is x
    Box box;
    for (std::size_t k = 0; k < 3; ++k) {
      const Point p = mesh.vertices[mesh.triangles[t][k]];
      turned[k] = {p[axis], p[u], p[v]};
      box.add({turned[k], turned[k]});
    }
    for (int row = grid.firstFrom(v, static_cast<double>(box.min.z));
         row < grid.height(axis) && grid.at(v, row) <= box.max.z; ++row)
      for (int column = grid.firstFrom(u, static_cast<double>(box.min.y));
           column < grid.width(axis) && grid.at(u, column) <= box.max.y; ++column) {
        const DVec3 p(before, static_cast<double>(grid.at(u, column)), static_cast<double>(grid.at(v, row)));
        if (crossingOf(turned, p) == 0) continue;
        long double d[3][3];  // from the first corner: to the others, to the line
        for (std::size_t k = 0; k < 3; ++k) {
          const auto i = static_cast<int>(k);
          for (std::size_t c = 1; c < 3; ++c)
            d[c - 1][k] = static_cast<long double>(turned[c][i]) - static_cast<long double>(turned[0][i]);
          d[2][k] = static_cast<long double>(p[i]) - static_cast<long double>(turned[0][i]);
        }
        const long double n[3] = {d[0][1] * d[1][2] - d[0][2] * d[1][1],
                                  d[0][2] * d[1][0] - d[0][0] * d[1][2],
                                  d[0][0] * d[1][1] - d[0][1] * d[1][0]};
        lines[static_cast<std::size_t>(row) * width + static_cast<std::size_t>(column)].push_back(
            {static_cast<long double>(turned[0].x) - (n[1] * d[2][1] + n[2] * d[2][2]) / n[0], t});
      }
  }
  for (auto& line : lines)
    std::sort(line.begin(), line.end(),
              [](const Crossing& a, const Crossing& b) { return a.depth < b.depth; });
  return lines;
}

/// How a tri-dexel differs from the exact crossings.
struct PeelDifference {
  std::size_t lines = 0, otherCount = 0, ends = 0;
  double depth = 0;              ///< greatest, model units, on lines with as many ends
  double depthBound = 0;         ///< what kPeelDepthBound allows
  std::size_t otherNormals = 0;  ///< more than kPeelNormalSteps from the triangle's own, turned outside
};

inline bool isNearNormal(PackedNormal a, PackedNormal b) {
  const auto steps = [](PackedNormal n) { return octahedral::unpack(n & ~kPackedFlag); };
  const octahedral::Folded f = steps(a), g = steps(b);
  if (std::abs(f.u - g.u) <= kPeelNormalSteps && std::abs(f.v - g.v) <= kPeelNormalSteps) return true;
  // On the border of the net neighbours are far apart in it.
  return length(unpackNormal(a) - unpackNormal(b)) < 2e-4f;
}

inline PeelDifference differenceFrom(const TriangleMesh& mesh, const TriDexel& model) {
  PeelDifference out;
  double largest = 0;
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t i : t)
      for (int k = 0; k < 3; ++k)
        largest = std::max(largest, std::fabs(static_cast<double>(mesh.vertices[i][k])));
  out.depthBound = kPeelDepthBound * largest;
  LineEnds ends;
  for (int axis = 0; axis < 3; ++axis) {
    const auto lines = exactCrossings(mesh, model.grid(), axis);
    for (std::size_t line = 0; line < lines.size(); ++line) {
      std::vector<Crossing> exact;
      for (const Crossing& c : lines[line]) {  // in pairs at one float32 number they vanish
        if (!exact.empty() && static_cast<float>(exact.back().depth) == static_cast<float>(c.depth))
          exact.pop_back();
        else
          exact.push_back(c);
      }
      model.family(axis).read(line, ends);
      ++out.lines;
      if (ends.size() != exact.size()) {
        ++out.otherCount;
        continue;
      }
      out.ends += ends.size();
      for (std::size_t i = 0; i < ends.size(); ++i) {
        out.depth = std::max(
            out.depth,
            static_cast<double>(std::fabs(static_cast<long double>(ends[i].depth) - exact[i].depth)));
        const auto& t = mesh.triangles[exact[i].triangle];
        const DVec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
        DVec3 n = cross(b - a, c - a);
        if ((n[axis] > 0) != (i % 2 == 1)) n = -n;
        if (!isNearNormal(ends[i].normal, packNormal(Vec3(normalized(n))))) ++out.otherNormals;
      }
    }
  }
  return out;
}

}  // namespace restroke::points::testing
