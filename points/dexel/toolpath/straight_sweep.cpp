// The oblique sweep of a disc, and the decomposition of a swept cylinder into it, cylinders and a slab,
// follow from the sum of convex sets: disc + segment (the axis) + segment (the move) is disc + parallelogram,
// whose edges give the four cylinders and whose inside gives the slab.

#include "points/dexel/toolpath/straight_sweep.h"

#include <algorithm>
#include <cmath>

#include "points/dexel/toolpath/line_math.h"

namespace restroke::points {

namespace {

using lines::between;
using lines::Flat2;
using lines::inCircle;
using lines::kInfinity;
using lines::kLower;
using lines::kSide;
using lines::kUpper;
using lines::Stretch;

// Hits of the round parts count as hits of the cutter's lower half when their normal points down, or up by no
// more than rounding may do.
constexpr double kLevel = 1e-9;

Stretch both(Stretch a, const Stretch& b) {
  a.clip(b);
  return a;
}

enum Piece : int { kFirst, kLast, kLowerDisc, kUpperDisc, kMiddle };

// The first place where a line enters one of several solids, and the last where it leaves one.
struct Hull {
  double enter = kInfinity, exit = -kInfinity;
  int enterPiece = 0, exitPiece = 0, enterFace = 0, exitFace = 0;

