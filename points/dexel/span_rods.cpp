#include "points/dexel/span_rods.h"

#include <array>
#include <cmath>

#include "implicit/errors.h"

namespace restroke::points {

namespace {

// A rod's section has so many sides, and discs overlap their neighbours by half.
constexpr int kSides = 10;
constexpr double kStep = 0.45;

// Rods one after the other.
class RodMaker {
 public:
  RodMaker(const RodLook& look, std::vector<Surfel>& out) : look_(look), out_(out) {
    // Directions of a regular polygon, each from the one before by the same turn: cos and sin of 36 degrees.
    const double c = (1 + std::sqrt(5.0)) / 4, s = std::sqrt(1 - c * c);
    double x = 1, y = 0;
    for (auto& side : sides_) {
      side = {x, y};
      const double next = c * x - s * y;
      y = s * x + c * y;
      x = next;
    }
  }

  void add(DVec3 from, DVec3 to) {
    const double size = length(to - from);
    if (!(size > 0)) return;
    const DVec3 along = (to - from) / size;
    const double r = static_cast<double>(look_.radius);
    const auto steps = static_cast<std::size_t>(std::ceil(size / (kStep * r)));
    if (out_.size() + steps * kSides > kMostRodSurfels)
      throw InputError(fmt::format("the spans as rods take more than {} surfels; fewer lines must be drawn",
                                   kMostRodSurfels));
    int least = 0;
    for (int a = 1; a < 3; ++a)
      if (std::fabs(along[a]) < std::fabs(along[least])) least = a;
    DVec3 axis(0);
    axis[least] = 1;
    const DVec3 u = normalized(cross(along, axis)), v = cross(along, u);
    put(from, -along, look_.radius);
    put(to, along, look_.radius);
    for (std::size_t i = 0; i < steps; ++i) {
      const DVec3 middle = from + (static_cast<double>(i) + 0.5) / static_cast<double>(steps) * size * along;
      for (const auto& [x, y] : sides_) {
        const DVec3 out = x * u + y * v;
        put(middle + r * out, out, static_cast<float>(0.5 * r));
      }
    }
  }

 private:
  void put(DVec3 p, DVec3 normal, float radius) {
    out_.push_back({Point(p), Vec3(normal), radius, look_.primitive, look_.sign});
  }

  const RodLook& look_;
  std::vector<Surfel>& out_;
  std::array<std::array<double, 2>, kSides> sides_;
};

}  // namespace

void appendRods(const Dexels& dexels, const LineFamily& lines, const RodLook& look,
                std::vector<Surfel>& out) {
  RodMaker rods(look, out);
  LineEnds ends;
  for (int row = 0; row < dexels.height(); ++row)
    for (int column = 0; column < dexels.width(); ++column) {
      dexels.read(dexels.lineAt(column, row), ends);
      const Ray line = lines.line(column, row);
      for (std::size_t i = 0; i < ends.size(); i += 2)
        rods.add(line.at(static_cast<double>(ends[i].depth)),
                 line.at(static_cast<double>(ends[i + 1].depth)));
    }
}

void appendEdges(const Zone& zone, const RodLook& look, std::vector<Surfel>& out) {
  RodMaker rods(look, out);
  if (const auto* ball = std::get_if<implicit::Sphere>(&zone.shape())) {
    constexpr int kParts = 64;
    const double r = static_cast<double>(ball->radius);
    for (int a = 0; a < 3; ++a) {
      // A circle by its points at equal steps of the tangent of half the angle, a quarter at a time.
      const auto at = [&](int i) {
        const int quarter = i / (kParts / 4);
        const double t = static_cast<double>(i % (kParts / 4)) / (kParts / 4);
        const double c = (1 - t * t) / (1 + t * t), s = 2 * t / (1 + t * t);
        const std::array<double, 4> x{c, -s, -c, s}, y{s, c, -s, -c};
        DVec3 p(ball->center);
        p[a] += r * x[static_cast<std::size_t>(quarter % 4)];
        p[(a + 1) % 3] += r * y[static_cast<std::size_t>(quarter % 4)];
        return p;
      };
      for (int i = 0; i < kParts; ++i) rods.add(at(i), at(i + 1));
    }
    return;
  }
  const std::array<DVec3, 8> corners = zone.corners();
  for (std::size_t i = 0; i < 8; ++i)
    for (const std::size_t bit : {1u, 2u, 4u})
      if ((i & bit) == 0) rods.add(corners[i], corners[i | bit]);
}

}  // namespace restroke::points
