// Two passes over the discs of a tile, as in "Surface splatting" (M. Zwicker, H. Pfister, J. van Baar, M.
// Gross, SIGGRAPH 2001) and its hardware versions: the nearest disc first, then a blend of those that lie
// close behind it. We differ in that normals are blended and shaded once a sample (deferred), and that only
// pixels near edges are supersampled.

#include "points/images/cpu_renderer.h"

#include <tbb/blocked_range2d.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>

#include "implicit/parallel.h"
#include "implicit/ray_cast.h"
#include "points/images/occlusion.h"
#include "points/images/shading.h"
#include "points/images/tile_raster.h"

namespace restroke::points {
namespace {

/// Places of the samples after the first, which is the pixel's centre: the additive sequence of the plastic
/// number's powers, which fills the pixel evenly however many are taken.
SampleOffset sampleOffset(int i) {
  const auto fraction = [](double x) { return static_cast<float>(x - std::floor(x)); };
  if (i == 0) return {};
  return {fraction(0.5 + 0.7548776662466927 * i) - 0.5f, fraction(0.5 + 0.5698402909980532 * i) - 0.5f};
}

TileWindow clippedWindow(const Camera& camera, int x0, int y0) {
  TileWindow window;
  window.x0 = std::max(x0, 0);
  window.y0 = std::max(y0, 0);
  window.width = std::min(x0 + kTileSide, static_cast<int>(camera.width)) - window.x0;
  window.height = std::min(y0 + kTileSide, static_cast<int>(camera.height)) - window.y0;
  return window;
}

/// Sum of blending weights under which a surface thins out: inside a surface whose discs are 0.95 of the
/// lattice's spacing the sum is about 0.9, on a straight edge of it half as much, and where discs stick out
/// beyond their surface it is less.
constexpr float kThin = 0.75f;
/// Parts of the weights that one kind, and lengths of the mean normal, under which a pixel shows more than
/// one surface. The latter is the cosine of 9 degrees; discs on the curve of one stamp differ by less.
constexpr float kPure = 0.99f, kCoherent = 0.988f;

/// Memory that a thread uses for one tile after the other.
struct Workspace {
  NearestPlane nearest;
  BlendPlane blended;
  std::vector<const ScreenDisc*> discs;
  RowMasks edges;
  std::array<Vec3, std::size_t{kTileSide} * kTileSide>
      color;  // sums over samples, and how many of them were covered
  std::array<float, std::size_t{kTileSide} * kTileSide> covered;
};

using Workspaces = tbb::enumerable_thread_specific<std::unique_ptr<Workspace>>;
Workspace& local(Workspaces& workspaces) {
  std::unique_ptr<Workspace>& mine = workspaces.local();
  if (!mine) mine = std::make_unique<Workspace>();
  return *mine;
}

/// The colour renderer's state for one picture.
class Painter {
 public:
  Painter(const Scene& scene, const Camera& camera, const RenderOptions& options, RenderedImage& image)
      : scene_(scene),
        camera_(camera),
        options_(options),
        image_(image),
        // One pixel more on each side, so that edges between tiles are seen.
        tiles_(scene, camera, {.tile = kTileSide - 2, .apron = 1}),
        smooth_(camera.width, camera.height) {}

  void paint() {
    Workspaces workspaces;
    tbb::parallel_for(tbb::blocked_range2d<int>(0, tiles_.rows(), 1, 0, tiles_.columns(), 1),
                      [&](const auto& range) {
                        for (int row = range.rows().begin(); row != range.rows().end(); ++row)
                          for (int column = range.cols().begin(); column != range.cols().end(); ++column)
                            paintTile(column, row, local(workspaces));
                      });
    if (options_.occlusion == Occlusion::ScreenSpace) occlude();
  }

 private:
  void paintTile(int column, int row, Workspace& ws) {
    ws.discs.clear();
    tiles_.forEach(column, row, [&](const ScreenDisc& disc) { ws.discs.push_back(&disc); });
    if (ws.discs.empty()) return;
    const int side = kTileSide - 2;
    TilePass pass;
    pass.window = clippedWindow(camera_, column * side - 1, row * side - 1);
    pass.nearW = tiles_.setup().nearW();
    const TileWindow inner = {column * side, row * side,
                              std::min(side, static_cast<int>(camera_.width) - column * side),
                              std::min(side, static_cast<int>(camera_.height) - row * side)};
    drawSamples(ws, pass);
    writeLayers(ws, pass.window, inner);
    ws.edges.fill(0);
    const bool edges = options_.samples > 1 && findEdges(ws, pass.window, inner);
    shadeCentres(ws, pass.window, inner);
    if (edges) {
      pass.wanted = &ws.edges;
      for (int i = 0; i < options_.samples; ++i) {
        pass.offset = sampleOffset(i);
        if (scene_.list) {
          castEdges(ws, pass, inner);
          continue;
        }
        if (i > 0) drawSamples(ws, pass);
        shadeEdges(ws, pass, inner);
      }
    }
    writeColor(ws, pass.window, inner);
  }

