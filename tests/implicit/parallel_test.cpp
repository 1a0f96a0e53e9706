// How many threads there come to be.

#include "implicit/parallel.h"

#include <gtest/gtest.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <filesystem>
#include <iterator>
#include <thread>
#include <vector>

namespace restroke {
namespace {

std::size_t threadsNow() {
  using std::filesystem::directory_iterator;
  return static_cast<std::size_t>(std::distance(directory_iterator("/proc/self/task"), directory_iterator()));
}

TEST(Parallel, ManyShortCallsAtOnceStartNoMoreThreadsThanWereAskedFor) {
  if (!std::filesystem::exists("/proc/self/task")) GTEST_SKIP() << "no /proc here: threads cannot be counted";
  constexpr std::size_t kCallers = 4;
  std::atomic<int> sum{0};
  std::atomic<std::size_t> most{0};
  std::vector<std::thread> callers;
  for (std::size_t k = 0; k < kCallers; ++k)
    callers.emplace_back([&] {
      for (int i = 0; i < 400; ++i) {
        inArena({.threads = 3}, [&] { tbb::parallel_for(0, 64, [&](int j) { sum += j % 2; }); });
        if (i % 20 == 0) most = std::max(most.load(), threadsNow());
      }
    });
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(sum, static_cast<int>(kCallers) * 400 * 32);
  // The callers, oneTBB's own, and those that sanitizers keep.
  const auto own = static_cast<std::size_t>(std::max(3, tbb::info::default_concurrency()));
  EXPECT_LE(most, kCallers + own + 3);
}

TEST(Parallel, AsManyThreadsTakePartAsAreAskedFor) {
  for (const int threads : {1, 5, 2}) {
    int slots = 0;
    inArena({.threads = threads}, [&] { slots = tbb::this_task_arena::max_concurrency(); });
    EXPECT_EQ(slots, threads);
  }
}

}  // namespace
}  // namespace restroke
