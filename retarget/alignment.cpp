// Coarse to fine: many starts with few points and few rounds, the best of them with more and more. Then two
// questions that decide whether the answer may be used: does the shape hold the motion, and is there another
// that fits as well?

#include "retarget/alignment.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <tuple>

#include "implicit/errors.h"
#include "retarget/alignment/matcher.h"
#include "retarget/alignment/starts.h"

namespace restroke::retarget {

namespace {

using alignment::Cloud;
using alignment::Effort;
using alignment::Matcher;
using alignment::Sampling;

constexpr std::size_t kFewest = 50;

// Measured (retarget/README.md): shapes that determine the motion lie far above, the others far below.
constexpr double kLeastFirmness = 3e-4;
constexpr double kLeastRivalRatio = 1.5;
constexpr double kMostRms = 0.015;
/// Motions that take the points to places within this many RMS radii of each other are one motion.
constexpr double kSamePlace = 0.05;

struct Candidate {
  Similarity motion;
  double score = 0;
};

struct Stage {
  Effort effort;
  std::size_t kept;
};

constexpr std::array kWholeStages{Stage{{100, 8}, 16}, Stage{{300, 10}, 6}};
constexpr std::array kPatchStages{Stage{{40, 0}, 1000}, Stage{{60, 4}, 150}, Stage{{200, 6}, 30},
                                  Stage{{500, 10}, 8}};
constexpr std::array kRivalStages{Stage{{150, 8}, 8}, Stage{{500, 10}, 3}};

/// The best of the candidates, at most `kept`, one from each place; among equals the first.
std::vector<Candidate> best(const Matcher& matcher, std::vector<Candidate> candidates, std::size_t kept) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score < b.score; });
  std::vector<Candidate> chosen;
  for (const Candidate& c : candidates) {
    if (chosen.size() == kept) break;
    const bool isNew = std::none_of(chosen.begin(), chosen.end(), [&](const Candidate& other) {
      return matcher.distance(other.motion, c.motion) < kSamePlace;
    });
    if (isNew) chosen.push_back(c);
  }
  return chosen;
}

double rmsOf(std::span<const double> squares) {
  double sum = 0;
  for (const double s : squares) sum += s;
  return std::sqrt(sum / static_cast<double>(squares.size()));
}

std::vector<Candidate> search(const Matcher& matcher, const std::vector<Similarity>& starts,
                              std::span<const Stage> stages) {
  std::vector<Candidate> candidates;
  for (const Similarity& start : starts) candidates.push_back({start, 0});
  for (const Stage& stage : stages) {
    for (Candidate& c : candidates) {
      c.motion = matcher.refined(c.motion, stage.effort);
      c.score = matcher.roughScore(c.motion, stage.effort);
    }
    candidates = best(matcher, std::move(candidates), stage.kept);
  }
  return candidates;
}

/// The candidates with all points. Only those that come near to the best are worth the last digits.
std::vector<Candidate> finished(const Matcher& matcher, std::vector<Candidate> candidates,
                                std::size_t points) {
  const Effort half{points / 4, 8, Sampling::Fine}, full{points, 20, Sampling::Fine};
  const auto improve = [&](Candidate& c, const Effort& effort) {
    c.motion = matcher.refined(c.motion, effort);
    c.score = rmsOf(matcher.squaredErrors(c.motion, full));
  };
  for (Candidate& c : candidates) improve(c, half);
  candidates = best(matcher, std::move(candidates), candidates.size());
  const double least = candidates.front().score;
  for (Candidate& c : candidates)
    if (c.score < 4 * least) improve(c, full);
  return best(matcher, std::move(candidates), candidates.size());
}

/// From the clouds' coordinates to the model's.
Similarity inModel(const Similarity& m, const Cloud& before, const Cloud& after) {
  Similarity out;
  out.rotation = m.rotation;
  out.scale = m.scale * after.radius / before.radius;
  out.translation =
      after.center + after.radius * m.translation - out.scale * turned(out.rotation, before.center);
  return out;
}

using Bits = std::tuple<float, float, float, float, float, float>;

std::vector<Bits> sortedBits(std::span<const OrientedPoint> points) {
  std::vector<Bits> bits;
  bits.reserve(points.size());
  for (const auto& [p, n] : points) bits.emplace_back(p.x, p.y, p.z, n.x, n.y, n.z);
  std::sort(bits.begin(), bits.end());
  return bits;
}

bool isUnchanged(std::span<const OrientedPoint> before, std::span<const OrientedPoint> after,
                 AlignmentMode mode) {
  if (before.size() > after.size() || (mode == AlignmentMode::Whole && before.size() != after.size()))
    return false;
  const std::vector<Bits> a = sortedBits(before), b = sortedBits(after);
  return std::includes(b.begin(), b.end(), a.begin(), a.end());
}

