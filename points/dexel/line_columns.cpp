#include "points/dexel/line_columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace restroke::points {

namespace {

constexpr std::uint32_t kSign = 0x80000000u;

std::uint32_t orderOf(float depth) {
  const auto bits = std::bit_cast<std::uint32_t>(depth);
  return (bits & kSign) != 0 ? ~bits : bits | kSign;
}
float depthOf(std::uint32_t order) {
  return std::bit_cast<float>((order & kSign) != 0 ? order & ~kSign : ~order);
}

std::uint32_t folded(std::uint32_t d) {
  return d << 1 ^ ((d & kSign) != 0 ? ~0u : 0u);
}
std::uint32_t unfolded(std::uint32_t word) {
  return word >> 1 ^ ((word & 1) != 0 ? ~0u : 0u);
}

// An end as numbers that are expected, each for itself.
constexpr std::size_t kFields = 6, kFieldsWithoutOperations = 4;
using Fields = std::array<std::uint32_t, kFields>;

Fields fieldsOf(const SpanEnd& end) {
  return {orderOf(end.depth),
          end.normal & 0x7fffu,
          end.normal >> 15 & 0x7fffu,
          end.normal >> 30,
          static_cast<std::uint32_t>(end.inner) + 1,
          static_cast<std::uint32_t>(end.outer) + 1};
}
SpanEnd endOf(const Fields& f) {
  return {depthOf(f[0]), f[1] | f[2] << 15 | f[3] << 30, static_cast<OperationId>(f[4] - 1),
          static_cast<OperationId>(f[5] - 1)};
}

// The ends of the line being coded and of the row above: what an end's numbers are expected from.
class Expectation {
 public:
  explicit Expectation(int width) : above_(static_cast<std::size_t>(width)), row_(above_) {}

  void beginRow() { std::swap(above_, row_); }
  // Ends of the line are added in order after this.
  void beginLine(std::size_t column, std::size_t count) {
    column_ = column;
    row_[column].clear();
    const auto same = [&](const std::vector<Fields>& line) { return line.size() == count ? &line : nullptr; };
    left_ = column > 0 ? same(row_[column - 1]) : nullptr;
    up_ = same(above_[column]);
    corner_ = column > 0 ? same(above_[column - 1]) : nullptr;
  }
  [[nodiscard]] std::uint32_t of(std::size_t field) const {
    const std::vector<Fields>& line = row_[column_];
    const std::size_t k = line.size();
    if (left_ && up_ && corner_) return (*left_)[k][field] + (*up_)[k][field] - (*corner_)[k][field];
    if (left_) return (*left_)[k][field];
    if (up_) return (*up_)[k][field];
    return k > 0 ? line[k - 1][field] : 0;
  }
  void add(const Fields& end) { row_[column_].push_back(end); }

 private:
  std::vector<std::vector<Fields>> above_, row_;
  std::size_t column_ = 0;
  const std::vector<Fields>*left_ = nullptr, *up_ = nullptr, *corner_ = nullptr;
};

void putColumn(ByteWriter& out, const std::vector<std::uint32_t>& words) {
  std::string plane(words.size(), '\0');
  for (int byte = 0; byte < 4; ++byte) {
    for (std::size_t i = 0; i < words.size(); ++i) plane[i] = static_cast<char>(words[i] >> 8 * byte & 0xff);
    out.put(std::string_view(plane));
  }
}

// A column where it is.
class Column {
 public:
  Column() = default;
  Column(ByteReader& in, std::size_t count, std::string_view what) : count_(count) {
    in.need(count, 4, what);
    bytes_ = in.take(4 * count, what);
  }
  [[nodiscard]] std::uint32_t operator[](std::size_t i) const {
    std::uint32_t word = 0;
    for (std::size_t byte = 0; byte < 4; ++byte)
      word |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes_[byte * count_ + i])) << 8 * byte;
    return word;
  }

 private:
  std::string_view bytes_;
  std::size_t count_ = 0;
};

constexpr std::array<std::string_view, kFields> kNames = {"depths",
                                                          "normals",
                                                          "the normals' second halves",
                                                          "the normals' flags",
                                                          "operations inside",
                                                          "operations outside"};

void refuseBadEnd(const ByteReader& in, const SpanEnd& end, std::uint32_t lastOperation) {
  const octahedral::Folded n = octahedral::unpack(end.normal);
  const auto known = [&](OperationId id) {
    return id == OperationId::None || static_cast<std::uint32_t>(id) <= lastOperation;
  };
  if (!std::isfinite(end.depth)) in.refuse("a depth is not a finite number; it must be one");
  if (n.u > octahedral::kMost || n.v > octahedral::kMost)
    in.refuse(fmt::format("a normal is {:#x}; its halves must be at most {}", end.normal & ~kPackedFlag,
                          2 * octahedral::kMost));
  if (!known(end.inner) || !known(end.outer))
    in.refuse(fmt::format("an end was made by operation {}; there are {}",
                          static_cast<std::uint32_t>(known(end.inner) ? end.outer : end.inner),
                          lastOperation));
}

}  // namespace

