// Operations replayed on lines (SPEC R5, R6): against the definition, line by line.

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "implicit/errors.h"
#include "implicit/simd/dispatch.h"
#include "points/dexel/mesh_solid.h"
#include "tests/points/refine_support.h"
#include "tests/support/effort.h"
#include "tests/support/meshes.h"

namespace restroke::points {
namespace {

using restroke::testing::kSanitized;
using restroke::testing::Random;
using testing::Primitive;
using testing::someZones;

// Volumes of every kind, posed meshes, and now and then an intersection.
TriDexelDocument mixedDocument(std::uint64_t seed, std::size_t count) {
  Random random(seed);
  TriDexelDocument document;
  std::vector<Primitive> list = {{{{0, 0, 0}, 1.0f}, testing::Sign::Positive}};
  document.initial = list;
  document.tools.push_back(restroke::testing::boxMesh({-0.2f, -0.1f, -0.15f}, {0.2f, 0.3f, 0.1f}));
  while (document.operations.size() < count) {
    const std::size_t choice = random.below(12);
    if (choice == 0) {
      PoseMatrix pose = kIdentityPose;
      const DVec3 x = normalized(DVec3(random.inCube(1))), y = normalized(cross(x, DVec3(random.inCube(1))));
      const DVec3 z = cross(x, y), at(random.inCube(0.8f));
      for (std::size_t row = 0; row < 3; ++row) {
        const int r = static_cast<int>(row);
        pose[4 * row] = x[r];
        pose[4 * row + 1] = y[r];
        pose[4 * row + 2] = z[r];
        pose[4 * row + 3] = at[r];
      }
      document.operations.push_back(
          {static_cast<DexelOperation>(random.below(2)), TriDexelDocument::PosedTool{0, pose}});
    } else if (choice == 1 && random.below(4) == 0) {
      document.operations.push_back(
          {DexelOperation::Intersection, implicit::Shape(random.inCube(0.3f), random.between(0.8f, 1.1f))});
    } else {
      list.push_back(restroke::testing::randomMixedPrimitive(random, list));
      document.operations.push_back(testing::operationOf(list.back()));
    }
  }
  return document;
}

std::vector<OperationId> allOf(const DexelHistory& history) {
  std::vector<OperationId> ids;
  for (std::size_t i = 0; i < history.idCount(); ++i) ids.push_back(static_cast<OperationId>(i));
  return ids;
}

// Where a step fills or clears a line, in float32, cut to the zone.
struct Painted {
  float enter, exit;
  bool fills;
  OperationId id;
};
std::vector<Painted> paintedBy(const HistoryStep& step, const Ray& line, float from, float to) {
  std::vector<SolidSpan> spans;
  if (step.ball) {
    if (const auto in = intersect(*step.ball, line)) spans.push_back({in->enter, in->exit});
  } else {
    step.solid->intersect(line, spans);
  }
  std::vector<std::pair<double, double>> stretches;
  if (step.operation == DexelOperation::Intersection) {
    double at = -1e30;
    for (const SolidSpan& span : spans) {
      stretches.emplace_back(at, span.enter);
      at = span.exit;
    }
    stretches.emplace_back(at, 1e30);
  } else {
    for (const SolidSpan& span : spans) stretches.emplace_back(span.enter, span.exit);
  }
  std::vector<Painted> out;
  for (const auto& [enter, exit] : stretches) {
    const float first = std::max(static_cast<float>(enter), from),
                last = std::min(static_cast<float>(exit), to);
    if (first < last) out.push_back({first, last, step.operation == DexelOperation::Union, step.id});
  }
  return out;
}

// By the definition, from the front: between any two borders the last operation there decides.
LineEnds endsByDefinition(const std::vector<HistoryStep>& steps, const Ray& line, float from, float to) {
  std::vector<Painted> all;
  std::set<float> borders = {from, to};
  for (const HistoryStep& step : steps)
    for (const Painted& painted : paintedBy(step, line, from, to)) {
      all.push_back(painted);
      borders.insert(painted.enter);
      borders.insert(painted.exit);
    }
  LineEnds ends;
  bool solid = false;
  OperationId owner = OperationId::None;
  for (auto at = borders.begin(); std::next(at) != borders.end(); ++at) {
    bool here = false;
    OperationId by = OperationId::None;
    for (const Painted& painted : all)
      if (painted.enter <= *at && *std::next(at) <= painted.exit) {
        here = painted.fills;
        by = painted.id;
      }
    if (here != solid) {
      const OperationId outer = *at == from ? OperationId::None : here ? owner : by;
      ends.push_back({*at, 0, here ? by : owner, outer});
    }
    solid = here;
    owner = by;
  }
  if (solid) ends.push_back({to, 0, owner, OperationId::None});
  return ends;
}

TEST(LineReplay, R6IsTheLastOperationThatDecidesOnLinesInAnyDirection) {
  const TriDexelDocument document = mixedDocument(5, kSanitized ? 30 : 90);
  const DexelHistory history(document);
  const auto ids = allOf(history);
  std::vector<HistoryStep> steps;
  for (const OperationId id : ids) history.stepsOf(id, steps);
  std::size_t endsSeen = 0;
  for (const Zone& zone : someZones())
    for (const LineFamily& family : newLines(zone, {.resolution = kSanitized ? 8 : 24})) {
      const LinesInZone lines = linesInZone(family, zone);
      const Dexels dexels = replay({history, ids}, lines);
      LineEnds ends;
      for (int row = 0; row < family.height; ++row)
        for (int column = 0; column < family.width; ++column) {
          const std::size_t at = dexels.lineAt(column, row);
          dexels.read(at, ends);
          if (!(lines.from[at] < lines.to[at])) {
            EXPECT_TRUE(ends.empty());
            continue;
          }
          const Ray line = family.line(column, row);
          const LineEnds expected = endsByDefinition(steps, line, lines.from[at], lines.to[at]);
          ASSERT_EQ(ends.size(), expected.size()) << "line " << column << ", " << row;
          for (std::size_t i = 0; i < ends.size(); ++i) {
            ++endsSeen;
            ASSERT_EQ(ends[i].depth, expected[i].depth);
            ASSERT_EQ(ends[i].inner, expected[i].inner);
            ASSERT_EQ(ends[i].outer, expected[i].outer);
            // Out of the solid: against the line where it enters.
            const double along = dot(DVec3(unpackNormal(ends[i].normal)), line.direction);
            EXPECT_LE(i % 2 == 0 ? along : -along, 0.02);
          }
        }
    }
  EXPECT_GT(endsSeen, kSanitized ? 100u : 2000u);
}

TEST(LineReplay, R6IsTheSameAsWhenEachLineAsksEachOperationAtAnySimdLevelAndThreadCount) {
  for (const bool mixed : {false, true}) {
    const TriDexelDocument document =
        mixed ? mixedDocument(6, kSanitized ? 20 : 60)
              : testing::denseDocument({.seed = 7, .count = kSanitized ? 200u : 1000u});
    const DexelHistory history(document);
    const auto ids = allOf(history);
    for (const Zone& zone : someZones())
      for (const LineFamily& family : newLines(zone, {.resolution = kSanitized ? 10 : 48})) {
        const LinesInZone lines = linesInZone(family, zone);
        const Dexels expected = replayPlainly({history, ids}, lines, {.threads = 2});
        const implicit::SimdLevel before = implicit::simdLevel();
        for (const implicit::SimdLevel level : implicit::supportedSimdLevels()) {
          implicit::useSimdLevel(level);
          for (const int threads : {1, 3})
            EXPECT_EQ(replay({history, ids}, lines, {.threads = threads}), expected);
        }
        implicit::useSimdLevel(before);
      }
  }
}

// Depths and normals are those of dexelsOf, which replays a list from the front.
TEST(LineReplay, R5WithAllInTheZoneIsWhatTheListHas) {
  Random random(8);
  std::vector<Primitive> all = {{{{0, 0, 0}, 1.0f}, testing::Sign::Positive}};
  TriDexelDocument document;
  document.initial = all;
  implicit::PrimitiveList list;
  list.append(all[0]);
  for (std::size_t i = 0; i < (kSanitized ? 30u : 120u); ++i) {
    all.push_back(restroke::testing::randomMixedPrimitive(random, all));
    document.operations.push_back(testing::operationOf(all.back()));
    list.append(all.back());
  }
  const DexelHistory history(document);
  const Zone everything(implicit::Sphere{{0, 0, 0}, 10});
  const LineFamily family = latticeAlong({1, 0.3, -0.2}, list.bounds(), kSanitized ? 0.2 : 0.05);
  const Dexels dexels = replay({history, allOf(history)}, linesInZone(family, everything)),
               expected = dexelsOf(list, family);
  LineEnds a, b;
  std::size_t different = 0, seen = 0;
  for (std::size_t line = 0; line < dexels.lineCount(); ++line) {
    dexels.read(line, a);
    expected.read(line, b);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_EQ(a[i].depth, b[i].depth);
      ++seen;
      // Where ends of two operations coincide either's normal is right.
      different += (a[i].normal & ~kPackedFlag) != (b[i].normal & ~kPackedFlag) ? 1 : 0;
    }
  }
  EXPECT_GT(seen, kSanitized ? 50u : 1000u);
  EXPECT_LE(different, seen / 50);
}

TEST(LineReplay, WithNothingToReplayLinesAreEmptyOrWhatTheyStartedAs) {
  TriDexelDocument document;
  const DexelHistory history(document);
  EXPECT_EQ(history.idCount(), 1u);
  const Zone zone = someZones()[1];
  const LinesInZone lines = linesInZone(newLines(zone, {.resolution = 9})[0], zone);
  EXPECT_EQ(replay({history, {}}, lines).endCount(), 0u);
  EXPECT_EQ(replay({history, allOf(history)}, lines).endCount(), 0u);
  Dexels start(lines.family.width, lines.family.height, {});
  const float middle = (lines.from[4] + lines.to[4]) / 2;
  start.write(4, std::vector<SpanEnd>{{lines.from[4], 5}, {middle, 6}});
  LineEnds ends;
  const Dexels kept = replay({history, {}, {.start = &start}}, lines);
  kept.read(4, ends);
  ASSERT_EQ(ends.size(), 2u);
  EXPECT_EQ(ends[1].depth, middle);
  EXPECT_EQ(ends[1].normal, 6u);
  EXPECT_EQ(kept.endCount(), 2u);
}

TEST(DexelHistory, R6ClustersFindWhatBoundsFind) {
  const TriDexelDocument documents[] = {mixedDocument(9, kSanitized ? 100 : 400),
                                        testing::denseDocument({.seed = 10, .count = 3000, .least = 0.001f})};
  for (const TriDexelDocument& document : documents) {
    const DexelHistory history(document);
    for (const Zone& zone : someZones()) {
      const auto ids = history.idsByBounds(zone);
      EXPECT_EQ(history.idsByClusters(zone), ids);
      EXPECT_LT(ids.size(), history.idCount());
      // None is missed: its bounds are asked one by one.
      std::size_t meet = 0;
      for (const OperationId id : allOf(history)) meet += zone.mayMeet(history.boundsOf(id)) ? 1 : 0;
      EXPECT_EQ(ids.size(), meet);
    }
  }
}

TEST(DexelHistory, RefusesAToolThatCannotBePosed) {
  TriDexelDocument document;
  document.tools.push_back(restroke::testing::boxMesh({0, 0, 0}, {1, 1, 1}));
  PoseMatrix pose = kIdentityPose;
  pose[0] = 2;
  document.operations.push_back({DexelOperation::Union, TriDexelDocument::PosedTool{0, pose}});
  try {
    const DexelHistory history(document);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).rfind("operation 1: ", 0), 0u) << error.what();
  }
}

