#include "implicit/primitive_list.h"

#include <algorithm>
#include <set>

#include "implicit/errors.h"

namespace restroke::implicit {

namespace {

// Room between the labels of appended neighbours: 32 insertions that halve it before all labels are renewed,
// and 2^32 appends.
constexpr PrimitiveList::Label kLabelStep = PrimitiveList::Label{1} << 32;

}  // namespace

void validate(const Primitive& primitive) {
  if (!primitive.shape.isSphere()) return;
  const Sphere& s = primitive.shape.ball();
  if (!isFinite(s.center) || !std::isfinite(s.radius))
    throw InputError("a sphere has a centre or radius that is not finite; all four numbers must be finite");
  if (!(s.radius > 0))
    throw InputError(fmt::format("a sphere has radius {}; it must be greater than 0", s.radius));
  const float far =
      std::fmax(std::fmax(std::fabs(s.center.x), std::fabs(s.center.y)), std::fabs(s.center.z)) + s.radius;
  if (!(far <= kMaxCoordinate))
    throw InputError(fmt::format("a sphere reaches {} model units from the origin; at most {} are allowed",
                                 far, kMaxCoordinate));
  if (!(s.radius >= far * 0x1p-14f))
    throw InputError(fmt::format(
        "a sphere of radius {} reaches {} model units from the origin; float32 cannot sample spheres smaller "
        "than 1/16384 of that",
        s.radius, far));
}

PrimitiveList::PrimitiveList(ClusterOptions options) : clusters_(options) {}

PrimitiveId PrimitiveList::insert(std::size_t position, const Primitive& primitive) {
  insert(position, {&primitive, 1});
  return idAt(position);
}

void PrimitiveList::insert(std::size_t position, std::span<const Primitive> primitives) {
  RESTROKE_CHECK_LE(position, size());
  for (const Primitive& primitive : primitives) validate(primitive);
  const std::size_t count = primitives.size();
  const auto labelBefore = [&] { return position == 0 ? 0 : labels_[order_[position - 1]]; };
  Label before = labelBefore(), step = kLabelStep;
  if (position < size()) {
    if ((labels_[order_[position]] - before) / (count + 1) == 0) {
      relabelAll();
      before = labelBefore();
    }
    step = (labels_[order_[position]] - before) / (count + 1);
  }
  order_.insert(order_.begin() + static_cast<std::ptrdiff_t>(position), count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t slot = takeSlot(primitives[i]);
    order_[position + i] = slot;
    labels_[slot] = before + (i + 1) * step;
    clusters_.insert(slot, boundsOf(primitives[i].shape), members());
  }
}

std::uint32_t PrimitiveList::takeSlot(const Primitive& primitive) {
  std::uint32_t slot;
  if (free_.empty()) {
    slot = static_cast<std::uint32_t>(balls_.size());
    balls_.emplace_back();
    positive_.push_back(0);
    isSphere_.push_back(0);
    labels_.push_back(0);
  } else {
    slot = free_.back();
    free_.pop_back();
  }
  balls_[slot] = primitive.shape.ball();
  positive_[slot] = primitive.sign == Sign::Positive;
  isSphere_[slot] = primitive.shape.isSphere();
  if (const auto& volume = primitive.shape.sharedVolume()) {
    balls_[slot].radius += volume->slack();
    if (volumes_.size() <= slot) volumes_.resize(slot + 1);
    volumes_[slot] = volume;
  }
  return slot;
}

Primitive PrimitiveList::primitiveIn(std::uint32_t slot) const {
  const Sign sign = isPositive(slot) ? Sign::Positive : Sign::Negative;
  return volumeIn(slot) ? Primitive{volumes_[slot], sign} : Primitive{balls_[slot], sign};
}

void PrimitiveList::remove(PrimitiveId id) {
  remove(positionOf(id), 1);
}

void PrimitiveList::remove(std::size_t first, std::size_t count) {
  RESTROKE_CHECK_LE(first, size());
  RESTROKE_CHECK_LE(count, size() - first);
  for (std::size_t i = count; i-- > 0;) {
    const std::uint32_t slot = order_[first + i];
    clusters_.remove(slot, boundsIn(slot), members());
    if (slot < volumes_.size()) volumes_[slot].reset();
    free_.push_back(slot);
  }
  const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(first);
  order_.erase(begin, begin + static_cast<std::ptrdiff_t>(count));
}

Box PrimitiveList::boundsIn(std::uint32_t slot) const {
  const PosedVolume* volume = volumeIn(slot);
  return volume ? volume->bounds() : boundsOf(balls_[slot]);
}

std::size_t PrimitiveList::positionOf(PrimitiveId id) const {
  const Label label = labelOf(id);
  const auto it = std::lower_bound(order_.begin(), order_.end(), label,
                                   [&](std::uint32_t slot, Label l) { return labels_[slot] < l; });
  return static_cast<std::size_t>(it - order_.begin());
}

Box PrimitiveList::bounds(Prefix prefix) const {
  Box box;
  const std::size_t end = std::min(prefix.count, size());
  for (std::size_t i = 0; i < end; ++i)
    if (isPositive(order_[i])) box.add(boundsIn(order_[i]));
  return box;
}

Sphere PrimitiveList::boundingSphere(Prefix prefix) const {
  Sphere out{bounds(prefix).center(), 0};
  const std::size_t end = std::min(prefix.count, size());
  for (std::size_t i = 0; i < end; ++i) {
    if (!isPositive(order_[i])) continue;
    const PosedVolume* volume = volumeIn(order_[i]);
    const Sphere& s = volume ? volume->ball() : balls_[order_[i]];
    out.radius = std::max(out.radius, length(s.center - out.center) + s.radius);
  }
  return out;
}

PrimitiveList::Label PrimitiveList::labelEnd(Prefix prefix) const {
  return prefix.count < size() ? labels_[order_[prefix.count]] : std::numeric_limits<Label>::max();
}

void PrimitiveList::relabelAll() {
  for (std::size_t i = 0; i < order_.size(); ++i) labels_[order_[i]] = (i + 1) * kLabelStep;
}

std::size_t PrimitiveList::bytes() const {
  std::set<const PosedVolume*> posed;
  std::set<const Volume*> volumes;
  for (const auto& volume : volumes_)
    if (volume) {
      posed.insert(volume.get());
      volumes.insert(&volume->volume());
    }
  std::size_t bytes = posed.size() * sizeof(PosedVolume);
  for (const Volume* volume : volumes) bytes += volume->bytes();
  return bytes + balls_.capacity() * sizeof(Sphere) + positive_.capacity() + isSphere_.capacity() +
         labels_.capacity() * sizeof(Label) + volumes_.capacity() * sizeof(volumes_[0]) +
         (free_.capacity() + order_.capacity()) * sizeof(std::uint32_t);
}

}  // namespace restroke::implicit
