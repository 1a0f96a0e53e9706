#pragma once
// A solid as spans on three families of parallel lines (SPEC D2-D4, R1).

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "implicit/execution.h"
#include "implicit/primitive_list.h"
#include "points/dexel/dexel_grid.h"
#include "points/dexel/dexels.h"

namespace restroke::points {

/// Three families of lines through one grid. A depth is the coordinate along the family's axis, in float32:
/// the tri-dexel of the same operations is the same bits on every machine, and whatever the number of
/// threads.
class TriDexel {
 public:
  /// An empty solid.
  explicit TriDexel(const DexelGrid& grid, Dexels::Options options = {.operations = true});
  TriDexel() : TriDexel(DexelGrid()) {}

  [[nodiscard]] const DexelGrid& grid() const { return grid_; }
  [[nodiscard]] const Dexels& family(int axis) const { return families_[static_cast<std::size_t>(axis)]; }
  [[nodiscard]] Dexels& family(int axis) { return families_[static_cast<std::size_t>(axis)]; }

  /// Adds or carves primitives one after the other; the first is operation `first`, the others follow. Where
  /// a line meets a primitive is computed in double and rounded once. A positive primitive beyond the grid is
  /// cut off at its outermost lines: growTo first. O(lines met), whatever else there is.
  void apply(std::span<const implicit::Primitive> primitives, OperationId first,
             const Execution& execution = {});
  /// Keeps what is within a shape. O(all lines).
  void intersect(const implicit::Shape& shape, OperationId id, const Execution& execution = {});
  /// Unites with another solid on the same lines, subtracts it, or keeps what both have. Throws InternalError
  /// when the grids differ.
  void apply(const TriDexel& other, DexelOperation operation, OperationId id,
             const Execution& execution = {});

  /// Keeps histories of all lines from now on (Dexels::startHistory). O(lines).
  void startHistory() {
    for (Dexels& dexels : families_) dexels.startHistory();
  }
  [[nodiscard]] bool keepsHistory() const { return families_[0].keepsHistory(); }
  /// What the histories hold: operations noted on all lines, and bytes, which bytes() counts too. 0 where
  /// none are kept. O(rows).
  struct HistorySize {
    std::size_t entries = 0, bytes = 0;
  };
  [[nodiscard]] HistorySize historySize() const;

  /// Adds empty lines on all sides until `bounds` is covered. What is there stays. Throws InputError as
  /// DexelGrid::grownTo, and then nothing has changed. O(lines) if there are any.
  void growTo(const Box& bounds);

  /// Is the grid point inside, as most of its three lines say?
  [[nodiscard]] bool isInside(const GridCounts& point) const;
  /// Mean over the families of the length in the solid times the square of the cell: cubic model units.
  [[nodiscard]] double volume() const;
  /// The same of one family.
  [[nodiscard]] double volumeOf(int axis) const;
  /// Box of all ends of all families; empty for an empty solid. O(lines).
  [[nodiscard]] Box bounds() const;
  [[nodiscard]] std::size_t endCount() const;
  [[nodiscard]] std::size_t bytes() const;
  /// Of the lines that have ends, by how far they are from the grid's anchor, and of all their ends: a model
  /// whose grid has grown, and is empty there, has the hash that it had. O(lines).
  [[nodiscard]] std::uint64_t stateHash() const;
  /// Same lines, same ends, bit for bit; histories are not compared.
  bool operator==(const TriDexel& other) const {
    return grid_ == other.grid_ && families_ == other.families_;
  }

 private:
  void findCoordinates();

  DexelGrid grid_;
  std::array<Dexels, 3> families_;
  std::array<std::vector<float>, 3> coordinates_;  // of the grid, and some more for kernels to read
};

struct ListDexelOptions {
  implicit::Prefix prefix = {};
  Dexels::Options lines = {};
};

/// The tri-dexel of (a prefix of) a list, analytically: from the exact intervals of each primitive on each
/// line, in list order (SPEC S2). The operation of a primitive is its position.
[[nodiscard]] TriDexel triDexelOf(const implicit::PrimitiveList& list, const DexelGrid& grid,
                                  const ListDexelOptions& options = {}, const Execution& execution = {});

}  // namespace restroke::points
