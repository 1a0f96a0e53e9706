#include "tests/bench/plain_list.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "implicit/near_balls.h"
#include "tests/bench/brush_dispatch.h"

namespace restroke::bench {

using implicit::DropBall;
using implicit::kPatch;
using implicit::SampledShape;

namespace {

std::size_t countOf(const std::vector<std::uint16_t>& masks) {
  std::size_t n = 0;
  for (const std::uint16_t mask : masks) n += static_cast<unsigned>(std::popcount(mask));
  return n;
}

}  // namespace

PlainList::PlainList(float density) : density_(density) {}

SampledShape PlainList::shapeOf(std::size_t i) const {
  SampledShape shape = implicit::sampled(list_[i].shape, *samples_[i].table);
  shape.positive = list_[i].sign == implicit::Sign::Positive;
  return shape;
}

implicit::BallArrays PlainList::arrays(std::size_t earlier) const {
  return {.x = columns_[kX].data(),
          .y = columns_[kY].data(),
          .z = columns_[kZ].data(),
          .reach = columns_[kReach].data(),
          .r2 = columns_[kRadius2].data(),
          .r2Drop = columns_[kDropRadius2].data(),
          .volume = volumes_.data(),
          .anyVolume = false,
          .positive = positive_.data(),
          .count = static_cast<std::uint32_t>(list_.size()),
          .earlier = static_cast<std::uint32_t>(earlier),
          .later = static_cast<std::uint32_t>(earlier)};
}

BallColumns PlainList::columns() const {
  return {columns_[kX].data(), columns_[kY].data(), columns_[kZ].data(), columns_[kReach].data(),
          list_.size()};
}

void PlainList::place(std::size_t i) {
  const DropBall ball = implicit::dropBall(list_[i].shape);
  const float radius = list_[i].shape.ball().radius;
  const float values[kColumns] = {ball.x, ball.y, ball.z, ball.reach, radius * radius, ball.r2Drop};
  for (std::size_t c = 0; c < kColumns; ++c) columns_[c][i] = values[c];
  positive_[i] = list_[i].sign == implicit::Sign::Positive;
}

// Room for the list, and balls that nothing meets after it.
void PlainList::pad() {
  const std::size_t n = list_.size(), room = (n + 2 * kPatch) / kPatch * kPatch;
  if (columns_[kX].size() < room) {
    for (std::vector<float>& column : columns_) column.resize(2 * room, 0);
    positive_.resize(2 * room);
    volumes_.resize(2 * room);
    found_.resize(2 * room);
  }
  for (std::size_t i = n; i < room; ++i) {
    columns_[kX][i] = implicit::kNowhere;
    columns_[kReach][i] = 0;
  }
}

// Of the primitive i: it is taken out of the way meanwhile, as a primitive does not test its own samples.
void PlainList::evaluate(std::size_t i) {
  const SampledShape shape = shapeOf(i);
  columns_[kX][i] = implicit::kNowhere;
  const int top = shape.tree->levels - 1;
  for (std::uint32_t node = 0; node < shape.tree->level[top].count; ++node)
    (void)implicit::ballKernels().evaluateNode(shape, top, node, arrays(i), samples_[i].visible.data());
  columns_[kX][i] = list_[i].shape.ball().center.x;
}

void PlainList::append(const implicit::Primitive& primitive) {
  const std::size_t i = list_.size();
  list_.push_back(primitive);
  pad();
  place(i);
  Samples& own = samples_.emplace_back();
  own.table = &implicit::samplesOf(primitive.shape, implicit::sampleCount(primitive.shape, density_));
  own.visible.resize(own.table->patches());
  evaluate(i);
  surfels_ += countOf(own.visible);
  const DropBall drop = implicit::dropBall(primitive.shape);
  const float sphere[4] = {drop.x, drop.y, drop.z, drop.reach};
  const std::size_t n = brushKernels().ballsMeeting(columns(), sphere, found_.data());
  for (std::size_t k = 0; k < n; ++k)
    if (found_[k] != i)
      surfels_ -=
          implicit::ballKernels().dropSamples(shapeOf(found_[k]), drop, samples_[found_[k]].visible.data());
}

void PlainList::remove(std::size_t first, std::size_t count) {
  std::vector<DropBall> gone;
  for (std::size_t i = first; i < first + count; ++i) gone.push_back(implicit::dropBall(list_[i].shape));
  const auto from = static_cast<std::ptrdiff_t>(first), to = static_cast<std::ptrdiff_t>(first + count);
  list_.erase(list_.begin() + from, list_.begin() + to);
  samples_.erase(samples_.begin() + from, samples_.begin() + to);
  for (std::size_t i = first; i < list_.size(); ++i) place(i);
  pad();

  std::vector<std::uint64_t> touched;  // primitive << 32 | patch
  for (const DropBall& ball : gone) {
    const float sphere[4] = {ball.x, ball.y, ball.z, ball.reach};
    const std::size_t n = brushKernels().ballsMeeting(columns(), sphere, found_.data());
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t i = found_[k];
      blocks_.assign((samples_[i].visible.size() + kPatch - 1) / kPatch, 0);
      implicit::ballKernels().touchedPatches(shapeOf(i), ball, blocks_.data());
      for (std::size_t b = 0; b < blocks_.size(); ++b)
        for (std::uint32_t bits = blocks_[b]; bits != 0; bits &= bits - 1)
          touched.push_back(std::uint64_t{i} << 32 |
                            (b * kPatch + static_cast<std::size_t>(std::countr_zero(bits))));
    }
  }
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  for (std::size_t k = 0; k < touched.size();) {
    const std::size_t i = touched[k] >> 32;
    const SampledShape shape = shapeOf(i);
    columns_[kX][i] = implicit::kNowhere;
    for (; k < touched.size() && touched[k] >> 32 == i; ++k) {
      const auto patch = static_cast<std::uint32_t>(touched[k]);
      (void)implicit::ballKernels().evaluatePatches(shape, {&patch, 1}, arrays(i),
                                                    samples_[i].visible.data());
    }
    columns_[kX][i] = list_[i].shape.ball().center.x;
  }
  countAgain();
}

