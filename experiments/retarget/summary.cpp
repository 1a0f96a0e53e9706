#include "experiments/retarget/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

namespace restroke::experiments {
namespace {

using retarget::Method;

/// Trials of one base, or of several.
struct Group {
  std::string base;
  std::vector<bool> member;  // by subject
};

std::vector<Group> groupsOf(const RetargetResults& results) {
  std::vector<Group> groups;
  const std::size_t count = results.subjects.size();
  for (std::size_t i = 0; i < count; ++i) {
    groups.push_back({results.subjects[i].name, std::vector<bool>(count, false)});
    groups.back().member[i] = true;
  }
  for (const bool tells : {true, false}) {
    Group group{tells ? kTelling : kSymmetric, std::vector<bool>(count, false)};
    for (std::size_t i = 0; i < count; ++i) group.member[i] = results.subjects[i].tellsMotion == tells;
    groups.push_back(std::move(group));
  }
  return groups;
}

RetargetSummary summed(const RetargetResults& results, const std::vector<const RetargetTrial*>& trials) {
  RetargetSummary sum;
  sum.trials = trials.size();
  std::vector<double> rms, stretch;
  for (const RetargetTrial* trial : trials) {
    const RetargetCase& of = results.cases[trial->changeCase];
    rms.push_back(trial->rms);
    stretch.push_back(trial->stretch);
    sum.worst = std::max(sum.worst, trial->worst);
    sum.followed += isFollowed(*trial) ? 1 : 0;
    sum.lost += trial->lost;
    sum.surface = std::max(sum.surface, trial->surface);
    sum.fellBack += trial->fellBack ? 1 : 0;
    sum.exactImage = sum.exactImage && of.exactImage;
    sum.chordError = std::max(sum.chordError, of.chordError);
  }
  const auto count = static_cast<double>(trials.size());
  sum.followed /= count;
  sum.lost /= count;
  sum.medianRms = quantile(rms, 0.5);
  sum.highRms = quantile(rms, 0.95);
  sum.stretch = quantile(stretch, 0.5);
  return sum;
}

/// Trials of some kinds, strengths and bases by one method.
std::vector<const RetargetTrial*> chosen(
    const RetargetResults& results, Method method,
    const std::function<bool(const RetargetCase&, const RetargetSubject&)>& of) {
  std::vector<const RetargetTrial*> trials;
  for (const RetargetTrial& trial : results.trials) {
    const RetargetCase& each = results.cases[trial.changeCase];
    if (trial.method == method && of(each, results.subjects[each.subject])) trials.push_back(&trial);
  }
  return trials;
}

std::string percent(double part) {
  return std::isfinite(part) ? fmt::format("{:.3g} %", 100 * part) : "lost";
}

/// What is asked of `aligned` where a shape tells its motion.
void addMotionClaims(const RetargetResults& results, std::vector<Claim>& all) {
  struct Asked {
    ChangeKind kind;
    double strength;
    const char* words;
  };
  constexpr std::array kAsked{Asked{ChangeKind::Translate, 0.5, "a translation of half the size"},
                              Asked{ChangeKind::Rotate, 45, "a turn of 45 degrees"},
                              Asked{ChangeKind::Scale, 1.5, "a scale of 1.5"},
                              Asked{ChangeKind::Motion, 1, "all three at once"}};
  for (const Asked& asked : kAsked) {
    const auto of = [&](const RetargetCase& c, const RetargetSubject& s) {
      return s.tellsMotion && c.kind == asked.kind && c.strength == asked.strength;
    };
    Claim claim{
        fmt::format("On bases that tell their motion, aligned follows {} with a median RMS error of at most "
                    "0.2 % of the stroke's length and at least 95 % of trials within 1 %; stamps left in "
                    "place miss by at least 50 times that",
                    asked.words),
        {},
        std::nullopt};
    const auto aligned = chosen(results, Method::Aligned, of), fixed = chosen(results, Method::Fixed, of);
    if (!aligned.empty()) {
      const RetargetSummary a = summed(results, aligned), f = summed(results, fixed);
      const double ratio = f.medianRms / a.medianRms;
      claim.measured =
          fmt::format("median {}, {:.1f} % within 1 %, {} trials; left in place {:.0f} times as far",
                      percent(a.medianRms), 100 * a.followed, a.trials, ratio);
      claim.holds = a.medianRms <= 0.002 && a.followed >= 0.95 && ratio >= 50;
    }
    all.push_back(std::move(claim));
  }
  Claim patch{
      "With only a patch around the stroke kept and the rest deformed, aligned follows at least 90 % of "
      "trials "
      "within 1 %",
      {},
      std::nullopt};
  const auto trials = chosen(results, Method::Aligned, [](const RetargetCase& c, const RetargetSubject& s) {
    return s.tellsMotion && c.kind == ChangeKind::Patch;
  });
  if (!trials.empty()) {
    const RetargetSummary sum = summed(results, trials);
    patch.measured = fmt::format("{:.1f} % of {} trials, median {}; {} were refused and cast as exact",
                                 100 * sum.followed, sum.trials, percent(sum.medianRms), sum.fellBack);
    patch.holds = sum.followed >= 0.9;
  }
  all.push_back(std::move(patch));
}

void addSymmetryClaim(const RetargetResults& results, std::vector<Claim>& all) {
  Claim claim{"Where symmetry hides the motion, aligned notices and says so", {}, std::nullopt};
  std::map<std::string, std::size_t> verdicts;
  std::size_t cases = 0, noticed = 0;
  for (const RetargetCase& c : results.cases) {
    if (results.subjects[c.subject].tellsMotion || !isSimilarity(c.kind)) continue;
    ++cases;
    ++verdicts[c.verdict];
    noticed += c.verdict == "symmetric" || c.verdict == "featureless" ? 1 : 0;
  }
  if (cases > 0) {
    for (const auto& [verdict, count] : verdicts)
      claim.measured += fmt::format("{}{} {}", claim.measured.empty() ? "" : ", ", verdict, count);
    claim.measured += fmt::format(" of {} motions of symmetric bases", cases);
    claim.holds = noticed == cases;
  }
  all.push_back(std::move(claim));
}

// Rounding of float32: of the hit, of the image's parameters or vertices, of the hit on the image; each at
// most half a unit in the last place of the greatest coordinate, which may be a few times the base's size,
// and along a slanting ray some times more.
constexpr double kRounding = 2e-6;
// Centres of stamps are rounded to this by default (sculpt/command.h).
constexpr double kGrid = 0x1p-16;

void addExactnessClaims(const RetargetResults& results, std::vector<Claim>& all) {
  Claim mapped{"mapped is exact to rounding for affine maps", {}, std::nullopt};
  double worst = 0;
  std::size_t count = 0;
  for (const RetargetTrial& trial : results.trials) {
    const RetargetCase& c = results.cases[trial.changeCase];
    if (trial.method != Method::Mapped || !(isSimilarity(c.kind) || c.kind == ChangeKind::Stretch)) continue;
    ++count;
    worst = std::max(worst, trial.rms * trial.length / results.subjects[c.subject].size);
  }
  if (count > 0) {
    mapped.measured = fmt::format("greatest RMS error {:.1e} of the base's size, {} trials", worst, count);
    mapped.holds = worst <= kRounding;
  }
  all.push_back(std::move(mapped));

  Claim exact{
      "For small local changes exact leaves no stroke point farther from the surface than the grid's "
      "rounding",
      {},
      std::nullopt};
  worst = 0;
  count = 0;
  for (const RetargetTrial& trial : results.trials) {
    const RetargetCase& c = results.cases[trial.changeCase];
    if (trial.method != Method::Exact || c.kind != ChangeKind::Bulge) continue;
    ++count;
    worst = std::max(worst, trial.surface * results.subjects[c.subject].size);
  }
  if (count > 0) {
    exact.measured = fmt::format("farthest {:.1e} model units (the grid is {:.1e}), {} trials of bulge",
                                 worst, kGrid, count);
    exact.holds = worst <= kGrid;
  }
  all.push_back(std::move(exact));
}

}  // namespace

double quantile(std::vector<double> values, double q) {
  std::erase_if(values, [](double v) { return std::isnan(v); });
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(values.size())));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank == 0 ? 0 : rank - 1);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::vector<RetargetSummary> summaries(const RetargetResults& results) {
  std::vector<RetargetSummary> all;
  for (const Group& group : groupsOf(results)) {
    std::map<std::tuple<ChangeKind, double, std::size_t>, std::vector<const RetargetTrial*>> trials;
    for (const RetargetTrial& trial : results.trials) {
      const RetargetCase& of = results.cases[trial.changeCase];
      if (!group.member[of.subject]) continue;
      const auto method = static_cast<std::size_t>(std::ranges::find(results.methods, trial.method) -
                                                   results.methods.begin());
      trials[{of.kind, of.strength, method}].push_back(&trial);
    }
    for (const auto& [key, each] : trials) {
      RetargetSummary sum = summed(results, each);
      sum.base = group.base;
      sum.kind = std::get<0>(key);
      sum.strength = std::get<1>(key);
      sum.method = results.methods[std::get<2>(key)];
      all.push_back(std::move(sum));
    }
  }
  return all;
}

