#include "points/dexel/toolpath/arc_sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "implicit/errors.h"
#include "points/dexel/toolpath/torus_sector.h"

namespace restroke::points {

namespace {

using lines::Flat2;
using lines::Stretch;

constexpr std::size_t kMostLevels = 18;

DVec3 unitOr(DVec3 n, DVec3 otherwise) {
  const double size = length(n);
  return size > 0 ? n / size : otherwise;
}

// The ring within `tube` of an arc, and the balls at its ends.
void appendRoundPath(const ArcPath& arc, double tube, const LocalLine& line, std::vector<Stretch>& found) {
  const DVec3 o = line.origin - arc.at({0, 0}, arc.heightBegin), e = line.direction;
  appendRing(arc, arc.radius, tube, {dot(o, arc.u), dot(o, arc.v), dot(o, arc.w)},
             {dot(e, arc.u), dot(e, arc.v), dot(e, arc.w)}, found);
  if (arc.isWhole) return;
  for (const Flat2 end : {arc.begin, arc.end}) {
    const DVec3 q = line.origin - arc.at(end, arc.heightBegin);
    const double b = dot(q, e);
    const DVec3 beside = q - b * e;
    const double square = tube * tube - dot(beside, beside);
    if (!(square >= 0)) continue;
    const double half = std::sqrt(square);
    found.push_back({-b - half, -b + half, lines::kSide, lines::kSide});
  }
}

}  // namespace

// One line against the sweep. In the coordinates of the arc's u and v, and z.
class PlaneArcSweep::Cut {
 public:
  Cut(const PlaneArcSweep& sweep, const LocalLine& line, LinePieces& pieces)
      : cutter_(sweep.cutter_), arc_(sweep.arc_), pieces_(pieces) {
    const DVec3 o = line.origin - arc_.center, e = line.direction;
    shift_ = -dot(o, e);
    const DVec3 near = o + shift_ * e;
    o_ = {dot(near, arc_.u), dot(near, arc_.v), near.z};
    e_ = {dot(e, arc_.u), dot(e, arc_.v), e.z};
  }

  // Within `reach` of the arc across the axis, from one height to another.
  void addPrism(double reach, double low, double high) {
    const Stretch heights = lines::between(o_.z, e_.z, low, high);
    if (heights.empty()) return;
    const Flat2 q{o_.x, o_.y}, w{e_.x, e_.y};
    found_.clear();
    Stretch outer = heights;
    outer.clip(lines::inCircle(q, w, arc_.radius + reach));
    if (!outer.empty()) {
      const Stretch hole = arc_.radius > reach ? lines::inCircle(q, w, arc_.radius - reach) : Stretch{};
      if (hole.empty()) {
        appendInWedge(arc_, q, w, outer, found_);
      } else {
        for (const Stretch& beside : {Stretch{-lines::kInfinity, hole.enter, lines::kSide, lines::kSide},
                                      Stretch{hole.exit, lines::kInfinity, lines::kSide, lines::kSide}}) {
          Stretch part = outer;
          part.clip(beside);
          if (!part.empty()) appendInWedge(arc_, q, w, part, found_);
        }
      }
    }
    for (const Stretch& s : found_)
      add(s, [&](DVec3 p, int face) -> DVec3 {
        if (face != lines::kSide) return {0, 0, face == lines::kLower ? -1 : 1};
        const double side = p.x * p.x + p.y * p.y < arc_.radius * arc_.radius ? -1 : 1;
        return unitOr({side * p.x, side * p.y, 0}, {side, 0, 0});
      });
    if (arc_.isWhole) return;
    for (const Flat2 end : {arc_.begin, arc_.end}) {
      const DVec3 center(arc_.radius * end.x, arc_.radius * end.y, 0);
      Stretch disc = heights;
      disc.clip(lines::inCircle({q.x - center.x, q.y - center.y}, w, reach));
      if (!disc.empty())
        add(disc, [&](DVec3 p, int face) -> DVec3 {
          if (face != lines::kSide) return {0, 0, face == lines::kLower ? -1 : 1};
          return unitOr({p.x - center.x, p.y - center.y, 0}, {1, 0, 0});
        });
    }
  }

