#include "tests/bench/rivals_output.h"

#include <fmt/format.h>

#include "experiments/text.h"
#include "tests/bench/machine.h"

namespace restroke::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr Row rowAt(std::size_t i) {
  return static_cast<Row>(i);
}

std::string labelOf(const Row row) {
  const RowInfo& info = infoOf(row);
  return fmt::format("{} ({})", info.text, info.unit);
}

std::string figure(Row row, const std::optional<double>& value) {
  return value ? fmt::format("{:.{}f}", *value, infoOf(row).digits) : "-";
}

std::string withRatio(const RivalsTable& table, Row row, const Column& rival) {
  const std::optional<double> ratio = table.ratio(row, rival);
  return figure(row, rival.at(row)) + (ratio ? fmt::format(" {:>7.3g}x", *ratio) : std::string(9, ' '));
}

// Of rivals that were measured at several levels, the highest.
std::vector<const Column*> shownRivals(const RivalsTable& table) {
  std::vector<const Column*> shown;
  for (const Column& column : table.rivals)
    if (table.rivalColumn(column.name(), {}) == &column) shown.push_back(&column);
  return shown;
}

Json number(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

template <class F>
void forColumns(const RivalsTable& table, const F& f) {
  for (const Column& column : table.ours) f(column, std::optional<double>());
  for (const Column& column : table.rivals) f(column, std::optional<double>(0));
}

}  // namespace

std::string textOf(const Heading& heading, const RivalsTable& table) {
  std::string text = textOf(heading.origin);
  text += fmt::format(
      "List: {}, {} primitives in {} strokes; Restroke at density {:g}: {} surfels; OpenVDB at voxel {:g}: "
      "{} "
      "voxels in the band; shortened list: {} stamps\n"
      "{} rays of a picture of 1280 x 720, every eighth row; medians of {} rounds (OpenVDB CSG: fewer; CGAL: "
      "one)\nRatios: how many times better Restroke is, at the rival's SIMD level, or at {}\n\n",
      heading.list, heading.primitives, heading.strokes, heading.density, heading.surfels, heading.voxel,
      heading.activeVoxels, heading.shortened, heading.rays, heading.rounds, table.ours.back().level());
  std::vector<std::vector<std::string>> lines(1, {""});
  for (const Column& column : table.ours) lines[0].push_back(column.level());
  const std::vector<const Column*> rivals = shownRivals(table);
  for (const Column* rival : rivals) lines[0].push_back(rival->name());
  for (std::size_t i = 0; i < kRows; ++i) {
    std::vector<std::string>& line = lines.emplace_back(1, labelOf(rowAt(i)));
    for (const Column& column : table.ours) line.push_back(figure(rowAt(i), column.at(rowAt(i))));
    for (const Column* rival : rivals) line.push_back(withRatio(table, rowAt(i), *rival));
  }
  return text + experiments::alignedTable(lines, 1);
}

std::string textOfTargets(const RivalsTable& table) {
  std::vector<std::vector<std::string>> lines = {{"target", "simd", "limit", "reached", ""}};
  for (const Target& target : targets()) {
    const std::optional<double> value = reached(table, target);
    const std::string_view unit = target.rival.empty() ? infoOf(target.row).unit : "times";
    lines.push_back({std::string(target.what), std::string(target.level.empty() ? "highest" : target.level),
                     fmt::format("at {} {:g} {}", target.atLeast ? "least" : "most", target.limit, unit),
                     value ? fmt::format("{:.3g}", *value) : "-",
                     !value                  ? "not measured here"
                     : isMet(target, *value) ? "yes"
                                             : "no"});
  }
  return experiments::alignedTable(lines, 3);
}

Json jsonOf(const Heading& heading, const RivalsTable& table, const std::vector<Check>& checks) {
  Json out = jsonOf(heading.origin);
  out.update(Json{{"simd", table.ours.back().level()},
                  {"list", heading.list},
                  {"primitives", heading.primitives},
                  {"strokes", heading.strokes},
                  {"density", heading.density},
                  {"surfels", heading.surfels},
                  {"voxel", heading.voxel},
                  {"active_voxels", heading.activeVoxels},
                  {"shortened", heading.shortened},
                  {"rays", heading.rays},
                  {"rounds", heading.rounds}});
  Json columns = Json::array();
  forColumns(table, [&](const Column& column, const std::optional<double>& rival) {
    Json entry = {{"name", column.name()}, {"simd", column.level()}};
    for (std::size_t i = 0; i < kRows; ++i) {
      const Row row = rowAt(i);
      if (!column.at(row)) continue;
      Json& cell = entry["rows"][std::string(infoOf(row).key)];
      cell = {
          {"value", *column.at(row)}, {"unit", infoOf(row).unit}, {"repetitions", column.repetitions(row)}};
      if (rival) cell["ratio"] = number(table.ratio(row, column));
    }
    columns.push_back(std::move(entry));
  });
  out["columns"] = std::move(columns);
  Json met = Json::array();
  for (const Target& target : targets()) {
    const std::optional<double> value = reached(table, target);
    met.push_back({{"what", target.what},
                   {"row", infoOf(target.row).key},
                   {"simd", target.level},
                   {"rival", target.rival},
                   {"limit", target.limit},
                   {"at_least", target.atLeast},
                   {"reached", number(value)},
                   {"met", value ? Json(isMet(target, *value)) : Json(nullptr)}});
  }
  out["targets"] = std::move(met);
  Json held = Json::array();
  for (const Check& check : checks) held.push_back({{"holds", check.holds}, {"sentence", check.sentence}});
  out["checks"] = std::move(held);
  return out;
}

std::string csvOf(const RivalsTable& table) {
  std::string text = "row,unit,column,simd,value,ratio,repetitions\n";
  forColumns(table, [&](const Column& column, const std::optional<double>& rival) {
    for (std::size_t i = 0; i < kRows; ++i) {
      const Row row = rowAt(i);
      const std::optional<double> value = column.at(row);
      if (!value) continue;
      const std::optional<double> ratio = rival ? table.ratio(row, column) : std::nullopt;
      text += fmt::format("{},{},{},{},{:.6g},{},{}\n", infoOf(row).key, infoOf(row).unit,
                          experiments::csvField(column.name()), column.level(), *value,
                          ratio ? fmt::format("{:.6g}", *ratio) : "", column.repetitions(row));
    }
  });
  return text;
}

}  // namespace restroke::bench
