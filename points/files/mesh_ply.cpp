// PLY: G. Turk, The PLY Polygon File Format, 1994.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "points/files/mesh_formats.h"

namespace restroke::points::formats {
namespace {

enum class Kind : std::uint8_t { Signed, Unsigned, Floating };
struct Type {
  Kind kind = Kind::Signed;
  std::size_t size = 1;  ///< bytes
};

std::optional<Type> typeNamed(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, Type>, 16> kTypes = {{{"char", {Kind::Signed, 1}},
                                                                         {"int8", {Kind::Signed, 1}},
                                                                         {"uchar", {Kind::Unsigned, 1}},
                                                                         {"uint8", {Kind::Unsigned, 1}},
                                                                         {"short", {Kind::Signed, 2}},
                                                                         {"int16", {Kind::Signed, 2}},
                                                                         {"ushort", {Kind::Unsigned, 2}},
                                                                         {"uint16", {Kind::Unsigned, 2}},
                                                                         {"int", {Kind::Signed, 4}},
                                                                         {"int32", {Kind::Signed, 4}},
                                                                         {"uint", {Kind::Unsigned, 4}},
                                                                         {"uint32", {Kind::Unsigned, 4}},
                                                                         {"float", {Kind::Floating, 4}},
                                                                         {"float32", {Kind::Floating, 4}},
                                                                         {"double", {Kind::Floating, 8}},
                                                                         {"float64", {Kind::Floating, 8}}}};
  for (const auto& [known, type] : kTypes)
    if (known == name) return type;
  return std::nullopt;
}

struct Property {
  std::string name;
  Type type;
  std::optional<Type> count;  ///< of a list: the type of its length
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Encoding : std::uint8_t { Ascii, LittleEndian, BigEndian };

struct Header {
  Encoding encoding = Encoding::Ascii;
  std::vector<Element> elements;
};

class HeaderReader {
 public:
  HeaderReader(const Source& source, TextCursor& text) : source_(source), text_(text) {}

  Header read() {
    text_.nextLine();
    if (text_.wordOfLine() != "ply") text_.refuseHere("the first line is not \"ply\", as in a PLY file");
    bool hasFormat = false;
    for (;;) {
      if (!text_.nextLine()) text_.refuseHere("the file ends inside the header; \"end_header\" closes it");
      const std::string_view keyword = text_.wordOfLine();
      if (keyword == "end_header") break;
      if (keyword == "format") {
        readFormat();
        hasFormat = true;
      } else if (keyword == "element") {
        readElement();
      } else if (keyword == "property") {
        readProperty();
      } else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty()) {
        text_.refuseHere(
            "the line begins with none of: format, comment, obj_info, element, property, end_header");
      }
    }
    if (!hasFormat) text_.refuseHere("the header ends without a format line");
    return std::move(header_);
  }

 private:
  void readFormat() {
    const std::string_view name = text_.wordOfLine();
    if (name == "ascii")
      header_.encoding = Encoding::Ascii;
    else if (name == "binary_little_endian")
      header_.encoding = Encoding::LittleEndian;
    else if (name == "binary_big_endian")
      header_.encoding = Encoding::BigEndian;
    else
      text_.refuseHere("the format is none of: ascii, binary_little_endian, binary_big_endian");
    if (text_.wordOfLine() != "1.0")
      text_.refuseHere("the format's version is not 1.0, the only one that is known");
  }

  void readElement() {
    Element element;
    element.name = text_.wordOfLine();
    const std::int64_t count = text_.integer(text_.wordOfLine(), "the number of elements");
    if (count < 0)
      text_.refuseHere(fmt::format("the number of elements is {}; it cannot be negative", count));
    element.count = static_cast<std::uint64_t>(count);
    header_.elements.push_back(element);
  }

  Type readType() {
    const auto type = typeNamed(text_.wordOfLine());
    if (!type) text_.refuseHere("a property's type is none that PLY has");
    return *type;
  }

