// Every history back end against the same demands (DESIGN invariant 10, SPEC S6): after any walk of apply,
// undo and redo the state equals the one that is built from scratch out of the strokes that lead to the
// cursor.

#include <gtest/gtest.h>

#include <map>

#include "experiments/backends/history_backend.h"
#include "experiments/random.h"
#include "implicit/errors.h"
#include "sculpt/document.h"

namespace restroke::experiments {
namespace {

sculpt::LogHeader smallHeader() {
  sculpt::LogHeader header;
  header.density = 150;
  return header;
}

std::vector<implicit::Primitive> listOf(const sculpt::Document& document) {
  std::vector<implicit::Primitive> list;
  for (std::size_t i = 0; i < document.model().list().size(); ++i)
    list.push_back(document.model().list().at(i));
  return list;
}

/// A short stroke across the base's front: some hit, some run over the edge, some miss altogether; some are
/// groups of fixed stamps.
sculpt::Command randomCommand(Random& random) {
  const auto mode = random.below(2) == 0 ? sculpt::Mode::Add : sculpt::Mode::Carve;
  if (random.below(6) == 0) {
    sculpt::FixedCommand fixed{.mode = mode, .stamps = {}};
    for (std::uint64_t i = 0; i <= random.below(3); ++i)
      fixed.stamps.push_back({.center = {static_cast<float>(random.between(-1, 1)),
                                         static_cast<float>(random.between(-1, 1)), 0.5f},
                              .radius = static_cast<float>(random.between(0.05, 0.3))});
    return fixed;
  }
  sculpt::StrokeCommand command;
  command.stroke.camera.position = {0, 0, 4};
  const auto x = static_cast<std::int32_t>(random.below(1280 * 16)),
             y = static_cast<std::int32_t>(random.below(720 * 16));
  const auto points = static_cast<std::int32_t>(1 + random.below(12));
  for (std::int32_t i = 0; i < points; ++i)
    command.stroke.points.push_back({{x + 160 * i, y + 40 * i * i}, static_cast<std::uint32_t>(8 * i), 700});
  command.brush.radius = 0.12f;
  command.brush.mode = mode;
  return command;
}

std::uint64_t shapeHash(const HistoryBackend& backend, const sculpt::Document& document) {
  const auto list = listOf(document);
  const auto surfels = document.model().surfels();
  return backend.hashOfShape({list, surfels});
}

/// The truth: for a path of commands, the hash of the state that a fresh document reaches.
class FromScratch {
 public:
  explicit FromScratch(const HistoryBackend& backend) : backend_(backend) {}
  std::uint64_t hashAfter(const std::vector<std::size_t>& path,
                          const std::vector<sculpt::Command>& commands) {
    const auto known = hashes_.find(path);
    if (known != hashes_.end()) return known->second;
    sculpt::Document document(smallHeader());
    for (const std::size_t i : path) document.apply(commands[i]);
    return hashes_[path] = shapeHash(backend_, document);
  }

