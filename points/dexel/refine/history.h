#pragma once
// The operations that made a model, ready to be replayed on any lines (SPEC R2, R5, R6).

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "implicit/geometry/box.h"
#include "implicit/shapes/sphere.h"
#include "points/dexel/dexel_document.h"
#include "points/dexel/refine/zone.h"
#include "points/dexel/tool_solid.h"

namespace restroke::points {

/// One step of a replay: a solid is added, taken away, or kept.
struct HistoryStep {
  DexelOperation operation = DexelOperation::Union;
  OperationId id{};  ///< Initial for all steps of the initial solid
  /// Where not null, the solid is this ball.
  const implicit::Sphere* ball = nullptr;
  /// Else this.
  const ToolSolid* solid = nullptr;
};

/// The steps of a document: those of its initial solid, then its operations in order. Balls lie in one array,
/// 18 bytes each with what is done with them; other solids are made once. Refers to the document.
///
/// It is made when a model is opened, in O(operations), and serves every zoom from then on.
class DexelHistory {
 public:
  /// Throws InputError (which begins with "operation N: ") for what cannot be posed. The document must
  /// outlive it.
  explicit DexelHistory(const TriDexelDocument& document, const Execution& execution = {});
  ~DexelHistory();
  DexelHistory(DexelHistory&&) noexcept;
  DexelHistory& operator=(DexelHistory&&) noexcept;

  /// Ids there are: Initial and one for each operation.
  [[nodiscard]] std::size_t idCount() const;
  /// Appends the steps of an id: one, but of Initial as many as the initial solid has primitives (a mesh is
  /// one, nothing is none).
  void stepsOf(OperationId id, std::vector<HistoryStep>& steps) const;
  /// Holds all that the operation changes; everything for an intersection.
  [[nodiscard]] Box boundsOf(OperationId id) const;

  /// Those of all ids whose bounds meet the zone, ascending: by asking all of them. O(operations).
  [[nodiscard]] std::vector<OperationId> idsByBounds(const Zone& zone) const;
  /// The same by the clusters: a tree of the operations' boxes (box_tree.h) made once, unlike the grids of
  /// implicit/clusters.h, which can be changed, and answer with more than is asked here. O(operations found,
  /// and a few more for each of them, + operations / 64). The clusters are made at the first call, in O(n log
  /// n), or by makeClusters. Not to be called from two threads at once.
  [[nodiscard]] std::vector<OperationId> idsByClusters(const Zone& zone) const;
  void makeClusters() const;

  /// Bytes held, without the document and the clusters.
  [[nodiscard]] std::size_t bytes() const;
  /// Bytes of the clusters; 0 before they are made.
  [[nodiscard]] std::size_t clusterBytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace restroke::points
