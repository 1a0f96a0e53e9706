#pragma once
// Where a tool is, as 4 x 4 matrices (SPEC D6), and the files that hold a sequence of them.

#include <array>
#include <filesystem>
#include <string_view>
#include <vector>

#include "implicit/geometry/vec.h"

namespace restroke::points {

/// Row major: takes the column (x, y, z, 1) of a point of the tool to that point in the model. The last row
/// is 0 0 0 1.
using PoseMatrix = std::array<double, 16>;

inline constexpr PoseMatrix kIdentityPose{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

/// How far the three axes of a pose may be from having one length and being at right angles, as part of that
/// length (of its square): numbers of a text file have few digits. Nothing is straightened: the tool goes
/// where the matrix takes it.
inline constexpr double kPoseTolerance = 1e-4;

/// Throws InputError unless the pose is rigid, or rigid with a uniform scale: all numbers finite, the last
/// row exactly 0 0 0 1, the axes of one length > 0 and at right angles (kPoseTolerance), right-handed.
void checkPose(const PoseMatrix& pose);

/// In double, from + and * in a fixed order.
[[nodiscard]] inline DVec3 posed(const PoseMatrix& m, DVec3 p) {
  return {m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3], m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
          m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]};
}

/// One pose a line: 16 numbers between blanks, row major. Empty lines, and what follows a #, are passed over.
/// Throws InputError that names the file, the line and what is wrong with it, a pose that checkPose refuses
/// included. A file without poses gives none. O(file size).
[[nodiscard]] std::vector<PoseMatrix> readPoses(const std::filesystem::path& path);
/// The same for a file's contents; `name` is what sentences call it.
[[nodiscard]] std::vector<PoseMatrix> parsePoses(std::string_view contents,
                                                 const std::filesystem::path& name);

}  // namespace restroke::points
