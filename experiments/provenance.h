#pragma once
// Where a result comes from: what every row and every manifest.json carries.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace restroke::experiments {

/// What was built, and on what it runs.
struct Provenance {
  std::string revision;  ///< git commit at build time, 12 hex digits or more; "unknown" outside a repository
  bool dirty = false;    ///< tracked files differed from the commit when it was built
  std::string compiler;  ///< name, version, build type
  std::string flags;     ///< options that were given to every source
  std::string cpu;       ///< model name; "unknown" where /proc/cpuinfo does not say
  unsigned processors = 0;
  std::string system;  ///< the system's own name of itself (/etc/os-release)
};
[[nodiscard]] Provenance provenance();

/// XXH3 (64 bit) as 16 hex digits.
[[nodiscard]] std::string hexHash(std::string_view bytes);
[[nodiscard]] std::string hex(std::uint64_t hash);
/// hexHash of a file's bytes. Throws InputError when it cannot be read.
[[nodiscard]] std::string hashOfFile(const std::filesystem::path& file);
/// A file's bytes. Throws InputError when it cannot be read.
[[nodiscard]] std::string bytesOfFile(const std::filesystem::path& file);

}  // namespace restroke::experiments