  void add(int piece, const Stretch& s) {
    if (!(s.enter <= s.exit)) return;
    if (s.enter < enter) {
      enter = s.enter;
      enterPiece = piece;
      enterFace = s.enterFace;
    }
    if (s.exit > exit) {
      exit = s.exit;
      exitPiece = piece;
      exitFace = s.exitFace;
    }
  }
};

// A round part's hits widen the span where they are on its lower half. The upper half may stick out above a
// short cutter; where a line comes to it from there it meets the moved disc at the shank's lower end, which
// is part of the cylinder's sweep.
void widen(LocalSpan& span, const LocalSpan& round) {
  if (round.enter < span.enter && round.enterNormal.z <= kLevel) {
    span.enter = round.enter;
    span.enterNormal = round.enterNormal;
  }
  if (round.exit > span.exit && round.exitNormal.z <= kLevel) {
    span.exit = round.exit;
    span.exitNormal = round.exitNormal;
  }
}

}  // namespace

StraightSweep::StraightSweep(const CutterProfile& cutter, DVec3 from, DVec3 to)
    : cutter_(cutter), from_(from), move_(to - from) {
  across_ = std::sqrt(move_.x * move_.x + move_.y * move_.y);
  if (across_ <= kStraight * std::max(std::fabs(move_.z), cutter.radius)) {
    across_ = move_.x = move_.y = 0;
    // Up and down: the cutter at the lower end, with a longer shank.
    from_.z += std::min(0.0, move_.z);
    move_.z = std::fabs(move_.z);
  } else {
    if (std::fabs(move_.z) <= kStraight * across_) move_.z = 0;
    forward_[0] = move_.x / across_;
    forward_[1] = move_.y / across_;
    slope_ = move_.z / across_;
    perHeight_ = move_.z == 0 ? 0 : 1 / move_.z;
  }
  length_ = length(move_);
}

// The line's origin moves to where it is nearest to the middle: what is subtracted there is of the sweep's
// own size.
LocalLine StraightSweep::nearby(const LocalLine& line, double& shift) const {
  const DVec3 o = line.origin - from_;
  const DVec3 middle = 0.5 * move_ + DVec3(0, 0, 0.5 * cutter_.length);
  shift = dot(middle - o, line.direction);
  return {o + shift * line.direction, line.direction};
}

LocalSpan StraightSweep::intersect(const LocalLine& line) const {
  double shift;
  const LocalLine near = nearby(line, shift);
  LocalSpan span = cylinder(near);
  if (cutter_.kind == Cutter::Kind::Ball) addBall(near, span);
  if (cutter_.kind == Cutter::Kind::BullNose) addRoundedEdge(near, span);
  span.enter += shift;
  span.exit += shift;
  return span;
}

LocalSpan StraightSweep::intersectShank(const LocalLine& line) const {
  double shift;
  LocalSpan span = cylinder(nearby(line, shift));
  span.enter += shift;
  span.exit += shift;
  return span;
}

LocalSpan StraightSweep::cylinder(const LocalLine& line) const {
  const DVec3 o = line.origin, e = line.direction;
  const double r = cutter_.radius, low = cutter_.shankBegin(), high = cutter_.length;
  const Flat2 q{o.x, o.y}, w{e.x, e.y}, move{move_.x, move_.y};
  const double rise = move_.z;
  Hull hull;
  if (across_ == 0) {
    hull.add(kFirst, both(between(o.z, e.z, low, high + rise), inCircle(q, w, r)));
  } else {
    hull.add(kFirst, both(between(o.z, e.z, low, high), inCircle(q, w, r)));
    hull.add(kLast,
             both(between(o.z, e.z, low + rise, high + rise), inCircle({q.x - move.x, q.y - move.y}, w, r)));
    if (rise != 0) {
      const Flat2 lean{move.x * perHeight_, move.y * perHeight_};
      const Flat2 wide{w.x - e.z * lean.x, w.y - e.z * lean.y};
      for (const int piece : {kLowerDisc, kUpperDisc}) {
        const double base = piece == kLowerDisc ? low : high;
        const double up = o.z - base;
        hull.add(piece, both(between(o.z, e.z, base + std::min(0.0, rise), base + std::max(0.0, rise)),
                             inCircle({q.x - up * lean.x, q.y - up * lean.y}, wide, r)));
      }
    }
    const Flat2 forward{forward_[0], forward_[1]};
    const double along = dot(q, forward), alongStep = dot(w, forward);
    Stretch middle = between(o.z - slope_ * along, e.z - slope_ * alongStep, low, high);
    for (Stretch s :
         {between(cross(forward, q), cross(forward, w), -r, r), between(along, alongStep, 0, across_)}) {
      s.enterFace = s.exitFace = kSide;
      middle.clip(s);
    }
    hull.add(kMiddle, middle);
  }
  if (!(hull.enter <= hull.exit)) return {};

  // A face between two of the solids is only hit where these meet on the outside: the normal there is that of
  // the sides.
  const auto normalAt = [&](double t, int piece, int face) -> DVec3 {
    const DVec3 p = line.at(t);
    const bool isUpperFree = piece == kFirst  ? rise <= 0 || across_ == 0
                             : piece == kLast ? rise >= 0
                                              : low == high || piece == kUpperDisc;
    const bool isLowerFree = piece == kFirst  ? rise >= 0
                             : piece == kLast ? rise <= 0
                                              : low == high || piece == kLowerDisc;
    if (piece == kMiddle) {
      if (face != kSide && rise == 0) return {0, 0, face == kLower ? -1 : 1};
      const double side = forward_[0] * p.y - forward_[1] * p.x < 0 ? -1 : 1;
      return {-side * forward_[1], side * forward_[0], 0};
    }
    if (face == kLower && isLowerFree) return {0, 0, -1};
    if (face == kUpper && isUpperFree) return {0, 0, 1};
    DVec3 n(p.x, p.y, 0);
    if (piece == kLast) n -= DVec3(move.x, move.y, 0);
    if (piece == kLowerDisc || piece == kUpperDisc) {
      const double s = (p.z - (piece == kLowerDisc ? low : high)) * perHeight_;
      n -= s * DVec3(move.x, move.y, 0);
      n.z = -(n.x * move.x + n.y * move.y) * perHeight_;
    }
    const double size = length(n);
    return size > 0 ? n / size : DVec3(0, 0, face == kLower ? -1 : 1);
  };
  return {hull.enter, hull.exit, normalAt(hull.enter, hull.enterPiece, hull.enterFace),
          normalAt(hull.exit, hull.exitPiece, hull.exitFace)};
}

void StraightSweep::addBall(const LocalLine& line, LocalSpan& span) const {
  const double r = cutter_.radius;
  const DVec3 o = line.origin - DVec3(0, 0, r), e = line.direction;
  LocalSpan ball;
  const auto addAt = [&](DVec3 center) {
    const DVec3 q = o - center;
    const double b = dot(q, e);
    const DVec3 beside = q - b * e;
    const double square = r * r - dot(beside, beside);
    if (!(square >= 0)) return;
    const double half = std::sqrt(square);
    ball.enter = std::min(ball.enter, -b - half);
    ball.exit = std::max(ball.exit, -b + half);
  };
  addAt(DVec3(0));
  const bool moves = across_ != 0;
  if (moves) {
    addAt(move_);
    const DVec3 axis = move_ / length_;
    const double along = dot(o, axis), alongStep = dot(e, axis);
    const DVec3 q = o - along * axis, w = e - alongStep * axis;
    const double a = dot(w, w);
    if (a > 1e-300) {
      const double c = dot(axis, cross(w, q)), discriminant = a * r * r - c * c;
      if (discriminant >= 0) {
        const double root = std::sqrt(discriminant), b = dot(w, q);
        const Stretch ends = between(along, alongStep, 0, length_);
        const double enter = std::max(ends.enter, (-b - root) / a),
                     exit = std::min(ends.exit, (-b + root) / a);
        if (enter <= exit) {
          ball.enter = std::min(ball.enter, enter);
          ball.exit = std::max(ball.exit, exit);
        }
      }
    }
  }
  if (ball.empty()) return;
  const auto normalAt = [&](double t) {
    DVec3 n = o + t * e;
    if (moves) n -= std::clamp(dot(n, move_) / (length_ * length_), 0.0, 1.0) * move_;
    const double size = length(n);
    return size > 0 ? n / size : DVec3(0, 0, -1);
  };
  ball.enterNormal = normalAt(ball.enter);
  ball.exitNormal = normalAt(ball.exit);
  widen(span, ball);
}

// The place s of the disc, from 0 to 1, at which it is nearest: the root of the derivative of the squared
// distance, half of it: -(1 - flat / |x|) (x . m) - b h, where x = q - s m across the axis, b = z - s h along
// it. It grows with s. Over the disc (|x| <= flat) its root is z / h. Else the root is between that and where
// x is shortest; there the function is curved one way, so that Newton's method comes to the root from z / h
// without passing it, and just so from an end of the way that lies between.
StraightSweep::Nearest StraightSweep::nearestOfDisc(DVec3 q) const {
  const double flat = cutter_.radius - cutter_.cornerRadius, rise = move_.z;
  const Flat2 m{move_.x, move_.y}, x0{q.x, q.y};
  const double mm = across_ * across_;
  double s = 0;
  if (across_ != 0 && rise == 0) {
    s = std::clamp(dot(x0, m) / mm, 0.0, 1.0);
  } else if (across_ != 0) {
    const double level = q.z * perHeight_, c = cross(x0, m), cc = c * c, hh = rise * rise;
    s = std::clamp(level, 0.0, 1.0);
    constexpr int kMostSteps = 64;
    for (int k = 0; k < kMostSteps; ++k) {
      const Flat2 x{x0.x - s * m.x, x0.y - s * m.y};
      const double square = dot(x, x);
      if (square <= flat * flat) break;
      const double size = std::sqrt(square), xm = dot(x, m), share = flat / size;
      const double value = -(1 - share) * xm - (q.z - s * rise) * rise;
      const double growth = mm - share * cc / square + hh;
      const double next = std::clamp(s - value / growth, 0.0, 1.0);
      const bool isThere = std::fabs(next - s) <= 0x1p-50;
      s = next;
      if (isThere) break;
    }
  }
  const Flat2 x{x0.x - s * m.x, x0.y - s * m.y};
  const double size = std::sqrt(dot(x, x)), beyond = size > flat ? 1 - flat / size : 0;
  const DVec3 away{beyond * x.x, beyond * x.y, q.z - s * rise};
  return {away, length(away)};
}

void StraightSweep::addRoundedEdge(const LocalLine& line, LocalSpan& span) const {
  const double r = cutter_.radius, corner = cutter_.cornerRadius;
  const DVec3 o = line.origin - DVec3(0, 0, corner), e = line.direction;
  // Up and down, the lowest place alone counts.
  const double rise = across_ == 0 ? 0 : move_.z;
  const Flat2 forward = across_ == 0 ? Flat2{1, 0} : Flat2{forward_[0], forward_[1]};
  const Flat2 q{o.x, o.y}, w{e.x, e.y};
  double enter = -kInfinity, exit = kInfinity;
  for (const Stretch& s : {between(o.z, e.z, std::min(0.0, rise) - corner, std::max(0.0, rise) + corner),
                           between(dot(forward, q), dot(forward, w), -r, across_ + r),
                           between(cross(forward, q), cross(forward, w), -r, r)}) {
    enter = std::max(enter, s.enter);
    exit = std::min(exit, s.exit);
  }
  if (!(enter <= exit)) return;

  const double tiny = 0x1p-50 * corner;
  LocalSpan round;
  const bool isShank = !span.empty();
  for (const double inwards : {1.0, -1.0}) {
    // Where the line comes to the shank outside of the rounded part, it does not come to that before: all is
    // convex.
    const double atShank = inwards > 0 ? span.enter : span.exit;
    if (isShank && nearestOfDisc(o + atShank * e).distance > corner) continue;
    double t = inwards > 0 ? enter : exit;
    DVec3 normal{0};
    constexpr int kMostSteps = 128;
    for (int k = 0;; ++k) {
      const Nearest at = nearestOfDisc(o + t * e);
      if (at.distance > 0) normal = at.away / at.distance;
      const double value = at.distance - corner;
      if (!(value > tiny) || k == kMostSteps) break;
      const double slope = inwards * dot(normal, e);
      if (!(slope < 0)) return;  // it grows from here on: the line misses
      const double next = t - inwards * value / slope;
      if (next == t) break;
      t = next;
      if (inwards > 0 ? t > exit : t < enter) return;
    }
    (inwards > 0 ? round.enter : round.exit) = t;
    (inwards > 0 ? round.enterNormal : round.exitNormal) = normal;
  }
  widen(span, round);
}

bool StraightSweep::contains(DVec3 p) const {
  const DVec3 q = p - from_;
  const double r = cutter_.radius, rise = move_.z;
  // The part of the way on which low <= height above the tip <= high.
  struct Part {
    double begin = 0, end = 1;
  };
  const auto partOf = [&](double low, double high) {
    if (rise == 0) return q.z >= low && q.z <= high ? Part{} : Part{1, 0};
    const double a = (q.z - low) / rise, b = (q.z - high) / rise;
    return Part{std::max(0.0, std::min(a, b)), std::min(1.0, std::max(a, b))};
  };
  const auto squareTo = [&](double s) {
    const double x = q.x - s * move_.x, y = q.y - s * move_.y;
    return x * x + y * y;
  };
  const auto nearestIn = [](const Part& part, double s) { return std::clamp(s, part.begin, part.end); };

  const Part shank = partOf(cutter_.shankBegin(), cutter_.length);
  const double beside = across_ == 0 ? 0 : (q.x * move_.x + q.y * move_.y) / (across_ * across_);
  if (shank.begin <= shank.end && squareTo(nearestIn(shank, beside)) <= r * r) return true;
  if (cutter_.kind == Cutter::Kind::Flat) return false;

  const double tip = cutter_.shankBegin();
  const Part below = partOf(-kInfinity, tip);
  if (!(below.begin <= below.end)) return false;
  const double flat = r - tip;
  const auto squareAt = [&](double s) {
    const double out = std::max(0.0, std::sqrt(squareTo(s)) - flat), down = q.z - s * rise - tip;
    return out * out + down * down;
  };
  // Convex in s: a third is taken away at a time.
  double a = below.begin, b = below.end;
  constexpr int kThirds = 120;
  for (int k = 0; k < kThirds; ++k) {
    const double third = (b - a) / 3;
    (squareAt(a + third) < squareAt(b - third) ? b : a) +=
        squareAt(a + third) < squareAt(b - third) ? -third : third;
  }
  return squareAt((a + b) / 2) <= tip * tip;
}

}  // namespace restroke::points
