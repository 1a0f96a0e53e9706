#pragma once
// The kinds of volume, each defined in the file of its name in this folder.

#include "implicit/volume_kinds.h"

namespace restroke::implicit {

[[nodiscard]] const VolumeKind& roundConeKind();
[[nodiscard]] const VolumeKind& ellipsoidKind();
[[nodiscard]] const VolumeKind& boxKind();
[[nodiscard]] const VolumeKind& cylinderKind();
[[nodiscard]] const VolumeKind& coneFrustumKind();
[[nodiscard]] const VolumeKind& torusKind();
[[nodiscard]] const VolumeKind& superellipsoidKind();
[[nodiscard]] const VolumeKind& convexPolyhedronKind();
[[nodiscard]] const VolumeKind& revolutionKind();
[[nodiscard]] const VolumeKind& meshKind();

}  // namespace restroke::implicit
