#include "experiments/retarget/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "experiments/page.h"
#include "experiments/retarget/summary.h"
#include "experiments/text.h"

namespace restroke::experiments {
namespace {

using retarget::Method;

std::string percent(double part) {
  if (!std::isfinite(part)) return "lost";
  const double p = 100 * part;
  if (p == 0) return "0";
  if (p < 0.001) return fmt::format("{:.0e}", p);
  return p < 0.1 ? fmt::format("{:.3f}", p) : p < 10 ? fmt::format("{:.2f}", p) : fmt::format("{:.0f}", p);
}

std::string strengthText(double strength) {
  return fmt::format("{:g}", strength);
}

/// The first group that has results; bases that tell their motion say more.
const char* mainGroup(const RetargetResults& results) {
  for (const RetargetSubject& s : results.subjects)
    if (s.tellsMotion) return kTelling;
  return kSymmetric;
}

std::vector<double> strengthsOf(const RetargetResults& results, ChangeKind kind) {
  std::vector<double> strengths;
  for (const RetargetCase& c : results.cases)
    if (c.kind == kind && std::ranges::find(strengths, c.strength) == strengths.end())
      strengths.push_back(c.strength);
  std::ranges::sort(strengths);
  return strengths;
}

// A method that loses more of the strokes' length than this is not the one to use.
constexpr double kUsableLost = 0.25;
// `exact` stands for all that cast. `mapped` needs to be told the map, and `surface` to know the same
// primitive, or the same triangles, in their new place: they are named apart.
constexpr std::array kRivals{Method::Exact, Method::Aligned, Method::Nearest, Method::Fixed};

/// The method with the least median error of those that know nothing but the two shapes; nearly equal ones
/// count as equal, and then the first of kRivals is taken.
const RetargetSummary* bestOf(const std::vector<RetargetSummary>& all, SummaryKey key) {
  const RetargetSummary* best = nullptr;
  for (const Method method : kRivals) {
    key.method = method;
    const RetargetSummary* each = find(all, key);
    if (each == nullptr || !(each->lost <= kUsableLost) || !std::isfinite(each->medianRms)) continue;
    if (best == nullptr || each->medianRms < 0.9 * best->medianRms) best = each;
  }
  return best;
}

std::string adviceFor(const RetargetResults& results, const std::vector<RetargetSummary>& all,
                      const char* group, ChangeKind kind) {
  struct Stretch {
    Method method;
    double first, last, least, most;
  };
  std::vector<Stretch> stretches;
  std::size_t strengths = 0;
  for (const double strength : strengthsOf(results, kind)) {
    const RetargetSummary* best = bestOf(all, {group, kind, strength, Method::Exact});
    if (best == nullptr) continue;
    ++strengths;
    if (stretches.empty() || stretches.back().method != best->method)
      stretches.push_back({best->method, strength, strength, best->medianRms, best->medianRms});
    Stretch& s = stretches.back();
    s.last = strength;
    s.least = std::min(s.least, best->medianRms);
    s.most = std::max(s.most, best->medianRms);
  }
  if (stretches.empty()) return {};
  std::string text;
  for (const Stretch& s : stretches) {
    const std::string range = stretches.size() == 1 && strengths > 1 ? "at every strength"
                              : s.first == s.last
                                  ? "at " + strengthText(s.first)
                                  : fmt::format("from {} to {}", strengthText(s.first), strengthText(s.last));
    text += fmt::format("{}{} {} (median error {}{} % of the stroke’s length)", text.empty() ? "" : ", ",
                        retarget::nameOf(s.method), range, percent(s.least),
                        percent(s.least) == percent(s.most) ? "" : " to " + percent(s.most));
  }
  const double strongest = strengthsOf(results, kind).back();
  if (const RetargetSummary* exact = find(all, {group, kind, strongest, Method::Exact});
      exact != nullptr && stretches.back().method != Method::Exact)
    text += std::isfinite(exact->medianRms)
                ? fmt::format("; at {} casting misses by {} %", strengthText(strongest),
                              percent(exact->medianRms)) +
                      (exact->lost > 0.05 ? fmt::format(" and loses {:.0f} %", 100 * exact->lost) : "")
                : fmt::format("; at {} casting loses the strokes", strengthText(strongest));
  if (const RetargetSummary* mapped = find(all, {group, kind, strongest, Method::Mapped}))
    text += fmt::format("; told the map, mapped errs by {} %", percent(mapped->medianRms));
  if (const RetargetSummary* surface = find(all, {group, kind, strongest, Method::Surface}))
    text +=
        fmt::format("; where the same primitive or the same triangles are still there, surface errs by {} %",
                    percent(surface->medianRms));
  return text + ".";
}

std::string leadOf(const RetargetResults& results, const std::vector<RetargetSummary>& all) {
  std::size_t strokes = 0;
  for (const RetargetSubject& s : results.subjects) strokes += s.strokes;
  std::string html = fmt::format(
      "<p class=lead>{} strokes on {} bases, {} changes with known truth, {} trials of {} methods.",
      grouped(strokes), results.subjects.size(), grouped(results.cases.size()),
      grouped(results.trials.size()), results.methods.size());
  const double strongest =
      strengthsOf(results, ChangeKind::Motion).empty() ? 0 : strengthsOf(results, ChangeKind::Motion).back();
  const auto* aligned = find(all, {kTelling, ChangeKind::Motion, strongest, Method::Aligned});
  const auto* fixed = find(all, {kTelling, ChangeKind::Motion, strongest, Method::Fixed});
  const auto* exact = find(all, {kTelling, ChangeKind::Motion, strongest, Method::Exact});
  if (aligned != nullptr && fixed != nullptr && exact != nullptr)
    html += fmt::format(
        " When a shape was moved, turned and scaled at once, <span class=ours>aligned</span> puts half of "
        "the strokes "
        "within {} % of their length of where they belong; left in place they miss by {} %, and plain "
        "casting {}.",
        percent(aligned->medianRms), percent(fixed->medianRms),
        std::isfinite(exact->medianRms) ? fmt::format("by {} % of what it still finds, {:.0f} % being lost",
                                                      percent(exact->medianRms), 100 * exact->lost)
                                        : "loses them");
  return html + "</p>\n";
}

std::string adviceSection(const RetargetResults& results) {
  std::string html = "<h2>Which method when</h2>\n<ul>\n";
  for (const std::string& sentence : adviceOf(results))
    html += fmt::format("<li>{}</li>\n", escapeHtml(sentence));
  return html +
         fmt::format(
             "</ul>\n<p class=note>By the least median error over the bases that tell their motion, among "
             "methods "
             "that know the two shapes alone; exact stands for all that cast (embree, depth). A method that "
             "loses "
             "more than {:.0f} % of the places is passed over, and one within 10 % of another counts as its "
             "equal.</p>\n",
             100 * kUsableLost);
}

std::string kindTable(const RetargetResults& results, const std::vector<RetargetSummary>& all,
                      const char* group, ChangeKind kind) {
  std::string html = fmt::format("<div class=wide><table>\n<tr><th>{}</th>", infoOf(kind).unit);
  for (const Method method : results.methods)
    html += fmt::format("<th{}>{}</th>", method == Method::Aligned ? " class=ours" : "",
                        retarget::nameOf(method));
  html += "</tr>\n";
  for (const double strength : strengthsOf(results, kind)) {
    std::string cells;
    for (const Method method : results.methods) {
      const RetargetSummary* s = find(all, {group, kind, strength, method});
      if (s == nullptr) {
        cells += "<td></td>";
        continue;
      }
      cells += fmt::format(
          "<td{}>{}{}</td>", method == Method::Aligned ? " class=ours" : "", percent(s->medianRms),
          s->lost > 0.05 ? fmt::format(" <span class=counted>−{:.0f}</span>", 100 * s->lost) : "");
    }
    html += fmt::format("<tr><td>{}</td>{}</tr>\n", strengthText(strength), cells);
  }
  return html + "</table></div>\n";
}

std::string kindSections(const RetargetResults& results, const std::vector<RetargetSummary>& all) {
  std::string html =
      "<h2>Every method, every change</h2>\n<p>Median RMS error in per cent of the stroke’s length; behind "
      "it, in grey, "
      "how many per cent of the points were lost where that is more than 5.</p>\n";
  bool telling = false, symmetric = false;
  for (const RetargetSubject& s : results.subjects) (s.tellsMotion ? telling : symmetric) = true;
  for (const ChangeInfo& info : changeKinds()) {
    if (strengthsOf(results, info.kind).empty()) continue;
    html += fmt::format("<h3>{}: {}</h3>\n", info.name, info.meaning);
    if (telling) html += kindTable(results, all, kTelling, info.kind);
    if (symmetric)
      html += "<p class=note>Bases that hide motions by their symmetry:</p>\n" +
              kindTable(results, all, kSymmetric, info.kind);
  }
  return html;
}

std::string baseSection(const RetargetResults& results) {
  std::string html =
      "<h2>Bases, and what the alignment said of them</h2>\n<div class=wide><table "
      "class=left>\n<tr><th>base</th>"
      "<th>tells its motion</th><th>strokes</th><th>beside it</th><th>surfels</th><th>farthest that a fine "
      "mesh is from "
      "the image</th><th class=able>motions</th><th class=able>other changes</th></tr>\n";
  for (std::size_t i = 0; i < results.subjects.size(); ++i) {
    const RetargetSubject& s = results.subjects[i];
    std::map<std::string, std::size_t> motions, others;
    double chord = 0;
    for (const RetargetCase& c : results.cases) {
      if (c.subject != i) continue;
      ++(isSimilarity(c.kind) ? motions : others)[c.verdict];
      chord = std::max(chord, c.chordError);
    }
    const auto counts = [](const std::map<std::string, std::size_t>& verdicts) {
      std::string text;
      for (const auto& [verdict, count] : verdicts)
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", verdict, count);
      return text;
    };
    html += fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.0e}</td><td class=able>{}</td>"
        "<td class=able>{}</td></tr>\n",
        escapeHtml(s.name), s.tellsMotion ? "yes" : "no", s.strokes, s.beside, grouped(s.surfels), chord,
        counts(motions), counts(others));
  }
  return html +
         "</table></div>\n<p class=note>The truth of a stroke point is its image under the map. A base under "
         "a motion "
         "is the same base in another pose; a sphere, an ellipsoid or a superellipsoid that is stretched "
         "along its axes "
         "is one of the same kind; a mesh under an affine map is a mesh: these images are exact but for the "
         "rounding of "
         "their parameters to float32. All other images are fine meshes, and the table says how far, as a "
         "part of the "
         "base’s size, they are from the image at most. Every stroke is drawn on the bare base, not on the "
         "strokes before "
         "it. Strokes that hardly touch the base are left out.</p>\n";
}

