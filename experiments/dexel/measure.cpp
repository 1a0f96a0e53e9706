#include "experiments/dexel/measure.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "experiments/random.h"
#include "implicit/errors.h"
#include "implicit/parallel.h"
#include "implicit/ray_cast.h"
#include "points/dexel/dexel_surfels.h"
#include "points/dexel/tri_dexel.h"
#include "points/surfel_model.h"

namespace restroke::experiments {
namespace {

using implicit::Side;
using points::DexelGrid;
using points::Dexels;
using points::GridCounts;
using points::Surfel;
using points::TriDexel;

// Half of a cell's diagonal: discs of neighbours meet.
constexpr double kDiscOfCell = 0.71;

std::size_t at(const GridCounts& counts, int axis) {
  return static_cast<std::size_t>(counts[static_cast<std::size_t>(axis)]);
}

/// A bit for each point of a grid.
class Voxels {
 public:
  Voxels(const implicit::PrimitiveList& list, const DexelGrid& grid, const Execution& execution)
      : grid_(grid) {
    const std::size_t row = at(grid.counts(), 0), slab = row * at(grid.counts(), 1);
    bits_.assign((slab * at(grid.counts(), 2) + 63) / 64, 0);
    std::vector<Point> points(slab);
    std::vector<Side> sides(slab);
    std::size_t bit = 0;
    for (int z = 0; z < grid.counts()[2]; ++z) {
      for (std::size_t i = 0; i < slab; ++i)
        points[i] = grid.at({static_cast<int>(i % row), static_cast<int>(i / row), z});
      sidesOf(list, points, sides, {}, execution);
      for (const Side side : sides) {
        if (side == Side::Inside) bits_[bit / 64] |= std::uint64_t{1} << bit % 64;
        ++bit;
      }
    }
  }

  /// Outside beyond the grid.
  [[nodiscard]] bool isInside(const GridCounts& p) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (p[a] < 0 || p[a] >= grid_.counts()[a]) return false;
    const std::size_t bit =
        (static_cast<std::size_t>(p[2]) * at(grid_.counts(), 1) + static_cast<std::size_t>(p[1])) *
            at(grid_.counts(), 0) +
        static_cast<std::size_t>(p[0]);
    return (bits_[bit / 64] >> bit % 64 & 1) != 0;
  }
  [[nodiscard]] bool contains(Point p) const {
    return isInside({grid_.nearestTo(0, p.x), grid_.nearestTo(1, p.y), grid_.nearestTo(2, p.z)});
  }
  [[nodiscard]] std::size_t bytes() const { return bits_.capacity() * sizeof(bits_[0]); }

  [[nodiscard]] std::vector<Surfel> faces() const {
    std::vector<Surfel> faces;
    GridCounts p;
    for (p[2] = 0; p[2] < grid_.counts()[2]; ++p[2])
      for (p[1] = 0; p[1] < grid_.counts()[1]; ++p[1])
        for (p[0] = 0; p[0] < grid_.counts()[0]; ++p[0])
          if (isInside(p)) addFaces(p, faces);
    return faces;
  }

 private:
  void addFaces(const GridCounts& p, std::vector<Surfel>& faces) const {
    for (int axis = 0; axis < 3; ++axis)
      for (const int way : {-1, 1}) {
        GridCounts beyond = p;
        beyond[static_cast<std::size_t>(axis)] += way;
        if (isInside(beyond)) continue;
        Surfel face{.position = grid_.at(p), .normal = Vec3(0)};
        face.position[axis] =
            static_cast<float>(static_cast<double>(face.position[axis]) + way * grid_.cell() / 2);
        face.normal[axis] = static_cast<float>(way);
        faces.push_back(face);
      }
  }

  DexelGrid grid_;
  std::vector<std::uint64_t> bits_;
};

/// Does the line of the family that is nearest to p say that it is inside?
bool saysInside(const TriDexel& model, int axis, Point p) {
  const Dexels& dexels = model.family(axis);
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  return dexels.contains(dexels.lineAt(model.grid().nearestTo(u, p[u]), model.grid().nearestTo(v, p[v])),
                         p[axis]);
}

/// f(i) for i from 0 to count - 1, on the execution's threads.
template <class F>
std::vector<double> valuesOf(std::size_t count, const Execution& execution, const F& f) {
  std::vector<double> values(count);
  inArena(execution,
          [&] { tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { values[i] = f(i); }); });
  return values;
}

Distances summed(std::vector<double> distances) {
  Distances out;
  if (distances.empty()) return out;
  // One after the other: the same sum for any number of threads.
  for (const double d : distances) out.mean += d;
  out.mean /= static_cast<double>(distances.size());
  std::ranges::sort(distances);
  out.high = distances[distances.size() - 1 - (distances.size() - 1) / 100];
  out.most = distances.back();
  return out;
}

/// A solid as one of the representations shows it.
struct Shown {
  std::vector<Surfel> elements;
  std::function<bool(Point)> contains;
};

