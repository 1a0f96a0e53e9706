#include "sculpt/shape_text.h"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "implicit/errors.h"
#include "points/files/mesh_files.h"
#include "points/isosurface/winding_source.h"
#include "sculpt/stroke_log_lines.h"
#include "sculpt/text_file.h"

namespace restroke::sculpt {

using implicit::ParameterInfo;
using implicit::Pose;
using implicit::PosedVolume;
using implicit::Shape;
using implicit::Volume;
using implicit::VolumeKind;
using implicit::VolumeParameters;
using Form = ParameterInfo::Form;

namespace {

constexpr NumberRange kNumber{-3.4e38, 3.4e38, "a number within the range of float32"};
constexpr NumberRange kCoordinate{-kMaxCoordinate, kMaxCoordinate, "a number within +-1e6"};
constexpr NumberRange kRadius{1e-30, kMaxCoordinate, "a number more than 0 and at most 1e6"};

std::size_t columnsOf(Form form) {
  return form == Form::Points ? 3 : form == Form::ProfilePoints ? 2 : 1;
}

void putNumbers(std::string& out, const float* numbers, std::size_t count) {
  out += '[';
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0) out += ',';
    out += formatFloat(numbers[i]);
  }
  out += ']';
}

void putMesh(std::string& out, const implicit::MeshSource& mesh, const std::filesystem::path& folder) {
  if (mesh.file.empty()) {  // embedded
    out += "\"vertices\":[";
    bool first = true;
    for (const Point v : mesh.mesh.vertices) {
      if (!std::exchange(first, false)) out += ',';
      putNumbers(out, &v.x, 3);
    }
    out += "],\"triangles\":[";
    first = true;
    for (const auto& t : mesh.mesh.triangles)
      out += fmt::format("{}[{},{},{}]", std::exchange(first, false) ? "" : ",", t[0], t[1], t[2]);
    out += ']';
    return;
  }
  const std::filesystem::path file = std::filesystem::absolute(mesh.file).lexically_normal();
  const auto base = std::filesystem::absolute(folder.empty() ? "." : folder).lexically_normal();
  out += fmt::format("\"file\":{},\"hash\":\"{:016x}\"",
                     nlohmann::json(file.lexically_relative(base).generic_string()).dump(), mesh.hash);
  if (mesh.repaired) out += ",\"repair\":\"winding\"";
}

std::string formatKind(const Volume& volume, const Pose* pose, const std::filesystem::path& folder) {
  const VolumeKind& kind = volume.kind();
  const VolumeParameters& values = volume.parameters();
  std::string out = fmt::format("{{\"{}\":{{", kind.name);
  for (std::size_t p = 0; p < kind.parameters.size(); ++p) {
    const ParameterInfo& info = kind.parameters[p];
    if (p > 0) out += ",";
    if (info.form == Form::Mesh) {
      putMesh(out, *values.mesh, folder);
      continue;
    }
    out += fmt::format("\"{}\":", info.name);
    const std::vector<float>& numbers = values.values[p];
    const std::size_t columns = columnsOf(info.form);
    if (info.form == Form::Number) {
      out += formatFloat(numbers[0]);
      continue;
    }
    out += '[';
    for (std::size_t i = 0; i < numbers.size(); i += columns) {
      if (i > 0) out += ',';
      putNumbers(out, &numbers[i], columns);
    }
    out += ']';
  }
  if (pose) {
    const Pose none;
    if (pose->position != none.position) {
      out += ",\"position\":";
      putNumbers(out, &pose->position.x, 3);
    }
    if (pose->rotation != none.rotation) {
      out += ",\"rotation\":";
      putNumbers(out, pose->rotation.data(), 4);
    }
    if (pose->scale != none.scale) out += fmt::format(",\"scale\":{}", formatFloat(pose->scale));
  }
  out += "}}";
  return out;
}

std::vector<float> numbersOf(const JsonField& field, std::size_t columns) {
  std::vector<float> numbers;
  const std::size_t rows = field.arraySize();
  for (std::size_t i = 0; i < rows; ++i) {
    const JsonField row = field.element(i);
    if (row.arraySize() != columns) row.refuse(fmt::format("an array of {} numbers", columns));
    for (std::size_t k = 0; k < columns; ++k) numbers.push_back(row.element(k).number32(kNumber));
  }
  return numbers;
}

