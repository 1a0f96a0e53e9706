#include "sculpt/stroke_log_lines.h"

#include <bit>
#include <cstdlib>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "implicit/errors.h"
#include "sculpt/document.h"
#include "sculpt/shape_text.h"
#include "sculpt/stroke_log.h"

namespace restroke::sculpt {

using nlohmann::json;

namespace {

constexpr double kAny = 3.4e38;
constexpr NumberRange kNumber{-kAny, kAny, "a number within the range of float32"};
constexpr NumberRange kCoordinate{-kMaxCoordinate, kMaxCoordinate, "a number within +-1e6"};
constexpr NumberRange kRadius{1e-30, kMaxCoordinate, "a number more than 0 and at most 1e6"};
constexpr NumberRange kPositive{1e-30, kAny, "a number more than 0"};
constexpr NumberRange kScreen{-(1 << 24), 1 << 24, "a whole number of 1/16 pixels within +-2^24"};
constexpr NumberRange kTime{0, 2147483647.0, "a whole number of milliseconds from 0 to 2^31 - 1"};
constexpr NumberRange kPressure{0, retarget::kMaxPressure, "a whole number from 0 to 1023"};
constexpr NumberRange kViewport{1, 65536, "a whole number from 1 to 65536"};
constexpr NumberRange kCount{0, 9007199254740992.0, "a whole number, 0 or more"};

std::string_view nameOf(Mode mode) {
  return mode == Mode::Add ? "add" : "carve";
}

void putVec(std::string& out, Vec3 v) {
  fmt::format_to(std::back_inserter(out), "[{},{},{}]", formatFloat(v.x), formatFloat(v.y), formatFloat(v.z));
}

void putSpheres(std::string& out, const char* key, const auto& spheres) {
  fmt::format_to(std::back_inserter(out), "\"{}\":[", key);
  bool first = true;
  for (const implicit::Sphere& s : spheres) {
    fmt::format_to(std::back_inserter(out), "{}[{},{},{},{}]", first ? "" : ",", formatFloat(s.center.x),
                   formatFloat(s.center.y), formatFloat(s.center.z), formatFloat(s.radius));
    first = false;
  }
  out += ']';
}

void putCamera(std::string& out, const Camera& camera) {
  out += "\"camera\":{\"position\":";
  putVec(out, camera.position);
  out += ",\"view\":";
  putVec(out, camera.view);
  out += ",\"up\":";
  putVec(out, camera.up);
  fmt::format_to(std::back_inserter(out), ",\"halfHeight\":{},\"viewport\":[{},{}],\"near\":{},\"far\":{}}},",
                 formatFloat(camera.halfHeight), camera.width, camera.height, formatFloat(camera.near),
                 formatFloat(camera.far));
}

void putBrush(std::string& out, const Brush& brush, const std::filesystem::path& folder) {
  fmt::format_to(std::back_inserter(out),
                 "\"brush\":{{\"radius\":{},\"spacing\":{},\"pressureToRadius\":{},\"mode\":\"{}\"",
                 formatFloat(brush.radius), formatFloat(brush.spacing), formatFloat(brush.pressureToRadius),
                 nameOf(brush.mode));
  if (brush.trace == Trace::Sweep) out += ",\"trace\":\"sweep\"";
  if (brush.tip) fmt::format_to(std::back_inserter(out), ",\"tip\":{}", formatVolume(*brush.tip, folder));
  out += "},";
}

// [x, y, z, radius], and behind it what the brush has more of: of a sweep 1 when joined, of a tip its
// rotation.
void putStamps(std::string& out, const std::vector<Stamp>& stamps, const Brush& brush) {
  out += "\"stamps\":[";
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const Stamp& s = stamps[i];
    fmt::format_to(std::back_inserter(out), "{}[{},{},{},{}", i == 0 ? "" : ",", formatFloat(s.center.x),
                   formatFloat(s.center.y), formatFloat(s.center.z), formatFloat(s.radius));
    if (brush.trace == Trace::Sweep) out += s.joined ? ",1" : ",0";
    if (brush.tip)
      for (const float q : s.rotation) fmt::format_to(std::back_inserter(out), ",{}", formatFloat(q));
    out += ']';
  }
  out += ']';
}

std::string formatStroke(const StrokeCommand& command, LineContext& context) {
  std::string out = "{\"stroke\":{";
  if (context.camera != command.stroke.camera) putCamera(out, command.stroke.camera);
  if (context.brush != command.brush) putBrush(out, command.brush, context.folder);
  context.camera = command.stroke.camera;
  context.brush = command.brush;
  fmt::format_to(std::back_inserter(out), "\"method\":\"{}\",\"points\":[", retarget::nameOf(command.method));
  bool first = true;
  for (const retarget::StrokePoint& p : command.stroke.points) {
    fmt::format_to(std::back_inserter(out), "{}[{},{},{},{}]", first ? "" : ",", p.screen.x, p.screen.y,
                   p.time, p.pressure);
    first = false;
  }
  out += ']';
  if (command.outcome) {
    fmt::format_to(std::back_inserter(out), ",\"outcome\":{{\"misses\":{},\"pieces\":{},",
                   command.outcome->misses, command.outcome->pieces);
    putStamps(out, command.outcome->stamps, command.brush);
    out += '}';
  }
  return out + "}}";
}

Vec3 vecOf(const JsonField& field, const NumberRange& range) {
  if (field.arraySize() != 3) field.refuse("an array of 3 numbers");
  return {field.element(0).number32(range), field.element(1).number32(range),
          field.element(2).number32(range)};
}

std::vector<implicit::Sphere> spheresOf(const JsonField& field) {
  std::vector<implicit::Sphere> spheres(field.arraySize());
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const JsonField row = field.element(i);
    if (row.arraySize() != 4) row.refuse("an array [x, y, z, radius]");
    spheres[i].center = {row.element(0).number32(kCoordinate), row.element(1).number32(kCoordinate),
                         row.element(2).number32(kCoordinate)};
    spheres[i].radius = row.element(3).number32(kRadius);
  }
  return spheres;
}

