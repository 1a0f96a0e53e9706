#pragma once
// Vectors that waste little: history is measured by what its buffers really hold (DESIGN invariant 11).

#include <algorithm>
#include <cstddef>
#include <vector>

namespace restroke::sculpt {

/// Doubling would leave half of a buffer unused; an eighth keeps appending linear and wastes little.
template <class T>
void makeRoom(std::vector<T>& buffer, std::size_t extra) {
  if (buffer.size() + extra > buffer.capacity())
    buffer.reserve(std::max(buffer.size() + extra, buffer.capacity() + buffer.capacity() / 8));
}

}  // namespace restroke::sculpt
