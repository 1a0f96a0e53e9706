#pragma once
// Lists of stamps made to measure: as many as wanted, each stroke a function of its number and the seed.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "implicit/primitive.h"

namespace restroke::experiments {

/// Stamps of a made stroke, and their distance in radii.
inline constexpr std::size_t kStrokeStamps = 32;
inline constexpr double kStampSpacing = 0.25;

/// A list, stroke by stroke: nothing but the bases is kept, so that a list of ten million costs nothing
/// before it is replayed.
struct Layout {
  std::vector<implicit::Primitive> bases;  ///< they come first
  std::size_t strokes = 0;
  /// Stroke k: the same every time. With `endless`, k may be `strokes` or more: further strokes of the same
  /// kind, for measuring stamps on the whole list.
  std::function<std::vector<implicit::Primitive>(std::size_t k)> stroke;
  bool endless = true;
  float density = 0;              ///< samples per square model unit
  Vec3 view{-0.35f, -0.25f, -1};  ///< how it is looked at, and how much of the picture's height its
  float fill = 0.97f;             ///< bounding sphere takes
};

/// A surface that grows: pebbles, each with about 1,000 stamps, on a square tray. Every pebble has the same
/// size, the same brush and the same number of strokes to within one, so that a stamp meets as many others in
/// a list of a million as in one of a thousand. Each stroke is on another pebble, far from the last. Stamps,
/// crowding and density are about those of the paper's sculpture: 272 stamps of radius 0.045 a square unit,
/// 17,600 samples a square unit.
[[nodiscard]] Layout extentLayout(std::size_t primitives, std::uint64_t seed);

/// Detail that grows: one unit sphere, and a brush that shrinks as 1 / sqrt(primitives) while the density
/// grows with their number, so that a stamp meets as many others, and has as many samples, at every size.
[[nodiscard]] Layout detailLayout(std::size_t primitives, std::uint64_t seed);

/// All strokes on one cap of the unit sphere, of radius `cap` (chord from its middle to its rim, greater than
/// 0 and at most 2, which is the whole sphere): they lie on each other. The brush is such that
/// a stamp in the middle of the cap meets about 10 / cap^2 others, whatever their number, as long as stamps
/// are small beside the cap: radius 0.005 for 100,000 primitives, with 128 samples each.
[[nodiscard]] Layout crowdedLayout(std::size_t primitives, double cap, std::uint64_t seed);

/// Strokes of brushes from 1 to `spread` (1 to 10,000), log-uniform, evenly over the order of strokes, on the
/// unit sphere. The mean area of a stamp is that of radius 0.15 whatever the spread, so that samples and
/// crowding stay alike.
[[nodiscard]] Layout spreadLayout(std::size_t primitives, double spread, std::uint64_t seed);
/// The smallest and largest radius of it.
struct RadiusRange {
  double least = 0, most = 0;
};
[[nodiscard]] RadiusRange radiiOf(double spread);

/// What a log or stamp list ends with, each stroke as it stands in the list; the bases are those of node 0.
/// Throws InputError when it cannot be read, or holds fewer than two strokes.
[[nodiscard]] Layout listLayout(const std::filesystem::path& file);

}  // namespace restroke::experiments
