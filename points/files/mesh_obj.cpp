// OBJ: Wavefront Advanced Visualizer, appendix B1, Object Files; the part of it that is polygons.

#include <algorithm>
#include <iterator>
#include <vector>

#include "points/files/mesh_formats.h"

namespace restroke::points::formats {
namespace {

/// What says nothing about polygons, from appendix B1. A line that begins with any other word is refused, so
/// that a file that is no OBJ file is not a mesh of nothing.
constexpr std::string_view kPassedOver[] = {
    "vt",     "vn",     "vp",     "cstype", "deg",        "bmat",      "step",     "p",        "l",
    "curv",   "curv2",  "surf",   "parm",   "trim",       "hole",      "scrv",     "sp",       "end",
    "con",    "g",      "s",      "mg",     "o",          "bevel",     "c_interp", "d_interp", "lod",
    "usemtl", "mtllib", "usemap", "maplib", "shadow_obj", "trace_obj", "ctech",    "stech",    "bsp",
    "bzp",    "cdc",    "cdp",    "res",    "call",       "csh"};

class ObjReader {
 public:
  explicit ObjReader(const Source& source) : text_(source, '#') {}

  TriangleMesh read() {
    while (text_.nextFilledLine()) {
      const std::string_view keyword = text_.wordOfLine();
      if (keyword == "v")
        readVertex();
      else if (keyword == "f" || keyword == "fo")
        readFace();
      else if (std::find(std::begin(kPassedOver), std::end(kPassedOver), keyword) == std::end(kPassedOver))
        text_.refuseHere("the line begins with a word that OBJ files do not have");
      else
        passOver();
    }
    if (mesh_.vertexCount() > 0 && !hasFaces_)
      text_.refuseHere("the file ends without a face (f); a mesh is needed, not points or curves");
    return std::move(mesh_).finish();
  }

 private:
  /// The next word; a backslash at the end of a line continues it on the next.
  std::string_view nextWord() {
    for (;;) {
      std::string_view word = text_.wordOfLine();
      if (!word.ends_with('\\')) return word;
      word.remove_suffix(1);
      if (!text_.nextLine() || !word.empty()) return word;
    }
  }

  void passOver() {
    while (!nextWord().empty()) {
    }
  }

  void readVertex() {
    Point p;
    for (int i = 0; i < 3; ++i) p[i] = text_.coordinate(nextWord());
    mesh_.addVertex(p);  // what follows is a weight or a colour
  }

  void readFace() {
    corners_.clear();
    for (std::string_view word = nextWord(); !word.empty(); word = nextWord()) {
      // v, v/vt, v//vn or v/vt/vn; from 1 on, or from -1 back.
      const auto count = static_cast<std::int64_t>(mesh_.vertexCount());
      const std::int64_t number = text_.integer(word.substr(0, word.find('/')), "a face's vertex");
      if (number == 0 || number > count || number < -count)
        text_.refuseHere(
            fmt::format("a face names vertex {}, but {} have been listed, from 1 on", number, count));
      corners_.push_back(number > 0 ? number - 1 : count + number);
    }
    if (corners_.size() < 3)
      text_.refuseHere(fmt::format("a face has {} corners; it needs three or more", corners_.size()));
    (void)mesh_.addPolygon(corners_);
    hasFaces_ = true;
  }

  TextCursor text_;
  MeshBuilder mesh_;
  std::vector<std::int64_t> corners_;
  bool hasFaces_ = false;
};

}  // namespace

TriangleMesh readObj(const Source& source) {
  return ObjReader(source).read();
}

std::string writeObj(const TriangleMesh& mesh, const MeshWriteOptions& options) {
  std::string out;
  auto to = std::back_inserter(out);
  fmt::format_to(to, "# unit {}\n", nameOf(options.unit));
  for (const std::string& comment : options.comments) fmt::format_to(to, "# {}\n", comment);
  for (const Point& p : mesh.vertices)
    fmt::format_to(to, "v {} {} {}\n", shortest(p.x), shortest(p.y), shortest(p.z));
  for (const auto& t : mesh.triangles)
    fmt::format_to(to, "f {} {} {}\n", std::uint64_t{t[0]} + 1, std::uint64_t{t[1]} + 1,
                   std::uint64_t{t[2]} + 1);
  return out;
}

}  // namespace restroke::points::formats
