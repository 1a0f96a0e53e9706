// Replays on lines by the graphics card are those of the CPU, bit for bit.

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "points/dexel/gl/gl_line_replay.h"
#include "points/dexel/refine/model_cells.h"
#include "points/dexel/refine/refine.h"
#include "tests/points/dexel_gl_support.h"
#include "tests/points/refine_support.h"
#include "tests/support/brute_force.h"
#include "tests/support/effort.h"
#include "tests/support/meshes.h"
#include "tests/support/random_volumes.h"

namespace restroke::points {
namespace {

using implicit::Primitive;
using implicit::PrimitiveList;
using implicit::Sign;
using implicit::Sphere;
using restroke::testing::kSanitized;
using restroke::testing::Random;
using Operation = TriDexelDocument::Operation;

using GlLineReplays = testing::GlDexelTest;
using Options = GlLineReplay::Options;

const Sphere kUnitBall{Point(0), 1};

DexelOperation randomChange(Random& random) {
  return random.below(2) == 0 ? DexelOperation::Union : DexelOperation::Subtraction;
}
Operation randomBall(Random& random, float least, float most) {
  return {randomChange(random), implicit::Shape(Sphere{random.inCube(1), random.between(least, most)})};
}
TriDexelDocument denseBalls(Random& random, int count) {
  TriDexelDocument document;
  document.initial = std::vector<Primitive>{{kUnitBall, Sign::Positive}};
  for (int i = 0; i < count; ++i) document.operations.push_back(randomBall(random, 0.03f, 0.3f));
  return document;
}
PoseMatrix randomPose(Random& random) {
  // A turn about one axis, by a half angle whose tangent is t.
  const double t = static_cast<double>(random.between(-1, 1)), c = (1 - t * t) / (1 + t * t),
               s = 2 * t / (1 + t * t), scale = static_cast<double>(random.between(0.2f, 0.5f));
  const DVec3 at(random.inCube(0.8f));
  if (random.below(2) == 0)
    return {scale * c, -scale * s, 0, at.x, scale * s, scale * c, 0, at.y, 0, 0, scale, at.z, 0, 0, 0, 1};
  return {scale, 0, 0, at.x, 0, scale * c, -scale * s, at.y, 0, scale * s, scale * c, at.z, 0, 0, 0, 1};
}
// Balls, volumes of every kind, posed meshes, swept cutters; now and then something is kept only.
TriDexelDocument mixedSolids(Random& random, int count) {
  TriDexelDocument document;
  document.initial =
      std::vector<Primitive>{{kUnitBall, Sign::Positive}, {{{0.5f, 0, 0}, 0.4f}, Sign::Negative}};
  document.tools = {restroke::testing::boxMesh({-1, -1, -1}, {1, 1, 1}), restroke::testing::ballMesh(1)};
  document.cutters = {{.kind = Cutter::Kind::Flat, .radius = 0.15, .length = 1},
                      {.kind = Cutter::Kind::Ball, .radius = 0.2, .length = 2}};
  std::vector<Primitive> primitives;
  for (int i = 0; i < count; ++i) {
    switch (random.below(5)) {
      case 0:
        document.operations.push_back(randomBall(random, 0.05f, 0.4f));
        break;
      case 1:
        document.operations.push_back(
            {randomChange(random),
             TriDexelDocument::PosedTool{static_cast<std::uint32_t>(random.below(2)), randomPose(random)}});
        break;
      case 2:
        document.operations.push_back(
            {randomChange(random),
             CutterMove{static_cast<std::uint32_t>(random.below(2)),
                        {.from = DVec3(random.inCube(1)), .to = DVec3(random.inCube(1))}}});
        break;
      case 3:
        if (random.below(4) == 0) {
          document.operations.push_back(
              {DexelOperation::Intersection, implicit::Shape(Sphere{random.inCube(0.2f), 1.1f})});
          break;
        }
        [[fallthrough]];
      default:
        primitives.push_back(restroke::testing::randomMixedPrimitive(random, primitives));
        document.operations.push_back({randomChange(random), primitives.back().shape});
    }
  }
  return document;
}

OrientedBox turnedBox() {
  OrientedBox box{.center = {0.1, -0.2, 0.15}, .half = {0.5, 0.4, 0.6}};
  box.axes = {DVec3{0.6, 0.8, 0}, DVec3{-0.48, 0.36, 0.8}, DVec3{0.64, -0.48, 0.6}};
  return box;
}
Camera smallCamera(std::uint32_t width, std::uint32_t height) {
  Camera camera;
  camera.position = {1.5f, 1.1f, 2.3f};
  camera.view = {-1.4f, -1.0f, -2.2f};
  camera.width = width;
  camera.height = height;
  camera.near = 0.5f;
  camera.far = 5;
  return camera;
}

struct ZonedLines {
  const char* name;
  Zone zone;
  std::vector<LineFamily> families;
};
// Along axes, oblique, from a camera; in all kinds of zones.
std::vector<ZonedLines> lineCases(int resolution) {
  Box box;
  box.add({{-0.7f, -0.5f, -0.9f}, {0.6f, 0.8f, 0.4f}});
  const Zone straight(orientedBoxOf(box)), turned(turnedBox()), ball(Sphere{{0.1f, 0.2f, -0.1f}, 0.8f});
  const auto side = static_cast<std::uint32_t>(resolution);
  const Camera camera = smallCamera(side + side / 2, side);
  const Zone frustum(camera);
  return {{"box", straight, newLines(straight, {.resolution = resolution})},
          {"turned box", turned, newLines(turned, {.resolution = resolution})},
          {"ball, oblique lines", ball,
           newLines(ball, {.resolution = resolution, .direction = DVec3(1, 2, -0.7)})},
          {"frustum", frustum, newLines(frustum, {.perPixel = true})}};
}

std::vector<OperationId> allOf(const DexelHistory& history) {
  std::vector<OperationId> ids(history.idCount());
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = static_cast<OperationId>(i);
  return ids;
}

// 0 and -0 are different bits.
bool areSameBits(const LineEnds& a, const LineEnds& b) {
  static_assert(sizeof(SpanEnd) == 4 * sizeof(std::uint32_t), "there are no gaps between numbers");
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0);
}
void expectSameBits(const Dexels& card, const Dexels& cpu) {
  ASSERT_EQ(card.lineCount(), cpu.lineCount());
  LineEnds a, b;
  std::size_t wrong = 0;
  for (std::size_t line = 0; line < cpu.lineCount(); ++line) {
    card.read(line, a);
    cpu.read(line, b);
    if (areSameBits(a, b)) continue;
    if (++wrong > 3) continue;
    ADD_FAILURE() << "line " << line << " has " << a.size() << " ends, not " << b.size();
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
      if (!(a[i] == b[i])) {
        ADD_FAILURE() << "end " << i << ": depth " << a[i].depth << " for " << b[i].depth << ", normal "
                      << a[i].normal << " for " << b[i].normal << ", inner "
                      << static_cast<std::uint32_t>(a[i].inner) << " for "
                      << static_cast<std::uint32_t>(b[i].inner) << ", outer "
                      << static_cast<std::uint32_t>(a[i].outer) << " for "
                      << static_cast<std::uint32_t>(b[i].outer);
        break;
      }
  }
  EXPECT_EQ(wrong, 0u) << "of " << cpu.lineCount() << " lines";
}

// How much there is of it, so that tests cannot pass by having nothing.
std::size_t expectSameAsOnCpu(const GlLineReplay& onCard, const DexelHistory& history,
                              const std::vector<OperationId>& ids, const std::vector<ZonedLines>& cases) {
  std::size_t ends = 0;
  for (const ZonedLines& given : cases)
    for (const LineFamily& family : given.families) {
      SCOPED_TRACE(given.name);
      const LinesInZone lines = linesInZone(family, given.zone);
      const Dexels cpu = replay({history, ids}, lines);
      expectSameBits(onCard({history, ids}, lines), cpu);
      ends += cpu.endCount();
    }
  return ends;
}

TEST_F(GlLineReplays, OfDenseBallsAreThoseOfTheCpu) {
  for (const std::uint64_t seed : {11, 12}) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const TriDexelDocument document = denseBalls(random, kSanitized ? 100 : 600);
    const DexelHistory history(document);
    EXPECT_GT(expectSameAsOnCpu(GlLineReplay(gl()), history, allOf(history), lineCases(kSanitized ? 9 : 37)),
              1000u);
  }
}

