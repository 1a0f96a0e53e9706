#include "sculpt/cli/replaying.h"

#include <utility>

#include "implicit/errors.h"
#include "sculpt/cli/words.h"

namespace restroke::cli {

sculpt::StrokeLog readLogNoting(const std::string& file) {
  sculpt::StrokeLog log = sculpt::readLog(file);
  if (log.warning) Output::note(*log.warning);
  return log;
}

void refuseStampList(const sculpt::StrokeLog& log, const std::string& file, const std::string& action) {
  if (log.stampList)
    throw InputError(fmt::format(
        "{}: is a stamp list, which has no cameras, but {} needs a log; restroke import makes one of it",
        file, action));
}

sculpt::Document replayNoting(const sculpt::StrokeLog& log, sculpt::ReplayOptions options,
                              const Execution& execution) {
  constexpr std::size_t kNotedOneByOne = 10;
  std::size_t empty = 0;
  std::string notes;
  const std::string file = options.file;
  Progress progress("replay", log.commands.size());
  options.step = [&, next = std::move(options.step)](std::size_t i, const sculpt::CommandReport& report) {
    if (std::holds_alternative<sculpt::StrokeCommand>(log.commands[i]) && report.primitivesAdded == 0 &&
        ++empty <= kNotedOneByOne)
      notes += fmt::format("restroke: {}: the stroke hits nothing and adds nothing\n",
                           sculpt::placeOf(log, file, i));
    progress.update(i + 1);
    if (next) next(i, report);
  };
  sculpt::Document document = sculpt::replay(log, options, execution);
  if (empty > kNotedOneByOne)
    notes += fmt::format("restroke: {}: {} more strokes hit nothing and add nothing\n", file,
                         empty - kNotedOneByOne);
  fmt::print(stderr, "{}", notes);
  return document;
}

void overrideDensity(sculpt::StrokeLog& log, const std::optional<float>& density) {
  if (density) log.header.density = checkedDensity(*density);
}

std::string hexHash(std::uint64_t hash) {
  return fmt::format("{:016x}", hash);
}

}  // namespace restroke::cli
