#pragma once
// Files that say what the tools of a program are, and what they work on: projects of CAMotics (JSON), with
// two keys of our own (SPEC R8).

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "implicit/geometry/box.h"
#include "implicit/geometry/triangle_mesh.h"
#include "points/dexel/toolpath/cutter.h"

namespace restroke::sculpt {

/// What a file says of one tool.
struct Tool {
  std::optional<points::Cutter> cutter;  ///< upright; nothing: there is no such cutter here
  std::string whyNot;                    ///< then, for a sentence: "has the shape ..."
  /// It lays material down: "mode": "add".
  bool adds = false;
};

/// A project. Of its keys these are looked at, and others passed over:
///
///   tools      an object of tools by their numbers:
///                units          "metric" (default) or "imperial": millimetres or inches of what follows
///                shape          "cylindrical": flat; "ballnose"; "bullnose": flat with a rounded corner
///                length         from the tip up
///                diameter
///                corner_radius  of a bull nose (ours); a cylinder that has one is a bull nose too
///                mode           "cut" (default) or "add" (ours)
///   workpiece  bounds: min and max, three numbers each, always in millimetres
///
/// A bull nose whose corner is as large as its radius is a ball nose. A tool of another shape ("conical",
/// "snubnose", "spheroid"), or one that cannot be as it is described, is an error only once it is selected.
struct ToolsFile {
  std::string name;  ///< for messages
  std::map<std::uint32_t, Tool> tools;
  std::optional<Box> workpiece;  ///< with an inside
};

/// Throws InputError "FILE: ..." for what is not JSON, or a key that is not of its kind.
[[nodiscard]] ToolsFile readToolsFile(const std::filesystem::path& path);
[[nodiscard]] ToolsFile parseToolsFile(std::string_view text, const std::string& name);

/// The tool with a number. Throws InputError that names the file and what is wrong when there is none, or no
/// cutter for it.
[[nodiscard]] const Tool& selectedTool(const ToolsFile& file, std::uint32_t number);
/// "1, 2 and 3"; "none".
[[nodiscard]] std::string numbersOf(const ToolsFile& file);

/// The workpiece as a mesh of 12 triangles. Throws InputError when the file has none.
[[nodiscard]] TriangleMesh stockOf(const ToolsFile& file);

}  // namespace restroke::sculpt
