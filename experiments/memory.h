#pragma once
// Experiment: what it costs in memory to undo (SPEC S12, X3).
//
// Hypothesis: a history of strokes as drawn is smaller than any history of shapes once there are more than a
// few strokes, and the
//   gap widens as the shape grows; packed strokes are smaller than the paper's own at every step of its
//   Table 2.
// Metric: bytes held for the history after each step (DESIGN invariant 11), for each back end on the same
// log. Expected shape: strokes grow with what is drawn, by a constant for each dab; snapshots grow with the
// square of the number
//   of steps; surfel deltas grow with the area that is touched, at some ten to a hundred times the strokes'
//   bytes.
//
// The paper's Table 2 (all eight steps; stamps decoded from the bytes, see experiments/paper_table.h):
//
//   step   stamps   stroke-based   snapshot-based        stroke of n stamps:      304 + 12 n
//      1      454          5,752           21,792        snapshot of n so far:    48 n, accumulated
//      2        1          6,068           43,632
//      3        1          6,384           65,520
//      4        1          6,700           87,456
//      5        1          7,016          109,440
//      6        1          7,332          131,472
//      7       96          8,788          158,112
//      8        1          9,104          184,800

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "experiments/backends/history_backend.h"
#include "points/images/png.h"

namespace restroke::experiments {

/// What changes the result.
struct MemoryOptions {
  /// Samples per square model unit; 0 takes each log's own.
  float density = 0;
  /// Undo and redo steps that every back end walks at random after the last step of a log, each checked by
  /// its hash.
  int walkSteps = 24;
  /// Of that walk.
  std::uint64_t seed = 1;
  /// Pictures of the shape per log, evenly spread over its steps, the last one included; 0 for none.
  int pictures = 4;
  std::uint32_t pictureSize = 480;  ///< pixels, both sides
};
/// Seconds instead of a minute: few surfels, small pictures.
[[nodiscard]] MemoryOptions smokeSize(MemoryOptions options);
/// The options as canonical text; its hash is in every row.
[[nodiscard]] std::string describe(const MemoryOptions& options);

/// Bytes of one back end after one step.
struct MemoryRow {
  std::string backend;  ///< name of the back end; "-paper" is added where the bytes are counted by the
                        ///< paper's arithmetic, and
                        ///< "-table2" where they stand in the paper's table
  std::string title;
  Abilities abilities;
  bool measured = true;        ///< false: the paper's count, nothing that is held
  std::size_t bytes = 0;       ///< held for the history
  std::size_t stateBytes = 0;  ///< held for the current shape besides
};

struct MemoryStep {
  std::size_t step = 0;        ///< 0 is the start
  std::string command;         ///< start, stroke, fixed, undo, redo
  std::size_t stamps = 0;      ///< primitives that the step added
  std::size_t primitives = 0;  ///< in the list, base included
  std::size_t surfels = 0;
  std::vector<MemoryRow> rows;  ///< the same back ends, in the same order, at every step of a log
};

struct MemoryPicture {
  std::size_t step = 0;
  points::DisplayImage image;
};

/// One log, measured.
struct MemoryLog {
  std::string name;  ///< file name without folder and ending
  std::filesystem::path file;
  std::string hash;  ///< of the file
  float density = 0;
  std::size_t strokes = 0;   ///< strokes and fixed groups
  std::size_t stamps = 0;    ///< that they put down, all together
  bool paperTable2 = false;  ///< its strokes have the stamps of the paper's Table 2
  std::size_t walked = 0;    ///< undo and redo steps that each back end was checked on
  std::vector<MemoryStep> steps;
  std::vector<MemoryPicture> pictures;
};

/// Told of progress: steps done, steps in all.
using StepProgress = std::function<void(std::size_t done, std::size_t all)>;

/// Replays a log (or a stamp list) into every back end. Throws InputError for a log that is not one,
/// InternalError when a back end's state is not the state that the log says.
[[nodiscard]] MemoryLog measureMemory(const std::filesystem::path& log, const MemoryOptions& options,
                                      const Execution& execution = {}, const StepProgress& progress = {});

/// Numbers names that two logs share: head, head-2, head-3.
void makeNamesUnique(std::vector<MemoryLog>& logs);

/// The table as text: steps down, back ends across, then what each of them can do. Long logs are thinned out.
[[nodiscard]] std::string memoryTable(const MemoryLog& log);

/// Writes results.csv, results.json, manifest.json, step pictures, the figures and report.html into the
/// folder, which is made when it is not there. Returns the files' names. Throws InputError when something
/// cannot be written or drawn.
std::vector<std::string> writeMemory(const std::vector<MemoryLog>& logs, const MemoryOptions& options,
                                     const std::filesystem::path& out);

}  // namespace restroke::experiments
