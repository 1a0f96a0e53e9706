#include "points/dexel/tridexel_file.h"

#include <xxhash.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <system_error>

#include "implicit/atomic_file.h"
#include "implicit/errors.h"
#include "implicit/primitive_list.h"
#include "implicit/process_memory.h"
#include "points/dexel/file_bytes.h"
#include "points/dexel/line_columns.h"

namespace restroke::points {

namespace {

using implicit::Primitive;
using implicit::Shape;
using implicit::Sign;
using implicit::Volume;

constexpr std::string_view kMagic = "TRIDEXEL";
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kHeader = 40, kHashed = 32;
// Depths of neighbours differ by noise that no level packs: beyond this one zstd only takes longer.
constexpr int kLevel = 6;

std::uint64_t hashOf(std::string_view start, std::string_view frame) {
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                              XXH3_freeState);
  XXH3_64bits_reset(state.get());
  XXH3_64bits_update(state.get(), start.data(), start.size());
  XXH3_64bits_update(state.get(), frame.data(), frame.size());
  return XXH3_64bits_digest(state.get());
}

// Writing ---------------------------------------------------------------------------------------------------

class BodyWriter {
 public:
  BodyWriter(const TriDexelDocument& document, const std::filesystem::path& name)
      : document_(document), name_(name) {}

  [[nodiscard]] std::string write() {
    const DexelGrid::Parts grid = document_.model.grid().parts();
    for (int a = 0; a < 3; ++a) out_.put(grid.anchor[a]);
    out_.put(grid.cell);
    for (const int first : grid.first) out_.put(std::int32_t{first});
    for (const int count : grid.counts) out_.put(std::int32_t{count});
    findVolumes();
    putCount(volumes_.size(), "volumes");
    for (const Volume* volume : volumes_) putVolume(*volume);
    putInitial();
    putCount(document_.tools.size(), "tools");
    for (const TriangleMesh& mesh : document_.tools) putMesh(mesh);
    putCount(document_.operations.size(), "operations");
    for (const TriDexelDocument::Operation& operation : document_.operations) putOperation(operation);
    refuseUnknownOperations();
    for (int axis = 0; axis < 3; ++axis) putLines(out_, document_.model.family(axis));
    return out_.bytes();
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(fmt::format("{}: {}", name_.string(), what));
  }
  void putCount(std::size_t count, std::string_view what) {
    if (count >= 0xffffffffu)
      refuse(fmt::format("there are {} {}; a .tridexel file holds less than 2^32", count, what));
    out_.put(static_cast<std::uint32_t>(count));
  }
  void putPoint(Point p) {
    for (int a = 0; a < 3; ++a) out_.put(p[a]);
  }

  // In the order in which they are first used; one that is shared is written once.
  void findVolumes() {
    const auto add = [&](const Shape& shape) {
      if (shape.isSphere()) return;
      const Volume* const volume = &shape.volume()->volume();
      if (numbers_.emplace(volume, static_cast<std::uint32_t>(volumes_.size())).second)
        volumes_.push_back(volume);
    };
    if (const auto* primitives = std::get_if<std::vector<Primitive>>(&document_.initial))
      for (const Primitive& primitive : *primitives) add(primitive.shape);
    for (const TriDexelDocument::Operation& operation : document_.operations)
      if (const auto* shape = std::get_if<Shape>(&operation.tool)) add(*shape);
  }

  void putVolume(const Volume& volume) {
    const std::string_view kind = volume.kind().name;
    out_.put(static_cast<std::uint8_t>(kind.size()));
    out_.put(kind);
    const implicit::VolumeParameters& parameters = volume.parameters();
    out_.put(static_cast<std::uint8_t>(parameters.values.size()));
    for (const std::vector<float>& values : parameters.values) {
      putCount(values.size(), "values of a parameter");
      for (const float value : values) out_.put(value);
    }
    out_.put(static_cast<std::uint8_t>(parameters.mesh ? 1 : 0));
    if (!parameters.mesh) return;
    putMesh(parameters.mesh->mesh);
    putCount(parameters.mesh->file.size(), "letters of a file's name");
    out_.put(std::string_view(parameters.mesh->file));
    out_.put(parameters.mesh->hash);
    out_.put(static_cast<std::uint8_t>(parameters.mesh->repaired ? 1 : 0));
  }

