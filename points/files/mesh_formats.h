#pragma once
// What the readers and writers of mesh formats share. For mesh_*.cpp, and for readers of other text files;
// others include mesh_files.h.
//
// Why they are our own but for 3MF's reader: assimp (5.2.5) was tried on the files of tests/points. It
// rounds decimal numbers to neighbours of the nearest float (a twentieth of the coordinates of one OBJ file),
// leaves out the last faces of OFF files, refuses an empty STL file, and stops the whole program on a binary
// PLY whose data begin with a line feed. lib3mf reads numbers right, but writes six decimals and random
// identifiers.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "implicit/errors.h"
#include "implicit/geometry/triangle_mesh.h"
#include "points/files/mesh_files.h"

namespace restroke::points::formats {

/// A file in memory.
struct Source {
  std::string_view bytes;
  std::filesystem::path name;
};

/// Throws the sentence "<file>: <place>: <what>", or without a place where that is empty.
[[noreturn]] void refuse(const Source& source, const std::string& place, std::string what);

/// The whole file. Throws InputError that names it, also for a folder or a device, where `wanted` ("a mesh
/// file") is what is needed.
[[nodiscard]] std::string contentsOf(const std::filesystem::path& path, const char* wanted);

// Numbers ---------------------------------------------------------------------------------------------------

/// The whole word as a number, rounded to the nearest float; nothing when it is no number, or not finite as a
/// float32.
[[nodiscard]] std::optional<float> parseFloat(std::string_view word);
/// The same as a double. What is too small for one is 0.
[[nodiscard]] std::optional<double> parseDouble(std::string_view word);
[[nodiscard]] std::optional<std::int64_t> parseInteger(std::string_view word);

/// The shortest text that reads back as the same number, as std::to_chars defines it: fmt's depends on its
/// version.
[[nodiscard]] std::string shortest(float value);
[[nodiscard]] std::string shortest(double value);

/// ASCII letters made small.
[[nodiscard]] std::string lowered(std::string_view text);

// Text ------------------------------------------------------------------------------------------------------

/// Walks through the words of a text, line by line. Lines end with LF, CR LF or CR.
class TextCursor {
 public:
  /// What begins a comment that lasts to the end of the line; 0 where the format has none.
  explicit TextCursor(const Source& source, char comment = 0) : source_(source), comment_(comment) {}

  /// Goes to the next line, and reports whether there is one.
  bool nextLine();
  /// Goes to the next line with a word in it.
  bool nextFilledLine();
  /// The next word of this line; empty when there is none.
  std::string_view wordOfLine();
  /// The next word of this line or a later one; empty at the end of the file.
  std::string_view word();
  /// What is left of this line, with comments.
  std::string_view restOfLine();

  /// From 1 on; 0 before the first.
  [[nodiscard]] std::size_t lineNumber() const { return number_; }
  /// "line 17"
  [[nodiscard]] std::string place() const;
  /// Where the next line begins, in bytes.
  [[nodiscard]] std::size_t nextByte() const { return next_; }

  [[noreturn]] void refuseHere(const std::string& what) const { refuse(source_, place(), what); }

  /// `word` as a coordinate; what is no finite float32 is refused.
  [[nodiscard]] float coordinate(std::string_view word) const;
  /// `word` as a double; `what` names it in the sentence when it is none, or not finite.
  [[nodiscard]] double number(std::string_view word, const char* what) const;
  /// `word` as an integer; `what` names it in the sentence when it is none.
  [[nodiscard]] std::int64_t integer(std::string_view word, const char* what) const;

 private:
  const Source& source_;
  char comment_;
  std::string_view line_;  ///< what is left of the current line
  std::size_t next_ = 0;
  std::size_t number_ = 0;
};

// Meshes ----------------------------------------------------------------------------------------------------

/// Collects a mesh as a file tells it. Vertices are numbered as in the file.
class MeshBuilder {
 public:
  void addVertex(Point p) { mesh_.vertices.push_back(p); }
  [[nodiscard]] std::size_t vertexCount() const { return mesh_.vertices.size(); }
  /// Adds a fan. Nothing but an index that is out of range can be wrong: the first such one is returned.
  [[nodiscard]] std::optional<std::int64_t> addPolygon(std::span<const std::int64_t> corners);
  /// Adds vertices and triangles whose indices count from the first of them.
  void append(const TriangleMesh& part);
  /// With equal positions made one.
  [[nodiscard]] TriangleMesh finish() &&;

 private:
  TriangleMesh mesh_;
};

// Readers ---------------------------------------------------------------------------------------------------

[[nodiscard]] TriangleMesh readStl(const Source& source);
[[nodiscard]] TriangleMesh readOff(const Source& source);
[[nodiscard]] TriangleMesh readObj(const Source& source);
[[nodiscard]] TriangleMesh readPly(const Source& source);
[[nodiscard]] TriangleMesh readAmf(const Source& source);
[[nodiscard]] TriangleMesh readZippedAmf(const Source& source);
[[nodiscard]] TriangleMesh read3mf(const Source& source);

/// Is it as long as a binary STL file says that it is?
[[nodiscard]] bool looksLikeBinaryStl(std::string_view bytes);

// Writers: the contents of a file ---------------------------------------------------------------------------

/// "millimeter" and so on, as AMF and 3MF spell it.
[[nodiscard]] const char* nameOf(LengthUnit unit);

[[nodiscard]] std::string writeStl(const TriangleMesh& mesh, const MeshWriteOptions& options);
[[nodiscard]] std::string writePly(const TriangleMesh& mesh, const MeshWriteOptions& options);
[[nodiscard]] std::string writeObj(const TriangleMesh& mesh, const MeshWriteOptions& options);
[[nodiscard]] std::string writeAmf(const TriangleMesh& mesh, const MeshWriteOptions& options);
[[nodiscard]] std::string write3mf(const TriangleMesh& mesh, const MeshWriteOptions& options);

}  // namespace restroke::points::formats
