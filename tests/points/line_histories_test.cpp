// Lines that keep every operation that changed them (SPEC R2b): against looking at every line after every
// operation.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "implicit/errors.h"
#include "points/dexel/dexel_tool.h"
#include "points/dexel/mesh_dexels.h"
#include "tests/points/dexel_gl_support.h"
#include "tests/support/effort.h"
#include "tests/support/meshes.h"
#include "tests/support/random_volumes.h"

namespace restroke::points {
namespace {

using implicit::Primitive;
using implicit::Sign;
using restroke::testing::ballMesh;
using restroke::testing::kSanitized;
using restroke::testing::Random;

// Of each family, of each line: what changed it.
using Histories = std::array<std::vector<std::vector<OperationId>>, 3>;

Histories historiesOf(const TriDexel& model) {
  Histories out;
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t line = 0; line < model.family(axis).lineCount(); ++line)
      model.family(axis).changesOf(line, out[static_cast<std::size_t>(axis)].emplace_back());
  return out;
}

// By the definition: a line whose ends are others than before was changed.
class Watched {
 public:
  explicit Watched(const TriDexel& model) : before_(model) {
    for (int axis = 0; axis < 3; ++axis)
      histories_[static_cast<std::size_t>(axis)].resize(model.family(axis).lineCount());
  }
  void look(const TriDexel& model, OperationId id) {
    LineEnds old, now;
    for (int axis = 0; axis < 3; ++axis)
      for (std::size_t line = 0; line < model.family(axis).lineCount(); ++line) {
        before_.family(axis).read(line, old);
        model.family(axis).read(line, now);
        if (old != now) histories_[static_cast<std::size_t>(axis)][line].push_back(id);
      }
    before_ = model;
  }
  [[nodiscard]] const Histories& histories() const { return histories_; }

