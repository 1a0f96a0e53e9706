// Perspective-correct splats: the plane of a disc is a linear function of 1 / depth over the screen, and so
// are the disc's own coordinates divided by depth (as in "Perspective accurate splatting", M. Zwicker, J.
// Raesaenen, M. Botsch, C. Dachsbacher, M. Pauly, Graphics Interface 2004, section 3, and the homogeneous
// bounds of "GPU-based ray-casting of quadratic surfaces", C. Sigg, T. Weyrich, M. Botsch, M. Gross, SPBG
// 2006, section 3). We keep the three functions apart instead of forming the conic, because the float32 of
// the conic's matrix loses the digits that the edge needs.

#include "points/images/screen_disc.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace restroke::points {
namespace {

/// Surfels a chunk: fixed, so that chunks do not depend on the number of threads.
constexpr std::size_t kChunk = 4096;

struct Interval {
  double min, max;
};

/// Where the disc's silhouette lies along one screen axis, as tangent (coordinate / depth). c and n are the
/// components of centre and normal along that axis, z those along the view. The disc must be in front of the
/// camera as a whole.
Interval tangents(double c, double n, double cz, double nz, double r2) {
  // The plane x = s z touches the disc's rim where (cx - s cz)^2 = r^2 (1 + s^2 - (nx - s nz)^2).
  const double a = cz * cz - r2 * (1.0 - nz * nz);
  const double b = c * cz + r2 * n * nz;
  const double e = c * c - r2 * (1.0 - n * n);
  const double root = std::sqrt(std::max(b * b - a * e, 0.0));
  return {(b - root) / a, (b + root) / a};
}

}  // namespace

ScreenSetup::ScreenSetup(const Camera& camera)
    : frame_(frameOf(camera)),
      width_(camera.width),
      height_(camera.height),
      firstX_(-frame_.halfWidth),
      stepX_(2.0 * frame_.halfWidth / width_),
      firstY_(frame_.halfHeight),
      stepY_(-2.0 * frame_.halfHeight / height_),
      near_(static_cast<double>(camera.near)),
      far_(static_cast<double>(camera.far)),
      nearW_(static_cast<float>(1.0 / near_)),
      farW_(static_cast<float>(1.0 / far_)) {}

bool ScreenSetup::project(const Surfel& surfel, ScreenDisc& disc) const {
  const DVec3 d = DVec3(surfel.position) - frame_.position;
  const DVec3 worldNormal(surfel.normal);
  const double cx = dot(d, frame_.right), cy = dot(d, frame_.up), cz = dot(d, frame_.forward);
  const double nx = dot(worldNormal, frame_.right), ny = dot(worldNormal, frame_.up),
               nz = dot(worldNormal, frame_.forward);
  const double r = static_cast<double>(surfel.radius);
  const double h =
      nx * cx + ny * cy + nz * cz;  // distance of the plane; negative when the disc faces the camera
  // Written so that anything that is not a number fails.
  if (!(h < 0.0) || !(h * h > kEdgeOnCosine * kEdgeOnCosine * (cx * cx + cy * cy + cz * cz)) || !(r > 0.0))
    return false;
  const double reach = r * std::sqrt(std::max(1.0 - nz * nz, 0.0));  // along the view
  if (!(cz + reach >= near_) || !(cz - reach <= far_)) return false;

  // Box on the screen. A disc that reaches behind the camera may be anywhere.
  double minX = 0, maxX = width_, minY = 0, maxY = height_;
  if (cz - reach > 1e-6 * std::fabs(cz)) {
    const Interval x = tangents(cx, nx, cz, nz, r * r), y = tangents(cy, ny, cz, nz, r * r);
    // A little more than the exact box: a pixel centre on its edge may belong to the rounded disc.
    constexpr double kMargin = 1e-3;
    minX = std::max(minX, (x.min - firstX_) / stepX_ - kMargin);
    maxX = std::min(maxX, (x.max - firstX_) / stepX_ + kMargin);
    minY = std::max(minY, (y.max - firstY_) / stepY_ - kMargin);
    maxY = std::min(maxY, (y.min - firstY_) / stepY_ + kMargin);
    if (!(minX < maxX && minY < maxY)) return false;
  }

  // The reference place: the centre's, unless that is not on or near the screen.
  double refX = 0.5 * width_, refY = 0.5 * height_;
  if (cz > 0.0) {
    const double x = (cx / cz - firstX_) / stepX_, y = (cy / cz - firstY_) / stepY_;
    if (x > -width_ && x < 2.0 * width_ && y > -height_ && y < 2.0 * height_) refX = x, refY = y;
  }
  const double floorX = std::floor(refX), floorY = std::floor(refY);
  const double dx = firstX_ + stepX_ * refX, dy = firstY_ + stepY_ * refY;

  const double w0 = (nx * dx + ny * dy + nz) / h, wX = nx * stepX_ / h, wY = ny * stepY_ / h;
  // Two axes of the disc, each 1 / r long: the normal crossed with the coordinate axis that it is least
  // along.
  DVec3 axis(1, 0, 0);
  const double ax = std::fabs(nx), ay = std::fabs(ny), az = std::fabs(nz);
  if (ay <= ax && ay <= az) axis = DVec3(0, 1, 0);
  if (az <= ax && az < ay) axis = DVec3(0, 0, 1);
  const DVec3 n(nx, ny, nz), c(cx, cy, cz);
  const DVec3 u = normalized(cross(n, axis)) / r;
  const DVec3 v = cross(n, u);
  const double uc = dot(u, c), vc = dot(v, c);

  disc.pixelX = static_cast<std::int32_t>(floorX);
  disc.pixelY = static_cast<std::int32_t>(floorY);
  disc.fractionX = static_cast<float>(refX - floorX);
  disc.fractionY = static_cast<float>(refY - floorY);
  disc.w0 = static_cast<float>(w0);
  disc.wX = static_cast<float>(wX);
  disc.wY = static_cast<float>(wY);
  disc.u0 = static_cast<float>(u.x * dx + u.y * dy + u.z - w0 * uc);
  disc.uX = static_cast<float>(u.x * stepX_ - wX * uc);
  disc.uY = static_cast<float>(u.y * stepY_ - wY * uc);
  disc.v0 = static_cast<float>(v.x * dx + v.y * dy + v.z - w0 * vc);
  disc.vX = static_cast<float>(v.x * stepX_ - wX * vc);
  disc.vY = static_cast<float>(v.y * stepY_ - wY * vc);
  disc.minX = static_cast<float>(minX);
  disc.maxX = static_cast<float>(maxX);
  disc.minY = static_cast<float>(minY);
  disc.maxY = static_cast<float>(maxY);
  disc.window = static_cast<float>(2.0 * r * w0 * w0);
  disc.normalX = static_cast<float>(nx);
  disc.normalY = static_cast<float>(ny);
  disc.normalZ = static_cast<float>(-nz);
  return true;
}

