#pragma once
// What one list costs: stamps, undo, rebuild, rays, pictures, bytes.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "experiments/scaling/layouts.h"
#include "implicit/execution.h"
#include "points/images/png.h"
#include "points/surfel_model.h"

namespace restroke::experiments {

/// How often, and what of; nothing here changes a shape.
struct MeasureOptions {
  std::size_t stamps =
      2000;                ///< single stamps that are timed, at least; fewer when they take over `patience`
  std::size_t undos = 60;  ///< strokes in the middle that are undone, at most
  double patience = 2;     ///< seconds for each kind of measurement that is repeated
  std::uint32_t width = 1280, height = 720;  ///< pixels of the picture that is timed
  std::uint64_t seed = 1;  ///< of the rays' pixels and the stamps whose neighbours are counted
  /// Also draw the picture for people, with smooth edges: the whole, and a part of it.
  bool portrait = false;
};

/// What is measured on one list. Times are wall times; medians and 99th percentiles are values of the sample.
struct Measured {
  std::size_t primitives = 0, bases = 0, strokes = 0;
  std::size_t surfels = 0;
  float density = 0;
  double leastRadius = 0, mostRadius = 0;  ///< of the stamps, model units
  double met = 0;      ///< primitives whose balls meet that of a stamp, the stamp left out; mean over stamps
  double metMost = 0;  ///< the greatest number among the stamps that were looked at

  std::size_t timedStamps = 0;
  double stampMedian = 0, stampHigh = 0;  ///< microseconds to append one stamp to the list at its full length
  double replay = 0;                      ///< seconds for all strokes, appended one by one after the bases
  double baseSeconds = 0;                 ///< for the bases, making the table of their samples included
  std::size_t undone = 0;
  double undoMedian = 0, undoHigh = 0;       ///< milliseconds to take out one stroke in the middle
  double rebuildOne = 0, rebuild = 0;        ///< milliseconds, by one thread and by all
  std::size_t rays = 0;                      ///< cast through random pixels, by one thread
  double raysASecond = 0, raysPrefixed = 0;  ///< against the whole list, and against its first half
  double rayHits = 0;                        ///< part of the rays that hit the whole list
  /// Milliseconds to list the surfels, and to draw them once they are listed (one sample a pixel, no exact
  /// edges); nothing when memory did not suffice.
  std::optional<double> listing, picture;

  points::ModelBytes bytes;
  std::size_t resident = 0;      ///< bytes of the process once the list was replayed
  std::size_t peakResident = 0;  ///< most bytes of the process while all this was measured
  std::string stateHash;         ///< after replay, after every undo was taken back, and after each rebuild
  std::string leftOut;           ///< one sentence where something was, else empty
  std::optional<points::DisplayImage> whole, part;  ///< with portrait
};

/// Replays the layout and measures. Throws InputError for stamps that the model refuses, and InternalError
/// when the state after undo and reinsertion, or after a rebuild, is not the one before.
[[nodiscard]] Measured measure(const Layout& layout, const MeasureOptions& options,
                               const Execution& execution);

/// Bytes that drawing takes for each surfel, about: itself, and its disc on the screen.
inline constexpr std::size_t kDrawingBytes = 130;

}  // namespace restroke::experiments
