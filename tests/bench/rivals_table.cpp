#include "tests/bench/rivals_table.h"

#include <algorithm>

namespace restroke::bench {
namespace {

constexpr std::array<RowInfo, kRows> kRowInfos = {{
    {"stamp_median", "stamp, median", "us", 2, false},
    {"stamp_p99", "stamp, 99th percentile", "us", 2, false},
    {"short_stamp_median", "stamp, median, of the shortened list", "us", 2, false},
    {"replay", "whole replay", "ms", 2, false},
    {"first_replay", "whole replay, first in process", "ms", 2, false},
    {"rebuild_1", "rebuild of everything, 1 thread", "ms", 2, false},
    {"rebuild_2", "rebuild of everything, 2 threads", "ms", 2, false},
    {"undo_median", "undo of a stroke in the middle, median", "ms", 3, false},
    {"undo_p99", "undo of a stroke in the middle, 99th perc.", "ms", 3, false},
    {"ray_build", "rays, built beforehand", "ms", 2, false},
    {"ray_update", "rays, up to date after a stroke at the end", "ms", 3, false},
    {"ray_update_undo", "rays, up to date after undo in the middle", "ms", 3, false},
    {"rays", "rays, 1 thread", "M/s", 3, true},
    {"prefix_rays", "rays on the first half of the list", "M/s", 3, true},
    {"ray_break_even", "rays after which building has paid off", "thousand", 0, false},
    {"expand", "surfels laid out, 2 threads", "ms", 2, false},
    {"picture", "picture 1280 x 720, laying out included", "ms", 2, false},
    {"model_bytes", "model, as counted", "MB", 3, false},
    {"allocated_bytes", "model, as the allocator says", "MB", 3, false},
    {"bytes_per_surfel", "bytes a surfel", "B", 2, false},
    {"bytes_per_primitive", "bytes a primitive, indices included", "B", 2, false},
}};

constexpr Target kTargets[] = {
    {"stamp, median", Row::StampMedian, "avx512", "", 3, false},
    {"stamp, 99th percentile", Row::StampP99, "avx512", "", 20, false},
    {"stamp, median", Row::StampMedian, "avx2", "", 5, false},
    {"stamp, 99th percentile", Row::StampP99, "avx2", "", 30, false},
    {"stamp against OpenVDB's CSG", Row::StampMedian, "", "OpenVDB CSG", 200, true},
    {"stamp against the leaf brush", Row::StampMedian, "avx512", "leaf brush", 5, true},
    {"stamp against the leaf brush", Row::StampMedian, "avx2", "leaf brush", 2.5, true},
    {"stamp against its plain loops", Row::StampMedian, "avx512", "leaf brush, plain", 5, true},
    {"stamp against its plain loops", Row::StampMedian, "avx2", "leaf brush, plain", 2.5, true},
    {"rebuild of everything, 2 threads", Row::RebuildTwo, "", "", 8, false},
    {"that against the leaf brush's replay", Row::RebuildTwo, "", "leaf brush", 10, true},
    {"that against its plain loops", Row::RebuildTwo, "", "leaf brush, plain", 10, true},
    {"undo of a stroke in the middle, median", Row::UndoMedian, "", "", 0.5, false},
    {"undo of a stroke in the middle, 99th perc.", Row::UndoP99, "", "", 2, false},
    {"bytes a surfel", Row::BytesPerSurfel, "", "", 20, false},
    {"bytes a primitive, indices included", Row::BytesPerPrimitive, "", "", 100, false},
    {"exact rays, whole list", Row::Rays, "avx512", "", 3, true},
    {"exact rays, first half of the list", Row::PrefixRays, "avx512", "", 3, true},
    {"exact rays, whole list", Row::Rays, "avx2", "", 1.5, true},
    {"exact rays, first half of the list", Row::PrefixRays, "avx2", "", 1.5, true},
    {"picture, laying out included", Row::Picture, "avx512", "", 12, false},
    {"picture, laying out included", Row::Picture, "sse2", "", 20, false},
};

// The series that a row is a quantile of.
struct Source {
  Series series;
  double q;
};
std::optional<Source> sourceOf(Row row) {
  switch (row) {
    case Row::StampMedian:
      return Source{Series::Stamps, 0.5};
    case Row::StampP99:
      return Source{Series::Stamps, 0.99};
    case Row::ShortStampMedian:
      return Source{Series::ShortStamps, 0.5};
    case Row::UndoMedian:
      return Source{Series::Undos, 0.5};
    case Row::UndoP99:
      return Source{Series::Undos, 0.99};
    default:
      return std::nullopt;
  }
}

std::vector<double> mediansOf(const std::vector<std::vector<double>>& rounds) {
  std::vector<double> medians(rounds[0].size()), values(rounds.size());
  for (std::size_t i = 0; i < medians.size(); ++i) {
    for (std::size_t round = 0; round < rounds.size(); ++round) values[round] = rounds[round].at(i);
    medians[i] = quantile(values, 0.5);
  }
  return medians;
}

}  // namespace

const RowInfo& infoOf(Row row) {
  return kRowInfos[static_cast<std::size_t>(row)];
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

std::optional<double> Column::at(Row row) const {
  if (const std::optional<Source> source = sourceOf(row)) {
    const auto& rounds = series_[static_cast<std::size_t>(source->series)];
    if (!rounds.empty()) return quantile(mediansOf(rounds), source->q);
  }
  const std::vector<double>& values = values_[static_cast<std::size_t>(row)];
  if (values.empty()) return std::nullopt;
  return quantile(values, 0.5);
}

std::size_t Column::repetitions(Row row) const {
  const std::optional<Source> source = sourceOf(row);
  const std::size_t rounds = source ? series_[static_cast<std::size_t>(source->series)].size() : 0;
  return rounds > 0 ? rounds : values_[static_cast<std::size_t>(row)].size();
}

const Column* RivalsTable::ourColumn(std::string_view level) const {
  if (level.empty()) return ours.empty() ? nullptr : &ours.back();
  for (const Column& column : ours)
    if (column.level() == level) return &column;
  return nullptr;
}

const Column* RivalsTable::rivalColumn(std::string_view name, std::string_view level) const {
  const Column* found = nullptr;
  for (const Column& column : rivals)
    if (column.name() == name && (level.empty() || column.level().empty() || column.level() == level))
      found = &column;
  return found;
}

std::optional<double> RivalsTable::ratio(Row row, const Column& rival, std::string_view level) const {
  const Column* column = ourColumn(rival.level().empty() ? level : rival.level());
  if (!column) return std::nullopt;
  const std::optional<double> a = column->at(row), b = rival.at(row);
  if (!a || !b || *a <= 0 || *b <= 0) return std::nullopt;
  return infoOf(row).moreIsBetter ? *a / *b : *b / *a;
}

std::span<const Target> targets() {
  return kTargets;
}

std::optional<double> reached(const RivalsTable& table, const Target& target) {
  const Column* column = table.ourColumn(target.level);
  if (!column) return std::nullopt;
  if (target.rival.empty()) return column->at(target.row);
  const Column* rival = table.rivalColumn(target.rival, target.level);
  return rival ? table.ratio(target.row, *rival, target.level) : std::nullopt;
}

bool isMet(const Target& target, double value) {
  return target.atLeast ? value >= target.limit : value <= target.limit;
}

}  // namespace restroke::bench
