#pragma once
// What is drawn, and how it looks: shared by the CPU and the OpenGL renderer.

#include <array>
#include <cstdint>
#include <span>

#include "implicit/primitive_list.h"
#include "points/images/image.h"
#include "points/surfel.h"

namespace restroke::points {

/// Surfels with what made them. The spans must outlive the call.
struct Scene {
  std::span<const Surfel> surfels;
  /// For each list position the history node that made the primitive (0 is the base); empty, or too short for
  /// some primitive: not known, the stroke layer then says kNoId, and only primitive 0 counts as the base.
  std::span<const std::uint32_t> strokeOfPrimitive = {};
  /// The list that the surfels are of, and how much of it; null: not known. With it the CPU renderer draws
  /// edges in the colour picture exactly, by casting rays; without it creases fray, since discs stick out
  /// over them by up to their radius.
  const implicit::PrimitiveList* list = nullptr;
  implicit::Prefix prefix = {};
};

/// Linear red, green, blue, 0 to 1.
using LinearColor = std::array<float, 3>;

/// Albedo of what the surface belongs to. The defaults tell the three apart in print and to colour-blind
/// eyes, by lightness and by the contrast of warm and cool.
struct Palette {
  LinearColor base = {0.62f, 0.50f, 0.40f};
  LinearColor added = {0.68f, 0.37f, 0.22f};
  LinearColor carved = {0.16f, 0.27f, 0.35f};
};

enum class Occlusion : std::uint8_t {
  None,
  ScreenSpace,  ///< creases and hollows are darker, ridges a little lighter
};

/// What changes the colour picture. Depth, normals and ids depend on none of it.
struct RenderOptions {
  /// Samples a pixel for edges, 1 to 16; 1 is aliased. Only pixels near edges pay for more than one.
  int samples = 8;
  Occlusion occlusion = Occlusion::ScreenSpace;
  Palette palette = {};
};

/// Throws InputError unless every field is in its range.
void validate(const RenderOptions& options, std::string_view where);

/// Whether the surface of a primitive is base, added or carved (Scene::strokeOfPrimitive decides what is
/// base).
enum class SurfaceKind : std::uint8_t { Base, Added, Carved };
[[nodiscard]] inline SurfaceKind kindOf(const Scene& scene, std::uint32_t primitive, implicit::Sign sign) {
  if (sign == implicit::Sign::Negative) return SurfaceKind::Carved;
  const bool isBase =
      primitive < scene.strokeOfPrimitive.size() ? scene.strokeOfPrimitive[primitive] == 0 : primitive == 0;
  return isBase ? SurfaceKind::Base : SurfaceKind::Added;
}

}  // namespace restroke::points
