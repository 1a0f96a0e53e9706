#include "points/dexel/tool_pose.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "implicit/errors.h"
#include "points/files/mesh_formats.h"

namespace restroke::points {

namespace {

// Of the product of the axes' lengths, the volume between them: less, and they lie in a plane but for
// rounding.
constexpr double kFlat = 1e-12;

}  // namespace

void checkPose(const PoseMatrix& pose) {
  for (std::size_t i = 0; i < pose.size(); ++i)
    if (!std::isfinite(pose[i]))
      throw InputError(
          fmt::format("number {} of the pose is {}; a pose has 16 finite numbers", i + 1, pose[i]));
  if (pose[12] != 0 || pose[13] != 0 || pose[14] != 0 || pose[15] != 1)
    throw InputError(fmt::format("the last row of the pose is {} {} {} {}; it must be 0 0 0 1", pose[12],
                                 pose[13], pose[14], pose[15]));
  // Brought to a size at which squares and products keep their digits.
  double size = 0;
  for (std::size_t i = 0; i < 12; ++i)
    if (i % 4 != 3) size = std::max(size, std::fabs(pose[i]));
  if (!(size > 0)) throw InputError("the pose is singular: it takes the whole tool to one point");
  DVec3 axes[3];
  double lengths[3];
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    axes[i] = DVec3(pose[k], pose[4 + k], pose[8 + k]) / size;
    lengths[i] = length(axes[i]);
  }
  const double volume = dot(axes[0], cross(axes[1], axes[2]));
  if (!(std::fabs(volume) > kFlat * lengths[0] * lengths[1] * lengths[2]))
    throw InputError("the pose is singular: it makes the tool flat");
  const auto [shortest, longest] = std::minmax({lengths[0], lengths[1], lengths[2]});
  if (longest - shortest > kPoseTolerance * longest)
    throw InputError(fmt::format(
        "the pose scales the tool's axes by {:.6g}, {:.6g} and {:.6g}; only a uniform scale is allowed "
        "(to within {} of it)",
        lengths[0] * size, lengths[1] * size, lengths[2] * size, kPoseTolerance));
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const double cosine = dot(axes[i], axes[j]) / (lengths[i] * lengths[j]);
    if (std::fabs(cosine) > kPoseTolerance)
      throw InputError(
          fmt::format("the pose shears the tool: the cosine between its axes {} and {} is {:.6g}, but must "
                      "be 0 (to within {})",
                      "xyz"[i], "xyz"[j], cosine, kPoseTolerance));
  }
  if (volume < 0)
    throw InputError(
        "the pose mirrors the tool: its determinant is less than 0; only turns, shifts and a uniform "
        "scale are allowed");
}

std::vector<PoseMatrix> parsePoses(std::string_view contents, const std::filesystem::path& name) {
  const formats::Source source{contents, name};
  formats::TextCursor text(source, '#');
  std::vector<PoseMatrix> poses;
  while (text.nextFilledLine()) {
    PoseMatrix pose{};
    std::size_t count = 0;
    for (std::string_view word = text.wordOfLine(); !word.empty(); word = text.wordOfLine(), ++count)
      if (count < pose.size()) pose[count] = text.number(word, "a number of a pose");
    if (count != pose.size()) text.refuseHere(fmt::format("{} numbers; a pose has 16, row by row", count));
    try {
      checkPose(pose);
    } catch (const InputError& error) {
      text.refuseHere(error.what());
    }
    poses.push_back(pose);
  }
  return poses;
}

std::vector<PoseMatrix> readPoses(const std::filesystem::path& path) {
  const std::string contents = formats::contentsOf(path, "a poses file");
  return parsePoses(contents, path);
}

}  // namespace restroke::points