TiledDiscs::TiledDiscs(const Scene& scene, const Camera& camera, Layout layout)
    : setup_(camera),
      layout_(layout),
      columns_((static_cast<int>(camera.width) + layout.tile - 1) / layout.tile),
      rows_((static_cast<int>(camera.height) + layout.tile - 1) / layout.tile),
      chunks_((scene.surfels.size() + kChunk - 1) / kChunk) {
  tbb::parallel_for(std::size_t{0}, chunks_.size(),
                    [&](std::size_t i) { fill(chunks_[i], scene, i * kChunk); });
}

TiledDiscs::TileRange TiledDiscs::tilesOf(const ScreenDisc& disc) const {
  const auto tile = [&](float pixel, int count) {
    return std::clamp(static_cast<int>(pixel) / layout_.tile, 0, count - 1);
  };
  const float apron = static_cast<float>(layout_.apron);
  return {tile(disc.minX - apron, columns_), tile(disc.maxX + apron, columns_),
          tile(disc.minY - apron, rows_), tile(disc.maxY + apron, rows_)};
}

void TiledDiscs::fill(Chunk& chunk, const Scene& scene, std::size_t begin) const {
  const std::span<const Surfel> surfels = scene.surfels;
  const std::size_t end = std::min(surfels.size(), begin + kChunk);
  const std::size_t tiles = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  chunk.first.assign(tiles + 1, 0);
  chunk.discs.reserve((end - begin) / 2);
  const auto forTiles = [&](const ScreenDisc& disc, auto visit) {
    const TileRange range = tilesOf(disc);
    for (int row = range.row0; row <= range.row1; ++row)
      for (int column = range.column0; column <= range.column1; ++column)
        visit(static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
              static_cast<std::size_t>(column));
  };
  for (std::size_t i = begin; i < end; ++i) {
    ScreenDisc disc;
    if (!setup_.project(surfels[i], disc)) continue;
    disc.surfel = static_cast<std::uint32_t>(i);
    disc.kind = kindOf(scene, surfels[i].primitive, surfels[i].sign);
    forTiles(disc, [&](std::size_t tile) { ++chunk.first[tile + 1]; });
    chunk.discs.push_back(disc);
  }
  // Counting sort: it keeps the order of the surfels within a tile.
  for (std::size_t tile = 0; tile < tiles; ++tile) chunk.first[tile + 1] += chunk.first[tile];
  chunk.entries.resize(chunk.first[tiles]);
  std::vector<std::uint32_t> next(chunk.first.begin(), chunk.first.end() - 1);
  for (std::size_t i = 0; i < chunk.discs.size(); ++i)
    forTiles(chunk.discs[i],
             [&](std::size_t tile) { chunk.entries[next[tile]++] = static_cast<std::uint32_t>(i); });
}

}  // namespace restroke::points
