#pragma once
// A volume placed in the model (SPEC S13): turned, scaled, moved.

#include <array>
#include <memory>
#include <vector>

#include "implicit/shapes/sphere.h"
#include "implicit/simd/ball_kernels.h"
#include "implicit/volume.h"

namespace restroke::implicit {

/// A point x of the volume's frame stands at position + scale * (x turned by `rotation`).
struct Pose {
  Point position{0};
  std::array<float, 4> rotation{0, 0, 0, 1};  ///< quaternion x, y, z, w of any length but 0
  float scale = 1;                            ///< > 0
  bool operator==(const Pose&) const = default;
};

/// The rotation that takes z to `axis` and x as near to `along` as that leaves. Neither is 0; where they are
/// parallel, any turn about the axis. Computed with + - * / and sqrt only.
[[nodiscard]] std::array<float, 4> rotationTo(DVec3 axis, DVec3 along);

/// Immutable; shared by the primitives that are it.
class PosedVolume : private GriddedVolume {
 public:
  /// Throws InputError when the pose is not finite, not a similarity, reaches beyond kMaxCoordinate, or makes
  /// the volume so thin or so far away that float32 cannot tell its sides apart (thickness under 2^-14 of its
  /// greatest coordinate).
  PosedVolume(std::shared_ptr<const Volume> volume, const Pose& pose);

  [[nodiscard]] const Volume& volume() const { return *volume_; }
  [[nodiscard]] const std::shared_ptr<const Volume>& sharedVolume() const { return volume_; }
  [[nodiscard]] const Pose& pose() const { return pose_; }
  /// A ball that holds it.
  [[nodiscard]] const Sphere& ball() const { return ball_; }
  /// A box that holds it, tight but for rounding.
  [[nodiscard]] const Box& bounds() const { return bounds_; }

  /// In it or on its boundary.
  [[nodiscard]] bool contains(Point p) const { return volume_->contains(toLocal(DVec3(p)), 0); }
  /// True also where rounding may have moved a point of its boundary (SPEC S3: such older samples are
  /// dropped).
  [[nodiscard]] bool drops(Point p) const { return volume_->contains(toLocal(DVec3(p)), dropDilation_); }
  [[nodiscard]] DVec3 outwardNormal(DVec3 p) const { return turned(volume_->outwardNormal(toLocal(p))); }
  /// Appends where the ray's whole line is inside.
  void intersect(const Ray& ray, std::vector<RayInterval>& intervals) const;
  [[nodiscard]] std::uint32_t containsLanes(const PointGroup& group, bool dropping) const;
  friend std::uint32_t lanesInVolume(const GriddedVolume& volume, const PointGroup& group, bool dropping);

  [[nodiscard]] DVec3 toLocal(DVec3 p) const {
    const DVec3 d = p - position_;
    return {(m_[0] * d.x + m_[3] * d.y + m_[6] * d.z) * inverseScale_,
            (m_[1] * d.x + m_[4] * d.y + m_[7] * d.z) * inverseScale_,
            (m_[2] * d.x + m_[5] * d.y + m_[8] * d.z) * inverseScale_};
  }
  [[nodiscard]] DVec3 toModel(DVec3 p) const { return position_ + scale_ * turned(p); }

  // The rounding that float32 leaves, as for spheres (SphereTolerance): m is the greatest coordinate, in the
  // model or in the volume's own frame.
  [[nodiscard]] float keepOffset() const { return keepOffset_; }  ///< 2^-18 m
  [[nodiscard]] float slack() const { return slack_; }            ///< 2^-17 m
  /// As the kernels look points up.
  [[nodiscard]] const GriddedVolume& gridded() const { return *this; }
  /// As the kernels turn samples.
  [[nodiscard]] const Rotations& rotations() const { return rotations_; }

  /// Volumes with equal parameters, equally posed.
  bool operator==(const PosedVolume& other) const;
  [[nodiscard]] std::size_t bytes() const {
    return sizeof(*this);
  }  ///< without the volume, which may be shared

 private:
  [[nodiscard]] DVec3 turned(DVec3 v) const {
    return {m_[0] * v.x + m_[1] * v.y + m_[2] * v.z, m_[3] * v.x + m_[4] * v.y + m_[5] * v.z,
            m_[6] * v.x + m_[7] * v.y + m_[8] * v.z};
  }

  void placeGrid();

  std::shared_ptr<const Volume> volume_;
  Pose pose_;
  double m_[9];  // rotation, rows first
  DVec3 position_{0};
  double scale_ = 1, inverseScale_ = 1;
  double dropDilation_ = 0;  // in the volume's frame: 2^-19 m
  float keepOffset_ = 0, slack_ = 0;
  Rotations rotations_{};
  Sphere ball_;
  Box bounds_;
};

}  // namespace restroke::implicit
