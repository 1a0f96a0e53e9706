#include "implicit/arena.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "tests/support/brute_force.h"

namespace restroke::implicit {
namespace {

TEST(Arena, CapacityIsAtMostAnEighthMoreThanWhatIsAskedFor) {
  for (std::uint32_t n = 1; n < 100000; ++n) {
    const std::uint32_t capacity = Arena<float>::capacityFor(n);
    ASSERT_GE(capacity, n);
    ASSERT_LE(capacity, n + std::max<std::uint32_t>(1, n / 8)) << n;
    ASSERT_EQ(Arena<float>::capacityFor(capacity), capacity) << n;
  }
}

TEST(Arena, ArraysNeverShareAPlaceAndKeepWhatIsInThem) {
  Arena<std::uint16_t> arena;
  testing::Random random(3);
  struct Array {
    std::uint32_t count;
    std::uint16_t mark;
  };
  std::map<std::uint32_t, Array> held;
  for (std::uint16_t step = 0; step < 4000; ++step) {
    if (random.below(3) == 0 && !held.empty()) {
      const auto any = std::next(held.begin(), static_cast<std::ptrdiff_t>(random.below(held.size())));
      for (std::uint32_t i = 0; i < any->second.count; ++i)
        ASSERT_EQ(arena.at(any->first)[i], any->second.mark);
      arena.giveBack(any->first, any->second.count);
      held.erase(any);
      continue;
    }
    const auto count = static_cast<std::uint32_t>(
        1 + (random.below(50) == 0 ? random.below(40000)
                                   : random.below(60)));  // longer than a block now and then
    const std::uint32_t handle = arena.take(count);
    ASSERT_FALSE(held.contains(handle));
    std::fill_n(arena.at(handle), count, step);
    held[handle] = {count, step};
  }
  for (const auto& [handle, array] : held)
    for (std::uint32_t i = 0; i < array.count; ++i) ASSERT_EQ(arena.at(handle)[i], array.mark);
}

TEST(Arena, UsesPlacesAgain) {
  Arena<std::uint32_t> arena;
  std::vector<std::uint32_t> handles;
  for (int i = 0; i < 1000; ++i) handles.push_back(arena.take(30));
  const std::size_t bytes = arena.bytes();
  for (const std::uint32_t handle : handles) arena.giveBack(handle, 30);
  for (int i = 0; i < 1000; ++i) (void)arena.take(29);  // of the same capacity
  EXPECT_LE(arena.bytes(), bytes + 1024 * sizeof(std::uint32_t) + 4096);
}

}  // namespace
}  // namespace restroke::implicit
