// DESIGN invariant 11: bytes counted from capacities, against the allocator's own figure.

#include <gtest/gtest.h>

#include "experiments/backends/history_backend.h"
#include "experiments/examples/example_logs.h"
#include "sculpt/document.h"
#include "tests/experiments/counted_allocation.h"

namespace restroke::experiments {
namespace {

// glibc rounds a block up to 16 bytes and lends the 8 of the next header: 24 bytes at most, for a block of
// one byte. A sanitizer's allocator gives what was asked for.
constexpr std::size_t kRounding = 24;

struct Given {
  std::size_t bytes = bytesAllocated();
  std::size_t blocks = blocksAllocated();
};

/// Holds when what was given out since `before` is `counted`, up to the rounding of its blocks and `beside`
/// bytes more.
void expectCounts(const Given& before, std::size_t counted, std::size_t beside) {
  const Given now;
  const std::size_t given = now.bytes - before.bytes;
  EXPECT_GE(given, counted) << "counts more than there is";
  EXPECT_LE(given, counted + beside + kRounding * (now.blocks - before.blocks)) << "forgets something";
}

struct State {
  std::vector<implicit::Primitive> list;
  std::vector<points::Surfel> surfels;
};

State stateOf(const sculpt::Document& document) {
  State state;
  for (std::size_t i = 0; i < document.model().list().size(); ++i)
    state.list.push_back(document.model().list().at(i));
  state.surfels = document.model().surfels();
  return state;
}

TEST(ModelBytes, AreWhatTheAllocatorGaveOut) {
  if (!kCountsAllocation) GTEST_SKIP() << "built with a sanitizer, whose allocator is not asked";
  sculpt::StrokeLog log = table2Log();
  log.header.density = 2000;
  sculpt::Document document(log.header);
  for (const sculpt::Command& command : log.commands) document.apply(command);
  const std::vector<implicit::Primitive> list = stateOf(document).list;
  // The document has made the tables of directions, which all models share. The model's object itself is on
  // the stack.
  const Given before;
  points::SurfelModel model(document.model().sampling(), sculpt::clustersFor(log.header));
  model.append(list);
  expectCounts(before, model.bytes().total(), 0);
  model.remove(200, 150, {.threads = 1});
  expectCounts(before, model.bytes().total(), 0);
  model.append(std::span(list).subspan(200, 150));
  expectCounts(before, model.bytes().total(), 0);
}

class BackendBytes : public ::testing::TestWithParam<BackendKind> {};

INSTANTIATE_TEST_SUITE_P(Shapes, BackendBytes,
                         ::testing::Values(BackendKind::ListSnapshots, BackendKind::SurfelSnapshots,
                                           BackendKind::SurfelDeltas, BackendKind::SurfelDeltasZstd,
                                           BackendKind::DexelDeltas));

TEST_P(BackendBytes, AreWhatTheAllocatorGaveOut) {
  if (!kCountsAllocation) GTEST_SKIP() << "built with a sanitizer, whose allocator is not asked";
  sculpt::StrokeLog log = table2Log();
  log.header.density = 2000;
  sculpt::Document document(log.header);
  std::vector<State> states = {stateOf(document)};
  for (const sculpt::Command& command : log.commands) {
    document.apply(command);
    states.push_back(stateOf(document));
  }
  // The back end's object itself: a few pointers and numbers.
  constexpr std::size_t kObject = 160;
  const Given before;
  const auto backend = makeBackend(GetParam(), {.header = log.header,
                                                .list = states[0].list,
                                                .surfels = states[0].surfels,
                                                .execution = {.threads = 1}});
  for (std::size_t i = 0; i < log.commands.size(); ++i) {
    SCOPED_TRACE("step " + std::to_string(i + 1));
    backend->apply(
        {.command = log.commands[i], .list = states[i + 1].list, .surfels = states[i + 1].surfels});
    expectCounts(before, backend->bytes() + backend->stateBytes(), kObject);
  }
  while (backend->canUndo()) backend->undo();
  expectCounts(before, backend->bytes() + backend->stateBytes(), kObject);
}

TEST(HistoryBytes, OfStrokesAreWhatTheAllocatorGaveOut) {
  if (!kCountsAllocation) GTEST_SKIP() << "built with a sanitizer, whose allocator is not asked";
  for (const sculpt::StrokeLog& log : {table2Log(), rabbitLog()}) {
    const Given before;
    sculpt::History history;
    for (const sculpt::Command& command : log.commands) {
      history.add(command);
      expectCounts(before, history.bytes(), 0);
    }
  }
}

TEST(HistoryBytes, OfTheStrokesBackEndAreThoseOfTheHistoryAlone) {
  const sculpt::StrokeLog log = rabbitLog();
  const sculpt::Document document(log.header);
  const State start = stateOf(document);
  const auto backend =
      makeBackend(BackendKind::Strokes,
                  {.header = log.header, .list = start.list, .surfels = start.surfels, .execution = {}});
  sculpt::History history;
  for (const sculpt::Command& command : log.commands) {
    history.add(command);
    backend->apply({.command = command, .list = {}, .surfels = {}});
    EXPECT_EQ(backend->bytes(), history.bytes());
  }
}

}  // namespace
}  // namespace restroke::experiments