  void drawSamples(Workspace& ws, const TilePass& pass) const {
    clear(ws.nearest, pass.window, tiles_.setup().farW());
    clear(ws.blended, pass.window);
    for (std::size_t i = 0; i < ws.discs.size(); ++i)
      drawNearest(ws.nearest, *ws.discs[i], static_cast<std::int32_t>(i), pass);
    for (const ScreenDisc* disc : ws.discs) blend(ws.blended, ws.nearest, *disc, pass);
  }

  template <class Visit>
  static void forPixels(const TileWindow& window, const TileWindow& inner, Visit visit) {
    for (int y = inner.y0; y < inner.y0 + inner.height; ++y)
      for (int x = inner.x0; x < inner.x0 + inner.width; ++x)
        visit(x, y, static_cast<std::size_t>((y - window.y0) * kTileStride + x - window.x0));
  }
  static std::size_t colorCell(const TileWindow& window, int x, int y) {
    return static_cast<std::size_t>((y - window.y0) * kTileSide + x - window.x0);
  }
  [[nodiscard]] std::size_t pixel(int x, int y) const {
    return static_cast<std::size_t>(y) * image_.width + static_cast<std::size_t>(x);
  }

  void writeLayers(const Workspace& ws, const TileWindow& window, const TileWindow& inner) {
    forPixels(window, inner, [&](int x, int y, std::size_t cell) {
      const std::int32_t number = ws.nearest.disc[cell];
      if (number < 0) return;
      const Surfel& surfel = scene_.surfels[ws.discs[static_cast<std::size_t>(number)]->surfel];
      const std::size_t p = pixel(x, y);
      image_.depth[p] = 1.0f / ws.nearest.w[cell];
      image_.normal[3 * p] = surfel.normal.x;
      image_.normal[3 * p + 1] = surfel.normal.y;
      image_.normal[3 * p + 2] = surfel.normal.z;
      image_.primitive[p] = surfel.primitive;
      if (surfel.primitive < scene_.strokeOfPrimitive.size())
        image_.stroke[p] = scene_.strokeOfPrimitive[surfel.primitive];
    });
  }

  [[nodiscard]] Vec3 blendedNormal(const Workspace& ws, std::size_t cell) const {
    const Vec3 sum(ws.blended.normalX[cell], ws.blended.normalY[cell], ws.blended.normalZ[cell]);
    const float size = length(sum);
    return size > 0 ? sum / size : Vec3(0, 0, 1);
  }

  [[nodiscard]] Vec3 shadedColor(const Workspace& ws, std::size_t cell, float x, float y) const {
    const Vec3 n = blendedNormal(ws, cell);
    const Vec3 d(tiles_.setup().directionX(x), tiles_.setup().directionY(y), -1.0f);
    const float scale = 1.0f / ws.blended.weight[cell];
    const Vec3 albedo =
        albedoOf(options_.palette, ws.blended.added[cell] * scale, ws.blended.carved[cell] * scale);
    return shade(look_, n, d * (-1.0f / length(d)), albedo);
  }

  /// All pixels but those at edges, which get their colour from all of their samples.
  void shadeCentres(Workspace& ws, const TileWindow& window, const TileWindow& inner) {
    forPixels(window, inner, [&](int x, int y, std::size_t cell) {
      const std::size_t c = colorCell(window, x, y);
      const bool hit = ws.nearest.disc[cell] >= 0;
      const bool shaded = hit && !isMarked(ws, window, x, y);
      ws.covered[c] = shaded ? 1.0f : 0.0f;
      ws.color[c] = shaded ? shadedColor(ws, cell, static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f)
                           : Vec3(0);
      if (!hit) return;
      smooth_.depth[pixel(x, y)] = 1.0f / ws.nearest.w[cell];
      smooth_.normal[pixel(x, y)] = blendedNormal(ws, cell);
    });
  }

  static bool isMarked(const Workspace& ws, const TileWindow& window, int x, int y) {
    return ws.edges[static_cast<std::size_t>(y - window.y0)] >> (x - window.x0) & 1;
  }

