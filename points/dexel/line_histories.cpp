#include "points/dexel/line_histories.h"

#include <algorithm>
#include <utility>

namespace restroke::points {

LineHistories::LineHistories(int width, int height)
    : width_(static_cast<std::size_t>(width)),
      kept_(true),
      last_(width_ * static_cast<std::size_t>(height), kNone),
      rows_(static_cast<std::size_t>(height)) {}

void LineHistories::note(std::size_t line, OperationId id) {
  if (id == OperationId::Initial || id == OperationId::None) return;
  std::vector<Entry>& pool = rows_[line / width_];
  std::uint32_t* place = &last_[line];
  while (*place != kNone && pool[*place].id > id) place = &pool[*place].before;
  if (*place != kNone && pool[*place].id == id) return;
  const auto entry = static_cast<std::uint32_t>(pool.size());
  const Entry fresh{id, std::exchange(*place, entry)};
  // By a quarter: there are many rows, and what each keeps for later adds up. The place was written before,
  // as the pool moves.
  if (pool.size() == pool.capacity()) pool.reserve(std::max<std::size_t>(4, pool.size() + pool.size() / 4));
  pool.push_back(fresh);
}

void LineHistories::appendOf(std::size_t line, std::vector<OperationId>& ids) const {
  const auto first = static_cast<std::ptrdiff_t>(ids.size());
  const std::vector<Entry>& pool = rows_[line / width_];
  for (std::uint32_t at = last_[line]; at != kNone; at = pool[at].before) ids.push_back(pool[at].id);
  std::reverse(ids.begin() + first, ids.end());
}

std::size_t LineHistories::entryCount() const {
  std::size_t count = 0;
  for (const std::vector<Entry>& pool : rows_) count += pool.size();
  return count;
}

std::size_t LineHistories::bytes() const {
  std::size_t bytes =
      last_.capacity() * sizeof(std::uint32_t) + rows_.capacity() * sizeof(std::vector<Entry>);
  for (const std::vector<Entry>& pool : rows_) bytes += pool.capacity() * sizeof(Entry);
  return bytes;
}

void LineHistories::takeOver(LineHistories&& others, int column, int row) {
  LineHistories old = std::move(others);
  for (std::size_t r = 0; r < old.rows_.size(); ++r) {
    const std::size_t at = static_cast<std::size_t>(row) + r;
    std::copy_n(old.last_.begin() + static_cast<std::ptrdiff_t>(r * old.width_), old.width_,
                last_.begin() + static_cast<std::ptrdiff_t>(at * width_) + column);
    rows_[at] = std::move(old.rows_[r]);
  }
}

}  // namespace restroke::points
