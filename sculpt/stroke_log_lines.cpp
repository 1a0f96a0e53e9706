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
constexpr NumberRange kNode{0, 4294967294.0, "the number of a node, 0 or more"};
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
  if (brush.radii == Radii::Follow) out += ",\"radii\":\"follow\"";
  if (brush.tip) fmt::format_to(std::back_inserter(out), ",\"tip\":{}", formatVolume(*brush.tip, folder));
  out += "},";
}

// A row is [x, y, z, radius], and behind it what the brush has more of: of a sweep 1 when joined, of a tip
// its rotation.
enum class Columns : std::uint8_t { Ball = 4, Sweep = 5, Tip = 8 };

Columns columnsFor(const Brush& brush) {
  return brush.trace == Trace::Sweep ? Columns::Sweep : brush.tip ? Columns::Tip : Columns::Ball;
}

// For a line that does not know the brush: what the stamps have more of.
Columns columnsFor(const std::vector<Stamp>& stamps) {
  Columns columns = Columns::Ball;
  for (const Stamp& s : stamps) {
    if (s.rotation != Stamp{}.rotation) return Columns::Tip;
    if (s.joined) columns = Columns::Sweep;
  }
  return columns;
}

void putStamps(std::string& out, const std::vector<Stamp>& stamps, Columns columns) {
  out += "\"stamps\":[";
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const Stamp& s = stamps[i];
    fmt::format_to(std::back_inserter(out), "{}[{},{},{},{}", i == 0 ? "" : ",", formatFloat(s.center.x),
                   formatFloat(s.center.y), formatFloat(s.center.z), formatFloat(s.radius));
    if (columns == Columns::Sweep) out += s.joined ? ",1" : ",0";
    if (columns == Columns::Tip)
      for (const float q : s.rotation) fmt::format_to(std::back_inserter(out), ",{}", formatFloat(q));
    out += ']';
  }
  out += ']';
}

void putOutcome(std::string& out, const StrokeOutcome& outcome, Columns columns) {
  fmt::format_to(std::back_inserter(out), "\"misses\":{},\"pieces\":{},", outcome.misses, outcome.pieces);
  putStamps(out, outcome.stamps, columns);
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
    out += ",\"outcome\":{";
    putOutcome(out, *command.outcome, columnsFor(command.brush));
    out += '}';
  }
  return out + "}}";
}

Vec3 vecOf(const JsonField& field, const NumberRange& range) {
  if (field.arraySize() != 3) field.refuse("an array of 3 numbers");
  return {field.element(0).number32(range), field.element(1).number32(range),
          field.element(2).number32(range)};
}

NodeId nodeOf(const JsonField& field) {
  return NodeId{static_cast<std::uint32_t>(field.integer(kNode))};
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
  field.requireKeysAmong({"radius", "spacing", "pressureToRadius", "mode", "trace", "radii", "tip"});
  Brush brush{.radius = field.member("radius").number32(kRadius),
              .spacing = field.member("spacing").number32(kNumber),
              .pressureToRadius = field.member("pressureToRadius").number32(kNumber),
              .mode = modeOf(field.member("mode"))};
  if (field.has("trace")) {
    const JsonField trace = field.member("trace");
    if (trace.value() != "stamps" && trace.value() != "sweep") trace.refuse("\"stamps\" or \"sweep\"");
    brush.trace = trace.value() == "sweep" ? Trace::Sweep : Trace::Stamps;
  }
  if (field.has("radii")) {
    const JsonField radii = field.member("radii");
    if (radii.value() != "keep" && radii.value() != "follow") radii.refuse("\"keep\" or \"follow\"");
    brush.radii = radii.value() == "follow" ? Radii::Follow : Radii::Keep;
  }
  if (field.has("tip")) brush.tip = volumeOf(field.member("tip"), folder);
  return brush;
}

