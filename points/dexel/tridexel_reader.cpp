#include <cmath>
#include <memory>
#include <utility>

#include "implicit/errors.h"
#include "implicit/primitive_list.h"
#include "points/dexel/file_bytes.h"
#include "points/dexel/line_columns.h"
#include "points/dexel/tridexel_body.h"

namespace restroke::points {

namespace {

using implicit::Primitive;
using implicit::Shape;
using implicit::Sign;
using implicit::Volume;

class BodyReader {
 public:
  BodyReader(std::string_view body, std::uint32_t version, const std::string& where)
      : in_(body, where), version_(version) {}

  [[nodiscard]] TriDexelDocument read() {
    TriDexelDocument out;
    const DexelGrid grid = getGrid();
    for (std::uint32_t left = getCount(2, "volumes"); left > 0; --left) volumes_.push_back(getVolume());
    getInitial(out);
    for (std::uint32_t left = getCount(8, "tools"); left > 0; --left) out.tools.push_back(getMesh());
    if (version_ >= 2)
      for (std::uint32_t left = getCount(97, "cutters"); left > 0; --left) out.cutters.push_back(getCutter());
    const std::uint32_t operations = getCount(18, "operations");
    out.operations.reserve(operations);
    for (std::uint32_t i = 0; i < operations; ++i) out.operations.push_back(getOperation(out));
    if (version_ >= 2) getRuns(out);
    const std::vector<std::uint8_t> names = namesInHistories(operations, out.runs);
    std::array<Dexels, 3> families;
    for (int axis = 0; axis < 3; ++axis) {
      Dexels& dexels = families[static_cast<std::size_t>(axis)];
      const auto kind = in_.get<std::uint8_t>("the lines' kind");
      if (kind > (version_ >= 2 ? 3 : 1))
        in_.refuse(
            fmt::format("the lines' kind is {}; it must be {}", kind, version_ >= 2 ? "0 to 3" : "0 or 1"));
      const bool keepsHistory = (kind & 2) != 0;
      if (axis > 0 && keepsHistory != families[0].keepsHistory())
        in_.refuse("some families of lines keep histories and some do not; it must be all or none");
      dexels = getLines(in_, grid.width(axis), grid.height(axis),
                        {.keepsOperations = (kind & 1) != 0, .lastOperation = operations});
      if (keepsHistory) getHistories(in_, dexels, names);
    }
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

  template <class T>
  void requireValid(const T& thing) const {
    (void)placed([&] {
      validate(thing);
      return 0;
    });
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
      requireValid(Primitive{shape});
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

  [[nodiscard]] double getFiniteDouble(std::string_view what) {
    const auto value = in_.get<double>(what);
    if (!std::isfinite(value))
      in_.refuse(fmt::format("{} has the number {}; it must be finite", what, value));
    return value;
  }
  [[nodiscard]] DVec3 getPlace(std::string_view what) {
    DVec3 p;
    for (int a = 0; a < 3; ++a) p[a] = getFiniteDouble(what);
    return p;
  }

  [[nodiscard]] Cutter getCutter() {
    Cutter cutter;
    const auto kind = in_.get<std::uint8_t>("the kind of a cutter");
    if (kind > 2) in_.refuse(fmt::format("a cutter is of kind {}; it must be 0, 1 or 2", kind));
    cutter.kind = static_cast<Cutter::Kind>(kind);
    for (double* number : {&cutter.radius, &cutter.length, &cutter.cornerRadius})
      *number = getFiniteDouble("a cutter");
    for (double& number : cutter.orientation) number = getFiniteDouble("a cutter");
    requireValid(cutter);
    return cutter;
  }

  [[nodiscard]] CutterMove getMove(std::size_t cutters) {
    CutterMove move;
    move.cutter = in_.get<std::uint32_t>("the number of a cutter");
    if (move.cutter >= cutters)
      in_.refuse(fmt::format("an operation uses cutter {} of {}; it must be there", move.cutter, cutters));
    PathElement& element = move.element;
    element.kind = getFlag("the kind of an element") ? PathElement::Kind::Arc : PathElement::Kind::Line;
    for (DVec3* p : {&element.from, &element.to, &element.center}) *p = getPlace("an element of a path");
    const auto axis = in_.get<std::uint8_t>("the axis of an arc");
    if (axis > 2) in_.refuse(fmt::format("an arc turns about axis {}; it must be 0, 1 or 2", axis));
    element.axis = axis;
    element.clockwise = getFlag("the sense of an arc");
    requireValid(element);
    return move;
  }

  void getRuns(TriDexelDocument& out) {
    const std::size_t operations = out.operations.size();
    std::size_t next = 1;
    for (std::uint32_t left = getCount(8, "runs"); left > 0; --left) {
      const auto first = in_.get<std::uint32_t>("a run"), count = in_.get<std::uint32_t>("a run");
      if (first < next || count < 2 || first > operations || count > operations + 1 - first)
        in_.refuse(
            fmt::format("a run has {} operations from {} on; it must have 2 or more of the {}, and begin "
                        "at {} or later",
                        count, first, operations, next));
      next = std::size_t{first} + count;
      out.runs.push_back({static_cast<OperationId>(first), count});
    }
  }

  [[nodiscard]] TriDexelDocument::Operation getOperation(const TriDexelDocument& document) {
    TriDexelDocument::Operation out;
    const auto operation = in_.get<std::uint8_t>("an operation"), sort = in_.get<std::uint8_t>("a tool");
    const int lastSort = version_ >= 2 ? 3 : 2;
    if (operation > 2 || sort > lastSort)
      in_.refuse(fmt::format("an operation is {} with a tool of sort {}; they must be at most 2 and {}",
                             operation, sort, lastSort));
    out.operation = static_cast<DexelOperation>(operation);
    if (sort < 2) {
      out.tool = getShape(sort);
      return out;
    }
    if (sort == 3) {
      out.tool = getMove(document.cutters.size());
      return out;
    }
    const std::size_t tools = document.tools.size();
    TriDexelDocument::PosedTool posed;
    posed.tool = in_.get<std::uint32_t>("the number of a tool");
    if (posed.tool >= tools)
      in_.refuse(fmt::format("an operation uses tool {} of {}; it must be there", posed.tool, tools));
    for (double& number : posed.pose) number = getFiniteDouble("the pose of a tool");
    out.tool = posed;
    return out;
  }

  ByteReader in_;
  std::uint32_t version_;
  std::vector<std::shared_ptr<const Volume>> volumes_;
};

}  // namespace

TriDexelDocument parseBody(std::string_view body, std::uint32_t version, const std::string& where) {
  return BodyReader(body, version, where).read();
}

}  // namespace restroke::points