  void putMesh(const TriangleMesh& mesh) {
    putCount(mesh.vertices.size(), "vertices");
    putCount(mesh.triangles.size(), "triangles");
    for (const Point p : mesh.vertices) {
      if (!isFinite(p)) refuse("a vertex of a mesh is not finite; it must be");
      putPoint(p);
    }
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t v : triangle) {
        if (v >= mesh.vertices.size())
          refuse(fmt::format("a triangle names vertex {} of {}; it must be there", v, mesh.vertices.size()));
        out_.put(v);
      }
  }

  void putShape(const Shape& shape) {
    out_.put(static_cast<std::uint8_t>(shape.isSphere() ? 0 : 1));
    if (shape.isSphere()) {
      putPoint(shape.ball().center);
      out_.put(shape.ball().radius);
      return;
    }
    out_.put(numbers_.at(&shape.volume()->volume()));
    const implicit::Pose& pose = shape.volume()->pose();
    putPoint(pose.position);
    for (const float q : pose.rotation) out_.put(q);
    out_.put(pose.scale);
  }

  void putInitial() {
    out_.put(static_cast<std::uint8_t>(document_.initial.index()));
    if (const auto* mesh = std::get_if<TriangleMesh>(&document_.initial)) putMesh(*mesh);
    if (const auto* primitives = std::get_if<std::vector<Primitive>>(&document_.initial)) {
      putCount(primitives->size(), "primitives");
      for (const Primitive& primitive : *primitives) {
        out_.put(static_cast<std::uint8_t>(primitive.sign == Sign::Negative ? 1 : 0));
        putShape(primitive.shape);
      }
    }
  }

  void putOperation(const TriDexelDocument::Operation& operation) {
    out_.put(static_cast<std::uint8_t>(operation.operation));
    if (const auto* shape = std::get_if<Shape>(&operation.tool)) {
      putShape(*shape);
      return;
    }
    const auto& posed = std::get<TriDexelDocument::PosedTool>(operation.tool);
    if (posed.tool >= document_.tools.size())
      refuse(fmt::format("an operation uses tool {} of {}; it must be there", posed.tool,
                         document_.tools.size()));
    out_.put(std::uint8_t{2});
    out_.put(posed.tool);
    for (const double number : posed.pose) {
      if (!std::isfinite(number)) refuse("the pose of a tool has a number that is not finite; it must be");
      out_.put(number);
    }
  }

  void refuseUnknownOperations() const {
    LineEnds ends;
    for (int axis = 0; axis < 3; ++axis) {
      const Dexels& dexels = document_.model.family(axis);
      if (!dexels.keepsOperations()) continue;
      for (std::size_t line = 0; line < dexels.lineCount(); ++line) {
        dexels.read(line, ends);
        for (const SpanEnd& end : ends)
          for (const OperationId id : {end.inner, end.outer})
            if (id != OperationId::None && static_cast<std::uint32_t>(id) > document_.operations.size())
              refuse(fmt::format("an end was made by operation {}, and there are {}; it must be one of them",
                                 static_cast<std::uint32_t>(id), document_.operations.size()));
      }
    }
  }

  const TriDexelDocument& document_;
  const std::filesystem::path& name_;
  ByteWriter out_;
  std::vector<const Volume*> volumes_;
  std::map<const Volume*, std::uint32_t> numbers_;
};

// Reading ---------------------------------------------------------------------------------------------------

class BodyReader {
 public:
  BodyReader(std::string_view body, const std::filesystem::path& name)
      : in_(body, fmt::format("{}: byte {} and on, unpacked, byte", name.string(), kHeader)) {}

  [[nodiscard]] TriDexelDocument read() {
    TriDexelDocument out;
    const DexelGrid grid = getGrid();
    for (std::uint32_t left = getCount(2, "volumes"); left > 0; --left) volumes_.push_back(getVolume());
    getInitial(out);
    for (std::uint32_t left = getCount(8, "tools"); left > 0; --left) out.tools.push_back(getMesh());
    const std::uint32_t operations = getCount(18, "operations");
    out.operations.reserve(operations);
    for (std::uint32_t i = 0; i < operations; ++i) out.operations.push_back(getOperation(out.tools.size()));
    std::array<Dexels, 3> families;
    for (int axis = 0; axis < 3; ++axis)
      families[static_cast<std::size_t>(axis)] =
          getLines(in_, grid.width(axis), grid.height(axis), operations);
    if (in_.left() != 0)
      in_.refuse(fmt::format("{} bytes follow the last line; there must be none", in_.left()));
    out.model = TriDexel(grid, {.operations = false});
    for (int axis = 0; axis < 3; ++axis)
      out.model.family(axis) = std::move(families[static_cast<std::size_t>(axis)]);
    return out;
  }

