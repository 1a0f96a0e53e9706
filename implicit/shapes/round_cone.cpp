// Round cone: the hull of two balls; a capsule when they are equal. It is what a sphere sweeps that moves
// along a segment while its radius changes evenly. Side test and clearance: the exact signed distance, in the
// plane of the axis (Quilez, "Distance functions", 2019, derives the same).

#include <algorithm>
#include <cmath>
#include <utility>

#include "implicit/errors.h"
#include "implicit/sampling/rings.h"
#include "implicit/shapes/kinds.h"
#include "implicit/shapes/ray_intervals.h"

namespace restroke::implicit {

namespace {

class RoundCone final : public VolumeOf<RoundCone> {
 public:
  explicit RoundCone(VolumeParameters parameters) : VolumeOf(roundConeKind(), std::move(parameters)) {
    radius0_ = numberOf(kind(), this->parameters(), 0, NumberRule::Positive);
    radius1_ = numberOf(kind(), this->parameters(), 1, NumberRule::Positive);
    length_ = numberOf(kind(), this->parameters(), 2, NumberRule::Positive);
    if (!(length_ > std::fabs(radius0_ - radius1_)))
      throw InputError(
          fmt::format("a roundCone of length {} has end balls of radius {} and {}, of which one "
                      "holds the other; the length must be greater than their difference",
                      length_, radius0_, radius1_));
    sine_ = (radius0_ - radius1_) / length_;
    cosine_ = std::sqrt(1 - sine_ * sine_);
    side_ = cosine_ * length_;
    const double top = length_ + radius1_, pi = 3.141592653589793;
    // Two segments of balls and the frustum between their circles.
    const auto segment = [pi](double r, double z) {  // of a ball, below height z
      return pi * (r * r * (z + r) - (z * z * z + r * r * r) / 3);
    };
    const double r0 = radius0_ * cosine_, r1 = radius1_ * cosine_;
    areas_[0] = 2 * pi * radius0_ * radius0_ * (1 + sine_);
    areas_[1] = pi * (r0 + r1) * side_;
    areas_[2] = 2 * pi * radius1_ * radius1_ * (1 - sine_);
    const double volume = segment(radius0_, radius0_ * sine_) + segment(radius1_, -radius1_ * sine_) +
                          pi / 3 * side_ * cosine_ * (r0 * r0 + r0 * r1 + r1 * r1);
    setMeasures({.center = {0, 0, (top - radius0_) / 2},
                 .radius = (top + radius0_) / 2,
                 .area = areas_[0] + areas_[1] + areas_[2],
                 .volume = volume,
                 .thickness = 2 * std::min(radius0_, radius1_)});
  }

  [[nodiscard]] double clearance(DVec3 p) const override { return valueAt(p).value; }
  [[nodiscard]] bool inside(DVec3 p, double dilation) const { return clearance(p) <= dilation; }
  [[nodiscard]] DVec3 outwardNormal(DVec3 p) const override { return valueAt(p).gradient; }
  void intersect(const Ray& ray, std::vector<RayInterval>& intervals) const override {
    appendConvexInterval([this](DVec3 p) { return valueAt(p); }, measures(), ray, intervals);
  }
  [[nodiscard]] double support(DVec3 direction) const override {
    return std::max(radius0_, direction.z * length_ + radius1_);
  }

 protected:
  [[nodiscard]] SampleTable makeSamples(std::uint32_t count) const override {
    const double area = measures().area, r0 = radius0_ * cosine_, r1 = radius1_ * cosine_;
    const double z0 = radius0_ * sine_, rise = length_ + radius1_ * sine_ - z0;
    const double perSide = (r1 * r1 - r0 * r0) / areas_[1], perWidth = r0 == r1 ? 0 : 1 / (r1 - r0);
    // A ball's height is its area (Archimedes); on the side the square of the radius grows with the area.
    const auto ball = [](double radius, double center, double z) {
      const double rho = std::sqrt(std::max(0.0, 1 - z * z));
      return ProfilePoint{radius * rho, center + radius * z, rho, z};
    };
    return sampleRings(area, count, [=, this](double below) {
      if (below < areas_[0]) return ball(radius0_, 0, below * (1 + sine_) / areas_[0] - 1);
      below -= areas_[0];
      if (below < areas_[1]) {
        const double r = std::sqrt(r0 * r0 + below * perSide);
        const double f = r0 == r1 ? below / areas_[1] : (r - r0) * perWidth;
        return ProfilePoint{r, z0 + f * rise, cosine_, sine_};
      }
      return ball(radius1_, length_, std::min(sine_ + (below - areas_[1]) * (1 - sine_) / areas_[2], 1.0));
    });
  }
  [[nodiscard]] bool makesSamplesQuickly() const override { return true; }

 private:
  [[nodiscard]] ValueAndGradient valueAt(DVec3 p) const {
    const double rho = std::sqrt(p.x * p.x + p.y * p.y);
    const double along = cosine_ * p.z - sine_ * rho;
    if (along > 0 && along < side_) {
      const double s = rho > 0 ? cosine_ / rho : 0;
      return {rho * cosine_ + p.z * sine_ - radius0_,
              rho > 0 ? DVec3(p.x * s, p.y * s, sine_) : DVec3(cosine_, 0, sine_)};
    }
    const DVec3 d = along <= 0 ? p : DVec3(p.x, p.y, p.z - length_);
    const double l = length(d);
    return {l - (along <= 0 ? radius0_ : radius1_), l > 0 ? d / l : DVec3(1, 0, 0)};
  }
  double radius0_, radius1_, length_;
  double sine_, cosine_;  // of the side's slope against the axis: the normal's height and radius
  double side_;           // length of the side
  double areas_[3];       // of the lower ball's zone, the side, the upper ball's zone
};

}  // namespace

const VolumeKind& roundConeKind() {
  static const VolumeKind kind{
      .name = "roundCone",
      .summary = "the hull of a ball about the origin and one on the z axis; a capsule when they are equal",
      .parameters = {{.name = "radius0", .meaning = "radius of the ball about the origin, > 0"},
                     {.name = "radius1", .meaning = "radius of the other ball, > 0"},
                     {.name = "length",
                      .meaning = "height of the other ball's centre, more than the difference of the radii"}},
      .make = [](const VolumeParameters& p) -> std::shared_ptr<const Volume> {
        return std::make_shared<RoundCone>(p);
      },
      .examples =
          [] {
            return std::vector<VolumeParameters>{{{{0.5f}, {0.3f}, {0.9f}}},
                                                 {{{0.2f}, {0.2f}, {1.0f}}},
                                                 {{{0.02f}, {0.01f}, {3.0f}}},
                                                 {{{1.0f}, {0.2f}, {0.81f}}}};
          }};
  return kind;
}

}  // namespace restroke::implicit