 private:
  const HistoryBackend& backend_;
  std::map<std::vector<std::size_t>, std::uint64_t> hashes_;
};

std::unique_ptr<HistoryBackend> freshBackend(BackendKind kind) {
  const sculpt::LogHeader header = smallHeader();
  const sculpt::Document document(header);
  const auto list = listOf(document);
  const auto surfels = document.model().surfels();
  return makeBackend(kind, {.header = header, .list = list, .surfels = surfels, .execution = {}});
}

class HistoryBackends : public testing::TestWithParam<BackendKind> {};

INSTANTIATE_TEST_SUITE_P(All, HistoryBackends, testing::ValuesIn(kAllBackends), [](const auto& each) {
  std::string name;
  bool upper = true;
  for (const char c : freshBackend(each.param)->name()) {
    if (c != '-') name += upper ? static_cast<char>(c - 'a' + 'A') : c;
    upper = c == '-';
  }
  return name;
});

TEST_P(HistoryBackends, StartAtTheBaseWithNothingToUndoOrRedo) {
  const auto backend = freshBackend(GetParam());
  EXPECT_FALSE(backend->canUndo());
  EXPECT_FALSE(backend->canRedo());
  EXPECT_EQ(backend->stateHash(), shapeHash(*backend, sculpt::Document(smallHeader())));
}

TEST_P(HistoryBackends, RefuseToUndoAtTheStartAndToRedoWithNothingAhead) {
  const auto backend = freshBackend(GetParam());
  EXPECT_THROW(backend->undo(), InputError);
  EXPECT_THROW(backend->redo(), InputError);
  EXPECT_EQ(backend->stateHash(), shapeHash(*backend, sculpt::Document(smallHeader())))
      << "a refusal changed the state";
}

TEST_P(HistoryBackends, RestoreTheStateBuiltFromScratchAfterAnyWalk) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const auto backend = freshBackend(GetParam());
    sculpt::Document reference(smallHeader());
    FromScratch truth(*backend);
    std::vector<sculpt::Command> commands;
    std::vector<std::size_t> path;   // commands from the start to the cursor
    std::vector<std::size_t> ahead;  // those that redo brings back, the next one last
    int undone = 0, redone = 0, branched = 0;
    for (int i = 0; i < 120; ++i) {
      const std::uint64_t what = random.below(10);
      if (what < 3) {
        commands.push_back(randomCommand(random));
        reference.apply(commands.back());
        const auto list = listOf(reference);
        const auto surfels = reference.model().surfels();
        backend->apply({.command = commands.back(), .list = list, .surfels = surfels});
        path.push_back(commands.size() - 1);
        branched += ahead.empty() ? 0 : 1;
        ahead.clear();
      } else if (what < 6) {
        ASSERT_EQ(backend->canUndo(), !path.empty());
        if (path.empty()) continue;
        backend->undo();
        reference.apply(sculpt::UndoCommand{});
        ahead.push_back(path.back());
        path.pop_back();
        ++undone;
      } else {
        ASSERT_EQ(backend->canRedo(), !ahead.empty());
        if (ahead.empty()) continue;
        backend->redo();
        reference.apply(sculpt::RedoCommand{});
        path.push_back(ahead.back());
        ahead.pop_back();
        ++redone;
      }
      ASSERT_EQ(backend->stateHash(), truth.hashAfter(path, commands)) << "after operation " << i;
    }
    // A walk that never branched would show little.
    EXPECT_GT(undone, 5);
    EXPECT_GT(redone, 5);
    EXPECT_GT(branched, 1);
  }
}

TEST_P(HistoryBackends, HoldMoreBytesWithEveryStrokeThatChangesTheShapeAndNoneForUndo) {
  const auto backend = freshBackend(GetParam());
  sculpt::Document reference(smallHeader());
  Random random(7);
  for (int i = 0; i < 12; ++i) {
    sculpt::Command command = randomCommand(random);
    reference.apply(command);
    const auto list = listOf(reference);
    const auto surfels = reference.model().surfels();
    backend->apply({.command = command, .list = list, .surfels = surfels});
  }
  const std::size_t full = backend->bytes();
  EXPECT_GT(full, 0u);
  while (backend->canUndo()) backend->undo();
  EXPECT_LE(backend->bytes(), full);
  while (backend->canRedo()) backend->redo();
  EXPECT_LE(backend->bytes(), full);
}

TEST(HistoryBackendsTogether, HaveDifferentNames) {
  std::map<std::string_view, int> seen;
  for (const BackendKind kind : kAllBackends) {
    const auto backend = freshBackend(kind);
    ++seen[backend->name()];
    EXPECT_FALSE(backend->title().empty());
    EXPECT_TRUE(backend->abilities().undoInOrder);
  }
  EXPECT_EQ(seen.size(), std::size(kAllBackends));
}

TEST(HistoryBackendsTogether, OnlyStrokesKeepWhatLiesAheadWhenAStrokeIsDrawnAfterAnUndo) {
  for (const BackendKind kind : kAllBackends) {
    const auto backend = freshBackend(kind);
    EXPECT_EQ(backend->abilities().branch, kind == BackendKind::Strokes) << backend->name();
    EXPECT_EQ(backend->abilities().retarget, kind == BackendKind::Strokes) << backend->name();
  }
}

TEST(StrokesBackend, CannotRetargetStampsThatCameWithoutACamera) {
  const auto backend = freshBackend(BackendKind::Strokes);
  const sculpt::Command fixed =
      sculpt::FixedCommand{.mode = sculpt::Mode::Add, .stamps = {{.center = {0, 0, 1}, .radius = 0.1f}}};
  backend->apply({.command = fixed, .list = {}, .surfels = {}});
  EXPECT_FALSE(backend->abilities().retarget);
  EXPECT_TRUE(backend->abilities().branch);
}

}  // namespace
}  // namespace restroke::experiments
