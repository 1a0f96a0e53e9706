#include "experiments/scaling/layouts.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "experiments/random.h"
#include "implicit/errors.h"
#include "sculpt/document.h"
#include "sculpt/stroke_log.h"

namespace restroke::experiments {
namespace {

using implicit::Primitive;
using implicit::Sign;

// The paper's sculpture: 3,426 stamps on a unit sphere, and 280,000 samples of which are seen.
constexpr double kPi = 3.141592653589793;
constexpr double kStampsPerArea = 3426 / (4 * kPi);
constexpr double kBrush = 0.045;
// A little less than the shipped list's 18,400: at a million stamps the sphere of the sweep `detail` stays
// below kMaxSamples.
constexpr float kDensity = 17'600;

constexpr double kPebbleStamps = 1000;
// Between middles, in pebble radii: stamps of neighbours do not meet.
constexpr double kPebbleStep = 2.4;

// Brush of 100,000 stamps on a cap. On caps of half its size they lie four times as densely.
constexpr double kCrowdBrush = 0.005;
constexpr double kCrowdPrimitives = 100'000;
constexpr double kCrowdSamples = 128;
constexpr double kSpreadBrush = 0.15;
constexpr float kSpreadDensity = 1000;

/// The numbers of one stroke. Neighbouring strokes must not share a stretch of one sequence, which
/// SplitMix64's states k and k + 1 would.
Random randomOf(std::uint64_t seed, std::size_t stroke) {
  return Random(Random(seed ^ (std::uint64_t{stroke} * 0xD6E8FEB86659FD93u)).next());
}

/// Of even distribution on the unit sphere.
DVec3 direction(Random& random) {
  for (;;) {
    const DVec3 p{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
    const double square = dot(p, p);
    if (square > 0.01 && square <= 1) return p / std::sqrt(square);
  }
}

DVec3 tangent(DVec3 normal, DVec3 towards) {
  const DVec3 t = towards - normal * dot(normal, towards);
  const double size = std::sqrt(dot(t, t));
  if (size > 1e-6) return t / size;
  return tangent(normal, std::fabs(normal.x) < 0.5 ? DVec3{1, 0, 0} : DVec3{0, 1, 0});
}

/// A ball to draw on, and how.
struct Ground {
  DVec3 center{0};
  double radius = 1;
  double brush = kBrush;
  double cap = 2;  ///< chord on the unit ball from +z; what is drawn stays within it, 2 is everywhere
};

bool withinCap(DVec3 p, double cap) {
  return 2 - 2 * p.z <= cap * cap;
}

/// Evenly within the cap: on a sphere, area is height.
DVec3 startWithin(double cap, Random& random) {
  if (cap >= 2) return direction(random);
  const DVec3 around = direction(random);
  const double z = 1 - random.unit() * cap * cap / 2;
  return DVec3{0, 0, z} + tangent({0, 0, 1}, around) * std::sqrt(std::max(0.0, 1 - z * z));
}

/// A curved line of stamps. What would leave the cap turns back to its middle.
std::vector<Primitive> walk(const Ground& ground, Sign sign, Random& random) {
  std::vector<Primitive> stroke;
  stroke.reserve(kStrokeStamps);
  DVec3 p = startWithin(ground.cap, random), along = tangent(p, direction(random));
  const double step = kStampSpacing * ground.brush / ground.radius, bend = random.between(-1, 1) * 2 * step;
  for (std::size_t i = 0; i < kStrokeStamps; ++i) {
    const DVec3 at = ground.center + p * ground.radius;
    stroke.push_back({{Point(at), static_cast<float>(ground.brush)}, sign});
    DVec3 next = p + along * step;
    if (!withinCap(next / std::sqrt(dot(next, next)), ground.cap)) {
      along = tangent(p, DVec3{0, 0, 1} + direction(random) * 0.3 * ground.cap);
      next = p + along * step;
    }
    p = next / std::sqrt(dot(next, next));
    along = tangent(p, along + cross(p, along) * bend);
  }
  return stroke;
}

std::size_t strokesFor(std::size_t primitives) {
  return std::max<std::size_t>(2, (primitives + kStrokeStamps / 2) / kStrokeStamps);
}

/// One unit sphere with everything on it.
Layout sphereLayout(std::size_t primitives, double brush, double cap, std::uint64_t seed) {
  Layout layout;
  layout.bases = {{{Point(0), 1}, Sign::Positive}};
  layout.strokes = strokesFor(primitives);
  layout.stroke = [=](std::size_t k) {
    Random random = randomOf(seed, k);
    return walk({.brush = brush, .cap = cap}, k % 2 == 0 ? Sign::Positive : Sign::Negative, random);
  };
  return layout;
}

}  // namespace

Layout extentLayout(std::size_t primitives, std::uint64_t seed) {
  const double pebbleRadius = std::sqrt(kPebbleStamps / kStampsPerArea / (4 * kPi));
  const auto pebbles = std::max<std::size_t>(
      1, static_cast<std::size_t>(static_cast<double>(primitives) / kPebbleStamps + 0.5));
  const auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(pebbles)) - 1e-9));
  const std::size_t rows = (pebbles + columns - 1) / columns;
  const auto centerOf = [=](std::size_t pebble) {
    const double step = kPebbleStep * pebbleRadius;
    return DVec3{(static_cast<double>(pebble % columns) - static_cast<double>(columns - 1) / 2) * step,
                 (static_cast<double>(pebble / columns) - static_cast<double>(rows - 1) / 2) * step, 0};
  };
  // Coprime to the number of pebbles: each is visited once before any is again.
  auto jump = static_cast<std::size_t>(0.618 * static_cast<double>(pebbles)) + 1;
  while (std::gcd(jump, pebbles) != 1) ++jump;

  Layout layout;
  layout.density = kDensity;
  layout.view = {0, 0.8f, -1};
  if (pebbles > 3) layout.fill = 1.45f;  // a tray is flat: its sphere stands over it
  layout.strokes = strokesFor(primitives);
  layout.bases.reserve(pebbles);
  for (std::size_t i = 0; i < pebbles; ++i)
    layout.bases.push_back({{Point(centerOf(i)), static_cast<float>(pebbleRadius)}, Sign::Positive});
  layout.stroke = [=](std::size_t k) {
    Random random = randomOf(seed, k);
    const std::size_t pebble = k % pebbles * jump % pebbles, round = k / pebbles;
    return walk({.center = centerOf(pebble), .radius = pebbleRadius},
                (round + pebble) % 2 == 0 ? Sign::Positive : Sign::Negative, random);
  };
  return layout;
}

