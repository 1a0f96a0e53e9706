#include "sculpt/stroke_log.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "implicit/atomic_file.h"
#include "implicit/errors.h"
#include "sculpt/stamp_list.h"
#include "sculpt/stroke_log_lines.h"
#include "sculpt/text_file.h"

namespace restroke::sculpt {

namespace {

StrokeLog parseLog(std::string_view text, const std::filesystem::path& path) {
  const std::string file = path.string();
  StrokeLog log;
  log.bytes = text.size();
  const std::size_t complete = text.rfind('\n') == std::string_view::npos ? 0 : text.rfind('\n') + 1;
  if (complete == 0)
    throw InputError(fmt::format("{}:1: the header line is torn, but must end with a newline", file));
  if (complete < text.size()) {
    const auto line =
        std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(complete), '\n') + 1;
    log.warning =
        fmt::format("{}:{}: the last line is torn (no newline at its end) and was dropped", file, line);
  }
  TextOrigin origin{file, 1};
  LineContext context{.folder = path.parent_path()};
  for (std::size_t begin = 0; begin < complete; ++origin.line) {
    const std::size_t end = text.find('\n', begin);
    const std::string_view line = text.substr(begin, end - begin);
    begin = end + 1;
    if (origin.line == 1) {
      log.header = parseHeader(line, origin, context.folder);
    } else {
      log.commands.push_back(parseCommand(line, origin, context));
      log.lines.push_back(origin.line);
    }
  }
  return log;
}

// A log that is open for appending, and closed (which releases its lock) on every way out.
class Appending {
 public:
  explicit Appending(const std::filesystem::path& file) : name_(file.string()) {
    descriptor_ = ::open(file.c_str(), O_RDWR | O_APPEND | O_CLOEXEC);
    if (descriptor_ < 0) refuse(errno);
  }
  ~Appending() { ::close(descriptor_); }
  Appending(const Appending&) = delete;
  Appending& operator=(const Appending&) = delete;

  void append(const std::string& line) const {
    while (::flock(descriptor_, LOCK_EX) != 0)
      if (errno != EINTR) refuse(errno);
    const off_t end = endOfLastLine();
    if (::ftruncate(descriptor_, end) != 0) refuse(errno);
    std::size_t written = 0;
    while (written < line.size()) {
      const ssize_t count = ::write(descriptor_, line.data() + written, line.size() - written);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) giveUp(end, errno);
      written += static_cast<std::size_t>(count);
    }
    if (::fsync(descriptor_) != 0) giveUp(end, errno);
  }

 private:
  [[noreturn]] void refuse(int error) const {
    throw InputError(fmt::format("{}: cannot be appended to, but must be a log that can be written ({})",
                                 name_, std::strerror(error)));
  }
  [[noreturn]] void giveUp(off_t end, int error) const {
    // What was written of the line has no newline yet or would be half a promise; if cutting it off fails as
    // well, it is a torn line.
    if (::ftruncate(descriptor_, end) != 0) refuse(error);
    refuse(error);
  }
  // Offset behind the last newline: a torn last line lies beyond it.
  [[nodiscard]] off_t endOfLastLine() const {
    struct stat info{};
    if (::fstat(descriptor_, &info) != 0) refuse(errno);
    if (!S_ISREG(info.st_mode)) throw InputError(fmt::format("{}: is not a file, but must be a log", name_));
    char first = 0;
    if (info.st_size == 0 || ::pread(descriptor_, &first, 1, 0) != 1 || first != '{')
      throw InputError(fmt::format(
          "{}: is not a stroke log, but only logs, which begin with '{{', can be appended to", name_));
    std::string block(std::size_t{1} << 16, '\0');
    for (off_t end = info.st_size; end > 0;) {
      const off_t begin = std::max<off_t>(0, end - static_cast<off_t>(block.size()));
      const auto size = static_cast<std::size_t>(end - begin);
      if (::pread(descriptor_, block.data(), size, begin) != static_cast<ssize_t>(size)) refuse(errno);
      const std::size_t newline = std::string_view(block.data(), size).rfind('\n');
      if (newline != std::string_view::npos) return begin + static_cast<off_t>(newline) + 1;
      end = begin;
    }
    throw InputError(fmt::format("{}:1: the header line is torn, but must end with a newline", name_));
  }

  std::string name_;
  int descriptor_ = -1;
};

}  // namespace

StrokeLog readLog(const std::filesystem::path& file) {
  const std::string text = readTextFile(file);
  if (!text.empty() && text.front() == '{') return parseLog(text, file);
  return parseStampList(text, file.string());
}

void writeLog(const std::filesystem::path& file, const StrokeLog& log) {
  LineContext context{.folder = file.parent_path()};
  std::string text = formatHeader(log.header, context.folder) + "\n";
  for (const Command& command : log.commands) text += formatCommand(command, context) + "\n";
  writeFileAtomically(file, std::string_view(text));
}

void appendToLog(const std::filesystem::path& file, const Command& command) {
  LineContext complete{.folder = file.parent_path()};  // otherwise empty: the line says everything
  const Appending log(file);
  log.append(formatCommand(command, complete) + "\n");
}

}  // namespace restroke::sculpt