const RetargetSummary* find(const std::vector<RetargetSummary>& all, const SummaryKey& key) {
  for (const RetargetSummary& each : all)
    if (each.base == key.base && each.kind == key.kind && each.strength == key.strength &&
        each.method == key.method)
      return &each;
  return nullptr;
}

std::vector<WorseCase> whereAlignedIsWorse(const RetargetResults& results) {
  std::vector<WorseCase> worse;
  const std::vector<RetargetSummary> all = summaries(results);
  for (std::size_t i = 0; i < results.subjects.size(); ++i)
    for (const RetargetSummary& aligned : all) {
      if (aligned.base != results.subjects[i].name || aligned.method != Method::Aligned) continue;
      const RetargetSummary* exact = find(all, {aligned.base, aligned.kind, aligned.strength, Method::Exact});
      if (exact != nullptr && aligned.medianRms > 1.25 * exact->medianRms &&
          aligned.medianRms > exact->medianRms + 0.002)
        worse.push_back({i, aligned.kind, aligned.strength, aligned.medianRms, exact->medianRms});
    }
  std::sort(worse.begin(), worse.end(), [](const WorseCase& a, const WorseCase& b) {
    return std::tuple(b.aligned - b.exact, a.subject, a.kind, a.strength) <
           std::tuple(a.aligned - a.exact, b.subject, b.kind, b.strength);
  });
  return worse;
}