Layout detailLayout(std::size_t primitives, std::uint64_t seed) {
  const double times = static_cast<double>(primitives) / 3426;
  Layout layout = sphereLayout(primitives, kBrush / std::sqrt(times), 2, seed);
  layout.density = static_cast<float>(static_cast<double>(kDensity) * times);
  return layout;
}

Layout crowdedLayout(std::size_t primitives, double cap, std::uint64_t seed) {
  const double brush = kCrowdBrush * std::sqrt(kCrowdPrimitives / static_cast<double>(primitives));
  Layout layout = sphereLayout(primitives, brush, cap, seed);
  layout.density = static_cast<float>(kCrowdSamples / (4 * kPi * brush * brush));
  layout.view = {0.2f, 0.3f, -1};
  return layout;
}

RadiusRange radiiOf(double spread) {
  // The mean square of radii that are log-uniform from a to s a is a^2 (s^2 - 1) / (2 ln s).
  if (!(spread > 1)) return {kSpreadBrush, kSpreadBrush};
  const double least = kSpreadBrush * std::sqrt(2 * std::log(spread) / (spread * spread - 1));
  return {least, least * spread};
}

Layout spreadLayout(std::size_t primitives, double spread, std::uint64_t seed) {
  const RadiusRange radii = radiiOf(spread);
  // Powers of the spread on a fine ladder by square roots alone: pow's last digits differ between libraries,
  // and they would decide radii.
  std::vector<double> roots;
  for (double root = std::sqrt(radii.most / radii.least); roots.size() < 24; root = std::sqrt(root))
    roots.push_back(root);
  // Rounded to float32, so that the logarithm's last digits do not matter.
  const double least = static_cast<double>(static_cast<float>(radii.least));
  Layout layout = sphereLayout(primitives, 0, 2, seed);
  layout.density = kSpreadDensity;
  layout.stroke = [=](std::size_t k) {
    // Multiples of the golden ratio: any run of strokes has radii of all sizes, evenly.
    std::uint64_t place = static_cast<std::uint32_t>(std::uint64_t{k} * 2'654'435'769u);
    double brush = least;
    for (std::size_t bit = 0; bit < roots.size(); ++bit)
      if (place >> (31 - bit) & 1) brush *= roots[bit];
    Random random = randomOf(seed, k);
    return walk({.brush = brush}, k % 2 == 0 ? Sign::Positive : Sign::Negative, random);
  };
  return layout;
}

Layout listLayout(const std::filesystem::path& file) {
  const sculpt::StrokeLog log = sculpt::readLog(file);
  sculpt::Document document(log.header);
  for (const sculpt::Command& command : log.commands) document.apply(command);
  const std::vector<std::uint32_t> nodes = document.nodeOfPrimitive();
  const implicit::PrimitiveList& list = document.model().list();

  Layout layout;
  const auto strokes = std::make_shared<std::vector<std::vector<Primitive>>>();
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (nodes[i] == 0) {
      layout.bases.push_back(list.at(i));
      continue;
    }
    if (strokes->empty() || nodes[i] != nodes[i - 1]) strokes->emplace_back();
    strokes->back().push_back(list.at(i));
  }
  if (strokes->size() < 2)
    throw InputError(
        fmt::format("{}: {} strokes; the scaling experiment takes out strokes from the middle, and "
                    "needs two or more",
                    file.string(), strokes->size()));
  layout.strokes = strokes->size();
  layout.stroke = [strokes](std::size_t k) { return strokes->at(k); };
  layout.endless = false;
  layout.density = log.header.density;
  return layout;
}

}  // namespace restroke::experiments
