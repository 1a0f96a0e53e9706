#pragma once
// Maps of space that are not affine, with known derivatives: bend, twist, bulge, and maps one after another
// (SPEC X2). For measurements, where the truth of a stroke on a deformed shape must be known.
//
// Bend and twist after Barr, "Global and local deformations of solid primitives", SIGGRAPH 1984, sections 2.2
// and 2.3, without his clamping (which is not smooth): they act on all of space.

#include <memory>
#include <vector>

#include "implicit/geometry/space_map.h"

namespace restroke {

/// A map whose derivative is known everywhere; normals and scale follow from it.
class SmoothMap : public SpaceMap {
 public:
  /// The derivative at p: the affine map that agrees with this one there to first order, its offset left out.
  [[nodiscard]] virtual Affine tangentAt(DVec3 p) const = 0;
  [[nodiscard]] DVec3 normal(DVec3 p, DVec3 n) const override { return tangentAt(p).normal(n); }
  [[nodiscard]] double scaleAt(DVec3 p) const override { return AffineMap(tangentAt(p)).scaleAt(p); }
};

/// Where a bend or a twist acts. The axes are unit vectors at right angles to each other, right-handed.
struct DeformationFrame {
  DVec3 origin{0};  ///< model units; stays where it is
  std::array<DVec3, 3> axes{DVec3(1, 0, 0), {0, 1, 0}, {0, 0, 1}};
  [[nodiscard]] DVec3 toLocal(DVec3 p) const {
    const DVec3 d = p - origin;
    return {dot(d, axes[0]), dot(d, axes[1]), dot(d, axes[2])};
  }
  [[nodiscard]] DVec3 turnedBack(DVec3 local) const {
    return local.x * axes[0] + local.y * axes[1] + local.z * axes[2];
  }
  [[nodiscard]] DVec3 toModel(DVec3 local) const { return origin + turnedBack(local); }
};

/// Bends the frame's third axis towards its first: the axis becomes a circle of the given curvature and keeps
/// its lengths. One to one where curvature * x < 1 and |curvature * z| < pi, x and z being coordinates in the
/// frame: beyond that, space is folded.
class BendMap final : public SmoothMap {
 public:
  /// Curvature in 1 / model unit, finite; 0 changes nothing.
  BendMap(const DeformationFrame& frame, double curvature) : frame_(frame), curvature_(curvature) {}
  [[nodiscard]] DVec3 point(DVec3 p) const override;
  [[nodiscard]] Affine tangentAt(DVec3 p) const override;

 private:
  DeformationFrame frame_;
  double curvature_;
};

/// Turns every slice across the frame's third axis about that axis, by `rate` radians for each model unit
/// along it. One to one; keeps volumes.
class TwistMap final : public SmoothMap {
 public:
  TwistMap(const DeformationFrame& frame, double rate) : frame_(frame), rate_(rate) {}
  [[nodiscard]] DVec3 point(DVec3 p) const override;
  [[nodiscard]] Affine tangentAt(DVec3 p) const override;

 private:
  DeformationFrame frame_;
  double rate_;
};

/// Moves what lies in a ball away from its centre (or, with a negative amplitude, towards it): d becomes
/// d * (1 + amplitude * (1 - |d|^2 / radius^2)^3). Outside the ball nothing moves, bit for bit. Twice
/// continuously differentiable; one to one.
class BulgeMap final : public SmoothMap {
 public:
  /// Throws InputError unless the radius is > 0 and the amplitude within -0.9 to 1.5.
  BulgeMap(DVec3 center, double radius, double amplitude);
  [[nodiscard]] DVec3 point(DVec3 p) const override;
  [[nodiscard]] Affine tangentAt(DVec3 p) const override;

 private:
  DVec3 center_;
  double radius_, amplitude_;
};

/// Maps one after another, the first of them first.
class ComposedMap final : public SmoothMap {
 public:
  explicit ComposedMap(std::vector<std::shared_ptr<const SmoothMap>> maps) : maps_(std::move(maps)) {}
  [[nodiscard]] DVec3 point(DVec3 p) const override;
  [[nodiscard]] Affine tangentAt(DVec3 p) const override;

 private:
  std::vector<std::shared_ptr<const SmoothMap>> maps_;
};

/// An affine map among smooth ones: for ComposedMap. (AffineMap tells methods that it is affine; this does
/// not.)
class AffineStep final : public SmoothMap {
 public:
  explicit AffineStep(const Affine& affine) : affine_(affine) {}
  [[nodiscard]] DVec3 point(DVec3 p) const override { return affine_.point(p); }
  [[nodiscard]] Affine tangentAt(DVec3) const override { return {affine_.matrix, DVec3(0)}; }

 private:
  Affine affine_;
};

}  // namespace restroke
