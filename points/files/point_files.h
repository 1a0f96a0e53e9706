#pragma once
// Surfels as point clouds with normals, for other programs: PLY and XYZ.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "points/surfel.h"

namespace restroke::points {

enum class PlyFormat : std::uint8_t { BinaryLittleEndian, Ascii };

struct PlyOptions {
  PlyFormat format = PlyFormat::BinaryLittleEndian;
  /// Lines for the header ("comment ..."), without line breaks.
  std::vector<std::string> comments = {};
};

/// Writes PLY 1.0 with one element, `vertex`, with the float properties x, y, z (model units), nx, ny, nz
/// (unit, out of the shape) and radius (of the disc, model units), in the order of the surfels. No surfels: a
/// valid file of 0 vertices. Ascii numbers are the shortest that read back as the same float32. Written
/// beside its final name and renamed. Throws InputError that names the file when it cannot be written, a
/// number of a surfel is not finite, or a comment has a line break. O(surfels) time and memory.
void writePly(const std::filesystem::path& path, std::span<const Surfel> surfels,
              const PlyOptions& options = {});

/// Writes a line "x y z nx ny nz" for each surfel, numbers as in ascii PLY. No surfels: an empty file. Errors
/// as writePly.
void writeXyz(const std::filesystem::path& path, std::span<const Surfel> surfels);

}  // namespace restroke::points
