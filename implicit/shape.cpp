#include "implicit/shape.h"

#include "implicit/errors.h"
#include "implicit/shapes/sphere_samples.h"

namespace restroke::implicit {

bool drops(const Shape& shape, Point p) {
  if (!shape.isSphere()) return shape.volume()->drops(p);
  return contains(Sphere{shape.ball().center, toleranceOf(shape.ball()).dropRadius}, p);
}

Box boundsOf(const Shape& shape) {
  return shape.isSphere() ? boundsOf(shape.ball()) : shape.volume()->bounds();
}

DVec3 outwardNormal(const Shape& shape, DVec3 p) {
  return shape.isSphere() ? outwardNormal(shape.ball(), p) : shape.volume()->outwardNormal(p);
}

void intersect(const Shape& shape, const Ray& ray, std::vector<RayInterval>& intervals) {
  if (!shape.isSphere()) {
    shape.volume()->intersect(ray, intervals);
  } else if (const auto in = intersect(shape.ball(), ray)) {
    intervals.push_back(*in);
  }
}

float slackOf(const Shape& shape) {
  return shape.isSphere() ? toleranceOf(shape.ball()).slack : shape.volume()->slack();
}

double areaOf(const Shape& shape) {
  if (shape.isSphere())
    return 12.566370614359172 * static_cast<double>(shape.ball().radius) *
           static_cast<double>(shape.ball().radius);
  const auto scale = static_cast<double>(shape.volume()->pose().scale);
  return shape.volume()->volume().measures().area * scale * scale;
}

std::uint32_t sampleCount(const Shape& shape, float density) {
  const double area = areaOf(shape), wanted = area * static_cast<double>(density);
  if (!(wanted <= kMaxSamples * 0.98)) {
    const std::string what =
        shape.isSphere() ? fmt::format("sphere of radius {}", shape.ball().radius)
                         : fmt::format("{} of area {:.6g}", shape.volume()->volume().kind().name, area);
    throw InputError(
        fmt::format("a {} at density {} would have {:.3g} samples; a primitive may have {} at most", what,
                    density, wanted, kMaxSamples));
  }
  return sampleCountFor(area, static_cast<double>(density));
}

const SampleTable& samplesOf(const Shape& shape, std::uint32_t count) {
  return shape.isSphere() ? sphereSamples(count) : shape.volume()->volume().samples(count);
}

bool keepsSamples(const Shape& shape) {
  return shape.isSphere() || shape.volume()->volume().keepsSamples();
}

SampledShape sampled(const Sphere& s, const SampleTable& samples) {
  const SphereTolerance t = toleranceOf(s);
  return {&samples.tree(), s.center.x,   s.center.y, s.center.z, s.radius,
          nullptr,         t.keepRadius, 0,          t.slack,    true};
}

SampledShape sampled(const PosedVolume& v, const SampleTable& samples) {
  const Pose& pose = v.pose();
  return {&samples.tree(), pose.position.x, pose.position.y, pose.position.z, pose.scale,
          &v.rotations(),  pose.scale,      v.keepOffset(),  v.slack(),       true};
}

SampledShape sampled(const Shape& shape, const SampleTable& samples) {
  return shape.isSphere() ? sampled(shape.ball(), samples) : sampled(*shape.volume(), samples);
}

DropBall regionOfNode(const SampledShape& shape, int level, std::uint32_t node) {
  return sphereOfNode(shape, level, node, 2 * shape.slack);
}

DropBall regionOf(const Shape& shape) {
  const Sphere& ball = shape.ball();
  return {ball.center.x, ball.center.y, ball.center.z, ball.radius + 2 * slackOf(shape), 0, nullptr};
}

PlacedSample placedSample(const SampledShape& shape, std::uint32_t i) {
  const PatchTree& t = *shape.tree;
  const float x = t.x[i], y = t.y[i], z = t.z[i];
  if (!shape.rotations) {
    const float r = shape.scale, k = shape.keepScale;
    return {{shape.x + r * x, shape.y + r * y, shape.z + r * z},
            {shape.x + k * x, shape.y + k * y, shape.z + k * z},
            {x, y, z}};
  }
  const float *m = shape.rotations->scaled, *r = shape.rotations->unit;
  const Point p{shape.x + ((m[0] * x + m[1] * y) + m[2] * z), shape.y + ((m[3] * x + m[4] * y) + m[5] * z),
                shape.z + ((m[6] * x + m[7] * y) + m[8] * z)};
  const float nx = t.nx[i], ny = t.ny[i], nz = t.nz[i];
  const Vec3 n{(r[0] * nx + r[1] * ny) + r[2] * nz, (r[3] * nx + r[4] * ny) + r[5] * nz,
               (r[6] * nx + r[7] * ny) + r[8] * nz};
  const float k = shape.keepOffset;
  return {p, {p.x + k * n.x, p.y + k * n.y, p.z + k * n.z}, n};
}

}  // namespace restroke::implicit
