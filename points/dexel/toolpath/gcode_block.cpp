#include "points/dexel/toolpath/gcode_block.h"

#include <optional>

namespace restroke::points {

namespace {

bool isDigit(char c) {
  return c >= '0' && c <= '9';
}

// What is left of a line without blanks and comments, in capitals.
std::string bareOf(std::string_view text, const std::filesystem::path& name, std::size_t line) {
  std::string bare;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == ';') break;
    if (c == '(') {
      const std::size_t end = text.find(')', i);
      if (end == std::string_view::npos)
        refuseGcode(name, line, "a comment begins with ( and does not end; it must end with ) in its line");
      i = end;
    } else if (c != ' ' && c != '\t') {
      bare += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    }
  }
  return bare;
}

std::vector<GcodeWord> wordsOf(const std::string& bare, const std::filesystem::path& name, std::size_t line) {
  std::vector<GcodeWord> words;
  for (std::size_t i = 0; i < bare.size();) {
    const std::size_t begin = i;
    const char letter = bare[i++];
    if (letter == '#' || letter == '[' || (i < bare.size() && (bare[i] == '#' || bare[i] == '[')))
      refuseGcode(name, line,
                  fmt::format("\"{}\": parameters and expressions are not understood; a word must be a "
                              "letter and a number",
                              bare.substr(begin, 12)));
    if (letter < 'A' || letter > 'Z')
      refuseGcode(name, line,
                  fmt::format("\"{}\" is no word; it must be a letter and a number", bare.substr(begin, 12)));
    const std::size_t number = i;
    if (i < bare.size() && (bare[i] == '+' || bare[i] == '-')) ++i;
    while (i < bare.size() && (isDigit(bare[i]) || bare[i] == '.')) ++i;
    const std::optional<double> value =
        formats::parseDouble(std::string_view(bare).substr(number, i - number));
    if (!value)
      refuseGcode(name, line,
                  fmt::format("the letter {} is followed by \"{}\"; it must be followed by a number", letter,
                              bare.substr(number, 12)));
    if (letter != 'N') words.push_back({letter, *value, bare.substr(begin, i - begin)});
  }
  return words;
}

}  // namespace

void refuseGcode(const std::filesystem::path& name, std::size_t line, const std::string& what) {
  formats::refuse({{}, name}, fmt::format("line {}", line), what);
}

bool GcodeReader::next(GcodeBlock& block) {
  while (text_.nextLine()) {
    const std::string bare = bareOf(text_.restOfLine(), name_, text_.lineNumber());
    if (bare.empty() || bare.front() == '/') continue;
    block.line = text_.lineNumber();
    block.isPercent = bare.front() == '%';
    block.words = block.isPercent ? std::vector<GcodeWord>{} : wordsOf(bare, name_, block.line);
    if (block.isPercent || !block.words.empty()) return true;
  }
  return false;
}

}  // namespace restroke::points
