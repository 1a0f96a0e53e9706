#include "points/images/png.h"

#include <png.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "implicit/atomic_file.h"
#include "implicit/errors.h"

namespace restroke::points {
namespace {

/// IEC 61966-2-1. The only use of pow: what it decides is the last bit of a displayed byte.
float encodeSrgb(float linear) {
  const float x = std::clamp(linear, 0.0f, 1.0f);
  return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
}

/// encodeSrgb at 4096 places, interpolated: within 1/20 of a step of a byte except in the darkest hundredth,
/// where the square root in the argument gives it the places that it needs.
class SrgbTable {
 public:
  SrgbTable() {
    for (int i = 0; i <= kSteps; ++i) {
      const float root = static_cast<float>(i) / kSteps;
      values_[static_cast<std::size_t>(i)] = encodeSrgb(root * root);
    }
  }
  [[nodiscard]] float operator()(float linear) const {
    const float place = std::sqrt(std::clamp(linear, 0.0f, 1.0f)) * kSteps;
    const int i = std::min(static_cast<int>(place), kSteps - 1);
    const float part = place - static_cast<float>(i);
    const auto index = static_cast<std::size_t>(i);
    return values_[index] + (values_[index + 1] - values_[index]) * part;
  }

 private:
  static constexpr int kSteps = 4096;
  std::array<float, kSteps + 1> values_{};
};

/// The studio: lighter towards a spot behind the shape, darker to the corners.
Vec3 studio(float x, float y) {
  const float dx = x - 0.5f, dy = y - 0.46f;
  const float distance = dx * dx * 1.3f + dy * dy * 1.6f;
  const float glow = 1.0f / (1.0f + 3.2f * distance);
  const Vec3 middle(0.230f, 0.238f, 0.252f), corner(0.030f, 0.034f, 0.043f);
  return corner + (middle - corner) * (glow * glow);
}

/// Ordered dither: where in (0, 1) a value's fraction must lie to be rounded up. Interleaved gradient noise
/// (J. Jimenez, "Next generation post processing in Call of Duty", SIGGRAPH 2014).
float threshold(std::uint32_t x, std::uint32_t y) {
  const auto fraction = [](float v) { return v - static_cast<float>(static_cast<int>(v)); };  // v >= 0
  return fraction(52.9829189f *
                  fraction(0.06711056f * static_cast<float>(x) + 0.00583715f * static_cast<float>(y)));
}

template <class Image>
DisplayImage display(const Image& image, const DisplayOptions& options) {
  static const SrgbTable encode;
  DisplayImage out;
  out.width = image.width;
  out.height = image.height;
  out.rgba.resize(image.rgba.size());
  tbb::parallel_for(std::uint32_t{0}, image.height, [&](std::uint32_t y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const std::size_t p = std::size_t{y} * image.width + x;
      const float* const source = &image.rgba[4 * p];
      float alpha = source[3];
      Vec3 color(source[0], source[1], source[2]);
      if (options.backdrop == Backdrop::Studio) {
        color += studio((static_cast<float>(x) + 0.5f) / static_cast<float>(image.width),
                        (static_cast<float>(y) + 0.5f) / static_cast<float>(image.height)) *
                 (1.0f - alpha);
        alpha = 1.0f;
      } else if (alpha > 0.0f) {
        color /= alpha;
      }
      const float up = threshold(x, y);
      for (int channel = 0; channel < 3; ++channel)
        out.rgba[4 * p + static_cast<std::size_t>(channel)] =
            static_cast<std::uint8_t>(std::min(encode(color[channel]) * 255.0f + up, 255.0f));
      out.rgba[4 * p + 3] = static_cast<std::uint8_t>(std::lround(std::clamp(alpha, 0.0f, 1.0f) * 255.0f));
    }
  });
  return out;
}

}  // namespace

DisplayImage toDisplay(const RenderedImage& image, const DisplayOptions& options) {
  return display(image, options);
}
DisplayImage toDisplay(const ColorImage& image, const DisplayOptions& options) {
  return display(image, options);
}

void writePng(const std::filesystem::path& path, const DisplayImage& image) {
  if (image.width == 0 || image.height == 0)
    throw InputError(fmt::format("{}: the image has {} x {} pixels; a PNG has at least one", path.string(),
                                 image.width, image.height));
  AtomicFile file(path);
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = image.width;
  png.height = image.height;
  png.format = PNG_FORMAT_RGBA;
  // The simplified interface of libpng reports errors instead of jumping; into memory, so that the system's
  // reason for a failed write is AtomicFile's to tell.
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::vector<char> bytes(size);
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgba.data(), 0, nullptr))
    throw InputError(fmt::format("{}: cannot encode the picture: {}", path.string(), png.message));
  file.write(std::string_view(bytes.data(), size));
  file.commit();
}

void writePng(const std::filesystem::path& path, const RenderedImage& image, const DisplayOptions& options) {
  writePng(path, toDisplay(image, options));
}

}  // namespace restroke::points
