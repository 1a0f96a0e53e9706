#include "implicit/clusters.h"

#include <algorithm>

#include "implicit/errors.h"

namespace restroke::implicit {

namespace {

std::size_t hashOf(Cell c) {
  std::uint64_t h = static_cast<std::uint32_t>(c.x) * 0x9E3779B97F4A7C15ull;
  h = (h ^ (h >> 32) ^ static_cast<std::uint32_t>(c.y)) * 0xD6E8FEB86659FD93ull;
  h = (h ^ (h >> 32) ^ static_cast<std::uint32_t>(c.z)) * 0xA0761D6478BD642Full;
  return static_cast<std::size_t>(h ^ (h >> 32));
}

std::int32_t indexAlong(double x, double cell) {
  // Clamped, which keeps the order of cells, and with it every list complete, even where an index would not
  // fit.
  const double i = x / cell;
  if (i < -2e9) return -2'000'000'000;
  if (i > 2e9) return 2'000'000'000;
  const auto whole = static_cast<std::int32_t>(i);
  return whole - (i < whole);  // floor, without a call to the library
}

}  // namespace

Cell ClusterGrid::cellAt(DVec3 p) const {
  const double cell = static_cast<double>(cell_);
  return {indexAlong(p.x, cell), indexAlong(p.y, cell), indexAlong(p.z, cell)};
}

std::size_t ClusterGrid::find(Cell c) const {
  const std::size_t mask = entries_.size() - 1;
  std::size_t i = hashOf(c) & mask;
  while (entries_[i].used && entries_[i].cell != c) i = (i + 1) & mask;
  return i;
}

std::span<const std::uint32_t> ClusterGrid::at(Cell c) const {
  if (entries_.empty()) return {};
  const Entry& e = entries_[find(c)];
  return e.used ? std::span<const std::uint32_t>(e.slots) : std::span<const std::uint32_t>();
}

void ClusterGrid::grow() {
  std::vector<Entry> old(entries_.empty() ? 64 : entries_.size() * 2);
  old.swap(entries_);
  for (Entry& e : old)
    if (e.used) entries_[find(e.cell)] = std::move(e);
}

std::vector<std::uint32_t>& ClusterGrid::listFor(Cell c) {
  if (2 * (usedEntries_ + 1) > entries_.size()) grow();
  Entry& e = entries_[find(c)];
  if (!e.used) {
    e.used = true;
    e.cell = c;
    ++usedEntries_;
  }
  return e.slots;
}

namespace {

// The cells of a box, a little widened: a ray that runs along a cell's face finds the primitive on either
// side of it.
template <class F>
void forCells(const ClusterGrid& grid, const Box& box, const F& f) {
  const DVec3 pad(1e-4 * static_cast<double>(grid.cell()));
  const Cell lo = grid.cellAt(DVec3(box.min) - pad), hi = grid.cellAt(DVec3(box.max) + pad);
  for (std::int32_t z = lo.z; z <= hi.z; ++z)
    for (std::int32_t y = lo.y; y <= hi.y; ++y)
      for (std::int32_t x = lo.x; x <= hi.x; ++x) f(Cell{x, y, z});
}

auto placeOf(const std::vector<std::uint32_t>& list, std::uint32_t slot, ClusterGrid::Labels labels) {
  const std::uint64_t label = labels[slot];
  if (!list.empty() && labels[list.back()] < label) return list.end();
  return std::lower_bound(list.begin(), list.end(), label,
                          [&](std::uint32_t s, std::uint64_t l) { return labels[s] < l; });
}

}  // namespace

void ClusterGrid::insert(std::uint32_t slot, const Box& box, Labels labels) {
  if (size_++ == 0) hull_ = Box{};
  hull_.add(box);
  forCells(*this, box, [&](Cell c) {
    std::vector<std::uint32_t>& list = listFor(c);
    list.insert(placeOf(list, slot, labels), slot);
  });
}

void ClusterGrid::remove(std::uint32_t slot, const Box& box, Labels labels) {
  --size_;
  forCells(*this, box, [&](Cell c) {
    std::vector<std::uint32_t>& list = entries_[find(c)].slots;
    const auto place = placeOf(list, slot, labels);
    RESTROKE_CHECK_EQ(place != list.end() && *place == slot, true);
    list.erase(place);
  });
}

std::size_t ClusterGrid::bytes() const {
  std::size_t bytes = entries_.capacity() * sizeof(Entry);
  for (const Entry& e : entries_) bytes += e.slots.capacity() * sizeof(std::uint32_t);
  return bytes;
}

Clusters::Clusters(ClusterOptions options) {
  if (!(std::isfinite(options.cell) && options.cell > 0))
    throw InputError(
        fmt::format("the cluster size is {}; it must be finite and greater than 0", options.cell));
  float cell = options.cell;
  for (int i = 0; i < kFinerGrids; ++i) cell /= kGridRatio;
  for (int i = 0; i < kGrids; ++i, cell *= kGridRatio) grids_.emplace_back(cell);
}

ClusterGrid& Clusters::gridFor(const Box& box) {
  const Vec3 size = box.max - box.min;
  const float span = std::fmax(size.x, std::fmax(size.y, size.z));
  for (std::size_t i = 0; i < kFinerGrids; ++i)
    if (span <= grids_[i].cell()) return grids_[i];
  for (std::size_t i = kFinerGrids; i < grids_.size(); ++i)
    if (span <= kMaxSpan * grids_[i].cell()) return grids_[i];
  return grids_.back();
}

std::size_t Clusters::finestInUse() const {
  for (std::size_t i = 0; i < grids_.size(); ++i)
    if (grids_[i].size() > 0) return i;
  return kFinerGrids;
}

std::size_t Clusters::bytes() const {
  std::size_t bytes = grids_.capacity() * sizeof(ClusterGrid);
  for (const ClusterGrid& grid : grids_) bytes += grid.bytes();
  return bytes;
}

}  // namespace restroke::implicit
