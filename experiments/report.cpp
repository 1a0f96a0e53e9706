#include "experiments/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/page.h"
#include "experiments/paper_table.h"
#include "experiments/text.h"

namespace restroke::experiments {
namespace {

constexpr std::size_t kReportRows = 14;

const MemoryRow* rowNamed(const MemoryStep& step, std::string_view backend) {
  const auto it = std::ranges::find(step.rows, backend, &MemoryRow::backend);
  return it == step.rows.end() ? nullptr : &*it;
}

std::size_t bytesOf(const MemoryStep& step, std::string_view backend) {
  const MemoryRow* row = rowNamed(step, backend);
  return row != nullptr ? row->bytes : 0;
}

std::string ratio(std::size_t large, std::size_t small) {
  if (small == 0) return "-";
  const double r = static_cast<double>(large) / static_cast<double>(small);
  return r < 9.95 ? fmt::format("{:.1f}", r) : grouped(static_cast<std::uint64_t>(std::llround(r)));
}

std::string lead(const MemoryLog& log) {
  const MemoryStep& last = log.steps.back();
  const std::size_t ours = bytesOf(last, "strokes");
  return fmt::format(
      "<p class=lead>After {} strokes ({} stamps), <span class=ours>{} bytes</span> are enough to undo, "
      "redo, branch and "
      "retarget everything. Snapshots of the primitive list take {} times as much, compressed surfel deltas "
      "{} times, "
      "snapshots of the surfels {} times.</p>\n",
      log.strokes, grouped(log.stamps), grouped(ours), ratio(bytesOf(last, "list-snapshots"), ours),
      ratio(bytesOf(last, "surfel-deltas-zstd"), ours), ratio(bytesOf(last, "surfel-snapshots"), ours));
}

/// Table 2 with our own figures in it.
std::string paperSection(const MemoryLog& log) {
  std::string html =
      "<h2>The paper’s Table 2</h2>\n"
      "<p>Eight strokes of 454, 1, 1, 1, 1, 1, 96 and 1 stamps. The printed figures decode exactly: a stroke "
      "of "
      "<i>n</i> stamps costs 304 + 12 <i>n</i> bytes, a snapshot 48 bytes for every primitive so far. Ours "
      "are measured: the "
      "capacity of every container that holds history, the tree included.</p>\n"
      "<div class=wide><table>\n<tr><th class=blank></th><th class=blank></th><th class=group "
      "colspan=3>strokes</th>"
      "<th class=group colspan=3>snapshots of the list</th></tr>\n"
      "<tr><th>step</th><th>stamps</th><th>printed</th><th>304 + 12 n</th><th class=ours>ours</th>"
      "<th>printed</th><th>48 n, summed</th><th>ours</th></tr>\n";
  for (const MemoryStep& step : log.steps) {
    if (step.step == 0) continue;
    html += fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{}</td><td class=counted>{}</td><td class=ours>{}</td><td>{}</td>"
        "<td class=counted>{}</td><td>{}</td></tr>\n",
        step.step, step.stamps, grouped(bytesOf(step, "strokes-table2")),
        grouped(bytesOf(step, "strokes-paper")), grouped(bytesOf(step, "strokes")),
        grouped(bytesOf(step, "list-snapshots-table2")), grouped(bytesOf(step, "list-snapshots-paper")),
        grouped(bytesOf(step, "list-snapshots")));
  }
  std::size_t above = 0;
  for (const MemoryStep& step : log.steps)
    if (step.step > 0 && bytesOf(step, "strokes") >= bytesOf(step, "strokes-table2")) ++above;
  html += "</table></div>\n";
  html += above == 0
              ? "<p>Ours are below the printed figure for strokes at every step.</p>\n"
              : fmt::format("<p>At {} of the steps ours are not below the printed figure for strokes.</p>\n",
                            above);
  return html +
         "<p class=note>R. Takeuchi, T. Watanabe, M. Kakimoto, K. Mikami, K. Kondo: Stroke history "
         "management for digital sculpting. Section 4, Table 2 and figure 12.</p>\n";
}

std::string stepsTable(const MemoryLog& log) {
  std::string html = "<div class=wide><table>\n<tr><th>step</th><th>stamps</th><th>surfels</th>";
  for (const MemoryRow& row : log.steps.front().rows)
    if (row.measured)
      html +=
          fmt::format("<th{}>{}</th>", row.backend == "strokes" ? " class=ours" : "", escapeHtml(row.title));
  html += "</tr>\n";
  for (const std::size_t i : thinned(log.steps.size(), kReportRows)) {
    const MemoryStep& step = log.steps[i];
    html += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td>",
                        step.step == 0 ? "start" : std::to_string(step.step), grouped(step.stamps),
                        grouped(step.surfels));
    for (const MemoryRow& row : step.rows)
      if (row.measured)
        html +=
            fmt::format("<td{}>{}</td>", row.backend == "strokes" ? " class=ours" : "", grouped(row.bytes));
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

/// The hypothesis, held against this log.
std::string verdict(const MemoryLog& log) {
  std::size_t from = log.steps.size();  // the first of the last steps at all of which strokes are smallest
  while (from > 1) {
    const MemoryStep& step = log.steps[from - 1];
    const bool smallest = std::ranges::all_of(step.rows, [&](const MemoryRow& row) {
      return !row.measured || row.backend == "strokes" || row.bytes > bytesOf(step, "strokes");
    });
    if (!smallest) break;
    --from;
  }
  if (log.steps.size() < 2) return {};
  if (from == 1) return "<p>Strokes are the smallest history at every step.</p>\n";
  if (from == log.steps.size()) return "<p>Strokes are not the smallest history at the last step.</p>\n";
  return fmt::format("<p>Strokes are the smallest history from step {} on.</p>\n", from);
}

std::string abilitiesTable(const MemoryLog& log) {
  const auto mark = [](bool able) { return able ? "yes" : "–"; };
  std::string html =
      "<h2>What each can do</h2>\n<div class=wide><table class=left>\n<tr><th>history</th><th "
      "class=able>undo in order</th>"
      "<th class=able>undo anywhere</th><th class=able>branch</th><th class=able>retarget</th><th>bytes at "
      "the end</th><th>times ours</th></tr>\n";
  const MemoryStep& last = log.steps.back();
  for (const MemoryRow& row : last.rows) {
    if (!row.measured) continue;
    html += fmt::format(
        "<tr><td{}>{}</td><td class=able>{}</td><td class=able>{}</td><td class=able>{}</td>"
        "<td class=able>{}</td><td>{}</td><td>{}</td></tr>\n",
        row.backend == "strokes" ? " class=ours" : "", escapeHtml(row.title), mark(row.abilities.undoInOrder),
        mark(row.abilities.undoAnywhere), mark(row.abilities.branch), mark(row.abilities.retarget),
        grouped(row.bytes), ratio(row.bytes, bytesOf(last, "strokes")));
  }
  return html + fmt::format(
                    "</table></div>\n<p class=note>Log {}. Undo anywhere: take out a step in the middle, the "
                    "later ones stay. "
                    "Branch: what lies ahead is kept when a stroke is drawn after an undo. Retarget: a step "
                    "can be applied again "
                    "to another shape. The column says what the stored data suffices for.</p>\n",
                    escapeHtml(log.name));
}

std::string logSection(const MemoryLog& log, const LogImages& images) {
  std::string html = fmt::format(
      "<h2>{}</h2>\n<p>{} strokes, {} stamps, {} surfels at the end, {} samples per square unit.{}</p>\n",
      escapeHtml(log.name), log.strokes, grouped(log.stamps), grouped(log.steps.back().surfels),
      log.density < 1 ? fmt::to_string(log.density)
                      : grouped(static_cast<std::uint64_t>(std::llround(log.density))),
      log.walked == 0
          ? ""
          : fmt::format(
                " Every history was then walked {} steps back and forth at random, and each restored the "
                "same states, bit for bit.",
                log.walked));
  if (!log.pictures.empty()) {
    html += "<div class=pictures>\n";
    for (std::size_t i = 0; i < log.pictures.size(); ++i)
      html += fmt::format(
          "<figure><img alt=\"The shape after step {0}\" src=\"{1}\"><figcaption>after step "
          "{0}</figcaption></figure>\n",
          log.pictures[i].step, dataUri("image/png", images.pngs.at(i)));
    html += "</div>\n";
  }
  html += "<h3>Bytes held after each step</h3>\n" + stepsTable(log) + verdict(log);
  html += figureHtml(
      images.linearSvg,
      "Strokes and snapshots of the list, as in the paper’s figure 12; dashed: by the paper’s arithmetic.");
  html += figureHtml(images.logarithmicSvg, "All histories on a logarithmic scale.");
  return html;
}

}  // namespace

std::string memoryReport(const std::vector<MemoryLog>& logs, const std::vector<LogImages>& images,
                         const Setup& setup, const Provenance& origin) {
  const auto paper = std::ranges::find_if(logs, &MemoryLog::paperTable2);
  // The log with the most strokes says most about what histories cost.
  const MemoryLog& largest = *std::ranges::max_element(logs, {}, &MemoryLog::strokes);
  std::string html = pageHead("What undo costs in memory") + lead(largest);
  html +=
      "<p>The same strokes go into every history. After each step the bytes that it holds to undo are "
      "counted, from the real "
      "capacity of its containers; the current shape, which any editor holds to show it at all, is not part "
      "of them.</p>\n";
  if (paper != logs.end()) html += paperSection(*paper);
  html += abilitiesTable(largest);
  for (std::size_t i = 0; i < logs.size(); ++i) html += logSection(logs[i], images.at(i));
  std::vector<std::pair<std::string, std::string>> inputs;
  for (const MemoryLog& log : logs) inputs.emplace_back(log.file.filename().string(), log.hash);
  html += originSection(setup, origin, inputs);
  return html.append(pageEnd());
}

}  // namespace restroke::experiments
