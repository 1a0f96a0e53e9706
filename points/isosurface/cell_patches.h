#pragma once
// The topology of one cell: which of its crossed edges belong to the same patch of surface.

#include <array>
#include <cstdint>

namespace restroke::points {

// Corner c of a cell stands at offsets (c & 1, c >> 1 & 1, c >> 2 & 1) along x, y, z; bit c of a cell's
// `corners` says that the corner is inside. Edge 4a + u + 2v runs along axis a, u and v being its offsets
// along the axes a + 1 and a + 2 (mod 3). Face 2a + s is the one at offset s along axis a. Sets of faces are
// bits.
//
// A face with two inside corners diagonally opposite is ambiguous: each of them may be cut off by a segment
// of its own, or they may be joined, each outside corner being cut off. Any reading will do, as long as both
// cells that share the face read it in the same way.

inline constexpr std::uint8_t kNoPatch = 0xff;

/// Lowest corner of a cell's edge; the other end is one step further along axis edge / 4.
[[nodiscard]] constexpr int lowCornerOf(int edge) {
  const int a = edge / 4;
  return (edge & 1) << (a + 1) % 3 | (edge >> 1 & 1) << (a + 2) % 3;
}

/// Patches of one cell, numbered from 0 in the order of their first edges; at most 4.
struct CellPatches {
  std::uint8_t count = 0;
  std::array<std::uint8_t, 12> ofEdge{};  ///< kNoPatch for an edge without a crossing
  std::uint8_t doubleFaces = 0;           ///< ambiguous faces on which both segments are of one patch
};

/// Ambiguous faces of a cell with these corners.
[[nodiscard]] std::uint8_t ambiguousFacesOf(std::uint8_t corners);

/// All faces are ambiguous: inside and outside corners alternate. Read with some faces joined and some not,
/// it is the only cell with two patches that no plane separates (tests/points/cell_patches_test.cpp tries
/// all).
[[nodiscard]] constexpr bool isCheckerboard(std::uint8_t corners) {
  return corners == 0x69 || corners == 0x96;
}

/// The patches of a cell with these corners, in which the inside corners of `joinedFaces` are joined; faces
/// that are not ambiguous do not matter there.
[[nodiscard]] CellPatches patchesOf(std::uint8_t corners, std::uint8_t joinedFaces);

/// The other end of the segment that begins or ends on a crossed edge of a face.
struct FaceEdge {
  std::uint8_t face, edge;
};
[[nodiscard]] int otherEnd(std::uint8_t corners, std::uint8_t joinedFaces, FaceEdge at);

}  // namespace restroke::points
