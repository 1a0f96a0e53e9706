#include "retarget/alignment/starts.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "implicit/geometry/det_math.h"

namespace restroke::retarget::alignment {

namespace {

/// The rotation group of the cube: the identity first.
std::vector<Rotation> cubeRotations() {
  std::vector<Rotation> rotations{{0, 0, 0, 1}, {1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
  const double half = std::sqrt(0.5);
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = a + 1; b < 4; ++b)
      for (const double sign : {half, -half}) {
        Rotation q{0, 0, 0, 0};
        q[a] = half;
        q[b] = sign;
        rotations.push_back(q);
      }
  for (unsigned signs = 0; signs < 8; ++signs)
    rotations.push_back({signs & 1 ? 0.5 : -0.5, signs & 2 ? 0.5 : -0.5, signs & 4 ? 0.5 : -0.5, 0.5});
  return rotations;
}

/// Takes the coordinate axes to the principal axes.
Rotation principalAxes(const Cloud& cloud) {
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < cloud.spread; ++k) {
    const DVec3 p = cloud.samples[k].position;
    const Eigen::Vector3d v(p.x, p.y, p.z);
    moments += v * v.transpose();
  }
  Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments).eigenvectors();
  if (axes.determinant() < 0) axes.col(0) *= -1;
  const Eigen::Quaterniond q = Eigen::Quaterniond(axes).normalized();
  return {q.x(), q.y(), q.z(), q.w()};
}

/// The shortest rotation that takes one unit vector to another.
Rotation rotationFrom(DVec3 a, DVec3 b) {
  const double w = 1 + dot(a, b);
  if (w < 1e-6) {  // opposite: half a turn about anything across
    const DVec3 other = std::fabs(a.x) < 0.8 ? DVec3(1, 0, 0) : DVec3(0, 1, 0);
    const DVec3 axis = normalized(cross(a, other));
    return {axis.x, axis.y, axis.z, 0};
  }
  const DVec3 v = cross(a, b);
  return composed(Rotation{v.x, v.y, v.z, w}, Rotation{0, 0, 0, 1});
}

struct Mean {
  DVec3 position{0}, normal{0};
};

Mean meanWithin(std::span<const Sample> samples, DVec3 center, double radius) {
  Mean mean;
  double count = 0;
  for (const Sample& s : samples) {
    const DVec3 d = s.position - center;
    if (dot(d, d) > radius * radius) continue;
    mean.position += s.position;
    mean.normal += s.normal;
    ++count;
  }
  if (count > 0) {
    mean.position /= count;
    mean.normal /= count;
  }
  return mean;
}

constexpr std::size_t kPlaces = 250;  // about a patch's radius / 3 apart, for a patch of a third of the shape
constexpr double kScales[] = {1, 0.7, 1.4, 0.5, 2};
constexpr int kTurns = 12;
/// A ball of this part of the patch's reach from its middle holds no border of it.
constexpr double kCore = 0.6;

std::vector<Rotation> turnsAboutZ() {
  std::vector<Rotation> turns;
  for (int k = 0; k < kTurns; ++k) {
    const double half = kPi * k / kTurns;
    turns.push_back({0, 0, std::sin(half), std::cos(half)});
  }
  return turns;
}

}  // namespace

Similarity identityBetween(const Cloud& before, const Cloud& after) {
  return {{0, 0, 0, 1}, before.radius / after.radius, (before.center - after.center) / after.radius};
}

std::vector<Similarity> wholeStarts(const Cloud& before, const Cloud& after) {
  std::vector<Similarity> starts{identityBetween(before, after)};
  const Rotation fromAxes = inverted(principalAxes(before)), toAxes = principalAxes(after);
  // A sixth of a turn about a diagonal: from the middle between rotations of the cube.
  const Rotation between = rotationAbout(DVec3(std::sqrt(1.0 / 3)), std::sqrt(1.0 / 3));
  for (const Rotation& q : cubeRotations()) {
    starts.push_back({q, 1, DVec3(0)});
    starts.push_back({composed(toAxes, composed(q, fromAxes)), 1, DVec3(0)});
    starts.push_back({composed(between, q), 1, DVec3(0)});
  }
  return starts;
}

std::vector<Similarity> patchStarts(const Cloud& patch, const Cloud& after) {
  std::vector<Similarity> starts{identityBetween(patch, after)};
  // The place that is looked for: where the patch is whole all around.
  const std::span<const Sample> within(patch.samples.data(), patch.spread);
  const DVec3 anchor = std::min_element(within.begin(), within.end(), [](const Sample& a, const Sample& b) {
                         return dot(a.position, a.position) < dot(b.position, b.position);
                       })->position;
  double reach = 0;
  for (const Sample& s : within) reach = std::fmax(reach, length(s.position - anchor));
  reach *= kCore;
  const Mean ofPatch = meanWithin(within, anchor, reach);
  const bool isBent = length(ofPatch.normal) < 0.4;

  const std::vector<Rotation> turns = turnsAboutZ();
  const std::vector<Rotation> cube = cubeRotations();
  const std::span<const Sample> around(after.samples.data(), after.spread);
  const std::size_t places = std::min(kPlaces, after.spread);
  for (std::size_t place = 0; place < places; ++place)
    for (const double factor : kScales) {
      const double scale = factor * patch.radius / after.radius;
      const Mean there = meanWithin(around, after.samples[place].position, reach * scale);
      const auto add = [&](const Rotation& q) {
        starts.push_back({q, scale, there.position - scale * turned(q, ofPatch.position)});
      };
      if (isBent) {
        for (const Rotation& q : cube) add(q);
        continue;
      }
      if (length(there.normal) < 0.2) continue;  // the patch would not lie there
      const Rotation flat = rotationFrom(normalized(ofPatch.normal), DVec3(0, 0, 1));
      const Rotation raised = rotationFrom(DVec3(0, 0, 1), normalized(there.normal));
      for (const Rotation& q : turns) add(composed(raised, composed(q, flat)));
    }
  return starts;
}

std::vector<Similarity> turnedStarts(const Cloud& before, const Similarity& motion) {
  std::vector<Similarity> starts;
  const auto add = [&](const Rotation& frame, const Rotation& q) {
    const Rotation turn = composed(frame, composed(q, inverted(frame)));
    starts.push_back(composed(motion, Similarity{turn, 1, DVec3(0)}));
  };
  const Rotation axes = principalAxes(before);
  for (const Rotation& q : cubeRotations()) add(axes, q);
  const Mean mean = meanWithin(std::span(before.samples.data(), before.spread), DVec3(0), 1e9);
  if (length(mean.normal) > 0.1) {
    const Rotation raised = rotationFrom(DVec3(0, 0, 1), normalized(mean.normal));
    for (const Rotation& q : turnsAboutZ()) add(raised, q);
  }
  return starts;
}

}  // namespace restroke::retarget::alignment