  void readProperty() {
    if (header_.elements.empty()) text_.refuseHere("a property stands before any element");
    // An element with properties takes a byte or more; one without is not looked for at all.
    if (const std::uint64_t count = header_.elements.back().count; count > source_.bytes.size())
      text_.refuseHere(
          fmt::format("there are {} elements of this property, but the file has room for 0 to {}", count,
                      source_.bytes.size()));
    Property property;
    std::string_view word = text_.wordOfLine();
    if (word == "list") {
      property.count = readType();
      if (property.count->kind == Kind::Floating)
        text_.refuseHere("a list's length is of a type that is not integer");
      property.type = readType();
    } else {
      const auto type = typeNamed(word);
      if (!type) text_.refuseHere("a property's type is none that PLY has");
      property.type = *type;
    }
    property.name = text_.wordOfLine();
    if (property.name.empty()) text_.refuseHere("a property has no name");
    header_.elements.back().properties.push_back(property);
  }

  const Source& source_;
  TextCursor& text_;
  Header header_;
};

/// Reads numbers one after the other, ascii or binary.
class Values {
 public:
  Values(const Source& source, TextCursor& text, Encoding encoding)
      : source_(source), text_(text), encoding_(encoding), at_(text.nextByte()) {}

  std::int64_t integer(Type type) {
    if (encoding_ == Encoding::Ascii) return text_.integer(text_.word(), "a value");
    const std::uint64_t bits = raw(type.size);
    if (type.kind == Kind::Unsigned) return static_cast<std::int64_t>(bits);
    if (type.size == 1) return static_cast<std::int8_t>(bits);
    if (type.size == 2) return static_cast<std::int16_t>(bits);
    return static_cast<std::int32_t>(bits);
  }

  float coordinate(Type type) {
    if (encoding_ == Encoding::Ascii) return text_.coordinate(text_.word());
    float value = 0;
    if (type.kind != Kind::Floating)
      value = static_cast<float>(integer(type));
    else if (type.size == 4)
      value = std::bit_cast<float>(static_cast<std::uint32_t>(raw(4)));
    else
      value = static_cast<float>(std::bit_cast<double>(raw(8)));
    if (!std::isfinite(value))
      refuseHere(fmt::format("the coordinate is {}; coordinates are finite float32 numbers", value));
    return value;
  }

  void skip(Type type) {
    if (encoding_ != Encoding::Ascii)
      (void)raw(type.size);
    else if (text_.word().empty())
      refuseHere("the file ends before its last element");
  }

  [[noreturn]] void refuseHere(const std::string& what) const {
    refuse(source_, encoding_ == Encoding::Ascii ? text_.place() : fmt::format("byte {}", at_), what);
  }

 private:
  std::uint64_t raw(std::size_t size) {
    if (source_.bytes.size() - at_ < size) refuseHere("the file ends before its last element");
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t byte = encoding_ == Encoding::LittleEndian ? i : size - 1 - i;
      value |= static_cast<std::uint64_t>(static_cast<unsigned char>(source_.bytes[at_ + i])) << 8 * byte;
    }
    at_ += size;
    return value;
  }

  const Source& source_;
  TextCursor& text_;
  Encoding encoding_;
  std::size_t at_;
};

class BodyReader {
 public:
  BodyReader(Values& values, const Header& header) : values_(values), header_(header) {}

  TriangleMesh read() {
    for (const Element& element : header_.elements) {
      if (element.properties.empty()) continue;
      const bool isVertex = element.name == "vertex", isFace = element.name == "face";
      if (isVertex) findCoordinates(element);
      if (isFace) findCorners(element);
      for (std::uint64_t i = 0; i < element.count; ++i) {
        if (isVertex)
          readVertex(element);
        else if (isFace)
          readFace(element);
        else
          for (const Property& property : element.properties) skip(property);
      }
    }
    return finish();
  }

 private:
  void findCoordinates(const Element& element) {
    constexpr std::array<std::string_view, 3> kNames = {"x", "y", "z"};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto found = std::find_if(element.properties.begin(), element.properties.end(),
                                      [&](const Property& p) { return p.name == kNames[i] && !p.count; });
      if (found == element.properties.end())
        values_.refuseHere(fmt::format("the element \"vertex\" has no property {}", kNames[i]));
      coordinates_[i] = static_cast<std::size_t>(found - element.properties.begin());
    }
  }

  void findCorners(const Element& element) {
    const auto found =
        std::find_if(element.properties.begin(), element.properties.end(), [](const Property& p) {
          return (p.name == "vertex_indices" || p.name == "vertex_index") && p.count &&
                 p.type.kind != Kind::Floating;
        });
    if (found == element.properties.end())
      values_.refuseHere("the element \"face\" has no list of integers named vertex_indices or vertex_index");
    cornerList_ = static_cast<std::size_t>(found - element.properties.begin());
    hasFaces_ = true;
  }