void putLines(ByteWriter& out, const Dexels& dexels) {
  const std::size_t width = static_cast<std::size_t>(dexels.width()),
                    fields = dexels.keepsOperations() ? kFields : kFieldsWithoutOperations;
  std::vector<std::uint32_t> counts;
  counts.reserve(dexels.lineCount());
  std::array<std::vector<std::uint32_t>, kFields> columns;
  Expectation expectation(dexels.width());
  LineEnds ends;
  for (int row = 0; row < dexels.height(); ++row) {
    expectation.beginRow();
    std::uint32_t before = 0;
    for (std::size_t column = 0; column < width; ++column) {
      dexels.read(dexels.lineAt(static_cast<int>(column), row), ends);
      const auto count = static_cast<std::uint32_t>(ends.size());
      counts.push_back(folded(count - before));
      before = count;
      expectation.beginLine(column, count);
      for (const SpanEnd& end : ends) {
        const Fields numbers = fieldsOf(end);
        for (std::size_t f = 0; f < fields; ++f) columns[f].push_back(folded(numbers[f] - expectation.of(f)));
        expectation.add(numbers);
      }
    }
  }
  out.put(static_cast<std::uint8_t>((dexels.keepsOperations() ? 1 : 0) | (dexels.keepsHistory() ? 2 : 0)));
  out.put(static_cast<std::uint64_t>(columns[0].size()));
  putColumn(out, counts);
  for (std::size_t f = 0; f < fields; ++f) putColumn(out, columns[f]);
}

Dexels getLines(ByteReader& in, int width, int height, const LinesInFile& known) {
  const auto total = in.get<std::uint64_t>("the number of ends");
  const std::size_t lines = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const Column counts(in, lines, "the numbers of ends of the lines");
  const std::size_t fields = known.keepsOperations ? kFields : kFieldsWithoutOperations;
  in.need(total, 4 * fields, "the ends");
  std::array<Column, kFields> columns;
  for (std::size_t f = 0; f < fields; ++f)
    columns[f] = Column(in, static_cast<std::size_t>(total), kNames[f]);

  Dexels dexels(width, height, {.operations = known.keepsOperations});
  Expectation expectation(width);
  LineEnds ends;
  std::size_t next = 0, line = 0;
  for (int row = 0; row < height; ++row) {
    expectation.beginRow();
    std::uint32_t count = 0;
    for (int column = 0; column < width; ++column, ++line) {
      count += unfolded(counts[line]);
      if (count % 2 != 0 || count > total - next)
        in.refuse(fmt::format("line {} has {} ends and {} are left; it must be an even number of those", line,
                              count, total - next));
      expectation.beginLine(static_cast<std::size_t>(column), count);
      ends.clear();
      for (std::uint32_t k = 0; k < count; ++k, ++next) {
        Fields numbers{};
        for (std::size_t f = 0; f < fields; ++f) numbers[f] = expectation.of(f) + unfolded(columns[f][next]);
        if (numbers[1] > 0x7fff || numbers[2] > 0x7fff || numbers[3] > 3)
          in.refuse(
              fmt::format("end {} has the normal {}, {}, {}; these must be less than 32768, 32768 and 4",
                          next, numbers[1], numbers[2], numbers[3]));
        const SpanEnd end = endOf(numbers);
        refuseBadEnd(in, end, known.lastOperation);
        if (!ends.empty() && !(end.depth > ends.back().depth))
          in.refuse(fmt::format("the depths of line {} are {} and then {}; they must ascend", line,
                                ends.back().depth, end.depth));
        expectation.add(numbers);
        ends.push_back(end);
      }
      if (count > 0) dexels.write(line, ends);
    }
  }
  if (next != total) in.refuse(fmt::format("the lines have {} ends of {}; they must have all", next, total));
  return dexels;
}

void putHistories(ByteWriter& out, const Dexels& dexels) {
  std::vector<std::uint32_t> counts, words;
  counts.reserve(dexels.lineCount());
  words.reserve(dexels.histories().entryCount());
  std::vector<OperationId> ids;
  std::size_t line = 0;
  for (int row = 0; row < dexels.height(); ++row) {
    std::uint32_t before = 0;
    for (int column = 0; column < dexels.width(); ++column, ++line) {
      ids.clear();
      dexels.changesOf(line, ids);
      const auto count = static_cast<std::uint32_t>(ids.size());
      counts.push_back(folded(count - before));
      before = count;
      std::uint32_t last = 0;
      for (const OperationId id : ids) {
        words.push_back(folded(static_cast<std::uint32_t>(id) - last));
        last = static_cast<std::uint32_t>(id);
      }
    }
  }
  out.put(static_cast<std::uint64_t>(words.size()));
  putColumn(out, counts);
  putColumn(out, words);
}

void getHistories(ByteReader& in, Dexels& dexels, std::span<const std::uint8_t> names) {
  const auto total = in.get<std::uint64_t>("the number of operations in histories");
  const Column counts(in, dexels.lineCount(), "the numbers of operations that changed the lines");
  in.need(total, 4, "the operations that changed lines");
  const Column words(in, static_cast<std::size_t>(total), "the operations that changed lines");
  dexels.startHistory();
  std::size_t next = 0, line = 0;
  for (int row = 0; row < dexels.height(); ++row) {
    std::uint32_t count = 0;
    for (int column = 0; column < dexels.width(); ++column, ++line) {
      count += unfolded(counts[line]);
      if (count > total - next)
        in.refuse(
            fmt::format("line {} was changed by {} operations and {} are left; it must be no more than "
                        "those",
                        line, count, total - next));
      std::uint32_t last = 0;
      for (std::uint32_t k = 0; k < count; ++k, ++next) {
        const std::uint32_t id = last + unfolded(words[next]);
        if (id <= last || id >= names.size() || names[id] == 0)
          in.refuse(
              fmt::format("line {} was changed by operation {} after {}; they must ascend, be there ({} "
                          "are), and of a run be the first",
                          line, id, last, names.size() - 1));
        dexels.noteChange(line, static_cast<OperationId>(id));
        last = id;
      }
    }
  }
  if (next != total)
    in.refuse(fmt::format("the lines were changed by {} operations of {}; it must be all", next, total));
}

}  // namespace restroke::points
