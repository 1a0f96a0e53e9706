#pragma once
// The shape of a primitive: a sphere, which is kept in place, or a posed volume of any other kind (SPEC S1,
// S13). What the list, the clusters, the ray walk and the surfels ask of a shape is all here.

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "implicit/posed_volume.h"
#include "implicit/shapes/sphere.h"

namespace restroke::implicit {

class Shape {
 public:
  Shape(const Sphere& sphere) : ball_(sphere) {}  // NOLINT(google-explicit-constructor): a sphere is a shape
  Shape(Point center, float radius) : ball_{center, radius} {}
  Shape(std::shared_ptr<const PosedVolume> volume)  // NOLINT(google-explicit-constructor): so is this
      : ball_(volume->ball()), volume_(std::move(volume)) {}
  /// A unit sphere about the origin.
  Shape() = default;

  /// The sphere itself, or a ball that holds the volume.
  [[nodiscard]] const Sphere& ball() const& { return ball_; }
  [[nodiscard]] Sphere ball() && { return ball_; }  // lists give primitives by value
  [[nodiscard]] bool isSphere() const { return !volume_; }
  /// Null for a sphere.
  [[nodiscard]] const PosedVolume* volume() const { return volume_.get(); }
  [[nodiscard]] const std::shared_ptr<const PosedVolume>& sharedVolume() const& { return volume_; }
  [[nodiscard]] std::shared_ptr<const PosedVolume> sharedVolume() && { return std::move(volume_); }

  bool operator==(const Shape& other) const {
    return ball_ == other.ball_ &&
           (volume_ == other.volume_ || (volume_ && other.volume_ && *volume_ == *other.volume_));
  }

 private:
  Sphere ball_;
  std::shared_ptr<const PosedVolume> volume_;
};

/// The side test: in the shape or on its boundary.
[[nodiscard]] inline bool contains(const Shape& shape, Point p) {
  return shape.isSphere() ? contains(shape.ball(), p) : shape.volume()->contains(p);
}
/// Whether a primitive of this shape drops an older sample at p: in it, on its boundary, or so little outside
/// that rounding may have moved it there (SPEC S3).
[[nodiscard]] bool drops(const Shape& shape, Point p);

[[nodiscard]] Box boundsOf(const Shape& shape);
/// Outward unit normal at a surface point.
[[nodiscard]] DVec3 outwardNormal(const Shape& shape, DVec3 p);
/// Appends where the ray's whole line is inside, in order.
void intersect(const Shape& shape, const Ray& ray, std::vector<RayInterval>& intervals);

/// Added to bounding radii: more than rounding can move a sample or a verdict.
[[nodiscard]] float slackOf(const Shape& shape);

/// Throws InputError when the shape would have more than kMaxSamples samples at the density (samples per
/// square model unit). A value of sampleCountFor.
[[nodiscard]] std::uint32_t sampleCount(const Shape& shape, float density);
/// The table of the shape's samples, shared by shapes that differ only in place. Where keepsSamples, it lives
/// as long as the shape's volume, and a sphere's always; else see Volume::samples.
[[nodiscard]] const SampleTable& samplesOf(const Shape& shape, std::uint32_t count);
[[nodiscard]] bool keepsSamples(const Shape& shape);
/// Surface area in square model units.
[[nodiscard]] double areaOf(const Shape& shape);

/// The shape with its samples as the kernels take it.
[[nodiscard]] SampledShape sampled(const Sphere& sphere, const SampleTable& samples);
[[nodiscard]] SampledShape sampled(const PosedVolume& volume, const SampleTable& samples);
[[nodiscard]] SampledShape sampled(const Shape& shape, const SampleTable& samples);

/// A sphere that holds all samples of a node of the tree, and where their keep tests are made.
[[nodiscard]] DropBall regionOfNode(const SampledShape& shape, int level, std::uint32_t node);
/// The same for all samples of the shape.
[[nodiscard]] DropBall regionOf(const Shape& shape);

/// Place, normal (out of the volume) and place of the keep test of sample i, in float32: the operations of
/// the kernels, one by one.
struct PlacedSample {
  Point position, keep;
  Vec3 normal;
};
[[nodiscard]] PlacedSample placedSample(const SampledShape& shape, std::uint32_t i);

}  // namespace restroke::implicit
