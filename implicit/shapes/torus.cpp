// Torus: the exact signed distance to a tube about a circle.

#include <algorithm>
#include <cmath>
#include <utility>

#include "implicit/errors.h"
#include "implicit/geometry/powers.h"
#include "implicit/sampling/charts.h"
#include "implicit/shapes/kinds.h"
#include "implicit/shapes/ray_intervals.h"

namespace restroke::implicit {

namespace {

class Torus final : public VolumeOf<Torus> {
 public:
  explicit Torus(VolumeParameters parameters) : VolumeOf(torusKind(), std::move(parameters)) {
    radius_ = numberOf(kind(), this->parameters(), 0, NumberRule::Positive);
    tube_ = numberOf(kind(), this->parameters(), 1, NumberRule::Positive);
    if (!(tube_ < radius_))
      throw InputError(
          fmt::format("a torus has a tube of radius {} about a circle of radius {}; the tube's must "
                      "be smaller",
                      tube_, radius_));
    setMeasures({.center = {},
                 .radius = radius_ + tube_,
                 .area = areaOf(charts()),
                 .volume = 19.739208802178716 * radius_ * tube_ * tube_,
                 .thickness = 2 * tube_});
  }

  [[nodiscard]] double clearance(DVec3 p) const override {
    const double across = std::sqrt(p.x * p.x + p.y * p.y) - radius_;
    return std::sqrt(across * across + p.z * p.z) - tube_;
  }
  [[nodiscard]] bool inside(DVec3 p, double dilation) const { return clearance(p) <= dilation; }
  [[nodiscard]] DVec3 outwardNormal(DVec3 p) const override {
    const double rho = std::sqrt(p.x * p.x + p.y * p.y);
    if (rho == 0) return {0, 0, p.z < 0 ? -1 : 1};
    const DVec3 d = p - DVec3(p.x, p.y, 0) * (radius_ / rho);
    const double l = length(d);
    return l > 0 ? d / l : DVec3(0, 0, 1);
  }
  void intersect(const Ray& ray, std::vector<RayInterval>& intervals) const override {
    appendMarchedIntervals(*this, ray, intervals);
  }
  [[nodiscard]] double support(DVec3 d) const override {
    return radius_ * std::sqrt(d.x * d.x + d.y * d.y) + tube_;
  }

 protected:
  [[nodiscard]] SampleTable makeSamples(std::uint32_t count) const override {
    return SampleTable(sampleCharts(charts(), count));
  }

 private:
  [[nodiscard]] std::vector<Chart> charts() const {
    constexpr int kRings = 256;
    return {revolved(kRings, [r = radius_, tube = tube_](double s) {
      const SineCosine angle = sineCosineOfTurns(s);
      return ProfilePoint{r + tube * angle.cosine, tube * angle.sine, angle.cosine, angle.sine};
    })};
  }

  double radius_, tube_;
};

}  // namespace

const VolumeKind& torusKind() {
  static const VolumeKind kind{
      .name = "torus",
      .summary = "a tube about a circle in the plane z = 0 around the origin",
      .parameters = {{.name = "radius", .meaning = "of the circle, > 0"},
                     {.name = "tube", .meaning = "radius of the tube, > 0 and smaller than the circle's"}},
      .make = [](const VolumeParameters& p) -> std::shared_ptr<const Volume> {
        return std::make_shared<Torus>(p);
      },
      .examples =
          [] {
            return std::vector<VolumeParameters>{
                {{{0.6f}, {0.25f}}}, {{{1.0f}, {0.01f}}}, {{{0.5f}, {0.49f}}}};
          }};
  return kind;
}

}  // namespace restroke::implicit
