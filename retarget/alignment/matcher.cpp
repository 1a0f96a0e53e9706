#include "retarget/alignment/matcher.h"

#include <algorithm>

namespace restroke::retarget::alignment {

namespace {

/// Opposite normals are as far apart as this many RMS radii: in a search from afar, direction counts as much
/// as place; near the end it only keeps the two sides of a thin wall apart.
constexpr double kNormalWeight = 0.3;
constexpr float kCoarseSlack = 0.5f;
constexpr double kRoughReach = 0.15;  // in RMS radii
constexpr double kLeastCosine = 0.5;

/// Tukey's loss ends at this many (robust) standard deviations, and never under the resolution that the last
/// rounds need.
constexpr double kCutoff = 4.685;
constexpr double kLeastDeviation = 2e-5;
constexpr double kConverged = 1e-6;  // in RMS radii

void weighRobustly(std::vector<Match>& matches, double radius) {
  std::vector<double> sizes;
  sizes.reserve(matches.size());
  for (const Match& m : matches)
    if (m.weight > 0) sizes.push_back(std::fabs(dot(m.normal, m.from - m.to)));
  if (sizes.empty()) return;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  const double deviation = std::fmax(1.4826 * *middle, kLeastDeviation * radius);
  for (Match& m : matches) {
    if (!(m.weight > 0)) continue;
    const double t = dot(m.normal, m.from - m.to) / (kCutoff * deviation), rest = 1 - t * t;
    m.weight *= rest > 0 ? rest * rest : 0;
  }
}

}  // namespace

Matcher::Matcher(const Cloud& before, const Cloud& after, AlignmentMode mode)
    : before_(before),
      after_(after),
      nearestAfter_(treesOf(
          after, kNormalWeight * (mode == AlignmentMode::Whole ? 1.0 : before.radius / after.radius))) {
  if (mode == AlignmentMode::Whole) nearestBefore_.emplace(treesOf(before, kNormalWeight));
}

Matcher::Trees Matcher::treesOf(const Cloud& cloud, double normalWeight) {
  const std::span<const Sample> all(cloud.samples);
  return {NearestSamples(all.first(cloud.spread), normalWeight), NearestSamples(all, normalWeight)};
}

StepFrame Matcher::frameOf(const Similarity& motion) const {
  return {motion.translation, motion.scale};  // centroid 0 and RMS radius 1, moved
}

void Matcher::match(const Similarity& motion, const Effort& effort, std::vector<Match>& matches) const {
  matches.clear();
  const auto tree = static_cast<std::size_t>(effort.sampling);
  const float slack = effort.sampling == Sampling::Coarse ? kCoarseSlack : 0.0f;
  NearestSamples::Answer answer;
  std::vector<Sample> queries;
  const auto add = [&](const Sample& from, const Sample& to) {
    const double cosine = dot(from.normal, to.normal);
    const DVec3 between = from.normal + to.normal;
    const bool agrees = cosine > kLeastCosine;
    matches.push_back(
        {from.position, to.position, agrees ? normalized(between) : DVec3(0), cosine, agrees ? 1.0 : 0.0});
  };
  const auto image = [&](const Sample& s) {
    return Sample{moved(motion, s.position), turned(motion.rotation, s.normal)};
  };
  const std::size_t forward = std::min(effort.points, before_.spread);
  for (std::size_t k = 0; k < forward; ++k) queries.push_back(image(before_.samples[k]));
  nearestAfter_[tree].find(queries, slack, answer);
  for (std::size_t k = 0; k < forward; ++k) add(queries[k], after_.samples[answer.index[k]]);
  if (!nearestBefore_) return;

  const Similarity back = inverted(motion);
  const std::size_t backward = std::min(effort.points, after_.spread);
  queries.clear();
  for (std::size_t k = 0; k < backward; ++k) {
    const Sample& s = after_.samples[k];
    queries.push_back({moved(back, s.position), turned(back.rotation, s.normal)});
  }
  (*nearestBefore_)[tree].find(queries, slack, answer);
  for (std::size_t k = 0; k < backward; ++k) add(image(before_.samples[answer.index[k]]), after_.samples[k]);
}

Similarity Matcher::refined(const Similarity& start, const Effort& effort) const {
  Similarity motion = start;
  std::vector<Match> matches;
  for (int round = 0; round < effort.rounds; ++round) {
    match(motion, effort, matches);
    weighRobustly(matches, motion.scale);
    const Similarity step = fittingStep(matches, frameOf(motion), 2);
    const Similarity next = composed(step, motion);
    // A collapsing or exploding motion never comes back.
    if (!(next.scale > start.scale * 0.2 && next.scale < start.scale * 5)) return motion;
    const double change = distance(motion, next);
    motion = next;
    if (change < kConverged) break;
  }
  return motion;
}

std::vector<double> Matcher::squaredErrors(const Similarity& motion, const Effort& effort) const {
  std::vector<Match> matches;
  match(motion, effort, matches);
  std::vector<double> errors;
  errors.reserve(matches.size());
  for (const Match& m : matches) {
    const double along = dot(m.normal, m.from - m.to) / motion.scale;
    errors.push_back(m.weight > 0 ? std::fmin(along * along, kMissSquared) : kMissSquared);
  }
  return errors;
}

double Matcher::roughScore(const Similarity& motion, const Effort& effort) const {
  std::vector<Match> matches;
  match(motion, effort, matches);
  double sum = 0;
  for (const Match& m : matches) {
    if (!(m.weight > 0)) {
      sum += 1;
      continue;
    }
    // Along the normals, and a little across: how far the nearest sample is across depends on the sampling.
    const DVec3 d = (m.from - m.to) / motion.scale;
    const double along = dot(d, m.normal);
    sum += std::fmin(1.0, along * along / (kRoughReach * kRoughReach) + dot(d, d) + 1 - m.cosine);
  }
  return sum / static_cast<double>(matches.size());
}

double Matcher::firmness(const Similarity& motion, const Effort& effort) const {
  std::vector<Match> matches;
  match(motion, effort, matches);
  return firmnessOf(matches, frameOf(motion));
}

double Matcher::distance(const Similarity& a, const Similarity& b) const {
  const std::size_t count = std::min<std::size_t>(before_.spread, 60);
  double sum = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const DVec3 d = moved(a, before_.samples[k].position) - moved(b, before_.samples[k].position);
    sum += dot(d, d);
  }
  return std::sqrt(sum / static_cast<double>(count)) / a.scale;
}

}  // namespace restroke::retarget::alignment
