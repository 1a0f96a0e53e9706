#pragma once
// The allocator's own figure of what this program holds through operator new.

#include <cstddef>

namespace restroke::experiments {

/// Bytes usable in all blocks that are held now (malloc_usable_size), whichever thread asked for them. Blocks
/// are rounded up by the allocator; its headers are not counted.
[[nodiscard]] std::size_t bytesAllocated();
/// Their number.
[[nodiscard]] std::size_t blocksAllocated();

}  // namespace restroke::experiments
