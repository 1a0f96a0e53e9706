#pragma once

#include <cstdint>

#include "implicit/primitive.h"

namespace restroke::points {

/// A surface element: an oriented disc (SPEC S3).
struct Surfel {
  Point position{0};     ///< model units
  Vec3 normal{0, 0, 1};  ///< unit, out of the whole shape
  float radius =
      0;  ///< of the disc, model units; discs of neighbours overlap, so that the surface has no gaps
  std::uint32_t primitive = 0;                     ///< position in the list of the primitive that owns it
  implicit::Sign sign = implicit::Sign::Positive;  ///< the owner's: Negative is a carved surface
};

/// What changes the surfels, besides the list.
struct SamplingOptions {
  /// Samples per square model unit, finite and > 0. A primitive gets at least 16 samples.
  float density = 8000;
};

}  // namespace restroke::points