  std::uint64_t lengthOf(const Property& list) {
    const std::int64_t length = values_.integer(*list.count);
    if (length < 0)
      values_.refuseHere(fmt::format("the length of a list is {}; it cannot be negative", length));
    return static_cast<std::uint64_t>(length);
  }

  void skip(const Property& property) {
    const std::uint64_t length = property.count ? lengthOf(property) : 1;
    for (std::uint64_t i = 0; i < length; ++i) values_.skip(property.type);
  }

  void readVertex(const Element& element) {
    Point p(0);
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const auto axis = std::find(coordinates_.begin(), coordinates_.end(), i);
      if (axis == coordinates_.end())
        skip(element.properties[i]);
      else
        p[static_cast<int>(axis - coordinates_.begin())] = values_.coordinate(element.properties[i].type);
    }
    vertices_.push_back(p);
  }

  void readFace(const Element& element) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const Property& property = element.properties[i];
      if (i != cornerList_) {
        skip(property);
        continue;
      }
      const std::uint64_t length = lengthOf(property);
      if (length < 3)
        values_.refuseHere(fmt::format("a face has {} corners; it needs three or more", length));
      lengths_.push_back(length);
      for (std::uint64_t k = 0; k < length; ++k) corners_.push_back(values_.integer(property.type));
    }
  }

  /// Faces may stand before the vertices.
  TriangleMesh finish() {
    if (!hasFaces_)
      values_.refuseHere("the file has no element \"face\"; a mesh is needed, not a point cloud");
    MeshBuilder mesh;
    for (const Point& p : vertices_) mesh.addVertex(p);
    std::span<const std::int64_t> rest(corners_);
    for (std::size_t f = 0; f < lengths_.size(); ++f) {
      if (const auto wrong = mesh.addPolygon(rest.first(lengths_[f])))
        values_.refuseHere(
            fmt::format("face {} names vertex {}, but there are {}, from 0 on", f, *wrong, vertices_.size()));
      rest = rest.subspan(lengths_[f]);
    }
    return std::move(mesh).finish();
  }

  Values& values_;
  const Header& header_;
  std::array<std::size_t, 3> coordinates_{};
  std::size_t cornerList_ = 0;
  bool hasFaces_ = false;
  std::vector<Point> vertices_;
  std::vector<std::uint64_t> lengths_;
  std::vector<std::int64_t> corners_;
};

void append32(std::string& out, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) out.push_back(static_cast<char>(value >> 8 * i & 0xff));
}

}  // namespace

TriangleMesh readPly(const Source& source) {
  TextCursor text(source);
  const Header header = HeaderReader(source, text).read();
  Values values(source, text, header.encoding);
  return BodyReader(values, header).read();
}

std::string writePly(const TriangleMesh& mesh, const MeshWriteOptions& options) {
  const bool ascii = options.encoding == MeshEncoding::Ascii;
  std::string out;
  auto to = std::back_inserter(out);
  fmt::format_to(to, "ply\nformat {} 1.0\ncomment unit {}\n", ascii ? "ascii" : "binary_little_endian",
                 nameOf(options.unit));
  for (const std::string& comment : options.comments) fmt::format_to(to, "comment {}\n", comment);
  fmt::format_to(to,
                 "element vertex {}\nproperty float x\nproperty float y\nproperty float z\nelement face {}\n"
                 "property list uchar uint vertex_indices\nend_header\n",
                 mesh.vertices.size(), mesh.triangles.size());
  if (ascii) {
    for (const Point& p : mesh.vertices)
      fmt::format_to(to, "{} {} {}\n", shortest(p.x), shortest(p.y), shortest(p.z));
    for (const auto& t : mesh.triangles) fmt::format_to(to, "3 {} {} {}\n", t[0], t[1], t[2]);
    return out;
  }
  out.reserve(out.size() + 12 * mesh.vertices.size() + 13 * mesh.triangles.size());
  for (const Point& p : mesh.vertices)
    for (int i = 0; i < 3; ++i) append32(out, std::bit_cast<std::uint32_t>(p[i]));
  for (const auto& t : mesh.triangles) {
    out.push_back(3);
    for (const std::uint32_t v : t) append32(out, v);
  }
  return out;
}

}  // namespace restroke::points::formats
