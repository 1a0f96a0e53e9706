#pragma once
// What a file that a subcommand is given holds, told by its contents.

#include <cstdint>
#include <string>

namespace restroke::cli {

/// A log or stamp list is what is nothing else: its reader has a sentence for folders and missing files.
/// A project of CAMotics (sculpt/tools_file.h) says what the workpiece is.
enum class SourceKind : std::uint8_t { Log, Mesh, TriDexel, Project };
[[nodiscard]] SourceKind sourceKindOf(const std::string& path);

}  // namespace restroke::cli