void PlainList::rebuild() {
  for (std::size_t i = 0; i < list_.size(); ++i) evaluate(i);
  countAgain();
}

void PlainList::countAgain() {
  surfels_ = 0;
  for (const Samples& s : samples_) surfels_ += countOf(s.visible);
}

std::size_t PlainList::bytes() const {
  std::size_t n = list_.capacity() * sizeof(implicit::Primitive) + samples_.capacity() * sizeof(Samples) +
                  positive_.capacity() + volumes_.capacity() * sizeof(volumes_[0]);
  for (const Samples& s : samples_) n += s.visible.capacity() * sizeof(std::uint16_t);
  for (const std::vector<float>& column : columns_) n += column.capacity() * sizeof(float);
  return n;
}

std::optional<double> PlainList::castRay(const Ray& ray) {
  const DVec3 unit = ray.direction / length(ray.direction);
  // The point of the line that is nearest to the origin, so that float32 has digits left for it.
  const DVec3 at = ray.origin - unit * dot(ray.origin, unit);
  const float origin[3] = {static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z)};
  const float direction[3] = {static_cast<float>(unit.x), static_cast<float>(unit.y),
                              static_cast<float>(unit.z)};
  const std::size_t n = brushKernels().ballsOnLine(columns(), origin, direction, 1e-5f, found_.data());
  std::size_t hits = 0;
  intervals_.clear();
  for (std::size_t k = 0; k < n; ++k)
    if (const auto in = implicit::intersect(list_[found_[k]].shape.ball(), ray)) {
      intervals_.push_back(*in);
      found_[hits++] = found_[k];
    }
  // The last interval that holds t says what is there; next that changes at its exit or at a later entry.
  const auto ownerAt = [&](double t) {
    std::size_t k = hits;
    while (k > 0 && !(intervals_[k - 1].enter <= t && t < intervals_[k - 1].exit)) --k;
    return k;  // one more than its number; 0: none
  };
  double t = ray.tMin;
  std::size_t owner = ownerAt(t);
  bool inside = owner != 0 && positive_[found_[owner - 1]] != 0;
  for (;;) {
    double next = owner != 0 ? intervals_[owner - 1].exit : std::numeric_limits<double>::infinity();
    for (std::size_t k = owner; k < hits; ++k)
      if (intervals_[k].enter > t) next = std::min(next, intervals_[k].enter);
    if (!(next < ray.tMax)) return std::nullopt;
    t = next;
    owner = ownerAt(t);
    const bool now = owner != 0 && positive_[found_[owner - 1]] != 0;
    if (now && !inside) return t;
    inside = now;
  }
}

}  // namespace restroke::bench
