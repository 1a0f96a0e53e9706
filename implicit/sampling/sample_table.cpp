#include "implicit/sampling/sample_table.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "implicit/errors.h"

namespace restroke::implicit {

namespace {

struct Place {
  float x, y, z;
  std::uint32_t index;
};

// Sorts so that aligned runs of 16, 256, 4096, ... places are compact: halves at such multiples, across the
// longest axis.
void makeCompact(Place* first, std::size_t n) {
  if (n <= kPatch) return;
  std::size_t block = kPatch;
  while (block * kPatch < n) block *= kPatch;
  const std::size_t blocks = (n + block - 1) / block;
  const std::size_t left = (blocks + 1) / 2 * block;
  float lo[3] = {first->x, first->y, first->z}, hi[3] = {first->x, first->y, first->z};
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
  const auto key = [axis](const Place& p) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; };
  // Which places go left is unique, because the index breaks ties; the order within a half does not matter
  // until the half is a patch, and patches are sorted at the end.
  std::nth_element(first, first + left, first + n, [&](const Place& a, const Place& b) {
    const float ka = key(a), kb = key(b);
    return ka < kb || (ka == kb && a.index < b.index);
  });
  makeCompact(first, left);
  makeCompact(first + left, n - left);
}

}  // namespace

SampleTable::SampleTable(std::span<const SurfaceSample> samples) {
  std::vector<Vec3> positions(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) positions[i] = Vec3(samples[i].position);
  std::vector<std::uint32_t> order;
  arrange(positions, order);
  nx_.resize(order.size());
  ny_.resize(order.size());
  nz_.resize(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Vec3 n(samples[order[i]].normal);
    nx_[i] = n.x;
    ny_[i] = n.y;
    nz_[i] = n.z;
  }
  makeTree();
}

SampleTable::SampleTable(Columns samples)
    : x_(std::move(samples.x)),
      y_(std::move(samples.y)),
      z_(std::move(samples.z)),
      nx_(std::move(samples.nx)),
      ny_(std::move(samples.ny)),
      nz_(std::move(samples.nz)) {
  RESTROKE_CHECK_EQ(x_.size() % kPatch, std::size_t{0});
  RESTROKE_CHECK_LE(std::size_t{1}, x_.size());
  makeTree();
}

SampleTable SampleTable::ofDirections(std::span<const Vec3> directions) {
  SampleTable table;
  std::vector<std::uint32_t> order;
  table.arrange(directions, order);
  table.makeTree();
  return table;
}

void SampleTable::arrange(std::span<const Vec3> positions, std::vector<std::uint32_t>& order) {
  const std::size_t count = positions.size();
  RESTROKE_CHECK_EQ(count % kPatch, std::size_t{0});
  RESTROKE_CHECK_LE(std::size_t{1}, count);
  std::vector<Place> places(count);
  for (std::size_t i = 0; i < count; ++i)
    places[i] = {positions[i].x, positions[i].y, positions[i].z, static_cast<std::uint32_t>(i)};
  makeCompact(places.data(), count);
  x_.resize(count);
  y_.resize(count);
  z_.resize(count);
  order.resize(count);
  for (std::size_t p = 0; p < count; p += kPatch) {
    std::sort(places.begin() + static_cast<std::ptrdiff_t>(p),
              places.begin() + static_cast<std::ptrdiff_t>(p + kPatch),
              [](const Place& a, const Place& b) { return a.index < b.index; });
    for (std::size_t i = p; i < p + kPatch; ++i) {
      x_[i] = places[i].x;
      y_[i] = places[i].y;
      z_[i] = places[i].z;
      order[i] = places[i].index;
    }
  }
}

// Both in four interleaved parts, which compilers can compute side by side.
DVec3 SampleTable::meanOf(std::size_t first, std::size_t last) const {
  float x[4] = {}, y[4] = {}, z[4] = {};
  for (std::size_t i = first; i < last; i += 4)
    for (std::size_t j = 0; j < 4; ++j) {
      x[j] += x_[i + j];
      y[j] += y_[i + j];
      z[j] += z_[i + j];
    }
  const auto sum = [](const float* p) { return static_cast<double>((p[0] + p[1]) + (p[2] + p[3])); };
  return DVec3(sum(x), sum(y), sum(z)) / static_cast<double>(last - first);
}

float SampleTable::farthestFrom(Point center, std::size_t first, std::size_t last) const {
  float squared[4] = {};
  for (std::size_t i = first; i < last; i += 4)
    for (std::size_t j = 0; j < 4; ++j) {
      const float x = x_[i + j] - center.x, y = y_[i + j] - center.y, z = z_[i + j] - center.z;
      const float d = x * x + y * y + z * z;
      squared[j] = squared[j] < d ? d : squared[j];
    }
  return std::sqrt(std::max({squared[0], squared[1], squared[2], squared[3]}));
}

void SampleTable::makeTree() {
  const std::size_t count = x_.size();
  float reach = 0;
  for (std::size_t i = 0; i < count; ++i)
    reach = std::max({reach, std::fabs(x_[i]), std::fabs(y_[i]), std::fabs(z_[i])});
  // Bounding spheres: about the mean of the run's positions.
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
      const DVec3 mean = meanOf(first, last);
      b.x[k] = static_cast<float>(mean.x);
      b.y[k] = static_cast<float>(mean.y);
      b.z[k] = static_cast<float>(mean.z);
      // Widened by more than float32 takes from the distance.
      b.radius[k] = farthestFrom({b.x[k], b.y[k], b.z[k]}, first, last) * 1.00001f + 1e-6f * reach;
    }
    bounds_.push_back(std::move(b));
    if (nodes <= kPatch) break;
  }
  RESTROKE_CHECK_LE(bounds_.size(), static_cast<std::size_t>(PatchTree::kMaxLevels));
  tree_.x = x_.data();
  tree_.y = y_.data();
  tree_.z = z_.data();
  tree_.nx = nx_.empty() ? x_.data() : nx_.data();
  tree_.ny = ny_.empty() ? y_.data() : ny_.data();
  tree_.nz = nz_.empty() ? z_.data() : nz_.data();
  tree_.levels = static_cast<int>(bounds_.size());
  std::size_t run = kPatch;
  for (std::size_t l = 0; l < bounds_.size(); ++l, run *= kPatch)
    tree_.level[l] = {bounds_[l].x.data(), bounds_[l].y.data(), bounds_[l].z.data(), bounds_[l].radius.data(),
                      static_cast<std::uint32_t>((count + run - 1) / run)};
}

std::size_t SampleTable::bytes() const {
  std::size_t bytes = sizeof(*this) + bounds_.capacity() * sizeof(Bounds) +
                      3 * (x_.capacity() + nx_.capacity()) * sizeof(float);
  for (const Bounds& b : bounds_) bytes += 4 * b.x.capacity() * sizeof(float);
  return bytes;
}

std::uint32_t sampleCountFor(double area, double density) {
  const auto n = static_cast<std::uint32_t>(std::min(area * density, 2.0 * kMaxSamples));
  std::uint32_t step = kPatch;
  while (n / step >= 64) step *= 2;
  return std::max<std::uint32_t>(kPatch, (n + step / 2) / step * step);
}

}  // namespace restroke::implicit
