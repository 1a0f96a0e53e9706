#pragma once
// The primitives near a place, laid out for the SIMD kernels.

#include <limits>
#include <vector>

#include "implicit/primitive_list.h"
#include "implicit/simd/ball_kernels.h"

namespace restroke::implicit {

/// The balls of a list that may meet a region, in list order. Keep one and use it again: its arrays keep
/// their memory.
class NearBalls {
 public:
  /// Where the primitive stands whose samples are asked about.
  struct Place {
    PrimitiveList::Label label = std::numeric_limits<PrimitiveList::Label>::max();  ///< smaller: earlier
    std::uint32_t slot = ~0u;  ///< its own, which is not collected
  };
  /// Collects the primitives of the prefix whose ball may meet the sphere, split into earlier and later ones;
  /// without a place all count as earlier. Conservatively: none is left out that meets it and, of the whole
  /// list, decides a side or has a visible sample in it (CrowdedCell).
  void gather(const PrimitiveList& list, const DropBall& region, PrimitiveList::Label labelEnd,
              const Place& own);
  void gather(const PrimitiveList& list, const DropBall& region, PrimitiveList::Label labelEnd) {
    gather(list, region, labelEnd, {});
  }

  /// The same, but where very many are near, what was gathered for one primitive's samples serves the next
  /// one's too, if these lie in the same place: ask in spatial order. It collects the own one as well, which
  /// arrays() leaves out, and more than meet the sphere. Call forget() when the list has changed, or for
  /// another prefix.
  void gatherShared(const PrimitiveList& list, const DropBall& region, PrimitiveList::Label labelEnd,
                    const Place& own);
  void forget() { shared_ = false; }

  [[nodiscard]] BallArrays arrays() const;
  [[nodiscard]] std::size_t size() const { return found_.size(); }
  /// Bytes held, from the containers' real capacity.
  [[nodiscard]] std::size_t bytes() const;
  /// Slot of the i-th ball.
  [[nodiscard]] std::uint32_t slot(std::size_t i) const { return found_[i].slot; }

 private:
  struct Found {
    PrimitiveList::Label label;
    std::uint32_t slot;
  };
  [[nodiscard]] bool isNew(std::uint32_t slot);
  void growSeen();
  void collect(const PrimitiveList& list, const DropBall& region, PrimitiveList::Label labelEnd,
               std::uint32_t except);
  void fill(const PrimitiveList& list);
  void splitAt(const Place& own);

  std::vector<std::uint32_t> meeting_;  // of one cell
  std::vector<Found> found_;
  // A hash set of the slots in `found_`, since a primitive is listed in several cells: round << 32 | slot, of
  // other rounds where there is none.
  std::vector<std::uint64_t> seen_ = std::vector<std::uint64_t>(256, 0);
  std::uint64_t round_ = 0;
  std::vector<float> floats_;  // six arrays, one after the other
  std::vector<const GriddedVolume*> volumes_;
  bool anyVolume_ = false;
  std::vector<std::uint8_t> positive_;
  std::size_t stride_ = 0;
  std::uint32_t earlier_ = 0, later_ = 0;
  bool shared_ = false;      // gatherShared may use what is here
  DropBall sharedRegion_{};  // for what lies in this sphere
};

/// What drops the older samples inside a primitive, with the reach of all its tests.
[[nodiscard]] DropBall dropBall(const Shape& shape);

}  // namespace restroke::implicit
