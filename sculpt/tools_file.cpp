#include "sculpt/tools_file.h"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "implicit/errors.h"
#include "sculpt/json_reader.h"
#include "sculpt/text_file.h"

namespace restroke::sculpt {

namespace {

using points::Cutter;

constexpr NumberRange kSize{-1e30, 1e30, "a number"};
constexpr NumberRange kCoordinate{-kMaxCoordinate, kMaxCoordinate, "a number within +-1e6"};

// In small letters, without what some put between words.
std::string plainWord(const std::string& text) {
  std::string plain;
  for (const char c : text)
    if (c != '-' && c != '_' && c != ' ')
      plain += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return plain;
}

std::string wordOf(const JsonField& object, const char* key, const char* otherwise) {
  return object.has(key) ? plainWord(object.member(key).string()) : otherwise;
}

double unitOf(const JsonField& tool) {
  const std::string word = wordOf(tool, "units", "metric");
  if (word != "metric" && word != "imperial") tool.member("units").refuse("\"metric\" or \"imperial\"");
  constexpr double kMillimetresPerInch = 25.4;
  return word == "metric" ? 1 : kMillimetresPerInch;
}

Tool toolOf(const JsonField& field) {
  if (!field.value().is_object()) field.refuse("an object");
  Tool tool;
  const std::string mode = wordOf(field, "mode", "cut");
  if (mode != "cut" && mode != "add") field.member("mode").refuse("\"cut\" or \"add\"");
  tool.adds = mode == "add";
  const double unit = unitOf(field);
  const std::string shape = wordOf(field, "shape", "cylindrical");
  if (shape != "cylindrical" && shape != "ballnose" && shape != "bullnose") {
    tool.whyNot = fmt::format("has the shape {}", describe(field.member("shape").value()));
    return tool;
  }
  const auto sizeOf = [&](const char* key) { return unit * field.member(key).number(kSize); };
  Cutter cutter;
  cutter.radius = sizeOf("diameter") / 2;
  cutter.length = sizeOf("length");
  const double corner = field.has("corner_radius") ? sizeOf("corner_radius") : 0;
  if (shape == "bullnose" && !field.has("corner_radius")) {
    tool.whyNot = "is a bull nose without corner_radius";
    return tool;
  }
  if (shape == "ballnose" || (corner > 0 && corner == cutter.radius)) {
    cutter.kind = Cutter::Kind::Ball;
  } else if (corner != 0) {
    cutter.kind = Cutter::Kind::BullNose;
    cutter.cornerRadius = corner;
  }
  try {
    points::validate(cutter);
    tool.cutter = cutter;
  } catch (const InputError& error) {
    tool.whyNot = fmt::format("cannot be ({})", error.what());
  }
  return tool;
}

std::uint32_t numberOf(const std::string& key, const JsonField& tools) {
  std::uint32_t number = 0;
  const char* const end = key.data() + key.size();
  const auto [stop, error] = std::from_chars(key.data(), end, number);
  if (error != std::errc() || stop != end || key.empty())
    throw InputError(fmt::format("{}: {} has the key {}; its keys must be the numbers of tools",
                                 tools.where(), tools.path(), describe(nlohmann::json(key))));
  return number;
}

Box boundsOf(const JsonField& field) {
  Box box;
  const auto place = [&](const char* key) {
    const JsonField point = field.member(key);
    if (point.arraySize() != 3) point.refuse("an array of three numbers");
    Point p;
    for (int a = 0; a < 3; ++a) p[a] = point.element(static_cast<std::size_t>(a)).number32(kCoordinate);
    return p;
  };
  box.min = place("min");
  box.max = place("max");
  for (int a = 0; a < 3; ++a)
    if (!(box.min[a] < box.max[a]))
      throw InputError(fmt::format("{}: {} goes along {} from {} to {}; it must have an inside",
                                   field.where(), field.path(), "xyz"[a], box.min[a], box.max[a]));
  return box;
}

}  // namespace

ToolsFile parseToolsFile(std::string_view text, const std::string& name) {
  const nlohmann::json json = parseJson(text, {.file = name});
  const JsonField root(json, name);
  if (!json.is_object()) root.refuse("an object");
  ToolsFile file;
  file.name = name;
  if (root.has("tools")) {
    const JsonField tools = root.member("tools");
    if (!tools.value().is_object()) tools.refuse("an object of tools by their numbers");
    for (const auto& [key, unused] : tools.value().items()) {
      const std::uint32_t number = numberOf(key, tools);
      file.tools[number] = toolOf(tools.member(key.c_str()));
    }
  }
  if (root.has("workpiece")) {
    const JsonField workpiece = root.member("workpiece");
    if (!workpiece.value().is_object()) workpiece.refuse("an object");
    if (workpiece.has("bounds")) file.workpiece = boundsOf(workpiece.member("bounds"));
  }
  return file;
}

ToolsFile readToolsFile(const std::filesystem::path& path) {
  return parseToolsFile(readTextFile(path), path.string());
}

std::string numbersOf(const ToolsFile& file) {
  std::string text;
  std::size_t left = file.tools.size();
  for (const auto& [number, unused] : file.tools)
    text += fmt::format("{}{}", number, --left > 1 ? ", " : left == 1 ? " and " : "");
  return text.empty() ? "none" : text;
}

const Tool& selectedTool(const ToolsFile& file, std::uint32_t number) {
  const auto found = file.tools.find(number);
  if (found == file.tools.end())
    throw InputError(
        fmt::format("{}: there is no tool {}; the tools are {}", file.name, number, numbersOf(file)));
  if (!found->second.cutter)
    throw InputError(
        fmt::format("{}: tool {} {}; cutters must be cylindrical, ballnose, or bullnose with a "
                    "corner_radius",
                    file.name, number, found->second.whyNot));
  return found->second;
}

TriangleMesh stockOf(const ToolsFile& file) {
  if (!file.workpiece)
    throw InputError(
        fmt::format("{}: there are no workpiece.bounds; a workpiece must say how large it is", file.name));
  const Box& box = *file.workpiece;
  TriangleMesh mesh;
  for (const float z : {box.min.z, box.max.z})
    for (const float y : {box.min.y, box.max.y})
      for (const float x : {box.min.x, box.max.x}) mesh.vertices.push_back({x, y, z});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

}  // namespace restroke::sculpt
