#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <system_error>

#include "points/files/mesh_formats.h"

namespace restroke::points::formats {
namespace {

constexpr std::string_view kBlanks = " \t\f\v";

/// std::from_chars takes no plus sign.
std::string_view withoutPlus(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+') word.remove_prefix(1);
  return word;
}

template <class Number>
std::string shortestOf(Number value) {
  std::array<char, 40> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

/// Of a number that is out of a double's range: is it too small rather than too large?
bool isTiny(std::string_view number) {
  const std::size_t exponent = number.find_first_of("eE");
  if (exponent != std::string_view::npos) return number.substr(exponent + 1).starts_with('-');
  return number.find_first_of("123456789") > number.find('.');
}

/// A word from a file, fit to be shown: short, printable.
std::string shown(std::string_view word) {
  constexpr std::size_t kLongest = 40;
  std::string text;
  for (const char c : word.substr(0, kLongest)) text += c >= ' ' && c <= '~' ? c : '?';
  return word.size() > kLongest ? text + "..." : text;
}

}  // namespace

void refuse(const Source& source, const std::string& place, std::string what) {
  // What comes from a file may hold anything; a sentence is one line.
  for (char& c : what)
    if ((c >= 0 && c < ' ') || c == 127) c = '?';
  const std::string name = source.name.string();
  throw InputError(place.empty() ? fmt::format("{}: {}", name, what)
                                 : fmt::format("{}: {}: {}", name, place, what));
}

std::string contentsOf(const std::filesystem::path& path, const char* wanted) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (fs::is_directory(path, error))
    throw InputError(fmt::format("{}: is a folder; {} is needed", path.string(), wanted));
  // A device may never end.
  if (const auto status = fs::status(path, error); fs::is_character_file(status) || fs::is_block_file(status))
    throw InputError(fmt::format("{}: is a device; {} is needed", path.string(), wanted));
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in)
    throw InputError(fmt::format("{}: cannot read this file: {}", path.string(),
                                 std::generic_category().message(errno != 0 ? errno : EIO)));
  std::string contents(std::istreambuf_iterator<char>(in), {});
  if (in.bad()) throw InputError(fmt::format("{}: cannot read this file: input/output error", path.string()));
  return contents;
}

std::optional<double> parseDouble(std::string_view word) {
  word = withoutPlus(word);
  const char *const begin = word.data(), *const end = begin + word.size();
  double value = 0;
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (stop != end || begin == end) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    if (!isTiny(word)) return std::nullopt;
    value = 0;
  }
  if (!std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<float> parseFloat(std::string_view word) {
  word = withoutPlus(word);
  const char *const begin = word.data(), *const end = begin + word.size();
  float value = 0;
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (stop != end || begin == end) return std::nullopt;
  // Libraries differ in whether a number that is too small is out of range. The nearest float is 0, or what
  // a double says.
  if (double wide = 0; error == std::errc::result_out_of_range) {
    if (std::from_chars(begin, end, wide).ec == std::errc())
      value = static_cast<float>(wide);
    else if (isTiny(word))
      value = 0;
    else
      return std::nullopt;
  }
  if (!std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parseInteger(std::string_view word) {
  word = withoutPlus(word);
  const char *const begin = word.data(), *const end = begin + word.size();
  std::int64_t value = 0;
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (begin == end || stop != end || error != std::errc()) return std::nullopt;
  return value;
}

std::string shortest(float value) {
  return shortestOf(value);
}
std::string shortest(double value) {
  return shortestOf(value);
}

std::string lowered(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

const char* nameOf(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::Millimetre:
      return "millimeter";
    case LengthUnit::Centimetre:
      return "centimeter";
    case LengthUnit::Metre:
      return "meter";
  }
  throw InternalError("a length unit that is none");
}

bool TextCursor::nextLine() {
  if (next_ >= source_.bytes.size()) {
    line_ = {};
    return false;
  }
  const std::size_t end = source_.bytes.find_first_of("\r\n", next_);
  line_ = source_.bytes.substr(next_, end == std::string_view::npos ? end : end - next_);
  if (end == std::string_view::npos)
    next_ = source_.bytes.size();
  else
    next_ = end + (source_.bytes.substr(end, 2) == "\r\n" ? 2 : 1);
  ++number_;
  if (comment_ != 0) line_ = line_.substr(0, line_.find(comment_));
  return true;
}

bool TextCursor::nextFilledLine() {
  while (nextLine())
    if (line_.find_first_not_of(kBlanks) != std::string_view::npos) return true;
  return false;
}

std::string_view TextCursor::wordOfLine() {
  const std::size_t begin = line_.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) {
    line_ = {};
    return {};
  }
  const std::size_t end = line_.find_first_of(kBlanks, begin);
  const std::string_view word =
      line_.substr(begin, end == std::string_view::npos ? std::string_view::npos : end - begin);
  line_ = end == std::string_view::npos ? std::string_view() : line_.substr(end);
  return word;
}

std::string_view TextCursor::word() {
  for (;;) {
    if (const std::string_view found = wordOfLine(); !found.empty()) return found;
    if (!nextLine()) return {};
  }
}

std::string_view TextCursor::restOfLine() {
  const std::string_view rest = line_;
  line_ = {};
  return rest;
}

std::string TextCursor::place() const {
  return fmt::format("line {}", number_);
}

float TextCursor::coordinate(std::string_view word) const {
  if (word.empty()) refuseHere("a coordinate is missing; a vertex has three");
  const auto value = parseFloat(word);
  if (!value)
    refuseHere(fmt::format("the coordinate is \"{}\"; coordinates are finite float32 numbers", shown(word)));
  return *value;
}

double TextCursor::number(std::string_view word, const char* what) const {
  const auto value = parseDouble(word);
  if (!value) refuseHere(fmt::format("{} is \"{}\"; it has to be finite", what, shown(word)));
  return *value;
}

std::int64_t TextCursor::integer(std::string_view word, const char* what) const {
  if (word.empty()) refuseHere(fmt::format("{} is missing", what));
  const auto value = parseInteger(word);
  if (!value) refuseHere(fmt::format("{} is \"{}\"; it has to be an integer", what, shown(word)));
  return *value;
}

}  // namespace restroke::points::formats
