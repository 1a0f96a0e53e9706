// Stamps along a stroke, as painting programs set dabs, but spaced along the surface instead of the screen.

#include "sculpt/brush.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "implicit/errors.h"
#include "implicit/primitive_list.h"
#include "implicit/shapes/kinds.h"

namespace restroke::sculpt {
namespace {

constexpr double kSmallestRadius = 1.0 / 16;  // fraction of the brush's radius that a light touch leaves
constexpr double kLongestChord =
    0.5;  // of the radius: how far apart hits may be for stamps to lie between them
constexpr double kJumpFootprints =
    8;  // slope against the line of sight (83 degrees) that a step within a pixel may have

/// A point of the stroke, given or put between two given ones.
struct Sample {
  retarget::StrokePlace at;
  double pressure = 0;         // 0 to 1
  std::optional<DVec3> place;  // nothing: the ray misses
  DVec3 normal{0, 0, 1};       // of the surface there
  double scale = 1;            // how much lengths have grown there
};

/// Radius as pressure and, where the brush follows it, the change of scale have it; in double until a stamp
/// is made.
class RadiusRule {
 public:
  explicit RadiusRule(const Brush& brush)
      : radius_(static_cast<double>(brush.radius)),
        effect_(static_cast<double>(brush.pressureToRadius)),
        follows_(brush.radii == Radii::Follow) {}
  [[nodiscard]] double at(double pressure, double scale) const {
    const double drawn = radius_ * std::max(kSmallestRadius, (1 - effect_) + effect_ * pressure);
    return follows_ ? drawn * scale : drawn;
  }

 private:
  double radius_, effect_;
  bool follows_;
};

/// Nearest multiple of the grid, half to even. The grid is a power of two: dividing and multiplying by it is
/// exact.
double roundToGrid(double value, double grid) {
  const double cells = value / grid;
  constexpr double kWhole = 0x1p52;  // from here on every double is a whole number
  if (!(cells > -kWhole && cells < kWhole)) return value;
  // Adding and taking away 1.5 * 2^52 would do it too, but for a compiler that is told to simplify.
  const auto below =
      static_cast<std::int64_t>(cells) - (cells < 0 ? 1 : 0);  // at most `cells`, and within 1 of it
  const double rest = cells - static_cast<double>(below);
  std::int64_t whole = below;
  if (rest > 0.5 || (rest == 0.5 && (below & 1) != 0)) ++whole;
  return static_cast<double>(whole) * grid;
}

/// Sets stamps along the polyline of hits.
class Stamper {
 public:
  Stamper(const Brush& brush, float grid, const CameraFrame& frame, StrokeOutcome& outcome)
      : brush_(brush),
        rule_(brush),
        grid_(static_cast<double>(grid)),
        right_(frame.right),
        outcome_(outcome) {}

  void begin(const Sample& sample) {
    endSweep();
    ++outcome_.pieces;
    last_ = sample;
    firstOfPiece_ = true;
    stamp({*sample.place, sample.pressure, sample.normal, right_, sample.scale});
    // Its direction is known once the stroke goes on.
  }
  void lineTo(const Sample& sample) {
    const DVec3 from = *last_.place, chord = *sample.place - from;
    const double chordLength = length(chord);
    if (firstOfPiece_ && chordLength > 0) {
      if (brush_.tip) outcome_.stamps.back().rotation = implicit::rotationTo(last_.normal, chord);
      firstOfPiece_ = false;
    }
    double walked = 0;  // along the chord
    while (chordLength - walked >= untilNext_) {
      walked += untilNext_;
      const double s = walked / chordLength;
      stamp({from + s * chord, last_.pressure + s * (sample.pressure - last_.pressure),
             last_.normal + s * (sample.normal - last_.normal), chord,
             last_.scale + s * (sample.scale - last_.scale)});
    }
    untilNext_ -= chordLength - walked;
    last_ = sample;
  }
  void end() { endSweep(); }