  // The lower half of what is within `tube` of a circle of the plane at height `tube`.
  void addLowerRing(const ArcPath& wedge, DVec3 center, double circle, double tube) {
    const DVec3 o = o_ - center - DVec3(0, 0, tube);
    found_.clear();
    appendRing(wedge, circle, tube, o, e_, found_);
    addLower(tube, [=](DVec3 p) {
      DVec3 n = p - center - DVec3(0, 0, tube);
      const double rho = std::sqrt(n.x * n.x + n.y * n.y);
      const double share = rho > 0 ? 1 - circle / rho : 0;
      return DVec3(n.x * share, n.y * share, n.z);
    });
  }
  void addLowerBall(DVec3 center, double radius) {
    const DVec3 q = o_ - center;
    const double b = dot(q, e_);
    const DVec3 beside = q - b * e_;
    const double square = radius * radius - dot(beside, beside);
    if (!(square >= 0)) return;
    const double half = std::sqrt(square);
    found_.assign(1, {-b - half, -b + half, lines::kSide, lines::kSide});
    addLower(radius, [=](DVec3 p) { return p - center; });
  }

 private:
  // Where it is cut off, the shank goes on; a cutter without a shank ends there.
  template <class Normal>
  void addLower(double height, const Normal& normal) {
    const Stretch below = lines::between(o_.z, e_.z, -lines::kInfinity, height);
    const bool hasShank = cutter_.length > cutter_.shankBegin();
    for (Stretch s : found_) {
      s.clip(below);
      if (s.empty()) continue;
      add(s, [&](DVec3 p, int face) -> DVec3 {
        if (face == lines::kUpper && !hasShank) return {0, 0, 1};
        return unitOr(normal(p), {0, 0, -1});
      });
    }
  }

  template <class Normal>
  void add(const Stretch& s, const Normal& normalAt) {
    const auto back = [&](DVec3 n) { return n.x * arc_.u + n.y * arc_.v + DVec3(0, 0, n.z); };
    pieces_.add({s.enter + shift_, s.exit + shift_, back(normalAt(o_ + s.enter * e_, s.enterFace)),
                 back(normalAt(o_ + s.exit * e_, s.exitFace))});
  }