TEST(MeshSolid, IsInsideWhereTheMeshIs) {
  const TriangleMesh mesh = restroke::testing::boxMesh({-0.2f, -0.1f, -0.15f}, {0.2f, 0.3f, 0.1f});
  const auto lined = std::make_shared<const MeshForLines>(mesh);
  PoseMatrix pose = kIdentityPose;
  pose[0] = pose[5] = 0.6;  // turned about z by an angle of cosine 0.6, and twice as large
  pose[1] = -0.8;
  pose[4] = 0.8;
  for (std::size_t i : {0u, 1u, 2u, 4u, 5u, 6u, 8u, 9u, 10u}) pose[i] *= 2;
  pose[3] = 1;
  const MeshSolid solid(lined, pose);
  Random random(11);
  std::size_t hits = 0;
  for (int k = 0; k < 500; ++k) {
    const Ray line{DVec3(random.inCube(1)) + DVec3(1, 0, 0), normalized(DVec3(random.inCube(1)))};
    std::vector<SolidSpan> spans;
    solid.intersect(line, spans);
    for (int i = 0; i < 10; ++i) {
      const double t = static_cast<double>(random.between(-1.5f, 1.5f));
      // Into the mesh's frame.
      const DVec3 p = (line.at(t) - DVec3(1, 0, 0)) / 2.0,
                  q(0.6 * p.x + 0.8 * p.y, -0.8 * p.x + 0.6 * p.y, p.z);
      const bool inside =
          q.x >= -0.2f && q.x <= 0.2f && q.y >= -0.1f && q.y <= 0.3f && q.z >= -0.15f && q.z <= 0.1f;
      bool found = false;
      for (const SolidSpan& span : spans) found = found || (t >= span.enter && t <= span.exit);
      EXPECT_EQ(found, inside);
    }
    for (const SolidSpan& span : spans) {
      ++hits;
      EXPECT_NEAR(static_cast<double>(length(span.enterNormal)), 1, 1e-6);
      EXPECT_LE(dot(DVec3(span.enterNormal), line.direction), 0);
      EXPECT_GE(dot(DVec3(span.exitNormal), line.direction), 0);
    }
  }
  EXPECT_GT(hits, 30u);
}

}  // namespace
}  // namespace restroke::points