std::vector<Stamp> stampsOf(const JsonField& field, Columns kind) {
  const auto columns = static_cast<std::size_t>(kind);
  std::vector<Stamp> stamps(field.arraySize());
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const JsonField row = field.element(i);
    if (row.arraySize() != columns)
      row.refuse(kind == Columns::Ball    ? "an array [x, y, z, radius]"
                 : kind == Columns::Sweep ? "an array [x, y, z, radius, joined]"
                                          : "an array [x, y, z, radius, and the rotation's quaternion]");
    Stamp& stamp = stamps[i];
    stamp.center = {row.element(0).number32(kCoordinate), row.element(1).number32(kCoordinate),
                    row.element(2).number32(kCoordinate)};
    stamp.radius = row.element(3).number32(kRadius);
    if (kind == Columns::Sweep) {
      constexpr NumberRange kFlag{0, 1, "0, or 1 for a stamp that the ball came to from the one before"};
      stamp.joined = row.element(4).integer(kFlag) == 1;
      if (stamp.joined && i == 0) row.element(4).refuse("0, since no stamp comes before");
    }
    if (kind == Columns::Tip)
      for (std::size_t k = 0; k < 4; ++k) stamp.rotation[k] = row.element(4 + k).number32(kNumber);
  }
  return stamps;
}

StrokeOutcome outcomeOf(const JsonField& field, Columns columns) {
  StrokeOutcome outcome;
  outcome.misses = static_cast<std::size_t>(field.member("misses").integer(kCount));
  outcome.pieces = static_cast<std::size_t>(field.member("pieces").integer(kCount));
  outcome.stamps = stampsOf(field.member("stamps"), columns);
  return outcome;
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
    command.outcome = outcomeOf(recorded, columnsFor(command.brush));
    if (command.outcome->misses > command.stroke.points.size())
      recorded.member("misses").refuse("at most the number of points");
  }
  const std::string where = field.where() + ": stroke";
  retarget::validate(command.stroke, where);
  validate(command.brush, where);
  context.camera = command.stroke.camera;
  context.brush = command.brush;
  return command;
}

// Edits of the tree, moves of its cursor, changes of the base
// -------------------------------------------------

void putRecasts(std::string& out, const Consequences& consequences) {
  if (consequences.recasts.empty()) return;
  out += ",\"recasts\":[";
  bool first = true;
  for (const Recast& recast : consequences.recasts) {
    fmt::format_to(std::back_inserter(out), "{}{{\"node\":{},", first ? "" : ",", indexOf(recast.node));
    first = false;
    if (recast.camera) {
      putCamera(out, *recast.camera);
      fmt::format_to(std::back_inserter(out), "\"scale\":{}", formatFloat(recast.scale));
    } else if (recast.outcome) {
      putOutcome(out, *recast.outcome, columnsFor(recast.outcome->stamps));
    }
    out += '}';
  }
  out += ']';
}

std::vector<Recast> recastsOf(const JsonField& command) {
  if (!command.has("recasts")) return {};
  const JsonField field = command.member("recasts");
  std::vector<Recast> recasts(field.arraySize());
  for (std::size_t i = 0; i < recasts.size(); ++i) {
    const JsonField row = field.element(i);
    Recast& recast = recasts[i];
    recast.node = nodeOf(row.member("node"));
    if (row.has("camera")) {
      row.requireKeysAmong({"node", "camera", "scale"});
      recast.camera = cameraOf(row.member("camera"));
      recast.scale = row.member("scale").number32(kPositive);
      restroke::validate(*recast.camera, row.where() + ": " + row.path() + ".camera");
    } else {
      row.requireKeysAmong({"node", "misses", "pieces", "stamps"});
      const JsonField stamps = row.member("stamps");
      const std::size_t columns = stamps.arraySize() == 0 ? 4 : stamps.element(0).arraySize();
      recast.outcome = outcomeOf(row, columns == 8   ? Columns::Tip
                                      : columns == 5 ? Columns::Sweep
                                                     : Columns::Ball);
    }
  }
  return recasts;
}

/// The name of an edit, and how its fields are written and read.
template <class Edit>
struct EditText {
  const char* name;
  const char* extentKey = nullptr;  ///< the key whose presence means the extent that is not the default
};
constexpr EditText<UndoCommand> kUndo{"undo"};
constexpr EditText<RedoCommand> kRedo{"redo"};
constexpr EditText<GotoCommand> kGoto{"goto"};
constexpr EditText<CancelCommand> kCancel{"cancel", "branch"};
constexpr EditText<RestoreCommand> kRestore{"restore", "branch"};
constexpr EditText<MoveCommand> kMove{"move", "single"};
constexpr EditText<CopyCommand> kCopy{"copy", "single"};

