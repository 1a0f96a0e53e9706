#pragma once
// What a cutter leaves behind, or a nozzle lays down, on one element of its path (SPEC R8).

#include <memory>

#include "points/dexel/tool_solid.h"
#include "points/dexel/toolpath/cutter.h"

namespace restroke::points {

struct SweepOptions {
  /// How far straight parts may be from an arc that is made of them, in radii of the cutter; > 0. Arcs are
  /// followed exactly but for those listed at SweptCutter.
  double tolerance = 1e-4;
  /// All arcs are made of straight parts (to test them).
  bool onlyStraightParts = false;
};

/// The union of a cutter in all places along a path element. A tip that does not move leaves the cutter.
///
/// How exact it is:
///
///   straight moves      flat and ball: planes and quadrics, solved in closed form. Bull nose: the rounded
///                       edge by Newton's method on the distance to a moved disc, a point of which is itself
///                       found so. All are within 1e-9 of the sweep's size, but for lines that only graze it.
///   plane arcs about    all three: a ring's sector, discs, and rings of round section (a polynomial of
///   the cutter's axis   degree 4), to the same bound.
///   other plane arcs    ball: the ball's ring likewise where the cutter is at least two radii long; its
///                       shank, and flat and bull-nose cutters, by straight parts: within `tolerance` radii.
///   helices, and arcs   by straight parts: within `tolerance` radii.
///   of more than 1e5
///   cutter radii
///
/// Moves that are off a plane or an axis by less than 2^-40 of their size are straightened; gaps of less than
/// 1e-9 radii on a line are closed. Everything is computed in double, from + - * / and sqrt in a fixed order:
/// the same bits everywhere.
class SweptCutter final : public ToolSolid {
 public:
  /// Throws InputError as validate(cutter) and validate(element), when the tolerance is not > 0, when the
  /// sweep reaches beyond what float32 can hold, or an arc is too large for its tolerance (more than 2^18
  /// straight parts).
  SweptCutter(const Cutter& cutter, const PathElement& element, const SweepOptions& options = {});
  ~SweptCutter() override;

  /// A straight move: one span at most. An arc may have several.
  void intersect(const Ray& line, std::vector<SolidSpan>& spans) const override;
  /// Is the point in the cutter in any of its places? By the definition, with straight parts where these are
  /// used; on the boundary rounding decides.
  [[nodiscard]] bool contains(DVec3 p) const;

 private:
  struct Body;
  DVec3 origin_, axes_[3];
  std::unique_ptr<const Body> body_;
};

}  // namespace restroke::points
