#pragma once
// Coordinates on the surface that a stroke was drawn on (R. Schmidt and K. Singh, "Sketch-based procedural
// surface modeling and compositing using surface trees", 2008): which primitive a place lies on, where on it,
// and how far off, to be evaluated again on what has become of that primitive.

#include <functional>
#include <memory>
#include <optional>

#include "implicit/primitive_list.h"
#include "retarget/trail.h"

namespace restroke::retarget {

/// Notes for every hit of the trail whose primitive it is. `list` is the one that the trail was cast on,
/// `ownerOf` says where its primitives come from. Misses, and hits of methods that do not know the primitive,
/// get no anchor. O(points).
void setAnchors(Trail& trail, const implicit::PrimitiveList& list,
                const std::function<OwnerKey(implicit::PrimitiveId)>& ownerOf);

/// Takes places on a shape to the places with the same coordinates on another one. Shapes correspond where
/// - both are of one kind, and every parameter has as many values in both; or both are balls or ellipsoids:
///   coordinates are those of the own frame, in parts of the volume's extent along each axis. Where the
///   parameters differ and neither is a ball or an ellipsoid, the place is then moved onto the present
///   boundary, along its normal;
/// - both are meshes with the same triangles and vertices that may have moved: coordinates are the nearest
///   triangle (of equally near ones the lowest), the place's barycentric coordinates on it, and the distance
///   from it.
/// Everything in double, from + - * / and sqrt: the same bits everywhere.
class SurfaceCoordinates {
 public:
  virtual ~SurfaceCoordinates() = default;

  /// Null when the shapes do not correspond. O(1); meshes O(triangles log triangles). Keeps copies of the
  /// shapes.
  [[nodiscard]] static std::unique_ptr<const SurfaceCoordinates> between(const implicit::Shape& former,
                                                                         const implicit::Shape& present);

  /// Where a hit on the former shape is now, with the normal on the side where it was, and `scale` how much
  /// lengths have grown: the ratio of the shapes' scales; where their proportions changed too, with the cube
  /// root of how their extents' product changed; of meshes, with the square root of how the triangle's area
  /// changed. Nothing where the place has no counterpart (no boundary along its normal, a triangle without
  /// area).
  [[nodiscard]] virtual std::optional<SurfaceHit> carry(const SurfaceHit& hit) const = 0;
};

}  // namespace restroke::retarget
