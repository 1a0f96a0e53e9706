#include "implicit/process_memory.h"

#include <malloc.h>

#include <algorithm>
#include <fstream>
#include <string>

namespace restroke {
namespace {

/// The number behind `key:` in a file of lines "key:  number kB"; 0 when there is none.
std::size_t kilobytesIn(const char* file, std::string_view key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);)
    if (line.starts_with(key) && line.size() > key.size() && line[key.size()] == ':')
      return std::strtoull(line.c_str() + key.size() + 1, nullptr, 10) * 1024;
  return 0;
}

std::optional<std::size_t> numberIn(const char* file) {
  std::ifstream in(file);
  std::size_t number = 0;
  if (in >> number) return number;  // not "max"
  return {};
}

}  // namespace

std::size_t residentBytes() {
  return kilobytesIn("/proc/self/status", "VmRSS");
}

std::size_t peakResidentBytes() {
  return kilobytesIn("/proc/self/status", "VmHWM");
}

void resetPeak() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << 5;  // Linux: proc(5)
}

std::optional<std::size_t> availableBytes() {
  std::optional<std::size_t> available;
  if (const std::size_t system = kilobytesIn("/proc/meminfo", "MemAvailable")) available = system;
  // Version 2 of control groups, as a container sees its own.
  const auto limit = numberIn("/sys/fs/cgroup/memory.max"), used = numberIn("/sys/fs/cgroup/memory.current");
  if (limit && used) {
    const std::size_t left = *limit > *used ? *limit - *used : 0;
    available = std::min(available.value_or(left), left);
  }
  return available;
}

}  // namespace restroke
