#include "points/dexel/dexels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>

#include "implicit/errors.h"
#include "points/dexel/change_line.h"

namespace restroke::points {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

template <class T>
std::size_t bytesOf(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

std::uint32_t numberIn(OperationId id) {
  return static_cast<std::uint32_t>(id);
}

// Places hold powers of two.
std::size_t classOf(std::size_t room) {
  return static_cast<std::size_t>(std::bit_width(room - 1));
}

}  // namespace

Dexels::Dexels(int width, int height, Options options) : width_(width), height_(height) {
  RESTROKE_CHECK_EQ(width >= 0 && height >= 0, true);
  const std::size_t lines = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  enter_.assign(lines, kInfinity);
  exit_.assign(lines, -kInfinity);
  enterNormal_.assign(lines, 0);
  exitNormal_.assign(lines, 0);
  more_.assign(lines, kNoMore);
  if (options.operations)
    for (auto& of : operations_) of.assign(lines, OperationId::None);
  rows_.resize(static_cast<std::size_t>(height));
  if (options.history) startHistory();
}

std::span<const SpanEnd> Dexels::severalOf(std::size_t line) const {
  const SpanEnd* const head = &rows_[line / static_cast<std::size_t>(width_)].pool[more_[line]];
  return {head + 1, numberIn(head->inner)};
}

std::size_t Dexels::endCount(std::size_t line) const {
  return hasMore(line) ? severalOf(line).size() : isEmpty(line) ? 0 : 2;
}

SpanEnd Dexels::endOf(std::size_t line, bool exit) const {
  SpanEnd end{(exit ? exit_ : enter_)[line], (exit ? exitNormal_ : enterNormal_)[line]};
  if (keepsOperations()) {
    end.inner = operations_[exit ? 2 : 0][line];
    end.outer = operations_[exit ? 3 : 1][line];
  }
  return end;
}

void Dexels::setEnd(std::size_t line, bool exit, const SpanEnd& end) {
  (exit ? exit_ : enter_)[line] = end.depth;
  (exit ? exitNormal_ : enterNormal_)[line] = end.normal;
  if (!keepsOperations()) return;
  operations_[exit ? 2 : 0][line] = end.inner;
  operations_[exit ? 3 : 1][line] = end.outer;
}

void Dexels::read(std::size_t line, LineEnds& ends) const {
  ends.clear();
  if (hasMore(line)) {
    const auto several = severalOf(line);
    ends.assign(several.begin(), several.end());
  } else if (!isEmpty(line)) {
    ends.push_back(endOf(line, false));
    ends.push_back(endOf(line, true));
  }
}

void Dexels::write(std::size_t line, std::span<const SpanEnd> ends) {
  if (ends.size() > 2) {
    SpanEnd* const place = takePlace(line, ends.size());
    std::copy(ends.begin(), ends.end(), place);
    if (!keepsOperations())
      for (std::size_t i = 0; i < ends.size(); ++i) place[i].inner = place[i].outer = OperationId::None;
  } else {
    givePlaceBack(line);
  }
  if (ends.empty()) {
    enter_[line] = kInfinity;
    exit_[line] = -kInfinity;
    return;
  }
  setEnd(line, false, ends.front());
  setEnd(line, true, ends.back());
}

// Room for so many ends of a line; those that are there stay. To be filled by the caller.
SpanEnd* Dexels::takePlace(std::size_t line, std::size_t count) {
  Row& row = rowOf(line);
  if (!hasMore(line) || numberIn(row.pool[more_[line]].outer) < count) {
    const std::size_t room = std::bit_ceil(count), kind = classOf(room);
    std::uint32_t place;
    if (kind < row.free.size() && !row.free[kind].empty()) {
      place = row.free[kind].back();
      row.free[kind].pop_back();
    } else {
      place = static_cast<std::uint32_t>(row.pool.size());
      // From a little for each line, by a quarter: there are many rows, and what each keeps for later adds
      // up.
      const std::size_t size = row.pool.size() + room + 1, held = row.pool.capacity();
      if (size > held)
        row.pool.reserve(std::max({size, held + held / 4, static_cast<std::size_t>(width_) / 8}));
      row.pool.resize(size);
    }
    row.pool[place].outer = static_cast<OperationId>(room);
    if (hasMore(line)) {
      const auto several = severalOf(line);
      std::copy(several.begin(), several.end(), &row.pool[place] + 1);
      givePlaceBack(line);
    }
    more_[line] = place;
  }
  SpanEnd* const head = &row.pool[more_[line]];
  head->inner = static_cast<OperationId>(count);
  return head + 1;
}

void Dexels::givePlaceBack(std::size_t line) {
  if (!hasMore(line)) return;
  Row& row = rowOf(line);
  const std::size_t kind = classOf(numberIn(row.pool[more_[line]].outer));
  if (row.free.size() <= kind) row.free.resize(kind + 1);
  row.free[kind].push_back(more_[line]);
  more_[line] = kNoMore;
}

// The ends of a line with several spans, where they are.
class Dexels::Ends {
 public:
  Ends(Dexels& dexels, std::size_t line) : dexels_(dexels), line_(line), ends_(dexels.severalOf(line)) {}
  [[nodiscard]] std::size_t size() const { return ends_.size(); }
  [[nodiscard]] float depth(std::size_t i) const { return ends_[i].depth; }
  [[nodiscard]] SpanEnd get(std::size_t i) const { return ends_[i]; }
  void replace(std::size_t first, std::size_t gone, const SpanEnd* fresh, std::size_t count) {
    const std::size_t before = ends_.size(), after = before - gone + count;
    if (after <= 2) {
      SpanEnd left[2];
      std::size_t n = 0;
      for (std::size_t i = 0; i < first; ++i) left[n++] = ends_[i];
      for (std::size_t i = 0; i < count; ++i) left[n++] = fresh[i];
      for (std::size_t i = first + gone; i < before; ++i) left[n++] = ends_[i];
      dexels_.write(line_, {left, n});
      return;
    }
    SpanEnd* const ends = dexels_.takePlace(line_, std::max(before, after));
    if (gone != count)
      std::memmove(ends + first + count, ends + first + gone, (before - first - gone) * sizeof(SpanEnd));
    std::copy(fresh, fresh + count, ends + first);
    (ends - 1)->inner = static_cast<OperationId>(after);
    if (first == 0) dexels_.setEnd(line_, false, ends[0]);
    if (first + count == after) dexels_.setEnd(line_, true, ends[after - 1]);
  }