std::string pictureRows(const RetargetResults& results, const ReportImages& images, std::size_t from,
                        std::size_t to) {
  std::string html;
  for (std::size_t r = from; r < to; ++r) {
    const RetargetPictures& row = results.pictures[r];
    html += fmt::format(
        "<h3>{}</h3>\n<div class=pictures style=\"grid-template-columns:repeat({},1fr);gap:.4rem\">\n",
        escapeHtml(row.caption), row.pictures.size());
    for (std::size_t i = 0; i < row.pictures.size(); ++i)
      html += fmt::format("<figure><img alt=\"{0}, {1}\" src=\"{2}\"><figcaption>{1}</figcaption></figure>\n",
                          escapeHtml(row.caption), escapeHtml(row.pictures[i].first),
                          dataUri("image/png", images.rows.at(r).at(i)));
    html += "</div>\n";
  }
  return html;
}

std::string worseSection(const RetargetResults& results, const ReportImages& images) {
  std::string html = "<h2>Where aligned is worse than plain casting</h2>\n";
  const std::vector<WorseCase> worse = whereAlignedIsWorse(results);
  if (worse.empty()) return html + "<p>Nowhere among the changes that were tried.</p>\n";
  html += fmt::format(
      "<p>{} of {} changes of bases, by more than a quarter and by more than 0.2 % of the stroke’s length. "
      "The largest "
      "differences:</p>\n<div class=wide><table class=left>\n<tr><th>base</th><th "
      "class=able>change</th><th>aligned, "
      "%</th><th>exact, %</th></tr>\n",
      worse.size(), results.cases.size());
  constexpr std::size_t kListed = 12;
  for (std::size_t i = 0; i < std::min(kListed, worse.size()); ++i)
    html += fmt::format("<tr><td>{}</td><td class=able>{} {}</td><td>{}</td><td>{}</td></tr>\n",
                        escapeHtml(results.subjects[worse[i].subject].name), infoOf(worse[i].kind).name,
                        strengthText(worse[i].strength), percent(worse[i].aligned), percent(worse[i].exact));
  return html + "</table></div>\n" + pictureRows(results, images, results.worseFrom, results.pictures.size());
}

