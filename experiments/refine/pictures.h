#pragma once
// What is lost, to be looked at.

#include <cstdint>
#include <string>
#include <vector>

#include "experiments/refine/loss.h"
#include "points/images/png.h"

namespace restroke::experiments {

struct PictureOptions {
  std::uint32_t size = 420;  ///< pixels along each side, > 0
  int fineLines = 128;       ///< as LossOptions has it
  double part = 0.01;        ///< the zone's part of the volume of the model's bounds
  int places = 6;            ///< that are tried, > 0
};

/// A zone of a model, by one method: in space, and cut through. Red is missing, blue is too much.
struct LossPicture {
  std::string history;  ///< for people, with the model's lines
  std::string method;   ///< "all", document, ends, touching
  std::string slug;     ///< for names of files: letters, digits and -
  double wrong = 0;     ///< of all lines of the zone, by the length inside the reference; 0 of "all"
  /// Surfels at the ends; those at missing stretches are the reference's.
  points::DisplayImage surface;
  /// The lines along x through one plane across z, a row of pixels each: the plane where `ends` is most
  /// wrong, for all methods the same.
  points::DisplayImage slice;
};

/// A model that is drawn.
struct PictureCase {
  std::string title, slug;
  LossModel model;
};
/// Dense adds and carves on coarse lines, milling, and rods between the lines.
[[nodiscard]] std::vector<PictureCase> pictureCases(const LossOptions& options, std::uint64_t seed);

/// The reference, document, ends and touching, of the zone of several where `ends` is most wrong. `seed`: of
/// the places, as measureLoss has it.
[[nodiscard]] std::vector<LossPicture> drawLoss(const PictureCase& drawn, const PictureOptions& options,
                                                std::uint64_t seed, const Execution& execution = {});

/// A plane's lines as rows of pixels, the first line at the foot: outside light, inside grey, missing red,
/// too much blue. `across`: pixels along the lines, between the depths from < to.
struct SliceLine {
  points::LineEnds reference, judged;
};
[[nodiscard]] points::DisplayImage sliceImage(const std::vector<SliceLine>& lines, float from, float to,
                                              std::uint32_t size);

}  // namespace restroke::experiments
