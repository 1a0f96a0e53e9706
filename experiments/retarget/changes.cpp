#include "experiments/retarget/changes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "experiments/random.h"
#include "experiments/retarget/fine_mesh.h"
#include "implicit/errors.h"
#include "implicit/geometry/deformations.h"
#include "implicit/geometry/det_math.h"
#include "implicit/geometry/powers.h"
#include "implicit/volume.h"

namespace restroke::experiments {
namespace {

using implicit::Pose;
using implicit::PosedVolume;
using implicit::Shape;

DVec3 unitVector(Random& random) {
  for (;;) {
    const DVec3 v(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
    const double l = length(v);
    if (l > 0.1 && l < 1) return v / l;
  }
}

/// Turn, scale, move, in the float32 numbers of a pose.
struct Motion {
  std::array<float, 4> rotation{0, 0, 0, 1};
  float scale = 1;
  Point position{0};

  [[nodiscard]] Affine affine() const {
    // As PosedVolume makes a matrix of the quaternion.
    double x = static_cast<double>(rotation[0]), y = static_cast<double>(rotation[1]),
           z = static_cast<double>(rotation[2]), w = static_cast<double>(rotation[3]);
    const double l = std::sqrt(x * x + y * y + z * z + w * w);
    x /= l, y /= l, z /= l, w /= l;
    Affine a;
    a.matrix = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    for (double& m : a.matrix) m *= static_cast<double>(scale);
    a.offset = DVec3(position);
    return a;
  }
};

struct MotionSize {
  double translation = 0;  ///< model units
  double degrees = 0;
  double scale = 1;
};

/// About the base's centre: turned and scaled there, then moved, in directions that the seed chooses.
Motion motionOf(const MotionSize& size, const ChangeSite& site) {
  Random random(site.seed);
  const DVec3 axis = unitVector(random), direction = unitVector(random);
  const auto [sine, cosine] = sineCosineOfTurns(size.degrees / 720);
  Motion motion;
  motion.rotation = {static_cast<float>(axis.x * sine), static_cast<float>(axis.y * sine),
                     static_cast<float>(axis.z * sine), static_cast<float>(cosine)};
  motion.scale = static_cast<float>(size.scale);
  const DVec3 center(implicit::boundsOf(site.base).center());
  motion.position = Point(center + size.translation * direction - motion.affine().direction(center));
  return motion;
}

Shape posed(const Shape& base, const Motion& motion) {
  const Affine affine = motion.affine();
  if (base.isSphere())
    return Shape(Point(affine.point(DVec3(base.ball().center))), base.ball().radius * motion.scale);
  Pose pose = base.volume()->pose();
  if (pose == Pose{}) {
    pose = {.position = motion.position, .rotation = motion.rotation, .scale = motion.scale};
  } else {
    const auto& q = motion.rotation;
    const auto& r = pose.rotation;
    const DVec3 a(q[0], q[1], q[2]), b(r[0], r[1], r[2]);
    const double qw = static_cast<double>(q[3]), rw = static_cast<double>(r[3]);
    const DVec3 v = qw * b + rw * a + cross(a, b);
    pose.position = Point(affine.point(DVec3(pose.position)));
    pose.rotation = {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z),
                     static_cast<float>(qw * rw - dot(a, b))};
    pose.scale *= motion.scale;
  }
  return std::make_shared<const PosedVolume>(base.volume()->sharedVolume(), pose);
}

KnownChange moved(const MotionSize& size, const ChangeSite& site) {
  const Motion motion = motionOf(size, site);
  return {.map = std::make_unique<AffineMap>(motion.affine()),
          .motionScale = static_cast<double>(motion.scale),
          .image = posed(site.base, motion)};
}

/// Kinds whose first three parameters are half sizes along the axes, and nothing else has a length.
bool stretchesAlongAxes(const PosedVolume& volume) {
  const auto& name = volume.volume().kind().name;
  return name == "ellipsoid" || name == "superellipsoid" ||
         (name == "box" && volume.volume().parameters().values.at(3) == std::vector<float>{0});
}

/// Factors along the model's axes about a centre. Exact where the kind allows it.
KnownChange stretched(DVec3 factors, const ChangeSite& site, const ImageOptions& options) {
  const DVec3 f(static_cast<float>(factors.x), static_cast<float>(factors.y), static_cast<float>(factors.z));
  const DVec3 center(site.base.ball().center);
  Affine affine;
  affine.matrix = {f.x, 0, 0, 0, f.y, 0, 0, 0, f.z};
  affine.offset = center - affine.direction(center);
  KnownChange change{
      .map = std::make_unique<AffineMap>(affine), .motionScale = std::nullopt, .image = site.base};
  const auto axes = [&](DVec3 half) {
    return std::array<float, 3>{static_cast<float>(half.x * f.x), static_cast<float>(half.y * f.y),
                                static_cast<float>(half.z * f.z)};
  };
  if (site.base.isSphere()) {
    const auto a = axes(DVec3(static_cast<double>(site.base.ball().radius)));
    change.image = std::make_shared<const PosedVolume>(
        implicit::volumeKindNamed("ellipsoid").make({.values = {{a[0]}, {a[1]}, {a[2]}}}),
        Pose{.position = Point(center)});
    return change;
  }
  const PosedVolume& volume = *site.base.volume();
  if (volume.pose() == Pose{} && stretchesAlongAxes(volume)) {
    implicit::VolumeParameters parameters = volume.volume().parameters();
    const auto a = axes(DVec3(parameters.values[0][0], parameters.values[1][0], parameters.values[2][0]));
    for (std::size_t k = 0; k < 3; ++k) parameters.values[k] = {a[k]};
    change.image = std::make_shared<const PosedVolume>(volume.volume().kind().make(parameters),
                                                       Pose{.position = Point(affine.offset)});
    return change;
  }
  if (volume.volume().parameters().mesh) {
    // Triangles stay triangles: the vertices alone are mapped.
    SurfaceMesh surface = fineMeshOf(site.base, {.edge = 1e30});
    change.image = shapeOf(mapped(surface, *change.map).mesh);
    return change;
  }
  MappedMesh image = mapped(fineMeshOf(site.base, {.edge = options.edge * sizeOf(site.base),
                                                   .mostTriangles = options.mostTriangles}),
                            *change.map);
  change.chordError = image.chordError;
  change.exactImage = false;
  change.image = shapeOf(std::move(image.mesh));
  return change;
}

/// Along the longest side of the box, with the second longest as the side that a bend goes to.
struct Lengthwise {
  DeformationFrame frame;
  double length = 0;
};
Lengthwise lengthwise(const Shape& base) {
  const Box box = implicit::boundsOf(base);
  const DVec3 size = DVec3(box.max) - DVec3(box.min);
  std::array<glm::length_t, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(),
            [&](auto a, auto b) { return size[a] != size[b] ? size[a] > size[b] : a < b; });
  Lengthwise result;
  DVec3 along(0), to(0);
  along[order[0]] = 1;
  to[order[1]] = 1;
  result.frame = {.origin = DVec3(box.center()), .axes = {to, cross(along, to), along}};
  result.length = size[order[0]];
  return result;
}

KnownChange deformed(std::unique_ptr<const SpaceMap> map, const ChangeSite& site,
                     const ImageOptions& options) {
  MappedMesh image = mapped(fineMeshOf(site.base, {.edge = options.edge * sizeOf(site.base),
                                                   .mostTriangles = options.mostTriangles}),
                            *map);
  KnownChange change{.map = std::move(map), .motionScale = std::nullopt, .image = Shape()};
  change.exactImage = false;
  change.chordError = image.chordError;
  change.image = shapeOf(std::move(image.mesh));
  return change;
}

// A bulge's ball has this part of the base's size as its radius, and its centre half a radius below the
// surface.
constexpr double kBulgeRadius = 0.2;

double distanceTo(std::span<const Point> points, DVec3 p) {
  double least = 1e300;
  for (const Point& q : points) least = std::min(least, length(DVec3(q) - p));
  return least;
}

// What is kept around a stroke, as a part of the base's size; how many bulges and dents, by turns, deform the
// rest; and how strong and how large they are at most.
constexpr double kKept = 0.08;
constexpr int kPatchBulges = 8;
constexpr std::array kPatchAmplitudes{0.5, -0.35};
constexpr double kPatchLargest = 0.35;

/// The motion where the stroke is, bulges and dents elsewhere: each as large as the kept part leaves room
/// for, each set where the ones before it and the stroke are farthest away.
KnownChange patched(double strength, const ChangeSite& site, const ImageOptions& options) {
  const double size = sizeOf(site.base);
  const SurfaceMesh surface =
      fineMeshOf(site.base, {.edge = options.edge * size, .mostTriangles = options.mostTriangles});
  std::vector<std::shared_ptr<const SmoothMap>> maps;
  std::vector<Point> taken(site.kept.begin(), site.kept.end());
  for (int i = 0; i < kPatchBulges; ++i) {
    DVec3 farthest(0);
    double most = -1;
    for (const Point& v : surface.mesh.vertices)
      if (const double d = distanceTo(taken, DVec3(v)); d > most) most = d, farthest = DVec3(v);
    taken.push_back(Point(farthest));
    const double radius = std::min(distanceTo(site.kept, farthest) - kKept * size, kPatchLargest * size);
    if (!(radius > 0.02 * size)) break;
    // A little inside, since a flat piece of surface through a bulge's centre would stay flat.
    const DVec3 inwards = DVec3(implicit::boundsOf(site.base).center()) - farthest;
    const double l = length(inwards);
    const DVec3 shift = l > 0 ? inwards * (0.25 * radius / l) : DVec3(0);
    const double room = std::min(radius, distanceTo(site.kept, farthest + shift) - kKept * size);
    if (room > 0)
      maps.push_back(std::make_shared<BulgeMap>(farthest + shift, room,
                                                kPatchAmplitudes[static_cast<std::size_t>(i) % 2]));
  }
  const Motion motion = motionOf(
      {.translation = 0.5 * strength * size, .degrees = 45 * strength, .scale = 1 + 0.5 * strength}, site);
  maps.push_back(std::make_shared<AffineStep>(motion.affine()));
  auto map = std::make_unique<ComposedMap>(std::move(maps));
  MappedMesh image = mapped(surface, *map);
  KnownChange change{.map = std::move(map),
                     .motionScale = static_cast<double>(motion.scale),
                     .image = Shape(),
                     .exactImage = false,
                     .chordError = image.chordError,
                     .patchRadius = kKept * size};
  change.image = shapeOf(std::move(image.mesh));
  return change;
}

const std::vector<ChangeInfo>& infos() {
  static const std::vector<ChangeInfo> all{
      {ChangeKind::Translate,
       "translate",
       "of the size",
       "moved by a part of its size",
       {0.02, 0.05, 0.1, 0.25, 0.5, 1},
       {0.5}},
      {ChangeKind::Rotate, "rotate", "degrees", "turned about its centre", {2, 5, 15, 45, 90}, {45}},
      {ChangeKind::Scale,
       "scale",
       "factor",
       "scaled alike in all directions about its centre",
       {1.02, 1.05, 1.1, 1.25, 1.5, 2},
       {1.5}},
      {ChangeKind::Motion,
       "motion",
       "of full",
       "moved, turned and scaled at once, full being half the size, 45 degrees and 1.5",
       {0.05, 0.1, 0.25, 0.5, 1},
       {1}},
      {ChangeKind::Stretch,
       "stretch",
       "factor",
       "stretched upwards, its volume kept",
       {1.02, 1.05, 1.1, 1.25, 1.5, 2},
       {1.25}},
      {ChangeKind::Bend,
       "bend",
       "degrees",
       "bent along its longest side, by this angle from end to end",
       {5, 10, 20, 45, 90},
       {20}},
      {ChangeKind::Twist,
       "twist",
       "degrees",
       "twisted along its longest side, by this angle from end to end",
       {5, 10, 20, 45, 90},
       {20}},
      {ChangeKind::Bulge,
       "bulge",
       "of its ball",
       "bulged where the strokes are, in a ball of a fifth of the size; the strength is the growth at its "
       "middle",
       {0.05, 0.1, 0.2, 0.4, 0.8},
       {0.2}},
      {ChangeKind::Patch,
       "patch",
       "of full",
       "moved as by motion around the stroke, and deformed everywhere else by bulges and dents",
       {0.1, 0.5, 1},
       {0.5}}};
  return all;
}

}  // namespace