  /// Marks pixels that need more than one sample: where the surface thins out, and where a neighbour shows
  /// another one (another coverage, a jump in depth, a crease, another kind). True when there are any.
  static bool findEdges(Workspace& ws, const TileWindow& window, const TileWindow& inner) {
    bool any = false;
    const auto mark = [&](int x, int y) {
      if (x < inner.x0 || y < inner.y0 || x >= inner.x0 + inner.width || y >= inner.y0 + inner.height) return;
      ws.edges[static_cast<std::size_t>(y - window.y0)] |= std::uint64_t{1} << (x - window.x0);
      any = true;
    };
    const auto compare = [&](int x, int y, std::size_t cell, std::size_t other) {
      if (ws.nearest.disc[cell] == ws.nearest.disc[other] || !isEdge(ws, cell, other)) return;
      const bool below = other == cell + kTileStride;
      mark(x, y);
      mark(below ? x : x + 1, below ? y + 1 : y);
    };
    forPixels(window, window, [&](int x, int y, std::size_t cell) {
      if (x + 1 < window.x0 + window.width) compare(x, y, cell, cell + 1);
      if (y + 1 < window.y0 + window.height) compare(x, y, cell, cell + kTileStride);
      if (ws.nearest.disc[cell] >= 0 && (isThin(ws, cell) || isMixed(ws, cell))) mark(x, y);
    });
    return any;
  }

  static bool isThin(const Workspace& ws, std::size_t cell) { return ws.blended.weight[cell] < kThin; }

  /// Discs of different surfaces were blended here: a crease.
  static bool isMixed(const Workspace& ws, std::size_t cell) {
    const BlendPlane& b = ws.blended;
    const float all = b.weight[cell], most = kPure * all;
    if (std::max({b.added[cell], b.carved[cell], all - b.added[cell] - b.carved[cell]}) < most) return true;
    const Vec3 sum(b.normalX[cell], b.normalY[cell], b.normalZ[cell]);
    return dot(sum, sum) < kCoherent * kCoherent * all * all;
  }

  static bool isEdge(const Workspace& ws, std::size_t cell, std::size_t other) {
    const std::int32_t a = ws.nearest.disc[cell], b = ws.nearest.disc[other];
    if ((a < 0) != (b < 0)) return true;
    const ScreenDisc& p = *ws.discs[static_cast<std::size_t>(a)];
    const ScreenDisc& q = *ws.discs[static_cast<std::size_t>(b)];
    if (p.kind != q.kind) return true;
    if (p.normalX * q.normalX + p.normalY * q.normalY + p.normalZ * q.normalZ < 0.9f) return true;
    return std::fabs(ws.nearest.w[cell] - ws.nearest.w[other]) > p.window + q.window;
  }

  /// Adds one sample to every edge pixel: from the discs ...
  void shadeEdges(Workspace& ws, const TilePass& pass, const TileWindow& inner) const {
    forMarked(ws, pass.window, inner, [&](int x, int y, std::size_t cell) {
      if (ws.nearest.disc[cell] < 0) return;
      const std::size_t c = colorCell(pass.window, x, y);
      ws.covered[c] += 1.0f;
      ws.color[c] += shadedColor(ws, cell, static_cast<float>(x) + 0.5f + pass.offset.x,
                                 static_cast<float>(y) + 0.5f + pass.offset.y);
    });
  }

  /// ... or from the shape itself.
  void castEdges(Workspace& ws, const TilePass& pass, const TileWindow& inner) {
    const bool first = pass.offset.x == 0 && pass.offset.y == 0;  // the pixel's centre
    const CameraFrame& frame = tiles_.setup().frame();
    Ray ray;
    ray.origin = frame.position;
    ray.tMin = static_cast<double>(camera_.near);
    ray.tMax = static_cast<double>(camera_.far);
    forMarked(ws, pass.window, inner, [&](int x, int y, std::size_t) {
      const float dx = tiles_.setup().directionX(static_cast<float>(x) + 0.5f + pass.offset.x);
      const float dy = tiles_.setup().directionY(static_cast<float>(y) + 0.5f + pass.offset.y);
      ray.direction =
          frame.forward + static_cast<double>(dx) * frame.right + static_cast<double>(dy) * frame.up;
      const std::optional<implicit::RayHit> hit = implicit::castRay(*scene_.list, ray, scene_.prefix);
      if (first)
        smooth_.depth[pixel(x, y)] =
            hit ? static_cast<float>(hit->t) : std::numeric_limits<float>::infinity();
      if (!hit) return;
      const Vec3 n(dot(hit->normal, frame.right), dot(hit->normal, frame.up),
                   -dot(hit->normal, frame.forward));
      if (first) smooth_.normal[pixel(x, y)] = n;
      const auto primitive = static_cast<std::uint32_t>(scene_.list->positionOf(hit->primitive));
      const SurfaceKind kind = kindOf(scene_, primitive, (*scene_.list)[hit->primitive].sign);
      const Vec3 albedo = albedoOf(options_.palette, kind == SurfaceKind::Added ? 1.0f : 0.0f,
                                   kind == SurfaceKind::Carved ? 1.0f : 0.0f);
      const Vec3 d(dx, dy, -1.0f);
      const std::size_t c = colorCell(pass.window, x, y);
      ws.covered[c] += 1.0f;
      ws.color[c] += shade(look_, n, d * (-1.0f / length(d)), albedo);
    });
  }

