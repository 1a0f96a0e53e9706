#pragma once
// The dexels of many lines: which stretches of each are inside a solid (SPEC D3, R1).

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "points/dexel/line_histories.h"
#include "points/dexel/span_end.h"

namespace restroke::points {

/// Spans on width x height lines, in rows. What the lines are in space is not known here: the same container
/// serves parallel lines and the rays of a frustum.
///
/// The first span of each line is held in arrays over all lines, so that kernels can compare many at a time;
/// the few others of a row are in a pool of that row. 36 bytes a line (20 without operations), and 16 for
/// each end beyond the first two; with histories 4 more a line, and 8 for each operation that changed it.
/// Different rows may be changed by different threads.
class Dexels {
 public:
  struct Options {
    /// Keeps SpanEnd::inner and outer; without, they read as None.
    bool operations = true;
    /// Keeps every operation that ever changed a line (SPEC R2b).
    bool history = false;
  };
  /// All lines empty. width, height >= 0.
  Dexels(int width, int height, Options options);
  Dexels() = default;

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] std::size_t lineCount() const { return enter_.size(); }
  [[nodiscard]] bool keepsOperations() const { return !operations_[0].empty(); }

  [[nodiscard]] std::size_t lineAt(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(column);
  }

  [[nodiscard]] bool isEmpty(std::size_t line) const { return enter_[line] > exit_[line]; }
  /// Has it more than one span?
  [[nodiscard]] bool hasMore(std::size_t line) const { return more_[line] != kNoMore; }
  [[nodiscard]] std::size_t endCount(std::size_t line) const;
  /// `ends` becomes the line's.
  void read(std::size_t line, LineEnds& ends) const;
  /// An even number of ends, strictly ascending in depth, finite.
  void write(std::size_t line, std::span<const SpanEnd> ends);
  /// changeLine (span_end.h), in place; a change is noted where histories are kept.
  bool change(std::size_t line, const ToolSpan& span, bool fills, OperationId id);

  [[nodiscard]] bool keepsHistory() const { return histories_.areKept(); }
  /// Keeps histories from now on; what they held is forgotten. O(lines).
  void startHistory() { histories_ = LineHistories(width_, height_); }
  /// For those who change lines by `write` or `hulls`: the operation has changed the line. The initial solid
  /// is not noted, as it is part of every line's past; nor is None. Histories must be kept. O(1) where a
  /// line's operations come in ascending order.
  void noteChange(std::size_t line, OperationId id) { histories_.note(line, id); }
  /// Appends every operation that ever changed the line, ascending, each once: an operation that left the
  /// line as it was is not among them. Histories must be kept. O(those).
  void changesOf(std::size_t line, std::vector<OperationId>& ids) const { histories_.appendOf(line, ids); }
  /// The histories of another container, whose first line is this one's at `column` and `row`, come to those
  /// lines. Both keep them.
  void takeHistory(Dexels& other, int column, int row) {
    histories_.takeOver(std::move(other.histories_), column, row);
  }
  /// For their size; empty where none are kept.
  [[nodiscard]] const LineHistories& histories() const { return histories_; }
  /// Is the depth in a span of the line, ends included? O(spans).
  [[nodiscard]] bool contains(std::size_t line, float depth) const;

  /// Ends of all lines. O(lines).
  [[nodiscard]] std::size_t endCount() const;
  /// Sum of the lengths of all spans, in order. O(lines).
  [[nodiscard]] double totalLength() const;
  /// Bytes held, from the containers' capacity.
  [[nodiscard]] std::size_t bytes() const;
  /// Same lines with the same ends, bit for bit. Histories are not compared.
  bool operator==(const Dexels& other) const;

  /// For kernels, line by line: its span; of a line with several, from the first entry to the last exit, and
  /// nothing else. An empty line enters at +infinity and leaves at -infinity.
  struct Hulls {
    float *enter, *exit;
    PackedNormal *enterNormal, *exitNormal;
    OperationId *enterInner, *enterOuter, *exitInner, *exitOuter;  ///< null without operations
    const std::uint32_t* more;  ///< kNoMore: the line has not several spans
  };
  static constexpr std::uint32_t kNoMore = 0xffffffffu;
  /// Asks the memory for the ends of a line with several spans, if it is one.
  void fetchMore(std::size_t line) const {
    if (hasMore(line))
      __builtin_prefetch(&rows_[line / static_cast<std::size_t>(width_)].pool[more_[line]], 1);
  }
  [[nodiscard]] Hulls hulls();
  struct ConstHulls {
    const float *enter, *exit;
    const PackedNormal *enterNormal, *exitNormal;
    const std::uint32_t* more;
  };
  [[nodiscard]] ConstHulls hulls() const {
    return {enter_.data(), exit_.data(), enterNormal_.data(), exitNormal_.data(), more_.data()};
  }

 private:
  // Ends of lines with several spans: places for 4, 8, ... of them, each after a head whose `inner` says how
  // many there are and whose `outer` for how many there is room.
  struct Row {
    std::vector<SpanEnd> pool;
    std::vector<std::vector<std::uint32_t>> free;  // places by the logarithm of their room
  };
  class Ends;
  class FewEnds;
  bool changeEnds(std::size_t line, const ToolSpan& span, bool fills, OperationId id);
  [[nodiscard]] Row& rowOf(std::size_t line) { return rows_[line / static_cast<std::size_t>(width_)]; }
  [[nodiscard]] std::span<const SpanEnd> severalOf(std::size_t line) const;
  [[nodiscard]] SpanEnd endOf(std::size_t line, bool exit) const;
  void setEnd(std::size_t line, bool exit, const SpanEnd& end);
  [[nodiscard]] SpanEnd* takePlace(std::size_t line, std::size_t count);
  void givePlaceBack(std::size_t line);

  int width_ = 0, height_ = 0;
  std::vector<float> enter_, exit_;
  std::vector<PackedNormal> enterNormal_, exitNormal_;
  std::vector<OperationId> operations_[4];  // enter: inner, outer; exit: inner, outer
  std::vector<std::uint32_t> more_;
  std::vector<Row> rows_;
  LineHistories histories_;
};

}  // namespace restroke::points
