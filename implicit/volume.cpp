#include "implicit/volume.h"

#include <algorithm>
#include <array>

#include "implicit/clearance_grid.h"

namespace restroke::implicit {

namespace {

// The last tables that a thread has made for volumes that do not keep them. The youngest stands before
// `next`, around the ring.
struct RecentTables {
  struct Entry {
    std::uint64_t volume = 0;
    std::uint32_t count = 0;
    std::unique_ptr<const SampleTable> table;
  };
  std::array<Entry, kRecentSamples> ring;
  std::size_t next = 0;
};

}  // namespace

Volume::Volume(const VolumeKind& kind, VolumeParameters parameters)
    : kind_(kind), parameters_(std::move(parameters)) {
  static std::atomic<std::uint64_t> last{0};
  id_ = last.fetch_add(1, std::memory_order_relaxed) + 1;
}

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
  if (!keepsSamples()) {
    thread_local RecentTables recent;
    for (std::size_t back = 1; back <= kRecentSamples; ++back) {
      const RecentTables::Entry& entry = recent.ring[(recent.next - back) % kRecentSamples];
      if (entry.volume == id_ && entry.count == count) return *entry.table;
    }
    RecentTables::Entry& oldest = recent.ring[recent.next++ % kRecentSamples];
    oldest = {id_, count, std::make_unique<const SampleTable>(makeSamples(count))};
    return *oldest.table;
  }
  const std::lock_guard lock(mutex_);
  for (const auto& [known, table] : tables_)
    if (known == count) return *table;
  tables_.emplace_back(count, std::make_unique<SampleTable>(makeSamples(count)));
  return *tables_.back().second;
}

std::size_t Volume::bytes() const {
  const std::lock_guard lock(mutex_);
  std::size_t bytes = sizeof(*this) + ownBytes() + bytesOf(parameters_) + sidesOfCells_.capacity() +
                      tables_.capacity() * sizeof(tables_.front());
  for (const auto& [count, table] : tables_) bytes += table->bytes();
  return bytes;
}

}  // namespace restroke::implicit