  const CutterProfile& cutter_;
  const ArcPath& arc_;
  LinePieces& pieces_;
  double shift_;
  DVec3 o_, e_;
  std::vector<Stretch> found_;
};

PlaneArcSweep::PlaneArcSweep(const CutterProfile& cutter, const ArcPath& arc) : cutter_(cutter), arc_(arc) {}

void PlaneArcSweep::intersect(const LocalLine& line, LinePieces& pieces) const {
  Cut cut(*this, line, pieces);
  const double r = cutter_.radius, begin = cutter_.shankBegin(), R = arc_.radius;
  cut.addPrism(r, begin, cutter_.length);
  if (cutter_.kind == Cutter::Kind::Flat) return;
  const auto ends = {arc_.begin, arc_.end};
  const auto placeOf = [&](Flat2 end) { return DVec3(R * end.x, R * end.y, 0); };
  if (cutter_.kind == Cutter::Kind::Ball) {
    cut.addLowerRing(arc_, DVec3(0), R, r);
    if (!arc_.isWhole)
      for (const Flat2 end : ends) cut.addLowerBall(placeOf(end) + DVec3(0, 0, r), r);
    return;
  }
  const double flat = r - begin;
  cut.addPrism(flat, 0, begin);
  cut.addLowerRing(arc_, DVec3(0), R + flat, begin);
  if (R > flat) cut.addLowerRing(arc_, DVec3(0), R - flat, begin);
  if (arc_.isWhole) return;
  ArcPath round;
  round.isWhole = true;
  for (const Flat2 end : ends) cut.addLowerRing(round, placeOf(end), flat, begin);
}

bool PlaneArcSweep::contains(DVec3 p) const {
  if (p.z > cutter_.length || p.z < 0) return false;
  const DVec3 away = p - arc_.nearest(p);
  const double tip = cutter_.shankBegin(), square = away.x * away.x + away.y * away.y;
  if (p.z >= tip) return square <= cutter_.radius * cutter_.radius;
  const double out = std::max(0.0, std::sqrt(square) - (cutter_.radius - tip)), down = tip - p.z;
  return out * out + down * down <= tip * tip;
}

ChordSweep::ChordSweep(const CutterProfile& cutter, const ArcPath& arc, double tolerance)
    : cutter_(cutter), arc_(arc) {
  // The height of the arc above a chord is radius (1 - cos) of half its turn, and 1 - cos half the square of
  // the distance between the unit directions. Against equal steps along the chord it is a little more.
  constexpr double kMargin = 0.9;
  Part part = whole();
  for (;;) {
    const Flat2 middle = middleOf(part.beginAt, part.endAt, part.isLong);
    const Flat2 step{middle.x - part.beginAt.x, middle.y - part.beginAt.y};
    const double above = arc_.radius * lines::dot(step, step) / 2;
    above_.push_back(above / kMargin);
    if (!part.isLong && above <= kMargin * tolerance) break;
    if (above_.size() > kMostLevels)
      throw InputError(fmt::format(
          "a path element is an arc of radius {:.6g} that is to be followed to within {:.6g}; that "
          "takes more than {} straight moves",
          arc_.radius, tolerance, 1 << kMostLevels));
    part.endAt = middle;
    part.isLong = false;
  }
  std::reverse(above_.begin(), above_.end());
}

ChordSweep::Part ChordSweep::whole() const {
  return {.beginAt = arc_.begin,
          .endAt = arc_.end,
          .begin = arc_.at(arc_.begin, arc_.heightBegin),
          .end = arc_.at(arc_.end, arc_.heightEnd),
          .heightBegin = arc_.heightBegin,
          .heightEnd = arc_.heightEnd,
          .level = above_.empty() ? 0 : static_cast<int>(above_.size()) - 1,
          .isLong = arc_.isLong || arc_.isWhole};
}

DVec3 ChordSweep::splitInto(std::vector<Part>& parts, const Part& part) const {
  const Flat2 at = middleOf(part.beginAt, part.endAt, part.isLong);
  const double height = (part.heightBegin + part.heightEnd) / 2;
  const DVec3 middle = arc_.at(at, height);
  parts.push_back({part.beginAt, at, part.begin, middle, part.heightBegin, height, part.level - 1, false});
  parts.push_back({at, part.endAt, middle, part.end, height, part.heightEnd, part.level - 1, false});
  return middle;
}

ChordSweep::Way ChordSweep::wayOf(const Part& part) const {
  // Of more than half a turn all of the circle is reached.
  if (part.isLong)
    return {.middle = arc_.at({0, 0}, (part.heightBegin + part.heightEnd) / 2),
            .half = {0, 0, (part.end.z - part.begin.z) / 2},
            .beside = arc_.radius + length(part.end - part.begin) / 2};
  // A straight part is its chord.
  const double beside = part.level == 0 ? 0 : above_[static_cast<std::size_t>(part.level)];
  return {.middle = 0.5 * (part.begin + part.end), .half = 0.5 * (part.end - part.begin), .beside = beside};
}

// Whether the cutter near a place could add to what is known of a line.
class ChordSweep::Probe {
 public:
  Probe(const CutterProfile& cutter, bool isShankOnly, const LocalLine& line, const LinePieces& pieces)
      : radius_(cutter.radius),
        round_(isShankOnly ? 0 : cutter.shankBegin()),
        low_(isShankOnly ? cutter.shankBegin() : 0),
        high_(cutter.length),
        line_(line),
        pieces_(pieces) {}

  // With the tip where `way` says. False only if it adds nothing.
  [[nodiscard]] bool mayAdd(const Way& way) const {
    const DVec3 o = line_.origin - way.middle, e = line_.direction;
    const double reach = way.reach();
    Stretch s = lines::between(o.z, e.z, low_ - reach, high_ + reach);
    if (s.empty()) return false;
    s.clip(lines::inCircle({o.x, o.y}, {e.x, e.y}, radius_ + reach));
    if (s.empty()) return false;
    const LocalSpan* known = nullptr;
    for (const LocalSpan& span : pieces_.spans()) {
      if (span.exit < s.enter || span.enter > s.exit) continue;
      if (known) return true;
      known = &span;
    }
    return !known || (s.enter < known->enter && mayPass(o, known->enter, -1, way)) ||
           (s.exit > known->exit && mayPass(o, known->exit, 1, way));
  }

