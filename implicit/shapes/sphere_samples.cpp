#include "implicit/shapes/sphere_samples.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

namespace restroke::implicit {

namespace {

// The lattice in its own order. Angles advance by the golden angle, as products of unit complex numbers;
// double leaves an error of at most n * 2^-52, far below the float32 that is kept.
std::vector<Vec3> fibonacciLattice(std::uint32_t n) {
  const double cosGolden = -0.7373688780783199, sinGolden = 0.6754902942615236;
  std::vector<Vec3> out(n);
  double c = 1, s = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / n;
    const double rho = std::sqrt(1.0 - z * z);
    out[i] = {static_cast<float>(rho * c), static_cast<float>(rho * s), static_cast<float>(z)};
    const double next = c * cosGolden - s * sinGolden;
    s = s * cosGolden + c * sinGolden;
    c = next;
  }
  return out;
}

struct Tables {
  std::mutex mutex;
  std::map<std::uint32_t, std::unique_ptr<SampleTable>> byCount;
};

Tables& tables() {
  static Tables t;
  return t;
}

}  // namespace

const SampleTable& sphereSamples(std::uint32_t count) {
  Tables& t = tables();
  const std::lock_guard lock(t.mutex);
  std::unique_ptr<SampleTable>& table = t.byCount[count];
  if (!table) table = std::make_unique<SampleTable>(SampleTable::ofDirections(fibonacciLattice(count)));
  return *table;
}

std::size_t bytesOfSphereSamples() {
  Tables& t = tables();
  const std::lock_guard lock(t.mutex);
  std::size_t bytes = 0;
  for (const auto& [count, table] : t.byCount) bytes += table->bytes();
  return bytes;
}

SphereTolerance toleranceOf(const Sphere& s) {
  const float m =
      std::max(std::max(std::fabs(s.center.x), std::fabs(s.center.y)), std::fabs(s.center.z)) + s.radius;
  return {s.radius + m * 0x1p-18f, s.radius + m * 0x1p-19f, m * 0x1p-17f};
}

}  // namespace restroke::implicit
