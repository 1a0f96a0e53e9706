// Replaces operator new and delete of the whole test program with ones that ask the allocator what it gave.
// mallinfo2 would not do: freed blocks that wait in the allocator's caches are still in use for it.

#include "tests/experiments/counted_allocation.h"

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::size_t> bytes{0};
std::atomic<std::size_t> blocks{0};

#if RESTROKE_COUNTS_ALLOCATION
void* counted(void* block) {
  if (block == nullptr) throw std::bad_alloc();
  bytes += malloc_usable_size(block);
  ++blocks;
  return block;
}

void release(void* block) noexcept {
  if (block == nullptr) return;
  bytes -= malloc_usable_size(block);
  --blocks;
  std::free(block);
}

std::size_t roundedUp(std::size_t size, std::size_t alignment) {
  return (size + alignment - 1) / alignment * alignment;
}
#endif

}  // namespace

#if RESTROKE_COUNTS_ALLOCATION
void* operator new(std::size_t size) {
  return counted(std::malloc(size == 0 ? 1 : size));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto a = static_cast<std::size_t>(alignment);
  return counted(std::aligned_alloc(a, roundedUp(size == 0 ? 1 : size, a)));
}
void operator delete(void* block) noexcept {
  release(block);
}
void operator delete(void* block, std::size_t) noexcept {
  release(block);
}
void operator delete(void* block, std::align_val_t) noexcept {
  release(block);
}
void operator delete(void* block, std::size_t, std::align_val_t) noexcept {
  release(block);
}
#endif

namespace restroke::experiments {

std::size_t bytesAllocated() {
  return bytes;
}
std::size_t blocksAllocated() {
  return blocks;
}

}  // namespace restroke::experiments
