#pragma once
// How long refinement takes while the history grows and the zone stays where it is.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/refine/differences.h"
#include "experiments/refine/histories.h"

namespace restroke::experiments {

/// What changes the result.
struct GrowthOptions {
  std::vector<std::size_t> operations{1000,    3000,    10'000,   30'000,
                                      100'000, 300'000, 1'000'000};  ///< ascending, each >= 500
  int resolution = 258;                                              ///< of the model
  int fineLines = 128;                                               ///< as LossOptions has it
  double part = 0.01;                                                ///< of the volume of a cube of side 1
  int repeats = 9;                                                   ///< of all methods but plain `all`
  /// What asks each operation on each line is done on a half, a fourth, ... of the lines across and along,
  /// where operations times lines would be more than this; and its time multiplied by what that leaves out,
  /// since each line costs the same.
  double plainMost = 2.5e9;
  /// It is repeated no more often than this many seconds allow, but done once.
  double plainSeconds = 3;
  /// Models whose lines' histories (R2b) would take more are not made: bytes.
  double mostHistoryBytes = 8e8;
};

/// 1000, 3000, 10,000, ... up to a number of at least 1000, which is the last one.
[[nodiscard]] std::vector<std::size_t> growthUpTo(std::size_t most);

/// Methods that are timed.
struct TimedMethod {
  const char* name;   ///< in tables: document, ends, touching, clusters, all, all-by-bounds, all-plain
  const char* title;  ///< for people
  points::RefineOptions options;
  bool byBounds = false;  ///< `all` of the operations whose bounds meet the zone: each line asks each of them
  /// Does each line ask each operation?
  [[nodiscard]] bool asksEach() const { return options.plain || byBounds; }
};
[[nodiscard]] const std::vector<TimedMethod>& timedMethods();

/// Of repeated times: median, quartiles.
struct Quartiles {
  double low = 0, median = 0, high = 0;
};
/// Values of the sample (of an even number the lower one of the middle); at least one.
[[nodiscard]] Quartiles quartilesOf(std::vector<double> values);

struct GrowthRow {
  Growth growth = Growth::Elsewhere;
  std::size_t operations = 0;
  std::string method;
  Quartiles seconds;                                ///< of the whole refinement
  double collect = 0, approximate = 0, replay = 0;  ///< medians, seconds
  std::size_t repeats = 0;
  /// Seconds are those of a part of the lines, times this (GrowthOptions::plainMost).
  double scale = 1;
  /// How many times as long as `ends` it took: of repetitions in the same turn.
  Quartiles byEnds;
  std::size_t collected = 0;
  bool identical = false;                  ///< with `all` culled by bounds
  std::optional<double> wrong;             ///< as LossRow::wrong
  std::size_t sidesMissed = 0, sides = 0;  ///< as Recall
  // Of the model, the same in all of its rows.
  std::size_t ids = 0;                           ///< that meet the zone
  std::size_t endsInZone = 0;                    ///< of the reference
  std::size_t modelBytes = 0;                    ///< with references (R2)
  std::optional<std::size_t> historyModelBytes;  ///< and with lines' histories (R2b), where it was made
  std::size_t historyBytes = 0;                  ///< of the operations ready to be replayed
  /// To make the model with references, and with lines' histories too; the operations ready to be replayed;
  /// their clusters. All of it beforehand.
  double modelSeconds = 0;
  std::optional<double> historyModelSeconds;
  double historySeconds = 0, clusterSeconds = 0;
};

/// A history that grows in one way, at all sizes. `told` is called with a text for people before each.
/// Counts and wrong lengths are the same for any number of threads. `notes` gets what was left out.
[[nodiscard]] std::vector<GrowthRow> measureGrowth(Growth growth, const GrowthOptions& options,
                                                   std::uint64_t seed, const Execution& execution,
                                                   const std::function<void(const std::string&)>& told,
                                                   std::vector<std::string>& notes);

/// The power of operations with which seconds grow: the slope of the line through their logarithms, least
/// squares, from `from` operations on. Nothing for less than two sizes.
[[nodiscard]] std::optional<double> powerOfGrowth(const std::vector<GrowthRow>& rows, Growth growth,
                                                  const std::string& method, std::size_t from);

}  // namespace restroke::experiments
