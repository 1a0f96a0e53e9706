#pragma once
// Experiment: how well does each method put a stroke back where it belongs, when what it was drawn on has
// changed (SPEC S7, S10, X2)?
//
// Hypothesis: no method is best for every change. `mapped` is exact to rounding where the map is known and
// affine;
//   `aligned` follows motions of shapes that tell how they were moved, without being told the map, and says
//   so where a symmetry hides the motion; `surface` follows deformations that keep primitives; plain casting
//   (`exact`, `embree`, `depth`) is the best for changes that are local and small, since it never leaves the
//   surface; what is left in place (`fixed`) misses by the change itself.
// Metric: with known truth, the RMS distance between where the method puts the stroke's points and where the
// map
//   takes them, divided by the length of the stroke there; points that are lost; distance from the changed
//   surface. Without truth (a stroke cancelled, two strokes reordered, another base) distance from the
//   surface, drift on the screen, stretch, points lost.
// Expected shape: `fixed` rises in proportion to every change; casting the same where the change moves the
// surface
//   sideways, and much less where it moves along the line of sight; `aligned` is flat for motions at an error
//   that the sampling sets, whatever their size; `mapped` is flat at the rounding of float32.
//
// Truth. Every stroke is drawn on the bare base, with `exact`, so that its truth is known: the image of each
// of its points under the map. (In a log later strokes lie on earlier ones; the changes without truth replay
// whole logs.)

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/retarget/changes.h"
#include "implicit/execution.h"
#include "points/images/png.h"
#include "retarget/method.h"

namespace restroke::experiments {

/// What changes the result.
struct RetargetOptions {
  /// Strokes drawn on each base, evenly spread over all of those that land on it; 0 takes all.
  std::size_t strokes = 16;
  /// Surfels of each base, about; a changed base has a third more, so that no sample is where it was.
  std::size_t samples = 15'000;
  std::uint32_t alignmentPoints = 2000;  ///< retarget::AlignmentOptions::points
  /// Strokes of each base that the change `patch`, which is another one for each stroke, is tried on.
  std::size_t patchStrokes = 3;
  /// Length of the edges of fine meshes, as a part of the base's size, and how many triangles they have at
  /// most.
  double edge = 0.025;
  std::size_t triangles = 20'000;
  /// Strokes of each log that the changes without truth are tried on, from its beginning; 0 takes all.
  std::size_t logStrokes = 10;
  std::uint64_t seed = 1;           ///< of directions, axes and what is aligned with what
  std::uint32_t pictureSize = 300;  ///< pixels, both sides
  bool openGl = true;  ///< try the method `depth`; left out, with a note, where OpenGL cannot be had
  bool smoke = false;  ///< few strengths and bases
};
/// Seconds instead of minutes: three bases, one or two strengths, few strokes and surfels.
[[nodiscard]] RetargetOptions smokeSize(RetargetOptions options);
/// The options as canonical text; its hash is in every row.
[[nodiscard]] std::string describe(const RetargetOptions& options);

/// What is tried.
struct RetargetInput {
  /// Logs whose strokes are drawn on their own base, and that the changes without truth are tried on.
  std::vector<std::filesystem::path> logs = {};
  /// Pen strokes (JSON), drawn on every base.
  std::vector<std::filesystem::path> pens = {};
  /// Folder of meshes to draw on besides the bases made here; need not be there.
  std::filesystem::path meshes = {};
};
/// Without logs: the shipped pen strokes, those of the shared data where they are there, and its meshes. The
/// shared data are below RESTROKE_SHARED from the environment, else below what CMake was told (../shared).
[[nodiscard]] RetargetInput defaultInput(std::vector<std::filesystem::path> logs);

/// A base with the strokes that were drawn on it.
struct RetargetSubject {
  std::string name;
  bool tellsMotion = true;  ///< as RetargetBase
  double size = 0;          ///< diagonal of its box, model units
  std::size_t strokes = 0;
  std::size_t beside = 0;  ///< strokes that hardly touch the base, left out
  std::size_t surfels = 0;
};

/// One change of one base. Of `patch` there is one for each stroke.
struct RetargetCase {
  std::size_t subject = 0;
  ChangeKind kind = ChangeKind::Translate;
  double strength = 0;
  bool exactImage = true;
  double chordError = 0;  ///< of the image, as a part of the base's size
  /// What the alignment of the whole shapes said; of `patch`, the patch's.
  std::string verdict;
};

/// One stroke by one method after one change with known truth.
struct RetargetTrial {
  std::size_t changeCase = 0;  ///< among RetargetResults::cases
  std::size_t stroke = 0;      ///< of the subject, counted from 0
  std::string source;          ///< file of the stroke
  retarget::Method method = retarget::Method::Exact;
  bool fellBack = false;   ///< `aligned` found no motion, and cast as `exact` does
  std::size_t places = 0;  ///< of the original that have a truth
  double lost = 0;         ///< part of the places that was not found again
  double length = 0;       ///< of the truth, model units
  double rms = 0;          ///< distance from the truth, divided by `length`; infinite when all are lost
  double worst = 0;        ///< the same for the worst place
  double surface = 0;      ///< greatest distance from the changed surface, as a part of the base's size
  double stretch = 1;      ///< length of what was found by length of the truth of the same places
};

/// One stroke by one method after a change without truth.
struct RetargetEdit {
  std::string log;
  std::string edit;  ///< "cancel 3", "swap 2 and 3", "base ellipsoid"
  std::string kind;  ///< cancel, reorder, base
  std::size_t stroke = 0;
  retarget::Method method = retarget::Method::Exact;
  bool fellBack = false;
  std::size_t places = 0;
  double lost = 0;     ///< part of the places that were not found again
  double surface = 0;  ///< RMS distance from the changed surface, as a part of the base's size
  double drift = 0;    ///< RMS distance on the screen between what the pen drew and where it is seen, pixels
  double stretch = 1;  ///< length by the original's length
};

/// A row of pictures: the original, and what each method made of it.
struct RetargetPictures {
  std::string caption;
  std::string name;  ///< for files
  std::vector<std::pair<std::string, points::DisplayImage>> pictures;
};

struct RetargetResults {
  std::vector<RetargetSubject> subjects;
  std::vector<RetargetCase> cases;
  std::vector<RetargetTrial> trials;
  std::vector<RetargetEdit> edits;
  std::vector<RetargetPictures> pictures;
  std::size_t worseFrom = 0;  ///< from here on, pictures are of cases where `aligned` is worse than `exact`
  std::vector<retarget::Method> methods;                    ///< that were tried
  std::vector<std::pair<std::string, std::string>> inputs;  ///< files and their hashes
  std::vector<std::string> notes;                           ///< what was left out, and why
};

/// Told of progress: what is at work, done and in all.
using RetargetProgress = std::function<void(const std::string& what, std::size_t done, std::size_t all)>;

/// Draws, changes, casts, measures. Throws InputError for a file that cannot be read.
[[nodiscard]] RetargetResults measureRetarget(const RetargetInput& input, const RetargetOptions& options,
                                              const Execution& execution = {},
                                              const RetargetProgress& progress = {});

/// Writes results.csv, results.json, trials.csv, edits.csv, manifest.json, figures, pictures and report.html
/// into the folder, which is made when it is not there. Returns the files' names. Throws InputError when
/// something cannot be written or drawn.
std::vector<std::string> writeRetarget(const RetargetResults& results, const RetargetOptions& options,
                                       const std::filesystem::path& out);

}  // namespace restroke::experiments
