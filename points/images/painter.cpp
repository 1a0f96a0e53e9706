// Two passes over the discs of a tile, as in "Surface splatting" (M. Zwicker, H. Pfister, J. van Baar, M.
// Gross, SIGGRAPH 2001) and its hardware versions: the nearest disc first, then a blend of those that lie
// close behind it. We differ in that normals are blended and shaded once a sample (deferred), and that only
// pixels near edges are supersampled.

#include "points/images/painter.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "implicit/ray_cast.h"
#include "points/images/tile_edges.h"

namespace restroke::points {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Places of the samples after the first, which is the pixel's centre: the additive sequence of the plastic
/// number's powers, which fills the pixel evenly however many are taken.
SampleOffset sampleOffset(int i) {
  const auto fraction = [](double x) { return static_cast<float>(x - std::floor(x)); };
  if (i == 0) return {};
  return {fraction(0.5 + 0.7548776662466927 * i) - 0.5f, fraction(0.5 + 0.5698402909980532 * i) - 0.5f};
}

void copy(float (&to)[3], Vec3 from) {
  to[0] = from.x, to[1] = from.y, to[2] = from.z;
}
void copy(float (&to)[3], const LinearColor& from) {
  std::copy(from.begin(), from.end(), to);
}

ShadingSetup shadingOf(const Look& look, const Palette& palette, const ScreenSetup& setup) {
  ShadingSetup out = {};
  out.farW = setup.farW();
  out.firstX = setup.firstX(), out.stepX = setup.stepX();
  out.firstY = setup.firstY(), out.stepY = setup.stepY();
  copy(out.key, look.key), copy(out.fill, look.fill), copy(out.rim, look.rim);
  copy(out.keyColor, look.keyColor), copy(out.fillColor, look.fillColor), copy(out.rimColor, look.rimColor);
  copy(out.sky, look.sky), copy(out.ground, look.ground);
  out.wrap = look.wrap, out.gloss = look.gloss, out.sheen = look.sheen;
  copy(out.base, palette.base), copy(out.added, palette.added), copy(out.carved, palette.carved);
  return out;
}

Vec3 blendedNormal(const BlendPlane& blended, std::size_t cell) {
  const Vec3 sum(blended.normalX[cell], blended.normalY[cell], blended.normalZ[cell]);
  const float size = length(sum);
  return size > 0 ? sum / size : Vec3(0, 0, 1);
}

std::size_t edgeCell(const TileWindow& window, int x, int y) {
  return static_cast<std::size_t>((y - window.y0) * kTileSide + x - window.x0);
}

}  // namespace

Painter::Painter(const Task& task, PaintMemory& memory, RenderedImage& image)
    : task_(task),
      memory_(memory),
      image_(image),
      kernels_(pictureKernels()),
      setup_(task.camera),
      shading_(shadingOf(look_, task.options.palette, setup_)) {
  // One pixel more on each side, so that edges between tiles are seen.
  if (supersampled()) layout_ = {.tile = kTileSide - 2, .apron = 1};
  if (occluded()) memory_.smooth.resize(image.width, image.height);
}

void Painter::paint() {
  memory_.tiles.fill(task_.scene, setup_, layout_);
  forgetOtherBlanks();
  forTiles(memory_.tiles, memory_.workspaces,
           [&](int column, int row, Workspace& ws) { paintTile(column, row, ws); });
  if (occluded()) occlude();
}

void Painter::forgetOtherBlanks() {
  BlankTiles& blanks = memory_.blanks;
  const std::size_t count =
      static_cast<std::size_t>(memory_.tiles.columns()) * static_cast<std::size_t>(memory_.tiles.rows());
  if (blanks.width == image_.width && blanks.height == image_.height && blanks.tile == layout_.tile &&
      blanks.occluded == occluded() && blanks.blank.size() == count)
    return;
  blanks.width = image_.width;
  blanks.height = image_.height;
  blanks.tile = layout_.tile;
  blanks.occluded = occluded();
  blanks.blank.assign(count, 0);
}

