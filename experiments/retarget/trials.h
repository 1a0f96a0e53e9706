#pragma once
// One change of one base: every method on every stroke, against the truth.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/retarget/drawing.h"
#include "implicit/geometry/similarity.h"
#include "retarget/alignment.h"
#include "retarget/surface_distance.h"

namespace restroke::experiments {

/// The methods to be tried. `depth` is left out, with a note, where no OpenGL context can be had or the
/// options say so.
[[nodiscard]] std::vector<retarget::Method> methodsToTry(const RetargetOptions& options,
                                                         std::vector<std::string>& notes);

/// What the alignment of two shapes gives the method `aligned`.
struct FoundMotion {
  std::string verdict;  ///< in the words of retarget/alignment.h
  std::optional<Similarity>
      motion;  ///< nothing: it is not to be used, and strokes are cast as `exact` casts them
};
/// Of whole shapes.
[[nodiscard]] FoundMotion alignedWhole(const points::SurfelModel& before, const points::SurfelModel& after,
                                       const retarget::AlignmentOptions& options);
/// Of the part of `before` around a stroke, in `after`.
struct PatchOf {
  const DrawnStroke& stroke;
  double radius;  ///< model units
};
[[nodiscard]] FoundMotion alignedPatch(const points::SurfelModel& before, const points::SurfelModel& after,
                                       const PatchOf& patch, const retarget::AlignmentOptions& options);

/// A changed base, ready to be cast on.
struct ChangedBase {
  const KnownChange* change = nullptr;
  const points::SurfelModel* model = nullptr;          ///< of the image
  const retarget::SurfaceDistance* surface = nullptr;  ///< of the same
  const FoundMotion* motion = nullptr;                 ///< for `aligned`
};

/// Casts strokes on one changed base. Casters that only look are kept while the camera stays the same:
/// drawing the depth buffer is what they cost.
class Follower {
 public:
  Follower(const ChangedBase& base, retarget::Method method, const Execution& execution);
  /// The caster for a stroke; valid until the next call.
  [[nodiscard]] retarget::Caster& casterFor(const DrawnStroke& stroke);
  /// The places of the original trail, cast anew.
  [[nodiscard]] retarget::Trail follow(const DrawnStroke& stroke);
  /// `aligned` has no motion to follow.
  [[nodiscard]] bool fellBack() const;

 private:
  class BaseOwner;
  ChangedBase base_;
  retarget::Method method_;
  Execution execution_;
  std::shared_ptr<const retarget::Owners> owners_;
  std::unique_ptr<retarget::Caster> caster_;
  std::optional<Camera> camera_;  // of the caster that is kept
};

/// The places of a trail, cast by another caster.
[[nodiscard]] retarget::Trail castAt(const retarget::Trail& original, retarget::Caster& caster);

/// Greatest and RMS distance of a trail's hits from the surface, model units; 0 without hits.
struct OffSurface {
  double greatest = 0, rms = 0;
};
[[nodiscard]] OffSurface offSurface(const retarget::Trail& trail, const retarget::SurfaceDistance& surface);

/// Compares with the truth, in the measures of retarget/measures.h.
[[nodiscard]] RetargetTrial measured(const DrawnStroke& stroke, const ChangedBase& base,
                                     const retarget::Trail& found, double baseSize);

}  // namespace restroke::experiments