Mode modeOf(const JsonField& field) {
  const std::string name = field.value().is_string() ? field.string() : std::string();
  if (name == "add") return Mode::Add;
  if (name == "carve") return Mode::Carve;
  field.refuse("\"add\" or \"carve\"");
}

Camera cameraOf(const JsonField& field) {
  field.requireKeysAmong({"position", "view", "up", "halfHeight", "viewport", "near", "far"});
  Camera camera;
  camera.position = vecOf(field.member("position"), kNumber);
  camera.view = vecOf(field.member("view"), kNumber);
  camera.up = vecOf(field.member("up"), kNumber);
  camera.halfHeight = field.member("halfHeight").number32(kPositive);
  const JsonField viewport = field.member("viewport");
  if (viewport.arraySize() != 2) viewport.refuse("an array [width, height]");
  camera.width = static_cast<std::uint32_t>(viewport.element(0).integer(kViewport));
  camera.height = static_cast<std::uint32_t>(viewport.element(1).integer(kViewport));
  camera.near = field.member("near").number32(kPositive);
  camera.far = field.member("far").number32(kPositive);
  return camera;
}

Brush brushOf(const JsonField& field, const std::filesystem::path& folder) {
  field.requireKeysAmong({"radius", "spacing", "pressureToRadius", "mode", "trace", "tip"});
  Brush brush{.radius = field.member("radius").number32(kRadius),
              .spacing = field.member("spacing").number32(kNumber),
              .pressureToRadius = field.member("pressureToRadius").number32(kNumber),
              .mode = modeOf(field.member("mode"))};
  if (field.has("trace")) {
    const JsonField trace = field.member("trace");
    if (trace.value() != "stamps" && trace.value() != "sweep") trace.refuse("\"stamps\" or \"sweep\"");
    brush.trace = trace.value() == "sweep" ? Trace::Sweep : Trace::Stamps;
  }
  if (field.has("tip")) brush.tip = volumeOf(field.member("tip"), folder);
  return brush;
}

