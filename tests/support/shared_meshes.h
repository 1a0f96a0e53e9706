#pragma once
// The meshes that other people made (shared/data/README.md), for tests that have RESTROKE_SHARED_DIR.

#include <algorithm>
#include <filesystem>
#include <vector>

namespace restroke::testing {

inline std::filesystem::path meshFolder() {
  return std::filesystem::path(RESTROKE_SHARED_DIR) / "data" / "meshes";
}

/// Sorted; none where the folder is absent.
inline std::vector<std::filesystem::path> meshesIn(const char* folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(meshFolder() / folder, error))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace restroke::testing
