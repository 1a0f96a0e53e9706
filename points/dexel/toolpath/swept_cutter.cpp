#include "points/dexel/toolpath/swept_cutter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <optional>
#include <variant>

#include "implicit/errors.h"
#include "points/dexel/toolpath/arc_path.h"
#include "points/dexel/toolpath/arc_sweep.h"
#include "points/dexel/toolpath/line_pieces.h"
#include "points/dexel/toolpath/straight_sweep.h"

namespace restroke::points {

namespace {

constexpr double kMend = 1e-9;
// More than what intersect() may be off, as part of the sweep's size.
constexpr double kMargin = 1e-8;

// The columns of a rotation, straightened: a rotation along the axes keeps its bits.
std::array<DVec3, 3> axesOf(const Cutter& cutter) {
  const auto& m = cutter.orientation;
  const DVec3 z = normalized(DVec3(m[2], m[5], m[8]));
  const DVec3 across(m[0], m[3], m[6]);
  const DVec3 x = normalized(across - dot(across, z) * z);
  return {x, cross(z, x), z};
}

struct Extent {
  DVec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
  void add(DVec3 p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
};

// Of the tip's way.
Extent wayOf(const PathElement& element) {
  Extent way;
  way.add(element.from);
  const auto arc = arcPathOf(element, {DVec3(1, 0, 0), DVec3(0, 1, 0), DVec3(0, 0, 1)});
  if (!arc) {
    way.add(element.to);
    return way;
  }
  way.add(element.from + arc->at(arc->begin, arc->heightBegin));
  way.add(element.from + arc->at(arc->end, arc->heightEnd));
  for (const lines::Flat2 d : {lines::Flat2{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
    if (arc->isBeside(d))
      for (const double height : {arc->heightBegin, arc->heightEnd})
        way.add(element.from + arc->at(d, height));
  return way;
}

Box boundsOf(const Cutter& cutter, const std::array<DVec3, 3>& axes, const PathElement& element) {
  const Extent way = wayOf(element);
  const DVec3 size = way.high - way.low;
  const double margin = kMargin * (std::max({size.x, size.y, size.z}) + cutter.radius + cutter.length);
  constexpr float kLowest = -std::numeric_limits<float>::infinity(), kHighest = -kLowest;
  Box box;
  for (int a = 0; a < 3; ++a) {
    const double x = axes[0][a], y = axes[1][a], along = cutter.length * axes[2][a];
    const double wide = cutter.radius * std::sqrt(x * x + y * y) + margin;
    const double low = way.low[a] - wide + std::min(0.0, along),
                 high = way.high[a] + wide + std::max(0.0, along);
    box.min[a] = std::nextafter(static_cast<float>(low), kLowest);
    box.max[a] = std::nextafter(static_cast<float>(high), kHighest);
  }
  if (!isFinite(box.min) || !isFinite(box.max))
    throw InputError(
        fmt::format("a cutter of radius {:.6g} and length {:.6g} reaches farther than float32 has "
                    "numbers for",
                    cutter.radius, cutter.length));
  return box;
}

}  // namespace

struct SweptCutter::Body {
  std::variant<StraightSweep, PlaneArcSweep, ChordSweep> sweep;
  double mend;
};

SweptCutter::SweptCutter(const Cutter& cutter, const PathElement& element, const SweepOptions& options)
    : origin_(element.from) {
  validate(cutter);
  validate(element);
  if (!(std::isfinite(options.tolerance) && options.tolerance > 0))
    throw InputError(
        fmt::format("the tolerance of arcs is {}; it must be greater than 0", options.tolerance));
  const std::array<DVec3, 3> axes = axesOf(cutter);
  std::copy(axes.begin(), axes.end(), axes_);
  setBounds(boundsOf(cutter, axes, element));

  const CutterProfile profile(cutter);
  const double mend = kMend * cutter.radius;
  const auto arc = arcPathOf(element, axes);
  if (!arc) {
    const DVec3 move = element.to - element.from;
    const DVec3 local(dot(move, axes[0]), dot(move, axes[1]), dot(move, axes[2]));
    body_.reset(new Body{StraightSweep(profile, DVec3(0), local), mend});
    return;
  }
  const bool isPlane = arc->heightBegin == arc->heightEnd;
  if (isPlane && !options.onlyStraightParts && std::fabs(arc->w.z) == 1 && arc->w.x == 0 && arc->w.y == 0) {
    body_.reset(new Body{PlaneArcSweep(profile, *arc), mend});
    return;
  }
  ChordSweep chords(profile, *arc, options.tolerance * cutter.radius);
  if (isPlane && !options.onlyStraightParts && cutter.kind == Cutter::Kind::Ball &&
      cutter.length >= 2 * cutter.radius)
    chords.takeBallExactly();
  body_.reset(new Body{chords, mend});
}

SweptCutter::~SweptCutter() = default;

void SweptCutter::intersect(const Ray& line, std::vector<SolidSpan>& spans) const {
  const DVec3 o = line.origin - origin_, e = line.direction;
  const LocalLine local{{dot(o, axes_[0]), dot(o, axes_[1]), dot(o, axes_[2])},
                        {dot(e, axes_[0]), dot(e, axes_[1]), dot(e, axes_[2])}};
  const auto back = [&](DVec3 n) { return Vec3(n.x * axes_[0] + n.y * axes_[1] + n.z * axes_[2]); };
  const auto append = [&](const LocalSpan& s) {
    if (s.enter < s.exit) spans.push_back({s.enter, s.exit, back(s.enterNormal), back(s.exitNormal)});
  };
  if (const auto* straight = std::get_if<StraightSweep>(&body_->sweep)) {
    append(straight->intersect(local));
    return;
  }
  LinePieces pieces(body_->mend);
  if (const auto* arc = std::get_if<PlaneArcSweep>(&body_->sweep))
    arc->intersect(local, pieces);
  else
    std::get<ChordSweep>(body_->sweep).intersect(local, pieces);
  for (const LocalSpan& s : pieces.spans()) append(s);
}

bool SweptCutter::contains(DVec3 p) const {
  const DVec3 q = p - origin_;
  const DVec3 local(dot(q, axes_[0]), dot(q, axes_[1]), dot(q, axes_[2]));
  return std::visit([&](const auto& sweep) { return sweep.contains(local); }, body_->sweep);
}

}  // namespace restroke::points
