// Stamps along a stroke, as painting programs set dabs, but spaced along the surface instead of the screen.

#include "sculpt/brush.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "implicit/errors.h"
#include "implicit/primitive_list.h"

namespace restroke::sculpt {
namespace {

constexpr double kSmallestRadius = 1.0 / 16;  // fraction of the brush's radius that a light touch leaves
constexpr double kLongestChord =
    0.5;  // of the radius: how far apart hits may be for stamps to lie between them
constexpr double kJumpFootprints =
    8;  // slope against the line of sight (83 degrees) that a step within a pixel may have

/// A point of the stroke, given or put between two given ones.
struct Sample {
  ScreenPoint screen;
  double pressure = 0;         // 0 to 1
  std::optional<DVec3> place;  // nothing: the ray misses
};

/// Radius as pressure has it, in double until a stamp is made.
class RadiusRule {
 public:
  explicit RadiusRule(const Brush& brush)
      : radius_(static_cast<double>(brush.radius)), effect_(static_cast<double>(brush.pressureToRadius)) {}
  [[nodiscard]] double at(double pressure) const {
    return radius_ * std::max(kSmallestRadius, (1 - effect_) + effect_ * pressure);
  }

 private:
  double radius_, effect_;
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
  Stamper(const Brush& brush, float grid, StrokeOutcome& outcome)
      : brush_(brush), rule_(brush), grid_(static_cast<double>(grid)), outcome_(outcome) {}

  void begin(const Sample& sample) {
    ++outcome_.pieces;
    last_ = sample;
    stamp(*sample.place, sample.pressure);
  }
  void lineTo(const Sample& sample) {
    const DVec3 from = *last_.place, chord = *sample.place - from;
    const double chordLength = length(chord);
    double walked = 0;  // along the chord
    while (chordLength - walked >= untilNext_) {
      walked += untilNext_;
      const double s = walked / chordLength;
      stamp(from + s * chord, last_.pressure + s * (sample.pressure - last_.pressure));
    }
    untilNext_ -= chordLength - walked;
    last_ = sample;
  }

 private:
  void stamp(DVec3 place, double pressure) {
    if (outcome_.stamps.size() == kMaxStamps)
      throw InputError(fmt::format(
          "a stroke needs more than {} stamps at a brush radius of {} and a spacing of {}; one may "
          "have at most so many",
          kMaxStamps, brush_.radius, brush_.spacing));
    const double radius = rule_.at(pressure);
    untilNext_ = radius * static_cast<double>(brush_.spacing);
    const Point center{static_cast<float>(roundToGrid(place.x, grid_)),
                       static_cast<float>(roundToGrid(place.y, grid_)),
                       static_cast<float>(roundToGrid(place.z, grid_))};
    outcome_.stamps.push_back(
        {.shape = {center, static_cast<float>(radius)},
         .sign = brush_.mode == Mode::Add ? implicit::Sign::Positive : implicit::Sign::Negative});
  }

  const Brush& brush_;
  RadiusRule rule_;
  double grid_;
  StrokeOutcome& outcome_;
  Sample last_;
  double untilNext_ = 0;  // length to go to the next stamp
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

  [[nodiscard]] Sample sampleAt(ScreenPoint screen, double pressure) {
    Sample sample{screen, pressure, std::nullopt};
    // A pen that rests sends the same place again and again.
    if (last_ && last_->screen == screen) {
      sample.place = last_->place;
      return sample;
    }
    if (const auto hit = caster_.cast(screen)) sample.place = DVec3(hit->position);
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
      connect(vertex_, sample);
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
    if (isWithinPixel(a.screen, b.screen)) {
      if (!b.place) return;  // the piece has ended at a
      return a.place && !isJump(a, b) ? stamper_.lineTo(b) : stamper_.begin(b);
    }
    const ScreenPoint middle{middleOf(a.screen.x, b.screen.x), middleOf(a.screen.y, b.screen.y)};
    const Sample m = sampleAt(middle, (a.pressure + b.pressure) / 2);
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
    return std::min(rule_.at(a.pressure), rule_.at(b.pressure));
  }
  [[nodiscard]] bool isShort(const Sample& a, const Sample& b) const {
    return length(*b.place - *a.place) <= chord_ * radiusBetween(a, b);
  }
  /// So close that b adds more of the pen's tremble and of the screen's rounding to the length of the way
  /// than of the way: a pen that is asked ten times as often must not go farther.
  [[nodiscard]] bool isNear(const Sample& a, const Sample& b) const {
    return length(*b.place - *a.place) <= chord_ / 2 * radiusBetween(a, b) ||
           (isWithinPixel(a.screen, b.screen) && !isJump(a, b));
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
}

StrokeOutcome stampsAlong(const retarget::Stroke& stroke, const Brush& brush, float grid,
                          retarget::Caster& caster) {
  if (!isPowerOfTwo(grid))
    throw InputError(fmt::format("the grid of stamp centres, {}, is not a power of two", grid));
  StrokeOutcome outcome;
  Stamper stamper(brush, grid, outcome);
  Walk walk(stroke.camera, brush, caster, stamper);
  for (const retarget::StrokePoint& point : stroke.points) {
    const Sample sample =
        walk.sampleAt(point.screen, static_cast<double>(point.pressure) / retarget::kMaxPressure);
    if (!sample.place) ++outcome.misses;
    walk.add(sample);
  }
  walk.finish();
  return outcome;
}

}  // namespace restroke::sculpt