// Adds the place to what a volume says of its parameters.
template <class F>
decltype(auto) placed(const std::string& where, const F& f) {
  try {
    return f();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", where, error.what()));
  }
}

// The mesh in the bytes of a file.
std::shared_ptr<const implicit::MeshSource> sourceIn(const std::string& bytes,
                                                     const std::filesystem::path& file, Repair repair,
                                                     const RepairNote& note) {
  auto source = std::make_shared<implicit::MeshSource>();
  source->mesh = points::parseMesh(bytes, file);
  source->file = file.string();
  source->hash = XXH3_64bits(bytes.data(), bytes.size());
  if (repair == Repair::None) return source;
  using Way = points::Repaired::Way;
  points::Repaired repaired = placed(file.string(), [&] { return points::repairByWinding(source->mesh); });
  if (repaired.way == Way::None) return source;
  source->mesh = std::move(repaired.mesh);
  source->repaired = true;
  if (note)
    note(fmt::format(
        "{} is no boundary of a solid: {}; {}", file.string(), describe(repaired.faults),
        repaired.way == Way::TurnedAround
            ? std::string("its triangles were turned around")
            : fmt::format("a solid of {} triangles was made of it by the generalised winding number at "
                          "resolution {}",
                          source->mesh.triangles.size(), points::kRepairResolution)));
  return source;
}

std::shared_ptr<const implicit::MeshSource> meshOf(const JsonField& field,
                                                   const std::filesystem::path& folder) {
  if (field.has("file")) {
    const std::string file = field.member("file").string();
    Repair repair = Repair::None;
    if (field.has("repair")) {
      if (field.member("repair").value() != "winding") field.member("repair").refuse("\"winding\"");
      repair = Repair::Winding;
    }
    const std::filesystem::path path = folder / file;
    const std::string place = fmt::format("{}: {}", field.where(), field.path());
    const std::string bytes = placed(place, [&] { return readTextFile(path); });
    // Before anything is made of it.
    const std::string hash = field.member("hash").string(),
                      found = fmt::format("{:016x}", XXH3_64bits(bytes.data(), bytes.size()));
    if (hash != found)
      throw InputError(
          fmt::format("{}: {}.hash is {}, but the file {} has the hash {}; the log was made on another "
                      "mesh",
                      field.where(), field.path(), hash, path.string(), found));
    return placed(place, [&] { return sourceIn(bytes, path, repair, {}); });
  }
  auto source = std::make_shared<implicit::MeshSource>();
  const std::vector<float> numbers = numbersOf(field.member("vertices"), 3);
  for (std::size_t i = 0; i < numbers.size(); i += 3)
    source->mesh.vertices.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
  const JsonField triangles = field.member("triangles");
  const NumberRange index{0, static_cast<double>(source->mesh.vertices.size()) - 1, "the number of a vertex"};
  for (std::size_t i = 0; i < triangles.arraySize(); ++i) {
    const JsonField row = triangles.element(i);
    if (row.arraySize() != 3) row.refuse("an array of 3 vertex numbers");
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k)
      triangle[k] = static_cast<std::uint32_t>(row.element(k).integer(index));
    source->mesh.triangles.push_back(triangle);
  }
  return source;
}

// The one member of an object, which names the kind.
std::pair<std::string, JsonField> onlyMember(const JsonField& field) {
  if (!field.value().is_object() || field.value().size() != 1)
    field.refuse("an object with one member, the kind of volume");
  const std::string name = field.value().begin().key();
  return {name, field.member(name.c_str())};
}

void requireKeys(const JsonField& field, const VolumeKind& kind, bool posed) {
  if (!field.value().is_object()) field.refuse("an object");
  for (const auto& [key, value] : field.value().items()) {
    bool known = posed && (key == "position" || key == "rotation" || key == "scale");
    for (const ParameterInfo& info : kind.parameters)
      known = known || key == info.name ||
              (info.form == Form::Mesh && (key == "file" || key == "hash" || key == "repair" ||
                                           key == "vertices" || key == "triangles"));
    if (!known)
      throw InputError(fmt::format("{}: {} has the key \"{}\", which a {} does not have", field.where(),
                                   field.path(), key, kind.name));
  }
}

