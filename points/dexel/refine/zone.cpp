#include "points/dexel/refine/zone.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "implicit/errors.h"
#include "implicit/geometry/det_math.h"

namespace restroke::points {

namespace {

// Rounded outwards by more than the sums before can lose.
void add(Box& box, DVec3 p, double beyond = 0) {
  const double size = std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}) + beyond;
  const double by = beyond + size * 0x1p-22;
  box.add({Point(p - DVec3(by)), Point(p + DVec3(by))});
}

std::array<DVec3, 8> cornersOf(const OrientedBox& box) {
  std::array<DVec3, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {
    corners[i] = box.center;
    for (int a = 0; a < 3; ++a)
      corners[i] += ((i >> a & 1) != 0 ? box.half[a] : -box.half[a]) * box.axes[static_cast<std::size_t>(a)];
  }
  return corners;
}

std::array<DVec3, 8> cornersOf(const CameraFrame& frame, double near, double far) {
  std::array<DVec3, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {
    const double depth = (i & 4) != 0 ? far : near;
    corners[i] =
        frame.position + depth * (frame.forward + ((i & 1) != 0 ? 1 : -1) * frame.halfWidth * frame.right +
                                  ((i & 2) != 0 ? 1 : -1) * frame.halfHeight * frame.up);
  }
  return corners;
}

void validate(const OrientedBox& box) {
  for (int a = 0; a < 3; ++a) {
    if (!std::isfinite(box.center[a]) || !std::isfinite(box.half[a]) || !(box.half[a] > 0))
      throw InputError(
          fmt::format("the zone is a box about ({}, {}, {}) of half extents ({}, {}, {}); these must be "
                      "finite, and the extents greater than 0",
                      box.center.x, box.center.y, box.center.z, box.half.x, box.half.y, box.half.z));
    for (std::size_t b = 0; b < 3; ++b) {
      const double product = dot(box.axes[static_cast<std::size_t>(a)], box.axes[b]);
      if (!(std::fabs(product - (static_cast<std::size_t>(a) == b ? 1 : 0)) <= 1e-6))
        throw InputError(
            "the zone is a box whose axes are not at right angles and of length 1; they must be");
    }
  }
}

}  // namespace

OrientedBox orientedBoxOf(const Box& box) {
  OrientedBox out;
  const DVec3 low(box.min), high(box.max);
  out.center = (low + high) / 2.0;
  out.half = (high - low) / 2.0;
  return out;
}

void Zone::takePlanes(std::vector<Plane> planes, const std::array<DVec3, 8>& corners) {
  planes_ = std::move(planes);
  for (const DVec3& p : corners) add(bounds_, p);
}

Zone::Zone(const OrientedBox& box) : shape_(box) {
  validate(box);
  std::vector<Plane> planes;
  for (int a = 0; a < 3; ++a)
    for (const double side : {-1.0, 1.0}) {
      const DVec3 normal = side * box.axes[static_cast<std::size_t>(a)];
      planes.push_back({normal, dot(normal, box.center) + box.half[a]});
    }
  takePlanes(std::move(planes), cornersOf(box));
  volume_ = 8 * box.half.x * box.half.y * box.half.z;
}

Zone::Zone(const implicit::Sphere& ball) : shape_(ball) {
  if (!isFinite(ball.center) || !std::isfinite(ball.radius) || !(ball.radius > 0))
    throw InputError(fmt::format(
        "the zone is a ball about ({}, {}, {}) of radius {}; these must be finite, and the radius greater "
        "than 0",
        ball.center.x, ball.center.y, ball.center.z, ball.radius));
  const double r = static_cast<double>(ball.radius);
  add(bounds_, DVec3(ball.center), r);
  volume_ = 4 * kPi / 3 * r * r * r;
}

Zone::Zone(const Camera& camera) : shape_(camera) {
  validate(camera, "the zone");
  const CameraFrame frame = frameOf(camera);
  const double near = static_cast<double>(camera.near), far = static_cast<double>(camera.far);
  std::vector<Plane> planes;
  const double along = dot(frame.forward, frame.position);
  planes.push_back({-frame.forward, -(along + near)});
  planes.push_back({frame.forward, along + far});
  const auto side = [&](DVec3 outwards, double half) {
    const DVec3 normal = normalized(outwards - half * frame.forward);
    planes.push_back({normal, dot(normal, frame.position)});
  };
  side(frame.right, frame.halfWidth);
  side(-frame.right, frame.halfWidth);
  side(frame.up, frame.halfHeight);
  side(-frame.up, frame.halfHeight);
  takePlanes(std::move(planes), cornersOf(frame, near, far));
  volume_ = 4.0 / 3 * frame.halfWidth * frame.halfHeight * (far * far * far - near * near * near);
}

