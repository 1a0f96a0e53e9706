#include "points/dexel/refine/ray_picture.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "implicit/errors.h"
#include "implicit/parallel.h"
#include "points/dexel/end_maker.h"
#include "points/images/occlusion.h"
#include "points/images/shading.h"

namespace restroke::points {

namespace {

class RayPainter {
 public:
  RayPainter(const Dexels& rays, const Camera& camera, const RenderOptions& options)
      : rays_(rays),
        across_(rays.width() / static_cast<int>(camera.width)),
        lines_(raysOf(withRays(camera, across_))),
        frame_(frameOf(camera)),
        palette_(options.palette) {
    RESTROKE_CHECK_EQ(rays.width() == lines_.width && rays.height() == lines_.height, true);
    image_.width = camera.width;
    image_.height = camera.height;
    image_.rgba.resize(4 * image_.pixels());
    image_.depth.assign(image_.pixels(), std::numeric_limits<float>::infinity());
    image_.normal.resize(3 * image_.pixels());
    image_.primitive.assign(image_.pixels(), kNoId);
    image_.stroke.assign(image_.pixels(), kNoId);
    surface_.resize(image_.width, image_.height);
    std::fill(surface_.depth.begin(), surface_.depth.end(), std::numeric_limits<float>::infinity());
  }

  void paintRow(std::uint32_t y) {
    LineEnds ends;
    for (std::uint32_t x = 0; x < image_.width; ++x) {
      Vec3 sum(0);
      int hits = 0;
      for (int j = 0; j < across_; ++j)
        for (int i = 0; i < across_; ++i) {
          const int column = static_cast<int>(x) * across_ + i, row = static_cast<int>(y) * across_ + j;
          rays_.read(rays_.lineAt(column, row), ends);
          if (ends.empty()) continue;
          ++hits;
          const bool isMiddle = i == across_ / 2 && j == across_ / 2;
          sum += colorOf(ends.front(), column, row, isMiddle ? y * image_.width + x : kNoPixel);
        }
      const float part = 1.0f / static_cast<float>(across_ * across_);
      float* const rgba = &image_.rgba[4 * (std::size_t{y} * image_.width + x)];
      for (int c = 0; c < 3; ++c) rgba[c] = sum[c] * part;
      rgba[3] = static_cast<float>(hits) * part;
    }
  }

  RenderedImage finish(const Camera& camera, Occlusion occlusion) {
    if (occlusion == Occlusion::ScreenSpace) {
      const std::vector<float> factor = occlusionOf(surface_, ScreenSetup(camera));
      for (std::size_t p = 0; p < factor.size(); ++p)
        for (std::size_t c = 0; c < 3; ++c) image_.rgba[4 * p + c] *= factor[p];
    }
    return std::move(image_);
  }

 private:
  static constexpr std::uint32_t kNoPixel = ~0u;

  // The colour of a ray's first end; of a pixel's middle ray the layers too.
  Vec3 colorOf(const SpanEnd& end, int column, int row, std::uint32_t pixel) {
    const Vec3 direction(lines_.line(column, row).direction);
    const Vec3 normal = unpackNormal(end.normal);
    const EndMaker maker = makerOf(end, rays_.keepsOperations());
    const auto inCamera = [&](Vec3 v) {
      return Vec3(dot(v, Vec3(frame_.right)), dot(v, Vec3(frame_.up)), -dot(v, Vec3(frame_.forward)));
    };
    const Vec3 n = inCamera(normal);
    if (pixel != kNoPixel) {
      image_.depth[pixel] = surface_.depth[pixel] = end.depth * dot(direction, Vec3(frame_.forward));
      surface_.normal[pixel] = n;
      for (int a = 0; a < 3; ++a)
        image_.normal[3 * std::size_t{pixel} + static_cast<std::size_t>(a)] = normal[a];
      image_.primitive[pixel] = maker.operation;
    }
    const SurfaceKind kind = kindOf({}, maker.operation, maker.sign);
    const Vec3 albedo =
        albedoOf(palette_, kind == SurfaceKind::Added ? 1 : 0, kind == SurfaceKind::Carved ? 1 : 0);
    return shade(look_, n, inCamera(-direction), albedo);
  }

  const Dexels& rays_;
  int across_;
  LineFamily lines_;
  CameraFrame frame_;
  Palette palette_;
  Look look_;
  RenderedImage image_;
  SurfaceBuffer surface_;
};

}  // namespace

Camera withRays(Camera camera, int across) {
  if (across < 1 || across > kMostRaysAcross)
    throw InputError(
        fmt::format("{} rays across a pixel were asked for; there must be 1 to {}", across, kMostRaysAcross));
  camera.width *= static_cast<std::uint32_t>(across);
  camera.height *= static_cast<std::uint32_t>(across);
  validate(camera, "the rays of a picture");
  return camera;
}

RenderedImage pictureOf(const Dexels& rays, const Camera& camera, const RenderOptions& options,
                        const Execution& execution) {
  validateForImage(camera, "the picture");
  validate(options, "the picture");
  RayPainter painter(rays, camera, options);
  RenderedImage image;
  inArena(execution, [&] {
    tbb::parallel_for(std::uint32_t{0}, camera.height, [&](std::uint32_t y) { painter.paintRow(y); });
    image = painter.finish(camera, options.occlusion);
  });
  return image;
}

}  // namespace restroke::points
