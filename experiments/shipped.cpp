#include "experiments/shipped.h"

#include "implicit/errors.h"

namespace restroke::experiments {

namespace fs = std::filesystem;

fs::path shippedFile(std::string_view relative) {
  std::error_code ignored;
  const fs::path beside = fs::read_symlink("/proc/self/exe", ignored).parent_path() / relative;
  const fs::path source = fs::path(RESTROKE_EXPERIMENTS_DIR) / relative;
  for (const fs::path& candidate : {beside, source})
    if (fs::exists(candidate, ignored)) return candidate;
  throw InputError(fmt::format("{}: neither at {} nor at {}; it belongs beside the program", relative,
                               beside.string(), source.string()));
}

}  // namespace restroke::experiments
