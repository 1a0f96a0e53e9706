#pragma once
// Experiment: voxels, one family of dexels, or three (SPEC D11; figure 1 of Milojevic et al., Free Form Shape
// Modelling by Hand Movement in Virtual Environment, 2016)?
//
// Hypothesis: at equal resolution three families of dexels show a surface everywhere and exactly where it is.
//   One family leaves gaps where the surface runs along its lines, and voxels are off by a part of a cell.
// Metric: for each solid, on the same grid of n points along the longest side of its bounds:
//   bytes        from the containers' capacity; of dexels with the operations at each end and without
//   wrong        random points on the wrong side, by those inside: a part of the solid's volume. A voxel
//                answers for its cube, one family by its nearest line, three by the majority of the nearest
//   coverage     distance from samples of the surface to the nearest element: the middle of a voxel's face,
//                the end of a dexel
//   accuracy     distance from the elements to the surface
//   The last two as mean, 99th percentile and maximum, in model units and in cells.
// Expected shape: bytes of voxels in proportion to n^3, of dexels to n^2: with a bit a voxel and 36 bytes a
//   line one family takes less from n = 288 on, three from n = 864 on (160 and 480 without operations), if
//   most lines have one span or none. What is wrong falls as 1 / n for all of them. Ends are on the surface
//   but for the rounding of float32. Faces of voxels are off by at most half a cell, and in the mean by a
//   sixth where the surface has all directions alike: 0 to 1/2 along the face's axis, each as likely, times
//   the cosine c between axis and normal, for which there are faces in proportion to c. Coverage by three
//   families at most about a cell, whatever n; by one family it grows with n when counted in cells: a slope
//   of s along the lines leaves sqrt(1 + s^2) cells between ends, and a ball has every slope.
//
// The paper's figure 1 shows a disc as voxels, as dexels along one axis, and with dexels along two; here it
// is a slice of a ball's model.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "experiments/dexel/measure.h"
#include "points/images/png.h"

namespace restroke::experiments {

struct RepresentationInfo {
  const char* name;   ///< in tables
  const char* title;  ///< for people
};
[[nodiscard]] const RepresentationInfo& infoOf(Representation representation);

inline constexpr int kLeastDexelResolution = 8, kMostDexelResolution = 1024;

/// What changes the result.
struct DexelOptions {
  /// Grid points along the longest side of the bounds, ascending.
  std::vector<int> resolutions{16, 32, 64, 128, 256};
  std::size_t points = 1'000'000;  ///< random ones, > 0
  /// Surface samples for each square of the finest cell.
  double samplesPerCell = 1;
  int pictureResolution = 64;       ///< of the pictures of elements; the next coarser one that is measured
  std::uint32_t pictureSize = 480;  ///< pixels along each side; 0: no pictures
  std::uint64_t seed = 1;           ///< of the random points
  bool smoke = false;
};
/// Seconds instead of minutes: 8, 16 and 32, fewer points, small pictures.
[[nodiscard]] DexelOptions smokeSize(DexelOptions options);
/// The options as canonical text; its hash is in every row.
[[nodiscard]] std::string describe(const DexelOptions& options);

/// A solid that is measured.
struct DexelSource {
  std::string name;
  std::vector<implicit::Primitive> primitives;
};
/// The unit ball, whose surface is known without any list.
[[nodiscard]] DexelSource analyticBall();
/// What a log or stamp list ends with. Throws InputError when it cannot be read.
[[nodiscard]] DexelSource sourceOf(const std::filesystem::path& log);
/// Shipped logs; one of them for smoke.
[[nodiscard]] std::vector<std::filesystem::path> defaultDexelLogs(bool smoke);

struct DexelRow {
  std::string source;
  std::size_t primitives = 0, samples = 0;  ///< of the list; of its surface
  int resolution = 0;
  DexelMeasured measured;
};

struct DexelPicture {
  std::string source;
  Representation representation = Representation::Voxels;
  int resolution = 0;
  points::DisplayImage image;
};

struct DexelResults {
  std::vector<DexelRow> rows;  ///< by source, then resolution, then representation
  std::vector<DexelPicture> pictures;
  std::vector<std::pair<std::string, std::string>> inputs;  ///< files and their hashes
};

/// Told of progress: what is at work, done and in all.
using DexelProgress = std::function<void(const std::string& what, std::size_t done, std::size_t all)>;

/// Measures the ball and what the logs end with. The same figures for any number of threads. Throws
/// InputError for a log that cannot be read or ends with nothing, for resolutions out of range, in disorder
/// or beyond memory.
[[nodiscard]] DexelResults measureDexels(const std::vector<std::filesystem::path>& logs,
                                         const DexelOptions& options, const Execution& execution = {},
                                         const DexelProgress& progress = {});

/// Writes results.csv, results.json, manifest.json, figure1.csv, figures, pictures and report.html into the
/// folder, which is made when it is not there. Returns the files' names. Throws InputError when something
/// cannot be written or drawn.
std::vector<std::string> writeDexels(const DexelResults& results, const DexelOptions& options,
                                     const std::filesystem::path& out);

}  // namespace restroke::experiments
