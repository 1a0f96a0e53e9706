#pragma once
// What is measured, for whom, and what it should be: the table of bench_rivals.

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace restroke::bench {

enum class Row : std::size_t {
  StampMedian,
  StampP99,
  ShortStampMedian,
  Replay,
  FirstReplay,
  RebuildOne,
  RebuildTwo,
  UndoMedian,
  UndoP99,
  RayBuild,
  RayUpdate,
  RayUpdateUndo,
  Rays,
  PrefixRays,
  RayBreakEven,
  Expand,
  Picture,
  ModelBytes,
  AllocatedBytes,
  BytesPerSurfel,
  BytesPerPrimitive,
};
inline constexpr std::size_t kRows = static_cast<std::size_t>(Row::BytesPerPrimitive) + 1;

struct RowInfo {
  std::string_view key;   ///< in files
  std::string_view text;  ///< for people
  std::string_view unit;
  int digits;         ///< after the point
  bool moreIsBetter;  ///< a rate; else a cost
};
[[nodiscard]] const RowInfo& infoOf(Row row);

/// Things of which each is measured once a round.
enum class Series : std::size_t { Stamps, ShortStamps, Undos };
inline constexpr std::size_t kSeries = 3;

/// The measurements of one program or library. Each figure is the median of all that were added; of a series
/// it is a quantile over the medians of each thing, so that what else the machine did once is nobody's 99th
/// percentile.
class Column {
 public:
  explicit Column(std::string name, std::string level = {})
      : name_(std::move(name)), level_(std::move(level)) {}

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Of SIMD, where it can be chosen; else empty.
  [[nodiscard]] const std::string& level() const { return level_; }
  void add(Row row, double value) { values_[static_cast<std::size_t>(row)].push_back(value); }
  /// One round of a series: as many values as in the rounds before it.
  void add(Series series, std::vector<double> round) {
    series_[static_cast<std::size_t>(series)].push_back(std::move(round));
  }
  /// Nothing where it was not measured.
  [[nodiscard]] std::optional<double> at(Row row) const;
  [[nodiscard]] std::size_t repetitions(Row row) const;

 private:
  std::string name_, level_;
  std::array<std::vector<double>, kRows> values_;
  std::array<std::vector<std::vector<double>>, kSeries> series_;
};

/// Restroke at every SIMD level, lowest first, and the rivals.
struct RivalsTable {
  std::vector<Column> ours;
  std::vector<Column> rivals;

  /// Null when there is none. Without a level: the highest one.
  [[nodiscard]] const Column* ourColumn(std::string_view level) const;
  [[nodiscard]] const Column* rivalColumn(std::string_view name, std::string_view level) const;
  /// How many times better Restroke is than the rival: at the rival's level where it has one, else at
  /// `level`.
  [[nodiscard]] std::optional<double> ratio(Row row, const Column& rival, std::string_view level = {}) const;
};

/// What Restroke is to reach on a machine of 2 cores, with 108 strokes, 3,426 stamps and 280,000 surfels.
struct Target {
  std::string_view what;
  Row row;
  std::string_view level;  ///< of SIMD; empty: the highest
  std::string_view rival;  ///< empty: the figure itself; else how many times better than this rival
  double limit;
  bool atLeast;  ///< else at most
};
[[nodiscard]] std::span<const Target> targets();
/// Nothing where the machine lacks the level, or it was not measured.
[[nodiscard]] std::optional<double> reached(const RivalsTable& table, const Target& target);
[[nodiscard]] bool isMet(const Target& target, double value);

/// q from 0 to 1 of values in any order; 0 of none.
[[nodiscard]] double quantile(std::vector<double> values, double q);

}  // namespace restroke::bench
