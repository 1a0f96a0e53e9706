#pragma once
// Tri-dexels on the graphics card: sampled from meshes by drawing them, changed by compute shaders (SPEC D2,
// D5).

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "implicit/geometry/triangle_mesh.h"
#include "points/dexel/tool_pose.h"
#include "points/dexel/tri_dexel.h"

namespace restroke::points {

/// An OpenGL 4.3 core context of its own, made through EGL (surfaceless), with the programs for tri-dexels.
/// On a machine without a graphics card Mesa's software driver serves.
///
/// Copies are the same context. It and what lives in it may be used from any thread; calls wait for each
/// other. After a call the calling thread's former EGL context is current again. A thread on which a GLX
/// context is current cannot use it.
class GlDexelContext {
 public:
  /// Throws InputError when there is no EGL display or no OpenGL 4.3 context, with what EGL says.
  GlDexelContext();
  /// The driver's name and version, for reports.
  [[nodiscard]] const std::string& driver() const;

  class State;
  [[nodiscard]] const std::shared_ptr<State>& state() const { return state_; }

 private:
  std::shared_ptr<State> state_;
};

/// A triangle mesh on the graphics card; 36 bytes a triangle there.
class GlMesh {
 public:
  /// Throws InputError when a coordinate of a triangle is not finite, or the mesh has more than
  /// kMostGlTriangles triangles.
  GlMesh(const GlDexelContext& context, const TriangleMesh& mesh);
  ~GlMesh();
  GlMesh(GlMesh&&) noexcept;
  GlMesh& operator=(GlMesh&&) noexcept;

  class Implementation;
  [[nodiscard]] const Implementation& implementation() const { return *implementation_; }

 private:
  std::unique_ptr<Implementation> implementation_;
};
inline constexpr std::size_t kMostGlTriangles = std::size_t{1} << 27;

/// How the crossings of each line are found. Fragments is the default as its cost does not grow with the
/// layers: 2 to 12 times as fast on shared/data's closed meshes at 128 lines.
enum class PeelMethod : std::uint8_t {
  /// All fragments of a line are gathered, then sorted: the mesh is drawn twice (to count, and to gather),
  /// however many layers there are.
  Fragments,
  /// Depth peeling proper (C. Everitt, Interactive Order-Independent Transparency, 2001): layer after layer,
  /// each by drawing the mesh twice (for the next depth, and for which triangle it is). As slow as there are
  /// layers; there to be compared with.
  Layers,
};

struct PeelOptions {
  PeelMethod method = PeelMethod::Fragments;
  /// Applied to the mesh first: ((m0 x + m1 y) + m2 z) + m3 for each row, in double, rounded once to float32.
  /// A mesh that was posed so beforehand gives the same bits.
  PoseMatrix pose = kIdentityPose;
};

/// Lines that cross a mesh an odd number of times: it is not closed there.
struct OddLines {
  std::size_t count = 0;
  struct Place {
    int family = 0, column = 0, row = 0;
    bool operator==(const Place&) const = default;
  };
  /// The first of them, at most kPlaces, by family, row and column.
  std::vector<Place> first;
  static constexpr std::size_t kPlaces = 16;
};

/// A tri-dexel (tri_dexel.h) in the graphics card's memory: 4 bytes a line and 16 an end, and room to grow.
/// What an operation needs meanwhile, about as much again, stays with the context for the next one. Nothing
/// is read back before it is asked for, but now and then a number that says how much memory is needed.
///
/// Its lines are kept in bands of whole rows, each with its own buffers and its own picture when a mesh is
/// drawn, so that a driver's limits bound a band and not the model.
class GlTriDexel {
 public:
  struct Options {
    /// At most so many, but a row at least. 1 to kMostLinesPerBand; without, an eighth of a family's lines,
    /// but 2^14 to 2^20: bands that a small tool does not meet cost nothing, each one that it meets costs
    /// some starts of programs, and meshes are drawn once for each band.
    std::optional<std::size_t> linesPerBand = std::nullopt;
  };
  static constexpr std::size_t kMostLinesPerBand = std::size_t{1} << 22;

  /// An empty solid. Throws InputError when a row has more lines than the driver's pictures may be wide, or
  /// memory does not suffice (any function here may say that).
  GlTriDexel(const GlDexelContext& context, const DexelGrid& grid, Options options);
  GlTriDexel(const GlDexelContext& context, const DexelGrid& grid) : GlTriDexel(context, grid, Options{}) {}
  ~GlTriDexel();
  GlTriDexel(GlTriDexel&&) noexcept;
  GlTriDexel& operator=(GlTriDexel&&) noexcept;