  template <class Visit>
  static void forMarked(const Workspace& ws, const TileWindow& window, const TileWindow& inner, Visit visit) {
    for (int y = inner.y0; y < inner.y0 + inner.height; ++y) {
      std::uint64_t row = ws.edges[static_cast<std::size_t>(y - window.y0)];
      for (; row; row &= row - 1) {
        const int i = std::countr_zero(row), cell = (y - window.y0) * kTileStride + i;
        visit(window.x0 + i, y, static_cast<std::size_t>(cell));
      }
    }
  }

  void writeColor(const Workspace& ws, const TileWindow& window, const TileWindow& inner) {
    const float perSample = 1.0f / static_cast<float>(options_.samples);
    forPixels(window, inner, [&](int x, int y, std::size_t) {
      const std::size_t c = colorCell(window, x, y), p = pixel(x, y);
      const float scale = isMarked(ws, window, x, y) ? perSample : 1.0f;
      for (int channel = 0; channel < 3; ++channel)
        image_.rgba[4 * p + static_cast<std::size_t>(channel)] = ws.color[c][channel] * scale;
      image_.rgba[4 * p + 3] = ws.covered[c] * scale;
    });
  }

  void occlude() {
    const std::vector<float> factor = occlusionOf(smooth_, tiles_.setup());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, factor.size(), 1U << 14), [&](const auto& range) {
      for (std::size_t p = range.begin(); p != range.end(); ++p)
        for (std::size_t channel = 0; channel < 3; ++channel) image_.rgba[4 * p + channel] *= factor[p];
    });
  }

  const Scene& scene_;
  const Camera& camera_;
  const RenderOptions& options_;
  RenderedImage& image_;
  const Look look_;
  TiledDiscs tiles_;
  SurfaceBuffer smooth_;
};

}  // namespace

DepthImage renderDepth(std::span<const Surfel> surfels, const Camera& camera, const Execution& execution) {
  validateForImage(camera, "depth image");
  DepthImage image;
  image.width = camera.width;
  image.height = camera.height;
  image.depth.resize(std::size_t{camera.width} * camera.height, std::numeric_limits<float>::infinity());
  inArena(execution, [&] {
    const TiledDiscs tiles({.surfels = surfels}, camera, {.tile = kTileSide, .apron = 0});
    Workspaces workspaces;
    const auto drawTile = [&](int column, int row) {
      NearestPlane& nearest = local(workspaces).nearest;
      TilePass pass;
      pass.window = clippedWindow(camera, column * kTileSide, row * kTileSide);
      pass.nearW = tiles.setup().nearW();
      clear(nearest, pass.window, tiles.setup().farW());
      tiles.forEach(column, row, [&](const ScreenDisc& disc) { drawNearest(nearest, disc, 0, pass); });
      for (int y = 0; y < pass.window.height; ++y)
        for (int x = 0; x < pass.window.width; ++x) {
          const int place = y * kTileStride + x;
          const auto cell = static_cast<std::size_t>(place);
          if (nearest.disc[cell] >= 0)
            image.depth[static_cast<std::size_t>(pass.window.y0 + y) * image.width +
                        static_cast<std::size_t>(pass.window.x0 + x)] = 1.0f / nearest.w[cell];
        }
    };
    tbb::parallel_for(tbb::blocked_range2d<int>(0, tiles.rows(), 1, 0, tiles.columns(), 1),
                      [&](const auto& range) {
                        for (int row = range.rows().begin(); row != range.rows().end(); ++row)
                          for (int column = range.cols().begin(); column != range.cols().end(); ++column)
                            drawTile(column, row);
                      });
  });
  return image;
}

RenderedImage render(const Scene& scene, const Camera& camera, const RenderOptions& options,
                     const Execution& execution) {
  validateForImage(camera, "picture");
  validate(options, "picture");
  RenderedImage image;
  image.width = camera.width;
  image.height = camera.height;
  image.rgba.resize(4 * image.pixels());
  image.depth.resize(image.pixels(), std::numeric_limits<float>::infinity());
  image.normal.resize(3 * image.pixels());
  image.primitive.resize(image.pixels(), kNoId);
  image.stroke.resize(image.pixels(), kNoId);
  inArena(execution, [&] { Painter(scene, camera, options, image).paint(); });
  return image;
}

}  // namespace restroke::points