 private:
  // So many things, each of which takes `least` bytes or more.
  [[nodiscard]] std::uint32_t getCount(std::size_t least, std::string_view what) {
    const auto count = in_.get<std::uint32_t>(what);
    in_.need(count, least, what);
    return count;
  }
  [[nodiscard]] bool getFlag(std::string_view what) {
    const auto flag = in_.get<std::uint8_t>(what);
    if (flag > 1) in_.refuse(fmt::format("{} is {}; it must be 0 or 1", what, flag));
    return flag == 1;
  }
  [[nodiscard]] float getFinite(std::string_view what) {
    const float value = in_.get<float>(what);
    if (!std::isfinite(value)) in_.refuse(fmt::format("{} is {}; it must be finite", what, value));
    return value;
  }
  [[nodiscard]] Point getPoint(std::string_view what) {
    Point p;
    for (int a = 0; a < 3; ++a) p[a] = getFinite(what);
    return p;
  }

  [[nodiscard]] DexelGrid getGrid() {
    DexelGrid::Parts parts;
    for (int a = 0; a < 3; ++a) parts.anchor[a] = in_.get<double>("the grid's anchor");
    parts.cell = in_.get<double>("the grid's cell");
    for (int& first : parts.first) first = in_.get<std::int32_t>("the grid's first points");
    for (int& count : parts.counts) count = in_.get<std::int32_t>("the numbers of points");
    constexpr int kFarthest = 1 << 28;
    for (std::size_t a = 0; a < 3; ++a)
      if (parts.counts[a] < 0 || parts.counts[a] > kMostLines || parts.first[a] < -kFarthest ||
          parts.first[a] > kFarthest)
        in_.refuse(
            fmt::format("the grid has {} points from the {}th on along an axis; there may be 0 to {} "
                        "from within 2^28",
                        parts.counts[a], parts.first[a], kMostLines));
    const DexelGrid grid(parts);
    if (!(std::isfinite(parts.cell) && parts.cell > 0))
      in_.refuse(fmt::format("the grid's cell is {}; it must be greater than 0", parts.cell));
    for (int a = 0; a < 3; ++a)
      for (int i = 0; i < parts.counts[static_cast<std::size_t>(a)]; ++i)
        if (!std::isfinite(grid.at(a, i)) || !(grid.at(a, i) < grid.at(a, i + 1)))
          in_.refuse(
              fmt::format("the grid's points {} and {} along an axis are at {} and {}; these must be "
                          "finite and ascend",
                          i, i + 1, grid.at(a, i), grid.at(a, i + 1)));
    return grid;
  }

  [[nodiscard]] TriangleMesh getMesh() {
    TriangleMesh mesh;
    const auto vertices = in_.get<std::uint32_t>("the vertices of a mesh"),
               triangles = in_.get<std::uint32_t>("the triangles of a mesh");
    in_.need(vertices, 12, "the vertices of a mesh");
    mesh.vertices.reserve(vertices);
    for (std::uint32_t i = 0; i < vertices; ++i) mesh.vertices.push_back(getPoint("a vertex of a mesh"));
    in_.need(triangles, 12, "the triangles of a mesh");
    mesh.triangles.resize(triangles);
    for (auto& triangle : mesh.triangles)
      for (std::uint32_t& v : triangle) {
        v = in_.get<std::uint32_t>("the triangles of a mesh");
        if (v >= vertices)
          in_.refuse(fmt::format("a triangle names vertex {} of {}; it must be there", v, vertices));
      }
    return mesh;
  }

  // What others refuse without knowing where it came from.
  template <class F>
  [[nodiscard]] auto placed(const F& f) const {
    try {
      return f();
    } catch (const InputError& error) {
      in_.refuse(error.what());
    }
  }