/// What is measured in the same way whatever it is.
DexelMeasured compare(const Truth& truth, const DexelGrid& grid, const Shown& shown,
                      const Execution& execution) {
  const std::vector<Surfel>& elements = shown.elements;
  DexelMeasured out;
  out.counts = grid.counts();
  out.cell = grid.cell();
  out.elements = elements.size();
  const std::vector<double> wrong = valuesOf(truth.points().size(), execution, [&](std::size_t i) {
    return shown.contains(truth.points()[i]) == (truth.sides()[i] == Side::Inside) ? 0.0 : 1.0;
  });
  out.wrongPoints = static_cast<std::size_t>(std::ranges::count(wrong, 1.0));
  out.wrongVolume = static_cast<double>(out.wrongPoints) / static_cast<double>(truth.pointsInside());

  out.accuracy = summed(valuesOf(elements.size(), execution, [&](std::size_t i) {
    return truth.distanceFromSurface(elements[i].position, elements[i].normal, grid.cell());
  }));
  const std::vector<Surfel>& samples = truth.surface().surfels();
  // With no element at all, as when a solid is thinner than the lines are apart, the bounds are how far
  // anything can be.
  const auto nowhere = 2 * static_cast<double>(truth.bounds().halfDiagonal());
  const retarget::NearestSurfels tree(elements);
  out.coverage = summed(valuesOf(samples.size(), execution, [&](std::size_t i) {
    const auto nearest = tree.nearest(samples[i].position);
    return nearest ? length(DVec3(elements[*nearest].position) - DVec3(samples[i].position)) : nowhere;
  }));
  return out;
}

}  // namespace

Truth::Truth(std::vector<implicit::Primitive> primitives, const TruthOptions& options,
             const Execution& execution)
    : primitives_(std::move(primitives)) {
  list_.insert(0, primitives_);
  bounds_ = list_.bounds();
  if (bounds_.empty()) throw InputError("nothing adds to the solid; it needs a positive primitive");
  Random random(options.seed);
  points_.resize(options.points);
  sides_.resize(options.points);
  for (Point& p : points_)
    for (int a = 0; a < 3; ++a)
      p[a] = static_cast<float>(
          random.between(static_cast<double>(bounds_.min[a]), static_cast<double>(bounds_.max[a])));
  sidesOf(list_, points_, sides_, {}, execution);
  inside_ = static_cast<std::size_t>(std::ranges::count(sides_, Side::Inside));

  points::SurfelModel model({.density = options.density});
  model.append(primitives_, execution);
  surface_ = std::make_unique<const retarget::NearestSurfels>(model.surfels(execution));
  if (inside_ == 0 || surface_->surfels().empty())
    throw InputError(
        fmt::format("of {} random points {} are inside, and {} surface samples are visible; the "
                    "solid must be there",
                    options.points, inside_, surface_->surfels().size()));
}

double Truth::distanceFromSurface(Point p, Vec3 normal, double reach) const {
  const Surfel& nearest = surface_->surfels()[*surface_->nearest(p)];
  double least = length(DVec3(nearest.position) - DVec3(p));
  for (const Vec3 along : {normal, nearest.normal}) {
    const DVec3 n = normalized(DVec3(along));
    // From close by first: the nearest crossing is looked for, not the outermost. Half of a cell is from one
    // side of a voxel's face to the other, and the surface between them.
    for (const double part : {1.0 / 64, 1.0 / 8, 1.0 / 2, 1.0}) {
      const double from = reach * part;
      const auto hit =
          castRay(list_, {.origin = DVec3(p) + from * n, .direction = -1.0 * n, .tMin = 0, .tMax = 2 * from});
      if (!hit) continue;
      least = std::min(least, std::fabs(from - hit->t));
      break;
    }
  }
  return least;
}

std::vector<DexelMeasured> measureAt(const Truth& truth, int resolution, const Execution& execution,
                                     std::vector<std::vector<points::Surfel>>* elements) {
  const DexelGrid grid = points::dexelGridFor(truth.bounds(), {.resolution = resolution});
  std::vector<DexelMeasured> out;
  const auto add = [&](Representation representation, Shown shown) -> DexelMeasured& {
    out.push_back(compare(truth, grid, shown, execution));
    out.back().representation = representation;
    if (elements != nullptr) {
      for (Surfel& element : shown.elements) element.radius = static_cast<float>(kDiscOfCell * grid.cell());
      elements->push_back(std::move(shown.elements));
    }
    return out.back();
  };
  {
    const Voxels voxels(truth.list(), grid, execution);
    add(Representation::Voxels, {voxels.faces(), [&](Point p) { return voxels.contains(p); }}).bytes =
        voxels.bytes();
  }
  const TriDexel model = triDexelOf(truth.list(), grid, {}, execution);
  TriDexel bare(grid, {.operations = false});
  bare.apply(truth.primitives(), points::OperationId::Initial, execution);

  std::vector<Surfel> ends =
      surfelsOf(model, {.family = kOneFamily, .ends = points::DexelEnds::All}, execution);
  DexelMeasured& one = add(Representation::OneFamily,
                           {std::move(ends), [&](Point p) { return saysInside(model, kOneFamily, p); }});
  one.lines = model.family(kOneFamily).lineCount();
  one.bytes = model.family(kOneFamily).bytes();
  one.bytesWithoutOperations = bare.family(kOneFamily).bytes();

  ends = surfelsOf(model, {.ends = points::DexelEnds::All}, execution);
  DexelMeasured& three =
      add(Representation::ThreeFamilies,
          {std::move(ends), [&](Point p) {
             return saysInside(model, 0, p) + saysInside(model, 1, p) + saysInside(model, 2, p) >= 2;
           }});
  three.lines = grid.lineCount();
  three.bytes = model.bytes();
  three.bytesWithoutOperations = bare.bytes();
  return out;
}

}  // namespace restroke::experiments
