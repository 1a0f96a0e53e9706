#include "implicit/near_balls.h"

#include <algorithm>

#include "implicit/shapes/sphere_samples.h"

namespace restroke::implicit {

DropBall dropBall(const Shape& shape) {
  const Sphere& s = shape.ball();
  if (const PosedVolume* volume = shape.volume())
    return {s.center.x, s.center.y, s.center.z, s.radius + volume->slack(), 0, &volume->gridded()};
  const SphereTolerance t = toleranceOf(s);
  return {s.center.x, s.center.y, s.center.z, s.radius + t.slack, t.dropRadius * t.dropRadius, nullptr};
}

void NearBalls::gather(const PrimitiveList& list, const DropBall& region, PrimitiveList::Label labelEnd,
                       PrimitiveList::Label own) {
  found_.clear();
  if (seen_.size() < list.slotCount()) seen_.resize(list.slotCount() + list.slotCount() / 2, 0);
  if (++round_ == 0) {
    std::fill(seen_.begin(), seen_.end(), 0);
    round_ = 1;
  }
  const Vec3 half(region.reach);
  const Point center(region.x, region.y, region.z);
  const std::span<const PrimitiveList::Label> labels = list.labels();
  const std::span<const PrimitiveList::Ball> balls = list.balls();
  std::size_t lists = 0;
  list.clusters().forListsIn({center - half, center + half}, [&](std::span<const std::uint32_t> slots) {
    ++lists;
    for (const std::uint32_t slot : slots) {
      if (seen_[slot] == round_) continue;
      seen_[slot] = round_;
      const PrimitiveList::Ball& b = balls[slot];
      const float dx = b.x - region.x, dy = b.y - region.y, dz = b.z - region.z;
      const float reach = (b.reach + region.reach) * 1.00001f;  // more than the rounding of the sums
      if (dx * dx + dy * dy + dz * dz > reach * reach) continue;
      const PrimitiveList::Label label = labels[slot];
      if (label >= labelEnd) break;  // lists are in list order
      if (label != own) found_.push_back({label, slot});
    }
  });
  if (lists > 1)
    std::sort(found_.begin(), found_.end(), [](const Found& a, const Found& b) { return a.label < b.label; });
  const std::size_t n = found_.size();
  stride_ = (n + kPatch) / kPatch * kPatch;
  if (floats_.size() < 6 * stride_) floats_.resize(12 * stride_);
  if (positive_.size() < stride_) {
    positive_.resize(2 * stride_);
    volumes_.resize(2 * stride_);
  }
  float* x = floats_.data();
  earlier_ = static_cast<std::uint32_t>(n);
  anyVolume_ = false;
  for (std::size_t i = 0; i < n; ++i) {
    const Primitive& p = list[PrimitiveId{found_[i].slot}];
    const DropBall b = dropBall(p.shape);
    x[i] = b.x;
    x[stride_ + i] = b.y;
    x[2 * stride_ + i] = b.z;
    x[3 * stride_ + i] = b.reach;
    x[4 * stride_ + i] = p.shape.ball().radius * p.shape.ball().radius;
    x[5 * stride_ + i] = b.r2Drop;
    volumes_[i] = b.volume;
    anyVolume_ = anyVolume_ || b.volume;
    positive_[i] = p.sign == Sign::Positive;
    if (found_[i].label > own && earlier_ == n) earlier_ = static_cast<std::uint32_t>(i);
  }
  for (std::size_t i = n; i < stride_; ++i) {
    x[i] = kNowhere;
    for (std::size_t k = 1; k < 6; ++k) x[k * stride_ + i] = 0;
  }
}

std::size_t NearBalls::bytes() const {
  return found_.capacity() * sizeof(Found) + seen_.capacity() * sizeof(std::uint32_t) +
         floats_.capacity() * sizeof(float) + positive_.capacity() +
         volumes_.capacity() * sizeof(const GriddedVolume*);
}

BallArrays NearBalls::arrays() const {
  const float* x = floats_.data();
  return {x,
          x + stride_,
          x + 2 * stride_,
          x + 3 * stride_,
          x + 4 * stride_,
          x + 5 * stride_,
          volumes_.data(),
          anyVolume_,
          positive_.data(),
          static_cast<std::uint32_t>(found_.size()),
          earlier_};
}

}  // namespace restroke::implicit
