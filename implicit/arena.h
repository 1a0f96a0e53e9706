#pragma once
// Memory for many short arrays: taken in blocks, named by 32-bit handles, used again when given back.

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace restroke::implicit {

/// Arrays of a plain type. An array holds its place until it is given back; its values are not initialised.
/// A place costs no bookkeeping of its own: who holds the handle knows the count.
template <class T>
class Arena {
 public:
  using Handle = std::uint32_t;
  static constexpr Handle kNone = ~Handle{0};

  /// Places that an array of `count` (1 or more) takes: the next of a ladder of 8 steps to the octave.
  static std::uint32_t capacityFor(std::uint32_t count) {
    if (count <= 2 * kSteps) return (count + 1) / 2 * 2;
    const std::uint32_t step = std::bit_floor(count - 1) / kSteps;
    return (count + step - 1) / step * step;
  }

  [[nodiscard]] Handle take(std::uint32_t count) {
    const std::uint32_t capacity = capacityFor(count);
    std::vector<Handle>& free = freeOf(capacity);
    if (!free.empty()) {
      const Handle handle = free.back();
      free.pop_back();
      return handle;
    }
    if (capacity > kBlock / 4) return newBlocks((capacity + kBlock - 1) / kBlock);
    if (next_ + capacity > kBlock) {
      current_ = newBlocks(1);
      next_ = 0;
    }
    const Handle handle = current_ + next_;
    next_ += capacity;
    return handle;
  }
  /// `count` as it was taken, or another of the same capacity.
  void giveBack(Handle handle, std::uint32_t count) { freeOf(capacityFor(count)).push_back(handle); }

  [[nodiscard]] T* at(Handle handle) { return starts_[handle / kBlock] + handle % kBlock; }
  [[nodiscard]] const T* at(Handle handle) const { return starts_[handle / kBlock] + handle % kBlock; }

  /// Bytes held, from the containers' real capacity.
  [[nodiscard]] std::size_t bytes() const {
    std::size_t bytes = starts_.size() * kBlock * sizeof(T) + starts_.capacity() * sizeof(T*) +
                        blocks_.capacity() * sizeof(blocks_[0]) + free_.capacity() * sizeof(free_[0]);
    for (const std::vector<Handle>& list : free_) bytes += list.capacity() * sizeof(Handle);
    return bytes;
  }

 private:
  static constexpr std::uint32_t kSteps = 8;
  static constexpr std::uint32_t kBlock = 16384;

  // Which class of the ladder a capacity is.
  [[nodiscard]] std::vector<Handle>& freeOf(std::uint32_t capacity) {
    std::size_t index = capacity / 2;
    if (capacity > 2 * kSteps) {
      const std::uint32_t octave = std::bit_floor(capacity - 1);
      index = kSteps * static_cast<std::size_t>(std::countr_zero(octave)) + capacity / (octave / kSteps);
    }
    if (free_.size() <= index) free_.resize(index + 1);
    return free_[index];
  }

  // One allocation for `count` neighbouring blocks.
  [[nodiscard]] Handle newBlocks(std::uint32_t count) {
    const auto first = static_cast<Handle>(starts_.size());
    blocks_.push_back(std::make_unique_for_overwrite<T[]>(std::size_t{count} * kBlock));
    for (std::uint32_t i = 0; i < count; ++i)
      starts_.push_back(blocks_.back().get() + std::size_t{i} * kBlock);
    return first * kBlock;
  }

  std::vector<std::unique_ptr<T[]>> blocks_;
  std::vector<T*> starts_;  // of each kBlock places
  std::vector<std::vector<Handle>> free_;
  Handle current_ = 0;
  std::uint32_t next_ = kBlock;  // places used of the current block
};

}  // namespace restroke::implicit
