// Cylinder: the greater of the distances to its side and to its ends' planes.

#include <algorithm>
#include <cmath>
#include <utility>

#include "implicit/sampling/charts.h"
#include "implicit/shapes/kinds.h"
#include "implicit/shapes/ray_intervals.h"

namespace restroke::implicit {

namespace {

class Cylinder final : public VolumeOf<Cylinder> {
 public:
  explicit Cylinder(VolumeParameters parameters) : VolumeOf(cylinderKind(), std::move(parameters)) {
    radius_ = numberOf(kind(), this->parameters(), 0, NumberRule::Positive);
    half_ = numberOf(kind(), this->parameters(), 1, NumberRule::Positive);
    setMeasures({.center = {},
                 .radius = std::sqrt(radius_ * radius_ + half_ * half_),
                 .area = areaOf(charts()),
                 .volume = 6.283185307179586 * radius_ * radius_ * half_,
                 .thickness = 2 * std::min(radius_, half_)});
  }

  [[nodiscard]] double clearance(DVec3 p) const override {
    return std::max(std::sqrt(p.x * p.x + p.y * p.y) - radius_, std::fabs(p.z) - half_);
  }
  [[nodiscard]] bool inside(DVec3 p, double dilation) const { return clearance(p) <= dilation; }
  [[nodiscard]] DVec3 outwardNormal(DVec3 p) const override {
    const double rho = std::sqrt(p.x * p.x + p.y * p.y);
    if (std::fabs(p.z) - half_ >= rho - radius_ || rho == 0) return {0, 0, p.z < 0 ? -1 : 1};
    return {p.x / rho, p.y / rho, 0};
  }
  void intersect(const Ray& ray, std::vector<RayInterval>& intervals) const override {
    appendConvexInterval([this](DVec3 p) { return ValueAndGradient{clearance(p), outwardNormal(p)}; },
                         measures(), ray, intervals);
  }
  [[nodiscard]] double support(DVec3 d) const override {
    return radius_ * std::sqrt(d.x * d.x + d.y * d.y) + half_ * std::fabs(d.z);
  }

 protected:
  [[nodiscard]] SampleTable makeSamples(std::uint32_t count) const override {
    return SampleTable(sampleCharts(charts(), count));
  }

 private:
  [[nodiscard]] std::vector<Chart> charts() const {
    const double pi = 3.141592653589793, r = radius_, h = half_;
    return {
        revolvedUniformly(pi * r * r, [=](double s) { return ProfilePoint{r * std::sqrt(s), -h, 0, -1}; }),
        revolvedUniformly(4 * pi * r * h, [=](double s) { return ProfilePoint{r, (2 * s - 1) * h, 1, 0}; }),
        revolvedUniformly(pi * r * r, [=](double s) { return ProfilePoint{r * std::sqrt(1 - s), h, 0, 1}; })};
  }

  double radius_, half_;
};

}  // namespace

const VolumeKind& cylinderKind() {
  static const VolumeKind kind{
      .name = "cylinder",
      .summary = "a cylinder about the z axis, its middle at the origin",
      .parameters = {{.name = "radius", .meaning = "> 0"}, {.name = "halfHeight", .meaning = "> 0"}},
      .make = [](const VolumeParameters& p) -> std::shared_ptr<const Volume> {
        return std::make_shared<Cylinder>(p);
      },
      .examples =
          [] {
            return std::vector<VolumeParameters>{
                {{{0.5f}, {0.6f}}}, {{{1.0f}, {0.01f}}}, {{{0.01f}, {2.0f}}}};
          }};
  return kind;
}

}  // namespace restroke::implicit
