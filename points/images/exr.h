#pragma once
// Pictures with layers for other programs: OpenEXR.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "implicit/geometry/camera.h"
#include "points/images/image.h"

namespace restroke::points {

/// What a file carries besides the layers and the camera.
struct ExrOptions {
  /// Name and text of string attributes, for instance {"restroke:revision", "1a2b3c4"}. Names are not empty,
  /// differ from each other and from the standard attributes', and have at most 255 bytes.
  std::vector<std::pair<std::string, std::string>> attributes = {};
};

/// Writes one scan-line part, zip-compressed, beside its final name and renamed, with the channels
///   R, G, B, A            half    linear, premultiplied (RenderedImage::rgba)
///   Z                     float   distance along the view, model units; +infinity where there is no surface
///   N.X, N.Y, N.Z         float   unit normal in model space; 0 where there is no surface
///   id.primitive          uint    list position of the owner; 4294967295 where there is no surface
///   id.stroke             uint    history node of the owner; 4294967295 where there is none
/// and the camera as the standard attributes worldToCamera and worldToNDC, by OpenEXR's conventions: row
/// vectors are multiplied from the left; camera space is left-handed with x right, y up, z along the view;
/// NDC is (0, 0) at the upper left and (1, 1) at the lower right corner of the image. worldToNDC's z runs
/// from 0 at the near to 1 at the far plane.
///
/// Throws InputError that names the file: not writable, disk full, an image of 0 pixels, a camera with
/// another viewport than the image, an attribute name out of range.
void writeExr(const std::filesystem::path& path, const RenderedImage& image, const Camera& camera,
              const ExrOptions& options = {});

}  // namespace restroke::points
