#include "implicit/sampling/poisson.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "implicit/errors.h"

namespace restroke::implicit {

namespace {

// Radii in units of the root of the area per sample. The first is for strips, whose few samples lie far
// apart.
constexpr double kFirstRadius = 4.0, kLastRadius = 0.4;
constexpr double kShrink = 0.9;     // from one round to the next
constexpr double kDarts = 8;        // a round, for each disc of the round's radius that fits the area
constexpr double kSameSide = -0.5;  // least cosine between normals of samples that keep their distance

// Accepted samples in cells of the round's radius, hashed.
class Accepted {
 public:
  explicit Accepted(std::uint32_t count) {
    std::size_t size = 64;
    while (size < 2 * std::size_t{count}) size *= 2;
    heads_.resize(size);
    samples_.reserve(count);
    next_.reserve(count);
  }
  void setRadius(double radius) {
    radius_ = radius;
    std::fill(heads_.begin(), heads_.end(), kNone);
    next_.clear();
    for (const SurfaceSample& s : samples_) link(s.position);
  }
  [[nodiscard]] bool isFree(const SurfaceSample& s) const {
    const std::int64_t x = index(s.position.x), y = index(s.position.y), z = index(s.position.z);
    for (std::int64_t i = x - 1; i <= x + 1; ++i)
      for (std::int64_t j = y - 1; j <= y + 1; ++j)
        for (std::int64_t k = z - 1; k <= z + 1; ++k)
          for (std::uint32_t n = heads_[slot(i, j, k)]; n != kNone; n = next_[n]) {
            const DVec3 d = samples_[n].position - s.position;
            if (dot(d, d) < radius_ * radius_ && dot(samples_[n].normal, s.normal) > kSameSide) return false;
          }
    return true;
  }
  void add(const SurfaceSample& s) {
    link(s.position);
    samples_.push_back(s);
  }
  [[nodiscard]] std::vector<SurfaceSample>& samples() { return samples_; }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  void link(DVec3 p) {
    std::uint32_t& head = heads_[slot(index(p.x), index(p.y), index(p.z))];
    const auto number = static_cast<std::uint32_t>(next_.size());
    next_.push_back(head);
    head = number;
  }
  [[nodiscard]] std::int64_t index(double a) const {
    return static_cast<std::int64_t>(std::floor(a / radius_));
  }
  [[nodiscard]] std::size_t slot(std::int64_t x, std::int64_t y, std::int64_t z) const {
    const std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ull ^
                            static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4Full ^
                            static_cast<std::uint64_t>(z) * 0x165667B19E3779F9ull;
    return static_cast<std::size_t>((h ^ h >> 32) & (heads_.size() - 1));
  }

  double radius_ = 1;
  std::vector<SurfaceSample> samples_;
  std::vector<std::uint32_t> heads_, next_;
};

}  // namespace

std::vector<SurfaceSample> samplePoisson(std::span<const SurfaceTriangle> triangles, std::uint32_t count) {
  std::vector<double> areas;  // up to the end of each
  areas.reserve(triangles.size());
  std::vector<double> regions;  // area of each
  double area = 0;
  for (const SurfaceTriangle& t : triangles) {
    const double own = length(cross(t.b - t.a, t.c - t.a)) / 2;
    area += own;
    areas.push_back(area);
    if (t.region >= regions.size()) regions.resize(t.region + 1, 0);
    regions[t.region] += own;
  }
  RESTROKE_CHECK_LT(0.0, area);
  // How many each region is still to get: rounded so that all together are `count`.
  std::vector<std::uint32_t> wanted(regions.size());
  double before = 0;
  std::uint32_t given = 0;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    before += regions[r];
    const auto all = r + 1 == regions.size()
                         ? count
                         : std::min(static_cast<std::uint32_t>(before / area * count + 0.5), count);
    wanted[r] = all - given;
    given = all;
  }

  // Additive recurrences by powers of the plastic number's relative in three dimensions, the real root of
  // x^4 = x + 1 (Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018).
  constexpr double kStep[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
  double u[3] = {0.5, 0.5, 0.5};
  const auto throwDart = [&] {
    for (int i = 0; i < 3; ++i) {
      u[i] += kStep[i];
      if (u[i] >= 1) u[i] -= 1;
    }
  };
  const auto landOn = [&](const SurfaceTriangle& t) {
    const double root = std::sqrt(u[1]);  // evenly over the triangle
    return SurfaceSample{t.a + root * ((t.b - t.a) + u[2] * (t.c - t.b)), t.normal};
  };
  const double spacing = std::sqrt(area / count);
  Accepted accepted(count);
  for (double radius = kFirstRadius; radius > kLastRadius; radius *= kShrink) {
    accepted.setRadius(radius * spacing);
    const auto darts = static_cast<std::uint32_t>(kDarts * count / (radius * radius)) + 64;
    for (std::uint32_t dart = 0; dart < darts; ++dart) {
      throwDart();
      const auto it = std::upper_bound(areas.begin(), areas.end(), u[0] * area);
      const SurfaceTriangle& t =
          triangles[std::min(static_cast<std::size_t>(it - areas.begin()), areas.size() - 1)];
      if (wanted[t.region] == 0) continue;
      const SurfaceSample sample = landOn(t);
      if (!accepted.isFree(sample)) continue;
      accepted.add(sample);
      --wanted[t.region];
      if (accepted.samples().size() == count) return std::move(accepted.samples());
    }
  }
  // Regions so small or so crowded that no dart found room: their share lands on their triangles in turn.
  while (accepted.samples().size() < count)
    for (const SurfaceTriangle& t : triangles) {
      if (wanted[t.region] == 0 || !(length(cross(t.b - t.a, t.c - t.a)) > 0)) continue;
      throwDart();
      accepted.add(landOn(t));
      --wanted[t.region];
    }
  return std::move(accepted.samples());
}

}  // namespace restroke::implicit