void Painter::paintTile(int column, int row, Workspace& ws) {
  const int side = layout_.tile;
  const TileWindow inner = {column * side, row * side,
                            std::min(side, static_cast<int>(image_.width) - column * side),
                            std::min(side, static_cast<int>(image_.height) - row * side)};
  std::uint8_t& blank =
      memory_.blanks.blank[static_cast<std::size_t>(row * memory_.tiles.columns() + column)];
  if (ws.discs.empty()) {
    if (blank == 0) writeNothing(inner);
    blank = 1;
    return;
  }
  blank = 0;
  TilePass pass;
  pass.window = clippedWindow(task_.camera, inner.x0 - layout_.apron, inner.y0 - layout_.apron);
  pass.nearW = setup_.nearW();
  drawSamples(ws, pass);
  writeCentres(ws, pass.window, inner);
  if (supersampled() && findEdges(ws, pass.window, inner)) paintEdges(ws, pass, inner);
}

void Painter::drawSamples(Workspace& ws, const TilePass& pass) const {
  clear(ws.nearest, pass.window, setup_.farW());
  clear(ws.blended, pass.window);
  kernels_.drawNearest(ws.nearest, ws.list(), pass);
  kernels_.blend(ws.blended, ws.nearest, ws.list(), pass);
}

/// Everything as the pixels' centres show it.
void Painter::writeCentres(const Workspace& ws, const TileWindow& window, const TileWindow& inner) {
  TileTarget target = {};
  target.x0 = inner.x0, target.y0 = inner.y0, target.width = inner.width, target.height = inner.height;
  target.cell = static_cast<std::size_t>((inner.y0 - window.y0) * kTileStride + inner.x0 - window.x0);
  target.pitch = image_.width;
  target.rgba = image_.rgba.data();
  if (occluded()) {
    target.smoothNormal = &memory_.smooth.normal.data()->x;
    target.depth = memory_.smooth.depth.data();
    kernels_.writeDepth(ws.nearest, setup_.farW(), target);
  }
  kernels_.shade(shading_, ws.nearest, ws.blended, target);
  if (task_.layers.depth) {
    target.depth = image_.depth.data();
    kernels_.writeDepth(ws.nearest, setup_.farW(), target);
  }
  if (task_.layers.normal || task_.layers.ids) writeIds(ws, window, inner);
}

void Painter::writeNothing(const TileWindow& inner) {
  const auto width = static_cast<std::size_t>(inner.width);
  for (int y = inner.y0; y < inner.y0 + inner.height; ++y) {
    const std::size_t p = pixel(inner.x0, y);
    std::fill_n(image_.rgba.data() + 4 * p, 4 * width, 0.0f);
    if (occluded()) std::fill_n(memory_.smooth.depth.data() + p, width, kInfinity);
    if (task_.layers.depth) std::fill_n(image_.depth.data() + p, width, kInfinity);
    if (task_.layers.normal) std::fill_n(image_.normal.data() + 3 * p, 3 * width, 0.0f);
    if (!task_.layers.ids) continue;
    std::fill_n(image_.primitive.data() + p, width, kNoId);
    std::fill_n(image_.stroke.data() + p, width, kNoId);
  }
}

void Painter::writeIds(const Workspace& ws, const TileWindow& window, const TileWindow& inner) {
  const Scene& scene = task_.scene;
  forPixels(window, inner, [&](int x, int y, std::size_t cell) {
    const std::size_t p = pixel(x, y);
    const std::int32_t number = ws.nearest.disc[cell];
    const ScreenDisc* const disc = number < 0 ? nullptr : ws.discs[static_cast<std::size_t>(number)];
    if (task_.layers.normal) {
      const Vec3 normal = disc ? scene.surfels[disc->surfel].normal : Vec3(0);
      std::copy_n(&normal.x, 3, image_.normal.data() + 3 * p);
    }
    if (!task_.layers.ids) return;
    const std::uint32_t primitive = disc ? disc->primitive : kNoId;
    image_.primitive[p] = primitive;
    image_.stroke[p] =
        primitive < scene.strokeOfPrimitive.size() ? scene.strokeOfPrimitive[primitive] : kNoId;
  });
}

/// The marked pixels get their colour from all of their samples.
void Painter::paintEdges(Workspace& ws, TilePass pass, const TileWindow& inner) {
  forMarked(ws.edges, pass.window, inner, [&](int x, int y, std::size_t) {
    const std::size_t c = edgeCell(pass.window, x, y);
    ws.covered[c] = 0;
    ws.color[c] = Vec3(0);
  });
  pass.wanted = &ws.edges;
  for (int i = 0; i < task_.options.samples; ++i) {
    pass.offset = sampleOffset(i);
    if (task_.scene.list) {
      castEdges(ws, pass, inner);
      continue;
    }
    if (i > 0) drawSamples(ws, pass);
    shadeEdges(ws, pass, inner);
  }
  writeEdges(ws, pass.window, inner);
}

