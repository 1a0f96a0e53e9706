#include "sculpt/replay.h"

#include "implicit/errors.h"

namespace restroke::sculpt {

std::string placeOf(const StrokeLog& log, const std::string& file, std::size_t index) {
  if (index < log.lines.size()) return fmt::format("{}:{}", file, log.lines[index]);
  return fmt::format("{}: command {}", file, index + 1);
}

Command recorded(const Command& command, const CommandReport& report, const Document& document) {
  if (std::holds_alternative<StrokeCommand>(command)) return document.history().command(report.node);
  Command written = command;
  if (Consequences* consequences = consequencesOf(written)) consequences->recasts = report.recasts;
  return written;
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
    if (options.record) options.record->commands[i] = recorded(log.commands[i], report, document);
    if (options.step) options.step(i, report);
  }
  return document;
}

History historyOf(const StrokeLog& log, const std::string& file) {
  History history;
  for (std::size_t i = 0; i < log.commands.size(); ++i) {
    const Command& command = log.commands[i];
    NodeResult result;
    if (const auto* stroke = std::get_if<StrokeCommand>(&command)) {
      if (stroke->outcome)
        result = {.stamps = static_cast<std::uint32_t>(primitivesOf(*stroke->outcome, stroke->brush).size()),
                  .misses = static_cast<std::uint32_t>(stroke->outcome->misses)};
    } else if (const auto* fixed = std::get_if<FixedCommand>(&command)) {
      result.stamps = static_cast<std::uint32_t>(fixed->size());
    }
    try {
      if (isNode(command))
        history.add(command, result);
      else
        history.edit(command);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", placeOf(log, file, i), error.what()));
    }
  }
  return history;
}

}  // namespace restroke::sculpt
