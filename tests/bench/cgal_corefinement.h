#pragma once
// A rival: Booleans of triangle meshes by CGAL's corefinement. That package is under the GPL and takes half a
// minute and up to 2 GB to compile: one source, in tests/bench only.

#include <cstddef>
#include <span>
#include <vector>

#include "implicit/primitive.h"

namespace restroke::bench {

struct CorefinementResult {
  std::vector<double> stampMicroseconds;  ///< of the stamps that succeeded, in order
  double seconds = 0;                     ///< of the Booleans, the base and the balls' meshes included
  std::size_t stamps = 0;                 ///< that were tried
  std::size_t skipped = 0;           ///< of these: refused, by self-intersection or a result without volume
  std::size_t faces = 0, bytes = 0;  ///< of the final mesh; bytes of its vertices, half-edges and faces
  bool closed = false;               ///< the final mesh has no border
};

/// What is tried: all of the list, unless the time runs out.
struct CorefinementOptions {
  double density = 14000;  ///< vertices per square model unit, to the nearest power of 4
  double seconds = 15;     ///< no stamp begins after that
};

/// The first primitive is the base; of what is no sphere, the ball around it is taken.
[[nodiscard]] CorefinementResult replayWithCorefinement(std::span<const implicit::Primitive> list,
                                                        const CorefinementOptions& options);

}  // namespace restroke::bench
