#pragma once
// On what a bench ran, and the file that it writes.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "experiments/provenance.h"

namespace restroke::bench {

/// Machine, compiler, revision: a line each.
[[nodiscard]] std::string textOf(const experiments::Provenance& origin);
/// revision, dirty, compiler, flags, cpu, processors, system.
[[nodiscard]] nlohmann::ordered_json jsonOf(const experiments::Provenance& origin);

/// Throws InputError when the file cannot be written.
void writeFile(const std::filesystem::path& file, std::string_view text);

}  // namespace restroke::bench
