#pragma once
// Space clusters (SPEC S4): which primitives touch a place. Hash grids, one for each order of magnitude of
// size.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "implicit/arena.h"
#include "implicit/crowded_cell.h"
#include "implicit/geometry/box.h"

namespace restroke::implicit {

/// How space is cut. Never changes a result, only speed and memory.
struct ClusterOptions {
  /// Cell size of the grid for ordinary brushes in model units, finite and > 0. For brushes of 1 to 10 % of
  /// the model's half size, 0.1 to 0.4 of it is a flat optimum; smaller cells list every primitive many times
  /// (tests/bench measures it).
  float cell = 0.2f;
};

/// A cell's place in its grid.
struct Cell {
  std::int32_t x = 0, y = 0, z = 0;
  bool operator==(const Cell&) const = default;
};

/// One hash grid: from cells to the lists of the primitives (slot numbers) that touch them, in list order.
/// Open addressing with linear probing; an emptied cell keeps its place, since a brush comes back to where it
/// was.
class ClusterGrid {
 public:
  /// Lists of slots, of all grids.
  using Lists = Arena<std::uint32_t>;

  ClusterGrid(float cell, Lists& lists) : cell_(cell), lists_(&lists) {}

  [[nodiscard]] float cell() const { return cell_; }
  [[nodiscard]] Cell cellAt(DVec3 p) const {
    const double cell = static_cast<double>(cell_);
    return {indexAlong(p.x, cell), indexAlong(p.y, cell), indexAlong(p.z, cell)};
  }
  /// The list of a cell; empty when nothing touches it. O(1).
  [[nodiscard]] std::span<const std::uint32_t> at(Cell c) const {
    if (entries_.empty()) return {};
    return listOf(entries_[find(c)]);
  }
  /// Calls f(list) for the list of every cell from `low` to `high`: by looking each cell up, or by going
  /// through the cells that were ever used, whichever are fewer. Where `decisive` is given, crowded cells
  /// answer with the lists of their leaves that meet it (CrowdedCell).
  template <class F>
  void forListsBetween(Cell low, Cell high, const F& f, const Box* decisive = nullptr) const {
    const auto along = [](std::int32_t a, std::int32_t b) { return static_cast<double>(b) - a + 1; };
    if (along(low.x, high.x) * along(low.y, high.y) * along(low.z, high.z) >
        static_cast<double>(entries_.size())) {
      for (const Entry& e : entries_) {
        const Cell& c = e.cell;
        if (low.x <= c.x && c.x <= high.x && low.y <= c.y && c.y <= high.y && low.z <= c.z && c.z <= high.z)
          report(e, decisive, f);
      }
      return;
    }
    for (std::int32_t z = low.z; z <= high.z; ++z)
      for (std::int32_t y = low.y; y <= high.y; ++y)
        for (std::int32_t x = low.x; x <= high.x; ++x) report(entries_[find({x, y, z})], decisive, f);
  }
  /// Cells that were ever used: going through them all costs about as much as looking up so many.
  [[nodiscard]] std::size_t usedCells() const { return usedEntries_; }
  /// Whether any cell is crowded (CrowdedCell).
  [[nodiscard]] bool crowded() const { return crowds_.size() > freeCrowds_.size(); }
  /// Number of primitives in this grid.
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Box that holds all that was ever inserted since the grid was last empty.
  [[nodiscard]] const Box& hull() const { return hull_; }

  void insert(std::uint32_t slot, const Box& box, const ClusterMembers& members);
  void remove(std::uint32_t slot, const Box& box, const ClusterMembers& members);
  /// Without the lists.
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Entry {
    Cell cell;
    std::uint32_t count = 0;
    Lists::Handle list = Lists::kNone;  // none: the entry was never used
    std::uint32_t crowd = kNoCrowd;     // in crowds_
  };
  static constexpr std::uint32_t kNoCrowd = ~0u;
  // Clamped, which keeps the order of cells, and with it every list complete, even where an index would not
  // fit.
  [[nodiscard]] static std::int32_t indexAlong(double x, double cell) {
    const double i = x / cell;
    if (!(i >= -2e9)) return -2'000'000'000;  // NaN too: nothing holds it, wherever it is looked for
    if (i > 2e9) return 2'000'000'000;
    const auto whole = static_cast<std::int32_t>(i);
    return whole - (i < whole);  // floor, without a call to the library
  }
  // Three products that do not wait for each other.
  [[nodiscard]] static std::size_t hashOf(Cell c) {
    const std::uint64_t h = static_cast<std::uint32_t>(c.x) * 0x9E3779B97F4A7C15ull ^
                            static_cast<std::uint32_t>(c.y) * 0xD6E8FEB86659FD93ull ^
                            static_cast<std::uint32_t>(c.z) * 0xA0761D6478BD642Full;
    return static_cast<std::size_t>(h ^ (h >> 32));
  }
  // Where the cell's entry is, or would be.
  [[nodiscard]] std::size_t find(Cell c) const {
    const std::size_t mask = entries_.size() - 1;
    std::size_t i = hashOf(c) & mask;
    while (entries_[i].list != Lists::kNone && entries_[i].cell != c) i = (i + 1) & mask;
    return i;
  }
  [[nodiscard]] std::span<const std::uint32_t> listOf(const Entry& e) const {
    return e.count == 0 ? std::span<const std::uint32_t>()
                        : std::span<const std::uint32_t>(lists_->at(e.list), e.count);
  }
  Entry& entryFor(Cell c);
  void grow();
  void putIn(Entry& e, std::uint32_t slot, const ClusterMembers& members);
  void takeFrom(Entry& e, std::uint32_t slot, const ClusterMembers& members);
  void makeCrowd(Entry& e, const ClusterMembers& members);
  template <class F>
  void report(const Entry& e, const Box* decisive, const F& f) const {
    if (e.count == 0) return;
    if (decisive && e.crowd != kNoCrowd)
      crowds_[e.crowd]->forListsIn(*decisive, f);
    else
      f(listOf(e));
  }

