#include "implicit/volume.h"

#include "implicit/clearance_grid.h"

namespace restroke::implicit {

void Volume::countAsked(std::uint32_t points) const {
  // Threads may lose each other's counts: the grid comes a little later then.
  const std::uint32_t asked = asked_.load(std::memory_order_relaxed) + points;
  asked_.store(asked, std::memory_order_relaxed);
  if (asked < kMostGridCells) return;
  const std::lock_guard lock(mutex_);
  if (!sidesOfCells_.empty()) return;
  sidesOfCells_ = implicit::sidesOfCells(*this);
  __atomic_store_n(&cells_, sidesOfCells_.data(), __ATOMIC_RELEASE);
}

const SampleTable& Volume::samples(std::uint32_t count) const {
  const std::lock_guard lock(mutex_);
  for (const auto& [known, table] : tables_)
    if (known == count) return *table;
  tables_.emplace_back(count, std::make_unique<SampleTable>(makeSamples(count)));
  return *tables_.back().second;
}

std::size_t Volume::bytes() const {
  const std::lock_guard lock(mutex_);
  std::size_t bytes =
      sizeof(*this) + ownBytes() + bytesOf(parameters_) + sidesOfCells_.capacity() + tables_.capacity() * sizeof(tables_.front());
  for (const auto& [count, table] : tables_) bytes += table->bytes();
  return bytes;
}

}  // namespace restroke::implicit
