// STL: Stereolithography Interface Specification, 3D Systems, 1989.

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>

#include "points/files/mesh_formats.h"

namespace restroke::points::formats {
namespace {

constexpr std::size_t kHeaderSize = 80, kCountSize = 4, kFacetSize = 50;

std::uint32_t u32(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + i])) << 8 * i;
  return value;
}

void append32(std::string& out, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) out.push_back(static_cast<char>(value >> 8 * i & 0xff));
}

TriangleMesh readBinary(const Source& source) {
  const std::string_view bytes = source.bytes;
  if (bytes.size() < kHeaderSize + kCountSize)
    refuse(source, fmt::format("byte {}", bytes.size()),
           "the file ends; a binary STL file has 84 bytes before its triangles");
  const std::uint64_t count = u32(bytes, kHeaderSize);
  if (const std::uint64_t size = kHeaderSize + kCountSize + count * kFacetSize; size != bytes.size())
    refuse(source, "byte 80",
           fmt::format("the count is {}, for which a binary STL file has {} bytes, not {}", count, size,
                       bytes.size()));
  MeshBuilder mesh;
  for (std::uint32_t t = 0; t < count; ++t) {
    const std::size_t facet = kHeaderSize + kCountSize + t * kFacetSize;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Point p;
      for (int i = 0; i < 3; ++i) {
        const std::size_t at = facet + 12 * (corner + 1) + 4 * static_cast<std::size_t>(i);
        p[i] = std::bit_cast<float>(u32(bytes, at));
        if (!std::isfinite(p[i]))
          refuse(source, fmt::format("byte {} (triangle {})", at, t),
                 fmt::format("the coordinate is {}; coordinates are finite numbers", p[i]));
      }
      mesh.addVertex(p);
    }
    const std::int64_t first = 3 * std::int64_t{t};
    (void)mesh.addPolygon(std::array{first, first + 1, first + 2});
  }
  return std::move(mesh).finish();
}

class AsciiReader {
 public:
  explicit AsciiReader(const Source& source) : text_(source) {}

  TriangleMesh read() {
    for (std::string word = next(); !word.empty(); word = next()) {
      if (word != "solid") text_.refuseHere("\"solid\" is expected here, which begins an ascii STL file");
      (void)text_.restOfLine();  // the name
      readSolid();
    }
    return std::move(mesh_).finish();
  }

 private:
  std::string next() { return lowered(text_.word()); }

  void expect(const char* word) {
    if (next() != word) text_.refuseHere(fmt::format("\"{}\" is expected here, in an ascii STL file", word));
  }

  void readSolid() {
    for (;;) {
      const std::string word = next();
      if (word == "endsolid") break;
      if (word != "facet") {
        text_.refuseHere(word.empty() ? "the file ends inside a solid; \"endsolid\" closes it"
                                      : "\"facet\" or \"endsolid\" is expected here, in an ascii STL file");
      }
      readFacet();
    }
    (void)text_.restOfLine();
  }

  void readFacet() {
    // "normal" and three numbers, which may be anything (some programs write "nan"): the corners say it
    // better.
    std::string word = next();
    for (int i = 0; i < 4 && word != "outer"; ++i) word = next();
    if (word != "outer")
      text_.refuseHere("\"outer\" is expected here, after a facet's normal, in an ascii STL file");
    expect("loop");
    const auto first = static_cast<std::int64_t>(mesh_.vertexCount());
    for (int corner = 0; corner < 3; ++corner) {
      expect("vertex");
      Point p;
      for (int i = 0; i < 3; ++i) p[i] = text_.coordinate(text_.word());
      mesh_.addVertex(p);
    }
    expect("endloop");
    expect("endfacet");
    (void)mesh_.addPolygon(std::array{first, first + 1, first + 2});
  }

  TextCursor text_;
  MeshBuilder mesh_;
};

/// Unit, or 0 for a triangle without area.
Vec3 normalOf(const std::array<Point, 3>& t) {
  const DVec3 a(t[0]), n = cross(DVec3(t[1]) - a, DVec3(t[2]) - a);
  const double size = length(n);
  return size > 0 && std::isfinite(size) ? Vec3(n / size) : Vec3(0);
}

}  // namespace

bool looksLikeBinaryStl(std::string_view bytes) {
  if (bytes.size() < kHeaderSize + kCountSize) return false;
  const std::uint64_t count = u32(bytes, kHeaderSize);
  return count > 0 && bytes.size() == kHeaderSize + kCountSize + count * kFacetSize;
}

TriangleMesh readStl(const Source& source) {
  if (looksLikeBinaryStl(source.bytes)) return readBinary(source);
  // Binary files may begin with "solid" too; a text has no zero bytes.
  TextCursor text(source);
  const bool isText =
      lowered(text.word()) == "solid" && std::memchr(source.bytes.data(), 0, source.bytes.size()) == nullptr;
  return isText ? AsciiReader(source).read() : readBinary(source);
}

std::string writeStl(const TriangleMesh& mesh, const MeshWriteOptions& options) {
  if (mesh.triangles.size() > std::numeric_limits<std::uint32_t>::max())
    throw InputError(fmt::format("{} triangles; an STL file holds up to 4294967295", mesh.triangles.size()));
  const bool ascii = options.encoding == MeshEncoding::Ascii;
  std::string out;
  if (ascii) {
    out = "solid restroke\n";
  } else {
    // Must not begin with "solid".
    out = "binary STL by restroke";
    out.resize(kHeaderSize, ' ');
    append32(out, static_cast<std::uint32_t>(mesh.triangles.size()));
    out.reserve(out.size() + mesh.triangles.size() * kFacetSize);
  }
  for (const auto& t : mesh.triangles) {
    const std::array<Point, 3> corners = {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
    const Vec3 n = normalOf(corners);
    if (ascii) {
      auto to = std::back_inserter(out);
      fmt::format_to(to, "  facet normal {} {} {}\n    outer loop\n", shortest(n.x), shortest(n.y),
                     shortest(n.z));
      for (const Point& p : corners)
        fmt::format_to(to, "      vertex {} {} {}\n", shortest(p.x), shortest(p.y), shortest(p.z));
      out += "    endloop\n  endfacet\n";
    } else {
      for (const Vec3& v : {n, corners[0], corners[1], corners[2]})
        for (int i = 0; i < 3; ++i) append32(out, std::bit_cast<std::uint32_t>(v[i]));
      out.append(2, '\0');
    }
  }
  if (ascii) out += "endsolid restroke\n";
  return out;
}

}  // namespace restroke::points::formats