  float cell_;
  Lists* lists_;
  std::size_t size_ = 0;
  std::size_t usedEntries_ = 0;
  Box hull_;
  std::vector<Entry> entries_;  // a power of two of them
  std::vector<std::unique_ptr<CrowdedCell>> crowds_;
  std::vector<std::uint32_t> freeCrowds_;
};

/// The hierarchy: a primitive is listed in the finest grid in which its box spans at most kMaxSpan cell
/// sizes, so that a base as large as the model and brushes a hundredth of it are both cheap to list, whatever
/// their ratio. Primitives that are small even beside the ordinary grid's cells go to finer grids, in which
/// they span at most one, so that they do not crowd. A query asks every grid that is in use: two in practice.
class Clusters {
 public:
  static constexpr float kMaxSpan = 8;
  static constexpr int kFinerGrids = 4;  ///< than the ordinary one
  static constexpr int kGrids = 16;
  static constexpr float kGridRatio = 8;  ///< of cell sizes, from one grid to the next

  /// Throws InputError when the cell size is not finite or not positive.
  explicit Clusters(ClusterOptions options);

  void insert(std::uint32_t slot, const Box& box, const ClusterMembers& members) {
    gridFor(box).insert(slot, box, members);
  }
  void remove(std::uint32_t slot, const Box& box, const ClusterMembers& members) {
    gridFor(box).remove(slot, box, members);
  }

  /// All grids, finest first; most are empty.
  [[nodiscard]] const std::vector<ClusterGrid>& grids() const { return grids_; }
  /// Index of the finest grid that is not empty; of the ordinary one when all are.
  [[nodiscard]] std::size_t finestInUse() const;

  /// Which primitives a query is about: all that touch the box, or, for the whole list, those that still
  /// decide the side of a point in it or have a visible sample there.
  enum class Wanted { All, Decisive };

  /// Calls f(list) for the list of every cell that meets the box. A primitive that touches several cells
  /// comes several times.
  template <class F>
  void forListsIn(const Box& box, Wanted wanted, const F& f) const {
    for (const ClusterGrid& grid : grids_) {
      if (grid.size() == 0) continue;
      const Box& hull = grid.hull();
      if (box.min.x > hull.max.x || box.max.x < hull.min.x || box.min.y > hull.max.y ||
          box.max.y < hull.min.y || box.min.z > hull.max.z || box.max.z < hull.min.z)
        continue;
      const auto low = [](float a, float b) { return static_cast<double>(a > b ? a : b); };
      const auto high = [](float a, float b) { return static_cast<double>(a < b ? a : b); };
      const Cell lo =
          grid.cellAt({low(box.min.x, hull.min.x), low(box.min.y, hull.min.y), low(box.min.z, hull.min.z)});
      const Cell hi = grid.cellAt(
          {high(box.max.x, hull.max.x), high(box.max.y, hull.max.y), high(box.max.z, hull.max.z)});
      grid.forListsBetween(lo, hi, f, wanted == Wanted::Decisive ? &box : nullptr);
    }
  }

  [[nodiscard]] bool crowded() const;
  [[nodiscard]] std::size_t bytes() const;

 private:
  [[nodiscard]] ClusterGrid& gridFor(const Box& box);
  std::unique_ptr<ClusterGrid::Lists> lists_;  // where it stays when the clusters are moved
  std::vector<ClusterGrid> grids_;
};

}  // namespace restroke::implicit
