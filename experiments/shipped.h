#pragma once
// Files that belong to the program: plots and example logs.

#include <filesystem>
#include <string_view>

namespace restroke::experiments {

/// A file of this folder, for instance "examples/table2.log": beside the program, else where the sources were
/// when it was built. Throws InputError that names both places when it is at neither.
[[nodiscard]] std::filesystem::path shippedFile(std::string_view relative);

}  // namespace restroke::experiments