std::shared_ptr<const Volume> volumeIn(const JsonField& field, const VolumeKind& kind,
                                       const std::filesystem::path& folder) {
  VolumeParameters parameters;
  for (const ParameterInfo& info : kind.parameters) {
    std::vector<float>& values = parameters.values.emplace_back();
    if (info.form == Form::Mesh) {
      parameters.mesh = meshOf(field, folder);
    } else if (info.form != Form::Number) {
      values = numbersOf(field.member(info.name.data()), columnsOf(info.form));
    } else if (info.optional && !field.has(info.name.data())) {
      values = {0};
    } else {
      values = {field.member(info.name.data()).number32(kNumber)};
    }
  }
  return placed(fmt::format("{}: {}", field.where(), field.path()), [&] { return kind.make(parameters); });
}

const VolumeKind& kindOf(const JsonField& field, const std::string& name) {
  return placed(fmt::format("{}: {}", field.where(), field.path()),
                [&]() -> const VolumeKind& { return implicit::volumeKindNamed(name); });
}

// Numbers between commas; nothing when the text is anything else.
std::optional<std::vector<float>> numbersBetweenCommas(std::string_view text) {
  std::vector<float> numbers;
  while (true) {
    float value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{}) return std::nullopt;
    numbers.push_back(value);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    if (text.empty()) return numbers;
    if (text.front() != ',') return std::nullopt;
    text.remove_prefix(1);
  }
}

std::string usageOf(const VolumeKind& kind) {
  std::string out = fmt::format("{}:", kind.name);
  for (const ParameterInfo& info : kind.parameters)
    out += fmt::format("{}{}=...", out.ends_with(':') ? "" : ",", info.name);
  return out;
}

// "radius=1,tube=0.3" after the kind's name. A value goes on until the next name.
std::shared_ptr<const Volume> volumeInWords(const VolumeKind& kind, std::string_view text,
                                            std::string_view option) {
  VolumeParameters parameters;
  parameters.values.resize(kind.parameters.size());
  const auto refuse = [&](const std::string& what) {
    throw InputError(fmt::format("{}: {}; it must be {}", option, what, usageOf(kind)));
  };
  while (!text.empty()) {
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos) refuse(fmt::format("\"{}\" names no value", text));
    const std::string_view name = text.substr(0, equals);
    std::size_t end = text.find('=', equals + 1);
    end = end == std::string_view::npos ? text.size() : text.rfind(',', end);
    const std::string_view value = text.substr(equals + 1, end - equals - 1);
    std::size_t p = 0;
    while (p < kind.parameters.size() && kind.parameters[p].name != name) ++p;
    if (p == kind.parameters.size()) refuse(fmt::format("a {} has no \"{}\"", kind.name, name));
    const auto numbers = numbersBetweenCommas(value);
    if (!numbers || numbers->size() % columnsOf(kind.parameters[p].form) != 0 ||
        (kind.parameters[p].form == Form::Number && numbers->size() != 1))
      refuse(fmt::format("the {} of a {} cannot be \"{}\"", name, kind.name, value));
    parameters.values[p] = *numbers;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  for (std::size_t p = 0; p < kind.parameters.size(); ++p)
    if (parameters.values[p].empty()) {
      if (!kind.parameters[p].optional)
        refuse(fmt::format("a {} lacks its {}", kind.name, kind.parameters[p].name));
      parameters.values[p] = {0};
    }
  return placed(std::string(option), [&] { return kind.make(parameters); });
}

bool isKind(std::string_view name) {
  return std::ranges::any_of(implicit::volumeKinds(),
                             [&](const VolumeKind* kind) { return kind->name == name; });
}

// A kind with its numbers, or a mesh file.
std::shared_ptr<const Volume> volumeNamed(std::string_view text, Repair repair, std::string_view option,
                                          const RepairNote& note) {
  const std::size_t colon = text.find(':');
  const std::string_view name = text.substr(0, colon);
  if (isKind(name) && name != "mesh")
    return volumeInWords(implicit::volumeKindNamed(name),
                         colon == std::string_view::npos ? std::string_view() : text.substr(colon + 1),
                         option);
  if (!isKind("mesh") || !std::filesystem::exists(std::filesystem::path(text)))
    return placed(fmt::format("{}: \"{}\" is no file", option, text),
                  [&] { return implicit::volumeKindNamed(name).make({}); });
  return placed(std::string(option), [&] {
    return implicit::volumeKindNamed("mesh").make(
        {{{}}, readMeshSource(std::filesystem::path(text), repair, note)});
  });
}

}  // namespace

