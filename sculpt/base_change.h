#pragma once
// What a transform makes of a base.

#include <array>
#include <string>
#include <string_view>

#include "implicit/geometry/space_map.h"
#include "implicit/shape.h"

namespace restroke::sculpt {

/// 3 x 4 numbers, rows first, as a TransformCommand and the log have them.
[[nodiscard]] Affine affineOf(const std::array<float, 12>& matrix);
[[nodiscard]] std::array<float, 12> matrixOf(const Affine& affine);

/// The exact image, but for float32: a sphere or an ellipsoid under any map that keeps sides apart (an
/// ellipsoid), a mesh under any such map (its vertices are mapped), any other shape turned, scaled evenly and
/// moved. Computed with + - * / and sqrt in a fixed order: the same bits everywhere. Throws InputError
/// (`where` begins the sentence) for other maps, and where the image is refused as a shape.
[[nodiscard]] implicit::Shape mappedShape(const implicit::Shape& shape, const Affine& map,
                                          const std::string& where);

/// "translate x y z; rotate ax ay az degrees; scale s": carried out from left to right about the origin, each
/// part any number of times; "scale sx sy sz" scales each axis. Uses libm's sine and cosine, so the numbers
/// are what is recorded, not the words. Throws InputError (`where` begins the sentence).
[[nodiscard]] Affine affineNamed(std::string_view text, const std::string& where);

}  // namespace restroke::sculpt
