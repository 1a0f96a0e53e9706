#pragma once
// From a stroke to stamps: spheres along the surface, evenly spaced whatever the input's sample rate.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "implicit/primitive.h"
#include "retarget/method.h"
#include "retarget/stroke.h"

namespace restroke::sculpt {

enum class Mode : std::uint8_t { Add, Carve };
[[nodiscard]] inline implicit::Sign signOf(Mode mode) {
  return mode == Mode::Add ? implicit::Sign::Positive : implicit::Sign::Negative;
}

/// What a stroke leaves behind.
enum class Trace : std::uint8_t {
  Stamps,  ///< the tip, again and again
  Sweep    ///< what the ball sweeps on its way: round cones from bend to bend
};

/// What becomes of the radius when the stroke is applied to a shape that has grown or shrunk, where the
/// method knows by how much (`mapped`, `aligned`, `surface`).
enum class Radii : std::uint8_t { Keep, Follow };

struct Brush {
  float radius = 0.05f;   ///< model units, > 0, at most kMaxCoordinate
  float spacing = 0.25f;  ///< distance between neighbouring stamps as a fraction of the radius, 0.01 to 4
  /// 0: pressure has no effect; 1: the radius is proportional to it; between: mixed linearly. The radius
  /// never falls below 1/16 of `radius`.
  float pressureToRadius = 0;
  Mode mode = Mode::Add;
  Trace trace = Trace::Stamps;
  Radii radii = Radii::Keep;
  /// The tip, null for a ball. Its frame counts in brush radii, its z axis goes along the surface's normal
  /// and its x axis along the stroke (of one single stamp: to the camera's right). Sweeps have none.
  std::shared_ptr<const implicit::Volume> tip = {};
  bool operator==(const Brush& other) const;
};

/// One place of a stroke.
struct Stamp {
  Point center{0};
  float radius = 0.05f;
  bool joined = false;                        ///< of a sweep: the ball came here from the stamp before
  std::array<float, 4> rotation{0, 0, 0, 1};  ///< of the tip; without one, none
  bool operator==(const Stamp&) const = default;
};

/// What a stroke became on a given shape.
struct StrokeOutcome {
  std::vector<Stamp> stamps;  ///< in order along the stroke
  std::size_t misses = 0;     ///< input points whose ray misses the shape
  std::size_t pieces = 0;     ///< runs of the stroke between misses and jumps; 0 when nothing was hit
  bool operator==(const StrokeOutcome&) const = default;
};

/// More stamps in one stroke are refused.
inline constexpr std::size_t kMaxStamps = 1'000'000;

/// Throws InputError (`where` begins the sentence) unless every field is in its range.
void validate(const Brush& brush, const std::string& where);

/// Walks the stroke over the surface that the caster sees and sets a stamp at the start of every piece and
/// then at every radius * spacing of length along the surface (the radius being that of the stamp just set,
/// when pressure varies it).
///
/// Between two input points the screen is bisected and cast until neighbouring hits are within min(spacing,
/// 1/2) * radius of each other; input points within half of that, or within a pixel, of the polyline's last
/// vertex are passed over. So the stamps depend on the curve that was drawn and not on how often the pen was
/// asked. Where one of two points misses, the edge is found to within a pixel, and the piece ends or begins
/// there; between two points that both miss nothing is looked for. Hits less than a pixel apart on the
/// screen, but apart in space by more than the radius and by more than 8 pixels' footprint, are a jump from
/// one surface to another: the piece ends and a new one begins.
///
/// Centres lie on the chords between neighbouring hits, so a centre is off the surface by at most half a
/// chord, radius * min(spacing, 1/2) / 2, and where the surface is smooth by chord^2 / (8 R) for a radius of
/// curvature R (at the default spacing on one of the brush's own radius: under 1 % of the radius); grazing
/// steps that no pixel resolves are bridged by chords of up to the jump's limit. Then centres are rounded to
/// multiples of `grid` (model units, a power of two), half to even. That is exact for coordinates under 2^24
/// * grid; beyond them float32 has fewer digits than the grid asks for.
///
/// A sweep sets its stamps where the stroke bends instead: each leg is as long as it can be while it passes
/// every place where a ball would have been stamped within kSweepTolerance.
///
/// One point, or equal points: one stamp. All points miss: none, pieces 0. Equal neighbours are cast once.
/// Needs the stroke and the brush to be valid; throws InputError for a grid that is no power of two and when
/// more than kMaxStamps stamps are needed. The same hits give the same bits: only + - * / and sqrt in double.
/// O(input points + stamps) casts.
[[nodiscard]] StrokeOutcome stampsAlong(const retarget::Stroke& stroke, const Brush& brush, float grid,
                                        retarget::Caster& caster);

/// How far a sweep may pass beside the places where a ball of `radius` would have been stamped, and how much
/// its radius may differ there, as a fraction of the radius: the sweep and stamps set ever more densely
/// differ by at most twice that, and the sweep needs only as many round cones as the stroke has bends.
inline constexpr float kSweepTolerance = 1.0f / 32;

/// The primitives that the stroke adds to the list: a ball or a tip for each stamp; of a sweep a round cone
/// for each joined stamp, and a ball for a stamp that none is joined to. Where one of two joined balls holds
/// the other, the ball alone. Throws InputError when a primitive is refused (PosedVolume).
[[nodiscard]] std::vector<implicit::Primitive> primitivesOf(const StrokeOutcome& outcome, const Brush& brush);

}  // namespace restroke::sculpt
