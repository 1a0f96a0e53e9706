#pragma once
// A line of a G-code program as words. Internal to points/dexel/toolpath.

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "points/files/mesh_formats.h"

namespace restroke::points {

struct GcodeWord {
  char letter = 0;  ///< A to Z
  double value = 0;
  std::string text;  ///< as it stands, without blanks, in capitals
};

/// One line of a program.
struct GcodeBlock {
  std::size_t line = 0;
  std::vector<GcodeWord> words;  ///< without N
  bool isPercent = false;        ///< a line that begins with %
};

/// Throws the InputError "<file>: line <n>: <what>".
[[noreturn]] void refuseGcode(const std::filesystem::path& name, std::size_t line, const std::string& what);

/// Walks through the lines of a program, but for empty ones and those that block delete leaves out. Numbers
/// are decimal, without exponents.
class GcodeReader {
 public:
  GcodeReader(std::string_view contents, const std::filesystem::path& name)
      : name_(name), source_{contents, name}, text_(source_) {}
  GcodeReader(const GcodeReader&) = delete;
  GcodeReader& operator=(const GcodeReader&) = delete;

  /// False at the end of the file. Throws InputError for what are no words.
  bool next(GcodeBlock& block);

 private:
  const std::filesystem::path& name_;
  formats::Source source_;
  formats::TextCursor text_;
};

}  // namespace restroke::points
