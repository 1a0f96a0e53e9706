#include "sculpt/text_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "implicit/errors.h"

namespace restroke::sculpt {

namespace {

// Closes on every way out.
class OpenFile {
 public:
  explicit OpenFile(int descriptor) : descriptor_(descriptor) {}
  ~OpenFile() { ::close(descriptor_); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  [[nodiscard]] int get() const { return descriptor_; }

 private:
  int descriptor_;
};

[[noreturn]] void refuse(const std::filesystem::path& file, int error) {
  throw InputError(fmt::format("{}: cannot be read, but must be a readable file ({})", file.string(),
                               std::strerror(error)));
}

}  // namespace

std::string readTextFile(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) refuse(file, errno);
  const OpenFile open(descriptor);
  struct stat info{};
  if (::fstat(open.get(), &info) != 0) refuse(file, errno);
  if (!S_ISREG(info.st_mode) && !S_ISFIFO(info.st_mode))
    throw InputError(fmt::format("{}: is a {}, but must be a file", file.string(),
                                 S_ISDIR(info.st_mode) ? "folder" : "device"));
  std::string text;
  std::size_t used = 0;
  constexpr std::size_t kBlock = std::size_t{1} << 20;
  text.resize(S_ISREG(info.st_mode) ? static_cast<std::size_t>(info.st_size) + 1 : kBlock);
  for (;;) {
    if (used == text.size()) text.resize(text.size() + std::max(kBlock, text.size() / 2));
    const ssize_t got = ::read(open.get(), text.data() + used, text.size() - used);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse(file, errno);
    if (got == 0) break;
    used += static_cast<std::size_t>(got);
  }
  text.resize(used);
  return text;
}

}  // namespace restroke::sculpt