 private:
  // Can the cutter be on the line beyond t? Its distance is a convex function, which is nowhere less than the
  // linear one that touches it: when that is positive for all places of the tip, and grows along the line, it
  // cannot.
  [[nodiscard]] bool mayPass(DVec3 origin, double t, double outwards, const Way& way) const {
    const DVec3 e = line_.direction, p = origin + t * e;
    const double rho = std::sqrt(p.x * p.x + p.y * p.y);
    const DVec3 out = rho > 0 ? DVec3(p.x / rho, p.y / rho, 0) : DVec3(0);
    // The greatest of the distances from the upper end, and from the side and the lower end, or from the
    // rounded part of both.
    double gap = p.z - high_;
    DVec3 gradient(0, 0, 1);
    const auto take = [&](double itsGap, DVec3 itsGradient) {
      if (itsGap > gap) {
        gap = itsGap;
        gradient = itsGradient;
      }
    };
    if (round_ > 0) {
      const double beside = std::max(0.0, rho - (radius_ - round_)), below = std::max(0.0, round_ - p.z);
      const double distance = std::sqrt(beside * beside + below * below);
      take(distance - round_, distance > 0 ? (beside * out - DVec3(0, 0, below)) / distance : DVec3(0));
    } else {
      take(rho - radius_, out);
      take(low_ - p.z, {0, 0, -1});
    }
    const double nearer = std::fabs(dot(gradient, way.half)) + way.beside;
    return !(gap > nearer && dot(gradient, e) * outwards >= 0);
  }

  double radius_, round_, low_, high_;
  const LocalLine& line_;
  const LinePieces& pieces_;
};

void ChordSweep::intersect(const LocalLine& line, LinePieces& pieces) const {
  if (isBallExact_) {
    ArcPath ball = arc_;
    ball.center += DVec3(0, 0, cutter_.radius);
    std::vector<Stretch> found;
    const double shift = -dot(line.origin - ball.center, line.direction);
    const LocalLine near{line.at(shift), line.direction};
    appendRoundPath(ball, cutter_.radius, near, found);
    const auto normalAt = [&](double t) {
      const DVec3 p = near.at(t);
      return unitOr(p - ball.nearest(p), {0, 0, -1});
    };
    for (const Stretch& s : found)
      pieces.add({s.enter + shift, s.exit + shift, normalAt(s.enter), normalAt(s.exit)});
  }
  const Probe probe(cutter_, isBallExact_, line, pieces);
  const auto add = [&](DVec3 from, DVec3 to) {
    const StraightSweep sweep(cutter_, from, to);
    pieces.add(isBallExact_ ? sweep.intersectShank(line) : sweep.intersect(line));
  };
  // Level by level, and the cutter in the middle of each part at once: soon most of the stretch is covered,
  // and only those parts are left that could make it longer.
  // The memory serves the next line too.
  thread_local std::vector<Part> parts, next;
  parts.assign(1, whole());
  while (!parts.empty()) {
    next.clear();
    for (const Part& part : parts) {
      if (!probe.mayAdd(wayOf(part))) continue;
      if (part.level == 0) {
        add(part.begin, part.end);
        continue;
      }
      const DVec3 middle = splitInto(next, part);
      if (probe.mayAdd({.middle = middle, .half = DVec3(0), .beside = 0})) add(middle, middle);
    }
    std::swap(parts, next);
  }
}

bool ChordSweep::contains(DVec3 p) const {
  if (isBallExact_) {
    const DVec3 up(0, 0, cutter_.radius), away = p - up - arc_.nearest(p - up);
    if (dot(away, away) <= cutter_.radius * cutter_.radius) return true;
  }
  std::vector<Part> parts{whole()};
  while (!parts.empty()) {
    const Part part = parts.back();
    parts.pop_back();
    const Way way = wayOf(part);
    const DVec3 q = p - way.middle;
    const double reach = way.reach(), wide = cutter_.radius + reach;
    if (q.x * q.x + q.y * q.y > wide * wide || q.z < -reach || q.z > cutter_.length + reach) continue;
    if (part.level > 0)
      splitInto(parts, part);
    else if (StraightSweep(cutter_, part.begin, part.end).contains(p))
      return true;
  }
  return false;
}

}  // namespace restroke::points
