#pragma once
// One line under operations, the last one first. Internal to points/dexel.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace restroke::points {

/// Who decides each place of a line: the last operation that fills or clears it. Operations come from the
/// last to the first, and each gets what none before it has taken (SPEC S4 along a line): the order in which
/// nothing is done that does not show, and in which a line is done when all of it is decided.
class LinePainter {
 public:
  static constexpr std::uint32_t kUndecided = 0xffffffffu;
  /// Decided before any step: inside, outside.
  static constexpr std::uint32_t kKnownFull = 0xfffffffeu, kKnownEmpty = 0xfffffffdu;
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();

  /// A stretch of the line up to the next one's beginning, or to the line's end.
  struct Piece {
    float begin;
    std::uint32_t owner;  ///< number of a step, or kUndecided
  };

  /// The line between two depths, from < to, undecided.
  void start(float from, float to) {
    pieces_.assign(1, {from, kUndecided});
    to_ = to;
    low_ = from;
    high_ = to;
  }
  /// The next stretch of a line that is being started, from where the last one ends on.
  void startPiece(float begin, std::uint32_t owner) { pieces_.push_back({begin, owner}); }
  void startPieces() { pieces_.clear(); }
  void endPieces(float to) {
    to_ = to;
    findUndecided();
  }
  /// Not started, or a line with nothing to decide.
  void clear() {
    pieces_.clear();
    low_ = kInfinity;
    high_ = -kInfinity;
  }

  /// All that is undecided lies between these; low > high: nothing is.
  [[nodiscard]] float low() const { return low_; }
  [[nodiscard]] float high() const { return high_; }

  /// Gives what is undecided between enter < exit to an owner.
  void paint(float enter, float exit, std::uint32_t owner) {
    if (!(enter < high_ && exit > low_)) return;
    std::size_t i = 0;
    while (i + 1 < pieces_.size() && !(pieces_[i + 1].begin > enter)) ++i;
    for (; i < pieces_.size() && pieces_[i].begin < exit; ++i) {
      if (pieces_[i].owner != kUndecided) continue;
      const float end = i + 1 < pieces_.size() ? pieces_[i + 1].begin : to_;
      if (!(end > enter)) continue;
      if (exit < end) pieces_.insert(at(i + 1), {exit, kUndecided});
      if (enter > pieces_[i].begin) {
        pieces_.insert(at(i + 1), {enter, owner});
        ++i;
      } else {
        pieces_[i].owner = owner;
      }
    }
    findUndecided();
  }

  [[nodiscard]] const std::vector<Piece>& pieces() const { return pieces_; }
  [[nodiscard]] float to() const { return to_; }

 private:
  [[nodiscard]] std::vector<Piece>::iterator at(std::size_t i) {
    return pieces_.begin() + static_cast<std::ptrdiff_t>(i);
  }
  void findUndecided() {
    std::size_t first = 0, last = pieces_.size();
    while (first < last && pieces_[first].owner != kUndecided) ++first;
    while (last > first && pieces_[last - 1].owner != kUndecided) --last;
    low_ = first < last ? pieces_[first].begin : kInfinity;
    high_ = first == last ? -kInfinity : last < pieces_.size() ? pieces_[last].begin : to_;
  }

  std::vector<Piece> pieces_;
  float to_ = 0, low_ = kInfinity, high_ = -kInfinity;
};

}  // namespace restroke::points
