#pragma once
// Triangle meshes in files: STL, PLY, OBJ, OFF, 3MF and AMF.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "implicit/geometry/triangle_mesh.h"

namespace restroke::points {

/// Reads a mesh. Which format it is is told by the contents, and by the name's ending where they leave it
/// open:
///
/// STL   ascii (several solids are one mesh) and binary, also binary files that begin with "solid"
/// PLY   1.0, ascii and binary of both byte orders: the elements "vertex" (x, y, z of any type) and "face"
/// OBJ   v and f, also with negative numbers; groups, materials, texture coordinates, normals, lines, points
///       and curves are passed over
/// OFF   also with colours, normals and texture coordinates (COFF, NOFF, ...); three dimensions, ascii. Faces
/// are read as
///       far as the header's count goes
/// 3MF   the build's items with their transforms and components; all objects of type model when nothing is
/// built AMF   plain or zipped; all objects, or the constellation's instances (moved, not turned). Curved
/// triangles
///       count as flat. Of a zip file the first member that ends in .amf
///
/// Coordinates are kept as they are in the file, whatever its unit, each rounded once to the nearest float32
/// (-0 becomes 0). Vertices at equal positions become one, the first of them, so that triangles share
/// vertices; unused ones stay. Polygons become fans about their first vertex. Nothing else is moved, mended
/// or left out, degenerate triangles included: ask faultsOf. A file of no triangles gives a mesh of none,
/// except where it is a point cloud.
///
/// Throws InputError, one sentence with the file, the line or byte, what was found and the rule. Time and
/// memory O(file size), but for packed files (what a zip member unpacks to is bounded by kUnpackedLimit).
[[nodiscard]] TriangleMesh readMesh(const std::filesystem::path& path);

/// The same for a file's contents; `name` is what sentences call it, and its ending counts as the file's.
[[nodiscard]] TriangleMesh parseMesh(std::string_view contents, const std::filesystem::path& name);

/// Largest size of a member of a zip file, in bytes.
inline constexpr std::uint64_t kUnpackedLimit = std::uint64_t{1} << 31;

enum class MeshEncoding : std::uint8_t { Binary, Ascii };
enum class LengthUnit : std::uint8_t { Millimetre, Centimetre, Metre };

struct MeshWriteOptions {
  /// Of STL and PLY; the other formats are text (3MF packed text).
  MeshEncoding encoding = MeshEncoding::Binary;
  /// What a coordinate of 1 means, written where the format has a place for it: 3MF, AMF (which has no
  /// centimetres: they are written as millimetres, coordinates times 10) and, as a comment, PLY and OBJ.
  LengthUnit unit = LengthUnit::Millimetre;
  /// Coordinates are multiplied by this, in double precision, and rounded to float32. Positive and finite.
  double scale = 1;
  /// Lines for the header of PLY and OBJ, without line breaks.
  std::vector<std::string> comments = {};
};

/// Writes a mesh in the format that the ending names: .stl, .ply, .obj, .amf or .3mf, in any case. Ascii
/// numbers are the shortest that read back as the same float32; a mesh without unused or doubled vertices is
/// read back equal (STL numbers vertices anew, in the order of the triangles). The same mesh and options give
/// the same bytes, 3MF with one version of zlib. Written beside its final name and renamed. Throws InputError
/// when the ending is another one, the file cannot be written, a coordinate is not finite (after scaling), an
/// index is out of range, or the format cannot hold the mesh (3MF: coordinates up to 1e9, no triangle that
/// repeats a vertex). O(mesh) time and memory.
void writeMesh(const std::filesystem::path& path, const TriangleMesh& mesh,
               const MeshWriteOptions& options = {});

}  // namespace restroke::points