 private:
  Dexels& dexels_;
  std::size_t line_;
  std::span<const SpanEnd> ends_;
};

// The ends of a line with one span or none, and room for what one change makes of them.
class Dexels::FewEnds {
 public:
  FewEnds(const Dexels& dexels, std::size_t line) {
    if (dexels.isEmpty(line)) return;
    ends_ = {dexels.endOf(line, false), dexels.endOf(line, true)};
    size_ = 2;
  }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] float depth(std::size_t i) const { return ends_[i].depth; }
  [[nodiscard]] SpanEnd get(std::size_t i) const { return ends_[i]; }
  void replace(std::size_t first, std::size_t gone, const SpanEnd* fresh, std::size_t count) {
    const std::array<SpanEnd, 4> old = ends_;
    std::copy(fresh, fresh + count, ends_.begin() + first);
    std::copy(old.begin() + first + gone, old.begin() + size_, ends_.begin() + first + count);
    size_ = size_ - gone + count;
  }
  [[nodiscard]] std::span<const SpanEnd> all() const { return {ends_.data(), size_}; }

 private:
  std::array<SpanEnd, 4> ends_;
  std::size_t size_ = 0;
};

bool Dexels::change(std::size_t line, const ToolSpan& span, bool fills, OperationId id) {
  if (!changeEnds(line, span, fills, keepsOperations() ? id : OperationId::None)) return false;
  if (keepsHistory()) noteChange(line, id);
  return true;
}

bool Dexels::changeEnds(std::size_t line, const ToolSpan& span, bool fills, OperationId id) {
  if (hasMore(line)) return changeStretch(Ends(*this, line), span, fills, id);
  FewEnds ends(*this, line);
  if (!changeStretch(ends, span, fills, id)) return false;
  write(line, ends.all());
  return true;
}

bool Dexels::contains(std::size_t line, float depth) const {
  if (!(depth >= enter_[line] && depth <= exit_[line])) return false;
  if (!hasMore(line)) return true;
  const auto several = severalOf(line);
  for (std::size_t i = 0; i < several.size(); i += 2)
    if (depth >= several[i].depth && depth <= several[i + 1].depth) return true;
  return false;
}

std::size_t Dexels::endCount() const {
  std::size_t count = 0;
  for (std::size_t line = 0; line < lineCount(); ++line) count += endCount(line);
  return count;
}

double Dexels::totalLength() const {
  double sum = 0;
  for (std::size_t line = 0; line < lineCount(); ++line) {
    if (hasMore(line)) {
      const auto several = severalOf(line);
      for (std::size_t i = 0; i < several.size(); i += 2)
        sum += static_cast<double>(several[i + 1].depth) - static_cast<double>(several[i].depth);
    } else if (!isEmpty(line)) {
      sum += static_cast<double>(exit_[line]) - static_cast<double>(enter_[line]);
    }
  }
  return sum;
}

std::size_t Dexels::bytes() const {
  std::size_t bytes = bytesOf(enter_) + bytesOf(exit_) + bytesOf(enterNormal_) + bytesOf(exitNormal_) +
                      bytesOf(more_) + bytesOf(rows_) + histories_.bytes();
  for (const auto& of : operations_) bytes += bytesOf(of);
  for (const Row& row : rows_) {
    bytes += bytesOf(row.pool) + bytesOf(row.free);
    for (const auto& places : row.free) bytes += bytesOf(places);
  }
  return bytes;
}

bool Dexels::operator==(const Dexels& other) const {
  if (width_ != other.width_ || height_ != other.height_) return false;
  LineEnds own, others;
  for (std::size_t line = 0; line < lineCount(); ++line) {
    read(line, own);
    other.read(line, others);
    if (own != others) return false;
  }
  return true;
}

Dexels::Hulls Dexels::hulls() {
  const auto at = [&](int i) { return keepsOperations() ? operations_[i].data() : nullptr; };
  return {enter_.data(), exit_.data(), enterNormal_.data(), exitNormal_.data(), at(0), at(1),
          at(2),         at(3),        more_.data()};
}

}  // namespace restroke::points
