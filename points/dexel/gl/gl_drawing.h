#pragma once
// How the polygons of a mesh lie in buffers (kHullMain in gl_peeling_shaders.h). Internal to points/dexel/gl.

#include <cstddef>

namespace restroke::points {

inline constexpr std::size_t kCornersPerTriangle = 7, kElementsPerTriangle = 3 * (kCornersPerTriangle - 2);
/// Drawn together. What begins a batch lies at a multiple of 256 bytes, as bindings need it.
inline constexpr std::size_t kTrianglesPerBatch = 1 << 15;
inline constexpr std::size_t kBytesPerTriangle = 9 * sizeof(float),
                             kBytesPerPolygon = 2 * kCornersPerTriangle * sizeof(float);

}  // namespace restroke::points