std::string editSection(const RetargetResults& results) {
  const std::vector<EditSummary> all = editSummaries(results);
  if (all.empty()) return {};
  std::string html =
      "<h2>Changes without a known truth</h2>\n<p>Whole logs, each stroke on what the ones before it made: a "
      "stroke "
      "cancelled, two strokes exchanged, another base of the same size. Counted are the strokes behind the "
      "change. Drift: "
      "how far on the screen what was found is from what the pen drew, seen from where it was drawn. mapped "
      "is left out: "
      "without a map it casts as exact does.</p>\n";
  for (const auto& [kind, title] : {std::pair{"cancel", "A stroke cancelled"},
                                    {"reorder", "Two strokes exchanged"},
                                    {"base", "Another base"}}) {
    std::string rows;
    for (const EditSummary& s : all)
      if (s.log == kAllLogs && s.kind == kind)
        rows += fmt::format(
            "<tr><td{}>{}</td><td>{}</td><td>{:.1e}</td><td>{:.2f}</td><td>{:.3f}</td><td>{:.1f}</td><td>{}</"
            "td></tr>\n",
            s.method == Method::Aligned ? " class=ours" : "", retarget::nameOf(s.method), s.strokes,
            s.surface, s.drift, s.stretch, 100 * s.lost,
            s.method == Method::Aligned ? std::to_string(s.fellBack) : "");
    if (!rows.empty())
      html += fmt::format(
          "<h3>{}</h3>\n<div class=wide><table class=left>\n<tr><th>method</th><th>strokes</th><th>off the "
          "surface, of "
          "the size</th><th>drift, pixels</th><th>length by the original’s</th><th>lost, %</th><th>cast as "
          "exact</th></tr>\n{}</table></div>\n",
          title, rows);
  }
  return html;
}

}  // namespace

