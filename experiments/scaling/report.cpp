#include "experiments/scaling/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/page.h"
#include "experiments/text.h"

namespace restroke::experiments {
namespace {

/// Three digits that count, thousands apart.
std::string number(double value) {
  if (!std::isfinite(value)) return "";
  if (value >= 1000) return grouped(static_cast<std::uint64_t>(std::llround(value)));
  return value >= 100  ? fmt::format("{:.0f}", value)
         : value >= 10 ? fmt::format("{:.1f}", value)
                       : fmt::format("{:.2f}", value);
}

std::string number(const std::optional<double>& value) {
  return value ? number(*value) : "–";
}

std::string valueText(const ScalingRow& row) {
  return row.sweep == Sweep::Crowding ? fmt::format("{:g}", row.value)
         : row.sweep == Sweep::Spread ? "1 : " + grouped(static_cast<std::uint64_t>(std::llround(row.value)))
                                      : grouped(static_cast<std::uint64_t>(std::llround(row.value)));
}

/// Where what was asked for is among the columns too.
const char* valueTitle(Sweep sweep) {
  return sweep == Sweep::Crowding || sweep == Sweep::Spread ? infoOf(sweep).parameter : "asked for";
}

struct Column {
  const char* title;
  std::string (*text)(const ScalingRow& row);
};

constexpr Column kColumns[] = {
    {"primitives", [](const ScalingRow& r) { return grouped(r.measured.primitives); }},
    {"surfels", [](const ScalingRow& r) { return grouped(r.measured.surfels); }},
    {"meets", [](const ScalingRow& r) { return number(r.measured.met); }},
    {"stamp µs", [](const ScalingRow& r) { return number(r.measured.stampMedian); }},
    {"p99", [](const ScalingRow& r) { return number(r.measured.stampHigh); }},
    {"undo ms", [](const ScalingRow& r) { return number(r.measured.undoMedian); }},
    {"p99", [](const ScalingRow& r) { return number(r.measured.undoHigh); }},
    {"replay s", [](const ScalingRow& r) { return number(r.measured.replay); }},
    {"rebuild ms, 1 thread", [](const ScalingRow& r) { return number(r.measured.rebuildOne); }},
    {"all threads", [](const ScalingRow& r) { return number(r.measured.rebuild); }},
    {"rays/s", [](const ScalingRow& r) { return number(r.measured.raysASecond); }},
    {"half prefix", [](const ScalingRow& r) { return number(r.measured.raysPrefixed); }},
    {"listing ms", [](const ScalingRow& r) { return number(r.measured.listing); }},
    {"picture ms", [](const ScalingRow& r) { return number(r.measured.picture); }},
    {"bytes a primitive", [](const ScalingRow& r) { return number(bytesPerPrimitive(r.measured)); }},
    {"bytes a surfel", [](const ScalingRow& r) { return number(bytesPerSurfel(r.measured)); }},
    {"peak MB",
     [](const ScalingRow& r) { return number(static_cast<double>(r.measured.peakResident) * 1e-6); }},
};

/// Rows of a sweep, of one source: a table for each.
std::vector<std::vector<const ScalingRow*>> groupsOf(const ScalingResults& results, Sweep sweep) {
  std::vector<std::vector<const ScalingRow*>> groups;
  for (const ScalingRow& row : results.rows) {
    if (row.sweep != sweep) continue;
    if (groups.empty() || groups.back().front()->source != row.source) groups.emplace_back();
    groups.back().push_back(&row);
  }
  return groups;
}

const ScalingRow* find(const ScalingResults& results, Sweep sweep, double value) {
  const auto row = std::ranges::find_if(
      results.rows, [&](const ScalingRow& r) { return r.sweep == sweep && r.value == value; });
  return row == results.rows.end() ? nullptr : &*row;
}

/// Figures whose growth is told.
struct Growing {
  const char* title;
  double (*of)(const Measured& m);
};
constexpr Growing kGrowing[] = {
    {"meets", [](const Measured& m) { return m.met; }},
    {"stamp, median", [](const Measured& m) { return m.stampMedian; }},
    {"stamp, p99", [](const Measured& m) { return m.stampHigh; }},
    {"undo, median", [](const Measured& m) { return m.undoMedian; }},
    {"undo, p99", [](const Measured& m) { return m.undoHigh; }},
    {"rebuild a primitive", [](const Measured& m) { return m.rebuild / static_cast<double>(m.primitives); }},
    {"time of a ray", [](const Measured& m) { return 1 / m.raysASecond; }},
    {"picture a surfel",
     [](const Measured& m) { return m.picture ? *m.picture / static_cast<double>(m.surfels) : NAN; }},
    {"bytes a primitive", [](const Measured& m) { return bytesPerPrimitive(m); }},
    {"bytes a surfel", [](const Measured& m) { return bytesPerSurfel(m); }},
};

std::string growthTable(const ScalingResults& results, Sweep sweep) {
  const ScalingRow* first = find(results, sweep, 1000);
  if (first == nullptr) return {};
  std::string html = fmt::format("<h3>{}</h3>\n<div class=wide><table>\n<tr><th>primitives</th>",
                                 escapeHtml(infoOf(sweep).title));
  for (const Growing& figure : kGrowing) html += fmt::format("<th>{}</th>", figure.title);
  html += "</tr>\n";
  for (const ScalingRow& row : results.rows) {
    if (row.sweep != sweep) continue;
    html += fmt::format("<tr><td>{}</td>", valueText(row));
    for (const Growing& figure : kGrowing) {
      const double ratio = figure.of(row.measured) / figure.of(first->measured);
      html += fmt::format("<td>{}</td>", std::isfinite(ratio) ? number(ratio) : "–");
    }
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

std::string sweepTable(const std::vector<const ScalingRow*>& rows) {
  std::string html = fmt::format("<div class=wide><table>\n<tr><th>{}</th>", valueTitle(rows.front()->sweep));
  for (const Column& column : kColumns) html += fmt::format("<th>{}</th>", column.title);
  html += "</tr>\n";
  for (const ScalingRow* row : rows) {
    html += fmt::format("<tr><td>{}</td>", valueText(*row));
    for (const Column& column : kColumns) html += fmt::format("<td>{}</td>", column.text(*row));
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

std::string pictureSection(const ScalingResults& results, const ScalingImages& images) {
  std::string html;
  for (const auto& picture : images.pictures) {
    const ScalingRow* row = nullptr;
    for (const ScalingRow& each : results.rows)
      if (each.sweep == picture.sweep && each.measured.whole) row = &each;
    if (row == nullptr) continue;
    const std::string caption =
        picture.part == "part"
            ? "Its middle, eight times as large."
            : fmt::format("{}: {} primitives, {} surfels.", infoOf(row->sweep).name,
                          grouped(row->measured.primitives), grouped(row->measured.surfels));
    html += fmt::format("<figure><img alt=\"{0}\" src=\"{1}\"><figcaption>{0}</figcaption></figure>\n",
                        escapeHtml(caption), dataUri("image/png", picture.png));
  }
  return html.empty() ? html : "<h2>What it looks like</h2>\n" + html;
}

const char* explanationOf(Sweep sweep) {
  switch (sweep) {
    case Sweep::Extent:
      return "The surface grows with the list: pebbles that are all alike, each stroke on another one than "
             "the "
             "last. A stamp meets as many others at every size, and finds little of them in a cache.";
    case Sweep::Detail:
      return "One unit sphere. The brush shrinks as 1 / √n and the density grows as n: a stamp has as many "
             "samples, and meets as many others, at every size. The sphere’s own samples are one large "
             "table.";
    case Sweep::Surfels:
      return "The same strokes at every density. A stamp has more samples, and so has the base under it.";
    case Sweep::Crowding:
      return "The same number of strokes on a smaller and smaller cap of the unit sphere (2 is the whole "
             "sphere; "
             "0.1 fits into one cell of the clusters). Stamps lie on each other: each meets a part of all.";
    case Sweep::Spread:
      return "Brushes of all sizes in one list, log-uniform. The mean area of a stamp is kept, so that "
             "samples "
             "and crowding stay alike; the smallest have the least number of samples that there is, 16.";
  }
  return "";
}

}  // namespace

double bytesPerPrimitive(const Measured& m) {
  return static_cast<double>(m.bytes.list + m.bytes.clusters) / static_cast<double>(m.primitives);
}

double bytesPerSurfel(const Measured& m) {
  return static_cast<double>(m.bytes.surfels) / static_cast<double>(m.surfels);
}

std::string_view figureOf(Sweep sweep) {
  return sweep == Sweep::Extent || sweep == Sweep::Detail ? "primitives" : infoOf(sweep).name;
}

std::vector<Claim> claims(const ScalingResults& results) {
  std::vector<Claim> out;
  constexpr double kMillion = 1'000'000;
  for (const Sweep sweep : {Sweep::Extent, Sweep::Detail}) {
    const ScalingRow *small = find(results, sweep, 1000), *large = find(results, sweep, kMillion);
    Claim claim{
        fmt::format("{}: the median stamp at 1,000,000 primitives costs at most 2 times that at 1,000",
                    infoOf(sweep).name),
        "",
        {}};
    if (small != nullptr && large != nullptr) {
      const double ratio = large->measured.stampMedian / small->measured.stampMedian;
      claim.holds = ratio <= 2;
      claim.measured = fmt::format("{:.2f} times: {} µs and {} µs; a stamp meets {} and {} primitives", ratio,
                                   number(large->measured.stampMedian), number(small->measured.stampMedian),
                                   number(large->measured.met), number(small->measured.met));
    }
    out.push_back(claim);
    Claim big{fmt::format("{}: 1,000,000 primitives and at least 10,000,000 surfels are replayed, undone in "
                          "the middle and drawn",
                          infoOf(sweep).name),
              "",
              {}};
    if (large != nullptr) {
      const Measured& m = large->measured;
      big.holds = m.surfels >= 10'000'000 && m.undone > 0 && m.picture.has_value();
      big.measured = fmt::format(
          "{} primitives, {} surfels: replayed in {} s, a stroke of {} stamps undone in {} ms, surfels "
          "listed in {} ms "
          "and drawn in {} ms, {:.2f} GB at most",
          grouped(m.primitives), grouped(m.surfels), number(m.replay), kStrokeStamps, number(m.undoMedian),
          number(m.listing), number(m.picture), static_cast<double>(m.peakResident) * 1e-9);
    }
    out.push_back(big);
  }
  Claim frame{fmt::format("the paper’s size: a stroke’s last stamp, listing and picture within a 60th of a "
                          "second ({:.1f} ms)",
                          kPaperFrame),
              "",
              {}};
  if (const ScalingRow* row = find(results, Sweep::Surfels, static_cast<double>(kPaperSurfels));
      row != nullptr && row->measured.picture && row->measured.listing) {
    const double all = row->measured.stampMedian / 1000 + *row->measured.listing + *row->measured.picture;
    frame.holds = all <= kPaperFrame;
    frame.measured = fmt::format("{} ms at {} primitives and {} surfels", number(all),
                                 grouped(row->measured.primitives), grouped(row->measured.surfels));
  }
  out.push_back(frame);
  return out;
}

std::string scalingTable(const ScalingResults& results) {
  std::string text;
  for (const Sweep sweep : kSweeps)
    for (const auto& rows : groupsOf(results, sweep)) {
      text += fmt::format("{}{}{}\n", infoOf(sweep).title, rows.front()->source.empty() ? "" : ", ",
                          rows.front()->source);
      std::vector<std::vector<std::string>> lines{{valueTitle(sweep)}};
      for (const Column& column : kColumns) lines.front().emplace_back(column.title);
      for (const ScalingRow* row : rows) {
        std::vector<std::string> line{valueText(*row)};
        for (const Column& column : kColumns) line.push_back(column.text(*row));
        lines.push_back(std::move(line));
      }
      text += alignedTable(lines) + "\n";
    }
  text += textOf(claims(results));
  for (const std::string& note : results.notes) text += fmt::format("left out: {}\n", note);
  return text;
}

std::string scalingReport(const ScalingResults& results, const ScalingImages& images, const Setup& setup,
                          const Provenance& origin) {
  std::string html = pageHead("How cost grows");
  std::size_t most = 0, surfels = 0;
  for (const ScalingRow& row : results.rows) {
    most = std::max(most, row.measured.primitives);
    surfels = std::max(surfels, row.measured.surfels);
  }
  html += fmt::format(
      "<p class=lead>{} lists of up to {} primitives and {} surfels, each replayed, stamped on, undone in "
      "the "
      "middle, rebuilt, hit by rays and drawn.</p>\n<p>Kernels: {}; {} threads for undo, rebuild and "
      "pictures, one "
      "for stamps and rays. At every size the state after strokes were taken from the middle and put back, "
      "and after "
      "a rebuild, was the one before, bit for bit.</p>\n",
      results.rows.size(), grouped(most), grouped(surfels), results.simd, results.threads);
  html += claimsSection(claims(results));
  html += "<h2>Growth</h2>\n<p>Each figure divided by that at 1,000 primitives.</p>\n";
  html += growthTable(results, Sweep::Extent) + growthTable(results, Sweep::Detail);
  std::string_view drawn;
  for (const Sweep sweep : kSweeps) {
    const auto groups = groupsOf(results, sweep);
    if (groups.empty()) continue;
    html += fmt::format("<h2>{}</h2>\n<p>{}</p>\n", escapeHtml(infoOf(sweep).title), explanationOf(sweep));
    for (const auto& rows : groups) {
      if (!rows.front()->source.empty())
        html += fmt::format("<h3>{}</h3>\n", escapeHtml(rows.front()->source));
      html += sweepTable(rows);
    }
    if (figureOf(sweep) == drawn || sweep == Sweep::Extent) continue;  // both of its sweeps, after the second
    drawn = figureOf(sweep);
    for (const auto& [name, svg] : images.figures)
      if (name == drawn)
        html += figureHtml(svg,
                           name == "primitives" || name == "surfels"
                               ? "Logarithmic on both axes. Dotted: the paper’s size, and a 60th of a second."
                               : "Logarithmic on both axes.");
  }
  html += pictureSection(results, images);
  html += fmt::format(
      "<h2>How it was measured</h2>\n<p>Stamps are appended one by one to the list at its full length; "
      "further "
      "strokes of the same kind, each taken away again, or the list’s own last ones. Meets: primitives whose "
      "balls "
      "meet that of a stamp, counted by the definition on stamps picked at random. An undo takes one stroke "
      "out of the "
      "second or third quarter of the list; putting it back is not timed. Rays go through random pixels of "
      "the "
      "picture, by one thread, for the whole list and for its first half. Listing makes the surfels; the "
      "picture "
      "({} x {} pixels) draws them on the CPU with one sample a pixel. Bytes of a primitive are those of "
      "list and clusters; bytes "
      "of a surfel, those of the visibility of all samples, also unseen ones. Peak is the process’s resident "
      "memory, tables "
      "of samples and what was measured before included.</p>\n",
      results.width, results.height);
  if (!results.notes.empty()) {
    html += "<h2>Left out</h2>\n<ul>\n";
    for (const std::string& note : results.notes) html += fmt::format("<li>{}</li>\n", escapeHtml(note));
    html += "</ul>\n";
  }
  html += originSection(setup, origin, results.inputs);
  return html.append(pageEnd());
}

}  // namespace restroke::experiments
