// OFF: Object File Format of Geomview, http://www.geomview.org/docs/html/OFF.html.

#include <vector>

#include "points/files/mesh_formats.h"

namespace restroke::points::formats {
namespace {

class OffReader {
 public:
  explicit OffReader(const Source& source) : source_(source), text_(source, '#') {}

  TriangleMesh read() {
    const std::string keyword(text_.word());
    if (keyword.find_first_of("4n") != std::string::npos)
      text_.refuseHere(
          fmt::format("the file begins with {}; OFF files are read in three dimensions only", keyword));
    const std::string_view word = text_.word();
    if (lowered(word) == "binary") text_.refuseHere("this is a binary OFF file; ascii ones are read only");
    const std::uint64_t vertices = checkedCount(word, "the number of vertices");
    const std::uint64_t faces = checkedCount(text_.word(), "the number of faces");
    (void)text_.restOfLine();  // the number of edges, which may be missing
    for (std::uint64_t v = 0; v < vertices; ++v) readVertex(v, vertices);
    for (std::uint64_t f = 0; f < faces; ++f) readFace(f, faces);
    return std::move(mesh_).finish();
  }

 private:
  std::uint64_t checkedCount(std::string_view word, const char* what) {
    const std::int64_t count = text_.integer(word, what);
    // A line of three numbers.
    constexpr std::size_t kShortest = 5;
    if (count < 0 || static_cast<std::uint64_t>(count) > source_.bytes.size() / kShortest)
      text_.refuseHere(fmt::format("{} is {}, but the file has room for 0 to {}", what, count,
                                   source_.bytes.size() / kShortest));
    return static_cast<std::uint64_t>(count);
  }

  void readVertex(std::uint64_t v, std::uint64_t count) {
    if (!text_.nextFilledLine())
      text_.refuseHere(fmt::format("the file ends after {} of its {} vertices", v, count));
    // One vertex a line; what follows its coordinates are a normal, a colour, texture coordinates.
    Point p;
    for (int i = 0; i < 3; ++i) p[i] = text_.coordinate(text_.wordOfLine());
    mesh_.addVertex(p);
  }

  void readFace(std::uint64_t f, std::uint64_t count) {
    if (!text_.nextFilledLine())
      text_.refuseHere(fmt::format("the file ends after {} of its {} faces", f, count));
    const std::int64_t corners = text_.integer(text_.wordOfLine(), "the number of a face's corners");
    if (corners < 3) text_.refuseHere(fmt::format("a face has {} corners; it needs three or more", corners));
    corners_.clear();
    for (std::int64_t i = 0; i < corners; ++i)
      corners_.push_back(text_.integer(text_.wordOfLine(), "a face's vertex"));
    if (const auto wrong = mesh_.addPolygon(corners_))
      text_.refuseHere(
          fmt::format("a face names vertex {}, but there are {}, from 0 on", *wrong, mesh_.vertexCount()));
  }

  const Source& source_;
  TextCursor text_;
  MeshBuilder mesh_;
  std::vector<std::int64_t> corners_;
};

}  // namespace

TriangleMesh readOff(const Source& source) {
  return OffReader(source).read();
}

}  // namespace restroke::points::formats
