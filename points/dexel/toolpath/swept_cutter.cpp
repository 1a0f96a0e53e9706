#include "points/dexel/toolpath/swept_cutter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

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
constexpr double kMostRadii = 1e5;

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

// Of one kind each: histories hold many.
struct SweptCutter::Body {
  Body() = default;
  virtual ~Body() = default;
  Body(const Body&) = delete;
  Body& operator=(const Body&) = delete;
  // Appends stretches to none.
  virtual void intersect(const LocalLine& line, std::vector<LocalSpan>& spans) const = 0;
  [[nodiscard]] virtual bool contains(DVec3 p) const = 0;

  template <class Sweep>
  struct Of;
  template <class Sweep>
  static std::unique_ptr<const Body> make(Sweep sweep, double mend) {
    return std::make_unique<Of<Sweep>>(std::move(sweep), mend);
  }
};

template <class Sweep>
struct SweptCutter::Body::Of final : Body {
  Of(Sweep own, double gap) : sweep(std::move(own)), mend(gap) {}
  void intersect(const LocalLine& line, std::vector<LocalSpan>& spans) const override {
    LinePieces pieces(mend, spans);
    sweep.intersect(line, pieces);
  }
  [[nodiscard]] bool contains(DVec3 p) const override { return sweep.contains(p); }
  Sweep sweep;
  double mend;
};

template <>
struct SweptCutter::Body::Of<StraightSweep> final : Body {
  Of(StraightSweep own, double) : sweep(own) {}
  void intersect(const LocalLine& line, std::vector<LocalSpan>& spans) const override {
    if (const LocalSpan span = sweep.intersect(line); !span.empty()) spans.push_back(span);
  }
  [[nodiscard]] bool contains(DVec3 p) const override { return sweep.contains(p); }
  StraightSweep sweep;
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
    body_ = Body::make(StraightSweep(profile, DVec3(0), local), mend);
    return;
  }
  // Of larger ones the polynomial of the ring has too few digits left.
  const bool isPlane = arc->heightBegin == arc->heightEnd && !options.onlyStraightParts &&
                       arc->radius <= kMostRadii * cutter.radius;
  if (isPlane && std::fabs(arc->w.z) == 1 && arc->w.x == 0 && arc->w.y == 0) {
    body_ = Body::make(PlaneArcSweep(profile, *arc), mend);
    return;
  }
  ChordSweep chords(profile, *arc, options.tolerance * cutter.radius);
  if (isPlane && cutter.kind == Cutter::Kind::Ball && cutter.length >= 2 * cutter.radius)
    chords.takeBallExactly();
  body_ = Body::make(std::move(chords), mend);
}

SweptCutter::~SweptCutter() = default;

void SweptCutter::intersect(const Ray& line, std::vector<SolidSpan>& spans) const {
  const DVec3 o = line.origin - origin_, e = line.direction;
  const LocalLine local{{dot(o, axes_[0]), dot(o, axes_[1]), dot(o, axes_[2])},
                        {dot(e, axes_[0]), dot(e, axes_[1]), dot(e, axes_[2])}};
  const auto back = [&](DVec3 n) { return Vec3(n.x * axes_[0] + n.y * axes_[1] + n.z * axes_[2]); };
  thread_local std::vector<LocalSpan> found;
  found.clear();
  body_->intersect(local, found);
  for (const LocalSpan& s : found)
    if (s.enter < s.exit) spans.push_back({s.enter, s.exit, back(s.enterNormal), back(s.exitNormal)});
}

bool SweptCutter::contains(DVec3 p) const {
  const DVec3 q = p - origin_;
  const DVec3 local(dot(q, axes_[0]), dot(q, axes_[1]), dot(q, axes_[2]));
  return body_->contains(local);
}

}  // namespace restroke::points