std::vector<EditSummary> editSummaries(const RetargetResults& results) {
  std::vector<std::string> logs{kAllLogs};
  for (const RetargetEdit& edit : results.edits)
    if (std::ranges::find(logs, edit.log) == logs.end()) logs.push_back(edit.log);
  std::vector<EditSummary> all;
  for (const std::string& log : logs)
    for (const char* kind : {"cancel", "reorder", "base"})
      for (const Method method : results.methods) {
        EditSummary sum{.log = log, .kind = kind, .method = method};
        std::vector<double> surface, drift, stretch;
        for (const RetargetEdit& edit : results.edits) {
          if ((log != kAllLogs && edit.log != log) || edit.kind != kind || edit.method != method ||
              edit.places == 0)
            continue;
          ++sum.strokes;
          sum.lost += edit.lost;
          sum.fellBack += edit.fellBack ? 1 : 0;
          if (edit.lost >= 1) continue;
          surface.push_back(edit.surface);
          drift.push_back(edit.drift);
          stretch.push_back(edit.stretch);
        }
        if (sum.strokes == 0) continue;
        sum.lost /= static_cast<double>(sum.strokes);
        sum.surface = quantile(surface, 0.5);
        sum.drift = quantile(drift, 0.5);
        sum.stretch = quantile(stretch, 0.5);
        all.push_back(std::move(sum));
      }
  return all;
}

std::vector<Claim> claims(const RetargetResults& results) {
  std::vector<Claim> all;
  addMotionClaims(results, all);
  addSymmetryClaim(results, all);
  addExactnessClaims(results, all);
  return all;
}

}  // namespace restroke::experiments
