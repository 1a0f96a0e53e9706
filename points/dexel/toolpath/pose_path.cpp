#include "points/dexel/toolpath/pose_path.h"

#include <cmath>
#include <map>

#include "implicit/errors.h"

namespace restroke::points {

namespace {

using Orientation = std::array<double, 9>;

Orientation orientationOf(const PoseMatrix& pose) {
  return {pose[0], pose[1], pose[2], pose[4], pose[5], pose[6], pose[8], pose[9], pose[10]};
}

bool areAlike(const Orientation& a, const Orientation& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!(std::fabs(a[i] - b[i]) <= kSameOrientation)) return false;
  return true;
}

void refuseScale(const Orientation& m, std::size_t pose) {
  const double size = length(DVec3(m[0], m[3], m[6]));
  if (std::fabs(size - 1) > kPoseTolerance)
    throw InputError(fmt::format(
        "pose {} scales by {:.6g}; a cutter has its own size, and its poses must not scale", pose, size));
}

}  // namespace

PosePath posePathOf(const std::vector<PoseMatrix>& poses) {
  PosePath path;
  std::map<Orientation, std::uint32_t> known;
  const Orientation* standing = nullptr;
  std::uint32_t number = 0;
  // The pose before is where the last step ended, or waits for a step of its own.
  DVec3 before{0};
  bool waits = false;
  const auto place = [&](DVec3 p) { path.steps.push_back({{.from = p, .to = p}, number}); };
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Orientation own = orientationOf(poses[i]);
    refuseScale(own, i + 1);
    const DVec3 tip(poses[i][3], poses[i][7], poses[i][11]);
    if (!standing || !areAlike(own, *standing)) {
      if (waits) place(before);
      if (standing) ++path.turns;
      const auto [at, isNew] = known.emplace(own, static_cast<std::uint32_t>(path.orientations.size()));
      if (isNew) path.orientations.push_back(own);
      standing = &at->first;
      number = at->second;
      waits = true;
    } else if (tip == before) {
      ++path.still;
    } else {
      path.steps.push_back({{.from = before, .to = tip}, number});
      waits = false;
    }
    before = tip;
  }
  if (waits) place(before);
  return path;
}

bool looksLikePoses(std::string_view contents) {
  bool isComment = false;
  for (const char c : contents) {
    const bool isLineEnd = c == '\n' || c == '\r';
    if (isComment) {
      isComment = !isLineEnd;
    } else if (c == '#' || c == ';') {
      isComment = true;
    } else if (!isLineEnd && c != ' ' && c != '\t') {
      return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.';
    }
  }
  return false;
}

}  // namespace restroke::points
