#pragma once
// A pen that draws on shapes, to make example logs: where it aims is said in model space, what it records is
// a stroke. Everything is computed with + - * / and sqrt, so that the logs are the same bytes on every
// machine.

#include <span>
#include <vector>

#include "sculpt/document.h"
#include "sculpt/stroke_log.h"

namespace restroke::experiments {

/// (cos, sin) of a number of turns. Polynomials, exact to about 1e-13; no libm.
struct Turn {
  double cos = 1, sin = 0;
};
[[nodiscard]] Turn turn(double turns);

/// Where the pen is aimed at, and how hard it presses.
struct Aim {
  DVec3 at{0};
  double pressure = 1;  ///< 0 to 1
};

/// A camera at `from` that looks at `at`, 1280 x 960 pixels, up as nearly as possible `up`.
[[nodiscard]] Camera cameraAt(DVec3 from, DVec3 at, DVec3 up = {0, 1, 0});

/// Points at equal distances from one place to the other, both included; `points` > 1.
[[nodiscard]] std::vector<Aim> straight(DVec3 from, DVec3 to, int points);

/// The stroke that a pen draws which is aimed at these points, one every 8 ms. Screen coordinates are rounded
/// to 1/16 pixel and equal neighbours kept: that is what a pen does that waits. Throws InternalError for a
/// point behind the camera.
[[nodiscard]] retarget::Stroke penStroke(const Camera& camera, std::span<const Aim> aims);

/// Writes down strokes while carrying them out.
class Sculptor {
 public:
  explicit Sculptor(const sculpt::LogHeader& header);

  [[nodiscard]] const sculpt::Document& document() const { return document_; }
  [[nodiscard]] const sculpt::StrokeLog& log() const { return log_; }

  /// Draws the stroke and returns the number of stamps that it became.
  std::size_t draw(const Camera& camera, std::span<const Aim> aims, const sculpt::Brush& brush);
  /// The same, of a stroke that has to hit: throws InternalError when the whole of it misses the shape.
  void drawOn(const Camera& camera, std::span<const Aim> aims, const sculpt::Brush& brush);
  /// The same, with the pen lifted as soon as there are `stamps` stamps. Returns false, and draws nothing,
  /// when the whole stroke has fewer, or jumps over that number.
  bool drawUntil(const Camera& camera, std::span<const Aim> aims, const sculpt::Brush& brush,
                 std::size_t stamps);

  /// Carries out any command, and writes it down with what followed from it.
  sculpt::CommandReport carryOut(sculpt::Command command);

  /// Where a ray from `from` towards `at` meets the shape. Throws InternalError when it does not.
  [[nodiscard]] DVec3 surfaceSeen(DVec3 from, DVec3 at) const;

 private:
  sculpt::StrokeLog log_;
  sculpt::Document document_;
};

}  // namespace restroke::experiments
