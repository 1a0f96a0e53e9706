#pragma once
// Stretches of a line that come from several solids whose union is wanted. Internal to points/dexel/toolpath.

#include <cstddef>
#include <vector>

#include "points/dexel/toolpath/straight_sweep.h"

namespace restroke::points {

/// Disjoint stretches of a line, ascending. What is added is united with what is there; gaps of less than
/// `mend`, which rounding leaves where solids touch, are closed.
class LinePieces {
 public:
  /// They are put into `spans`, which is empty.
  LinePieces(double mend, std::vector<LocalSpan>& spans) : mend_(mend), spans_(spans) {}

  void add(const LocalSpan& span) {
    if (span.empty()) return;
    std::size_t first = 0;
    while (first < spans_.size() && spans_[first].exit < span.enter - mend_) ++first;
    std::size_t last = first;
    LocalSpan all = span;
    for (; last < spans_.size() && spans_[last].enter <= span.exit + mend_; ++last) {
      if (spans_[last].enter <= all.enter) {
        all.enter = spans_[last].enter;
        all.enterNormal = spans_[last].enterNormal;
      }
      if (spans_[last].exit >= all.exit) {
        all.exit = spans_[last].exit;
        all.exitNormal = spans_[last].exitNormal;
      }
    }
    const auto at = spans_.begin() + static_cast<std::ptrdiff_t>(first);
    if (first == last) {
      spans_.insert(at, all);
      return;
    }
    *at = all;
    spans_.erase(at + 1, spans_.begin() + static_cast<std::ptrdiff_t>(last));
  }
  [[nodiscard]] const std::vector<LocalSpan>& spans() const { return spans_; }

 private:
  double mend_;
  std::vector<LocalSpan>& spans_;
};

}  // namespace restroke::points
