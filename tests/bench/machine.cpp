#include "tests/bench/machine.h"

#include <fmt/format.h>

#include <fstream>

#include "implicit/errors.h"

namespace restroke::bench {

std::string textOf(const experiments::Provenance& origin) {
  return fmt::format("Machine: {}, {} processors, {}\nCompiler: {}; flags {}\nRevision: {}{}\n", origin.cpu,
                     origin.processors, origin.system, origin.compiler, origin.flags, origin.revision,
                     origin.dirty ? " (dirty)" : "");
}

nlohmann::ordered_json jsonOf(const experiments::Provenance& origin) {
  return {{"revision", origin.revision}, {"dirty", origin.dirty}, {"compiler", origin.compiler},
          {"flags", origin.flags},       {"cpu", origin.cpu},     {"processors", origin.processors},
          {"system", origin.system}};
}

void writeFile(const std::filesystem::path& file, std::string_view text) {
  std::ofstream out(file, std::ios::binary);
  out << text << std::flush;
  if (!out)
    throw InputError(
        fmt::format("{}: cannot be written; its folder must exist and have room", file.string()));
}

}  // namespace restroke::bench
