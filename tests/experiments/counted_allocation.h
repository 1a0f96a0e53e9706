#pragma once
// The allocator's own figure of what this program holds through operator new.

#include <cstddef>

// A sanitizer brings operators of its own, which must not be replaced (clang's do not even link then).
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define RESTROKE_COUNTS_ALLOCATION 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define RESTROKE_COUNTS_ALLOCATION 0
#endif
#endif
#ifndef RESTROKE_COUNTS_ALLOCATION
#define RESTROKE_COUNTS_ALLOCATION 1
#endif

namespace restroke::experiments {

/// False in a sanitizer's build: the figures below are then 0.
inline constexpr bool kCountsAllocation = RESTROKE_COUNTS_ALLOCATION != 0;

/// Bytes usable in all blocks that are held now (malloc_usable_size), whichever thread asked for them. Blocks
/// are rounded up by the allocator; its headers are not counted.
[[nodiscard]] std::size_t bytesAllocated();
/// Their number.
[[nodiscard]] std::size_t blocksAllocated();

}  // namespace restroke::experiments
