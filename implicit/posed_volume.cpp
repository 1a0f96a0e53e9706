#include "implicit/posed_volume.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "implicit/clearance_grid.h"
#include "implicit/errors.h"

namespace restroke::implicit {

std::array<float, 4> rotationTo(DVec3 axis, DVec3 along) {
  const DVec3 z = normalized(axis);
  DVec3 x = along - dot(along, z) * z;
  if (!(dot(x, x) > 1e-12 * dot(along, along))) {
    // Parallel: the coordinate axis that is farthest from z.
    const DVec3 a(std::fabs(z.x), std::fabs(z.y), std::fabs(z.z));
    const DVec3 other = a.x <= a.y && a.x <= a.z ? DVec3(1, 0, 0)
                        : a.y <= a.z             ? DVec3(0, 1, 0)
                                                 : DVec3(0, 0, 1);
    x = other - dot(other, z) * z;
  }
  x = normalized(x);
  const DVec3 y = cross(z, x);
  // The matrix with columns x, y, z as a quaternion, from its largest component (Shepperd, "Quaternion from
  // rotation matrix", Journal of Guidance and Control 1, 1978).
  const double xx = x.x, yy = y.y, zz = z.z;
  const double four[4] = {1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz, 1 + xx + yy + zz};
  const int largest = static_cast<int>(std::max_element(four, four + 4) - four);
  const double q = std::sqrt(four[largest]);
  double out[4];
  const double yz = y.z - z.y, zx = z.x - x.z, xy = x.y - y.x;     // 4 w (x, y, z)
  const double sxy = x.y + y.x, syz = y.z + z.y, szx = z.x + x.z;  // 4 x y, 4 y z, 4 z x
  switch (largest) {
    case 0:
      out[0] = q, out[1] = sxy / q, out[2] = szx / q, out[3] = yz / q;
      break;
    case 1:
      out[0] = sxy / q, out[1] = q, out[2] = syz / q, out[3] = zx / q;
      break;
    case 2:
      out[0] = szx / q, out[1] = syz / q, out[2] = q, out[3] = xy / q;
      break;
    default:
      out[0] = yz / q, out[1] = zx / q, out[2] = xy / q, out[3] = q;
      break;
  }
  return {static_cast<float>(out[0] / 2), static_cast<float>(out[1] / 2), static_cast<float>(out[2] / 2),
          static_cast<float>(out[3] / 2)};
}

PosedVolume::PosedVolume(std::shared_ptr<const Volume> volume, const Pose& pose)
    : GriddedVolume(), volume_(std::move(volume)), pose_(pose) {
  const std::string_view name = volume_->kind().name;
  double q[4], n2 = 0;
  for (int i = 0; i < 4; ++i) {
    q[i] = static_cast<double>(pose.rotation[static_cast<std::size_t>(i)]);
    n2 += q[i] * q[i];
  }
  if (!isFinite(pose.position) || !std::isfinite(pose.scale) || !std::isfinite(n2))
    throw InputError(fmt::format("the pose of a {} is not finite; all eight numbers must be finite", name));
  if (!(n2 > 1e-30))
    throw InputError(fmt::format("the rotation of a {} is the quaternion 0; it must have a length", name));
  if (!(pose.scale > 0))
    throw InputError(fmt::format("the scale of a {} is {}; it must be greater than 0", name, pose.scale));
  const double n = std::sqrt(n2), x = q[0] / n, y = q[1] / n, z = q[2] / n, w = q[3] / n;
  const double m[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
                       2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                       2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
  std::copy(m, m + 9, m_);
  position_ = DVec3(pose.position);
  scale_ = static_cast<double>(pose.scale);
  inverseScale_ = 1 / scale_;
  for (int i = 0; i < 9; ++i) {
    rotations_.unit[i] = static_cast<float>(m_[i]);
    rotations_.scaled[i] = static_cast<float>(scale_ * m_[i]);
  }

  const VolumeMeasures& measures = volume_->measures();
  const DVec3 center = toModel(measures.center);
  const double radius = scale_ * measures.radius;
  const auto largest = [](DVec3 v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); };
  const double greatest = std::max(
      {largest(center) + radius, largest(position_), scale_ * (largest(measures.center) + measures.radius)});
  if (!(greatest <= static_cast<double>(kMaxCoordinate)))
    throw InputError(fmt::format("a {} reaches {:.6g} model units from the origin; at most {} are allowed",
                                 name, greatest, kMaxCoordinate));
  const double thickness = scale_ * measures.thickness;
  if (!(thickness >= greatest * 0x1p-14))
    throw InputError(
        fmt::format("a {} is only {:.6g} thick and reaches {:.6g} model units from the origin; float32 "
                    "cannot sample what "
                    "is thinner than 1/16384 of that",
                    name, thickness, greatest));
  keepOffset_ = static_cast<float>(greatest * 0x1p-18);
  slack_ = static_cast<float>(greatest * 0x1p-17);
  dropDilation_ = greatest * 0x1p-19 * inverseScale_;
  const double pad = greatest * 0x1p-22;
  ball_ = {Point(center), static_cast<float>(radius + 2 * pad)};
  const auto extent = [&](DVec3 axis) {  // along the model's axis
    const DVec3 local(m_[0] * axis.x + m_[3] * axis.y + m_[6] * axis.z,
                      m_[1] * axis.x + m_[4] * axis.y + m_[7] * axis.z,
                      m_[2] * axis.x + m_[5] * axis.y + m_[8] * axis.z);
    return scale_ * volume_->support(local) + pad;
  };
  bounds_.max = Point(position_ + DVec3(extent({1, 0, 0}), extent({0, 1, 0}), extent({0, 0, 1})));
  bounds_.min = Point(position_ - DVec3(extent({-1, 0, 0}), extent({0, -1, 0}), extent({0, 0, -1})));
  placeGrid();
  volume_->countPlace();
}

void PosedVolume::placeGrid() {
  const GridGeometry grid(*volume_);
  cells = volume_->cells();
  for (int a = 0; a < 3; ++a) {
    origin[a] = pose_.position[a];
    for (int b = 0; b < 3; ++b)
      toCells[3 * a + b] = static_cast<float>(m_[3 * b + a] * inverseScale_ / grid.cell);
    shift[a] = static_cast<float>(-grid.low[a] / grid.cell);
    last[a] = static_cast<float>(grid.size[static_cast<std::size_t>(a)]) - 0.5f;
  }
  row = static_cast<float>(grid.size[0]);
  layer = static_cast<float>(grid.size[0] * grid.size[1]);
  // Points in and about the volume are placed within a few roundings of their distance from the origin.
  const VolumeMeasures& measures = volume_->measures();
  const double rounding = 0x1p-20 * (length(measures.center) + 2 * measures.radius);
  sure = rounding + dropDilation_ < kGridMargin * grid.cell;
}

void PosedVolume::intersect(const Ray& ray, std::vector<RayInterval>& intervals) const {
  const DVec3 d = ray.direction;
  const Ray local{toLocal(ray.origin),
                  {(m_[0] * d.x + m_[3] * d.y + m_[6] * d.z) * inverseScale_,
                   (m_[1] * d.x + m_[4] * d.y + m_[7] * d.z) * inverseScale_,
                   (m_[2] * d.x + m_[5] * d.y + m_[8] * d.z) * inverseScale_},
                  ray.tMin,
                  ray.tMax};
  volume_->intersect(local, intervals);
}

std::uint32_t PosedVolume::containsLanes(const PointGroup& group, bool dropping) const {
  const double dilation = dropping ? dropDilation_ : 0;
  if (!sure || !__atomic_load_n(cells, __ATOMIC_RELAXED)) {
    // All of the points may be on one side, as their sphere tells. (Those that a grid left are near the
    // surface.)
    const DropBall& sphere = group.sphere;
    const double reach = static_cast<double>(sphere.reach) * inverseScale_;
    const double clearance = volume_->clearance(toLocal(DVec3(Point(sphere.x, sphere.y, sphere.z))));
    if (clearance > reach + dilation) return 0;
    if (clearance < -reach) return group.lanes;
    if (sure) volume_->countAsked(static_cast<std::uint32_t>(std::popcount(group.lanes)));
  }
  LocalPoints points;
  for (std::uint32_t left = group.lanes; left != 0; left &= left - 1) {
    const auto i = static_cast<unsigned>(__builtin_ctz(left));
    const DVec3 p = toLocal(DVec3(Point(group.x[i], group.y[i], group.z[i])));
    points.x[i] = p.x;
    points.y[i] = p.y;
    points.z[i] = p.z;
  }
  return volume_->containsLanes(points, group.lanes, dilation);
}

bool PosedVolume::operator==(const PosedVolume& other) const {
  return pose_ == other.pose_ &&
         (volume_ == other.volume_ || (&volume_->kind() == &other.volume_->kind() &&
                                       volume_->parameters() == other.volume_->parameters()));
}

std::uint32_t lanesInVolume(const GriddedVolume& volume, const PointGroup& group, bool dropping) {
  return static_cast<const PosedVolume&>(volume).containsLanes(group, dropping);
}

}  // namespace restroke::implicit
