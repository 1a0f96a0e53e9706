#pragma once
// What casting a stroke read of the shape, so that it is cast again only where that has changed (DESIGN
// invariant 6).

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "implicit/geometry/box.h"
#include "implicit/shapes/sphere.h"
#include "retarget/method.h"

namespace restroke::sculpt {

/// Primitives that came to the list or went, and a ball around all of them.
class ChangedPlaces {
 public:
  void add(const implicit::Sphere& ball);
  [[nodiscard]] bool empty() const { return balls_.empty(); }
  [[nodiscard]] std::span<const implicit::Sphere> balls() const { return balls_; }
  /// Holds all balls, not tightly.
  [[nodiscard]] const implicit::Sphere& around() const { return around_; }
  /// False only when none of the balls meets the box.
  [[nodiscard]] bool mayMeet(const Box& box) const;

 private:
  std::vector<implicit::Sphere> balls_;
  implicit::Sphere around_{};
};

/// One answer of a caster.
struct ReadCast {
  retarget::StrokePlace place;
  bool hit = false;
  bool holds = true;     ///< nothing that it read has changed
  Point end{0};          ///< of what was read: the hit, or the ray's end
  Vec3 normal{0, 0, 1};  ///< of the hit
  float scale = 1;       ///< of the hit
};

/// All casts of one stroke. 52 bytes each.
class StrokeReads {
 public:
  [[nodiscard]] static StrokeReads ofEverything();
  /// Anything of the shape may have been read.
  [[nodiscard]] bool everything() const { return everything_; }
  /// A box that holds all that was read; unbounded where that is everything, empty where it is nothing.
  [[nodiscard]] const Box& bounds() const { return bounds_; }
  /// Marks the casts that read where something has changed; false when there are none. O(balls) where the
  /// stroke is far from all of them, else O(casts * balls).
  [[nodiscard]] bool touchedBy(std::span<const ChangedPlaces> changes);
  [[nodiscard]] std::size_t bytes() const { return sizeof(*this) + casts_.capacity() * sizeof(ReadCast); }

 private:
  friend class ReadingCaster;
  void finish();

  bool everything_ = false;
  Box bounds_;
  DVec3 apex_{0};                 // where all rays begin
  DVec3 axis_{0, 0, 1};           // of a cone about all rays
  double cosine_ = 1, sine_ = 0;  // of the cone's half angle
  double reach_ = 0;              // from the apex to the farthest end
  std::vector<ReadCast> casts_;   // in order along the stroke; those that read nothing are left out
};

/// Answers as another caster does, or from former casts that still hold, and keeps what was read.
class ReadingCaster final : public retarget::Caster {
 public:
  /// `former`, which may be null, is what the same stroke read when it was cast on a shape that differs only
  /// where touchedBy was told. Both must outlive the caster.
  explicit ReadingCaster(retarget::Caster& caster, const StrokeReads* former = nullptr)
      : caster_(caster), former_(former) {}
  std::optional<retarget::SurfaceHit> cast(const retarget::StrokePlace& place) override;
  std::optional<Ray> readsAlong(const retarget::StrokePlace& place) const override {
    return caster_.readsAlong(place);
  }
  [[nodiscard]] StrokeReads take();
  /// How often the other caster was asked.
  [[nodiscard]] std::size_t castAnew() const { return castAnew_; }

 private:
  retarget::Caster& caster_;
  const StrokeReads* former_;
  StrokeReads reads_;
  std::size_t castAnew_ = 0;
};

}  // namespace restroke::sculpt
