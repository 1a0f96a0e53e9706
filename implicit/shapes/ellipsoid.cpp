// Ellipsoid. Side test: the length of p in units of the semi-axes, against 1.

#include <algorithm>
#include <cmath>
#include <utility>

#include "implicit/geometry/powers.h"
#include "implicit/sampling/charts.h"
#include "implicit/shapes/kinds.h"
#include "implicit/shapes/ray_intervals.h"

namespace restroke::implicit {

namespace {

class Ellipsoid final : public VolumeOf<Ellipsoid> {
 public:
  explicit Ellipsoid(VolumeParameters parameters) : VolumeOf(ellipsoidKind(), std::move(parameters)) {
    for (int i = 0; i < 3; ++i)
      axes_[i] = numberOf(kind(), this->parameters(), static_cast<std::size_t>(i), NumberRule::Positive);
    least_ = std::min({axes_.x, axes_.y, axes_.z});
    setMeasures({.center = {},
                 .radius = std::max({axes_.x, axes_.y, axes_.z}),
                 .area = areaOf(charts()),
                 .volume = 4.1887902047863905 * axes_.x * axes_.y * axes_.z,
                 .thickness = 2 * least_});
  }

  [[nodiscard]] bool inside(DVec3 p, double dilation) const {
    const double value = valueAt(p);
    if (!(value <= dilation)) return false;
    return value <= 0 || value <= dilation * length(gradientAt(p));
  }
  /// Outside, the distance to the box about it is a second bound, better for flat ellipsoids.
  [[nodiscard]] double clearance(DVec3 p) const override {
    const double value = valueAt(p);
    if (value <= 0) return value;
    const DVec3 out(std::max(std::fabs(p.x) - axes_.x, 0.0), std::max(std::fabs(p.y) - axes_.y, 0.0),
                    std::max(std::fabs(p.z) - axes_.z, 0.0));
    return std::max(value, length(out));
  }
  [[nodiscard]] DVec3 outwardNormal(DVec3 p) const override {
    const DVec3 g = gradientAt(p);
    const double l = length(g);
    return l > 0 ? g / l : DVec3(1, 0, 0);
  }
  void intersect(const Ray& ray, std::vector<RayInterval>& intervals) const override {
    appendConvexInterval([this](DVec3 p) { return ValueAndGradient{valueAt(p), gradientAt(p)}; }, measures(),
                         ray, intervals);
  }
  [[nodiscard]] double support(DVec3 direction) const override { return length(axes_ * direction); }

 protected:
  [[nodiscard]] SampleTable makeSamples(std::uint32_t count) const override {
    return SampleTable(sampleCharts(charts(), count));
  }

 private:
  // Scaled so that it changes by at most the distance that p moves.
  [[nodiscard]] double valueAt(DVec3 p) const { return (length(p / axes_) - 1) * least_; }
  [[nodiscard]] DVec3 gradientAt(DVec3 p) const {
    const DVec3 unit = p / axes_;
    const double l = length(unit);
    return l > 0 ? unit / axes_ * (least_ / l) : DVec3(0);
  }
  [[nodiscard]] std::vector<Chart> charts() const {
    // The unit sphere in rings about the axis that differs most from the others: a needle's along it, a
    // disc's around it.
    int order[3] = {0, 1, 2};
    std::sort(order, order + 3, [&](int a, int b) { return axes_[a] > axes_[b]; });
    const bool needle = axes_[order[1]] * axes_[order[1]] < axes_[order[0]] * axes_[order[2]];
    const int pole = needle ? order[0] : order[2];
    constexpr int kRings = 128, kColumns = 48;
    return {Chart::measured(kRings, kColumns, [axes = axes_, pole](double s, double t) {
      const SineCosine angle = sineCosineOfTurns(t);
      const double z = 2 * s - 1, rho = std::sqrt(std::max(0.0, 1 - z * z));
      DVec3 unit;
      unit[pole] = z;
      unit[(pole + 1) % 3] = rho * angle.cosine;
      unit[(pole + 2) % 3] = rho * angle.sine;
      return SurfaceSample{unit * axes, normalized(unit / axes)};
    })};
  }

  DVec3 axes_{1};
  double least_ = 1;
};

}  // namespace

const VolumeKind& ellipsoidKind() {
  static const VolumeKind kind{.name = "ellipsoid",
                               .summary = "an ellipsoid about the origin",
                               .parameters = {{.name = "x", .meaning = "semi-axis along x, > 0"},
                                              {.name = "y", .meaning = "semi-axis along y, > 0"},
                                              {.name = "z", .meaning = "semi-axis along z, > 0"}},
                               .make = [](const VolumeParameters& p) -> std::shared_ptr<const Volume> {
                                 return std::make_shared<Ellipsoid>(p);
                               },
                               .examples =
                                   [] {
                                     return std::vector<VolumeParameters>{{{{0.9f}, {0.6f}, {0.4f}}},
                                                                          {{{0.5f}, {0.5f}, {0.5f}}},
                                                                          {{{1.0f}, {0.7f}, {0.02f}}},
                                                                          {{{0.03f}, {0.02f}, {2.0f}}}};
                                   }};
  return kind;
}

}  // namespace restroke::implicit