TEST_F(GlLineReplays, OfSomeOperationsAreThoseOfTheCpu) {
  Random random(13);
  const TriDexelDocument document = denseBalls(random, 300);
  const DexelHistory history(document);
  std::vector<OperationId> ids;
  for (std::uint32_t i = 0; i < history.idCount(); ++i)
    if (random.below(3) == 0) ids.push_back(OperationId{i});
  EXPECT_GT(expectSameAsOnCpu(GlLineReplay(gl()), history, ids, lineCases(kSanitized ? 9 : 25)), 500u);
}

TEST_F(GlLineReplays, OfMixedSolidsAreThoseOfTheCpu) {
  for (const std::uint64_t seed : {21, 22, 23}) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const TriDexelDocument document = mixedSolids(random, kSanitized ? 20 : 60);
    const DexelHistory history(document);
    EXPECT_GT(expectSameAsOnCpu(GlLineReplay(gl()), history, allOf(history), lineCases(kSanitized ? 7 : 21)),
              500u);
  }
}

TEST_F(GlLineReplays, StartFromAMeshAsOnTheCpu) {
  Random random(31);
  TriDexelDocument document = mixedSolids(random, 12);
  document.initial = restroke::testing::ballMesh(2);
  const DexelHistory history(document);
  EXPECT_GT(expectSameAsOnCpu(GlLineReplay(gl()), history, allOf(history), lineCases(kSanitized ? 7 : 21)),
            500u);
}