  [[nodiscard]] const DexelGrid& grid() const;
  /// Becomes the model, whose grid must be this one's (InternalError). Throws InputError for a model that
  /// keeps histories of its lines: nothing here would note what changes them. O(lines + ends).
  void upload(const TriDexel& model);
  /// The same ends as were uploaded, bit for bit; with the operations of the ends, unless the model that was
  /// uploaded kept none. O(lines + ends).
  [[nodiscard]] TriDexel download() const;

  /// Unites with another solid on the same lines, subtracts it, or keeps what both have: what TriDexel::apply
  /// does, with the same result bit for bit, one work item a line (SPEC D5). One restriction: where a
  /// driver's float32 subtraction takes denormal numbers (below 1.2e-38) for zero, and the neighbours of a
  /// new end are so near, another one of the two may tell what is beyond it (SpanEnd::inner, outer). The
  /// grids, the contexts and the lines per band must be the same (InternalError). O(ends) in each band in
  /// which the tool is not empty.
  void apply(const GlTriDexel& tool, DexelOperation operation, OperationId id);

  /// Becomes the solid that the mesh bounds (operation Initial, no flags), by layered depth-normal images of
  /// the three families: each line's crossings with the mesh, in ascending order, are entries and exits in
  /// turn. Normals are the triangles', turned to the outside of the span. Both methods give the same bits.
  ///
  /// What is promised: the driver only proposes triangles for a line, a little too many; whether the line
  /// crosses one is decided in the shader in double, with a line through an edge or a corner taken as moved
  /// by less than any number (as crossingOf in exact_predicates.h). So lines that run in faces, along edges
  /// or through corners are as good as others; a closed mesh has no odd line whatever the rounding; and where
  /// products of coordinate differences fit a double (53 bits: coordinates of like magnitude) the crossings
  /// are exactly those of the exact predicates. Depths are computed in double, kept between those of the
  /// triangle's corners, and rounded once: see kPeelDepthBound. Crossings whose depths are the same float32
  /// number vanish in pairs: a wall that thin is not there. Surfaces that overlap are told by parity alone:
  /// inside twice is outside. Faces seen edge-on by a family have no crossings with it.
  ///
  /// On a driver whose doubles are not those of IEEE 754 results may differ in what depends on the last bit.
  /// Throws InputError when the pose is not finite, its last row is not 0 0 0 1, or the posed mesh reaches
  /// beyond 1e30.
  void peel(const GlMesh& mesh, const PeelOptions& options = {});
  /// Of the last peel: none before the first. Their last entry, which has no exit, is left out.
  [[nodiscard]] OddLines oddLines() const;

  /// Reads a number for each band.
  [[nodiscard]] std::size_t endCount() const;
  /// Of the graphics card's memory.
  [[nodiscard]] std::size_t bytes() const;

  class Implementation;

 private:
  std::unique_ptr<Implementation> implementation_;
};

/// Where the same line crosses the same triangle, the depth differs from the exact one by at most this part
/// of the largest coordinate of the posed mesh: rounding to float32 is 2^-24 of the depth, and double adds
/// next to nothing, but on triangles that are seen at less than some 1e-8 radians. Measured 2^-24.
inline constexpr double kPeelDepthBound = 0x1.02p-24;
/// Part of the lines whose number of ends may differ from that by exact predicates, on meshes whose
/// coordinates are of like magnitude. Measured 0, on all meshes of tests/points/dexel_peeling_test.cpp and
/// balls, boxes and slivers on the lattice. What is allowed is for crossings at one depth near 0, where
/// float32 tells apart what rounding made of it.
inline constexpr double kPeelOtherPart = 1e-5;
/// Steps of the octahedral grid (packed_normal.h) between a normal and packNormal's of the same triangle: the
/// shader rounds once, from double, packNormal from float32.
inline constexpr int kPeelNormalSteps = 1;

/// Once, and back: the tri-dexel of a mesh.
struct PeeledModel {
  TriDexel model;
  OddLines odd;
};
[[nodiscard]] PeeledModel peel(const GlDexelContext& context, const TriangleMesh& mesh, const DexelGrid& grid,
                               const PeelOptions& options = {});

}  // namespace restroke::points