/// Calls f with the EditText of each.
template <class F>
void forEachEdit(const F& f) {
  f(kUndo);
  f(kRedo);
  f(kGoto);
  f(kCancel);
  f(kRestore);
  f(kMove);
  f(kCopy);
}

template <class Edit>
std::string formatEdit(const EditText<Edit>& text, const Edit& edit) {
  std::string inside;
  if constexpr (requires { edit.node; })
    fmt::format_to(std::back_inserter(inside), ",\"node\":{}", indexOf(edit.node));
  if constexpr (requires { edit.to; })
    fmt::format_to(std::back_inserter(inside), ",\"to\":{}", indexOf(edit.to));
  if constexpr (requires { edit.extent; })
    if (edit.extent != Edit{}.extent)
      fmt::format_to(std::back_inserter(inside), ",\"{}\":true", text.extentKey);
  if constexpr (requires { edit.recasts; }) putRecasts(inside, edit);
  if (!inside.empty()) inside.erase(0, 1);
  return fmt::format("{{\"{}\":{{{}}}}}", text.name, inside);
}

template <class Edit>
Edit editOf(const EditText<Edit>& text, const JsonField& field) {
  Edit edit;
  constexpr bool kHasNode = requires { edit.node; }, kHasTo = requires { edit.to; },
                 kHasRecasts = requires { edit.recasts; };
  // A key that the edit does not have is given twice: a list of keys has a fixed length here.
  field.requireKeysAmong({kHasNode ? "node" : text.name, kHasTo ? "to" : text.name,
                          text.extentKey ? text.extentKey : text.name, kHasRecasts ? "recasts" : text.name});
  if constexpr (kHasNode) edit.node = nodeOf(field.member("node"));
  if constexpr (kHasTo) edit.to = nodeOf(field.member("to"));
  if constexpr (requires { edit.extent; })
    if (field.has(text.extentKey)) {
      const JsonField flag = field.member(text.extentKey);
      if (!flag.value().is_boolean()) flag.refuse("true or false");
      if (flag.value().template get<bool>())
        edit.extent = edit.extent == Extent::Single ? Extent::Branch : Extent::Single;
    }
  if constexpr (kHasRecasts) edit.recasts = recastsOf(field);
  return edit;
}

TransformCommand transformOf(const JsonField& field) {
  field.requireKeysAmong({"matrix", "recasts"});
  const JsonField matrix = field.member("matrix");
  TransformCommand command;
  if (matrix.arraySize() != command.matrix.size()) matrix.refuse("an array of 12 numbers, 3 rows of 4");
  for (std::size_t i = 0; i < command.matrix.size(); ++i)
    command.matrix[i] = matrix.element(i).number32(kNumber);
  command.recasts = recastsOf(field);
  return command;
}

std::string formatTransform(const TransformCommand& command) {
  std::string out = "{\"transform\":{\"matrix\":[";
  for (std::size_t i = 0; i < command.matrix.size(); ++i) {
    if (i > 0) out += ',';
    out += formatFloat(command.matrix[i]);
  }
  out += ']';
  putRecasts(out, command);
  return out + "}}";
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
  if (const auto* base = std::get_if<BaseCommand>(&command)) {
    std::string out = fmt::format("{{\"base\":{{\"shape\":{}", formatShape(base->base, context.folder));
    putRecasts(out, *base);
    return out + "}}";
  }
  if (const auto* transform = std::get_if<TransformCommand>(&command)) return formatTransform(*transform);
  std::string out;
  forEachEdit([&]<class Edit>(const EditText<Edit>& text) {
    if (const auto* edit = std::get_if<Edit>(&command)) out = formatEdit(text, *edit);
  });
  return out;
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
  field.requireKeysAmong(
      {"stroke", "fixed", "base", "transform", "undo", "redo", "goto", "cancel", "restore", "move", "copy"});
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
  if (field.has("base")) {
    const JsonField base = field.member("base");
    base.requireKeysAmong({"shape", "recasts"});
    return BaseCommand{{recastsOf(base)}, shapeOf(base.member("shape"), context.folder)};
  }
  if (field.has("transform")) return transformOf(field.member("transform"));
  std::optional<Command> edit;
  forEachEdit([&]<class Edit>(const EditText<Edit>& one) {
    if (field.has(one.name)) edit = editOf(one, field.member(one.name));
  });
  return std::move(edit).value();
}

}  // namespace restroke::sculpt