std::vector<Stamp> stampsOf(const JsonField& field, const Brush& brush) {
  const std::size_t columns = brush.trace == Trace::Sweep ? 5 : brush.tip ? 8 : 4;
  std::vector<Stamp> stamps(field.arraySize());
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const JsonField row = field.element(i);
    if (row.arraySize() != columns)
      row.refuse(columns == 4   ? "an array [x, y, z, radius]"
                 : columns == 5 ? "an array [x, y, z, radius, joined]"
                                : "an array [x, y, z, radius, and the rotation's quaternion]");
    Stamp& stamp = stamps[i];
    stamp.center = {row.element(0).number32(kCoordinate), row.element(1).number32(kCoordinate),
                    row.element(2).number32(kCoordinate)};
    stamp.radius = row.element(3).number32(kRadius);
    if (columns == 5) {
      constexpr NumberRange kFlag{0, 1, "0, or 1 for a stamp that the ball came to from the one before"};
      stamp.joined = row.element(4).integer(kFlag) == 1;
      if (stamp.joined && i == 0) row.element(4).refuse("0, since no stamp comes before");
    }
    if (columns == 8)
      for (std::size_t k = 0; k < 4; ++k) stamp.rotation[k] = row.element(4 + k).number32(kNumber);
  }
  return stamps;
}

std::vector<retarget::StrokePoint> pointsOf(const JsonField& field) {
  std::vector<retarget::StrokePoint> points(field.arraySize());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const json& row = field.value()[i];
    const auto whole = [&](std::size_t k, const NumberRange& range) -> std::int64_t {
      // A stroke may have a million points: names of fields are only made for messages.
      if (!row[k].is_number_integer()) field.element(i).element(k).refuse(range.rule);
      const auto value = row[k].get<double>();
      if (!(value >= range.min && value <= range.max)) field.element(i).element(k).refuse(range.rule);
      return row[k].get<std::int64_t>();
    };
    if (!row.is_array() || row.size() != 4)
      field.element(i).refuse("an array [x, y, milliseconds, pressure]");
    points[i].screen = {static_cast<std::int32_t>(whole(0, kScreen)),
                        static_cast<std::int32_t>(whole(1, kScreen))};
    points[i].time = static_cast<std::uint32_t>(whole(2, kTime));
    points[i].pressure = static_cast<std::uint16_t>(whole(3, kPressure));
    if (i > 0 && points[i].time < points[i - 1].time)
      field.element(i).element(2).refuse("no earlier than the point before it");
  }
  return points;
}

StrokeCommand strokeOf(const JsonField& field, LineContext& context) {
  field.requireKeysAmong({"camera", "brush", "method", "points", "outcome"});
  StrokeCommand command;
  if (field.has("camera")) {
    command.stroke.camera = cameraOf(field.member("camera"));
  } else {
    if (!context.camera)
      throw InputError(fmt::format(
          "{}: stroke.camera is missing, but the first stroke of a log must have one", field.where()));
    command.stroke.camera = *context.camera;
  }
  if (field.has("brush")) {
    command.brush = brushOf(field.member("brush"), context.folder);
  } else {
    if (!context.brush)
      throw InputError(fmt::format("{}: stroke.brush is missing, but the first stroke of a log must have one",
                                   field.where()));
    command.brush = *context.brush;
  }
  const JsonField method = field.member("method");
  try {
    command.method = retarget::methodNamed(method.string());
  } catch (const InputError& error) {
    if (!method.value().is_string()) throw;
    throw InputError(fmt::format("{}: stroke.method: {}", field.where(), error.what()));
  }
  command.stroke.points = pointsOf(field.member("points"));
  if (field.has("outcome")) {
    const JsonField recorded = field.member("outcome");
    if (retarget::isDeterministic(command.method))
      throw InputError(
          fmt::format("{}: stroke.outcome stands beside the method {}, but is only for methods whose result "
                      "depends on the machine",
                      field.where(), retarget::nameOf(command.method)));
    recorded.requireKeysAmong({"misses", "pieces", "stamps"});
    StrokeOutcome outcome;
    outcome.misses = static_cast<std::size_t>(recorded.member("misses").integer(kCount));
    outcome.pieces = static_cast<std::size_t>(recorded.member("pieces").integer(kCount));
    if (outcome.misses > command.stroke.points.size())
      recorded.member("misses").refuse("at most the number of points");
    outcome.stamps = stampsOf(recorded.member("stamps"), command.brush);
    command.outcome = std::move(outcome);
  }
  const std::string where = field.where() + ": stroke";
  retarget::validate(command.stroke, where);
  validate(command.brush, where);
  context.camera = command.stroke.camera;
  context.brush = command.brush;
  return command;
}

