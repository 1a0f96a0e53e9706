#pragma once
// Experiment: how does the cost of a stamp, an undo, a rebuild, a ray and a picture grow (SPEC S4, S11, X1)?
//
// Hypothesis: what a stamp costs depends on what it meets, not on what there is. With the same local crowding
//   a stamp on a million primitives costs at most twice what it costs on a thousand; the rest is memory that
//   is no longer in a cache.
// Metric: on each list, at its full length: median and 99th percentile of appending one stamp; of taking one
//   stroke out of the middle; rebuild by one thread and by all; rays a second through random pixels, against
//   the whole list and its first half; listing and drawing all surfels on the CPU; bytes of list, clusters
//   and surfels; resident memory of the process. Crowding is counted, by definition and without any index:
//   the primitives that a stamp meets.
// Expected shape: stamp, undo and rays flat in the number of primitives, rebuild, bytes and picture in
//   proportion to it; stamp, undo and rebuild in proportion to the samples of a stamp as the density grows; a
//   stamp at most in proportion to what it meets as strokes crowd on a cap; flat in the spread of radii,
//   since area and crowding are kept.
//
// The paper's point: 108 strokes, 3,426 primitives, about 280,000 points, edited and drawn 60 times a second
// (16.7 ms).
//
// Constant crowding, two ways, since each alone could be doubted:
//   extent   the surface grows: pebbles of about 1,000 stamps each. Every pebble is alike, so crowding is the
//            same by construction. Strokes jump from pebble to pebble, so that each finds its place out of
//            the caches. No limit but memory: the samples of all pebbles are one table.
//   detail   one unit sphere; the brush shrinks as 1 / sqrt(n) while the density grows as n. The base alone
//            has 65 n samples, which ends at the most that a primitive may have (2^26, about a million
//            stamps), and its table is read all over.
// A large slab would be a third: half of its samples would lie on a side that nothing touches.
//
// At every size the list's state hash after strokes were taken from the middle and put back, and after a
// rebuild by one thread and by all, must be the one before; else the experiment stops.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "experiments/scaling/measure.h"

namespace restroke::experiments {

/// The paper's size.
inline constexpr std::size_t kPaperPrimitives = 3426, kPaperSurfels = 280'000;
inline constexpr double kPaperFrame = 1000.0 / 60;  ///< milliseconds

enum class Sweep : std::uint8_t { Extent, Detail, Surfels, Crowding, Spread };
inline constexpr Sweep kSweeps[] = {Sweep::Extent, Sweep::Detail, Sweep::Surfels, Sweep::Crowding,
                                    Sweep::Spread};

struct SweepInfo {
  const char* name;       ///< in tables and file names
  const char* parameter;  ///< what `value` is
  const char* title;
};
[[nodiscard]] const SweepInfo& infoOf(Sweep sweep);

/// What changes the result.
struct ScalingOptions {
  std::vector<Sweep> sweeps{std::begin(kSweeps), std::end(kSweeps)};  ///< that are measured
  std::size_t most = 1'000'000;                                       ///< primitives of the largest list
  /// That the densities of the sampling are chosen for. The paper's size is among them.
  /// The shipped list ends at 80 million, where its base has as many samples as a primitive may have.
  std::vector<std::size_t> surfels{10'000,     100'000,    kPaperSurfels, 1'000'000,
                                   10'000'000, 80'000'000, 100'000'000};
  std::size_t crowd = 100'000;            ///< primitives on the cap
  std::size_t spreadPrimitives = 10'000;  ///< of the list with many radii
  MeasureOptions measure = {};
  std::uint64_t seed = 1;  ///< of all strokes
  bool smoke = false;
};
/// Seconds instead of minutes: lists up to 10,000 primitives, 100,000 surfels, small pictures.
[[nodiscard]] ScalingOptions smokeSize(ScalingOptions options);
/// The options as canonical text; its hash is in every row.
[[nodiscard]] std::string describe(const ScalingOptions& options);

struct ScalingRow {
  Sweep sweep = Sweep::Extent;
  std::string source;  ///< the log, of the sweep of surfels; else empty
  double value = 0;    ///< that was asked for: primitives, surfels, radius of the cap, spread
  Measured measured;
};

struct ScalingResults {
  std::vector<ScalingRow> rows;
  std::vector<std::pair<std::string, std::string>> inputs;  ///< files and their hashes
  std::vector<std::string> notes;                           ///< what was left out, and why
  std::string simd;                                         ///< instruction set of the kernels
  int threads = 0;                                          ///< that undo, rebuild and pictures used
  std::uint32_t width = 0, height = 0;                      ///< of the pictures, pixels
};

/// The shipped list of the paper's size.
[[nodiscard]] std::vector<std::filesystem::path> defaultScalingLogs();

/// Told of progress: what is at work, done and in all.
using ScalingProgress = std::function<void(const std::string& what, std::size_t done, std::size_t all)>;

/// Replays, undoes, rebuilds, casts, draws. The logs (or stamp lists) are what the sweep of surfels replays.
/// Sizes for which memory or the sampling's limits do not suffice are left out, with a note. Throws
/// InputError for a log that cannot be read, InternalError when a state hash differs.
[[nodiscard]] ScalingResults measureScaling(const std::vector<std::filesystem::path>& logs,
                                            const ScalingOptions& options, const Execution& execution = {},
                                            const ScalingProgress& progress = {});

/// Writes results.csv, results.json, manifest.json, figures, pictures and report.html into the folder, which
/// is made when it is not there. Returns the files' names. Throws InputError when something cannot be written
/// or drawn.
std::vector<std::string> writeScaling(const ScalingResults& results, const ScalingOptions& options,
                                      const std::filesystem::path& out);

}  // namespace restroke::experiments
