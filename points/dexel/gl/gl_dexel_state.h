#pragma once
// What tri-dexels on the graphics card share. Internal to points/dexel/gl; no OpenGL header is included here.

#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "points/dexel/gl/gl_buffer.h"
#include "points/dexel/gl/gl_tri_dexel.h"
#include "points/images/egl_context.h"
#include "points/images/gl_program.h"

namespace restroke::points {

/// Rows of one family, with their spans: those of line i are the ends offsets[i] to offsets[i + 1] - 1.
struct GlBand {
  int axis = 0, row = 0, rows = 0, width = 0;
  GlBuffer offsets, ends;
  GlBuffer odd;             ///< a bit a line; of no bytes before the first peel
  std::size_t most = 0;     ///< not fewer ends than there are; 0 only where there are none for sure
  std::size_t longest = 0;  ///< not fewer than any line's ends
  [[nodiscard]] std::size_t lines() const {
    return static_cast<std::size_t>(rows) * static_cast<std::size_t>(width);
  }
};

/// What replays on lines need (gl_line_replay.cpp).
struct GlReplayParts;

class GlDexelContext::State {
 public:
  State();

  /// While it lives, the calling thread has the context for itself.
  class Use {
   public:
    explicit Use(State& state);

   private:
    std::lock_guard<std::mutex> lock_;
    EglContext::Current current_;
  };

  [[nodiscard]] const std::string& driver() const { return driver_; }
  [[nodiscard]] GlBuffer newBuffer(GlBuffer::Seen seen = GlBuffer::Seen::Whole) const {
    return GlBuffer(memory_, seen);
  }
  /// Pixels that a picture may have along a side.
  [[nodiscard]] int widest() const { return widest_; }

  /// Bytes of a buffer that a shader sees at once.
  [[nodiscard]] std::size_t largestBlock() const { return memory_->largestBlock(); }

  /// Runs the program on all lines, which it knows as lineCount.
  static void runOnLines(const GlProgram& program, std::size_t lines) { runOnItems(program, lines, lines); }
  /// The same with another number of work items.
  static void runOnItems(const GlProgram& program, std::size_t lines, std::size_t items);
  /// Runs a program that stops and goes on (PARTS) until each of its items has done so much work.
  void runInParts(const GlProgram& program, std::size_t lines, std::size_t work);
  /// The most ends that a line has. Waits for what was computed.
  [[nodiscard]] std::size_t longestOf(const GlBand& band);
  /// After a program that stored counts: what is before each group of lines.
  void scanGroups(std::size_t lines);
  /// Sum of the counts, after scanGroups.
  [[nodiscard]] std::size_t countedOf(std::size_t lines) const;

  struct Programs {
    GlProgram scanCounts, scanGroups, offsets;
    GlProgram combineCount, combineWrite;
    GlProgram pose, hull;
    GlProgram countFragments, gatherFragments, nearestDepth, nearestTriangle;
    GlProgram takeLayer, placeLayer, sort, pairCount, pairWrite;
  };
  [[nodiscard]] const Programs& programs() const { return programs_; }

  /// Those that few models need: made by the first who asks.
  struct LongLinePrograms {
    GlProgram longest, sortChunks, merge;
    GlProgram combineCount, combineWrite, pairCount, pairWrite;
  };
  [[nodiscard]] const LongLinePrograms& longLinePrograms();

  /// Places for what an operation makes; it changes places with what was there before.
  struct Scratch {
    GlBuffer offsets, ends, groupSums;
    GlBuffer posed, places;                                 // of the mesh that is drawn, seen in parts
    GlBuffer normals, counts, cursors, fragments, numbers;  // of the mesh; of the band that is drawn
    GlBuffer merged, states;                                // if it has long lines
    std::vector<GlBuffer> layers;
    unsigned framebuffer = 0, vertexArray = 0, elements = 0;
  };
  [[nodiscard]] Scratch& scratch() { return *scratch_; }
  /// Made by the first who asks.
  [[nodiscard]] GlReplayParts& replayParts();

 private:
  void makeDrawing();

  std::mutex mutex_;
  EglContext context_{GlVersion{.major = 4, .minor = 3}};
  std::shared_ptr<GlMemory> memory_;
  Programs programs_;
  std::unique_ptr<const LongLinePrograms> longLinePrograms_;
  std::unique_ptr<Scratch> scratch_;
  std::shared_ptr<GlReplayParts> replayParts_;
  std::string driver_;
  int widest_ = 0;
};

class GlMesh::Implementation {
 public:
  Implementation(std::shared_ptr<GlDexelContext::State> state, const TriangleMesh& mesh);
  [[nodiscard]] const std::shared_ptr<GlDexelContext::State>& state() const { return state_; }
  [[nodiscard]] std::size_t triangleCount() const { return triangleCount_; }
  [[nodiscard]] const GlBuffer& triangles() const { return triangles_; }
  [[nodiscard]] const Box& bounds() const { return bounds_; }

 private:
  std::shared_ptr<GlDexelContext::State> state_;
  std::size_t triangleCount_ = 0;
  GlBuffer triangles_;  // nine numbers each
  Box bounds_;
};

class GlTriDexel::Implementation {
 public:
  Implementation(std::shared_ptr<GlDexelContext::State> state, const DexelGrid& grid, Options options);
  [[nodiscard]] const DexelGrid& grid() const { return grid_; }
  void upload(const TriDexel& model);
  [[nodiscard]] TriDexel download() const;
  void apply(const Implementation& tool, DexelOperation operation, OperationId id);
  void peel(const GlMesh::Implementation& mesh, const PeelOptions& options);
  [[nodiscard]] OddLines oddLines() const;
  [[nodiscard]] std::size_t endCount() const;
  [[nodiscard]] std::size_t bytes() const;

 private:
  void clear(GlBand& band);

  std::shared_ptr<GlDexelContext::State> state_;
  DexelGrid grid_;
  bool operations_ = true;             // kept by the model that was uploaded
  std::vector<GlBand> bands_;          // by family and row
  std::vector<GlBuffer> coordinates_;  // of the grid's points, by axis
};

/// One mesh drawn into bands: gl_peeling.cpp.
class GlPeeler {
 public:
  /// Poses the mesh.
  GlPeeler(GlDexelContext::State& state, const GlMesh::Implementation& mesh, const PeelOptions& options);
  /// Box of the posed mesh, a little too large.
  [[nodiscard]] const Box& bounds() const { return bounds_; }
  /// Makes the polygons of a family.
  void startFamily(const DexelGrid& grid, int axis);
  /// The band's lines become those of the mesh. `columns` and `rows`: coordinates of the family's lines.
  void fill(GlBand& band, const GlBuffer& columns, const GlBuffer& rows);

 private:
  void draw(const GlProgram& program) const;
  void gatherFragments(const GlBand& band);
  void sortFragments(std::size_t lines);
  void peelLayers(const GlBand& band);
  void offsetsOfCounts(std::size_t lines);

  GlDexelContext::State& state_;
  std::size_t triangleCount_;
  PeelMethod method_;
  Box bounds_;
  const GlBand* band_ = nullptr;
  const GlBuffer *columns_ = nullptr, *rows_ = nullptr;
  std::size_t fragments_ = 0, longest_ = 0;  // of the band; not fewer than any line's
};

}  // namespace restroke::points
