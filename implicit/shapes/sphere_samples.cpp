#include "implicit/shapes/sphere_samples.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <memory>
#include <mutex>
#include <vector>

#include "implicit/errors.h"

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

// A table for each count that sampleCountFor gives: 64 to an octave.
struct Tables {
  std::mutex mutex;  // held by who makes one
  std::array<std::unique_ptr<const SampleTable>, 64 * 20> made;
  std::array<std::atomic<const SampleTable*>, 64 * 20> byCount{};
};

constinit Tables tables;

std::size_t placeOf(std::uint32_t count) {
  const std::uint32_t patches = count / static_cast<std::uint32_t>(kPatch);
  const int octave = std::max(0, static_cast<int>(std::bit_width(patches)) - 6);
  return 64 * static_cast<std::size_t>(octave) + (patches >> octave);
}

}  // namespace

const SampleTable& sphereSamples(std::uint32_t count) {
  const std::size_t place = placeOf(count);
  if (const SampleTable* known = tables.byCount[place].load(std::memory_order_acquire)) return *known;
  const std::lock_guard lock(tables.mutex);
  if (!tables.made[place]) {
    RESTROKE_CHECK_EQ(count, sampleCountFor(count, 1));
    tables.made[place] = std::make_unique<SampleTable>(SampleTable::ofDirections(fibonacciLattice(count)));
    tables.byCount[place].store(tables.made[place].get(), std::memory_order_release);
  }
  return *tables.made[place];
}

std::size_t bytesOfSphereSamples() {
  const std::lock_guard lock(tables.mutex);
  std::size_t bytes = 0;
  for (const auto& table : tables.made)
    if (table) bytes += table->bytes();
  return bytes;
}

}  // namespace restroke::implicit
