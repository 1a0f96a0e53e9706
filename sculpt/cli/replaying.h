#pragma once
// Reading and replaying a log for a subcommand, with what has to be said on the way.

#include <optional>
#include <string>

#include "sculpt/cli/output.h"
#include "sculpt/replay.h"

namespace restroke::cli {

/// Reads the log or stamp list; a torn last line is noted on standard error.
[[nodiscard]] sculpt::StrokeLog readLogNoting(const std::string& file);

/// Throws InputError that says why the action cannot be had of a stamp list, if the log is one.
void refuseStampList(const sculpt::StrokeLog& log, const std::string& file, const std::string& action);

/// Replays with a progress bar. Strokes that hit nothing are noted on standard error, the first ten one by
/// one. `options.step` is called as well.
[[nodiscard]] sculpt::Document replayNoting(const sculpt::StrokeLog& log, sculpt::ReplayOptions options,
                                            const Execution& execution);

/// A log without its header's density where the command line gave one.
void overrideDensity(sculpt::StrokeLog& log, const std::optional<float>& density);

/// State hash as it is printed: 16 hexadecimal digits.
[[nodiscard]] std::string hexHash(std::uint64_t hash);

}  // namespace restroke::cli
