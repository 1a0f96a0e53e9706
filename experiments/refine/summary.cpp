#include "experiments/refine/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "experiments/text.h"

namespace restroke::experiments {
namespace {

constexpr std::size_t kMillion = 1'000'000;
constexpr int kTargetLines = 258;
constexpr double kPlainTarget = 50, kCulledTarget = 3;
// A power that counts as none: what a factor of ten in operations makes a fourth slower.
constexpr double kFlat = 0.1;

std::optional<double> partOf(double part, double all) {
  if (!(all > 0)) return std::nullopt;
  return part / all;
}

std::string percent(double part) {
  return fmt::format("{:.2g} %", 100 * part);
}

void keepGreater(std::optional<double>& greatest, const std::optional<double>& value, double by) {
  if (value) greatest = std::max(greatest.value_or(0), *value / by);
}

bool sameModel(const LossRow& a, const LossRow& b) {
  return a.sweep == b.sweep && a.value == b.value && a.history == b.history && a.operations == b.operations &&
         a.resolution == b.resolution && a.part == b.part;
}

Claim clustersAreAll(const RefinementResults& results) {
  Claim claim{"clusters gives the bits of all", "", {}};
  std::size_t zones = 0, same = 0;
  const auto count = [&](const auto& rows, const auto& identical) {
    for (const auto& row : rows) {
      if (row.method != "clusters") continue;
      ++zones;
      same += identical(row) ? 1 : 0;
    }
  };
  count(results.losses, [](const LossRow& row) { return row.differences.identical; });
  count(results.growths, [](const GrowthRow& row) { return row.identical; });
  if (zones == 0) return claim;
  claim.holds = same == zones;
  claim.measured = fmt::format("in {} of {} zones", same, zones);
  return claim;
}

Claim endsAreClose(const std::vector<PooledLoss>& all) {
  Claim claim{fmt::format("ends is within {:g} % of wrong length on dense mixed histories at {} lines",
                          100 * kTargetWrong, kTargetLines),
              "",
              {}};
  double worst = 0;
  std::string text;
  for (const PooledLoss& each : all) {
    const LossRow& row = *each.first;
    if (row.sweep != LossSweep::Lines || !row.denseMixed || row.resolution != kTargetLines ||
        row.method != "ends" || !each.wrong)
      continue;
    claim.holds = claim.holds.value_or(true) && *each.wrong <= kTargetWrong;
    worst = std::max(worst, each.worst);
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", row.history, percent(*each.wrong));
  }
  if (claim.holds) claim.measured = fmt::format("{}; the worst zone {}", text, percent(worst));
  return claim;
}

/// `ends` against another method at a million operations.
Claim fasterThan(const RefinementResults& results, Growth growth, const std::string& method,
                 std::string text) {
  const double target = method == "all-plain" ? kPlainTarget : kCulledTarget;
  Claim claim{fmt::format("a million operations, {}: ends is at least {:g} times as fast as {}",
                          nameOf(growth), target, text),
              "",
              {}};
  const GrowthRow *rival = find(results.growths, growth, kMillion, method),
                  *ends = find(results.growths, growth, kMillion, "ends");
  if (rival == nullptr || ends == nullptr) return claim;
  claim.holds = rival->byEnds.median >= target;
  claim.measured = fmt::format("{:.3g} times: {:.3g} s and {:.3g} s", rival->byEnds.median,
                               rival->seconds.median, ends->seconds.median);
  return claim;
}

Claim followsTheZone(const RefinementResults& results) {
  Claim claim{fmt::format("while the zone has the same operations, the seconds of ends grow as a power of "
                          "the history of at most {:g}",
                          kFlat),
              "",
              {}};
  const auto power = [&](Growth growth, const char* method) {
    return powerOfGrowth(results.growths, growth, method, kFittedFrom);
  };
  const auto ends = power(Growth::Elsewhere, "ends");
  if (!ends) return claim;
  claim.holds = *ends <= kFlat;
  claim.measured = fmt::format("{:.2f}", *ends);
  for (const char* method : {"touching", "clusters", "all", "all-plain"})
    if (const auto p = power(Growth::Elsewhere, method))
      claim.measured += fmt::format(", {} {:.2f}", method, *p);
  for (const Growth growth : {Growth::Deeper, Growth::Finer}) {
    const auto own = power(growth, "ends"), all = power(growth, "all");
    if (own && all)
      claim.measured += fmt::format("; {}: ends {:.2f}, all {:.2f}", nameOf(growth), *own, *all);
  }
  return claim;
}

/// Zones of histories that only take away, or only add, by `document`: what should not be there.
Claim documentHolds(const RefinementResults& results, bool removals) {
  Claim claim{removals ? "document: where operations only take away, nothing is missing"
                       : "document: where operations only add, nothing is too much",
              "",
              {}};
  double most = 0;
  std::size_t zones = 0, wrong = 0;
  for (const LossRow& row : results.losses) {
    if (row.method != "document" || row.additions != (removals ? 0 : 1) || !(row.length > 0)) continue;
    const double against = (removals ? row.differences.missing : row.differences.extra) / row.length;
    ++zones;
    wrong += against > 0 ? 1 : 0;
    most = std::max(most, against);
  }
  if (zones == 0) return claim;
  claim.holds = wrong == 0;
  claim.measured = wrong == 0
                       ? fmt::format("in none of {} zones", zones)
                       : fmt::format("there is in {} of {} zones, up to {}", wrong, zones, percent(most));
  return claim;
}

/// Whether features thinner than a cell are found.
Claim thinFeaturesAre(const RefinementResults& results, bool found) {
  Claim claim{found
                  ? "plates thinner than a cell are all found by ends"
                  : "of rods and grains between the lines, thinner than a cell, ends and touching find none",
              "",
              {}};
  std::size_t there = 0, missed = 0;
  for (const LossRow& row : results.losses) {
    if (row.sweep != LossSweep::Thin || row.value >= 1 ||
        row.history.ends_with("between the lines") == found || (found && row.history != "plates") ||
        !(row.method == "ends" || (!found && row.method == "touching")))
      continue;
    there += row.recall.trimming;
    missed += row.recall.trimmingMissed;
  }
  if (there == 0) return claim;
  claim.holds = missed == (found ? 0 : there);
  claim.measured = fmt::format("{} of {} found", there - missed, there);
  return claim;
}

}  // namespace

std::vector<PooledLoss> pooled(const std::vector<LossRow>& rows) {
  std::vector<PooledLoss> out;
  std::vector<const LossRow*> together;
  const auto flush = [&] {
    if (together.empty()) return;
    // Methods in the order in which they come.
    for (const RefineVariant& variant : refineVariants()) {
      PooledLoss pool;
      double length = 0, missing = 0, extra = 0, ends = 0, collected = 0, ids = 0;
      Recall recall;
      for (const LossRow* row : together) {
        if (row->method != variant.name) continue;
        if (pool.first == nullptr) pool.first = row;
        ++pool.zones;
        length += row->length;
        missing += row->differences.missing;
        extra += row->differences.extra;
        ends += static_cast<double>(row->ends);
        collected += static_cast<double>(row->collected);
        ids += static_cast<double>(row->ids);
        pool.worst = std::max(pool.worst, row->wrong().value_or(0));
        recall.trimming += row->recall.trimming;
        recall.trimmingMissed += row->recall.trimmingMissed;
        recall.sides += row->recall.sides;
        recall.sidesMissed += row->recall.sidesMissed;
        recall.endsMissed += row->recall.endsMissed;
        keepGreater(pool.toJudged, row->differences.toJudged, row->cell);
        keepGreater(pool.toReference, row->differences.toReference, row->cell);
      }
      if (pool.first == nullptr) continue;
      pool.missing = partOf(missing, length);
      pool.extra = partOf(extra, length);
      pool.wrong = partOf(missing + extra, length);
      if (length > 0) pool.volume = (extra - missing) / length;
      const auto part = [](std::size_t a, std::size_t b) {
        return partOf(static_cast<double>(a), static_cast<double>(b));
      };
      pool.trimmingMissed = part(recall.trimmingMissed, recall.trimming);
      pool.sidesMissed = part(recall.sidesMissed, recall.sides);
      pool.endsMissed = partOf(static_cast<double>(recall.endsMissed), ends);
      pool.collected = partOf(collected, ids).value_or(0);
      out.push_back(pool);
    }
    together.clear();
  };
  for (const LossRow& row : rows) {
    if (!together.empty() && !sameModel(*together.front(), row)) flush();
    together.push_back(&row);
  }
  flush();
  return out;
}

Failures failuresOf(const std::vector<LossRow>& rows, LossSweep sweep, const std::string& method) {
  Failures out;
  for (const LossRow& row : rows) {
    if (row.sweep != sweep || row.method != method) continue;
    const std::optional<double> wrong = row.wrong();
    if (!wrong) continue;
    ++out.zones;
    out.beyond += *wrong > kTargetWrong ? 1 : 0;
    out.badly += *wrong > kBadlyWrong ? 1 : 0;
    out.worst = std::max(out.worst, *wrong);
  }
  return out;
}

const GrowthRow* find(const std::vector<GrowthRow>& rows, Growth growth, std::size_t operations,
                      const std::string& method) {
  const auto row = std::ranges::find_if(rows, [&](const GrowthRow& r) {
    return r.growth == growth && r.operations == operations && r.method == method;
  });
  return row == rows.end() ? nullptr : &*row;
}

std::vector<Claim> claims(const RefinementResults& results) {
  const std::vector<PooledLoss> all = pooled(results.losses);
  std::vector<Claim> out{clustersAreAll(results), endsAreClose(all)};
  for (const auto& [method, text] :
       {std::pair{"all-plain", "plain all"},
        {"all-by-bounds", "all culled by bounds, line by line"},
        {"all",
         "all culled by bounds that then works, as ends does, only where operations meet lines and show"}})
    for (const Growth growth : kGrowths) out.push_back(fasterThan(results, growth, method, text));
  for (const Claim& claim :
       {followsTheZone(results), documentHolds(results, true), documentHolds(results, false),
        thinFeaturesAre(results, false), thinFeaturesAre(results, true)})
    out.push_back(claim);
  return out;
}

}  // namespace restroke::experiments
