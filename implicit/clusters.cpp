#include "implicit/clusters.h"

#include <algorithm>

#include "implicit/errors.h"

namespace restroke::implicit {

void ClusterGrid::grow() {
  std::vector<Entry> old(entries_.empty() ? 64 : entries_.size() * 2);
  old.swap(entries_);
  for (const Entry& e : old)
    if (e.list != Lists::kNone) entries_[find(e.cell)] = e;
}

ClusterGrid::Entry& ClusterGrid::entryFor(Cell c) {
  if (2 * (usedEntries_ + 1) > entries_.size()) grow();
  Entry& e = entries_[find(c)];
  if (e.list == Lists::kNone) {
    e.cell = c;
    e.list = lists_->take(1);
    ++usedEntries_;
  }
  return e;
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

// Where in the list the slot is, or belongs.
std::uint32_t placeOf(std::span<const std::uint32_t> list, std::uint32_t slot,
                      std::span<const std::uint64_t> labels) {
  const std::uint64_t label = labels[slot];
  const auto count = static_cast<std::uint32_t>(list.size());
  if (list.empty() || labels[list.back()] < label) return count;
  const auto place = std::lower_bound(list.begin(), list.end(), label,
                                      [&](std::uint32_t s, std::uint64_t l) { return labels[s] < l; });
  return static_cast<std::uint32_t>(place - list.begin());
}

// A list this long is cut (CrowdedCell); one of half the length need not be any more. Shorter lists are
// looked through, 8 balls at a time, faster than leaves are found.
constexpr std::uint32_t kCrowd = 512;

}  // namespace

void ClusterGrid::insert(std::uint32_t slot, const Box& box, const ClusterMembers& members) {
  if (size_++ == 0) hull_ = Box{};
  hull_.add(box);
  forCells(*this, box, [&](Cell c) { putIn(entryFor(c), slot, members); });
}

void ClusterGrid::remove(std::uint32_t slot, const Box& box, const ClusterMembers& members) {
  --size_;
  forCells(*this, box, [&](Cell c) { takeFrom(entries_[find(c)], slot, members); });
}

void ClusterGrid::putIn(Entry& e, std::uint32_t slot, const ClusterMembers& members) {
  const std::uint32_t place = placeOf(listOf(e), slot, members.labels);
  if (e.count != 0 && Lists::capacityFor(e.count) == e.count) {
    const Lists::Handle larger = lists_->take(e.count + 1);
    std::copy_n(lists_->at(e.list), e.count, lists_->at(larger));
    lists_->giveBack(e.list, e.count);
    e.list = larger;
  }
  std::uint32_t* list = lists_->at(e.list);
  std::copy_backward(list + place, list + e.count, list + e.count + 1);
  list[place] = slot;
  ++e.count;
  if (e.crowd != kNoCrowd)
    crowds_[e.crowd]->insert(slot, members);
  else if (e.count >= kCrowd)
    makeCrowd(e, members);
}

void ClusterGrid::takeFrom(Entry& e, std::uint32_t slot, const ClusterMembers& members) {
  const std::uint32_t place = placeOf(listOf(e), slot, members.labels);
  std::uint32_t* list = lists_->at(e.list);
  RESTROKE_CHECK_EQ(place < e.count && list[place] == slot, true);
  std::copy(list + place + 1, list + e.count, list + place);
  --e.count;
  // The room stays that of the ladder's step, so that it need not be kept.
  if (e.count != 0 && Lists::capacityFor(e.count) == e.count) {
    const Lists::Handle smaller = lists_->take(e.count);
    std::copy_n(list, e.count, lists_->at(smaller));
    lists_->giveBack(e.list, e.count + 1);
    e.list = smaller;
  }
  if (e.crowd == kNoCrowd) return;
  if (e.count > kCrowd / 2) {
    crowds_[e.crowd]->remove(slot, listOf(e), members);
  } else {
    crowds_[e.crowd].reset();
    freeCrowds_.push_back(e.crowd);
    e.crowd = kNoCrowd;
  }
}

void ClusterGrid::makeCrowd(Entry& e, const ClusterMembers& members) {
  if (freeCrowds_.empty()) {
    freeCrowds_.push_back(static_cast<std::uint32_t>(crowds_.size()));
    crowds_.emplace_back();
  }
  e.crowd = freeCrowds_.back();
  freeCrowds_.pop_back();
  const DVec3 low(e.cell.x, e.cell.y, e.cell.z);
  const double size = static_cast<double>(cell_);
  const Box box{Point(low * size), Point((low + DVec3(1)) * size)};
  crowds_[e.crowd] = std::make_unique<CrowdedCell>(box, listOf(e), members);
}

std::size_t ClusterGrid::bytes() const {
  std::size_t bytes = entries_.capacity() * sizeof(Entry) + crowds_.capacity() * sizeof(crowds_[0]) +
                      freeCrowds_.capacity() * sizeof(std::uint32_t);
  for (const auto& crowd : crowds_)
    if (crowd) bytes += crowd->bytes();
  return bytes;
}

Clusters::Clusters(ClusterOptions options) : lists_(std::make_unique<ClusterGrid::Lists>()) {
  if (!(std::isfinite(options.cell) && options.cell > 0))
    throw InputError(
        fmt::format("the cluster size is {}; it must be finite and greater than 0", options.cell));
  float cell = options.cell;
  for (int i = 0; i < kFinerGrids; ++i) cell /= kGridRatio;
  for (int i = 0; i < kGrids; ++i, cell *= kGridRatio) grids_.emplace_back(cell, *lists_);
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

bool Clusters::crowded() const {
  return std::any_of(grids_.begin(), grids_.end(), [](const ClusterGrid& grid) { return grid.crowded(); });
}

std::size_t Clusters::bytes() const {
  std::size_t bytes = grids_.capacity() * sizeof(ClusterGrid) + sizeof(*lists_) + lists_->bytes();
  for (const ClusterGrid& grid : grids_) bytes += grid.bytes();
  return bytes;
}

}  // namespace restroke::implicit
