#pragma once
// Trials with known truth, brought together.

#include <optional>
#include <string>
#include <vector>

#include "experiments/output.h"
#include "experiments/retarget.h"

namespace restroke::experiments {

/// A stroke counts as followed when its RMS error is within this, and no more of its length is lost than
/// that.
inline constexpr double kFollowedRms = 0.01, kFollowedLost = 0.05;
[[nodiscard]] inline bool isFollowed(const RetargetTrial& trial) {
  return trial.rms <= kFollowedRms && trial.lost <= kFollowedLost;
}

/// All strokes of one base, or of several, by one method after one change.
struct RetargetSummary {
  std::string base;  ///< name; kTelling, kSymmetric: all bases that tell their motion, and all others
  ChangeKind kind = ChangeKind::Translate;
  double strength = 0;
  retarget::Method method = retarget::Method::Exact;
  std::size_t trials = 0;
  double medianRms = 0;  ///< of the strokes' lengths; infinite where most are lost altogether
  double highRms = 0;    ///< 95 % are at most this
  double worst = 0;      ///< greatest of all places, of the strokes' lengths
  double followed = 0;   ///< part of the trials
  double lost = 0;       ///< mean part of the length
  double surface = 0;    ///< greatest distance from the surface, of the base's size
  double stretch = 1;    ///< median
  std::size_t fellBack = 0;
  bool exactImage = true;  ///< of all bases
  double chordError = 0;   ///< greatest, of the base's size
};
inline constexpr const char* kTelling = "(telling)";
inline constexpr const char* kSymmetric = "(symmetric)";

/// By base in the order of the subjects, then the two groups; by kind, strength and method.
[[nodiscard]] std::vector<RetargetSummary> summaries(const RetargetResults& results);

/// Names one of these.
struct SummaryKey {
  std::string_view base;
  ChangeKind kind;
  double strength;
  retarget::Method method;
};
/// Null when there is none.
[[nodiscard]] const RetargetSummary* find(const std::vector<RetargetSummary>& all, const SummaryKey& key);

/// A change of a base after which `aligned` is clearly worse than `exact`: its median error is more than 1.25
/// times as large, and larger by 0.2 % of the stroke's length.
struct WorseCase {
  std::size_t subject = 0;
  ChangeKind kind = ChangeKind::Translate;
  double strength = 0;
  double aligned = 0, exact = 0;  ///< median errors
};
/// The largest difference first.
[[nodiscard]] std::vector<WorseCase> whereAlignedIsWorse(const RetargetResults& results);

/// All strokes after one kind of edit by one method.
struct EditSummary {
  std::string log;   ///< or kAllLogs
  std::string kind;  ///< cancel, reorder, base
  retarget::Method method = retarget::Method::Exact;
  std::size_t strokes = 0;
  double surface = 0;  ///< median, of the base's size
  double drift = 0;    ///< median, pixels
  double stretch = 1;  ///< median
  double lost = 0;     ///< mean
  std::size_t fellBack = 0;
};
inline constexpr const char* kAllLogs = "(all)";
[[nodiscard]] std::vector<EditSummary> editSummaries(const RetargetResults& results);

/// The value that a part `q` (0 to 1) of the values is at most; they may be infinite, NaN counts
/// for nothing. NaN for none.
[[nodiscard]] double quantile(std::vector<double> values, double q);

/// What SPEC and hypothesis promise.
[[nodiscard]] std::vector<Claim> claims(const RetargetResults& results);

}  // namespace restroke::experiments