  [[nodiscard]] std::shared_ptr<const Volume> getVolume() {
    const std::string_view name = in_.take(in_.get<std::uint8_t>("the name of a kind"), "the name of a kind");
    const implicit::VolumeKind& kind =
        *placed([&]() -> const implicit::VolumeKind* { return &implicit::volumeKindNamed(name); });
    const auto count = in_.get<std::uint8_t>("the number of parameters");
    implicit::VolumeParameters parameters;
    for (std::uint8_t left = count; left > 0; --left) {
      std::vector<float>& values = parameters.values.emplace_back(getCount(4, "the values of a parameter"));
      for (float& value : values) value = getFinite("a parameter");
    }
    if (getFlag("whether a volume has a mesh")) {
      auto source = std::make_shared<implicit::MeshSource>();
      source->mesh = getMesh();
      source->file = in_.take(getCount(1, "the name of a file"), "the name of a file");
      source->hash = in_.get<std::uint64_t>("the hash of a file");
      source->repaired = getFlag("whether a mesh was repaired");
      parameters.mesh = std::move(source);
    }
    refuseBadParameters(kind, parameters);
    return placed([&] { return kind.make(parameters); });
  }

  void refuseBadParameters(const implicit::VolumeKind& kind, const implicit::VolumeParameters& parameters) {
    using Form = implicit::ParameterInfo::Form;
    bool takesMesh = false, fits = parameters.values.size() == kind.parameters.size();
    for (std::size_t i = 0; i < kind.parameters.size() && fits; ++i) {
      const Form form = kind.parameters[i].form;
      const std::size_t values = parameters.values[i].size();
      takesMesh = takesMesh || form == Form::Mesh;
      fits = form == Form::Number          ? values == 1
             : form == Form::ProfilePoints ? values % 2 == 0
             : form == Form::Points        ? values % 3 == 0
                                           : values == 0;
    }
    if (!fits || takesMesh != (parameters.mesh != nullptr))
      in_.refuse(fmt::format("the parameters of a {} are not as many as it takes; it takes {}", kind.name,
                             kind.parameters.size()));
  }

  [[nodiscard]] Shape getShape(std::uint8_t sort) {
    if (sort == 0) {
      const Point center = getPoint("the centre of a ball");
      const Shape shape(center, getFinite("the radius of a ball"));
      (void)placed([&] {
        validate(Primitive{shape});
        return 0;
      });
      return shape;
    }
    const auto number = in_.get<std::uint32_t>("the number of a volume");
    if (number >= volumes_.size())
      in_.refuse(fmt::format("a shape is volume {} of {}; it must be there", number, volumes_.size()));
    implicit::Pose pose;
    pose.position = getPoint("the position of a volume");
    for (float& q : pose.rotation) q = getFinite("the rotation of a volume");
    pose.scale = getFinite("the scale of a volume");
    return placed([&] { return std::make_shared<const implicit::PosedVolume>(volumes_[number], pose); });
  }

  void getInitial(TriDexelDocument& out) {
    const auto kind = in_.get<std::uint8_t>("the kind of the initial solid");
    if (kind > 2) in_.refuse(fmt::format("the initial solid is of kind {}; it must be 0, 1 or 2", kind));
    if (kind == 1) out.initial = getMesh();
    if (kind != 2) return;
    std::vector<Primitive> primitives;
    for (std::uint32_t left = getCount(18, "primitives"); left > 0; --left) {
      const Sign sign = getFlag("the sign of a primitive") ? Sign::Negative : Sign::Positive;
      const auto sort = static_cast<std::uint8_t>(getFlag("the sort of a shape") ? 1 : 0);
      primitives.push_back({getShape(sort), sign});
    }
    out.initial = std::move(primitives);
  }

  [[nodiscard]] TriDexelDocument::Operation getOperation(std::size_t tools) {
    TriDexelDocument::Operation out;
    const auto operation = in_.get<std::uint8_t>("an operation"), sort = in_.get<std::uint8_t>("a tool");
    if (operation > 2 || sort > 2)
      in_.refuse(
          fmt::format("an operation is {} with a tool of sort {}; both must be 0, 1 or 2", operation, sort));
    out.operation = static_cast<DexelOperation>(operation);
    if (sort < 2) {
      out.tool = getShape(sort);
      return out;
    }
    TriDexelDocument::PosedTool posed;
    posed.tool = in_.get<std::uint32_t>("the number of a tool");
    if (posed.tool >= tools)
      in_.refuse(fmt::format("an operation uses tool {} of {}; it must be there", posed.tool, tools));
    for (double& number : posed.pose) {
      number = in_.get<double>("the pose of a tool");
      if (!std::isfinite(number))
        in_.refuse(fmt::format("the pose of a tool has the number {}; it must be finite", number));
    }
    out.tool = posed;
    return out;
  }

  ByteReader in_;
  std::vector<std::shared_ptr<const Volume>> volumes_;
};

