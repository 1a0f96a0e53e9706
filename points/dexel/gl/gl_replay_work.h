#pragma once
// What the CPU does for replays on the graphics card: which lines and steps are next, what the card cannot
// find out itself, and what becomes of its answers. Internal to points/dexel/gl; no OpenGL here.

#include <tbb/enumerable_thread_specific.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "points/dexel/gl/gl_replay_tiles.h"
#include "points/dexel/refine/line_replay.h"
#include "points/dexel/refine/steps_on_line.h"

namespace restroke::points {

// The shaders' constants (gl_line_replay_shaders.h).
inline constexpr std::uint32_t kReplayTabled = 0x80000000u, kReplayAsk = 0x40000000u,
                               kReplayOverflow = 0xffffffffu;

using ReplayWords = std::vector<std::uint32_t>;
using FourWords = std::array<std::uint32_t, 4>;

/// Some lines that are worked on together, tile by tile.
struct ReplayPart {
  struct Tile {
    std::size_t tile;                  ///< of the rectangle's
    std::uint32_t firstLine, endLine;  ///< of the part's
    std::size_t next = 0;              ///< of the tile's list
  };
  std::vector<Tile> tiles;
  std::vector<FourWords> lines;  ///< column, row, from, to
  ReplayWords lineTiles;         ///< of each line, which of `tiles`
};

/// Some steps of each tile.
struct ReplayRound {
  ReplayWords items, table;
  std::vector<FourWords> tiles;  ///< of each of the part's: items from, to; first line
};

/// How far a line is.
struct ReplayLineState {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  std::uint32_t pieces = 1;    ///< kReplayOverflow: more than there is room for
  std::uint32_t open = 0;      ///< its first undecided piece, or kNone
  std::uint32_t item = kNone;  ///< where it stopped, or kNone
  std::uint32_t stretch = 0;
  [[nodiscard]] bool isDecided() const { return open == kNone; }
  [[nodiscard]] bool isStopped() const { return item != kNone; }
};

class ReplayWork {
 public:
  /// None of it decides a result.
  struct Limits {
    std::size_t solids;  ///< of each tile that are no balls, in a round
    std::size_t words;   ///< that the card sees of a buffer
  };
  /// What is to be done; outlives the work. Of a size are the lines and what they become.
  struct Task {
    const LinesInZone& lines;
    const ReplayBasis& basis;
    const Execution& execution;
    Dexels& out;
  };
  /// Lines are asked in turns; the first is 1, of all lines in the zone.
  ReplayWork(const Task& task, const Limits& limits);

  /// Goes on with the lines and steps of a rectangle. O(as StepsOfTiles::makeLists).
  void take(StepsOfTiles&& here, std::span<const HistoryStep> steps);
  /// Of the rectangle, by the numbers that items have.
  [[nodiscard]] std::span<const HistoryStep> steps() const { return steps_; }
  /// Is the step one whose stretches come in a table?
  [[nodiscard]] bool isTabled(std::uint32_t step) const {
    return !steps_[step].ball || steps_[step].operation == DexelOperation::Intersection;
  }

  /// At most so many of the rectangle's lines whose turn it is, from a tile on, which becomes the one to go
  /// on with. They are not asked again, unless askAgain says so.
  [[nodiscard]] ReplayPart nextPart(std::size_t& tile, std::uint8_t turn, std::size_t most);
  void askAgain(const ReplayPart& part, std::size_t line, std::uint8_t turn) {
    asked_[lineOf(part, line)] = turn;
  }

  /// Of each line where its first pieces are and how many; pieces.
  [[nodiscard]] ReplayWords knownOf(const ReplayPart& part) const;
  /// Of each line where the ends are that it had before any step, and how many; depths and normals. None of
  /// lines with a long start.
  [[nodiscard]] ReplayWords startOf(const ReplayPart& part) const;
  [[nodiscard]] bool hasLongStart(const ReplayPart& part, std::size_t line) const;

  /// The next steps of all tiles with undecided lines; nothing when there are none left.
  [[nodiscard]] std::optional<ReplayRound> nextRound(ReplayPart& part,
                                                     std::span<const ReplayLineState> states);

  /// Writes what the card found: offsets of lines in `ends`, whose operations are numbers of steps.
  void writeLines(const ReplayPart& part, const ReplayWords& offsets, LineEnds& ends);
  /// Replays lines that the card was not given, or could not hold.
  void replayOnCpu(const ReplayPart& part, std::span<const std::size_t> lines);

 private:
  // A step of a tile that the card does not know: of each line, and behind the last one, where its stretches
  // begin in the table; stretches.
  struct Job {
    const ReplayPart::Tile* tile;
    std::uint32_t step;
    ReplayWords table;
  };
  // What cells know of the lines of a tile.
  struct KnownOfTile {
    ReplayWords pieces;
    std::vector<std::array<std::uint32_t, 2>> places;  // of each line: from which word, how many pieces
  };
  [[nodiscard]] KnownOfTile knownOf(const ReplayPart& part, const ReplayPart::Tile& tile) const;
  void makeTable(const ReplayPart& part, std::span<const ReplayLineState> states, Job& job);
  [[nodiscard]] ReplayRound roundOf(ReplayPart& part, std::span<const std::size_t> stops,
                                    std::span<const Job> jobs) const;
  void complete(const ReplayPart& part, std::size_t line, std::span<SpanEnd> ends);
  [[nodiscard]] std::size_t lineOf(const ReplayPart& part, std::size_t line) const;
  [[nodiscard]] CutLine cutLine(const ReplayPart& part, std::size_t line) const;

  const LinesInZone& lines_;
  const ReplayBasis& basis_;
  const Execution& execution_;
  Dexels& out_;
  Limits limits_;
  std::vector<std::uint8_t> asked_;  // of each line whose turn it is; 0: it is done, or not in the zone

  std::optional<StepsOfTiles> here_;
  std::vector<HistoryStep> steps_;
  std::optional<tbb::enumerable_thread_specific<StepsOnLine>> onLine_;
};

}  // namespace restroke::points
