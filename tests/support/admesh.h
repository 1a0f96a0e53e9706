#pragma once
// What admesh, a program by somebody else, says of a mesh.

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "points/files/mesh_files.h"

namespace restroke::testing {

inline bool hasAdmesh() {
  return std::system("command -v admesh > /dev/null") == 0;
}

struct AdmeshReport {
  std::string text;
  int status = 0;
  /// The number after "label :"; -1 when there is none.
  [[nodiscard]] double valueOf(const std::string& label) const {
    const std::size_t at = text.find(label);
    const std::size_t colon = at == std::string::npos ? at : text.find(':', at);
    return colon == std::string::npos ? -1.0 : std::strtod(text.c_str() + colon + 1, nullptr);
  }
  /// What it would have repaired, with how often; empty when there is nothing.
  [[nodiscard]] std::vector<std::string> repairs() const {
    std::vector<std::string> found;
    if (status != 0) found.push_back(fmt::format("status {}", status));
    for (const char* label : {"Total disconnected facets", "Degenerate facets", "Edges fixed",
                              "Facets removed", "Facets added", "Facets reversed", "Backwards edges"})
      if (valueOf(label) != 0) found.push_back(fmt::format("{}: {}", label, valueOf(label)));
    return found;
  }
};

/// Only what matches exactly counts as connected, and directions are checked.
inline AdmeshReport askAdmesh(const TriangleMesh& mesh) {
  static int number = 0;
  const std::string stl = (std::filesystem::temp_directory_path() /
                           fmt::format("restroke_admesh_{}_{}.stl", ::getpid(), ++number))
                              .string();
  points::writeMesh(stl, mesh);
  AdmeshReport report;
  report.status =
      std::system(fmt::format("admesh --exact --normal-directions '{0}' > '{0}.txt' 2>&1", stl).c_str());
  std::stringstream text;
  text << std::ifstream(stl + ".txt").rdbuf();
  report.text = text.str();
  std::filesystem::remove(stl);
  std::filesystem::remove(stl + ".txt");
  return report;
}

}  // namespace restroke::testing
