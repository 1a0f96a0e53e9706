#pragma once
// Where the search for a motion begins. All in the clouds' own coordinates: from those of `before` to those
// of `after`.

#include <vector>

#include "retarget/alignment/cloud.h"

namespace restroke::retarget::alignment {

/// The motion that leaves every point of the model where it is.
[[nodiscard]] Similarity identityBetween(const Cloud& before, const Cloud& after);

/// Centroid onto centroid and RMS radius onto RMS radius; turned by the 24 rotations of the cube, once from
/// the coordinate axes and once from the principal axes; and the identity.
[[nodiscard]] std::vector<Similarity> wholeStarts(const Cloud& before, const Cloud& after);

/// The patch put onto places spread over `after`, mean normal onto mean normal, in twelve turns about it
/// (where the patch bends so far that its mean normal says little, in the 24 rotations of the cube); each in
/// five scales; and the identity.
[[nodiscard]] std::vector<Similarity> patchStarts(const Cloud& patch, const Cloud& after);

/// The motion, with the shape first turned about its centroid: by the 24 rotations of the cube about its
/// principal axes, and in twelve turns about its mean normal where it has one. The unturned motion is the
/// first.
[[nodiscard]] std::vector<Similarity> turnedStarts(const Cloud& before, const Similarity& motion);

}  // namespace restroke::retarget::alignment
