#include "experiments/page.h"

#include <fmt/format.h>

#include "experiments/text.h"

namespace restroke::experiments {
namespace {

// Print and screen alike: black on white, a serif to read and tabular figures to compare.
constexpr std::string_view kStyle = R"css(
:root { color-scheme: light; --ink: #1c1c1c; --soft: #666; --rule: #d8d4cc; --ours: #b3261e; --rival: #1f5fa8; }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 3rem 1.5rem 4rem; max-width: 62rem; background: #fff; color: var(--ink);
       font: 17px/1.55 Charter, "Bitstream Charter", "Source Serif 4", Georgia, "DejaVu Serif", serif; }
h1 { font-size: 2rem; line-height: 1.2; margin: 0 0 .4rem; font-weight: 600; }
h2 { font-size: 1.35rem; margin: 3rem 0 .6rem; padding-top: 1rem; border-top: 1px solid var(--rule); font-weight: 600; }
h3 { font-size: 1.05rem; margin: 2rem 0 .5rem; font-weight: 600; }
p { max-width: 44rem; margin: .6rem 0; }
.lead { color: #333; font-size: 1.12rem; }
table { border-collapse: collapse; margin: .9rem 0 .4rem; font: 14px/1.35 system-ui, "DejaVu Sans", "Liberation Sans", sans-serif;
        font-variant-numeric: tabular-nums; }
th, td { padding: .28rem .75rem; text-align: right; white-space: nowrap; }
th { font-weight: 600; border-bottom: 1.5px solid #444; vertical-align: bottom; white-space: normal; max-width: 8.5rem; }
th.group { text-align: center; border-bottom: 1px solid var(--rule); color: var(--soft); max-width: none; }
th.blank { border-bottom: none; }
td { border-bottom: 1px solid #eeebe5; }
tr:last-child td { border-bottom: 1.5px solid #444; }
td:first-child, th:first-child { padding-left: .2rem; }
.left td:first-child, .left th:first-child { text-align: left; }
.left .able { text-align: center; }
.ours { color: var(--ours); font-weight: 600; }
.counted { color: var(--soft); font-weight: 400; }
.note, figcaption { color: var(--soft); font: 13.5px/1.45 system-ui, "DejaVu Sans", "Liberation Sans", sans-serif; max-width: 44rem; }
.wide { overflow-x: auto; }
figure { margin: 1.2rem 0; break-inside: avoid; }
figure img { display: block; width: 100%; max-width: 52rem; height: auto; }
.pictures { display: grid; grid-template-columns: repeat(auto-fit, minmax(12rem, 1fr)); gap: 1rem; margin: 1.2rem 0; }
.pictures figure { margin: 0; }
.pictures img { width: 100%; border: 1px solid var(--rule); border-radius: 3px; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .2rem 1.2rem; margin: .8rem 0;
     font: 13.5px/1.45 system-ui, "DejaVu Sans", "Liberation Sans", sans-serif; }
dt { color: var(--soft); } dd { margin: 0; overflow-wrap: anywhere; }
@media print {
  @page { margin: 16mm; }
  body { max-width: none; padding: 0; font-size: 10.5pt; }
  table { font-size: 8pt; } th, td { padding: .15rem .4rem; }
  h2, h3 { break-after: avoid; } table { break-inside: avoid; } .wide { overflow: visible; } h2 { margin-top: 1.6rem; }
  figure img { max-width: 150mm; }
  .pictures { grid-template-columns: repeat(4, 1fr); gap: 3mm; }
}
)css";

}  // namespace

std::string pageHead(std::string_view title) {
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=en>\n<head>\n<meta charset=utf-8>\n"
      "<meta name=viewport content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n<style>",
      escapeHtml(title));
  html += kStyle;
  return html + fmt::format("</style>\n</head>\n<body>\n<h1>{}</h1>\n", escapeHtml(title));
}

std::string_view pageEnd() {
  return "</body>\n</html>\n";
}

std::string dataUri(std::string_view type, std::string_view bytes) {
  return fmt::format("data:{};base64,{}", type, base64(bytes));
}

std::string figureHtml(std::string_view svg, std::string_view caption) {
  if (svg.empty()) return {};
  return fmt::format("<figure><img alt=\"{}\" src=\"{}\"><figcaption>{}</figcaption></figure>\n",
                     escapeHtml(caption), dataUri("image/svg+xml", svg), escapeHtml(caption));
}

std::string claimsSection(std::span<const Claim> claims) {
  std::string html =
      "<h2>Promised and measured</h2>\n<div class=wide><table class=left>\n<tr><th>promised</th><th "
      "class=able>holds</th><th class=able>measured</th></tr>\n";
  for (const Claim& claim : claims)
    html += fmt::format(
        "<tr><td style=\"white-space:normal\">{}</td><td class=able>{}</td><td "
        "style=\"white-space:normal\">{}</td></tr>\n",
        escapeHtml(claim.text), claim.holds ? (*claim.holds ? "yes" : "<b>no</b>") : "not tried",
        escapeHtml(claim.measured));
  return html + "</table></div>\n";
}

std::string originSection(const Setup& setup, const Provenance& p,
                          std::span<const std::pair<std::string, std::string>> inputs) {
  std::string html = "<h2>Where this comes from</h2>\n<dl>\n";
  const auto entry = [&](std::string_view name, const std::string& value) {
    html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", name, escapeHtml(value));
  };
  entry("revision", p.revision + (p.dirty ? ", with changes that are not committed" : ""));
  entry("compiler", p.compiler);
  entry("flags", p.flags);
  entry("machine", fmt::format("{}, {} processors, {}", p.cpu, p.processors, p.system));
  entry("options", fmt::format("{} (XXH3 {})", setup.options, hexHash(setup.options)));
  for (const auto& [file, hash] : inputs) entry("input", fmt::format("{}, XXH3 {}", file, hash));
  return html + "</dl>\n";
}

}  // namespace restroke::experiments