std::string whereOf(const TextOrigin& origin) {
  return fmt::format("{}:{}", origin.file, origin.line);
}

}  // namespace

std::string formatFloat(float value) {
  // JSON's -0 would be read as the integer 0.
  if (value == 0) return std::signbit(value) ? "-0.0" : "0";
  std::string text = fmt::format("{}", value);
  // Readers go through double; the few shortest forms that this rounds to a neighbour are written with nine
  // digits.
  if (std::bit_cast<std::uint32_t>(static_cast<float>(std::strtod(text.c_str(), nullptr))) !=
      std::bit_cast<std::uint32_t>(value))
    text = fmt::format("{:.9g}", value);
  return text;
}

std::string formatHeader(const LogHeader& header, const std::filesystem::path& folder) {
  return fmt::format("{{\"restroke\":{},\"unit\":\"{}\",\"density\":{},\"grid\":{},\"base\":{}}}",
                     kLogVersion, header.unit, formatFloat(header.density), formatFloat(header.grid),
                     formatShape(header.base, folder));
}

std::string formatCommand(const Command& command, LineContext& context) {
  if (const auto* stroke = std::get_if<StrokeCommand>(&command)) return formatStroke(*stroke, context);
  if (const auto* fixed = std::get_if<FixedCommand>(&command)) {
    std::string out = fmt::format("{{\"fixed\":{{\"mode\":\"{}\",", nameOf(fixed->mode));
    putSpheres(out, "stamps", fixed->stamps);
    if (!fixed->shapes.empty()) {
      out += ",\"shapes\":[";
      for (std::size_t i = 0; i < fixed->shapes.size(); ++i)
        fmt::format_to(std::back_inserter(out), "{}{}", i == 0 ? "" : ",",
                       formatShape(fixed->shapes[i], context.folder));
      out += ']';
    }
    out += "}}";
    return out;
  }
  return std::holds_alternative<UndoCommand>(command) ? "{\"undo\":{}}" : "{\"redo\":{}}";
}

LogHeader parseHeader(std::string_view line, const TextOrigin& origin, const std::filesystem::path& folder) {
  const json text = parseJson(line, origin);
  const JsonField field(text, whereOf(origin));
  if (!field.has("restroke"))
    throw InputError(fmt::format(
        "{}: the key \"restroke\" is missing, but the first line of a log must be its header with the "
        "format version there",
        whereOf(origin)));
  const std::int64_t version = field.member("restroke").integer({1, 1e9, "a format version, 1 or more"});
  if (version > kLogVersion)
    throw InputError(fmt::format(
        "{}: the log has format version {}, but this program reads up to version {}; a Restroke that "
        "reads version {} is needed",
        whereOf(origin), version, kLogVersion, version));
  field.requireKeysAmong({"restroke", "unit", "density", "grid", "base"});
  LogHeader header;
  header.version = static_cast<int>(version);
  header.unit = field.member("unit").string();
  header.density = field.member("density").number32(kPositive);
  header.grid = field.member("grid").number32(kPositive);
  header.base = shapeOf(field.member("base"), folder);
  validate(header, whereOf(origin));
  return header;
}

Command parseCommand(std::string_view line, const TextOrigin& origin, LineContext& context) {
  const json text = parseJson(line, origin);
  const JsonField field(text, whereOf(origin));
  field.requireKeysAmong({"stroke", "fixed", "undo", "redo"});
  if (text.size() != 1) field.refuse("an object with exactly one command");
  if (field.has("stroke")) return strokeOf(field.member("stroke"), context);
  if (field.has("fixed")) {
    const JsonField fixed = field.member("fixed");
    fixed.requireKeysAmong({"mode", "stamps", "shapes"});
    FixedCommand command{modeOf(fixed.member("mode")), spheresOf(fixed.member("stamps"))};
    if (fixed.has("shapes")) {
      const JsonField shapes = fixed.member("shapes");
      for (std::size_t i = 0; i < shapes.arraySize(); ++i)
        command.shapes.push_back(shapeOf(shapes.element(i), context.folder));
    }
    return command;
  }
  const char* name = field.has("undo") ? "undo" : "redo";
  field.member(name).requireKeysAmong({});
  if (field.has("undo")) return UndoCommand{};
  return RedoCommand{};
}

}  // namespace restroke::sculpt
