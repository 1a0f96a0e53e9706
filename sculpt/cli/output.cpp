#include "sculpt/cli/output.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

#include "implicit/errors.h"

namespace restroke::cli {

Output::Output(const CommonOptions& options) {
  toStandardOutput_ = options.json == "-";
  if (!options.json.empty() && !toStandardOutput_) file_ = std::make_unique<AtomicFile>(options.json);
}

void Output::say(std::string_view text) const {
  if (!toStandardOutput_) std::fwrite(text.data(), 1, text.size(), stdout);
}

void Output::note(std::string_view text) {
  fmt::print(stderr, "restroke: {}\n", text);
}

void Output::finish(const nlohmann::ordered_json& object) {
  const std::string text = object.dump(2) + "\n";
  if (toStandardOutput_) std::fwrite(text.data(), 1, text.size(), stdout);
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
    throw InputError(fmt::format("standard output: cannot be written ({})", std::strerror(errno)));
  if (file_) {
    file_->write(text);
    file_->commit();
  }
}

Execution executionOf(const CommonOptions& options) {
  return {.threads = options.threads};
}

Progress::Progress(std::string label, std::size_t total)
    : label_(std::move(label)),
      total_(std::max<std::size_t>(total, 1)),
      terminal_(::isatty(STDERR_FILENO) != 0),
      next_(Clock::now() + std::chrono::seconds(1)) {}

Progress::~Progress() {
  if (shown_) fmt::print(stderr, "\r\033[K");
}

void Progress::update(std::size_t done) {
  if (!terminal_ || Clock::now() < next_) return;
  next_ = Clock::now() + std::chrono::milliseconds(100);
  shown_ = true;
  constexpr std::size_t kWidth = 40;
  const std::size_t filled = std::min(done, total_) * kWidth / total_;
  fmt::print(stderr, "\r{} [{}{}] {} of {}\033[K", label_, std::string(filled, '#'),
             std::string(kWidth - filled, '.'), grouped(done), grouped(total_));
  std::fflush(stderr);
}

std::string grouped(std::size_t number) {
  std::string text = std::to_string(number);
  for (std::size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, 1, ',');
  return text;
}

std::string plural(std::size_t count, std::string_view word) {
  return fmt::format("{} {}{}", grouped(count), word,
                     count == 1                                    ? ""
                     : word.ends_with("s") || word.ends_with("sh") ? "es"
                                                                   : "s");
}

}  // namespace restroke::cli