 private:
  struct Footing {
    DVec3 place;
    double pressure;
    DVec3 normal, along;
    double scale;
  };
  void stamp(const Footing& at) {
    const double radius = rule_.at(at.pressure, at.scale);
    untilNext_ = radius * static_cast<double>(brush_.spacing);
    Stamp stamp;
    stamp.center = {static_cast<float>(roundToGrid(at.place.x, grid_)),
                    static_cast<float>(roundToGrid(at.place.y, grid_)),
                    static_cast<float>(roundToGrid(at.place.z, grid_))};
    stamp.radius = static_cast<float>(radius);
    if (brush_.tip && dot(at.normal, at.normal) > 0)
      stamp.rotation = implicit::rotationTo(at.normal, at.along);
    if (brush_.trace == Trace::Sweep)
      sweep(stamp);
    else
      put(stamp);
  }
  void put(const Stamp& stamp) {
    if (outcome_.stamps.size() == kMaxStamps)
      throw InputError(fmt::format(
          "a stroke needs more than {} stamps at a brush radius of {} and a spacing of {}; one may "
          "have at most so many",
          kMaxStamps, brush_.radius, brush_.spacing));
    outcome_.stamps.push_back(stamp);
  }
  // A leg runs from the last stamp that was put over those that wait, and is put when it would no longer pass
  // all of them closely.
  void sweep(const Stamp& stamp) {
    if (firstOfPiece_) {
      put(stamp);
      return;
    }
    waiting_.push_back(stamp);
    if (waiting_.size() < 2 || passesClosely(outcome_.stamps.back(), waiting_)) return;
    waiting_.pop_back();
    endSweep();
    waiting_.push_back(stamp);
  }
  void endSweep() {
    if (waiting_.empty()) return;
    waiting_.back().joined = true;
    put(waiting_.back());
    waiting_.clear();
  }
  static bool passesClosely(const Stamp& from, const std::vector<Stamp>& waiting) {
    const Stamp& to = waiting.back();
    const DVec3 a(from.center), leg = DVec3(to.center) - a;
    const double square = dot(leg, leg);
    for (const Stamp& s : waiting) {
      const DVec3 d = DVec3(s.center) - a;
      const double t = square > 0 ? std::clamp(dot(d, leg) / square, 0.0, 1.0) : 0;
      const double radius = static_cast<double>(from.radius) +
                            t * (static_cast<double>(to.radius) - static_cast<double>(from.radius));
      const double limit = static_cast<double>(kSweepTolerance) * static_cast<double>(s.radius);
      if (length(d - t * leg) > limit || std::fabs(radius - static_cast<double>(s.radius)) > limit)
        return false;
    }
    return true;
  }

  const Brush& brush_;
  RadiusRule rule_;
  double grid_;
  DVec3 right_;
  StrokeOutcome& outcome_;
  Sample last_;
  bool firstOfPiece_ = true;
  std::vector<Stamp> waiting_;  // of a sweep
  double untilNext_ = 0;        // length to go to the next stamp
};

/// Casts the stroke and refines it until it is a polyline on the surface.
class Walk {
 public:
  Walk(const Camera& camera, const Brush& brush, retarget::Caster& caster, Stamper& stamper)
      : frame_(frameOf(camera)),
        footprint_(2 * frame_.halfHeight / camera.height),
        chord_(std::min(static_cast<double>(brush.spacing), kLongestChord)),
        rule_(brush),
        caster_(caster),
        stamper_(stamper) {}

  [[nodiscard]] Sample sampleAt(const retarget::StrokePlace& at, double pressure) {
    Sample sample{at, pressure, std::nullopt};
    // A pen that rests sends the same place again and again.
    if (last_ && last_->at.screen == at.screen) {
      sample = *last_;
      sample.at = at;
      sample.pressure = pressure;
      return sample;
    }
    if (const auto hit = caster_.cast(at)) {
      sample.place = DVec3(hit->position);
      sample.normal = DVec3(hit->normal);
      sample.scale = static_cast<double>(hit->scale);
    }
    return sample;
  }

