#include "sculpt/stamp_list.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <utility>

#include "implicit/errors.h"

namespace restroke::sculpt {

namespace {

// Hands out lines, and words of the line at hand.
class Lines {
 public:
  Lines(std::string_view text, std::string_view file) : rest_(text), file_(file) {}

  /// False at the end of the text; blank lines at the end count as the end.
  bool next() {
    if (rest_.find_first_not_of(" \t\r\n") == std::string_view::npos) return false;
    const std::size_t end = rest_.find('\n');
    line_ = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (line_.ends_with('\r')) line_.remove_suffix(1);
    words_ = line_;
    ++number_;
    return true;
  }
  [[nodiscard]] std::size_t number() const { return number_; }
  std::string_view word() {
    words_.remove_prefix(std::min(words_.find_first_not_of(" \t"), words_.size()));
    const std::string_view word = words_.substr(0, words_.find_first_of(" \t"));
    words_.remove_prefix(word.size());
    return word;
  }
  void requireEnd(std::string_view rule) {
    if (const std::string_view extra = word(); !extra.empty()) refuse(extra, rule);
  }
  [[noreturn]] void refuse(std::string_view found, std::string_view rule) const {
    std::string shown(found.substr(0, 40));
    for (char& c : shown)
      if ((c >= 0 && c < ' ') || c == 127) c = '?';
    throw InputError(fmt::format("{}:{}: found \"{}\", but must be {}", file_, number_, shown, rule));
  }
  [[noreturn]] void endsEarly(std::string_view rule) const {
    throw InputError(fmt::format("{}:{}: the list ends here, but must {}", file_, number_, rule));
  }

 private:
  std::string_view rest_, line_, words_;
  std::string_view file_;
  std::size_t number_ = 0;
};

float coordinateOf(Lines& lines, std::string_view word, std::string_view rule) {
  float value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || !(std::fabs(value) <= kMaxCoordinate))
    lines.refuse(word, rule);
  return value;
}

implicit::Sphere sphereOf(Lines& lines, std::string_view first) {
  static constexpr std::string_view kCoordinate = "x y z r, numbers within +-1e6";
  std::array<float, 4> values{};
  for (std::size_t i = 0; i < 4; ++i) {
    const std::string_view word = i == 0 && !first.empty() ? first : lines.word();
    values[i] = coordinateOf(lines, word, kCoordinate);
    if (i == 3 && !(values[3] > 0)) lines.refuse(word, "a radius more than 0");
  }
  lines.requireEnd("the end of the line after x y z r");
  return {{values[0], values[1], values[2]}, values[3]};
}

long long countOf(Lines& lines, std::string_view word, std::string_view rule) {
  long long value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) lines.refuse(word, rule);
  return value;
}

}  // namespace

float densityFor(const implicit::Shape& base) {
  constexpr double kSamples = 100'000;
  const double exact = kSamples / areaOf(base);
  double unit = 1;
  while (exact >= 100 * unit) unit *= 10;
  while (exact < 10 * unit) unit /= 10;
  return static_cast<float>(std::floor(exact / unit + 0.5) * unit);
}

StrokeLog parseStampList(std::string_view text, std::string_view file) {
  StrokeLog log;
  log.stampList = true;
  log.bytes = text.size();
  Lines lines(text, file);
  if (!lines.next())
    throw InputError(
        fmt::format("{}: is empty, but must begin with a log's header or a stamp list's B line", file));
  if (const std::string_view word = lines.word(); word != "B")
    lines.refuse(word, "B, which begins the line of the base sphere");
  log.header.base = sphereOf(lines, {});
  log.header.density = densityFor(log.header.base);
  while (lines.next()) {
    if (const std::string_view word = lines.word(); word != "S")
      lines.refuse(word, "S, which begins a stroke, or the end");
    FixedCommand fixed;
    const std::string_view sign = lines.word();
    if (sign != "1" && sign != "-1") lines.refuse(sign, "the sign 1 (adds) or -1 (carves)");
    fixed.mode = sign == "1" ? Mode::Add : Mode::Carve;
    const std::string_view word = lines.word();
    const long long count = countOf(lines, word, "a whole number of stamps");
    if (count < 1 || count > static_cast<long long>(kMaxStamps))
      lines.refuse(word, "a number of stamps from 1 to 1,000,000");
    lines.requireEnd("the end of the line after S sign count");
    log.lines.push_back(lines.number());
    for (long long i = 0; i < count; ++i) {
      if (!lines.next()) lines.endsEarly(fmt::format("give {} stamps of the stroke and has {}", count, i));
      fixed.stamps.push_back(sphereOf(lines, lines.word()));
    }
    log.commands.emplace_back(std::move(fixed));
  }
  return log;
}

}  // namespace restroke::sculpt
