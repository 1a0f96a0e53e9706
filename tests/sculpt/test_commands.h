#pragma once
// Commands that tests of the document draw on a unit sphere.

#include <filesystem>
#include <string>
#include <vector>

#include "sculpt/command.h"

namespace restroke::sculpt {

/// Looks from +z at the unit sphere, which nearly fills a viewport of 400 x 400 pixels.
[[nodiscard]] Camera frontCamera();
/// A stroke from the left to the right through the middle, `offset` pixels below it, of 21 points.
[[nodiscard]] StrokeCommand line(int offset, Mode mode = Mode::Add);
/// A stroke beside the sphere.
[[nodiscard]] StrokeCommand miss();
/// A coarse header that keeps tests quick.
[[nodiscard]] LogHeader coarseHeader();

/// The shared data, or an empty path where the machine has none.
[[nodiscard]] std::filesystem::path sharedData();
/// A new empty folder that is removed with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  /// Writes a file there and returns its path.
  [[nodiscard]] std::filesystem::path file(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
};
[[nodiscard]] std::string textOf(const std::filesystem::path& file);

}  // namespace restroke::sculpt
