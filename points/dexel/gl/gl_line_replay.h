#pragma once
// Operations replayed on lines by the graphics card (SPEC R6), one work item a line.

#include <cstddef>
#include <span>

#include "points/dexel/gl/gl_tri_dexel.h"
#include "points/dexel/refine/line_replay.h"

namespace restroke::points {

/// A LineReplayer in OpenGL: what `replay` (line_replay.h) gives, bit for bit, owners and normals included,
/// where the driver's double + - * / and sqrt are those of IEEE 754, as they are on Mesa's software driver.
/// (GLSL itself promises less.) On another driver what depends on the last bit of a double may
/// differ: a depth by one step of float32, or by what a grazing ball makes of it, a normal by one step of
/// packed_normal.h. Where a driver takes denormal float32 numbers for zero, depths below 1.2e-38 are 0.
///
/// Balls are met with lines by the card. Of all other solids (posed volumes, meshes, swept cutters), and
/// what an intersection leaves of any solid, the stretches are found by the CPU, in parallel, for lines that
/// are still undecided, and handed to the card a few for each line at a time; their normals are found by the
/// CPU for the ends that they have made. What is known before (ReplayBasis) is found by the CPU too.
///
/// The work is cut into parts that the driver's limits allow. What 8 x 8 neighbouring lines meet must fit
/// into one buffer, 16 bytes a step (128 MiB on Mesa's software driver, 16 MiB on any): InputError. Lines of
/// more than 2,048 pieces, or that start from more than 1,024 ends, are replayed by the CPU.
class GlLineReplay {
 public:
  /// No result depends on them.
  struct Options {
    std::size_t room = 32;  ///< pieces that a line has memory for at first, > 0; lines with more are redone
    std::size_t lines = std::size_t{1} << 17;  ///< worked on at a time, > 0
    std::size_t pairs = std::size_t{1} << 24;  ///< of steps and tiles of 8 x 8 lines, at a time
    std::size_t solids = 4;                    ///< that are no balls: of each tile at a time, > 0
  };
  GlLineReplay(const GlDexelContext& context, const Options& options)
      : context_(context), options_(options) {}
  explicit GlLineReplay(const GlDexelContext& context) : GlLineReplay(context, Options{}) {}

  /// Throws InputError when the driver has not enough memory. From any thread; calls in one context wait for
  /// each other.
  [[nodiscard]] Dexels operator()(const ReplayInput& input, const LinesInZone& lines,
                                  const Execution& execution = {}) const;

 private:
  GlDexelContext context_;
  Options options_;
};

}  // namespace restroke::points
