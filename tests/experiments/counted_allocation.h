#pragma once
// The allocator's own figure of what this program holds through operator new.

#include <cstddef>

#include "tests/support/effort.h"

// A sanitizer brings operators of its own, which must not be replaced (clang's do not even link then).
#define RESTROKE_COUNTS_ALLOCATION (!RESTROKE_SANITIZED)

namespace restroke::experiments {

/// False in a sanitizer's build: the figures below are then 0.
inline constexpr bool kCountsAllocation = RESTROKE_COUNTS_ALLOCATION;

/// Bytes usable in all blocks that are held now (malloc_usable_size), whichever thread asked for them. Blocks
/// are rounded up by the allocator; its headers are not counted.
[[nodiscard]] std::size_t bytesAllocated();
/// Their number.
[[nodiscard]] std::size_t blocksAllocated();

}  // namespace restroke::experiments