std::array<DVec3, 8> Zone::corners() const {
  if (const auto* box = std::get_if<OrientedBox>(&shape_)) return cornersOf(*box);
  if (const auto* camera = std::get_if<Camera>(&shape_))
    return cornersOf(frameOf(*camera), static_cast<double>(camera->near), static_cast<double>(camera->far));
  return cornersOf(orientedBoxOf(bounds_));
}

bool Zone::contains(DVec3 p) const {
  if (const auto* ball = std::get_if<implicit::Sphere>(&shape_)) {
    const DVec3 d = p - DVec3(ball->center);
    const double r = static_cast<double>(ball->radius) + widening_;
    return dot(d, d) <= r * r;
  }
  return std::all_of(planes_.begin(), planes_.end(),
                     [&](const Plane& plane) { return dot(plane.normal, p) <= plane.offset; });
}

std::optional<RayInterval> Zone::clip(const Ray& ray) const {
  if (const auto* ball = std::get_if<implicit::Sphere>(&shape_)) {
    // As intersect(Sphere, Ray), with the zone's widening.
    const DVec3 to = DVec3(ball->center) - ray.origin;
    const double dd = dot(ray.direction, ray.direction), middle = dot(to, ray.direction) / dd;
    const DVec3 q = to - middle * ray.direction;
    const double r = static_cast<double>(ball->radius) + widening_, square = r * r - dot(q, q);
    if (!(square > 0)) return std::nullopt;
    const double half = std::sqrt(square / dd);
    return RayInterval{middle - half, middle + half};
  }
  RayInterval in{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  for (const Plane& plane : planes_) {
    const double rate = dot(plane.normal, ray.direction), room = plane.offset - dot(plane.normal, ray.origin);
    if (rate > 0)
      in.exit = std::min(in.exit, room / rate);
    else if (rate < 0)
      in.enter = std::max(in.enter, room / rate);
    else if (room < 0)
      return std::nullopt;
  }
  if (!(in.enter < in.exit)) return std::nullopt;
  return in;
}

bool Zone::mayMeet(const Box& box) const {
  if (box.empty()) return false;
  for (int a = 0; a < 3; ++a)
    if (box.max[a] < bounds_.min[a] || box.min[a] > bounds_.max[a]) return false;
  const DVec3 low(box.min), high(box.max);
  if (const auto* ball = std::get_if<implicit::Sphere>(&shape_)) {
    double square = 0;
    for (int a = 0; a < 3; ++a) {
      const double c = static_cast<double>(ball->center[a]);
      const double d = std::max({low[a] - c, c - high[a], 0.0});
      square += d * d;
    }
    const double r = (static_cast<double>(ball->radius) + widening_) * (1 + 0x1p-40);
    return square <= r * r;
  }
  for (const Plane& plane : planes_) {
    double least = 0, size = std::fabs(plane.offset);
    for (int a = 0; a < 3; ++a) {
      const double at = plane.normal[a] * (plane.normal[a] > 0 ? low[a] : high[a]);
      least += at;
      size += std::fabs(at);
    }
    if (least > plane.offset + size * 0x1p-48) return false;
  }
  return true;
}

Zone Zone::widened(double distance) const {
  RESTROKE_CHECK_EQ(distance >= 0 && std::isfinite(distance), true);
  Zone out = *this;
  out.widening_ += distance;
  for (Plane& plane : out.planes_) plane.offset += distance;
  if (const auto* ball = std::get_if<implicit::Sphere>(&shape_)) {
    out.bounds_ = {};
    const double r = static_cast<double>(ball->radius) + out.widening_;
    add(out.bounds_, DVec3(ball->center), r);
  } else if (const auto* box = std::get_if<OrientedBox>(&shape_)) {
    OrientedBox larger = *box;
    larger.half += DVec3(out.widening_);
    out.bounds_ = {};
    for (const DVec3& p : cornersOf(larger)) add(out.bounds_, p);
  } else {
    // Planes that move out along their normals leave the edges farther than the distance: by the sharpness
    // of the corners. The box of the corners of a larger frustum holds them.
    const Camera& camera = std::get<Camera>(shape_);
    const CameraFrame frame = frameOf(camera);
    const auto back = [&](double half) { return out.widening_ * std::sqrt(1 + half * half) / half; };
    // The four sides meet behind the camera, at two places where the picture is not square.
    const double near = static_cast<double>(camera.near) - out.widening_,
                 far = static_cast<double>(camera.far) + out.widening_;
    out.bounds_ = {};
    for (const double depth : {near, far})
      for (const double x : {-1.0, 1.0})
        for (const double y : {-1.0, 1.0}) {
          const double wide = std::max(0.0, (depth + back(frame.halfWidth)) * frame.halfWidth),
                       high = std::max(0.0, (depth + back(frame.halfHeight)) * frame.halfHeight);
          add(out.bounds_,
              frame.position + depth * frame.forward + x * wide * frame.right + y * high * frame.up);
        }
  }
  return out;
}

}  // namespace restroke::points