// The body of a file whose header says that it is whole and unchanged.
std::string unpacked(std::string_view contents, const std::filesystem::path& name) {
  const std::string where = fmt::format("{}: byte", name.string());
  ByteReader in(contents, where);
  const auto refuse = [&](std::size_t byte, const std::string& what) {
    throw InputError(fmt::format("{} {}: {}", where, byte, what));
  };
  if (contents.substr(0, kMagic.size()) != kMagic.substr(0, std::min(kMagic.size(), contents.size())))
    refuse(0, fmt::format("this is no tri-dexel model; those begin with \"{}\"", kMagic));
  if (contents.size() < kHeader)
    refuse(contents.size(), fmt::format("the file ends; its header must have {} bytes", kHeader));
  (void)in.take(kMagic.size(), "");
  const auto version = in.get<std::uint32_t>(""), reserved = in.get<std::uint32_t>("");
  const auto size = in.get<std::uint64_t>(""), packed = in.get<std::uint64_t>(""),
             hash = in.get<std::uint64_t>("");
  if (version != kVersion)
    refuse(8, fmt::format("this is version {} of the format; version {} can be read", version, kVersion));
  if (reserved != 0) refuse(12, fmt::format("there is {}; it must be 0", reserved));
  const std::string_view frame = contents.substr(kHeader);
  if (packed != frame.size())
    refuse(24, fmt::format("the packed part is said to have {} bytes and has {}; it must have as many",
                           packed, frame.size()));
  if (hashOf(contents.substr(0, kHashed), frame) != hash)
    refuse(32, "the checksum is another one than that of the contents; they must be as they were written");
  if (ZSTD_getFrameContentSize(frame.data(), frame.size()) != size ||
      ZSTD_findFrameCompressedSize(frame.data(), frame.size()) != frame.size())
    refuse(kHeader, fmt::format("there is no zstd frame of {} bytes that unpacks to {}; there must be one",
                                packed, size));
  if (const std::optional<std::size_t> available = availableBytes(); available && size > *available)
    refuse(16, fmt::format("the model unpacks to {} bytes; {} are free, and it must fit", size, *available));
  std::string body(static_cast<std::size_t>(size), '\0');
  const std::size_t got = ZSTD_decompress(body.data(), body.size(), frame.data(), frame.size());
  if (ZSTD_isError(got) || got != body.size())
    refuse(kHeader, fmt::format("zstd cannot unpack this ({}); it must be one zstd frame",
                                ZSTD_isError(got) ? ZSTD_getErrorName(got) : "too short"));
  return body;
}

}  // namespace

std::string formatTriDexel(const TriDexelDocument& document, const std::filesystem::path& name) {
  const std::string body = BodyWriter(document, name).write();
  std::string frame(ZSTD_compressBound(body.size()), '\0');
  const std::size_t packed = ZSTD_compress(frame.data(), frame.size(), body.data(), body.size(), kLevel);
  if (ZSTD_isError(packed)) throw InternalError(fmt::format("zstd: {}", ZSTD_getErrorName(packed)));
  frame.resize(packed);
  ByteWriter out;
  out.put(kMagic);
  out.put(kVersion);
  out.put(std::uint32_t{0});
  out.put(static_cast<std::uint64_t>(body.size()));
  out.put(static_cast<std::uint64_t>(frame.size()));
  out.put(hashOf(out.bytes(), frame));
  out.put(std::string_view(frame));
  return out.bytes();
}

TriDexelDocument parseTriDexel(std::string_view contents, const std::filesystem::path& name) {
  const std::string body = unpacked(contents, name);
  return BodyReader(body, name).read();
}

void writeTriDexel(const std::filesystem::path& path, const TriDexelDocument& document) {
  AtomicFile file(path);
  file.write(formatTriDexel(document, path));
  file.commit();
}

TriDexelDocument readTriDexel(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  // A device may never end.
  if (const auto status = fs::status(path, error);
      fs::is_directory(status) || fs::is_character_file(status) || fs::is_block_file(status))
    throw InputError(fmt::format("{}: is a {}; a .tridexel file is needed", path.string(),
                                 fs::is_directory(status) ? "folder" : "device"));
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in)
    throw InputError(fmt::format("{}: cannot read this file: {}", path.string(),
                                 std::generic_category().message(errno != 0 ? errno : EIO)));
  const std::string contents{std::istreambuf_iterator<char>(in), {}};
  if (in.bad()) throw InputError(fmt::format("{}: cannot read this file: input/output error", path.string()));
  return parseTriDexel(contents, path);
}

}  // namespace restroke::points
