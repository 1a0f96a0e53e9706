#include "implicit/near_balls.h"

#include <algorithm>

#include "implicit/shapes/sphere_samples.h"

namespace restroke::implicit {

DropBall dropBall(const Sphere& s) {
  const SphereTolerance t = toleranceOf(s);
  return {s.center.x, s.center.y, s.center.z, s.radius + t.slack, t.dropRadius * t.dropRadius};
}

void NearBalls::gather(const PrimitiveList& list, const DropBall& region, PrimitiveList::Label labelEnd,
                       PrimitiveList::Label own) {
  found_.clear();
  const Vec3 half(region.reach);
  const Point center(region.x, region.y, region.z);
  const std::span<const PrimitiveList::Label> labels = list.labels();
  std::size_t lists = 0;
  list.clusters().forListsIn({center - half, center + half}, [&](std::span<const std::uint32_t> slots) {
    ++lists;
    for (const std::uint32_t slot : slots) {
      const PrimitiveList::Label label = labels[slot];
      if (label >= labelEnd) break;  // lists are in list order
      const Sphere& s = list[PrimitiveId{slot}].shape;
      const Vec3 d = s.center - center;
      // 2^-16 is more than the slack and the rounding of this sum, relative to the radii (slack is at most 2^-3 of a radius).
      const float reach = (s.radius + region.reach) * 1.00002f + toleranceOf(s).slack;
      if (dot(d, d) <= reach * reach && label != own) found_.push_back({label, slot});
    }
  });
  if (lists > 1) {
    std::sort(found_.begin(), found_.end(), [](const Found& a, const Found& b) { return a.label < b.label; });
    found_.erase(std::unique(found_.begin(), found_.end(),
                             [](const Found& a, const Found& b) { return a.label == b.label; }),
                 found_.end());
  }
  const std::size_t n = found_.size();
  stride_ = (n + kPatch) / kPatch * kPatch;
  if (floats_.size() < 6 * stride_) floats_.resize(12 * stride_);
  if (positive_.size() < stride_) positive_.resize(2 * stride_);
  float* x = floats_.data();
  earlier_ = static_cast<std::uint32_t>(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Primitive& p = list[PrimitiveId{found_[i].slot}];
    const DropBall b = dropBall(p.shape);
    x[i] = b.x;
    x[stride_ + i] = b.y;
    x[2 * stride_ + i] = b.z;
    x[3 * stride_ + i] = b.reach;
    x[4 * stride_ + i] = p.shape.radius * p.shape.radius;
    x[5 * stride_ + i] = b.r2Drop;
    positive_[i] = p.sign == Sign::Positive;
    if (found_[i].label > own && earlier_ == n) earlier_ = static_cast<std::uint32_t>(i);
  }
  for (std::size_t i = n; i < stride_; ++i) {
    x[i] = kNowhere;
    for (std::size_t k = 1; k < 6; ++k) x[k * stride_ + i] = 0;
  }
}

BallArrays NearBalls::arrays() const {
  const float* x = floats_.data();
  return {x,
          x + stride_,
          x + 2 * stride_,
          x + 3 * stride_,
          x + 4 * stride_,
          x + 5 * stride_,
          positive_.data(),
          static_cast<std::uint32_t>(found_.size()),
          earlier_};
}

}  // namespace restroke::implicit
