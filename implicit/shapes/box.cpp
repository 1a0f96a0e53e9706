// Box, with edges and corners rounded on demand. Side test: the signed distance; of a sharp box the greatest
// of the distances to its faces' planes.

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

class RoundedBox final : public VolumeOf<RoundedBox> {
 public:
  explicit RoundedBox(VolumeParameters parameters) : VolumeOf(boxKind(), std::move(parameters)) {
    DVec3 half;
    for (int i = 0; i < 3; ++i)
      half[i] = numberOf(kind(), this->parameters(), static_cast<std::size_t>(i), NumberRule::Positive);
    rounding_ = numberOf(kind(), this->parameters(), 3, NumberRule::NotNegative);
    const double least = std::min({half.x, half.y, half.z});
    if (rounding_ > least)
      throw InputError(
          fmt::format("a box has edges rounded by {} and a half side of {}; the rounding must be at "
                      "most the smallest half side",
                      rounding_, least));
    core_ = half - DVec3(rounding_);
    setMeasures({.center = {},
                 .radius = length(core_) + rounding_,
                 .area = areaOf(charts()),
                 .volume = volumeOfBox(),
                 .thickness = 2 * least});
  }

  [[nodiscard]] double clearance(DVec3 p) const override {
    const DVec3 q(std::fabs(p.x) - core_.x, std::fabs(p.y) - core_.y, std::fabs(p.z) - core_.z);
    const double most = std::max({q.x, q.y, q.z});
    if (most <= 0 || rounding_ == 0) return most - rounding_;
    return length(DVec3(std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0))) - rounding_;
  }
  [[nodiscard]] bool inside(DVec3 p, double dilation) const { return clearance(p) <= dilation; }
  [[nodiscard]] DVec3 outwardNormal(DVec3 p) const override { return gradientAt(p); }
  void intersect(const Ray& ray, std::vector<RayInterval>& intervals) const override {
    appendConvexInterval([this](DVec3 p) { return ValueAndGradient{clearance(p), gradientAt(p)}; },
                         measures(), ray, intervals);
  }
  [[nodiscard]] double support(DVec3 d) const override {
    return core_.x * std::fabs(d.x) + core_.y * std::fabs(d.y) + core_.z * std::fabs(d.z) + rounding_;
  }

 protected:
  [[nodiscard]] SampleTable makeSamples(std::uint32_t count) const override {
    return SampleTable(sampleCharts(charts(), count));
  }

 private:
  // Core, plates on its faces, edges, corners.
  [[nodiscard]] double volumeOfBox() const {
    const double x = core_.x, y = core_.y, z = core_.z, r = rounding_, pi = 3.141592653589793;
    return 8 * x * y * z + 8 * r * (x * y + y * z + z * x) + 2 * pi * r * r * (x + y + z) +
           4 * pi / 3 * r * r * r;
  }
  [[nodiscard]] DVec3 gradientAt(DVec3 p) const {
    const DVec3 sign(p.x < 0 ? -1 : 1, p.y < 0 ? -1 : 1, p.z < 0 ? -1 : 1);
    const DVec3 q(std::fabs(p.x) - core_.x, std::fabs(p.y) - core_.y, std::fabs(p.z) - core_.z);
    const double most = std::max({q.x, q.y, q.z});
    if (most <= 0 || rounding_ == 0) {
      const int axis = q.x == most ? 0 : q.y == most ? 1 : 2;
      DVec3 g(0);
      g[axis] = sign[axis];
      return g;
    }
    return sign * normalized(DVec3(std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)));
  }
  // Six faces, and where it is rounded twelve quarter cylinders and eight eighths of a sphere.
  [[nodiscard]] std::vector<Chart> charts() const {
    const double halfPi = 1.5707963267948966;
    std::vector<Chart> charts;
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3, c = (a + 2) % 3;
      for (const double side : {-1.0, 1.0})
        charts.push_back(Chart::uniform(4 * core_[b] * core_[c], [=, this](double s, double t) {
          SurfaceSample p;
          p.position[a] = side * (core_[a] + rounding_);
          p.position[b] = (2 * s - 1) * core_[b];
          p.position[c] = (2 * t - 1) * core_[c];
          p.normal = DVec3(0);
          p.normal[a] = side;
          return p;
        }));
      if (rounding_ == 0) continue;
      for (int quarter = 0; quarter < 4; ++quarter)  // edges along a
        charts.push_back(Chart::uniform(2 * core_[a] * halfPi * rounding_, [=, this](double s, double t) {
          const SineCosine angle = sineCosineOfTurns((quarter + t) / 4);
          SurfaceSample p;
          p.normal[a] = 0;
          p.normal[b] = angle.cosine;
          p.normal[c] = angle.sine;
          p.position = rounding_ * p.normal;
          p.position[a] = (2 * s - 1) * core_[a];
          p.position[b] += quarter == 0 || quarter == 3 ? core_[b] : -core_[b];
          p.position[c] += quarter < 2 ? core_[c] : -core_[c];
          return p;
        }));
    }
    if (rounding_ == 0) return charts;
    for (int quarter = 0; quarter < 4; ++quarter)
      for (const double up : {-1.0, 1.0})
        charts.push_back(Chart::uniform(halfPi * rounding_ * rounding_, [=, this](double s, double t) {
          const SineCosine angle = sineCosineOfTurns((quarter + t) / 4);
          const double rho = std::sqrt(std::max(0.0, 1 - s * s));
          const DVec3 n(rho * angle.cosine, rho * angle.sine, up * s);
          const DVec3 corner(quarter == 0 || quarter == 3 ? core_.x : -core_.x,
                             quarter < 2 ? core_.y : -core_.y, up * core_.z);
          return SurfaceSample{corner + rounding_ * n, n};
        }));
    return charts;
  }

  DVec3 core_{1};  // half sides without the rounding
  double rounding_ = 0;
};

}  // namespace

const VolumeKind& boxKind() {
  static const VolumeKind kind{
      .name = "box",
      .summary = "a box about the origin, its edges along the axes",
      .parameters = {{.name = "x", .meaning = "half side along x, > 0"},
                     {.name = "y", .meaning = "half side along y, > 0"},
                     {.name = "z", .meaning = "half side along z, > 0"},
                     {.name = "rounding",
                      .meaning = "radius of the edges, 0 (sharp) to the smallest half side",
                      .optional = true}},
      .make = [](const VolumeParameters& p) -> std::shared_ptr<const Volume> {
        return std::make_shared<RoundedBox>(p);
      },
      .examples =
          [] {
            return std::vector<VolumeParameters>{{{{0.6f}, {0.5f}, {0.4f}, {0.1f}}},
                                                 {{{0.6f}, {0.5f}, {0.4f}, {0.0f}}},
                                                 {{{1.0f}, {0.8f}, {0.01f}, {0.0f}}},
                                                 {{{0.5f}, {0.5f}, {0.5f}, {0.5f}}},
                                                 {{{2.0f}, {0.02f}, {0.03f}, {0.005f}}}};
          }};
  return kind;
}

}  // namespace restroke::implicit
