#include "sculpt/replay.h"

#include "implicit/errors.h"

namespace restroke::sculpt {

std::string placeOf(const StrokeLog& log, const std::string& file, std::size_t index) {
  if (index < log.lines.size()) return fmt::format("{}:{}", file, log.lines[index]);
  return fmt::format("{}: command {}", file, index + 1);
}

Document replay(const StrokeLog& log, const ReplayOptions& options, const Execution& execution) {
  Document document(log.header, options.document, execution);
  for (std::size_t i = 0; i < log.commands.size(); ++i) {
    CommandReport report;
    try {
      report = document.apply(log.commands[i]);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", placeOf(log, options.file, i), error.what()));
    }
    if (options.step) options.step(i, report);
  }
  return document;
}

History historyOf(const StrokeLog& log, const std::string& file) {
  History history;
  for (std::size_t i = 0; i < log.commands.size(); ++i) {
    const Command& command = log.commands[i];
    if (std::holds_alternative<UndoCommand>(command)) {
      if (history.cursor() == kRootNode)
        throw InputError(fmt::format("{}: {}", placeOf(log, file, i), kNothingToUndo));
      history.moveCursor(history.parent(history.cursor()));
    } else if (std::holds_alternative<RedoCommand>(command)) {
      if (history.redoTarget(history.cursor()) == history.cursor())
        throw InputError(fmt::format("{}: {}", placeOf(log, file, i), kNothingToRedo));
      history.moveCursor(history.redoTarget(history.cursor()));
    } else {
      NodeResult result;
      if (const auto* stroke = std::get_if<StrokeCommand>(&command)) {
        if (stroke->outcome)
          result = {
              .stamps = static_cast<std::uint32_t>(primitivesOf(*stroke->outcome, stroke->brush).size()),
              .misses = static_cast<std::uint32_t>(stroke->outcome->misses)};
      } else {
        result.stamps = static_cast<std::uint32_t>(std::get<FixedCommand>(command).size());
      }
      history.add(command, result);
    }
  }
  return history;
}

}  // namespace restroke::sculpt
