#pragma once
// A whole log carried out, line by line.

#include <functional>
#include <string>

#include "sculpt/document.h"
#include "sculpt/stroke_log.h"

namespace restroke::sculpt {

/// Called after each command with its index in StrokeLog::commands.
using ReplayStep = std::function<void(std::size_t index, const CommandReport& report)>;

struct ReplayOptions {
  std::string file = "log";  ///< name for messages
  DocumentOptions document = {};
  ReplayStep step = {};  ///< may be empty
  /// Where it is given, a log with as many commands: each gets what was carried out, with the outcomes that
  /// are to be recorded with it. May be the log that is replayed.
  StrokeLog* record = nullptr;
};

/// The command as it is to be written down once it has been carried out: with the outcomes that depend on
/// this machine.
[[nodiscard]] Command recorded(const Command& command, const CommandReport& report, const Document& document);

/// The document after all commands of the log. Throws InputError "FILE:LINE: ..." for a command that cannot
/// be carried out.
[[nodiscard]] Document replay(const StrokeLog& log, const ReplayOptions& options = {},
                              const Execution& execution = {});

/// The tree that the log's commands make, with its cursor, but without any shape: results of nodes are 0
/// where no outcome is recorded. Throws as replay does. O(points).
[[nodiscard]] History historyOf(const StrokeLog& log, const std::string& file = "log");

/// "FILE:LINE" of a command, or "FILE: command N" where the log knows no lines.
[[nodiscard]] std::string placeOf(const StrokeLog& log, const std::string& file, std::size_t index);

}  // namespace restroke::sculpt