void requireFinite(std::span<const OrientedPoint> points, const char* which) {
  for (std::size_t k = 0; k < points.size(); ++k)
    if (!isFinite(points[k].position) || !isFinite(points[k].normal) ||
        !(dot(points[k].normal, points[k].normal) > 0))
      throw InputError(
          fmt::format("alignment: point {} of `{}` or its normal is not finite, or the normal is 0; both "
                      "must be finite, the normal of length 1",
                      k, which));
}

void judge(Alignment& out) {
  if (out.relativeRms > kMostRms) {
    out.verdict = AlignmentVerdict::NoFit;
    out.reason = fmt::format(
        "the best motion leaves an RMS distance of {:.2g} radii between the surfaces; {} is the most",
        out.relativeRms, kMostRms);
  } else if (out.firmness < kLeastFirmness) {
    out.verdict = AlignmentVerdict::Featureless;
    out.reason =
        fmt::format("the shape can slide along itself: the smallest eigenvalue is {:.2g}; {} is the least",
                    out.firmness, kLeastFirmness);
  } else if (out.rivalRatio < kLeastRivalRatio) {
    out.verdict = AlignmentVerdict::Symmetric;
    out.reason = fmt::format(
        "another motion fits almost as well: its RMS distance is {:.3g} times the best; {} is the least",
        out.rivalRatio, kLeastRivalRatio);
  } else {
    out.verdict = AlignmentVerdict::Found;
    out.reason = fmt::format("RMS distance {:.2g} radii; the next best motion has {:.3g} times as much",
                             out.relativeRms, out.rivalRatio);
  }
}

}  // namespace

std::string_view nameOf(AlignmentVerdict verdict) {
  switch (verdict) {
    case AlignmentVerdict::Found:
      return "found";
    case AlignmentVerdict::Symmetric:
      return "symmetric";
    case AlignmentVerdict::Featureless:
      return "featureless";
    case AlignmentVerdict::NoFit:
      break;
  }
  return "no fit";
}

std::vector<OrientedPoint> orientedPoints(std::span<const points::Surfel> surfels) {
  std::vector<OrientedPoint> out;
  out.reserve(surfels.size());
  for (const points::Surfel& s : surfels) out.push_back({s.position, s.normal});
  return out;
}

std::vector<OrientedPoint> patchAround(std::span<const OrientedPoint> points, std::span<const Point> stroke,
                                       double radius) {
  std::vector<OrientedPoint> patch;
  for (const OrientedPoint& p : points)
    if (std::any_of(stroke.begin(), stroke.end(), [&](Point s) {
          const DVec3 d = DVec3(p.position) - DVec3(s);
          return dot(d, d) <= radius * radius;
        }))
      patch.push_back(p);
  return patch;
}

Alignment alignSurfels(std::span<const OrientedPoint> before, std::span<const OrientedPoint> after,
                       const AlignmentOptions& options) {
  requireFinite(before, "before");
  requireFinite(after, "after");
  Alignment out;
  if (before.size() < kFewest || after.size() < kFewest) {
    out.reason = fmt::format("{} points before and {} after; at least {} are needed", before.size(),
                             after.size(), kFewest);
    return out;
  }
  if (isUnchanged(before, after, options.mode)) {
    out.verdict = AlignmentVerdict::Found;
    out.firmness = out.rivalRatio = std::numeric_limits<double>::infinity();
    out.reason = "every point is where it was";
    return out;
  }
  const std::size_t points = std::max<std::size_t>(options.points, kFewest);
  const Cloud from = alignment::cloudOf(before, {points, 10 * points}, options.seed);
  const Cloud to = alignment::cloudOf(after, {points, 10 * points}, options.seed + 1);
  const bool isWhole = options.mode == AlignmentMode::Whole;
  const Matcher matcher(from, to, options.mode);
  std::vector<Candidate> candidates = isWhole
                                          ? search(matcher, alignment::wholeStarts(from, to), kWholeStages)
                                          : search(matcher, alignment::patchStarts(from, to), kPatchStages);
  // A part that looks like itself when it is turned has its rivals here, where a sweep need not have kept
  // them.
  const std::vector<Candidate> rivals =
      search(matcher, alignment::turnedStarts(from, candidates.front().motion), kRivalStages);
  candidates.insert(candidates.end(), rivals.begin(), rivals.end());
  const std::vector<Candidate> found = finished(matcher, std::move(candidates), points);
  Candidate chosen = found.front();
  // Of those that fit alike the smallest motion: what did not move should stay.
  const Similarity identity = alignment::identityBetween(from, to);
  for (const Candidate& c : found)
    if (c.score < found.front().score * kLeastRivalRatio &&
        matcher.distance(identity, c.motion) < matcher.distance(identity, chosen.motion))
      chosen = c;
  out.motion = inModel(chosen.motion, from, to);
  out.relativeRms = chosen.score;
  out.rms = chosen.score * from.radius * out.motion.scale;
  out.firmness = matcher.firmness(chosen.motion, {points, 0, Sampling::Fine});
  out.rivalRatio = found.size() > 1 ? found[1].score / std::max(found[0].score, 1e-12)
                                    : std::numeric_limits<double>::infinity();
  judge(out);
  return out;
}

}  // namespace restroke::retarget