std::span<const ChangeInfo> changeKinds() {
  return infos();
}

const ChangeInfo& infoOf(ChangeKind kind) {
  return infos().at(static_cast<std::size_t>(kind));
}

bool isSimilarity(ChangeKind kind) {
  return kind == ChangeKind::Translate || kind == ChangeKind::Rotate || kind == ChangeKind::Scale ||
         kind == ChangeKind::Motion;
}

Shape similarTo(const Shape& shape, double scale, DVec3 shift) {
  Motion motion;
  motion.scale = static_cast<float>(scale);
  motion.position = Point(shift);
  return posed(shape, motion);
}

double sizeOf(const Shape& shape) {
  return 2 * static_cast<double>(implicit::boundsOf(shape).halfDiagonal());
}

KnownChange makeChange(ChangeKind kind, double strength, const ChangeSite& site,
                       const ImageOptions& options) {
  const double size = sizeOf(site.base);
  switch (kind) {
    case ChangeKind::Translate:
      return moved({.translation = strength * size}, site);
    case ChangeKind::Rotate:
      return moved({.degrees = strength}, site);
    case ChangeKind::Scale:
      return moved({.scale = strength}, site);
    case ChangeKind::Motion:
      return moved(
          {.translation = 0.5 * strength * size, .degrees = 45 * strength, .scale = 1 + 0.5 * strength},
          site);
    case ChangeKind::Stretch:
      return stretched({1 / std::sqrt(strength), strength, 1 / std::sqrt(strength)}, site, options);
    case ChangeKind::Bend: {
      const Lengthwise along = lengthwise(site.base);
      return deformed(std::make_unique<BendMap>(along.frame, strength * kPi / 180 / along.length), site,
                      options);
    }
    case ChangeKind::Twist: {
      const Lengthwise along = lengthwise(site.base);
      return deformed(std::make_unique<TwistMap>(along.frame, strength * kPi / 180 / along.length), site,
                      options);
    }
    case ChangeKind::Bulge: {
      const double radius = kBulgeRadius * size;
      return deformed(std::make_unique<BulgeMap>(site.middle - 0.5 * radius * site.outward, radius, strength),
                      site, options);
    }
    case ChangeKind::Patch:
      return patched(strength, site, options);
  }
  throw InternalError("makeChange: no such change");
}

}  // namespace restroke::experiments
