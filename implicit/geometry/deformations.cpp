#include "implicit/geometry/deformations.h"

#include "implicit/errors.h"
#include "implicit/geometry/det_math.h"
#include "implicit/geometry/powers.h"

namespace restroke {
namespace {

SineCosine sineCosineOf(double radians) {
  return sineCosineOfTurns(radians / (2 * kPi));
}

/// The matrix whose columns are where the frame's axes go, given in the frame, as a map of model space.
Affine inModel(const DeformationFrame& frame, const std::array<DVec3, 3>& columns) {
  Affine affine;
  for (std::size_t column = 0; column < 3; ++column) {
    // The model's axis number `column`, in the frame.
    const auto k = static_cast<glm::length_t>(column);
    const DVec3 local(frame.axes[0][k], frame.axes[1][k], frame.axes[2][k]);
    const DVec3 image = frame.turnedBack(local.x * columns[0] + local.y * columns[1] + local.z * columns[2]);
    affine.matrix[column] = image.x;
    affine.matrix[3 + column] = image.y;
    affine.matrix[6 + column] = image.z;
  }
  return affine;
}

}  // namespace

DVec3 BendMap::point(DVec3 p) const {
  if (curvature_ == 0) return p;
  const DVec3 q = frame_.toLocal(p);
  const auto [sine, cosine] = sineCosineOf(curvature_ * q.z);
  // (1 - cos a) / k, without the difference of nearly equal numbers.
  const double half = sineCosineOf(curvature_ * q.z / 2).sine;
  return frame_.toModel({q.x * cosine + 2 * half * half / curvature_, q.y, (1 / curvature_ - q.x) * sine});
}

Affine BendMap::tangentAt(DVec3 p) const {
  const DVec3 q = frame_.toLocal(p);
  const auto [sine, cosine] = sineCosineOf(curvature_ * q.z);
  const double along = 1 - curvature_ * q.x;
  return inModel(frame_, {DVec3(cosine, 0, -sine), {0, 1, 0}, {along * sine, 0, along * cosine}});
}

DVec3 TwistMap::point(DVec3 p) const {
  if (rate_ == 0) return p;
  const DVec3 q = frame_.toLocal(p);
  const auto [sine, cosine] = sineCosineOf(rate_ * q.z);
  return frame_.toModel({q.x * cosine - q.y * sine, q.x * sine + q.y * cosine, q.z});
}

Affine TwistMap::tangentAt(DVec3 p) const {
  const DVec3 q = frame_.toLocal(p);
  const auto [sine, cosine] = sineCosineOf(rate_ * q.z);
  return inModel(frame_, {DVec3(cosine, sine, 0),
                          {-sine, cosine, 0},
                          {-rate_ * (q.x * sine + q.y * cosine), rate_ * (q.x * cosine - q.y * sine), 1}});
}

BulgeMap::BulgeMap(DVec3 center, double radius, double amplitude)
    : center_(center), radius_(radius), amplitude_(amplitude) {
  if (!(radius > 0))
    throw InputError(fmt::format("a bulge has the radius {}; it must be more than 0", radius));
  // Along a radius the map grows as 1 + a (1 - s)^2 (1 - 7 s), s = (d / radius)^2, whose last factors lie
  // between -0.66 and 1: beyond these amplitudes it would turn back.
  if (!(amplitude >= -0.9 && amplitude <= 1.5))
    throw InputError(fmt::format("a bulge has the amplitude {}; it must be within -0.9 to 1.5", amplitude));
}

DVec3 BulgeMap::point(DVec3 p) const {
  const DVec3 d = p - center_;
  const double s = dot(d, d) / (radius_ * radius_);
  if (s >= 1) return p;
  const double rest = 1 - s;
  return p + amplitude_ * rest * rest * rest * d;
}

Affine BulgeMap::tangentAt(DVec3 p) const {
  const DVec3 d = p - center_;
  const double s = dot(d, d) / (radius_ * radius_);
  Affine affine;
  if (s >= 1) return affine;
  const double rest = 1 - s, growth = 1 + amplitude_ * rest * rest * rest;
  const double slope = -6 * amplitude_ * rest * rest / (radius_ * radius_);  // of the growth, along d
  for (glm::length_t row = 0; row < 3; ++row)
    for (glm::length_t column = 0; column < 3; ++column)
      affine.matrix[static_cast<std::size_t>(3 * row + column)] =
          (row == column ? growth : 0.0) + slope * d[row] * d[column];
  return affine;
}

DVec3 ComposedMap::point(DVec3 p) const {
  for (const auto& map : maps_) p = map->point(p);
  return p;
}

Affine ComposedMap::tangentAt(DVec3 p) const {
  Affine tangent;
  for (const auto& map : maps_) {
    tangent = composed(map->tangentAt(p), tangent);
    p = map->point(p);
  }
  return tangent;
}

}  // namespace restroke
