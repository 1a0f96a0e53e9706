#include "sculpt/pen_strokes.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "implicit/errors.h"
#include "sculpt/document.h"
#include "sculpt/json_reader.h"
#include "sculpt/stamp_list.h"
#include "sculpt/text_file.h"

namespace restroke::sculpt {

using nlohmann::json;

namespace {

constexpr NumberRange kPixels{-1048576, 1048576, "a number of pixels within +-2^20"};
constexpr NumberRange kSeconds{-1e12, 1e12, "a number of seconds within +-1e12"};
constexpr NumberRange kPressure{0, 1, "a pressure from 0 to 1"};
constexpr NumberRange kSize{1, 65536, "a number of pixels from 1 to 65536"};
constexpr double kLastMillisecond = 2147483647.0;

double rounded(double value) {
  return std::floor(value + 0.5);
}

// Fields by index, with names only for messages: files have up to a million points.
double valueAt(const JsonField& points, std::size_t index, std::size_t k, const NumberRange& range) {
  const json& value = points.value()[index][k];
  if (!value.is_number() || !(value.get<double>() >= range.min && value.get<double>() <= range.max))
    points.element(index).element(k).refuse(range.rule);
  return value.get<double>();
}

std::vector<retarget::StrokePoint> pointsOf(const JsonField& field) {
  std::vector<retarget::StrokePoint> points(field.arraySize());
  if (points.empty()) field.refuse("an array of at least 1 point");
  double first = 0, last = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const json& row = field.value()[i];
    if (!row.is_array() || row.size() != 4) field.element(i).refuse("an array [x, y, seconds, pressure]");
    const double seconds = valueAt(field, i, 2, kSeconds);
    if (i == 0) first = last = seconds;
    if (seconds < last) field.element(i).element(2).refuse("no earlier than the point before it");
    last = seconds;
    const double milliseconds = rounded((seconds - first) * 1000);
    if (milliseconds > kLastMillisecond)
      field.element(i).element(2).refuse("at most 2^31 - 1 milliseconds after the first point");
    points[i].screen = {static_cast<std::int32_t>(rounded(valueAt(field, i, 0, kPixels) * kSubPixels)),
                        static_cast<std::int32_t>(rounded(valueAt(field, i, 1, kPixels) * kSubPixels))};
    points[i].time = static_cast<std::uint32_t>(milliseconds);
    points[i].pressure =
        static_cast<std::uint16_t>(rounded(valueAt(field, i, 3, kPressure) * retarget::kMaxPressure));
  }
  return points;
}

}  // namespace

StrokeLog readPenStrokes(const std::filesystem::path& file, const PenOptions& options) {
  const std::string text = readTextFile(file);
  const json parsed = parseJson(text, {.file = file.string()});
  const JsonField drawing(parsed, file.string());

  StrokeLog log;
  log.bytes = text.size();
  log.header.base = options.base;
  log.header.density = options.density != 0 ? options.density : densityFor(options.base);
  validate(log.header, "options");

  const auto width = static_cast<std::uint32_t>(std::ceil(drawing.member("width").number(kSize)));
  const auto height = static_cast<std::uint32_t>(std::ceil(drawing.member("height").number(kSize)));
  const Box box = implicit::boundsOf(options.base);
  StrokeCommand command;
  const Framing framing{
      .width = width, .height = height, .fill = options.fill != 0 ? options.fill : kDefaultFill};
  command.stroke.camera = frameSphere(options.base.ball().center, options.base.ball().radius, framing);
  command.brush.radius = options.radius != 0 ? options.radius : kDefaultRadius * box.halfDiagonal();
  command.brush.trace = options.trace;
  command.brush.tip = options.tip;
  validate(command.stroke.camera, "options: camera");
  validate(command.brush, "options: brush");

  const JsonField strokes = drawing.member("strokes");
  const std::size_t count = strokes.arraySize();
  if (count == 0) strokes.refuse("an array of at least 1 stroke");
  log.commands.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    command.stroke.points = pointsOf(strokes.element(i).member("points"));
    const bool carves = options.mode == PenMode::Carve || (options.mode == PenMode::Alternate && i % 2 == 1);
    command.brush.mode = carves ? Mode::Carve : Mode::Add;
    log.commands.emplace_back(command);
  }
  return log;
}

}  // namespace restroke::sculpt
