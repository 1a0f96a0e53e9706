#include "experiments/refine/histories.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "experiments/random.h"
#include "implicit/errors.h"
#include "implicit/geometry/det_math.h"
#include "implicit/geometry/powers.h"
#include "implicit/volume_kinds.h"

namespace restroke::experiments {
namespace {

using implicit::Primitive;
using implicit::Sign;
using points::OperationId;

// Radii are evenly from (1 - kSpread) to (1 + kSpread) of their mean: the mean cube is 1 + kSpread^2 of the
// cube of the mean.
constexpr double kSpread = 0.5;
constexpr double kBallVolume = 4 * kPi / 3 * (1 + kSpread * kSpread);

constexpr double kCutterStep = 0.3, kRowStep = 0.7;
constexpr int kPasses = 2;

constexpr double kThinLength = 5;  // cells, of rods and plates
constexpr int kThinRoom = 8;       // cells from one feature to the next

constexpr double kDeepRadius = 0.03, kNearRadius = 0.05, kFarRadius = 0.02;
constexpr double kFineDensity = 8;
constexpr std::size_t kNearOperations = 430;

double volumeOf(Ground ground) {
  return ground == Ground::Ball ? 4 * kPi / 3 : 1;
}

Primitive ball(DVec3 center, double radius, Sign sign) {
  return {{Point(center), static_cast<float>(radius)}, sign};
}

/// A box along the axes.
Primitive box(DVec3 center, DVec3 half, Sign sign) {
  implicit::VolumeParameters parameters;
  for (int a = 0; a < 3; ++a) parameters.values.push_back({static_cast<float>(half[a])});
  parameters.values.push_back({0});  // sharp
  return {std::make_shared<const implicit::PosedVolume>(implicit::volumeKindNamed("box").make(parameters),
                                                        implicit::Pose{.position = Point(center)}),
          sign};
}

Primitive block() {
  return box(DVec3(0.5), DVec3(0.5), Sign::Positive);
}

DVec3 placeOn(Ground ground, Random& random) {
  for (;;) {
    DVec3 p;
    for (int a = 0; a < 3; ++a) p[a] = ground == Ground::Ball ? random.between(-1, 1) : random.unit();
    if (ground != Ground::Ball || dot(p, p) <= 1) return p;
  }
}

double radiusAbout(double mean, Random& random) {
  return mean * random.between(1 - kSpread, 1 + kSpread);
}

Sign signOf(double additions, Random& random) {
  return random.unit() < additions ? Sign::Positive : Sign::Negative;
}

/// The surface that the milling leaves: hills and hollows on a plane.
class Relief {
 public:
  explicit Relief(std::uint64_t seed) {
    Random random(seed);
    for (Bump& b : bumps_)
      b = {random.unit(), random.unit(), random.between(0.08, 0.3), random.between(-0.08, 0.1)};
  }
  [[nodiscard]] double at(double x, double y) const {
    double height = 0.22;
    for (const Bump& b : bumps_) {
      const double dx = (x - b.x) / b.width, dy = (y - b.y) / b.width, rest = 1 - dx * dx - dy * dy;
      if (rest > 0) height += b.height * rest * rest;
    }
    return std::max(0.05, height);
  }

