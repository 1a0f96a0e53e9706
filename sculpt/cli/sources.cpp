#include "sculpt/cli/sources.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace restroke::cli {

namespace {

// A project is an object that has a workpiece; the first key of a log is "restroke".
bool isProject(std::ifstream& file) {
  constexpr std::size_t kMost = 1 << 20;
  std::string text(kMost, '\0');
  file.clear();
  file.seekg(0);
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  const std::size_t key = text.find('"');
  return key != std::string::npos && text.compare(key, 10, "\"restroke\"") != 0 &&
         text.find("\"workpiece\"") != std::string::npos;
}

}  // namespace

// A log begins with '{', a stamp list with the line of its base; so may the header of a binary STL file,
// which its size gives away. What is no plain file is left to the reader of logs, which reads pipes too.
SourceKind sourceKindOf(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return SourceKind::Log;
  constexpr std::size_t kStlHeader = 80, kStlTriangle = 50;
  constexpr std::string_view kTriDexel = "TRIDEXEL";
  std::array<char, kStlHeader + 4> first{};
  std::ifstream file(path, std::ios::binary);
  file.read(first.data(), first.size());
  if (file.gcount() == 0) return SourceKind::Log;
  if (std::string_view(first.data(), kTriDexel.size()) == kTriDexel) return SourceKind::TriDexel;
  if (first[0] != '{' && (first[0] != 'B' || (first[1] != ' ' && first[1] != '\t'))) return SourceKind::Mesh;
  std::uintmax_t triangles = 0;  // little endian
  for (std::size_t i = 4; i-- > 0;)
    triangles = triangles * 256 + static_cast<unsigned char>(first[kStlHeader + i]);
  const bool isStl = std::filesystem::file_size(path, error) == first.size() + kStlTriangle * triangles;
  if (isStl) return SourceKind::Mesh;
  return first[0] == '{' && isProject(file) ? SourceKind::Project : SourceKind::Log;
}

}  // namespace restroke::cli
