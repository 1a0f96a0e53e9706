#pragma once
// Strokes for tests: from the shared files, and made up.

#include <cstdint>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "implicit/primitive.h"
#include "retarget/stroke.h"

namespace restroke::retarget {

/// Folders of the shared data: below RESTROKE_SHARED from the environment, else below what CMake was told.
[[nodiscard]] std::filesystem::path sharedStrokesFolder();
[[nodiscard]] std::filesystem::path sharedStampsFolder();

/// Points of every stroke of a file (format in the shared data's README.md), quantised as import does.
[[nodiscard]] std::vector<std::vector<StrokePoint>> readStrokeFile(const std::filesystem::path& file);

/// Base and stamps of a stamp list, in order.
[[nodiscard]] std::vector<implicit::Primitive> readStampFile(const std::filesystem::path& file);

/// A whole number from `low` to `high`, the same on every platform (std::uniform_int_distribution is not).
[[nodiscard]] inline std::int64_t uniform(std::mt19937_64& random, std::int64_t low, std::int64_t high) {
  return low + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(high - low + 1));
}

}  // namespace restroke::retarget