 private:
  struct Bump {
    double x = 0, y = 0, width = 1, height = 0;
  };
  std::array<Bump, 12> bumps_;
};

/// Operations that are near a box, and no others.
std::vector<Primitive> nearOperations(const Box& near, std::uint64_t seed) {
  Random random(seed);
  std::vector<Primitive> out;
  for (std::size_t i = 0; i < kNearOperations; ++i) {
    const double radius = radiusAbout(kNearRadius, random);
    DVec3 p;
    for (int a = 0; a < 3; ++a)
      p[a] = random.between(static_cast<double>(near.min[a]) - radius,
                            static_cast<double>(near.max[a]) + radius);
    out.push_back(ball(p, radius, signOf(0.5, random)));
  }
  return out;
}

Primitive farOperation(const Box& near, Random& random) {
  for (;;) {
    const double radius = radiusAbout(kFarRadius, random);
    const DVec3 p = placeOn(Ground::Block, random);
    bool apart = false;
    for (int a = 0; a < 3; ++a)
      apart = apart || p[a] < static_cast<double>(near.min[a]) - 1.01 * radius ||
              p[a] > static_cast<double>(near.max[a]) + 1.01 * radius;
    const Sign sign = signOf(0.5, random);
    if (apart) return ball(p, radius, sign);
  }
}

RefineHistory grownElsewhere(std::size_t operations, const Box& near, std::uint64_t seed) {
  RESTROKE_CHECK_LE(kNearOperations, operations);
  RefineHistory out{.name = "elsewhere", .initial = {block()}, .operations = {}};
  const std::vector<Primitive> local = nearOperations(near, seed);
  Random random(seed + 1);
  out.operations.reserve(operations);
  for (std::size_t i = 0; i < operations; ++i) {
    const std::size_t before = i * local.size() / operations, after = (i + 1) * local.size() / operations;
    out.operations.push_back(after > before ? local[before] : farOperation(near, random));
  }
  return out;
}

}  // namespace

Box boundsOf(const RefineHistory& history) {
  Box bounds;
  for (const auto* list : {&history.initial, &history.operations})
    for (const Primitive& p : *list)
      if (p.sign == Sign::Positive) bounds.add(boundsOf(p.shape));
  return bounds;
}

double meanRadiusOf(const BallsOptions& o) {
  return powerOf(o.density * volumeOf(o.ground) / (static_cast<double>(o.operations) * kBallVolume), 1.0 / 3);
}

std::size_t operationsFor(double density, double meanRadius, Ground ground) {
  const double count = density * volumeOf(ground) / (kBallVolume * meanRadius * meanRadius * meanRadius);
  return static_cast<std::size_t>(std::max(1.0, std::round(count)));
}

RefineHistory strewnBalls(const BallsOptions& options) {
  RefineHistory out{.name = "balls", .initial = {}, .operations = {}};
  if (options.ground == Ground::Block) out.initial.push_back(block());
  if (options.ground == Ground::Ball) out.initial.push_back(ball(DVec3(0), 1, Sign::Positive));
  const double mean = meanRadiusOf(options);
  Random random(options.seed);
  out.operations.reserve(options.operations);
  for (std::size_t i = 0; i < options.operations; ++i) {
    const DVec3 p = placeOn(options.ground, random);
    const double radius = radiusAbout(mean, random);
    out.operations.push_back(ball(p, radius, signOf(options.additions, random)));
  }
  return out;
}

RefineHistory milledBlock(std::size_t operations, std::uint64_t seed) {
  RefineHistory out{.name = "milled",
                    .initial = {box({0.5, 0.5, 0.25}, {0.5, 0.5, 0.25}, Sign::Positive)},
                    .operations = {}};
  const Relief relief(seed);
  const double radius = std::sqrt(kPasses / (kCutterStep * kRowStep * static_cast<double>(operations)));
  const int rows = std::max(1, static_cast<int>(1 / (kRowStep * radius))),
            places = std::max(1, static_cast<int>(1 / (kCutterStep * radius)));
  for (int pass = kPasses - 1; pass >= 0; --pass)
    for (int row = 0; row < rows; ++row)
      for (int i = 0; i < places; ++i) {
        // There and back.
        const double along = (row % 2 == 0 ? i + 0.5 : places - i - 0.5) / places,
                     across = (row + 0.5) / rows;
        const double x = pass % 2 == 0 ? along : across, y = pass % 2 == 0 ? across : along;
        out.operations.push_back(
            ball({x, y, relief.at(x, y) + radius + pass * 0.6 * radius}, radius, Sign::Negative));
      }
  return out;
}

const char* nameOf(Thin thin) {
  static constexpr std::array kNames{"plates", "rods", "grains"};
  return kNames.at(static_cast<std::size_t>(thin));
}

RefineHistory thinFeatures(const ThinOptions& options) {
  RefineHistory out{
      .name = fmt::format("{}{}", nameOf(options.thin), options.between ? ", between the lines" : ""),
      .initial = {block(), box({0.75, 0.5, 0.5}, {0.24, 0.49, 0.49}, Sign::Negative)},
      .operations = {}};
  const double cell = 1.0 / options.resolution;
  const int along = options.resolution / kThinRoom;
  Random random(options.seed);
  for (int z = 0; z < along; ++z)
    for (int y = 0; y < along; ++y)
      for (int x = 0; x < along; ++x) {
        const int axis = static_cast<int>(random.below(3));
        DVec3 place, half;
        for (int a = 0; a < 3; ++a) {
          const int room = a == 0 ? x : a == 1 ? y : z;
          const double middle = (room + 0.5) * kThinRoom;
          // The lines are in the middles of cells, so whole numbers of cells are between them.
          place[a] = cell * (middle + (options.between ? 0 : random.between(-0.5, 0.5)));
          const bool thin = options.thin == Thin::Plates ? a == axis : a != axis;
          half[a] = cell / 2 * (thin || options.thin == Thin::Grains ? options.thickness : kThinLength);
        }
        const Sign sign = place.x < 0.5 ? Sign::Negative : Sign::Positive;
        out.operations.push_back(options.thin == Thin::Grains ? ball(place, half.x, sign)
                                                              : box(place, half, sign));
      }
  return out;
}

const char* nameOf(Growth growth) {
  static constexpr std::array kNames{"elsewhere", "deeper", "finer"};
  return kNames.at(static_cast<std::size_t>(growth));
}

RefineHistory grownHistory(Growth growth, std::size_t operations, const Box& near, std::uint64_t seed) {
  if (growth == Growth::Elsewhere) return grownElsewhere(operations, near, seed);
  BallsOptions options{.operations = operations, .density = kFineDensity, .seed = seed};
  if (growth == Growth::Deeper)
    options.density = static_cast<double>(operations) * kBallVolume * kDeepRadius * kDeepRadius * kDeepRadius;
  RefineHistory out = strewnBalls(options);
  out.name = nameOf(growth);
  return out;
}

points::TriDexelDocument documentOf(const RefineHistory& history, int resolution, Kept kept,
                                    const Execution& execution) {
  points::TriDexelDocument document;
  document.initial = history.initial;
  document.operations.reserve(history.operations.size());
  for (const Primitive& p : history.operations)
    document.operations.push_back(
        {p.sign == Sign::Positive ? points::DexelOperation::Union : points::DexelOperation::Subtraction,
         p.shape});
  const points::Dexels::Options options{.operations = true, .history = kept == Kept::Histories};
  document.model =
      points::TriDexel(points::dexelGridFor(boundsOf(history), {.resolution = resolution}), options);
  for (const Primitive& p : history.initial) document.model.apply({&p, 1}, OperationId::Initial, execution);
  document.model.apply(history.operations, OperationId{1}, execution);
  return document;
}

}  // namespace restroke::experiments
