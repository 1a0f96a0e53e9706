#include "tests/bench/leaf_brush.h"

#include <openvdb/tools/Prune.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "implicit/side.h"
#include "tests/bench/brush_dispatch.h"
#include "tests/bench/openvdb_grid.h"

namespace restroke::bench {
namespace {

using Accessor = openvdb::FloatGrid::Accessor;
using Leaf = openvdb::FloatTree::LeafNodeType;
constexpr int kDim = static_cast<int>(Leaf::DIM);
static_assert(kDim == 8 && Leaf::NUM_VOXELS == 512);
static_assert(openvdb::util::NodeMask<3>::WORD_COUNT == 8);

// Squares of the distances from the ball's centre to the nearest and the farthest point of a leaf's voxels,
// voxels given by their middle.
struct Distances2 {
  float nearest = 0, farthest = 0;
};
Distances2 distancesTo(const float first[3], float span) {
  Distances2 out;
  for (int a = 0; a < 3; ++a) {
    const float low = first[a], high = first[a] + span;
    const float near = low > 0 ? low : high < 0 ? -high : 0;
    const float far = std::max(-low, high);
    out.nearest += near * near;
    out.farthest += far * far;
  }
  return out;
}

}  // namespace

LeafBrush::LeafBrush(double voxel, Loops loops)
    : grid_(std::make_unique<OpenVdbGrid>()), voxel_(voxel), loops_(loops) {
  openvdb::initialize();
  grid_->grid = openvdb::createLevelSet<openvdb::FloatGrid>(voxel, kHalfWidth);
}
LeafBrush::~LeafBrush() = default;

void LeafBrush::stamp(const implicit::Primitive& primitive) {
  const implicit::Sphere& sphere = primitive.shape.ball();
  const auto voxel = static_cast<float>(voxel_);
  const BrushBall ball{sphere.radius, grid_->grid->background(), voxel,
                       primitive.sign == implicit::Sign::Positive};
  const auto brushLeaf = loops_ == Loops::Plain ? brushLeafPlainly : brushKernels().brushLeaf;
  const float reach = ball.radius + ball.band, core = ball.radius - ball.band;
  const float span = (kDim - 1) * voxel;
  const float deep = ball.adds ? -ball.band : ball.band;  // what the ball's core becomes
  int low[3], high[3];                                    // first voxels of the leaves that the box meets
  for (int a = 0; a < 3; ++a) {
    low[a] =
        static_cast<int>(std::floor(static_cast<double>(sphere.center[a] - reach) / voxel_)) & ~(kDim - 1);
    high[a] =
        static_cast<int>(std::ceil(static_cast<double>(sphere.center[a] + reach) / voxel_)) & ~(kDim - 1);
  }
  Accessor accessor = grid_->grid->getAccessor();
  for (int x = low[0]; x <= high[0]; x += kDim)
    for (int y = low[1]; y <= high[1]; y += kDim)
      for (int z = low[2]; z <= high[2]; z += kDim) {
        const openvdb::Coord at(x, y, z);
        const float first[3] = {static_cast<float>(x * voxel_ - static_cast<double>(sphere.center.x)),
                                static_cast<float>(y * voxel_ - static_cast<double>(sphere.center.y)),
                                static_cast<float>(z * voxel_ - static_cast<double>(sphere.center.z))};
        const Distances2 d2 = distancesTo(first, span);
        if (d2.nearest >= reach * reach) continue;
        Leaf* leaf = accessor.probeLeaf(at);
        if (!leaf && accessor.getValue(at) == deep) continue;
        if (core > 0 && d2.farthest < core * core) {
          accessor.addTile(1, at, deep, false);
          accessor.clear();  // it may still know the leaf that is gone
          continue;
        }
        if (!leaf) leaf = accessor.touchLeaf(at);
        brushLeaf({leaf->buffer().data(), &leaf->getValueMask().getWord<std::uint64_t>(0), first[0], first[1],
                   first[2]},
                  ball);
      }
}

void LeafBrush::prune() {
  openvdb::tools::pruneLevelSet(grid_->grid->tree());
}

std::size_t LeafBrush::bytes() const {
  return grid_->grid->memUsage();
}
std::size_t LeafBrush::activeVoxels() const {
  return grid_->grid->activeVoxelCount();
}

double LeafBrush::differenceFrom(const OpenVdbGrid& other) const {
  double worst = 0;
  const auto compare = [&](const openvdb::FloatGrid& a, const openvdb::FloatGrid& b) {
    const auto accessor = b.getConstAccessor();
    for (auto value = a.cbeginValueOn(); value; ++value)
      worst = std::max(worst, std::fabs(static_cast<double>(*value) -
                                        static_cast<double>(accessor.getValue(value.getCoord()))));
  };
  compare(*grid_->grid, *other.grid);
  compare(*other.grid, *grid_->grid);
  return worst / voxel_;
}

LeafBrush::Signs LeafBrush::compareSigns(const implicit::PrimitiveList& list, std::size_t tries) const {
  const implicit::Sphere around = list.boundingSphere();
  const double half = 1.1 * static_cast<double>(around.radius) / voxel_;
  std::mt19937 random(1);  // its numbers are the same everywhere
  const auto accessor = grid_->grid->getConstAccessor();
  Signs out;
  for (std::size_t i = 0; i < tries; ++i) {
    int voxel[3];
    Point p;
    for (int a = 0; a < 3; ++a) {
      const double along = static_cast<double>(random()) / 4294967296.0;
      voxel[a] = static_cast<int>(
          std::floor(static_cast<double>(around.center[a]) / voxel_ + half * (2 * along - 1)));
      p[a] = static_cast<float>(voxel[a] * voxel_);
    }
    const float value = accessor.getValue({voxel[0], voxel[1], voxel[2]});
    if (std::fabs(static_cast<double>(value)) <= voxel_) continue;
    ++out.asked;
    if ((value < 0) != (implicit::sideOf(list, p) == implicit::Side::Inside)) ++out.wrong;
  }
  return out;
}

}  // namespace restroke::bench
