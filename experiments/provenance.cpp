#include "experiments/provenance.h"

#include <xxhash.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <thread>

#include "experiments_revision.h"  // made at every build by revision.cmake
#include "implicit/errors.h"

namespace restroke::experiments {
namespace {

/// The value of the first line `key<separator>value`, without quotes; "unknown" when there is none.
std::string lineValue(const char* file, std::string_view key, char separator) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t at = line.find(separator);
    if (at == std::string::npos) continue;
    const std::size_t begin = line.find_first_not_of(" \t\"", at + 1);
    if (begin == std::string::npos) break;
    return line.substr(begin, line.find_last_not_of(" \t\"") + 1 - begin);
  }
  return "unknown";
}

}  // namespace

Provenance provenance() {
  Provenance p;
  p.revision = RESTROKE_REVISION;
  p.dirty = RESTROKE_DIRTY;
  p.compiler = RESTROKE_COMPILER;
  p.flags = RESTROKE_COMPILE_FLAGS;
  p.cpu = lineValue("/proc/cpuinfo", "model name", ':');
  p.processors = std::thread::hardware_concurrency();
  p.system = lineValue("/etc/os-release", "PRETTY_NAME", '=');
  return p;
}

std::string hex(std::uint64_t hash) {
  return fmt::format("{:016x}", hash);
}

std::string hexHash(std::string_view bytes) {
  return hex(XXH3_64bits(bytes.data(), bytes.size()));
}

std::string bytesOfFile(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string bytes;
  if (in) bytes.assign(std::istreambuf_iterator<char>(in), {});
  if (!in || in.bad())
    throw InputError(fmt::format("{}: cannot be read ({}); it must be a readable file", file.string(),
                                 errno != 0 ? std::strerror(errno) : "no reason given"));
  return bytes;
}

std::string hashOfFile(const std::filesystem::path& file) {
  return hexHash(bytesOfFile(file));
}

}  // namespace restroke::experiments
