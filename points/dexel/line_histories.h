#pragma once
// Which operations ever changed each of many lines (SPEC R2b). Dexels keeps them; internal to points/dexel.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "points/dexel/span_end.h"

namespace restroke::points {

/// Of each line on width x height lines, in rows, the operations that changed it: ascending, each once.
/// 4 bytes a line and 8 an entry, in a pool of the line's row. Different rows may be changed by different
/// threads.
class LineHistories {
 public:
  /// Keeps nothing: no line may be asked or noted.
  LineHistories() = default;
  LineHistories(int width, int height);

  [[nodiscard]] bool areKept() const { return kept_; }

  /// The operation has changed the line. What was noted before is noted once; Initial and None are passed
  /// over. O(1) where ids come in ascending order, else O(later ones of the line).
  void note(std::size_t line, OperationId id);
  /// Appends those of the line. O(those).
  void appendOf(std::size_t line, std::vector<OperationId>& ids) const;
  /// Of all lines. O(rows).
  [[nodiscard]] std::size_t entryCount() const;
  /// Bytes held, from the containers' capacity.
  [[nodiscard]] std::size_t bytes() const;

  /// Becomes the histories of others, whose first line is this one's at `column` and `row`.
  void takeOver(LineHistories&& others, int column, int row);

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  struct Entry {
    OperationId id;
    std::uint32_t before;  // of the line, in the same pool; or kNone
  };
  std::size_t width_ = 0;
  bool kept_ = false;
  std::vector<std::uint32_t> last_;  // entry of each line; or kNone
  std::vector<std::vector<Entry>> rows_;
};

}  // namespace restroke::points