 private:
  TriDexel before_;
  Histories histories_;
};

DexelGrid gridOf(int resolution) {
  return dexelGridFor({Point(-1.3f), Point(1.3f)}, {.resolution = resolution});
}

std::vector<Primitive> randomList(std::uint64_t seed, std::size_t count) {
  Random random(seed);
  std::vector<Primitive> list = {{{{0, 0, 0}, 1.0f}, Sign::Positive}};
  while (list.size() < count) list.push_back(restroke::testing::randomMixedPrimitive(random, list));
  return list;
}

TEST(LineHistories, R2bHoldWhateverChangedALineAndNothingElse) {
  const std::vector<Primitive> list = randomList(11, kSanitized ? 40 : 250);
  const DexelGrid grid = gridOf(30);
  for (const bool keepsOperations : {true, false}) {
    TriDexel model(grid, {.operations = keepsOperations, .history = true});
    Watched watched(model);
    for (std::size_t i = 0; i < list.size(); ++i) {
      const auto id = static_cast<OperationId>(i + 1);
      model.apply({&list[i], 1}, id);
      watched.look(model, id);
    }
    EXPECT_EQ(historiesOf(model), watched.histories());
    for (const int threads : {1, 2, 8}) {
      TriDexel again(grid, {.operations = keepsOperations, .history = true});
      again.apply(list, OperationId{1}, {.threads = threads});
      EXPECT_EQ(historiesOf(again), watched.histories()) << threads << " threads";
      EXPECT_EQ(again, model);
    }
  }
}

TEST(LineHistories, R2bNoteMeshToolsOtherModelsAndIntersections) {
  const TriangleMesh workpiece = ballMesh(3), mesh = ballMesh(1);
  const DexelTool tool(mesh);
  TriDexel model = triDexelOf(workpiece, gridOf(24));
  EXPECT_FALSE(model.keepsHistory());
  model.startHistory();
  Watched watched(model);
  Random random(3);
  std::uint32_t id = 0;
  for (int round = 0; round < 12; ++round) {
    const Point at = random.inCube(0.9f);
    const double size = round % 3 == 2 ? 2 : 0.4;
    const PoseMatrix pose{size, 0, 0,    static_cast<double>(at.x) / 4, 0, size, 0, static_cast<double>(at.y),
                          0,    0, size, static_cast<double>(at.z) / 2, 0, 0,    0, 1};
    const auto operation = static_cast<DexelOperation>(round % 3);
    const auto look = [&] { watched.look(model, static_cast<OperationId>(id)); };
    apply(model, tool, {pose, operation, static_cast<OperationId>(++id)});
    look();
    TriDexel other(model.grid());
    const Primitive primitive{{random.inCube(1), round % 3 == 2 ? 1.7f : 0.3f}, Sign::Positive};
    other.apply({&primitive, 1}, OperationId::Initial);
    model.apply(other, operation, static_cast<OperationId>(++id));
    look();
    if (round % 3 != 2) continue;
    model.intersect({random.inCube(0.2f), 1.1f}, static_cast<OperationId>(++id));
    look();
  }
  EXPECT_GT(model.historySize().entries, 1000u);
  EXPECT_EQ(historiesOf(model), watched.histories());
}

TEST(LineHistories, TheInitialSolidIsNotNoted) {
  const Primitive ball{{{0, 0, 0}, 1.0f}, Sign::Positive};
  TriDexel model(gridOf(10), {.history = true});
  model.apply({&ball, 1}, OperationId::Initial);
  EXPECT_EQ(model.historySize().entries, 0u);
  model.startHistory();
  EXPECT_EQ(model.historySize().entries, 0u);
  EXPECT_TRUE(model.keepsHistory());
}

TEST(LineHistories, MoveAlongWhenTheGridGrows) {
  TriDexel model(gridOf(16), {.history = true});
  const std::vector<Primitive> list = randomList(4, 40);
  model.apply(list, OperationId{1});
  const TriDexel before = model;
  model.growTo({{-2.5f, -1, -1.9f}, {1, 3, 2.2f}});
  ASSERT_GT(model.grid().lineCount(), before.grid().lineCount());
  const DexelGrid::Parts small = before.grid().parts(), large = model.grid().parts();
  std::vector<OperationId> own, expected;
  for (int axis = 0; axis < 3; ++axis) {
    const Dexels& dexels = model.family(axis);
    const auto u = static_cast<std::size_t>((axis + 1) % 3), v = static_cast<std::size_t>((axis + 2) % 3);
    for (int row = 0; row < dexels.height(); ++row)
      for (int column = 0; column < dexels.width(); ++column) {
        own.clear();
        expected.clear();
        dexels.changesOf(dexels.lineAt(column, row), own);
        const int c = column + large.first[u] - small.first[u], r = row + large.first[v] - small.first[v];
        const Dexels& old = before.family(axis);
        if (c >= 0 && r >= 0 && c < old.width() && r < old.height())
          old.changesOf(old.lineAt(c, r), expected);
        ASSERT_EQ(own, expected) << axis << ": " << column << ", " << row;
      }
  }
  EXPECT_EQ(model.historySize().entries, before.historySize().entries);
  // And go on.
  const Primitive beside{{{-2.2f, 0, 0}, 0.3f}, Sign::Positive};
  model.apply({&beside, 1}, OperationId{100});
  EXPECT_GT(model.historySize().entries, before.historySize().entries);
}

TEST(LineHistories, AreAscendingWithoutRepetitionsWhateverTheOrderOfNotes) {
  Random random(9);
  Dexels dexels(5, 4, {.history = true});
  std::vector<std::set<OperationId>> expected(dexels.lineCount());
  for (int i = 0; i < 5000; ++i) {
    const std::size_t line = random.below(expected.size());
    const auto id = static_cast<OperationId>(random.below(60));
    dexels.noteChange(line, id);
    if (id != OperationId::Initial) expected[line].insert(id);
  }
  dexels.noteChange(0, OperationId::None);
  std::size_t entries = 0;
  for (std::size_t line = 0; line < expected.size(); ++line) {
    std::vector<OperationId> ids = {OperationId{7}};
    dexels.changesOf(line, ids);
    EXPECT_EQ(ids.front(), OperationId{7}) << "what was there stays";
    EXPECT_TRUE(std::equal(ids.begin() + 1, ids.end(), expected[line].begin(), expected[line].end())) << line;
    entries += expected[line].size();
  }
  EXPECT_EQ(dexels.histories().entryCount(), entries);
}

TEST(LineHistories, AreCountedAndChangeNeitherEndsNorHashes) {
  const std::vector<Primitive> list = randomList(5, 60);
  TriDexel with(gridOf(24), {.history = true}), without(gridOf(24));
  with.apply(list, OperationId::Initial);
  without.apply(list, OperationId::Initial);
  EXPECT_EQ(with, without);
  EXPECT_EQ(with.stateHash(), without.stateHash());
  EXPECT_GE(with.historySize().bytes, 4 * with.grid().lineCount() + 8 * with.historySize().entries);
  EXPECT_EQ(with.bytes(), without.bytes() + with.historySize().bytes);
  EXPECT_EQ(without.historySize().entries + without.historySize().bytes, 0u);
  EXPECT_EQ(Dexels(0, 0, {.history = true}).histories().entryCount(), 0u);
}

TEST(LineHistories, AListsModelCanKeepThem) {
  const std::vector<Primitive> list = randomList(6, 50);
  implicit::PrimitiveList primitives;
  for (const Primitive& primitive : list) primitives.append(primitive);
  TriDexel expected(gridOf(20), {.history = true});
  expected.apply(list, OperationId::Initial);
  const TriDexel model = triDexelOf(primitives, gridOf(20), {.lines = {.history = true}});
  EXPECT_EQ(historiesOf(model), historiesOf(expected));
  EXPECT_FALSE(triDexelOf(primitives, gridOf(20), {.prefix = {10}}).keepsHistory());
}

using LineHistoriesOnACard = testing::GlDexelTest;

TEST_F(LineHistoriesOnACard, AreRefusedAsNothingWouldNoteThem) {
  TriDexel model(gridOf(8), {.history = true});
  GlTriDexel there(gl(), model.grid());
  try {
    there.upload(model);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("must be changed on the CPU"), std::string::npos);
  }
}

}  // namespace
}  // namespace restroke::points
