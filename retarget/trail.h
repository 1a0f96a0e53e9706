#pragma once
// The output stroke (SPEC S7, steps 3 to 5): where a stroke met the surface, in object and screen space.

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "implicit/primitive.h"
#include "retarget/method.h"

namespace restroke::retarget {

/// A primitive by where it comes from, which stays the same when the list is made anew: the history node that
/// made it (0: the base) and which of the node's primitives it is, counted from 0.
struct OwnerKey {
  std::uint32_t node = 0;
  std::uint32_t index = 0;
  bool operator==(const OwnerKey&) const = default;
};

/// The primitive that a hit lies on, as it was when the stroke was first applied. With the hit it gives the
/// coordinates on that primitive, also between two points of a trail (retarget/anchors.h).
struct Anchor {
  OwnerKey owner;
  implicit::Shape shape;
  bool operator==(const Anchor&) const = default;
};

struct TrailPoint {
  StrokePlace place;
  std::optional<SurfaceHit> hit;  ///< nothing: the stroke misses there
  /// Kept for the method `surface` only.
  std::optional<Anchor> anchor = {};
};

/// Places in order along the stroke, no two at the same `along`. Input points are at whole numbers, but where
/// a pen rested only the first of equal neighbours may be there.
struct Trail {
  std::vector<TrailPoint> points;

  /// The trail at a place: a point of it, or between two hits their mean, weighted by nearness along the
  /// stroke (normals of unit length; primitive and anchor those of the nearer). Nothing where one of the two
  /// misses, or beyond the ends. O(log points).
  [[nodiscard]] std::optional<TrailPoint> at(double along) const;
};

/// The trail with its hits carried by a map of space, normals of unit length. Who owns a hit is kept.
[[nodiscard]] Trail mapped(const Trail& trail, const SpaceMap& map);

/// Answers as another caster does, and keeps what was asked and answered.
class TrailRecorder final : public Caster {
 public:
  explicit TrailRecorder(Caster& caster) : caster_(caster) {}
  std::optional<SurfaceHit> cast(const StrokePlace& place) override;
  std::optional<Ray> readsAlong(const StrokePlace& place) const override { return caster_.readsAlong(place); }
  /// In order along the stroke, each place once.
  [[nodiscard]] Trail take();

 private:
  Caster& caster_;
  std::map<double, TrailPoint> points_;  // by place
};

/// Where primitives are now.
class Owners {
 public:
  virtual ~Owners() = default;
  /// Nothing when the node is not part of the shape any more, or makes fewer primitives than it did.
  [[nodiscard]] virtual std::optional<implicit::Primitive> find(OwnerKey owner) const = 0;
};

/// Answers from an original trail that something carries along: `carry` says where a point of it is now. The
/// base of `fixed`, `nearest`, `surface`, and of `mapped` where the map is not affine.
class TrailCaster : public Caster {
 public:
  explicit TrailCaster(const Trail& original) : original_(original) {}
  std::optional<SurfaceHit> cast(const StrokePlace& place) final;

 protected:
  /// `point` is a hit.
  [[nodiscard]] virtual std::optional<SurfaceHit> carry(const TrailPoint& point) const = 0;

 private:
  const Trail& original_;
};

}  // namespace restroke::retarget
