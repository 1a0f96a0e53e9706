#pragma once
// The stroke log on disk: JSON Lines, one command a line (DESIGN invariant 8; format in sculpt/README.md).

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sculpt/command.h"

namespace restroke::sculpt {

/// The format version that is written, and the newest that is read.
inline constexpr int kLogVersion = 1;

struct StrokeLog {
  LogHeader header = {};
  std::vector<Command> commands = {};
  /// Line of the file on which each command stands (of a stamp list: its S line); for messages. May be empty
  /// in logs that were not read from a file.
  std::vector<std::size_t> lines = {};
  bool stampList = false;  ///< read from a stamp list, which has no cameras
  std::size_t bytes = 0;   ///< size of the file that it was read from
  /// One sentence when the file's last line was torn (no newline at its end) and dropped.
  std::optional<std::string> warning = {};
};

/// Reads a log or a stamp list (told apart by their first byte: a log begins with '{'). Throws InputError
/// that names file and line. Whether undo and redo are possible where they stand is found by replay, not
/// here. O(bytes).
[[nodiscard]] StrokeLog readLog(const std::filesystem::path& file);

/// Writes a whole log beside its final name, flushes it to disk and renames it. A camera or brush equal to
/// that of the stroke line above is left out of the line. Throws InputError (and leaves a former file as it
/// was) when it cannot be written.
void writeLog(const std::filesystem::path& file, const StrokeLog& log);

/// Appends one line, complete in itself, and flushes it to disk; cuts off a torn last line first. An earlier
/// line is never rewritten, and a second process that appends waits. Throws InputError when the file is
/// missing, not a log or cannot be written; the log then ends with its last complete line.
void appendToLog(const std::filesystem::path& file, const Command& command);

}  // namespace restroke::sculpt
