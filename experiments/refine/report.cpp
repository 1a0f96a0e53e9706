#include "experiments/refine/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "experiments/page.h"
#include "experiments/refine/summary.h"
#include "experiments/text.h"

namespace restroke::experiments {
namespace {

constexpr const char* kDash = "–";

/// The methods of the tables; what widening and correction do is a table of its own.
bool isMain(std::string_view method) {
  return method == "document" || method == "ends" || method == "touching" || method == "clusters";
}

std::string percent(const std::optional<double>& part, int digits) {
  if (!part) return kDash;
  const double value = 100 * *part;
  if (value == 0) return "0";
  const std::string text = fmt::format("{:.{}f}", value, digits);
  return text.find_first_of("123456789") == std::string::npos ? fmt::format("{:.0e}", value) : text;
}

std::string number(const std::optional<double>& value) {
  return value ? fmt::format("{:.2f}", *value) : kDash;
}

struct LossColumn {
  const char* title;
  std::string (*text)(const PooledLoss& p);
};
constexpr LossColumn kLossColumns[] = {
    {"wrong %", [](const PooledLoss& p) { return percent(p.wrong, 4); }},
    {"missing %", [](const PooledLoss& p) { return percent(p.missing, 4); }},
    {"too much %", [](const PooledLoss& p) { return percent(p.extra, 4); }},
    {"volume %", [](const PooledLoss& p) { return percent(p.volume, 4); }},
    {"worst zone %", [](const PooledLoss& p) { return p.wrong ? percent(p.worst, 4) : std::string(kDash); }},
    {"missed: made an end %", [](const PooledLoss& p) { return percent(p.trimmingMissed, 1); }},
    {"at an end %", [](const PooledLoss& p) { return percent(p.sidesMissed, 1); }},
    {"ends %", [](const PooledLoss& p) { return percent(p.endsMissed, 2); }},
    {"farthest lost, cells", [](const PooledLoss& p) { return number(p.toJudged); }},
    {"farthest added, cells", [](const PooledLoss& p) { return number(p.toReference); }},
    {"replayed %", [](const PooledLoss& p) { return percent(p.collected, 1); }},
};

std::string modelText(const LossRow& row) {
  if (row.sweep == LossSweep::Lines) return fmt::format("{}, {} lines", row.history, row.resolution);
  if (row.sweep == LossSweep::Zoom) return fmt::format("{}, {:g} %", row.history, 100 * row.value);
  if (row.sweep == LossSweep::Thin) return fmt::format("{}, {:g} cells", row.history, row.value);
  return fmt::format("{:g} ({} operations)", row.value, grouped(row.operations));
}

std::vector<PooledLoss> ofSweep(const std::vector<PooledLoss>& all, LossSweep sweep) {
  std::vector<PooledLoss> out;
  std::ranges::copy_if(all, std::back_inserter(out), [&](const PooledLoss& p) {
    return p.first->sweep == sweep && isMain(p.first->method);
  });
  return out;
}

std::string htmlTable(const std::vector<std::vector<std::string>>& lines, std::size_t left) {
  std::string html = "<div class=\"wide left\"><table>\n";
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const char* const tag = i == 0 ? "th" : "td";
    html += "<tr>";
    for (std::size_t c = 0; c < lines[i].size(); ++c)
      html += fmt::format("<{0}{1}>{2}</{0}>", tag, c > 0 && c < left ? " style=\"text-align:left\"" : "",
                          escapeHtml(lines[i][c]));
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

std::vector<std::vector<std::string>> lossLines(const std::vector<PooledLoss>& rows, const char* value) {
  std::vector<std::vector<std::string>> lines{{value, "method"}};
  for (const LossColumn& column : kLossColumns) lines.front().emplace_back(column.title);
  const LossRow* last = nullptr;
  for (const PooledLoss& row : rows) {
    const std::string model = modelText(*row.first);
    // What has been said is not said again.
    const bool again = last != nullptr && modelText(*last) == model;
    std::vector<std::string> line{again ? "" : model, row.first->method};
    for (const LossColumn& column : kLossColumns) line.push_back(column.text(row));
    lines.push_back(std::move(line));
    last = row.first;
  }
  return lines;
}

/// Dense mixed histories by the variants of `ends`, and what the model takes.
std::vector<std::vector<std::string>> variantLines(const std::vector<PooledLoss>& all) {
  std::vector<std::vector<std::string>> lines{
      {"model", "variant", "wrong %", "missed: at an end %", "replayed %"}};
  for (const PooledLoss& p : all) {
    if (p.first->sweep != LossSweep::Lines || !p.first->denseMixed || !p.first->method.starts_with("ends"))
      continue;
    const auto variant = std::ranges::find_if(
        refineVariants(), [&](const RefineVariant& v) { return v.name == p.first->method; });
    lines.push_back({p.first->method == "ends" ? modelText(*p.first) : "", variant->title,
                     percent(p.wrong, 4), percent(p.sidesMissed, 1), percent(p.collected, 1)});
  }
  return lines;
}

std::vector<std::vector<std::string>> byteLines(const std::vector<PooledLoss>& all) {
  std::vector<std::vector<std::string>> lines{
      {"model", "operations", "bytes with references (R2)", "histories of lines besides (R2b)", "times"}};
  for (const PooledLoss& p : all) {
    const LossRow& row = *p.first;
    if (row.sweep != LossSweep::Lines || row.method != "ends") continue;
    lines.push_back({modelText(row), grouped(row.operations), grouped(row.modelBytes),
                     grouped(row.lineHistoryBytes),
                     fmt::format("{:.2f}", static_cast<double>(row.modelBytes + row.lineHistoryBytes) /
                                               static_cast<double>(row.modelBytes))});
  }
  return lines;
}

std::vector<std::vector<std::string>> failureLines(const std::vector<LossRow>& rows) {
  std::vector<std::vector<std::string>> lines{{"varied", "method", "zones",
                                               fmt::format("beyond {:g} % wrong", 100 * kTargetWrong),
                                               fmt::format("beyond {:g} %", 100 * kBadlyWrong), "worst %"}};
  for (const LossSweep sweep : kLossSweeps)
    for (const char* method : {"document", "ends", "touching"}) {
      const Failures f = failuresOf(rows, sweep, method);
      if (f.zones == 0) continue;
      const auto part = [&](std::size_t n) {
        return fmt::format("{} ({:.0f} %)", n, 100 * static_cast<double>(n) / static_cast<double>(f.zones));
      };
      lines.push_back({infoOf(sweep).value, method, fmt::format("{}", f.zones), part(f.beyond), part(f.badly),
                       percent(f.worst, 3)});
    }
  return lines;
}

std::string milliseconds(double seconds) {
  return fmt::format("{:.3g}", 1000 * seconds);
}

std::vector<std::vector<std::string>> growthLines(const std::vector<GrowthRow>& rows, Growth growth) {
  std::vector<std::vector<std::string>> lines{{"operations", "method", "ms", "quartiles", "find",
                                               "approximate", "replay", "by ends", "turns", "replayed",
                                               "wrong %", "missed: at an end %"}};
  std::size_t last = 0;
  for (const GrowthRow& row : rows) {
    if (row.growth != growth) continue;
    std::optional<double> missed;
    if (row.sides > 0) missed = static_cast<double>(row.sidesMissed) / static_cast<double>(row.sides);
    lines.push_back({row.operations == last ? "" : grouped(row.operations), row.method,
                     milliseconds(row.seconds.median),
                     fmt::format("{} to {}", milliseconds(row.seconds.low), milliseconds(row.seconds.high)),
                     milliseconds(row.collect), milliseconds(row.approximate), milliseconds(row.replay),
                     fmt::format("{:.3g}", row.byEnds.median),
                     row.scale == 1 ? fmt::format("{}", row.repeats)
                                    : fmt::format("{}, 1/{:g} of the lines", row.repeats, row.scale),
                     grouped(row.collected), percent(row.wrong, 4), percent(missed, 1)});
    last = row.operations;
  }
  return lines;
}

/// What is made when a model is opened.
std::vector<std::vector<std::string>> beforehandLines(const std::vector<GrowthRow>& rows) {
  std::vector<std::vector<std::string>> lines{{"growth", "operations", "in the zone", "ends in the zone",
                                               "model, s", "with histories, s", "steps, s", "clusters, s",
                                               "model, bytes (R2)", "with histories (R2b)", "steps, bytes"}};
  for (const GrowthRow& row : rows) {
    if (row.method != "ends") continue;
    lines.push_back({nameOf(row.growth), grouped(row.operations), grouped(row.ids), grouped(row.endsInZone),
                     fmt::format("{:.2f}", row.modelSeconds),
                     row.historyModelSeconds ? fmt::format("{:.2f}", *row.historyModelSeconds) : kDash,
                     fmt::format("{:.3f}", row.historySeconds), fmt::format("{:.3f}", row.clusterSeconds),
                     grouped(row.modelBytes), row.historyModelBytes ? grouped(*row.historyModelBytes) : kDash,
                     grouped(row.historyBytes)});
  }
  return lines;
}

std::vector<std::vector<std::string>> powerLines(const std::vector<GrowthRow>& rows) {
  std::vector<std::vector<std::string>> lines{{"growth"}};
  for (const TimedMethod& method : timedMethods()) lines.front().emplace_back(method.title);
  for (const Growth growth : kGrowths) {
    std::vector<std::string> line{nameOf(growth)};
    for (const TimedMethod& method : timedMethods())
      line.push_back(number(powerOfGrowth(rows, growth, method.name, kFittedFrom)));
    lines.push_back(std::move(line));
  }
  return lines;
}

const char* explanationOf(LossSweep sweep) {
  switch (sweep) {
    case LossSweep::Lines:
      return "Balls strewn at random that are added and carved alike, on a ball (ball-…) and all over a "
             "block "
             "(block-…), each point covered by 8 of them; a block that is only milled, and balls that are "
             "only added; the strokes of logs.";
    case LossSweep::Zoom:
      return "The zone’s part of the volume of the model’s bounds, at the finest lines: the number of new "
             "lines stays, so that they come closer.";
    case LossSweep::Feature:
      return "Balls of ever smaller mean radius, in cells of the model, so many that each point is covered "
             "by 8.";
    case LossSweep::Density:
      return "Ever more balls of the same radii.";
    case LossSweep::Additions:
      return "The same balls, of which a part adds and the others carve; each point is covered by 3.";
    case LossSweep::Thin:
      return "Plates and rods five cells long and balls, carved into a block and added in a hollow: "
             "anywhere, "
             "and in the middles between the lines. What no line meets, no reference finds.";
  }
  return "";
}

constexpr const char* kPromises =
    "<h2>What each method promises</h2>\n<dl>\n<dt>all</dt><dd>The model: every operation is replayed. "
    "Plainly, each line asks each operation; or those whose bounds meet the zone are, of which each is then "
    "worked on only on the lines that it meets.</dd>\n<dt>clusters</dt><dd>The same bits: the operations "
    "whose bounds meet the zone, found in clusters that were made "
    "beforehand.</dd>\n<dt>touching</dt><dd>Every "
    "operation that ever changed one of the model’s lines through the zone, on the initial solid (R2b). "
    "Wrong "
    "only within operations that none of these lines has noticed.</dd>\n<dt>ends</dt><dd>The operations on "
    "both "
    "sides of each end in the zone and a cell around it (R2), on nothing; then corrected where all twelve "
    "edges of one of the model’s cells are inside, or all outside. Elsewhere nothing is "
    "promised.</dd>\n<dt>document</dt><dd>The operation that last trimmed each end, on an approximation from "
    "the model’s cells: an upper one where these operations only take away, else a lower one. So the result "
    "contains the solid, or is contained in it where they only add, but for what lies within a cell and "
    "meets "
    "none of its edges; where they do both, nothing is promised.</dd>\n</dl>\n";

std::string pictureSection(const RefinementImages& images) {
  std::string html, last;
  for (const auto& picture : images.pictures) {
    if (picture.history != last)
      html += fmt::format("{}<h3>{}</h3>\n<div class=pictures>\n", last.empty() ? "" : "</div>\n",
                          escapeHtml(picture.history));
    last = picture.history;
    html += fmt::format(
        "<figure><img alt=\"{0}\" src=\"{1}\"><img alt=\"{0}, cut\" src=\"{2}\"><figcaption>{0}</figcaption>"
        "</figure>\n",
        escapeHtml(picture.caption), dataUri("image/png", picture.surfacePng),
        dataUri("image/png", picture.slicePng));
  }
  if (html.empty()) return {};
  return "<h2>What is lost</h2>\n<p>A zone of each model on its new lines, and one plane of it cut through: "
         "the "
         "zone of several, and its plane, where ends is most wrong. Red is missing, blue is too much.</p>\n" +
         html + "</div>\n";
}

std::string figureOf(const RefinementImages& images, std::string_view name, std::string_view caption) {
  for (const auto& [figure, svg] : images.figures)
    if (figure == name) return figureHtml(svg, caption);
  return {};
}

std::string growthSection(const RefinementResults& results, const RefinementImages& images) {
  if (results.growths.empty()) return {};
  std::string html =
      "<h2>Seconds, while the history grows and the zone stays</h2>\n<p>Elsewhere: the zone has the same 430 "
      "operations near it, whatever there is elsewhere. Deeper: balls of one mean radius pile up in place. "
      "Finer: balls become smaller, so that each point is covered by 8 of them. Medians of turns in each of "
      "which every method ran; “by ends” is the median of a turn’s ratios. Where each line asks each "
      "operation, "
      "a part of the lines was done, and the time multiplied by what was left out.</p>\n";
  html += figureOf(images, "time", "Logarithmic on both axes. Dotted: in proportion to the history.");
  html += fmt::format("<h3>Power of the number of operations, from {} on</h3>\n", grouped(kFittedFrom));
  html += htmlTable(powerLines(results.growths), 1);
  for (const Growth growth : kGrowths)
    html += fmt::format("<h3>{}</h3>\n", nameOf(growth)) + htmlTable(growthLines(results.growths, growth), 2);
  html += "<h3>Beforehand, when a model is made or opened</h3>\n";
  html += htmlTable(beforehandLines(results.growths), 1);
  for (const std::string& note : results.notes)
    html += fmt::format("<p class=note>{}.</p>\n", escapeHtml(note));
  return html;
}

constexpr const char* kHow =
    "<h2>How it was measured</h2>\n<p>Each model is made of its operations on its lines. Zones are cubes "
    "about "
    "ends of lines picked at random (of thin features: about operations), moved into the model’s bounds. "
    "Each "
    "is refined by every method on the same three families of new lines and compared with all: what "
    "stretches "
    "of the lines are inside one of both only, by the length inside all. Operations that matter are those at "
    "the ends of all; the initial solid is none. One has made an end if it is the later one of the two at "
    "it; "
    "“at an end” counts both. “Farthest” are greatest distances from an end of one to the nearest of the "
    "other, in cells of the model; ends at the zone’s border are left out. Replayed: operations and initial "
    "solid that were collected, by those whose bounds meet the zone; operations beyond the zone count too, "
    "so "
    "it may be more than all. Zones of one model are taken together by summing lengths and counts.</p>\n";

}  // namespace

std::string refinementTable(const RefinementResults& results) {
  const std::vector<PooledLoss> all = pooled(results.losses);
  std::string text;
  for (const LossSweep sweep : kLossSweeps) {
    const std::vector<PooledLoss> rows = ofSweep(all, sweep);
    if (rows.empty()) continue;
    text +=
        fmt::format("{}\n{}\n", infoOf(sweep).title, alignedTable(lossLines(rows, infoOf(sweep).value), 2));
  }
  for (const Growth growth : kGrowths) {
    const auto lines = growthLines(results.growths, growth);
    if (lines.size() > 1)
      text +=
          fmt::format("Seconds, while the history grows: {}\n{}\n", nameOf(growth), alignedTable(lines, 2));
  }
  for (const std::string& note : results.notes) text += note + "\n";
  return text + textOf(claims(results));
}

std::string refinementReport(const RefinementResults& results, const RefinementImages& images,
                             const Setup& setup, const Provenance& origin) {
  const std::vector<PooledLoss> all = pooled(results.losses);
  std::string html = pageHead("What refinement by references misses");
  html += fmt::format(
      "<p class=lead>{} models, {} zones, each refined in {} ways and compared with the replay of the whole "
      "history.</p>\n",
      all.size() / refineVariants().size(), results.losses.size() / refineVariants().size(),
      refineVariants().size());
  html += claimsSection(claims(results)) + kPromises;
  html += "<h2>How often it fails</h2>\n" + htmlTable(failureLines(results.losses), 2);
  html += pictureSection(images);
  for (const LossSweep sweep : kLossSweeps) {
    const std::vector<PooledLoss> rows = ofSweep(all, sweep);
    if (rows.empty()) continue;
    html += fmt::format("<h2>{}</h2>\n<p>{}</p>\n", infoOf(sweep).title, explanationOf(sweep));
    html += figureOf(images, infoOf(sweep).name,
                     "Zones taken together. What is below the axis stands at its foot.");
    html += htmlTable(lossLines(rows, infoOf(sweep).value), 2);
    if (sweep != LossSweep::Lines) continue;
    html += "<h3>Widening and correction, on dense mixed histories</h3>\n" + htmlTable(variantLines(all), 2);
    html += "<h3>What the model takes</h3>\n" + htmlTable(byteLines(all), 1);
  }
  html += growthSection(results, images);
  html += kHow;
  html += originSection(setup, origin, results.inputs);
  return html.append(pageEnd());
}

}  // namespace restroke::experiments
