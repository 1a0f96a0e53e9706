#include "implicit/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <system_error>
#include <utility>

#include "implicit/errors.h"

namespace restroke {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, int error) {
  throw InputError(
      fmt::format("{}: cannot write this file: {}", path.string(), std::generic_category().message(error)));
}

/// A file descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const { return fd_; }
  /// Closes now; false leaves the reason in errno (some file systems report a full disk only here).
  [[nodiscard]] bool close() { return ::close(std::exchange(fd_, -1)) == 0; }

 private:
  int fd_;
};

/// Two writers of one file, in one process or in two, must not share a temporary.
fs::path temporaryFor(const fs::path& path) {
  static std::atomic<unsigned> counter{0};
  fs::path result = path;
  result += fmt::format(".tmp-{}-{}", ::getpid(), counter++);
  return result;
}

/// Makes the rename itself last. A file system that cannot flush a folder says EINVAL or the like; the rename
/// has happened all the same, so that is no reason to report failure.
void flushFolder(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const Descriptor fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.get() >= 0) (void)::fsync(fd.get());
}

}  // namespace

AtomicFile::AtomicFile(fs::path path) : path_(std::move(path)), temporary_(temporaryFor(path_)) {
  if (path_.empty() || !path_.has_filename())
    throw InputError(fmt::format("\"{}\": cannot write this file: a file name is missing", path_.string()));
  // A device or a pipe would be replaced by a plain file; a folder cannot be.
  std::error_code ignored;
  const fs::file_status status = fs::status(path_, ignored);
  if (fs::is_directory(status)) fail(path_, EISDIR);
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw InputError(
        fmt::format("{}: cannot write this file: what has this name is not a regular file", path_.string()));
  // Renaming over a link would replace the link, not the file that it names.
  if (fs::is_symlink(fs::symlink_status(path_, ignored))) {
    const fs::path target = fs::weakly_canonical(path_, ignored);
    if (!ignored) temporary_ = temporaryFor(target), path_ = target;
  }
  Descriptor fd(::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (fd.get() < 0) fail(path_, errno);
}

AtomicFile::~AtomicFile() {
  if (!done_) ::unlink(temporary_.c_str());
}

void AtomicFile::write(std::string_view bytes) {
  Descriptor fd(::open(temporary_.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC));
  if (fd.get() < 0) fail(path_, errno);
  while (!bytes.empty()) {
    // One call writes at most 2^31 - 4096 bytes.
    const ssize_t written = ::write(fd.get(), bytes.data(), std::min<std::size_t>(bytes.size(), 1U << 30));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(path_, errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  if (!fd.close()) fail(path_, errno);
}

void AtomicFile::commit() {
  if (done_) throw InternalError(fmt::format("{}: committed twice", path_.string()));
  Descriptor fd(::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC));
  if (fd.get() < 0) fail(path_, errno);
  if (::fsync(fd.get()) != 0 && errno != EINVAL && errno != EROFS) fail(path_, errno);
  // Replacing a file keeps its permissions.
  struct stat former{};
  if (::stat(path_.c_str(), &former) == 0) (void)::fchmod(fd.get(), former.st_mode & 07777);
  if (!fd.close()) fail(path_, errno);
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) fail(path_, errno);
  done_ = true;
  flushFolder(path_);
}

void writeFileAtomically(const fs::path& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace restroke
