#pragma once
// Pictures for the screen: 8 bits, sRGB.

#include <cstdint>
#include <filesystem>
#include <vector>

#include "points/images/image.h"
#include "points/images/scene.h"

namespace restroke::points {

/// sRGB with straight (not premultiplied) alpha, row-major, the top left pixel first, 4 bytes a pixel.
struct DisplayImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> rgba;
};

/// What stands behind the shape.
enum class Backdrop : std::uint8_t {
  Studio,       ///< a soft grey gradient, opaque
  Transparent,  ///< nothing: alpha is coverage
};

struct DisplayOptions {
  Backdrop backdrop = Backdrop::Studio;
};

/// Linear colour to sRGB. Gradients are dithered by less than one step with a fixed pattern, so that no bands
/// show; same image, same bytes. Values beyond 1 are cut off.
[[nodiscard]] DisplayImage toDisplay(const RenderedImage& image, const DisplayOptions& options = {});
[[nodiscard]] DisplayImage toDisplay(const ColorImage& image, const DisplayOptions& options = {});

/// Writes the picture as PNG with an sRGB chunk, beside its final name and renamed. Throws InputError that
/// names the file (not writable, disk full), or says that an image of 0 pixels cannot be stored.
void writePng(const std::filesystem::path& path, const DisplayImage& image);
/// toDisplay, then writePng.
void writePng(const std::filesystem::path& path, const RenderedImage& image,
              const DisplayOptions& options = {});

}  // namespace restroke::points
