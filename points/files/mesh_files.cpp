#include "points/files/mesh_files.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "implicit/atomic_file.h"
#include "points/files/mesh_formats.h"
#include "points/files/zip.h"

namespace restroke::points {
namespace formats {
namespace {

using Bits = std::array<std::uint32_t, 3>;

struct HashOfBits {
  std::size_t operator()(const Bits& bits) const {
    std::uint64_t h = 0;
    for (const std::uint32_t b : bits) {
      h = (h ^ b) * 0x9e3779b97f4a7c15u;
      h ^= h >> 32;
    }
    return static_cast<std::size_t>(h);
  }
};

}  // namespace

std::optional<std::int64_t> MeshBuilder::addPolygon(std::span<const std::int64_t> corners) {
  const auto count = static_cast<std::int64_t>(mesh_.vertices.size());
  for (const std::int64_t v : corners)
    if (v < 0 || v >= count) return v;
  const auto at = [&](std::size_t i) { return static_cast<std::uint32_t>(corners[i]); };
  for (std::size_t i = 2; i < corners.size(); ++i) mesh_.triangles.push_back({at(0), at(i - 1), at(i)});
  return std::nullopt;
}

void MeshBuilder::append(const TriangleMesh& part) {
  const auto base = static_cast<std::uint32_t>(mesh_.vertices.size());
  mesh_.vertices.insert(mesh_.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const auto& t : part.triangles) mesh_.triangles.push_back({base + t[0], base + t[1], base + t[2]});
}

TriangleMesh MeshBuilder::finish() && {
  if (mesh_.vertices.size() > std::numeric_limits<std::uint32_t>::max())
    throw InputError(
        fmt::format("the mesh has {} vertices; up to 4294967295 can be numbered", mesh_.vertices.size()));
  // The map is only asked, never walked through: its order is no matter.
  std::unordered_map<Bits, std::uint32_t, HashOfBits> known;
  known.reserve(mesh_.vertices.size());
  std::vector<std::uint32_t> number;
  number.reserve(mesh_.vertices.size());
  TriangleMesh welded;
  for (const Point& p : mesh_.vertices) {
    const Point q = p + Point(0.0f);  // -0 and 0 are one place
    const Bits bits{std::bit_cast<std::uint32_t>(q.x), std::bit_cast<std::uint32_t>(q.y),
                    std::bit_cast<std::uint32_t>(q.z)};
    const auto [entry, isNew] = known.try_emplace(bits, static_cast<std::uint32_t>(welded.vertices.size()));
    if (isNew) welded.vertices.push_back(q);
    number.push_back(entry->second);
  }
  welded.triangles = std::move(mesh_.triangles);
  for (auto& triangle : welded.triangles)
    for (std::uint32_t& v : triangle) v = number[v];
  return welded;
}

}  // namespace formats

namespace {

namespace fs = std::filesystem;
using formats::Source;

std::string endingOf(const fs::path& name) {
  return formats::lowered(name.extension().string());
}

TriangleMesh parseZip(const Source& source) {
  std::vector<ZipMember> members;
  try {
    members = zipMembers(source.bytes);
  } catch (const InputError& error) {
    formats::refuse(source, "", error.what());
  }
  const auto has = [&](const auto& isWanted) {
    return std::any_of(members.begin(), members.end(), isWanted);
  };
  if (has([](const ZipMember& m) { return m.name == "[Content_Types].xml" || m.name.ends_with(".model"); }))
    return formats::read3mf(source);
  if (has([](const ZipMember& m) { return endingOf(m.name) == ".amf"; }))
    return formats::readZippedAmf(source);
  formats::refuse(source, "", "a zip archive without a 3MF model and without a member that ends in .amf");
}

/// The first word of a text, comment lines passed over.
std::string firstWord(const Source& source) {
  formats::TextCursor text(source, '#');
  return std::string(text.word());
}

bool isOffKeyword(std::string_view word) {
  return word.size() <= 8 && word.ends_with("OFF") &&
         word.find_first_not_of("STCN4nOF") == std::string_view::npos;
}

bool isAmf(std::string_view bytes) {
  // An XML declaration, a comment and a doctype may stand before the root.
  return bytes.substr(0, 2000).find("<amf") != std::string_view::npos;
}

TriangleMesh parse(const Source& source) {
  using namespace formats;
  const std::string_view bytes = source.bytes;
  const std::string ending = endingOf(source.name);
  if (bytes.empty()) refuse(source, "", "the file is empty; a mesh file has at least a header");
  if (isZip(bytes)) return parseZip(source);
  if (looksLikeBinaryStl(bytes)) return readStl(source);
  if (bytes.starts_with("ply")) return readPly(source);
  const std::string word = firstWord(source);
  if (isOffKeyword(word)) return readOff(source);
  if (word.starts_with("<") && isAmf(bytes)) return readAmf(source);
  if (lowered(word) == "solid" || ending == ".stl") return readStl(source);
  if (ending == ".obj") return readObj(source);
  for (const char* keyword : {"v", "f", "vn", "vt", "o", "g", "mtllib", "usemtl"})
    if (word == keyword) return readObj(source);
  if (ending == ".ply") refuse(source, "line 1", "the file does not begin with \"ply\", as a PLY file does");
  if (ending == ".off")
    refuse(source, "line 1", "the file does not begin with OFF, COFF or the like, as an OFF file does");
  if (ending == ".amf") refuse(source, "", "neither XML with an <amf> element nor a zip archive");
  if (ending == ".3mf") refuse(source, "", "not a zip archive, as a 3MF file is");
  refuse(source, "", "not a mesh file that is known here (STL, PLY, OBJ, OFF, 3MF, AMF)");
}

}  // namespace

TriangleMesh parseMesh(std::string_view contents, const fs::path& name) {
  return parse({contents, name});
}

TriangleMesh readMesh(const fs::path& path) {
  const std::string contents = formats::contentsOf(path, "a mesh file");
  return parseMesh(contents, path);
}

void writeMesh(const fs::path& path, const TriangleMesh& mesh, const MeshWriteOptions& options) {
  const auto fail = [&](const std::string& what) {
    throw InputError(fmt::format("{}: {}", path.string(), what));
  };
  if (!(options.scale > 0) || !std::isfinite(options.scale))
    fail(fmt::format("the scale is {}; it has to be positive and finite", options.scale));
  for (const std::string& comment : options.comments)
    if (comment.find_first_of("\r\n") != std::string::npos)
      fail("a comment has a line break; a header has one comment a line");
  TriangleMesh scaled = mesh;
  for (std::size_t v = 0; v < scaled.vertices.size(); ++v) {
    Point& p = scaled.vertices[v];
    if (options.scale != 1) p = Point(DVec3(p) * options.scale);
    if (!isFinite(p))
      fail(fmt::format("vertex {} would be at ({}, {}, {}); only finite numbers can be stored", v, p.x, p.y,
                       p.z));
  }
  for (std::size_t t = 0; t < scaled.triangles.size(); ++t)
    for (const std::uint32_t v : scaled.triangles[t])
      if (v >= scaled.vertices.size())
        fail(fmt::format("triangle {} names vertex {}, but the mesh has {} vertices, from 0 on", t, v,
                         scaled.vertices.size()));
  const std::string ending = endingOf(path);
  std::string contents;
  try {
    if (ending == ".stl")
      contents = formats::writeStl(scaled, options);
    else if (ending == ".ply")
      contents = formats::writePly(scaled, options);
    else if (ending == ".obj")
      contents = formats::writeObj(scaled, options);
    else if (ending == ".amf")
      contents = formats::writeAmf(scaled, options);
    else if (ending == ".3mf")
      contents = formats::write3mf(scaled, options);
    else
      throw InputError(
          fmt::format("the ending is \"{}\"; meshes are written as .stl, .ply, .obj, .amf or .3mf", ending));
  } catch (const InputError& error) {
    fail(error.what());
  }
  writeFileAtomically(path, contents);
}

}  // namespace restroke::points
