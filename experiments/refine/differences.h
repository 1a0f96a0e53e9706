#pragma once
// How far a refined model is from another on the same lines: what refinement has lost.

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "points/dexel/refine/refine.h"
#include "points/surfel.h"
#include "retarget/methods/nearest_surfels.h"

namespace restroke::experiments {

/// A stretch of a line that is inside by one of two models only.
struct WrongStretch {
  float from = 0, to = 0;  ///< depths, from < to
  bool extra = false;      ///< by the model that is judged; else by the reference, and missing
  bool operator==(const WrongStretch&) const = default;
};
/// `stretches` becomes those of a line, ascending; two that meet are of different kinds. O(ends).
void findWrongStretches(std::span<const points::SpanEnd> reference, std::span<const points::SpanEnd> judged,
                        std::vector<WrongStretch>& stretches);

/// An operation that the reference's ends show.
struct VisibleOperation {
  points::OperationId id{};
  std::size_t trims = 0;  ///< ends that it made: of the two at an end it is the later one
  std::size_t sides = 0;  ///< ends at which it is on either side
};

/// What all methods are compared with: the ends of the whole history on the new lines. The initial solid is
/// no operation, and ends at the zone's border, where the solid goes on, are none that an operation made.
class Reference {
 public:
  explicit Reference(points::RefinedModel model);

  [[nodiscard]] const points::RefinedModel& model() const { return model_; }
  /// Inside the solid, all families together, in lengths of the lines.
  [[nodiscard]] double length() const { return length_; }
  /// Ascending by id.
  [[nodiscard]] const std::vector<VisibleOperation>& visible() const { return visible_; }
  /// Ends within the zone.
  [[nodiscard]] std::size_t ends() const { return surface_->surfels().size(); }
  /// Those ends, by line.
  [[nodiscard]] const retarget::NearestSurfels& surface() const { return *surface_; }

 private:
  points::RefinedModel model_;
  double length_ = 0;
  std::vector<VisibleOperation> visible_;
  std::unique_ptr<const retarget::NearestSurfels> surface_;
};

struct Recall {
  std::size_t trimming = 0, trimmingMissed = 0;  ///< operations that made an end; those not collected
  std::size_t sides = 0, sidesMissed = 0;        ///< the same of operations on either side of an end
  std::size_t endsMissed = 0;                    ///< ends that were made by what was not collected
};
/// `ids`: those collected, ascending.
[[nodiscard]] Recall recallOf(const Reference& reference, std::span<const points::OperationId> ids);

struct Differences {
  double missing = 0, extra = 0;  ///< lengths of wrong stretches, all families together
  /// Greatest distance from an end of the reference within the zone to the nearest one of the judged model,
  /// and the other way round, model units. Ends are the surface where lines are: differences of the order of
  /// the lines' spacing are between neighbours. Nothing where one of the two has no end.
  std::optional<double> toJudged, toReference;
  bool identical = false;  ///< all lines bit for bit, normals and references too
};
/// The models must have the same lines.
[[nodiscard]] Differences differencesOf(const Reference& reference, const points::RefinedModel& judged,
                                        const Execution& execution = {});

/// How an end is drawn.
enum class EndKind : std::uint8_t {
  Right,    ///< both models have it, or it is at the zone's border
  Extra,    ///< at a stretch that is too much
  Missing,  ///< at one that is missing, and may be the reference's
};
struct MarkedEnd {
  points::Surfel surfel;  ///< a disc that covers a cell
  EndKind kind = EndKind::Right;
};
/// The judged model's ends, and the reference's at missing stretches: what should stand there. Of three
/// families those that see the surface well.
[[nodiscard]] std::vector<MarkedEnd> markedEnds(const Reference& reference,
                                                const points::RefinedModel& judged);

}  // namespace restroke::experiments
