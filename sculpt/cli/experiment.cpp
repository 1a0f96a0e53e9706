// restroke experiment: the program restroke-experiment, which knows the modules that stand above this one.

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "implicit/errors.h"
#include "sculpt/cli/commands.h"

namespace restroke::cli {

void becomeExperiment(char** arguments) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string program =
      (error ? std::filesystem::path() : self.parent_path() / "restroke-experiment").string();
  if (program.empty()) throw InternalError(fmt::format("/proc/self/exe: {}", error.message()));
  // The word "experiment" makes room for the program's name.
  std::string name = program;
  arguments[0] = name.data();
  ::execv(program.c_str(), arguments);
  throw InputError(
      fmt::format("{}: cannot be started, but must lie beside restroke ({})", program, std::strerror(errno)));
}

}  // namespace restroke::cli