  /// The next point of the input.
  void add(const Sample& sample) {
    if (!last_) {
      if (sample.place) stamper_.begin(sample);
      vertex_ = sample;
    } else if (sample.place && vertex_.place && isNear(vertex_, sample)) {
      // Waits: the polyline goes on from the vertex, past what lies so close to it.
    } else if (sample.place) {
      // Places in between are counted from the input point before, so that none has the number of an input
      // point that was passed over.
      Sample start = vertex_;
      start.at.along = last_->at.along;
      connect(start, sample);
      vertex_ = sample;
    } else {
      finish();
      connect(*last_, sample);
      vertex_ = sample;
    }
    last_ = sample;
  }
  /// Walks to the last point that waits.
  void finish() {
    if (last_ && last_->place && vertex_.place) stamper_.lineTo(*last_);
  }

 private:
  /// Goes from a to b, both cast, a already walked to. Each level halves the distance on the screen, which
  /// begins under 2^26 sixteenths of a pixel: some 22 levels deep at most.
  void connect(const Sample& a, const Sample& b) {
    if (!a.place && !b.place) return;
    if (a.place && b.place && isShort(a, b)) return stamper_.lineTo(b);
    if (isWithinPixel(a.at.screen, b.at.screen)) {
      if (!b.place) return;  // the piece has ended at a
      return a.place && !isJump(a, b) ? stamper_.lineTo(b) : stamper_.begin(b);
    }
    const ScreenPoint middle{middleOf(a.at.screen.x, b.at.screen.x), middleOf(a.at.screen.y, b.at.screen.y)};
    const Sample m = sampleAt({middle, (a.at.along + b.at.along) / 2}, (a.pressure + b.pressure) / 2);
    connect(a, m);
    connect(m, b);
  }
  static std::int32_t middleOf(std::int32_t a, std::int32_t b) {
    return static_cast<std::int32_t>((std::int64_t{a} + b) >> 1);
  }
  static bool isWithinPixel(ScreenPoint a, ScreenPoint b) {
    const std::int64_t dx = std::int64_t{a.x} - b.x, dy = std::int64_t{a.y} - b.y;
    return dx * dx + dy * dy < std::int64_t{kSubPixels} * kSubPixels;
  }
  [[nodiscard]] double radiusBetween(const Sample& a, const Sample& b) const {
    return std::min(rule_.at(a.pressure, a.scale), rule_.at(b.pressure, b.scale));
  }
  [[nodiscard]] bool isShort(const Sample& a, const Sample& b) const {
    return length(*b.place - *a.place) <= chord_ * radiusBetween(a, b);
  }
  /// So close that b adds more of the pen's tremble and of the screen's rounding to the length of the way
  /// than of the way: a pen that is asked ten times as often must not go farther.
  [[nodiscard]] bool isNear(const Sample& a, const Sample& b) const {
    return length(*b.place - *a.place) <= chord_ / 2 * radiusBetween(a, b) ||
           (isWithinPixel(a.at.screen, b.at.screen) && !isJump(a, b));
  }
  [[nodiscard]] bool isJump(const Sample& a, const Sample& b) const {
    const double nearer = std::min(dot(*a.place - frame_.position, frame_.forward),
                                   dot(*b.place - frame_.position, frame_.forward));
    const double limit = std::max(radiusBetween(a, b), kJumpFootprints * footprint_ * nearer);
    return length(*b.place - *a.place) > limit;
  }

