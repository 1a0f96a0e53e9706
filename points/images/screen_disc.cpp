#include "points/images/screen_disc.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace restroke::points {
namespace {

/// Surfels a chunk: fixed, so that chunks do not depend on the number of threads.
constexpr std::size_t kChunk = 4096;

// The kernels read surfels as floats.
static_assert(sizeof(Surfel) == SurfelFloats::kStride * sizeof(float));
static_assert(offsetof(Surfel, position) == 0 && offsetof(Surfel, normal) == 3 * sizeof(float) &&
              offsetof(Surfel, radius) == 6 * sizeof(float));

void copy(double (&to)[3], DVec3 from) {
  to[0] = from.x, to[1] = from.y, to[2] = from.z;
}
void copy(float (&to)[3], DVec3 from) {
  const Vec3 rounded(from);
  to[0] = rounded.x, to[1] = rounded.y, to[2] = rounded.z;
}

ProjectionSetup projectionOf(const CameraFrame& frame, const Camera& camera) {
  ProjectionSetup setup = {};
  copy(setup.position, frame.position);
  copy(setup.right, frame.right);
  copy(setup.up, frame.up);
  copy(setup.forward, frame.forward);
  setup.width = camera.width;
  setup.height = camera.height;
  setup.firstX = -frame.halfWidth;
  setup.stepX = 2.0 * frame.halfWidth / setup.width;
  setup.firstY = frame.halfHeight;
  setup.stepY = -2.0 * frame.halfHeight / setup.height;
  setup.near = static_cast<double>(camera.near);
  setup.far = static_cast<double>(camera.far);

  copy(setup.eye, frame.position);
  copy(setup.view, frame.forward);
  copy(setup.side[0], normalized(frame.right + frame.halfWidth * frame.forward));
  copy(setup.side[1], normalized(-frame.right + frame.halfWidth * frame.forward));
  copy(setup.side[2], normalized(frame.up + frame.halfHeight * frame.forward));
  copy(setup.side[3], normalized(-frame.up + frame.halfHeight * frame.forward));
  // Twice the margin of the box on the screen, and more than float32 errs by.
  setup.looseness = static_cast<float>(2e-3 * std::max(setup.stepX, -setup.stepY) + 4e-6);
  return setup;
}

/// For each pixel, which tile it is in.
void listTiles(std::vector<std::uint16_t>& tileOf, std::uint32_t pixels, int side) {
  tileOf.resize(pixels);
  for (std::uint32_t i = 0; i < pixels; ++i)
    tileOf[i] = static_cast<std::uint16_t>(i / static_cast<std::uint32_t>(side));
}

}  // namespace

ScreenSetup::ScreenSetup(const Camera& camera)
    : frame_(frameOf(camera)),
      projection_(projectionOf(frame_, camera)),
      firstX_(static_cast<float>(projection_.firstX)),
      stepX_(static_cast<float>(projection_.stepX)),
      firstY_(static_cast<float>(projection_.firstY)),
      stepY_(static_cast<float>(projection_.stepY)),
      nearW_(static_cast<float>(1.0 / projection_.near)),
      farW_(static_cast<float>(1.0 / projection_.far)) {}

void TiledDiscs::fill(const Scene& scene, const ScreenSetup& setup, Layout layout) {
  layout_ = layout;
  listTiles(columnOf_, static_cast<std::uint32_t>(setup.projection().width), layout.tile);
  listTiles(rowOf_, static_cast<std::uint32_t>(setup.projection().height), layout.tile);
  columns_ = columnOf_.back() + 1;
  rows_ = rowOf_.back() + 1;
  chunkCount_ = (scene.surfels.size() + kChunk - 1) / kChunk;
  if (chunks_.size() < chunkCount_) chunks_.resize(chunkCount_);
  tbb::parallel_for(std::size_t{0}, chunkCount_,
                    [&](std::size_t i) { fillChunk(chunks_[i], scene, setup, i * kChunk); });
}

TiledDiscs::TileRange TiledDiscs::tilesOf(const ScreenDisc& disc) const {
  const auto tile = [](const std::vector<std::uint16_t>& tileOf, int pixel) {
    return tileOf[static_cast<std::size_t>(std::clamp(pixel, 0, static_cast<int>(tileOf.size()) - 1))];
  };
  // Another for samples beside the centres, which may lie in the disc when its pixel's centre is outside.
  const int apron = 2 * layout_.apron;
  return {tile(columnOf_, disc.firstX - apron), tile(columnOf_, disc.lastX + apron),
          tile(rowOf_, disc.firstY - apron), tile(rowOf_, disc.lastY + apron)};
}

template <class Visit>
void TiledDiscs::forTiles(const TileRange& range, Visit visit) const {
  for (int row = range.row0; row <= range.row1; ++row)
    for (int column = range.column0; column <= range.column1; ++column)
      visit(static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
            static_cast<std::size_t>(column));
}

void TiledDiscs::fillChunk(Chunk& chunk, const Scene& scene, const ScreenSetup& setup,
                           std::size_t begin) const {
  const PictureKernels& kernels = pictureKernels();
  const Surfel* const surfels = scene.surfels.data() + begin;
  const SurfelFloats floats = {reinterpret_cast<const float*>(surfels)};
  std::array<std::uint32_t, kChunk> numbers;
  const std::size_t may = kernels.cull(setup.projection(), floats,
                                       std::min(kChunk, scene.surfels.size() - begin), numbers.data());
  if (chunk.capacity <= may) {
    chunk.capacity = may + may / 4 + 1;
    chunk.discs = std::make_unique_for_overwrite<ScreenDisc[]>(chunk.capacity);
  }
  const std::size_t seen =
      kernels.project(setup.projection(), floats, {numbers.data(), may}, chunk.discs.get());
  chunk.ranges.resize(seen);
  for (std::size_t i = 0; i < seen; ++i) {
    ScreenDisc& disc = chunk.discs[i];
    const Surfel& surfel = surfels[disc.surfel];
    disc.surfel += static_cast<std::uint32_t>(begin);
    disc.primitive = surfel.primitive;
    disc.kind = kindOf(scene, surfel.primitive, surfel.sign);
    chunk.ranges[i] = tilesOf(disc);
  }
  sortChunk(chunk);
}

void TiledDiscs::sortChunk(Chunk& chunk) const {
  // Counting sort: it keeps the order of the surfels within a tile.
  const std::size_t tiles = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  chunk.end.assign(tiles, 0);
  for (const TileRange& range : chunk.ranges) forTiles(range, [&](std::size_t tile) { ++chunk.end[tile]; });
  std::uint32_t sum = 0;
  for (std::uint32_t& end : chunk.end) {  // where the tile begins, until it is filled
    const std::uint32_t count = end;
    end = sum;
    sum += count;
  }
  chunk.entries.resize(sum);
  for (std::size_t i = 0; i < chunk.ranges.size(); ++i)
    forTiles(chunk.ranges[i],
             [&](std::size_t tile) { chunk.entries[chunk.end[tile]++] = static_cast<std::uint32_t>(i); });
}

void TiledDiscs::list(int column, int row, std::vector<const ScreenDisc*>& discs) const {
  const std::size_t tile =
      static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  for (std::size_t i = 0; i < chunkCount_; ++i) {
    const Chunk& chunk = chunks_[i];
    for (std::uint32_t k = tile == 0 ? 0 : chunk.end[tile - 1]; k < chunk.end[tile]; ++k)
      discs.push_back(&chunk.discs[chunk.entries[k]]);
  }
}

}  // namespace restroke::points