TEST_F(GlLineReplays, OfNothingAreEmpty) {
  const TriDexelDocument nothing;
  const DexelHistory history(nothing);
  const Zone zone{kUnitBall};
  const GlLineReplay onCard(gl());
  for (const LineFamily& family : newLines(zone, {.resolution = 9})) {
    const Dexels dexels = onCard({history, allOf(history)}, linesInZone(family, zone));
    EXPECT_EQ(dexels.lineCount(), 81u);
    EXPECT_EQ(dexels.endCount(), 0u);
    EXPECT_TRUE(dexels.keepsOperations());
    EXPECT_EQ(onCard({history, {}}, linesInZone(family, zone)), dexels);
  }
}

TEST_F(GlLineReplays, WhereNoLineMeetsTheZoneAreEmpty) {
  Random random(41);
  const TriDexelDocument document = denseBalls(random, 20);
  const DexelHistory history(document);
  const Zone near{kUnitBall}, far{Sphere{{50, 50, 50}, 1}};
  for (const LineFamily& family : newLines(near, {.resolution = 9})) {
    const LinesInZone lines = linesInZone(family, far);
    ASSERT_EQ(lines.count(), 0u);
    EXPECT_EQ(GlLineReplay(gl())({history, allOf(history)}, lines).endCount(), 0u);
  }
  const LinesInZone none{.family = {}, .from = {}, .to = {}};
  EXPECT_EQ(GlLineReplay(gl())({history, allOf(history)}, none).lineCount(), 0u);
}

// Concentric shells, the last one the smallest: every line through the middle has all of them.
TriDexelDocument shells(int count) {
  TriDexelDocument document;
  for (int i = 0; i < count; ++i)
    document.operations.push_back(
        {i % 2 == 0 ? DexelOperation::Union : DexelOperation::Subtraction,
         implicit::Shape(Sphere{Point(0), 1 - static_cast<float>(i) / static_cast<float>(count)})});
  return document;
}

// The most ends that a line has.
std::size_t expectSameShells(const GlLineReplay& onCard, int count, int resolution) {
  const TriDexelDocument document = shells(count);
  const DexelHistory history(document);
  const Zone zone{Sphere{Point(0), 1.25f}};
  std::size_t most = 0;
  for (const LineFamily& family : newLines(zone, {.resolution = resolution, .direction = DVec3(1, 2, 3)})) {
    const LinesInZone lines = linesInZone(family, zone);
    const Dexels cpu = replay({history, allOf(history)}, lines);
    expectSameBits(onCard({history, allOf(history)}, lines), cpu);
    for (std::size_t line = 0; line < cpu.lineCount(); ++line) most = std::max(most, cpu.endCount(line));
  }
  return most;
}

