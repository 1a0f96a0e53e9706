// Superellipsoid (Barr, "Superquadrics and angle-preserving transformations", IEEE Computer Graphics and
// Applications 1, 1981): ((|x/a|^(2/e2) + |y/b|^(2/e2))^(e2/e1) + |z/c|^(2/e1))^(e1/2) <= 1. With exponents
// of at most 2 the left side is a norm, so the solid is convex. Its powers are our own (geometry/powers.h).

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

constexpr double kLeastExponent = 0.1, kGreatestExponent = 2;

class Superellipsoid final : public VolumeOf<Superellipsoid> {
 public:
  explicit Superellipsoid(VolumeParameters parameters)
      : VolumeOf(superellipsoidKind(), std::move(parameters)) {
    for (int i = 0; i < 3; ++i)
      axes_[i] = numberOf(kind(), this->parameters(), static_cast<std::size_t>(i), NumberRule::Positive);
    double exponents[2];
    for (std::size_t i = 0; i < 2; ++i) {
      const double e = exponents[i] = numberOf(kind(), this->parameters(), 3 + i, NumberRule::Positive);
      if (!(static_cast<float>(e) >= static_cast<float>(kLeastExponent) && e <= kGreatestExponent))
        throw InputError(fmt::format("a superellipsoid has the exponent {}; it must be from {} to {}", e,
                                     kLeastExponent, kGreatestExponent));
    }
    up_ = 2 / exponents[0];
    around_ = 2 / exponents[1];
    // The ball within: the ellipsoid is inside when no exponent passes 1, and always the octahedron.
    const double least = std::min({axes_.x, axes_.y, axes_.z});
    const DVec3 inverse = 1.0 / axes_;
    round_ = up_ >= 2 && around_ >= 2;
    inner_ = round_ ? least : 1 / length(inverse);
    // The ball around: the ellipsoid is outside when no exponent falls below 1, and always the box.
    const double outer = up_ <= 2 && around_ <= 2 ? std::max({axes_.x, axes_.y, axes_.z}) : length(axes_);
    // Jaklic, Leonardis, Solina, "Segmentation and recovery of superquadrics", 2000, section 2.4.
    const auto beta = [](double a, double b) { return std::tgamma(a) * std::tgamma(b) / std::tgamma(a + b); };
    const double volume = 2 * axes_.x * axes_.y * axes_.z * exponents[0] * exponents[1] *
                          beta(exponents[0] / 2 + 1, exponents[0]) * beta(exponents[1] / 2, exponents[1] / 2);
    setMeasures(
        {.center = {}, .radius = outer, .area = areaOf(charts()), .volume = volume, .thickness = 2 * inner_});
  }

  [[nodiscard]] bool inside(DVec3 p, double dilation) const {
    const DVec3 q(std::fabs(p.x / axes_.x), std::fabs(p.y / axes_.y), std::fabs(p.z / axes_.z));
    // Most points are decided by the box around it and the solid within, without powers.
    const double beyond = 1 + dilation / inner_;
    if (q.x > beyond || q.y > beyond || q.z > beyond) return false;
    if (within(q) < 1 - 1e-9) return true;
    const double total = totalAt(q);
    if (total <= 1) return true;
    if (dilation == 0) return false;
    // The gradient is at most 1, so that the norm is at most 1 + d where the next test says yes, and the
    // total at most (1 + d)^up <= e^(up d).
    const double far = up_ * dilation / inner_;
    if (far < 1 && total > 1 + far * (1 + far) * (1 + 1e-6) + 1e-9) return false;
    const ValueAndGradient at = valueAt(p);
    return at.value <= dilation * length(at.gradient);
  }
  /// Outside, the distance to the box about it is a second bound.
  [[nodiscard]] double clearance(DVec3 p) const override {
    const DVec3 out(std::max(std::fabs(p.x) - axes_.x, 0.0), std::max(std::fabs(p.y) - axes_.y, 0.0),
                    std::max(std::fabs(p.z) - axes_.z, 0.0));
    const double box = length(out);
    if (box > inner_ / 2) return box;
    const DVec3 q(std::fabs(p.x / axes_.x), std::fabs(p.y / axes_.y), std::fabs(p.z / axes_.z));
    if (const double deep = within(q); deep < 0.5) return (deep - 1) * inner_;
    return std::max((powerOf(totalAt(q), 1 / up_) - 1) * inner_, box > 0 ? box : -inner_);
  }
  [[nodiscard]] DVec3 outwardNormal(DVec3 p) const override {
    const DVec3 g = valueAt(p).gradient;
    const double l = length(g);
    return l > 0 ? g / l : DVec3(0, 0, p.z < 0 ? -1 : 1);
  }
  void intersect(const Ray& ray, std::vector<RayInterval>& intervals) const override {
    appendConvexInterval([this](DVec3 p) { return valueAt(p); }, measures(), ray, intervals);
  }
  /// The dual norm.
  [[nodiscard]] double support(DVec3 d) const override {
    const DVec3 q = axes_ * d;
    return dual(dual(q.x, q.y, around_), q.z, up_);
  }

