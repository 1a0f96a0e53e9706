#include "implicit/near_balls.h"

#include <algorithm>
#include <cstddef>

#include "implicit/shapes/sphere_samples.h"

namespace restroke::implicit {

DropBall dropBall(const Shape& shape) {
  const Sphere& s = shape.ball();
  if (const PosedVolume* volume = shape.volume())
    return {s.center.x, s.center.y, s.center.z, s.radius + volume->slack(), 0, &volume->gridded()};
  const SphereTolerance t = toleranceOf(s);
  return {s.center.x, s.center.y, s.center.z, s.radius + t.slack, t.dropRadius * t.dropRadius, nullptr};
}

// Open addressing with linear probing; at most half full.
bool NearBalls::isNew(std::uint32_t slot) {
  if (2 * (found_.size() + 1) > seen_.size()) growSeen();
  const std::uint64_t key = round_ << 32 | slot;
  const std::size_t mask = seen_.size() - 1;
  for (std::size_t i = (slot * 0x9E3779B1u >> 7) & mask;; i = (i + 1) & mask) {
    if (seen_[i] == key) return false;
    if (seen_[i] >> 32 == round_) continue;
    seen_[i] = key;
    return true;
  }
}

void NearBalls::growSeen() {
  seen_.assign(4 * seen_.size(), 0);
  const std::size_t mask = seen_.size() - 1;
  for (const Found& f : found_) {
    std::size_t i = (f.slot * 0x9E3779B1u >> 7) & mask;
    while (seen_[i] != 0) i = (i + 1) & mask;
    seen_[i] = round_ << 32 | f.slot;
  }
}

void NearBalls::gather(const PrimitiveList& list, const DropBall& region, PrimitiveList::Label labelEnd,
                       const Place& own) {
  shared_ = false;
  collect(list, region, labelEnd, own.slot);
  fill(list);
  splitAt(own);
}

void NearBalls::gatherShared(const PrimitiveList& list, const DropBall& region, PrimitiveList::Label labelEnd,
                             const Place& own) {
  // So many that to gather them costs more than to test, for each patch, those that are only near its
  // neighbours.
  constexpr std::size_t kMany = 192;
  const auto distance = [&] {
    return length(Vec3(region.x - sharedRegion_.x, region.y - sharedRegion_.y, region.z - sharedRegion_.z));
  };
  if (!shared_ || !((distance() + region.reach) * 1.00001f <= sharedRegion_.reach)) {
    gather(list, region, labelEnd, own);
    if (found_.size() < kMany) return;
    sharedRegion_ = region;
    sharedRegion_.reach *= 1.75f;
    collect(list, sharedRegion_, labelEnd, ~0u);
    fill(list);
    shared_ = true;
  }
  splitAt(own);
}

void NearBalls::collect(const PrimitiveList& list, const DropBall& region, PrimitiveList::Label labelEnd,
                        std::uint32_t except) {
  found_.clear();
  round_ = (round_ + 1) & 0xFFFFFFFF;
  if (round_ == 0) {
    std::fill(seen_.begin(), seen_.end(), 0);
    round_ = 1;
  }
  const Vec3 half(region.reach);
  const Point center(region.x, region.y, region.z);
  const std::span<const PrimitiveList::Label> labels = list.labels();
  static_assert(sizeof(PackedBall) == sizeof(Sphere) &&
                offsetof(Sphere, radius) == offsetof(PackedBall, radius));
  const auto* balls = reinterpret_cast<const PackedBall*>(list.balls().data());
  const BallKernels& kernels = ballKernels();
  // Of spheres the tests reach a little beyond the ball: by 2^-17 of the greatest coordinate, which is at
  // most the region's and the distance between the two. What is added to the reach covers the first, the
  // factor in the kernel the second.
  const float far = std::fmax(std::fmax(std::fabs(region.x), std::fabs(region.y)), std::fabs(region.z));
  DropBall wide = region;
  wide.reach += far * 0x1p-16f;
  std::size_t lists = 0;
  const bool wholeList = labelEnd == std::numeric_limits<PrimitiveList::Label>::max();
  const auto wanted = wholeList ? Clusters::Wanted::Decisive : Clusters::Wanted::All;
  list.clusters().forListsIn(
      {center - half, center + half}, wanted, [&](std::span<const std::uint32_t> slots) {
        if (labels[slots.back()] >= labelEnd)
          slots = slots.first(static_cast<std::size_t>(
              std::partition_point(slots.begin(), slots.end(),
                                   [&](std::uint32_t slot) { return labels[slot] < labelEnd; }) -
              slots.begin()));
        if (meeting_.size() < slots.size()) meeting_.resize(2 * slots.size());
        const std::size_t met = kernels.meetingSlots(balls, slots, wide, meeting_.data());
        const std::size_t before = found_.size();
        for (std::size_t i = 0; i < met; ++i)
          if (meeting_[i] != except && isNew(meeting_[i]))
            found_.push_back({labels[meeting_[i]], meeting_[i]});
        lists += found_.size() > before;
      });
  if (lists > 1)
    std::sort(found_.begin(), found_.end(), [](const Found& a, const Found& b) { return a.label < b.label; });
}

void NearBalls::splitAt(const Place& own) {
  const auto later =
      std::partition_point(found_.begin(), found_.end(), [&](const Found& f) { return f.label < own.label; });
  earlier_ = static_cast<std::uint32_t>(later - found_.begin());
  later_ = earlier_ + (later != found_.end() && later->slot == own.slot);
}

void NearBalls::fill(const PrimitiveList& list) {
  const std::size_t n = found_.size();
  stride_ = (n + kPatch) / kPatch * kPatch;
  if (floats_.size() < 6 * stride_) floats_.resize(12 * stride_);
  if (positive_.size() < stride_) {
    positive_.resize(2 * stride_);
    volumes_.resize(2 * stride_);
  }
  const std::span<const Sphere> balls = list.balls();
  float* const x = floats_.data();
  float *const y = x + stride_, *const z = y + stride_, *const reach = z + stride_,
               *const r2 = reach + stride_, *const r2Drop = r2 + stride_;
  anyVolume_ = false;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t slot = found_[i].slot;
    const Sphere& s = balls[slot];
    const SphereTolerance t = toleranceOf(s);
    x[i] = s.center.x;
    y[i] = s.center.y;
    z[i] = s.center.z;
    reach[i] = s.radius + t.slack;
    r2[i] = s.radius * s.radius;
    r2Drop[i] = t.dropRadius * t.dropRadius;
    positive_[i] = list.isPositive(slot);
    const PosedVolume* volume = list.volumeIn(slot);
    volumes_[i] = volume ? &volume->gridded() : nullptr;
    anyVolume_ = anyVolume_ || volume;
  }
  for (std::size_t i = n; i < stride_; ++i) {
    x[i] = kNowhere;
    for (std::size_t k = 1; k < 6; ++k) x[k * stride_ + i] = 0;
  }
}

std::size_t NearBalls::bytes() const {
  return found_.capacity() * sizeof(Found) + meeting_.capacity() * sizeof(std::uint32_t) +
         seen_.capacity() * sizeof(std::uint64_t) + floats_.capacity() * sizeof(float) +
         positive_.capacity() + volumes_.capacity() * sizeof(const GriddedVolume*);
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
          earlier_,
          later_};
}

}  // namespace restroke::implicit