TEST_F(GlLineReplays, HaveRoomForHundredsOfShells) {
  const int count = kSanitized ? 60 : 400;
  for (const std::size_t room : {1, 16, 100'000})
    EXPECT_GE(expectSameShells(GlLineReplay(gl(), Options{.room = room}), count, 15),
              2 * static_cast<std::size_t>(count) - 2);
}

TEST_F(GlLineReplays, HaveThousandsOfPiecesOnTheCpu) {
  if (kSanitized) GTEST_SKIP() << "too slow in a sanitized build";
  EXPECT_GE(expectSameShells(GlLineReplay(gl()), 2500, 3), 4900u);
}

TEST_F(GlLineReplays, StartFromThousandsOfEnds) {
  const Zone zone{Sphere{Point(0), 1}};
  const LineFamily family = newLines(zone, {.resolution = 3, .direction = DVec3(0, 0, 1)}).front();
  const LinesInZone lines = linesInZone(family, zone);
  Dexels start(family.width, family.height, {.operations = true});
  for (std::size_t line = 0; line < start.lineCount(); ++line) {
    LineEnds ends;
    for (int i = 0; i < 2 * (line % 2 == 0 ? 300 : 3000); ++i)
      ends.push_back(
          {static_cast<float>(i - 3000) * 0x1p-12f, packNormal({0, 0, i % 2 == 0 ? -1.0f : 1.0f})});
    start.write(line, ends);
  }
  Random random(91);
  const TriDexelDocument document = denseBalls(random, 20);
  const DexelHistory history(document);
  const std::vector<OperationId> ids = {OperationId{3}, OperationId{7}, OperationId{8}};
  const Dexels cpu = replay({history, ids, {.start = &start}}, lines);
  EXPECT_GT(cpu.endCount(), 5000u);
  expectSameBits(GlLineReplay(gl())({history, ids, {.start = &start}}, lines), cpu);
}

// One solid that meets a line hundreds of times: what a work item does at a time ends within it.
TEST_F(GlLineReplays, GoThroughHundredsOfWalls) {
  const int walls = kSanitized ? 40 : 800;
  TriangleMesh mesh;
  for (int i = 0; i < walls; ++i) {
    const float low = 2 * static_cast<float>(i) / static_cast<float>(walls) - 1;
    mesh = restroke::testing::together(
        std::move(mesh),
        restroke::testing::boxMesh({-0.8f, -0.8f, low}, {0.8f, 0.8f, low + 1 / static_cast<float>(walls)}));
  }
  TriDexelDocument document;
  document.tools = {std::move(mesh)};
  document.operations = {{DexelOperation::Union, TriDexelDocument::PosedTool{0, kIdentityPose}}};
  const DexelHistory history(document);
  const Zone zone{Sphere{Point(0), 1.1f}};
  for (const LineFamily& family : newLines(zone, {.resolution = 5, .direction = DVec3(0.1, 0.2, 1)})) {
    const LinesInZone lines = linesInZone(family, zone);
    const Dexels cpu = replay({history, allOf(history)}, lines);
    expectSameBits(GlLineReplay(gl())({history, allOf(history)}, lines), cpu);
    EXPECT_GT(cpu.endCount(), 10 * static_cast<std::size_t>(walls));
  }
}

TEST_F(GlLineReplays, AreTheSameHoweverTheWorkIsCut) {
  Random random(51);
  const TriDexelDocument document = mixedSolids(random, 40);
  const DexelHistory history(document);
  const Options cuts[] = {{.lines = 1},
                          {.room = 2, .lines = 100},
                          {.pairs = 1},
                          {.room = 5, .lines = 70, .pairs = 90, .solids = 1},
                          {.solids = 1000}};
  std::vector<ZonedLines> cases = lineCases(kSanitized ? 9 : 19);
  cases.erase(cases.begin(), cases.begin() + 2);
  for (const Options& options : cuts) {
    if (options.lines == 1) {  // slow
      const ZonedLines few{"few", cases[0].zone, newLines(cases[0].zone, {.resolution = 6})};
      EXPECT_GT(expectSameAsOnCpu(GlLineReplay(gl(), options), history, allOf(history), {few}), 50u);
    } else {
      EXPECT_GT(expectSameAsOnCpu(GlLineReplay(gl(), options), history, allOf(history), cases), 200u);
    }
  }
}

TEST_F(GlLineReplays, KnowWhatCellsKnow) {
  Random random(61);
  const TriDexelDocument document = mixedSolids(random, 40);
  const DexelHistory history(document);
  Box box;
  box.add({Point(-1), Point(1)});
  // Any model will do: cells decide first, whatever they say.
  TriDexel model{DexelGrid(box, 0.09)};
  const std::vector<Primitive> primitives = {{kUnitBall, Sign::Positive},
                                             {{{0, 0.3f, 0}, 0.5f}, Sign::Negative}};
  model.apply(primitives, OperationId{0});
  for (const ZonedLines& given : lineCases(kSanitized ? 9 : 31)) {
    const ModelCells cells(model, given.zone.bounds(), {});
    for (const LineFamily& family : given.families) {
      SCOPED_TRACE(given.name);
      const LinesInZone lines = linesInZone(family, given.zone);
      for (const std::size_t room : {2, 16}) {
        const Dexels cpu = replay({history, allOf(history), {.known = &cells}}, lines);
        expectSameBits(
            GlLineReplay(gl(), Options{.room = room})({history, allOf(history), {.known = &cells}}, lines),
            cpu);
        EXPECT_GT(cpu.endCount(), 100u);
        expectSameBits(GlLineReplay(gl())({history, {}, {.known = &cells}}, lines),
                       replay({history, {}, {.known = &cells}}, lines));
      }
    }
  }
}

TEST_F(GlLineReplays, StartFromOtherDexels) {
  Random random(71);
  const TriDexelDocument document = denseBalls(random, 60), other = denseBalls(random, 80);
  const DexelHistory history(document), otherHistory(other);
  const std::vector<OperationId> ids = allOf(history);
  for (const ZonedLines& given : lineCases(kSanitized ? 9 : 31))
    for (const LineFamily& family : given.families) {
      SCOPED_TRACE(given.name);
      const LinesInZone lines = linesInZone(family, given.zone);
      const Dexels start = replay({otherHistory, allOf(otherHistory)}, lines);
      // Without the initial solid, or it would hide what was there.
      const std::span<const OperationId> some = std::span(ids).subspan(1);
      const Dexels cpu = replay({history, some, {.start = &start}}, lines);
      expectSameBits(GlLineReplay(gl())({history, some, {.start = &start}}, lines), cpu);
      EXPECT_GT(cpu.endCount(), 100u);
      expectSameBits(GlLineReplay(gl())({history, {}, {.start = &start}}, lines),
                     replay({history, {}, {.start = &start}}, lines));
    }
}

TEST_F(GlLineReplays, RefineAsTheCpuDoes) {
  Random random(81);
  TriDexelDocument document = denseBalls(random, kSanitized ? 60 : 300);
  testing::makeModel(document, 40);
  const DexelHistory history(document);
  Box part;
  part.add({Point(0.2f), Point(0.7f)});
  const Zone zone(orientedBoxOf(part));
  const std::vector<LineFamily> families = newLines(zone, {.resolution = kSanitized ? 9 : 30});
  for (const RefineMethod method : {RefineMethod::Document, RefineMethod::Ends, RefineMethod::Clusters}) {
    SCOPED_TRACE(nameOf(method));
    const RefinedModel cpu = refine({document, history}, {zone, families}, {.method = method}),
                       card = refine({document, history}, {zone, families},
                                     {.method = method, .replayer = GlLineReplay(gl())});
    EXPECT_EQ(card.ids, cpu.ids);
    ASSERT_EQ(card.families.size(), cpu.families.size());
    for (std::size_t i = 0; i < cpu.families.size(); ++i) {
      expectSameBits(card.families[i].dexels, cpu.families[i].dexels);
      EXPECT_GT(cpu.families[i].dexels.endCount(), 100u);
    }
  }
}

}  // namespace
}  // namespace restroke::points
