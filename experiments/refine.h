#pragma once
// Experiment: what does refinement by references miss, and what does it save (SPEC X5, R2-R6; N. Montana,
// M. Monteil, R. Nosenzo, A. Lieutier, Designing a modeled volume represented by dexels, US 2013/0116983,
// 2013)?
//
// Hypothesis: where a model's operations are much larger than its cells, the operations at the ends of its
//   lines are those that matter, and a zone refined by them alone is the model but for slivers; the time of a
//   zoom follows the zone. What no line meets, no end can refer to: such operations are lost whatever is
//   done with the ends, and so is their shape. Operations from clusters never miss anything.
// Metric: each method of points/dexel/refine/refine.h against the replay of the whole history (`all`), on the
//   same new lines of the same zone:
//   missed       operations that made an end of the reference, or are on either side of one, and were not
//                collected, by all such operations; and ends that those made, by all ends
//   wrong        length of the lines inside one of both only, by the length inside the reference: what is
//                missing, what is too much, their sum; their difference is the wrong volume
//   Hausdorff    greatest distance from an end of one to the nearest end of the other, both ways, in model
//                units and in cells of the model
//   seconds      to find the operations, to make the approximation from the model's cells, to replay:
//                medians and quartiles of repetitions in turn, so that what is compared ran in one run
//   against the model's lines along its longest side, the zone's part of the volume of the model's bounds,
//   the size of features in cells, operations that cover a point, the part of additions, and the thickness of
//   features thinner than a cell; and seconds against the number of operations, with the zone where it is.
// Expected shape: missed operations grow as features come down to the size of cells, and nothing is found
//   of rods and grains that lie between the lines; plates are always met by one family. Wrong lengths fall
//   with the cells, faster than missed operations, since what is missed is small. `document` contains the
//   solid where there are only removals, is contained in it where there are only additions, and is far off
//   where both occur. `clusters` is `all`, bit for bit. Seconds of `all` grow with the history, plainly in
//   proportion; those of `ends` and `clusters` do not grow with what is elsewhere; where operations pile up
//   in the zone itself, `clusters` grows with them and `ends` only until the surface is all theirs.
//
// The document has no figures to compare with. This project's targets: `ends` within 0.02 % of wrong length
// on dense mixed histories at 258 lines; at a million operations 50 times as fast as plain `all`, and 3 times
// as fast as `all` culled by bounds.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "experiments/refine/growth.h"
#include "experiments/refine/loss.h"
#include "experiments/refine/pictures.h"

namespace restroke::experiments {

inline constexpr std::size_t kLeastGrowth = 500, kMostGrowth = 10'000'000;

/// What changes the result.
struct RefinementOptions {
  LossOptions loss;
  GrowthOptions growth;
  std::uint32_t pictureSize = 420;  ///< pixels along each side; 0: no pictures
  int picturePlaces = 6;            ///< zones of which the worst is drawn
  std::uint64_t seed = 1;           ///< of histories and places
  bool smoke = false;
};
/// Seconds instead of minutes: small histories, few lines and places, small pictures.
[[nodiscard]] RefinementOptions smokeSize(RefinementOptions options);
/// The options as canonical text; its hash is in every row.
[[nodiscard]] std::string describe(const RefinementOptions& options);

/// Shipped logs; a small one for smoke.
[[nodiscard]] std::vector<std::filesystem::path> defaultRefinementLogs(bool smoke);

struct RefinementResults {
  std::vector<LossRow> losses;     ///< by sweep, history, value, resolution, zone, method
  std::vector<GrowthRow> growths;  ///< by growth, operations, method
  std::vector<LossPicture> pictures;
  std::vector<std::pair<std::string, std::string>> inputs;  ///< files and their hashes
  std::vector<std::string> notes;                           ///< what was left out, and why
};

/// Told of progress: what is at work, done and in all.
using RefinementProgress = std::function<void(const std::string& what, std::size_t done, std::size_t all)>;

/// Measures made histories and those of the logs. All figures but seconds are the same for any number of
/// threads. Throws InputError for a log that cannot be read or ends with nothing, and for options out of
/// range.
[[nodiscard]] RefinementResults measureRefinement(const std::vector<std::filesystem::path>& logs,
                                                  const RefinementOptions& options,
                                                  const Execution& execution = {},
                                                  const RefinementProgress& progress = {});

/// Writes results.csv, results.json, times.csv, times.json, manifest.json, figures, pictures and report.html
/// into the folder, which is made when it is not there. Returns the files' names. Throws InputError when
/// something cannot be written or drawn.
std::vector<std::string> writeRefinement(const RefinementResults& results, const RefinementOptions& options,
                                         const std::filesystem::path& out);

}  // namespace restroke::experiments
