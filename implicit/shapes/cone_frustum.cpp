// Cone frustum, a cone when one end is a point: the greatest of the distances to its side's cone and to its
// ends' planes.

#include <algorithm>
#include <cmath>
#include <utility>

#include "implicit/errors.h"
#include "implicit/sampling/charts.h"
#include "implicit/shapes/kinds.h"
#include "implicit/shapes/ray_intervals.h"

namespace restroke::implicit {

namespace {

class ConeFrustum final : public VolumeOf<ConeFrustum> {
 public:
  explicit ConeFrustum(VolumeParameters parameters) : VolumeOf(coneFrustumKind(), std::move(parameters)) {
    radius0_ = numberOf(kind(), this->parameters(), 0, NumberRule::NotNegative);
    radius1_ = numberOf(kind(), this->parameters(), 1, NumberRule::NotNegative);
    half_ = numberOf(kind(), this->parameters(), 2, NumberRule::Positive);
    const double greater = std::max(radius0_, radius1_);
    if (!(greater > 0))
      throw InputError("a coneFrustum has two ends of radius 0; one of them must be greater than 0");
    const double slope = (radius0_ - radius1_) / (2 * half_);
    cosine_ = 1 / std::sqrt(1 + slope * slope);
    sine_ = slope * cosine_;
    offset_ = (radius0_ + radius1_) / 2 * cosine_;
    setMeasures({.center = {},
                 .radius = std::sqrt(greater * greater + half_ * half_),
                 .area = areaOf(charts()),
                 .volume = 2.0943951023931953 * half_ *
                           (radius0_ * radius0_ + radius0_ * radius1_ + radius1_ * radius1_),
                 .thickness = 2 * std::min(greater, half_)});
  }

  [[nodiscard]] double clearance(DVec3 p) const override {
    return std::max(sideAt(std::sqrt(p.x * p.x + p.y * p.y), p.z), std::fabs(p.z) - half_);
  }
  [[nodiscard]] bool inside(DVec3 p, double dilation) const { return clearance(p) <= dilation; }
  [[nodiscard]] DVec3 outwardNormal(DVec3 p) const override {
    const double rho = std::sqrt(p.x * p.x + p.y * p.y);
    if (std::fabs(p.z) - half_ >= sideAt(rho, p.z)) return {0, 0, p.z < 0 ? -1 : 1};
    return rho > 0 ? DVec3(cosine_ * p.x / rho, cosine_ * p.y / rho, sine_) : DVec3(cosine_, 0, sine_);
  }
  void intersect(const Ray& ray, std::vector<RayInterval>& intervals) const override {
    appendConvexInterval([this](DVec3 p) { return ValueAndGradient{clearance(p), outwardNormal(p)}; },
                         measures(), ray, intervals);
  }
  [[nodiscard]] double support(DVec3 d) const override {
    const double across = std::sqrt(d.x * d.x + d.y * d.y);
    return std::max(radius0_ * across - half_ * d.z, radius1_ * across + half_ * d.z);
  }

 protected:
  [[nodiscard]] SampleTable makeSamples(std::uint32_t count) const override {
    return SampleTable(sampleCharts(charts(), count));
  }

 private:
  [[nodiscard]] double sideAt(double rho, double z) const { return rho * cosine_ + z * sine_ - offset_; }
  [[nodiscard]] std::vector<Chart> charts() const {
    const double pi = 3.141592653589793, r0 = radius0_, r1 = radius1_, h = half_;
    const double slant = std::sqrt((r0 - r1) * (r0 - r1) + 4 * h * h);
    return {
        revolvedUniformly(pi * r0 * r0, [=](double s) { return ProfilePoint{r0 * std::sqrt(s), -h, 0, -1}; }),
        revolvedUniformly(pi * (r0 + r1) * slant,
                          [=, cosine = cosine_, sine = sine_](double s) {
                            // The square of the radius grows evenly with the area.
                            const double r = std::sqrt(r0 * r0 + s * (r1 * r1 - r0 * r0));
                            const double f = r0 == r1 ? s : (r - r0) / (r1 - r0);
                            return ProfilePoint{r, (2 * f - 1) * h, cosine, sine};
                          }),
        revolvedUniformly(pi * r1 * r1,
                          [=](double s) { return ProfilePoint{r1 * std::sqrt(1 - s), h, 0, 1}; })};
  }

  double radius0_, radius1_, half_;
  double cosine_, sine_, offset_;  // the side: rho cosine + z sine = offset
};

}  // namespace

const VolumeKind& coneFrustumKind() {
  static const VolumeKind kind{
      .name = "coneFrustum",
      .summary = "a cone about the z axis, cut off at both ends or one; its middle height at the origin",
      .parameters = {{.name = "radius0", .meaning = "at the lower end, >= 0"},
                     {.name = "radius1", .meaning = "at the upper end, >= 0; not both are 0"},
                     {.name = "halfHeight", .meaning = "> 0"}},
      .make = [](const VolumeParameters& p) -> std::shared_ptr<const Volume> {
        return std::make_shared<ConeFrustum>(p);
      },
      .examples =
          [] {
            return std::vector<VolumeParameters>{{{{0.6f}, {0.25f}, {0.5f}}},
                                                 {{{0.5f}, {0.0f}, {0.5f}}},
                                                 {{{0.0f}, {0.05f}, {2.0f}}},
                                                 {{{1.0f}, {0.98f}, {0.02f}}}};
          }};
  return kind;
}

}  // namespace restroke::implicit