  CameraFrame frame_;
  double footprint_;  // side of a pixel at unit depth, model units
  double chord_;      // longest chord, fraction of the radius
  RadiusRule rule_;
  retarget::Caster& caster_;
  Stamper& stamper_;
  std::optional<Sample> last_;  // of the input
  Sample vertex_;               // of the polyline: the last input point that was walked to
};

bool isPowerOfTwo(float value) {
  constexpr std::uint32_t kMantissa = (1u << 23) - 1;
  return std::isnormal(value) && value > 0 && (std::bit_cast<std::uint32_t>(value) & kMantissa) == 0;
}

}  // namespace

bool Brush::operator==(const Brush& other) const {
  return radius == other.radius && spacing == other.spacing && pressureToRadius == other.pressureToRadius &&
         mode == other.mode && trace == other.trace && radii == other.radii &&
         (tip == other.tip || (tip && other.tip && &tip->kind() == &other.tip->kind() &&
                               tip->parameters() == other.tip->parameters()));
}

void validate(const Brush& brush, const std::string& where) {
  // Written so that NaN fails.
  if (!(brush.radius > 0 && brush.radius <= kMaxCoordinate))
    throw InputError(fmt::format("{}: brush radius {} is not above 0 and at most {} model units", where,
                                 brush.radius, kMaxCoordinate));
  if (!(brush.spacing >= 0.01f && brush.spacing <= 4))
    throw InputError(fmt::format("{}: brush spacing {} is not from 0.01 to 4 radii", where, brush.spacing));
  if (!(brush.pressureToRadius >= 0 && brush.pressureToRadius <= 1))
    throw InputError(fmt::format("{}: the effect of pressure on the radius, {}, is not from 0 to 1", where,
                                 brush.pressureToRadius));
  if (brush.mode != Mode::Add && brush.mode != Mode::Carve)
    throw InputError(
        fmt::format("{}: brush mode {} is neither add nor carve", where, static_cast<int>(brush.mode)));
  if (brush.tip && brush.trace == Trace::Sweep)
    throw InputError(
        fmt::format("{}: the brush sweeps a {}, but only the ball is swept; other tips are stamped", where,
                    brush.tip->kind().name));
}

StrokeOutcome stampsAlong(const retarget::Stroke& stroke, const Brush& brush, float grid,
                          retarget::Caster& caster) {
  if (!isPowerOfTwo(grid))
    throw InputError(fmt::format("the grid of stamp centres, {}, is not a power of two", grid));
  StrokeOutcome outcome;
  Stamper stamper(brush, grid, frameOf(stroke.camera), outcome);
  Walk walk(stroke.camera, brush, caster, stamper);
  for (std::size_t i = 0; i < stroke.points.size(); ++i) {
    const retarget::StrokePoint& point = stroke.points[i];
    const Sample sample = walk.sampleAt({point.screen, static_cast<double>(i)},
                                        static_cast<double>(point.pressure) / retarget::kMaxPressure);
    if (!sample.place) ++outcome.misses;
    walk.add(sample);
  }
  walk.finish();
  stamper.end();
  return outcome;
}

std::vector<implicit::Primitive> primitivesOf(const StrokeOutcome& outcome, const Brush& brush) {
  const implicit::Sign sign = signOf(brush.mode);
  const std::vector<Stamp>& stamps = outcome.stamps;
  std::vector<implicit::Primitive> primitives;
  primitives.reserve(stamps.size());
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const Stamp& stamp = stamps[i];
    if (stamp.joined && i > 0) {
      const Stamp& from = stamps[i - 1];
      const DVec3 leg = DVec3(stamp.center) - DVec3(from.center);
      const auto distance = static_cast<float>(length(leg));
      if (distance > std::fabs(from.radius - stamp.radius)) {
        const auto cone = implicit::roundConeKind().make({{{from.radius}, {stamp.radius}, {distance}}});
        primitives.push_back({std::make_shared<const implicit::PosedVolume>(
                                  cone, implicit::Pose{from.center, implicit::rotationTo(leg, {1, 0, 0}), 1}),
                              sign});
        continue;
      }
      // One holds the other. The ball before has a primitive of its own unless nothing was joined to it so
      // far.
      if (from.joined && from.radius >= stamp.radius) continue;
      primitives.push_back({implicit::Shape(from.radius >= stamp.radius ? from.center : stamp.center,
                                            std::max(from.radius, stamp.radius)),
                            sign});
      continue;
    }
    const bool goesOn = i + 1 < stamps.size() && stamps[i + 1].joined;
    if (goesOn) continue;  // the leg that follows holds it
    if (brush.tip)
      primitives.push_back({std::make_shared<const implicit::PosedVolume>(
                                brush.tip, implicit::Pose{stamp.center, stamp.rotation, stamp.radius}),
                            sign});
    else
      primitives.push_back({implicit::Shape(stamp.center, stamp.radius), sign});
  }
  return primitives;
}

}  // namespace restroke::sculpt
