#include "experiments/dexel/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <string_view>

#include "experiments/page.h"
#include "experiments/text.h"

namespace restroke::experiments {
namespace {

constexpr const char* kDash = "–";

/// Cells: three digits after the point; less than half of the last is said to be so.
std::string cells(const DexelMeasured& m, double distance) {
  const double value = distance / m.cell;
  return value > 0 && value < 0.0005 ? fmt::format("{:.0e}", value) : fmt::format("{:.3f}", value);
}

std::string perUnit(const std::optional<double>& bytes) {
  return bytes ? fmt::format("{:.1f}", *bytes) : kDash;
}

struct Column {
  const char* title;
  std::string (*text)(const DexelRow& row);
};

constexpr Column kColumns[] = {
    {"lines", [](const DexelRow& r) { return r.measured.lines > 0 ? grouped(r.measured.lines) : kDash; }},
    {"elements", [](const DexelRow& r) { return grouped(r.measured.elements); }},
    {"bytes", [](const DexelRow& r) { return grouped(r.measured.bytes); }},
    {"without operations",
     [](const DexelRow& r) {
       return r.measured.bytesWithoutOperations ? grouped(*r.measured.bytesWithoutOperations) : kDash;
     }},
    {"a line", [](const DexelRow& r) { return perUnit(bytesPerLine(r.measured)); }},
    {"an end", [](const DexelRow& r) { return perUnit(bytesPerEnd(r.measured)); }},
    {"wrong %", [](const DexelRow& r) { return fmt::format("{:.3f}", 100 * r.measured.wrongVolume); }},
    {"coverage", [](const DexelRow& r) { return cells(r.measured, r.measured.coverage.mean); }},
    {"99 %", [](const DexelRow& r) { return cells(r.measured, r.measured.coverage.high); }},
    {"most", [](const DexelRow& r) { return cells(r.measured, r.measured.coverage.most); }},
    {"accuracy", [](const DexelRow& r) { return cells(r.measured, r.measured.accuracy.mean); }},
    {"99 %", [](const DexelRow& r) { return cells(r.measured, r.measured.accuracy.high); }},
    {"most", [](const DexelRow& r) { return cells(r.measured, r.measured.accuracy.most); }},
};

std::vector<const DexelRow*> rowsOf(const DexelResults& results, std::string_view source) {
  std::vector<const DexelRow*> rows;
  for (const DexelRow& row : results.rows)
    if (row.source == source) rows.push_back(&row);
  return rows;
}

const DexelRow* find(const DexelResults& results, std::string_view source, Representation representation,
                     int resolution) {
  const auto row = std::ranges::find_if(results.rows, [&](const DexelRow& r) {
    return r.source == source && r.measured.representation == representation && r.resolution == resolution;
  });
  return row == results.rows.end() ? nullptr : &*row;
}

std::set<int> resolutionsOf(const DexelResults& results) {
  std::set<int> resolutions;
  for (const DexelRow& row : results.rows) resolutions.insert(row.resolution);
  return resolutions;
}

struct Range {
  double least = INFINITY, most = -INFINITY;
  void add(double value) {
    least = std::min(least, value);
    most = std::max(most, value);
  }
  [[nodiscard]] bool empty() const { return least > most; }
  [[nodiscard]] bool within(double low, double high) const { return least >= low && most <= high; }
};

/// "0.7 to 0.8", or one number where they print alike.
std::string text(const Range& range, int digits) {
  const std::string least = fmt::format("{:.{}f}", range.least, digits),
                    most = fmt::format("{:.{}f}", range.most, digits);
  return least == most ? least : least + " to " + most;
}

template <class F>
Range rangeOf(const DexelResults& results, const F& valueOf) {
  Range range;
  for (const DexelRow& row : results.rows)
    if (const std::optional<double> value = valueOf(row)) range.add(*value);
  return range;
}

/// The power of n with which a figure grows from resolution `from` to `to`, over all solids.
template <class F>
Range powerOf(const DexelResults& results, Representation representation, std::pair<int, int> between,
              const F& figureOf) {
  Range range;
  const auto [from, to] = between;
  for (const std::string& source : sourcesOf(results)) {
    const DexelRow *coarse = find(results, source, representation, from),
                   *fine = find(results, source, representation, to);
    if (coarse == nullptr || fine == nullptr || figureOf(*coarse) <= 0 || figureOf(*fine) <= 0) continue;
    range.add(std::log(figureOf(*fine) / figureOf(*coarse)) / std::log(static_cast<double>(to) / from));
  }
  return range;
}

Claim bytesGrow(const DexelResults& results, const std::set<int>& resolutions) {
  Claim claim{"bytes grow as n³ for voxels and as n² for dexels, n points along the longest side", "", {}};
  if (resolutions.size() < 2) return claim;
  const std::pair between{*std::next(resolutions.rbegin()), *resolutions.rbegin()};
  const auto bytes = [](const DexelRow& row) { return static_cast<double>(row.measured.bytes); };
  const Range voxels = powerOf(results, Representation::Voxels, between, bytes),
              one = powerOf(results, Representation::OneFamily, between, bytes),
              three = powerOf(results, Representation::ThreeFamilies, between, bytes);
  claim.holds = voxels.within(2.8, 3.2) && one.within(1.8, 2.2) && three.within(1.8, 2.2);
  claim.measured = fmt::format("from {} to {} powers of {} for voxels, {} for one family, {} for three",
                               between.first, between.second, text(voxels, 2), text(one, 2), text(three, 2));
  return claim;
}

/// n from which dexels take less than voxels, by the squares and cubes that were measured at the finest.
Range crossingOf(const DexelResults& results, Representation representation, int finest, bool operations) {
  Range range;
  for (const std::string& source : sourcesOf(results)) {
    const DexelRow *dexels = find(results, source, representation, finest),
                   *voxels = find(results, source, Representation::Voxels, finest);
    if (dexels == nullptr || voxels == nullptr) continue;
    const std::size_t bytes =
        operations ? dexels->measured.bytes : dexels->measured.bytesWithoutOperations.value_or(0);
    range.add(finest * static_cast<double>(bytes) / static_cast<double>(voxels->measured.bytes));
  }
  return range;
}

Claim lessMemory(const DexelResults& results, const std::set<int>& resolutions) {
  Claim claim{
      "the paper: dexels take less memory than voxels (here of one bit each, one family, the finest n)",
      "",
      {}};
  if (resolutions.empty()) return claim;
  const int finest = *resolutions.rbegin();
  const Range one = crossingOf(results, Representation::OneFamily, finest, true),
              three = crossingOf(results, Representation::ThreeFamilies, finest, true),
              bare = crossingOf(results, Representation::OneFamily, finest, false),
              bareThree = crossingOf(results, Representation::ThreeFamilies, finest, false);
  claim.holds = one.most <= finest;
  claim.measured = fmt::format(
      "at n = {}; as n³ against n² one family takes less from n = {} on (without operations {}), three from "
      "{} on ({})",
      finest, text(one, 0), text(bare, 0), text(three, 0), text(bareThree, 0));
  return claim;
}

Claim wrongFalls(const DexelResults& results, const std::set<int>& resolutions) {
  Claim claim{"what is on the wrong side falls as 1 / n, from 16 to the finest n (64 or finer)", "", {}};
  // Coarser grids miss whole parts of a solid.
  if (!resolutions.contains(16) || *resolutions.rbegin() < 64) return claim;
  const std::pair between{16, *resolutions.rbegin()};
  Range all;
  for (const Representation representation : kRepresentations) {
    const Range range = powerOf(results, representation, between,
                                [](const DexelRow& row) { return row.measured.wrongVolume; });
    if (range.empty()) return claim;
    all.add(range.least);
    all.add(range.most);
  }
  claim.holds = all.within(-1.3, -0.7);
  claim.measured = fmt::format("from {} to {} powers of {}", between.first, between.second, text(all, 2));
  return claim;
}

std::vector<Claim> accuracyClaims(const DexelResults& results) {
  const Range ends = rangeOf(results, [](const DexelRow& r) -> std::optional<double> {
    if (r.measured.representation == Representation::Voxels) return std::nullopt;
    return r.measured.accuracy.most / r.measured.cell;
  });
  const auto facesOf = [&](double Distances::* which) {
    return rangeOf(results, [&](const DexelRow& r) -> std::optional<double> {
      if (r.measured.representation != Representation::Voxels) return std::nullopt;
      return r.measured.accuracy.*which / r.measured.cell;
    });
  };
  const Range faces = facesOf(&Distances::mean), farthest = facesOf(&Distances::most);
  std::vector<Claim> out{
      {"every end of a dexel is on the surface, to a thousandth of a cell", "", {}},
      {"faces of voxels are off by more than a tenth of a cell in the mean, and by half a cell at most",
       "",
       {}}};
  if (ends.empty() || faces.empty()) return out;
  out[0].holds = ends.most <= 1e-3;
  out[0].measured = fmt::format("{:.1e} cells at most", ends.most);
  out[1].holds = faces.least > 0.1 && farthest.most < 0.5 + 1e-3;
  out[1].measured = fmt::format("{} cells in the mean, {:.3f} at most", text(faces, 3), farthest.most);
  return out;
}

std::vector<Claim> coverageClaims(const DexelResults& results, const std::set<int>& resolutions) {
  std::vector<Claim> out{
      {"99 % of the surface is within a cell of an end of three families, at n ≥ 32", "", {}},
      {"at the finest n the worst place is farther from one family’s ends than from three families’",
       "",
       {}}};
  const Range high = rangeOf(results, [](const DexelRow& r) -> std::optional<double> {
    if (r.measured.representation != Representation::ThreeFamilies || r.resolution < 32) return std::nullopt;
    return r.measured.coverage.high / r.measured.cell;
  });
  if (!high.empty()) {
    out[0].holds = high.most <= 1;
    out[0].measured = fmt::format("within {} cells", text(high, 2));
  }
  Range one, three, ratio;
  for (const std::string& source : sourcesOf(results)) {
    const DexelRow *a = find(results, source, Representation::OneFamily, *resolutions.rbegin()),
                   *b = find(results, source, Representation::ThreeFamilies, *resolutions.rbegin());
    if (a == nullptr || b == nullptr) continue;
    one.add(a->measured.coverage.most / a->measured.cell);
    three.add(b->measured.coverage.most / b->measured.cell);
    ratio.add(a->measured.coverage.most / b->measured.coverage.most);
  }
  if (!ratio.empty()) {
    out[1].holds = ratio.least > 1;
    out[1].measured =
        fmt::format("{} cells against {}, {} times as far", text(one, 1), text(three, 1), text(ratio, 1));
  }
  return out;
}

std::string headingOf(const DexelRow& row) {
  return fmt::format("{}: {} primitive{}, {} samples of the surface", row.source, grouped(row.primitives),
                     row.primitives == 1 ? "" : "s", grouped(row.samples));
}

std::string tableOf(const std::vector<const DexelRow*>& rows) {
  std::string html = "<div class=\"wide left\"><table>\n<tr><th></th><th>n</th>";
  for (const Column& column : kColumns) html += fmt::format("<th>{}</th>", column.title);
  html += "</tr>\n";
  for (const DexelRow* row : rows) {
    html += fmt::format("<tr><td>{}</td><td>{}</td>", infoOf(row->measured.representation).title,
                        row->resolution);
    for (const Column& column : kColumns) html += fmt::format("<td>{}</td>", column.text(*row));
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

constexpr const char* kHow =
    "<h2>How it was measured</h2>\n<p>All three stand on the same grid of points, whose middle is that of "
    "the "
    "bounds. "
    "Voxels are a bit a point, the side of the point by the list. One family has a line through each point "
    "of a "
    "face of the grid, three have them through three faces; ends are computed from the list. Bytes are the "
    "containers’ capacity, with the operations at both sides of each end and without.</p>\n<p>Wrong: random "
    "points "
    "in the bounds whose side by the list is not what the voxel around them, the nearest line, or the "
    "majority of "
    "the three nearest lines says, by all that are inside. Coverage: from samples of the surface to the "
    "nearest "
    "element, in cells. Elements are ends of dexels, and middles of the faces between voxels of different "
    "sides. "
    "Accuracy: from the elements to the surface, in cells: the nearest of the surface’s samples and of "
    "the places where lines through the element, along its own normal and that sample’s, meet the list’s "
    "surface exactly.</p>\n";

}  // namespace

std::optional<double> bytesPerLine(const DexelMeasured& m) {
  if (m.lines == 0) return std::nullopt;
  return static_cast<double>(m.bytes) / static_cast<double>(m.lines);
}

std::optional<double> bytesPerEnd(const DexelMeasured& m) {
  if (m.lines == 0 || m.elements == 0) return std::nullopt;
  return static_cast<double>(m.bytes) / static_cast<double>(m.elements);
}

std::vector<std::string> sourcesOf(const DexelResults& results) {
  std::vector<std::string> sources;
  for (const DexelRow& row : results.rows)
    if (sources.empty() || sources.back() != row.source) sources.push_back(row.source);
  return sources;
}

std::vector<Claim> claims(const DexelResults& results) {
  const std::set<int> resolutions = resolutionsOf(results);
  std::vector<Claim> out;
  const auto add = [&](std::vector<Claim> more) { out.insert(out.end(), more.begin(), more.end()); };
  add(accuracyClaims(results));
  add(coverageClaims(results, resolutions));
  add({wrongFalls(results, resolutions), bytesGrow(results, resolutions), lessMemory(results, resolutions)});
  return out;
}

std::string dexelTable(const DexelResults& results) {
  std::string text;
  for (const std::string& source : sourcesOf(results)) {
    const auto rows = rowsOf(results, source);
    text += headingOf(*rows.front()) + "; coverage and accuracy in cells\n";
    std::vector<std::vector<std::string>> lines{{"", "n"}};
    for (const Column& column : kColumns) lines.front().emplace_back(column.title);
    for (const DexelRow* row : rows) {
      std::vector<std::string> line{infoOf(row->measured.representation).name,
                                    fmt::format("{}", row->resolution)};
      for (const Column& column : kColumns) line.push_back(column.text(*row));
      lines.push_back(std::move(line));
    }
    text += alignedTable(lines, 1) + "\n";
  }
  return text + textOf(claims(results));
}

std::string dexelReport(const DexelResults& results, const DexelImages& images, const Setup& setup,
                        const Provenance& origin) {
  std::string html = pageHead("Voxels, one family of dexels, or three");
  html += fmt::format(
      "<p class=lead>{} solids at {} resolutions: what each way to keep them takes, and how far from the "
      "truth it "
      "is.</p>\n",
      sourcesOf(results).size(), resolutionsOf(results).size());
  html += figureHtml(images.figure1,
                     "A slice of a ball’s model, as the paper’s figure 1: voxels, dexels along one axis, "
                     "dexels along two. Red: "
                     "parts of the circle that are farther than a cell from any end.");
  html += claimsSection(claims(results));
  for (const std::string& source : sourcesOf(results)) {
    const auto rows = rowsOf(results, source);
    html += fmt::format("<h2>{}</h2>\n", escapeHtml(headingOf(*rows.front())));
    html += tableOf(rows);
    for (const auto& [name, svg] : images.figures)
      if (name == source)
        html += figureHtml(
            svg, "Logarithmic on both axes. Distances below a millionth of a cell stand at the foot.");
    html += "<div class=pictures>\n";
    for (const auto& picture : images.pictures)
      if (picture.source == source)
        html += fmt::format("<figure><img alt=\"{0}\" src=\"{1}\"><figcaption>{0}</figcaption></figure>\n",
                            escapeHtml(picture.caption), dataUri("image/png", picture.png));
    html += "</div>\n";
  }
  html += kHow;
  html += originSection(setup, origin, results.inputs);
  return html.append(pageEnd());
}

}  // namespace restroke::experiments
