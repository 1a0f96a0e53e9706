#include "implicit/shapes/sphere_samples.h"

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>

#include "implicit/errors.h"

namespace restroke::implicit {

std::uint32_t sampleCount(const Sphere& s, float density) {
  const double fourPi = 12.566370614359172;
  const double wanted = static_cast<double>(density) * fourPi * static_cast<double>(s.radius) * s.radius;
  if (!(wanted <= kMaxSamples * 0.98))
    throw InputError(fmt::format(
        "a sphere of radius {} at density {} would have {:.3g} samples; a primitive may have {} at most",
        s.radius, density, wanted, kMaxSamples));
  const auto n = static_cast<std::uint32_t>(wanted);
  std::uint32_t step = kPatch;
  while (n / step >= 64) step *= 2;
  return std::max<std::uint32_t>(kPatch, (n + step / 2) / step * step);
}

namespace {

struct Direction {
  float x, y, z;
  std::uint32_t index;
};

// The lattice in its own order. Angles advance by the golden angle, as products of unit complex numbers;
// double leaves an error of at most n * 2^-52, far below the float32 that is kept.
std::vector<Direction> fibonacciLattice(std::uint32_t n) {
  const double cosGolden = -0.7373688780783199, sinGolden = 0.6754902942615236;
  std::vector<Direction> out(n);
  double c = 1, s = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / n;
    const double rho = std::sqrt(1.0 - z * z);
    out[i] = {static_cast<float>(rho * c), static_cast<float>(rho * s), static_cast<float>(z), i};
    const double next = c * cosGolden - s * sinGolden;
    s = s * cosGolden + c * sinGolden;
    c = next;
  }
  return out;
}

// Sorts so that aligned runs of 16, 256, 4096, ... directions are compact: halves at such multiples, across
// the longest axis.
void makeCompact(Direction* first, std::size_t n) {
  if (n <= kPatch) return;
  std::size_t block = kPatch;
  while (block * kPatch < n) block *= kPatch;
  const std::size_t blocks = (n + block - 1) / block;
  const std::size_t left = (blocks + 1) / 2 * block;
  float lo[3] = {2, 2, 2}, hi[3] = {-2, -2, -2};
  for (std::size_t i = 0; i < n; ++i) {
    const float v[3] = {first[i].x, first[i].y, first[i].z};
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], v[a]);
      hi[a] = std::max(hi[a], v[a]);
    }
  }
  int axis = 0;
  for (int a = 1; a < 3; ++a)
    if (hi[a] - lo[a] > hi[axis] - lo[axis]) axis = a;
  const auto key = [axis](const Direction& d) { return axis == 0 ? d.x : axis == 1 ? d.y : d.z; };
  // Which directions go left is unique, because the index breaks ties; the order within a half does not
  // matter until the half is a patch, and patches are sorted at the end.
  std::nth_element(first, first + left, first + n, [&](const Direction& a, const Direction& b) {
    const float ka = key(a), kb = key(b);
    return ka < kb || (ka == kb && a.index < b.index);
  });
  makeCompact(first, left);
  makeCompact(first + left, n - left);
}

}  // namespace

SphereSamples::SphereSamples(std::uint32_t count) {
  RESTROKE_CHECK_EQ(count % kPatch, std::size_t{0});
  std::vector<Direction> lattice = fibonacciLattice(count);
  makeCompact(lattice.data(), lattice.size());
  x_.resize(count);
  y_.resize(count);
  z_.resize(count);
  for (std::size_t p = 0; p < count; p += kPatch) {
    std::sort(lattice.begin() + static_cast<std::ptrdiff_t>(p),
              lattice.begin() + static_cast<std::ptrdiff_t>(p + kPatch),
              [](const Direction& a, const Direction& b) { return a.index < b.index; });
    for (std::size_t i = p; i < p + kPatch; ++i) {
      x_[i] = lattice[i].x;
      y_[i] = lattice[i].y;
      z_[i] = lattice[i].z;
    }
  }
  // Bounding spheres: about the mean of the run's directions.
  for (std::size_t run = kPatch;; run *= kPatch) {
    const std::size_t nodes = (count + run - 1) / run;
    const std::size_t padded = (nodes + kPatch - 1) / kPatch * kPatch;
    Bounds b;
    b.x.assign(padded, kNowhere);
    b.y.assign(padded, 0);
    b.z.assign(padded, 0);
    b.radius.assign(padded, 0);
    for (std::size_t k = 0; k < nodes; ++k) {
      const std::size_t first = k * run, last = std::min<std::size_t>(first + run, count);
      DVec3 mean(0);
      for (std::size_t i = first; i < last; ++i) mean += DVec3(direction(static_cast<std::uint32_t>(i)));
      mean /= static_cast<double>(last - first);
      b.x[k] = static_cast<float>(mean.x);
      b.y[k] = static_cast<float>(mean.y);
      b.z[k] = static_cast<float>(mean.z);
      double farthest = 0;
      for (std::size_t i = first; i < last; ++i)
        farthest = std::max(farthest, length(DVec3(direction(static_cast<std::uint32_t>(i))) -
                                             DVec3(b.x[k], b.y[k], b.z[k])));
      b.radius[k] = static_cast<float>(farthest * 1.00001 + 1e-6);
    }
    bounds_.push_back(std::move(b));
    if (nodes <= kPatch) break;
  }
  RESTROKE_CHECK_LE(bounds_.size(), static_cast<std::size_t>(PatchTree::kMaxLevels));
  tree_.dx = x_.data();
  tree_.dy = y_.data();
  tree_.dz = z_.data();
  tree_.levels = static_cast<int>(bounds_.size());
  std::size_t run = kPatch;
  for (std::size_t l = 0; l < bounds_.size(); ++l, run *= kPatch)
    tree_.level[l] = {bounds_[l].x.data(), bounds_[l].y.data(), bounds_[l].z.data(), bounds_[l].radius.data(),
                      static_cast<std::uint32_t>((count + run - 1) / run)};
}

std::size_t SphereSamples::bytes() const {
  std::size_t bytes = sizeof(*this) + bounds_.capacity() * sizeof(Bounds) + 3 * x_.capacity() * sizeof(float);
  for (const Bounds& b : bounds_) bytes += 4 * b.x.capacity() * sizeof(float);
  return bytes;
}

namespace {

struct Tables {
  std::mutex mutex;
  std::map<std::uint32_t, std::unique_ptr<SphereSamples>> byCount;
};

Tables& tables() {
  static Tables t;
  return t;
}

}  // namespace

const SphereSamples& SphereSamples::ofCount(std::uint32_t count) {
  Tables& t = tables();
  const std::lock_guard lock(t.mutex);
  std::unique_ptr<SphereSamples>& table = t.byCount[count];
  if (!table) table.reset(new SphereSamples(count));
  return *table;
}

std::size_t SphereSamples::bytesOfAll() {
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

PatchedBall patchedBall(const Sphere& s, bool positive, const SphereSamples& samples) {
  const SphereTolerance t = toleranceOf(s);
  return {samples.tree(), s.center.x, s.center.y, s.center.z, s.radius, t.keepRadius, t.slack, positive};
}

}  // namespace restroke::implicit
