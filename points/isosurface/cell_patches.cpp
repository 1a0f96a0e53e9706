// Nielson, "Dual marching cubes", IEEE Visualization 2004: the loops that marching cubes would draw on a
// cell's boundary are its patches, and each gets one vertex.

#include "points/isosurface/cell_patches.h"

#include <utility>

namespace restroke::points {

namespace {

using Segment = std::pair<int, int>;  // from the edge where the inside ends to the one where it begins

constexpr int edgeBetween(int corner, int other) {
  for (int e = 0; e < 12; ++e) {
    const int low = lowCornerOf(e), high = low | 1 << e / 4;
    if ((low == corner && high == other) || (low == other && high == corner)) return e;
  }
  return -1;
}

// Faces' corners in counter-clockwise order, seen from outside the cell, and the edges that follow each.
struct FaceRing {
  std::array<int, 4> corner{}, edge{};
};

constexpr std::array<FaceRing, 6> kRings = [] {
  std::array<FaceRing, 6> rings{};
  for (int face = 0; face < 6; ++face) {
    const int a = face / 2, s = face % 2;
    const int o = s << a, u = 1 << (a + 1) % 3, v = 1 << (a + 2) % 3;
    FaceRing& ring = rings[static_cast<std::size_t>(face)];
    ring.corner = {o, s == 1 ? o | u : o | v, o | u | v, s == 1 ? o | v : o | u};
    for (std::size_t i = 0; i < 4; ++i) ring.edge[i] = edgeBetween(ring.corner[i], ring.corner[(i + 1) % 4]);
  }
  return rings;
}();

struct FaceSegments {
  int count = 0;
  std::array<Segment, 2> segments{};
};

constexpr FaceSegments segmentsOn(int face, unsigned corners, unsigned joinedFaces) {
  const FaceRing& ring = kRings[static_cast<std::size_t>(face)];
  const auto inside = [&](int i) {
    return (corners >> ring.corner[static_cast<std::size_t>(i & 3)] & 1) != 0;
  };
  FaceSegments out;
  for (int i = 0; i < 4; ++i) {
    if (!inside(i) || inside(i + 1)) continue;
    // Around the run of inside corners that ends at i, or around the run of outside ones that begins there.
    const int step = (joinedFaces >> face & 1) != 0 ? 1 : 3;
    int j = i + step;
    while (inside(j) || !inside(j + 1)) j += step;
    out.segments[static_cast<std::size_t>(out.count++)] = {ring.edge[static_cast<std::size_t>(i)],
                                                           ring.edge[static_cast<std::size_t>(j & 3)]};
  }
  return out;
}

constexpr CellPatches trace(unsigned corners, unsigned joinedFaces) {
  std::array<int, 12> next{};
  for (int& n : next) n = -1;
  std::array<FaceSegments, 6> faces{};
  for (int face = 0; face < 6; ++face) {
    FaceSegments& s = faces[static_cast<std::size_t>(face)];
    s = segmentsOn(face, corners, joinedFaces);
    for (int k = 0; k < s.count; ++k) {
      const Segment& segment = s.segments[static_cast<std::size_t>(k)];
      next[static_cast<std::size_t>(segment.first)] = segment.second;
    }
  }
  CellPatches out;
  for (std::uint8_t& p : out.ofEdge) p = kNoPatch;
  for (std::size_t e = 0; e < 12; ++e) {
    if (next[e] < 0 || out.ofEdge[e] != kNoPatch) continue;
    for (std::size_t at = e; out.ofEdge[at] == kNoPatch; at = static_cast<std::size_t>(next[at]))
      out.ofEdge[at] = out.count;
    ++out.count;
  }
  for (std::size_t face = 0; face < 6; ++face) {
    const FaceSegments& s = faces[face];
    if (s.count == 2 && out.ofEdge[static_cast<std::size_t>(s.segments[0].first)] ==
                            out.ofEdge[static_cast<std::size_t>(s.segments[1].first)])
      out.doubleFaces = static_cast<std::uint8_t>(out.doubleFaces | 1u << face);
  }
  return out;
}

// Of the reading in which nothing is joined, which is that of nearly all cells.
constexpr std::array<CellPatches, 256> kSeparate = [] {
  std::array<CellPatches, 256> table{};
  for (unsigned corners = 0; corners < 256; ++corners) table[corners] = trace(corners, 0);
  return table;
}();

}  // namespace

std::uint8_t ambiguousFacesOf(std::uint8_t corners) {
  unsigned faces = 0;
  for (int face = 0; face < 6; ++face)
    if (segmentsOn(face, corners, 0).count == 2) faces |= 1u << face;
  return static_cast<std::uint8_t>(faces);
}

CellPatches patchesOf(std::uint8_t corners, std::uint8_t joinedFaces) {
  return joinedFaces == 0 ? kSeparate[corners] : trace(corners, joinedFaces);
}

int otherEnd(std::uint8_t corners, std::uint8_t joinedFaces, FaceEdge at) {
  const FaceSegments s = segmentsOn(at.face, corners, joinedFaces);
  for (int k = 0; k < s.count; ++k) {
    const auto [from, to] = s.segments[static_cast<std::size_t>(k)];
    if (from == at.edge) return to;
    if (to == at.edge) return from;
  }
  return -1;
}

}  // namespace restroke::points
