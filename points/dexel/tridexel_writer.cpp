#include <algorithm>
#include <cmath>
#include <map>

#include "implicit/errors.h"
#include "points/dexel/file_bytes.h"
#include "points/dexel/line_columns.h"
#include "points/dexel/tridexel_body.h"

namespace restroke::points {

namespace {

using implicit::Primitive;
using implicit::Shape;
using implicit::Sign;
using implicit::Volume;

class BodyWriter {
 public:
  BodyWriter(const TriDexelDocument& document, const std::filesystem::path& name)
      : document_(document), name_(name), version_(versionFor(document)) {}

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
    if (version_ >= 2) putCutters();
    putCount(document_.operations.size(), "operations");
    for (const TriDexelDocument::Operation& operation : document_.operations) putOperation(operation);
    if (version_ >= 2) putRuns();
    refuseUnknownOperations();
    for (int axis = 0; axis < 3; ++axis) {
      const Dexels& dexels = document_.model.family(axis);
      putLines(out_, dexels);
      if (dexels.keepsHistory()) putHistories(out_, dexels);
    }
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

  void putFinite(double number, std::string_view what) {
    if (!std::isfinite(number)) refuse(fmt::format("{} has a number that is not finite; it must be", what));
    out_.put(number);
  }

  void putCutters() {
    putCount(document_.cutters.size(), "cutters");
    for (const Cutter& cutter : document_.cutters) {
      out_.put(static_cast<std::uint8_t>(cutter.kind));
      for (const double number : {cutter.radius, cutter.length, cutter.cornerRadius})
        putFinite(number, "a cutter");
      for (const double number : cutter.orientation) putFinite(number, "a cutter");
    }
  }

  void putMove(const CutterMove& move) {
    if (move.cutter >= document_.cutters.size())
      refuse(fmt::format("an operation uses cutter {} of {}; it must be there", move.cutter,
                         document_.cutters.size()));
    out_.put(std::uint8_t{3});
    out_.put(move.cutter);
    const PathElement& element = move.element;
    out_.put(static_cast<std::uint8_t>(element.kind));
    for (const DVec3& p : {element.from, element.to, element.center})
      for (int a = 0; a < 3; ++a) putFinite(p[a], "an element of a path");
    if (element.axis < 0 || element.axis > 2)
      refuse(fmt::format("an arc turns about axis {}; it must be 0, 1 or 2", element.axis));
    out_.put(static_cast<std::uint8_t>(element.axis));
    out_.put(static_cast<std::uint8_t>(element.clockwise ? 1 : 0));
  }

  void putRuns() {
    putCount(document_.runs.size(), "runs");
    std::size_t next = 1;
    for (const TriDexelDocument::Run& run : document_.runs) {
      const std::size_t first = static_cast<std::uint32_t>(run.first);
      if (first < next || run.count < 2 || first + run.count - 1 > document_.operations.size())
        refuse(
            fmt::format("a run has {} operations from {} on; it must have 2 or more of the {}, and begin "
                        "at {} or later",
                        run.count, first, document_.operations.size(), next));
      next = first + run.count;
      out_.put(static_cast<std::uint32_t>(first));
      out_.put(run.count);
    }
  }

  void putOperation(const TriDexelDocument::Operation& operation) {
    out_.put(static_cast<std::uint8_t>(operation.operation));
    if (const auto* shape = std::get_if<Shape>(&operation.tool)) {
      putShape(*shape);
      return;
    }
    if (const auto* move = std::get_if<CutterMove>(&operation.tool)) {
      putMove(*move);
      return;
    }
    const auto& posed = std::get<TriDexelDocument::PosedTool>(operation.tool);
    if (posed.tool >= document_.tools.size())
      refuse(fmt::format("an operation uses tool {} of {}; it must be there", posed.tool,
                         document_.tools.size()));
    out_.put(std::uint8_t{2});
    out_.put(posed.tool);
    for (const double number : posed.pose) putFinite(number, "the pose of a tool");
  }

  void refuseUnknownOperations() const {
    const std::vector<std::uint8_t> names = namesInHistories(document_.operations.size(), document_.runs);
    LineEnds ends;
    std::vector<OperationId> changes;
    for (int axis = 0; axis < 3; ++axis) {
      const Dexels& dexels = document_.model.family(axis);
      if (dexels.keepsHistory() != document_.model.keepsHistory())
        refuse("some families of lines keep histories and some do not; it must be all or none");
      for (std::size_t line = 0; line < dexels.lineCount(); ++line) {
        if (dexels.keepsOperations()) {
          dexels.read(line, ends);
          for (const SpanEnd& end : ends)
            for (const OperationId id : {end.inner, end.outer})
              if (id != OperationId::None && static_cast<std::uint32_t>(id) > document_.operations.size())
                refuse(
                    fmt::format("an end was made by operation {}, and there are {}; it must be one of "
                                "them",
                                static_cast<std::uint32_t>(id), document_.operations.size()));
        }
        if (!dexels.keepsHistory()) continue;
        changes.clear();
        dexels.changesOf(line, changes);
        for (const OperationId id : changes)
          if (static_cast<std::size_t>(id) >= names.size() || names[static_cast<std::size_t>(id)] == 0)
            refuse(
                fmt::format("a line was changed by operation {} of {}; it must be one of them, and of a "
                            "run the first",
                            static_cast<std::uint32_t>(id), document_.operations.size()));
      }
    }
  }

  const TriDexelDocument& document_;
  const std::filesystem::path& name_;
  std::uint32_t version_;
  ByteWriter out_;
  std::vector<const Volume*> volumes_;
  std::map<const Volume*, std::uint32_t> numbers_;
};

}  // namespace

std::uint32_t versionFor(const TriDexelDocument& document) {
  const bool moves = std::any_of(
      document.operations.begin(), document.operations.end(),
      [](const TriDexelDocument::Operation& o) { return std::holds_alternative<CutterMove>(o.tool); });
  bool histories = false;
  for (int axis = 0; axis < 3; ++axis) histories |= document.model.family(axis).keepsHistory();
  return moves || histories || !document.cutters.empty() || !document.runs.empty() ? 2 : 1;
}

std::vector<std::uint8_t> namesInHistories(std::size_t operations,
                                           std::span<const TriDexelDocument::Run> runs) {
  std::vector<std::uint8_t> names(operations + 1, 1);
  names[0] = 0;
  for (const TriDexelDocument::Run& run : runs)
    std::fill_n(names.begin() + static_cast<std::ptrdiff_t>(run.first) + 1, run.count - 1, 0);
  return names;
}

std::string formatBody(const TriDexelDocument& document, const std::filesystem::path& name) {
  return BodyWriter(document, name).write();
}

}  // namespace restroke::points
