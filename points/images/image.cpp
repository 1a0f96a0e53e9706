#include "points/images/image.h"

#include "implicit/errors.h"
#include "points/images/scene.h"

namespace restroke::points {

void validateForImage(const Camera& camera, std::string_view where) {
  restroke::validate(camera, std::string(where));
  if (std::size_t{camera.width} * camera.height > kMaxPixels)
    throw InputError(fmt::format("{}: the viewport is {} x {} pixels; an image has at most {} pixels", where,
                                 camera.width, camera.height, kMaxPixels));
}

void validate(const RenderOptions& options, std::string_view where) {
  if (options.samples < 1 || options.samples > 16)
    throw InputError(fmt::format("{}: {} samples a pixel; it must be 1 to 16", where, options.samples));
  for (const LinearColor* color : {&options.palette.base, &options.palette.added, &options.palette.carved})
    for (const float channel : *color)
      if (!(channel >= 0.0f && channel <= 1.0f))
        throw InputError(fmt::format("{}: a colour of the palette has a channel of {}; it must be 0 to 1",
                                     where, channel));
}

}  // namespace restroke::points