std::string formatVolume(const Volume& volume, const std::filesystem::path& folder) {
  return formatKind(volume, nullptr, folder);
}

std::string formatShape(const Shape& shape, const std::filesystem::path& folder) {
  if (!shape.isSphere()) return formatKind(shape.volume()->volume(), &shape.volume()->pose(), folder);
  std::string out = "{\"sphere\":{\"center\":";
  putNumbers(out, &shape.ball().center.x, 3);
  out += fmt::format(",\"radius\":{}}}}}", formatFloat(shape.ball().radius));
  return out;
}

std::shared_ptr<const Volume> volumeOf(const JsonField& field, const std::filesystem::path& folder) {
  const auto [name, member] = onlyMember(field);
  const VolumeKind& kind = kindOf(field, name);
  requireKeys(member, kind, false);
  return volumeIn(member, kind, folder);
}

Shape shapeOf(const JsonField& field, const std::filesystem::path& folder) {
  const auto [name, member] = onlyMember(field);
  const auto vec = [](const JsonField& f) {
    if (f.arraySize() != 3) f.refuse("an array of 3 numbers");
    return Point(f.element(0).number32(kCoordinate), f.element(1).number32(kCoordinate),
                 f.element(2).number32(kCoordinate));
  };
  if (name == "sphere") {
    member.requireKeysAmong({"center", "radius"});
    return {vec(member.member("center")), member.member("radius").number32(kRadius)};
  }
  const VolumeKind& kind = kindOf(field, name);
  requireKeys(member, kind, true);
  Pose pose;
  if (member.has("position")) pose.position = vec(member.member("position"));
  if (member.has("rotation")) {
    const JsonField rotation = member.member("rotation");
    if (rotation.arraySize() != 4) rotation.refuse("an array of 4 numbers, the quaternion x, y, z, w");
    for (std::size_t i = 0; i < 4; ++i) pose.rotation[i] = rotation.element(i).number32(kNumber);
  }
  if (member.has("scale")) pose.scale = member.member("scale").number32(kRadius);
  const auto volume = volumeIn(member, kind, folder);
  return placed(fmt::format("{}: {}", field.where(), field.path()),
                [&] { return Shape(std::make_shared<const PosedVolume>(volume, pose)); });
}

Shape shapeNamed(std::string_view text, Repair repair, std::string_view option, const RepairNote& note) {
  if (text == "sphere") return {};
  constexpr std::string_view kSphere = "sphere:";
  if (text.starts_with(kSphere)) {
    const auto numbers = numbersBetweenCommas(text.substr(kSphere.size()));
    if (!numbers || numbers->size() != 4)
      throw InputError(
          fmt::format("{}: \"{}\" must have four numbers behind sphere: (x,y,z,r)", option, text));
    const std::vector<float>& n = *numbers;
    const Shape sphere({n[0], n[1], n[2]}, n[3]);
    return placed(std::string(option), [&] {
      validate(implicit::Primitive{sphere, implicit::Sign::Positive});
      return sphere;
    });
  }
  const auto volume = volumeNamed(text, repair, option, note);
  return placed(std::string(option),
                [&] { return Shape(std::make_shared<const PosedVolume>(volume, Pose{})); });
}

std::shared_ptr<const Volume> tipNamed(std::string_view text, Repair repair, std::string_view option,
                                       const RepairNote& note) {
  if (text == "ball") return nullptr;
  return volumeNamed(text, repair, option, note);
}

std::string describeKinds() {
  std::string out;
  for (const VolumeKind* kind : implicit::volumeKinds()) {
    out += fmt::format("{:<18}{}\n", kind->name, kind->summary);
    for (const ParameterInfo& info : kind->parameters)
      out += fmt::format("{:<18}  {}: {}\n", "", info.name, info.meaning);
  }
  return out;
}

std::shared_ptr<const implicit::MeshSource> readMeshSource(const std::filesystem::path& file, Repair repair,
                                                           const RepairNote& note) {
  return sourceIn(readTextFile(file), file, repair, note);
}

}  // namespace restroke::sculpt
