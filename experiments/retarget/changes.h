#pragma once
// What happens to a base in the retargeting experiment, so that the truth is known: a map of space, and the
// base's image under it (SPEC X2).

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "implicit/geometry/space_map.h"
#include "implicit/shape.h"

namespace restroke::experiments {

enum class ChangeKind : std::uint8_t { Translate, Rotate, Scale, Motion, Stretch, Bend, Twist, Bulge, Patch };

struct ChangeInfo {
  ChangeKind kind;
  std::string_view name;
  std::string_view unit;     ///< of the strength
  std::string_view meaning;  ///< one clause
  std::vector<double> strengths;
  std::vector<double> smokeStrengths;
};
/// All kinds, in the order of the enumeration.
[[nodiscard]] std::span<const ChangeInfo> changeKinds();
[[nodiscard]] const ChangeInfo& infoOf(ChangeKind kind);
/// Translations, turns, even scales: what a camera can follow.
[[nodiscard]] bool isSimilarity(ChangeKind kind);

/// Where a change takes place.
struct ChangeSite {
  implicit::Shape base;
  std::span<const Point> kept = {};  ///< of Patch: surface points around which nothing but the motion happens
  DVec3 middle{0};                   ///< of Bulge: the surface point that it is set under
  DVec3 outward{0, 0, 1};            ///< the surface's normal there
  std::uint64_t seed = 1;            ///< of directions and axes
};

/// The known map, and the shape that the base becomes by it.
struct KnownChange {
  std::unique_ptr<const SpaceMap> map;
  /// Motions: how much lengths grow. Nothing for other maps.
  std::optional<double> motionScale;
  implicit::Shape image;
  /// The image is the base's kind under the map, right but for the rounding of its parameters (or of
  /// vertices) to float32; else a fine mesh.
  bool exactImage = true;
  double chordError = 0;   ///< of a fine mesh (MappedMesh), model units
  double patchRadius = 0;  ///< Patch: how far around the stroke nothing but the motion happens
};

/// Most triangles of a fine mesh, and its edges' length as a fraction of the base's size.
struct ImageOptions {
  std::size_t mostTriangles = 20'000;
  double edge = 0.025;
};

/// Directions and axes are drawn from the seed. Maps that are affine have parameters that were rounded to
/// float32 first, so that a base posed by them is their image. Throws InputError when the image is no solid.
[[nodiscard]] KnownChange makeChange(ChangeKind kind, double strength, const ChangeSite& site,
                                     const ImageOptions& options = {});

/// The shape scaled about the origin, then moved.
[[nodiscard]] implicit::Shape similarTo(const implicit::Shape& shape, double scale, DVec3 shift);

/// Diagonal of the shape's box: what translations and errors of images are measured by.
[[nodiscard]] double sizeOf(const implicit::Shape& shape);

}  // namespace restroke::experiments
