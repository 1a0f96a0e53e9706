#pragma once
// The camera of a stroke whose method is `aligned`, moved along with the part that it was drawn on (SPEC
// S10).

#include <string>
#include <vector>

#include "sculpt/evaluation.h"

namespace restroke::sculpt {

/// The surfels around a stroke that is drawn now: what it is found by later. At most kPatchPoints.
[[nodiscard]] std::vector<retarget::OrientedPoint> patchBefore(const retarget::Trail& trail,
                                                               const Brush& brush, const StrokeSite& site);
inline constexpr std::size_t kPatchPoints = 600;

struct AlignedView {
  Camera camera;
  float scale = 1;   ///< how much bigger things are than where the stroke was drawn
  std::string note;  ///< one sentence where no motion was found, and the stroke's own camera is taken
};

struct BaseSource {
  const History& history;
  const BaseChains& bases;
};

/// Where the base has become another one: the motion of the whole base. Else, and where the base's motion is
/// not to be found: that of the patch around the stroke, on the shape before it. Depends on a numerical
/// solver, and is therefore recorded.
[[nodiscard]] AlignedView alignedView(const Original& original, const StrokeCommand& stroke,
                                      const StrokeSite& site, const BaseSource& bases);

}  // namespace restroke::sculpt
