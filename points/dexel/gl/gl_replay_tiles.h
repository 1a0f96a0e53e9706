#pragma once
// Which steps may change which lines, tile by tile. Internal to points/dexel/gl; no OpenGL here.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "points/dexel/refine/placed_steps.h"

namespace restroke::points {

/// Lines of a tile, along its columns and its rows.
inline constexpr int kReplayTile = 8;

/// The tiles that hold some lines: their columns and rows.
[[nodiscard]] LineRectangle tilesOf(const LineRectangle& lines);

/// The steps of a rectangle of tiles, numbered anew in their order, and those of each tile.
class StepsOfTiles {
 public:
  /// Takes the steps that meet the tiles. O(steps).
  StepsOfTiles(std::span<const PlacedStep> placed, const LineRectangle& tiles);

  [[nodiscard]] const LineRectangle& tiles() const { return tiles_; }
  [[nodiscard]] std::size_t tileCount() const;
  [[nodiscard]] std::span<const PlacedStep> steps() const { return steps_; }
  /// Of steps and tiles that meet.
  [[nodiscard]] std::size_t pairCount() const { return pairCount_; }

  /// To be called before `of`, inside an arena. O(rows of tiles * steps + pairs).
  void makeLists();
  /// Numbers of the tile's steps, the last one first. Tiles count by rows.
  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t tile) const;

 private:
  struct Row {
    std::vector<std::size_t> offsets;  // of each tile's list, and the end of the last one
    std::vector<std::uint32_t> numbers;
  };
  [[nodiscard]] Row rowOf(int row) const;
  [[nodiscard]] std::size_t width() const {
    return static_cast<std::size_t>(tiles_.endColumn - tiles_.firstColumn);
  }

  LineRectangle tiles_;
  std::vector<PlacedStep> steps_;
  std::size_t pairCount_ = 0;
  std::vector<Row> rows_;
};

}  // namespace restroke::points