/// Adds one sample to every edge pixel: from the discs ...
void Painter::shadeEdges(Workspace& ws, const TilePass& pass, const TileWindow& inner) const {
  forMarked(ws.edges, pass.window, inner, [&](int x, int y, std::size_t cell) {
    if (ws.nearest.disc[cell] < 0) return;
    const Vec3 d(setup_.directionX(static_cast<float>(x) + 0.5f + pass.offset.x),
                 setup_.directionY(static_cast<float>(y) + 0.5f + pass.offset.y), -1.0f);
    const float scale = 1.0f / ws.blended.weight[cell];
    const Vec3 albedo =
        albedoOf(task_.options.palette, ws.blended.added[cell] * scale, ws.blended.carved[cell] * scale);
    const std::size_t c = edgeCell(pass.window, x, y);
    ws.covered[c] += 1.0f;
    ws.color[c] += shade(look_, blendedNormal(ws.blended, cell), d * (-1.0f / length(d)), albedo);
  });
}

/// ... or from the shape itself.
void Painter::castEdges(Workspace& ws, const TilePass& pass, const TileWindow& inner) {
  const bool first = occluded() && pass.offset.x == 0 && pass.offset.y == 0;  // the pixel's centre
  const Scene& scene = task_.scene;
  const CameraFrame& frame = setup_.frame();
  Ray ray;
  ray.origin = frame.position;
  ray.tMin = static_cast<double>(task_.camera.near);
  ray.tMax = static_cast<double>(task_.camera.far);
  forMarked(ws.edges, pass.window, inner, [&](int x, int y, std::size_t) {
    const float dx = setup_.directionX(static_cast<float>(x) + 0.5f + pass.offset.x);
    const float dy = setup_.directionY(static_cast<float>(y) + 0.5f + pass.offset.y);
    ray.direction =
        frame.forward + static_cast<double>(dx) * frame.right + static_cast<double>(dy) * frame.up;
    const std::optional<implicit::RayHit> hit = implicit::castRay(*scene.list, ray, scene.prefix);
    if (first) memory_.smooth.depth[pixel(x, y)] = hit ? static_cast<float>(hit->t) : kInfinity;
    if (!hit) return;
    const Vec3 n(dot(hit->normal, frame.right), dot(hit->normal, frame.up), -dot(hit->normal, frame.forward));
    if (first) memory_.smooth.normal[pixel(x, y)] = n;
    const auto primitive = static_cast<std::uint32_t>(scene.list->positionOf(hit->primitive));
    const SurfaceKind kind = kindOf(scene, primitive, (*scene.list)[hit->primitive].sign);
    const Vec3 albedo = albedoOf(task_.options.palette, kind == SurfaceKind::Added ? 1.0f : 0.0f,
                                 kind == SurfaceKind::Carved ? 1.0f : 0.0f);
    const Vec3 d(dx, dy, -1.0f);
    const std::size_t c = edgeCell(pass.window, x, y);
    ws.covered[c] += 1.0f;
    ws.color[c] += shade(look_, n, d * (-1.0f / length(d)), albedo);
  });
}

void Painter::writeEdges(const Workspace& ws, const TileWindow& window, const TileWindow& inner) {
  const float perSample = 1.0f / static_cast<float>(task_.options.samples);
  forMarked(ws.edges, window, inner, [&](int x, int y, std::size_t) {
    const std::size_t c = edgeCell(window, x, y);
    float* const rgba = image_.rgba.data() + 4 * pixel(x, y);
    const Vec3 color = ws.color[c] * perSample;
    std::copy_n(&color.x, 3, rgba);
    rgba[3] = ws.covered[c] * perSample;
  });
}

void Painter::occlude() {
  const std::vector<float> factor = occlusionOf(memory_.smooth, setup_);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, factor.size(), 1U << 14), [&](const auto& range) {
    for (std::size_t p = range.begin(); p != range.end(); ++p)
      for (std::size_t channel = 0; channel < 3; ++channel) image_.rgba[4 * p + channel] *= factor[p];
  });
}

}  // namespace restroke::points