 protected:
  [[nodiscard]] SampleTable makeSamples(std::uint32_t count) const override {
    return SampleTable(sampleCharts(charts(), count));
  }

 private:
  static double dual(double a, double b, double p) {
    a = std::fabs(a);
    b = std::fabs(b);
    const double most = std::max(a, b);
    if (p == 1 || most == 0) return most;
    const double q =
        std::min(p / (p - 1), 64.0);  // beyond, the norm is the greater to 1 %, and larger: a bound
    return most * powerOf(powerOf(a / most, q) + powerOf(b / most, q), 1 / q);
  }
  // A norm that is greater everywhere: of the ellipsoid or the octahedron within.
  [[nodiscard]] double within(DVec3 q) const { return round_ ? length(q) : q.x + q.y + q.z; }
  // The norm's power `up_` at a point in units of the axes, none of them negative.
  [[nodiscard]] double totalAt(DVec3 q) const {
    return powerOf(powerOf(q.x, around_) + powerOf(q.y, around_), up_ / around_) + powerOf(q.z, up_);
  }
  [[nodiscard]] ValueAndGradient valueAt(DVec3 p) const {
    const double x = std::fabs(p.x / axes_.x), y = std::fabs(p.y / axes_.y), z = std::fabs(p.z / axes_.z);
    const double round = powerOf(x, around_) + powerOf(y, around_);
    const double total = powerOf(round, up_ / around_) + powerOf(z, up_);
    const double norm = powerOf(total, 1 / up_);
    ValueAndGradient out{(norm - 1) * inner_, DVec3(0)};
    if (total == 0) return out;
    const double outer = inner_ * norm / total;
    const double ring = round > 0 ? outer * powerOf(round, up_ / around_ - 1) : 0;
    if (x > 0) out.gradient.x = ring * powerOf(x, around_ - 1) / (p.x < 0 ? -axes_.x : axes_.x);
    if (y > 0) out.gradient.y = ring * powerOf(y, around_ - 1) / (p.y < 0 ? -axes_.y : axes_.y);
    if (z > 0) out.gradient.z = outer * powerOf(z, up_ - 1) / (p.z < 0 ? -axes_.z : axes_.z);
    return out;
  }
  [[nodiscard]] std::vector<Chart> charts() const {
    constexpr int kCells = 48;
    return starShaped(kCells, [this](DVec3 direction) {
      const DVec3 p = direction * axes_;
      const DVec3 surface =
          p /
          powerOf(totalAt({std::fabs(direction.x), std::fabs(direction.y), std::fabs(direction.z)}), 1 / up_);
      return SurfaceSample{surface, outwardNormal(surface)};
    });
  }

  DVec3 axes_{1};
  double up_ = 2, around_ = 2;  // the powers 2 / e1, 2 / e2: 1 to 20
  double inner_ = 1;            // radius of a ball within
  bool round_ = true;           // the ellipsoid of the axes is within
};

}  // namespace

const VolumeKind& superellipsoidKind() {
  static const VolumeKind kind{
      .name = "superellipsoid",
      .summary = "between an octahedron, an ellipsoid and a box, about the origin",
      .parameters = {{.name = "x", .meaning = "semi-axis along x, > 0"},
                     {.name = "y", .meaning = "semi-axis along y, > 0"},
                     {.name = "z", .meaning = "semi-axis along z, > 0"},
                     {.name = "e1",
                      .meaning = "exponent of the outline seen from the side, 0.1 (square) to 2"},
                     {.name = "e2", .meaning = "exponent of the outline seen along z, 0.1 (square) to 2"}},
      .make = [](const VolumeParameters& p) -> std::shared_ptr<const Volume> {
        return std::make_shared<Superellipsoid>(p);
      },
      .examples =
          [] {
            return std::vector<VolumeParameters>{{{{0.6f}, {0.6f}, {0.6f}, {0.4f}, {0.4f}}},
                                                 {{{0.7f}, {0.5f}, {0.6f}, {1.0f}, {1.0f}}},
                                                 {{{0.7f}, {0.7f}, {0.7f}, {2.0f}, {2.0f}}},
                                                 {{{1.0f}, {0.6f}, {0.03f}, {0.1f}, {1.5f}}},
                                                 {{{0.5f}, {0.5f}, {0.8f}, {1.7f}, {0.3f}}}};
          }};
  return kind;
}

}  // namespace restroke::implicit