std::vector<std::string> adviceOf(const RetargetResults& results) {
  const std::vector<RetargetSummary> all = summaries(results);
  std::vector<std::string> sentences;
  for (const ChangeInfo& info : changeKinds()) {
    if (strengthsOf(results, info.kind).empty()) continue;
    const std::string advice = adviceFor(results, all, mainGroup(results), info.kind);
    if (!advice.empty()) sentences.push_back(fmt::format("A base {}: {}", info.meaning, advice));
  }
  return sentences;
}

std::string retargetTable(const RetargetResults& results) {
  const std::vector<RetargetSummary> all = summaries(results);
  const char* group = mainGroup(results);
  std::vector<std::vector<std::string>> lines{{"change", "strength"}};
  for (const Method method : results.methods) lines.front().emplace_back(retarget::nameOf(method));
  for (const ChangeInfo& info : changeKinds())
    for (const double strength : strengthsOf(results, info.kind)) {
      std::vector<std::string> line{std::string(info.name), strengthText(strength)};
      for (const Method method : results.methods) {
        const RetargetSummary* s = find(all, {group, info.kind, strength, method});
        line.push_back(s == nullptr ? "" : percent(s->medianRms));
      }
      lines.push_back(std::move(line));
    }
  std::string text =
      fmt::format("Median RMS error in per cent of the stroke's length, bases that {} their motion:\n\n",
                  group == kTelling ? "tell" : "hide");
  text += alignedTable(lines, 1) + "\n";
  for (const Claim& claim : claims(results))
    text +=
        fmt::format("{}: {}: {}\n", claim.holds ? (*claim.holds ? "holds" : "DOES NOT HOLD") : "not tried",
                    claim.text, claim.measured);
  for (const std::string& note : results.notes) text += fmt::format("note: {}\n", note);
  return text;
}

std::string retargetReport(const RetargetResults& results, const ReportImages& images, const Setup& setup,
                           const Provenance& origin) {
  const std::vector<RetargetSummary> all = summaries(results);
  std::string html = pageHead("Where strokes go when the shape changes") + leadOf(results, all);
  html +=
      "<p>Strokes are drawn on a base; the base is changed by a map that is known; each method puts the "
      "strokes on what it "
      "has become, and is compared with where the map takes them. What is lost, and how far strokes are off "
      "the surface, "
      "is measured as well.</p>\n";
  html += adviceSection(results) + claimsSection(claims(results));
  html += figureHtml(images.tellingSvg,
                     "Median RMS error against the strength of the change, bases that tell their motion.");
  html += figureHtml(images.symmetricSvg, "The same for bases that hide motions by their symmetry.");
  html +=
      "<h2>Pictures</h2>\n<p>The original; then the changed base with the strokes left in place, and by each "
      "method. depth "
      "and embree look like exact.</p>\n" +
      pictureRows(results, images, 0, results.worseFrom);
  html += worseSection(results, images) + editSection(results) + kindSections(results, all) +
          baseSection(results);
  if (!results.notes.empty()) {
    html += "<h2>Left out</h2>\n<ul>\n";
    for (const std::string& note : results.notes) html += fmt::format("<li>{}</li>\n", escapeHtml(note));
    html += "</ul>\n";
  }
  html += originSection(setup, origin, results.inputs);
  return html.append(pageEnd());
}

}  // namespace restroke::experiments
