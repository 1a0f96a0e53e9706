// restroke import: pen strokes or a stamp list become a log.

#include <nlohmann/json.hpp>

#include "implicit/errors.h"
#include "sculpt/cli/commands.h"
#include "sculpt/cli/output.h"
#include "sculpt/cli/replaying.h"
#include "sculpt/cli/words.h"
#include "sculpt/pen_strokes.h"
#include "sculpt/text_file.h"

namespace restroke::cli {

namespace {

float checkedSize(const char* option, float value) {
  if (!(value > 0) || !(value <= kMaxCoordinate))
    throw InputError(fmt::format("{}: {} must be more than 0 and at most {}", option, value, kMaxCoordinate));
  return value;
}

sculpt::PenMode penModeNamed(const std::string& name) {
  if (name == "add") return sculpt::PenMode::Add;
  if (name == "carve") return sculpt::PenMode::Carve;
  if (name == "alternate") return sculpt::PenMode::Alternate;
  throw InputError(fmt::format("--mode: \"{}\" must be add, carve or alternate", name));
}

sculpt::Trace traceNamed(const std::string& name) {
  if (name == "stamps") return sculpt::Trace::Stamps;
  if (name == "sweep") return sculpt::Trace::Sweep;
  throw InputError(fmt::format("--trace: \"{}\" must be stamps or sweep", name));
}

sculpt::PenOptions penOptionsOf(const ImportOptions& options) {
  sculpt::PenOptions pen;
  const sculpt::Repair repair = repairNamed(options.repair);
  pen.base = sculpt::shapeNamed(options.base.value_or("sphere"), repair, "--base", Output::note);
  pen.trace = traceNamed(options.trace.value_or("stamps"));
  if (options.tip) pen.tip = sculpt::tipNamed(*options.tip, repair, "--tip", Output::note);
  pen.mode = penModeNamed(options.mode.value_or("add"));
  if (options.radius) pen.radius = checkedSize("--radius", *options.radius);
  if (options.density) pen.density = checkedDensity(*options.density);
  if (options.fill) {
    pen.fill = *options.fill;
    if (!(pen.fill >= 0.01f) || !(pen.fill <= 100))
      throw InputError(fmt::format("--fill: {} must be from 0.01 to 100", pen.fill));
  }
  return pen;
}

sculpt::StrokeLog readSource(const ImportOptions& options) {
  const sculpt::PenOptions pen = penOptionsOf(options);
  const std::string text = sculpt::readTextFile(options.source);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first != std::string::npos && text[first] == '{') return sculpt::readPenStrokes(options.source, pen);
  if (options.base || options.mode || options.radius || options.fill || options.tip || options.trace)
    throw InputError(fmt::format(
        "{}: is not a JSON file; a stamp list brings its own base, signs and radii, and takes no --base, "
        "--mode, --radius, --fill, --tip or --trace",
        options.source));
  sculpt::StrokeLog log = sculpt::readLog(options.source);
  overrideDensity(log, options.density);
  return log;
}

}  // namespace

int runImport(const ImportOptions& options) {
  const sculpt::StrokeLog log = readSource(options);
  Output output(options.common);
  std::size_t points = 0, stamps = 0;
  for (const sculpt::Command& command : log.commands) {
    if (const auto* stroke = std::get_if<sculpt::StrokeCommand>(&command))
      points += stroke->stroke.points.size();
    if (const auto* fixed = std::get_if<sculpt::FixedCommand>(&command)) stamps += fixed->stamps.size();
  }
  sculpt::writeLog(options.out, log);
  output.say(fmt::format("{}: {} strokes, {}\n", options.out, grouped(log.commands.size()),
                         log.stampList ? grouped(stamps) + " fixed stamps" : grouped(points) + " points"));
  nlohmann::ordered_json json{
      {"out", options.out}, {"strokes", log.commands.size()}, {"stroke_points", points}};
  if (log.stampList) json["fixed_stamps"] = stamps;
  json["density"] = log.header.density;
  output.finish(json);
  return 0;
}

}  // namespace restroke::cli
