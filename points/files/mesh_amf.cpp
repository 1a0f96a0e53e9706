// AMF: ISO/ASTM 52915, Standard specification for additive manufacturing file format; its triangles and
// constellations, without curved triangles, materials, textures and metadata.

#include <algorithm>
#include <iterator>
#include <pugixml.hpp>
#include <utility>
#include <vector>

#include "points/files/mesh_formats.h"
#include "points/files/zip.h"

namespace restroke::points::formats {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

class AmfReader {
 public:
  explicit AmfReader(const Source& source) : source_(source) {}

  TriangleMesh read() {
    const auto result = document_.load_buffer(source_.bytes.data(), source_.bytes.size());
    if (!result)
      refuse(source_, placeOf(result.offset),
             fmt::format("the XML is malformed: {}", lowered(result.description())));
    const pugi::xml_node root = document_.child("amf");
    if (!root) refuse(source_, "", "the root of the XML is not <amf>, as in an AMF file");
    for (const pugi::xml_node object : root.children("object")) readObject(object);
    MeshBuilder mesh;
    if (root.child("constellation"))
      for (const pugi::xml_node constellation : root.children("constellation")) place(constellation, mesh);
    else
      for (const auto& object : objects_) mesh.append(object.second);
    return std::move(mesh).finish();
  }

 private:
  [[nodiscard]] std::string placeOf(std::ptrdiff_t offset) const {
    const auto at = std::clamp<std::ptrdiff_t>(offset, 0, static_cast<std::ptrdiff_t>(source_.bytes.size()));
    const auto before = source_.bytes.substr(0, static_cast<std::size_t>(at));
    return fmt::format("line {}", 1 + std::count(before.begin(), before.end(), '\n'));
  }
  [[noreturn]] void refuseAt(pugi::xml_node node, const std::string& what) const {
    refuse(source_, placeOf(node.offset_debug()), what);
  }

  [[nodiscard]] float coordinate(pugi::xml_node parent, const char* name, const char* when) const {
    const std::string_view text = trimmed(parent.child_value(name));
    const auto value = parseFloat(text);
    if (!value)
      refuseAt(parent, fmt::format("<{}> {} is \"{}\"; it has to be a finite float32 number", name, when,
                                   text.substr(0, 40)));
    return *value;
  }

  void readObject(pugi::xml_node object) {
    MeshBuilder mesh;
    std::vector<std::int64_t> corners;
    for (const pugi::xml_node meshNode : object.children("mesh")) {
      const auto first = static_cast<std::int64_t>(mesh.vertexCount());
      for (const pugi::xml_node vertex : meshNode.child("vertices").children("vertex")) {
        const pugi::xml_node at = vertex.child("coordinates");
        if (!at) refuseAt(vertex, "a <vertex> has no <coordinates>");
        mesh.addVertex({coordinate(at, "x", "of a vertex"), coordinate(at, "y", "of a vertex"),
                        coordinate(at, "z", "of a vertex")});
      }
      const auto count = static_cast<std::int64_t>(mesh.vertexCount()) - first;
      for (const pugi::xml_node volume : meshNode.children("volume"))
        for (const pugi::xml_node triangle : volume.children("triangle")) {
          corners.clear();
          for (const char* name : {"v1", "v2", "v3"}) {
            const std::string_view text = trimmed(triangle.child_value(name));
            const auto v = parseInteger(text);
            if (!v || *v < 0 || *v >= count)
              refuseAt(
                  triangle,
                  fmt::format("<{}> of a triangle is \"{}\"; it has to be one of the mesh's {} vertices, "
                              "numbered from 0 on",
                              name, text.substr(0, 40), count));
            corners.push_back(first + *v);
          }
          (void)mesh.addPolygon(corners);
        }
    }
    objects_.emplace_back(object.attribute("id").value(), std::move(mesh).finish());
  }

  void place(pugi::xml_node constellation, MeshBuilder& mesh) const {
    for (const pugi::xml_node instance : constellation.children("instance")) {
      const std::string id = instance.attribute("objectid").value();
      const auto object =
          std::find_if(objects_.begin(), objects_.end(), [&](const auto& o) { return o.first == id; });
      if (object == objects_.end())
        refuseAt(instance, fmt::format("an instance names object \"{}\", which is not in the file (nested "
                                       "constellations are not read)",
                                       id.substr(0, 40)));
      const auto valueOf = [&](const char* name) {
        return instance.child(name) ? coordinate(instance, name, "of an instance") : 0.0f;
      };
      for (const char* name : {"rx", "ry", "rz"})
        if (valueOf(name) != 0)
          refuseAt(instance,
                   fmt::format("an instance is turned (<{}>); only instances that are moved are read", name));
      const DVec3 move(valueOf("deltax"), valueOf("deltay"), valueOf("deltaz"));
      TriangleMesh moved = object->second;
      for (Point& p : moved.vertices) p = Point(DVec3(p) + move);
      for (const Point& p : moved.vertices)
        if (!isFinite(p))
          refuseAt(instance, "an instance is moved so far that coordinates are not finite float32 numbers");
      // A file of a thousand instances of a large object must not fill the memory.
      constexpr std::size_t kMost = std::size_t{1} << 27;
      if (mesh.vertexCount() + moved.vertices.size() > kMost)
        refuseAt(instance,
                 fmt::format("the instances have more than {} vertices together, the limit", kMost));
      mesh.append(moved);
    }
  }

  const Source& source_;
  pugi::xml_document document_;
  std::vector<std::pair<std::string, TriangleMesh>> objects_;  ///< by id, in the order of the file
};

}  // namespace

TriangleMesh readAmf(const Source& source) {
  return AmfReader(source).read();
}

TriangleMesh readZippedAmf(const Source& source) {
  std::string contents;
  try {
    for (const ZipMember& member : zipMembers(source.bytes))
      if (lowered(member.name).ends_with(".amf")) {
        contents = unzip(source.bytes, member, kUnpackedLimit);
        break;
      }
  } catch (const InputError& error) {
    refuse(source, "", error.what());
  }
  return AmfReader({contents, source.name}).read();
}

std::string writeAmf(const TriangleMesh& mesh, const MeshWriteOptions& options) {
  // AMF has no centimetres. Ten times a float is exact in double, and its shortest text reads back as the
  // same.
  const bool tenfold = options.unit == LengthUnit::Centimetre;
  const LengthUnit unit = tenfold ? LengthUnit::Millimetre : options.unit;
  std::string out;
  auto to = std::back_inserter(out);
  fmt::format_to(to, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<amf unit=\"{}\" version=\"1.1\">\n",
                 nameOf(unit));
  out += " <object id=\"0\">\n  <mesh>\n   <vertices>\n";
  for (const Point& p : mesh.vertices) {
    out += "    <vertex><coordinates>";
    for (int i = 0; i < 3; ++i) {
      const char axis = "xyz"[i];
      if (tenfold)
        fmt::format_to(to, "<{0}>{1}</{0}>", axis, shortest(static_cast<double>(p[i]) * 10));
      else
        fmt::format_to(to, "<{0}>{1}</{0}>", axis, shortest(p[i]));
    }
    out += "</coordinates></vertex>\n";
  }
  out += "   </vertices>\n   <volume>\n";
  for (const auto& t : mesh.triangles)
    fmt::format_to(to, "    <triangle><v1>{}</v1><v2>{}</v2><v3>{}</v3></triangle>\n", t[0], t[1], t[2]);
  out += "   </volume>\n  </mesh>\n </object>\n</amf>\n";
  return out;
}

}  // namespace restroke::points::formats
