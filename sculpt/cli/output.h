#pragma once
// What every subcommand says, and where: text on standard output, one JSON object, notes and progress on
// standard error.

#include <chrono>
#include <cstddef>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "implicit/atomic_file.h"
#include "implicit/execution.h"
#include "sculpt/cli/commands.h"

namespace restroke::cli {

/// Opens the JSON file first, so that one that cannot be written stops the work before it begins, and gives
/// it its name last.
class Output {
 public:
  explicit Output(const CommonOptions& options);

  /// Text for people. Left out when the JSON goes to standard output, so that this is one JSON value.
  void say(std::string_view text) const;
  /// A line on standard error, whatever goes to standard output.
  static void note(std::string_view text);
  /// Writes the object where the options ask for it, and flushes standard output. Call it last. Throws
  /// InputError.
  void finish(const nlohmann::ordered_json& object);

 private:
  bool toStandardOutput_ = false;
  std::unique_ptr<AtomicFile> file_;
};

[[nodiscard]] Execution executionOf(const CommonOptions& options);

/// A bar on standard error for work that takes over a second. None when standard error is not a terminal.
class Progress {
 public:
  Progress(std::string label, std::size_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// `done` of the total are finished.
  void update(std::size_t done);

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  std::size_t total_;
  bool terminal_;
  bool shown_ = false;
  Clock::time_point next_;
};

/// 1234567 as "1,234,567".
[[nodiscard]] std::string grouped(std::size_t number);
/// "1 stroke", "2 strokes", "3 misses".
[[nodiscard]] std::string plural(std::size_t count, std::string_view word);

}  // namespace restroke::cli
