#pragma once

#include <filesystem>
#include <string>

namespace restroke::sculpt {

/// The bytes of a regular file or a pipe. Throws InputError "FILE: ..., reason" when it is missing, cannot be
/// read, or is a folder or a device.
[[nodiscard]] std::string readTextFile(const std::filesystem::path& file);

}  // namespace restroke::sculpt
