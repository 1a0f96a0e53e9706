#pragma once
// The ordered list of signed primitives: the only truth about a shape (SPEC S2, S4; DESIGN invariant 1).

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "implicit/clusters.h"
#include "implicit/primitive.h"

namespace restroke::implicit {

/// Throws InputError when a sphere is not finite, its radius is not positive, or float32 has too few digits
/// for it: it reaches beyond kMaxCoordinate, or its radius is less than 2^-14 of its greatest coordinate.
/// (Volumes were checked when they were posed.)
void validate(const Primitive& primitive);

/// The first `count` primitives of a list. Every query may be asked of a prefix, which costs nothing to make.
struct Prefix {
  std::size_t count = std::numeric_limits<std::size_t>::max();
};

/// S_0 is empty; S_i is S_(i-1) united with the i-th primitive where that is positive, less it where it is
/// negative.
///
/// Positions count from 0 and change when something is inserted or removed before them; ids do not. Appending
/// costs O(clusters touched); inserting and removing in the middle adds a move of the position table (4 bytes
/// a primitive).
class PrimitiveList {
 public:
  explicit PrimitiveList(ClusterOptions options = {});

  [[nodiscard]] std::size_t size() const { return order_.size(); }
  [[nodiscard]] bool empty() const { return order_.empty(); }

  PrimitiveId append(const Primitive& primitive) { return insert(size(), primitive); }
  /// Puts the primitive before the one that is at `position` (0 to size()). Throws InputError as
  /// validate does.
  PrimitiveId insert(std::size_t position, const Primitive& primitive);
  /// The same for several, in order: the position table moves once. All are validated before any is put on
  /// the list.
  void insert(std::size_t position, std::span<const Primitive> primitives);
  void remove(PrimitiveId id);
  /// Takes out the primitives at positions first .. first + count - 1; the position table moves once.
  void remove(std::size_t first, std::size_t count);

  [[nodiscard]] PrimitiveId idAt(std::size_t position) const { return PrimitiveId{order_[position]}; }
  /// O(log n).
  [[nodiscard]] std::size_t positionOf(PrimitiveId id) const;
  /// By value: what is kept of a sphere is less than a Primitive.
  [[nodiscard]] Primitive operator[](PrimitiveId id) const { return primitiveIn(slotOf(id)); }
  [[nodiscard]] Primitive at(std::size_t position) const { return primitiveIn(order_[position]); }

  /// Box around all positive primitives of the prefix. O(n).
  [[nodiscard]] Box bounds(Prefix prefix = {}) const;
  /// Sphere about the centre of bounds() that holds all positive primitives of the prefix; radius 0 when
  /// there are none. O(n).
  [[nodiscard]] Sphere boundingSphere(Prefix prefix = {}) const;

  [[nodiscard]] const Clusters& clusters() const { return clusters_; }

  /// Order labels: they grow with the position, and stay as they are while others are inserted or removed,
  /// except that an insertion that finds no room between two labels renews all of them. Compare them, store
  /// none.
  using Label = std::uint64_t;
  [[nodiscard]] std::span<const Label> labels() const { return labels_; }  ///< by slot
  [[nodiscard]] Label labelOf(PrimitiveId id) const { return labels_[slotOf(id)]; }
  /// The label such that exactly the primitives of the prefix have smaller ones.
  [[nodiscard]] Label labelEnd(Prefix prefix) const;
  /// One more than the largest slot number in use; ids index arrays of this size.
  [[nodiscard]] std::size_t slotCount() const { return balls_.size(); }

  /// A sphere itself; of a volume, a ball beyond which no test of it says yes. By slot.
  [[nodiscard]] std::span<const Sphere> balls() const { return balls_; }
  [[nodiscard]] bool isPositive(std::uint32_t slot) const { return positive_[slot] != 0; }
  /// Null for a sphere.
  [[nodiscard]] const PosedVolume* volumeIn(std::uint32_t slot) const {
    return slot < volumes_.size() ? volumes_[slot].get() : nullptr;
  }

  /// Bytes held, from the containers' capacity; volumes that are no spheres included, each once.
  [[nodiscard]] std::size_t bytes() const;

  static std::uint32_t slotOf(PrimitiveId id) { return static_cast<std::uint32_t>(id); }

 private:
  void relabelAll();
  [[nodiscard]] ClusterMembers members() const { return {labels_, balls_, isSphere_}; }
  [[nodiscard]] std::uint32_t takeSlot(const Primitive& primitive);

  [[nodiscard]] Primitive primitiveIn(std::uint32_t slot) const;
  [[nodiscard]] Box boundsIn(std::uint32_t slot) const;

  // Of each slot. Volumes only up to the last one: a list of spheres on a base has room for one.
  std::vector<Sphere> balls_;
  std::vector<std::uint8_t> positive_, isSphere_;
  std::vector<Label> labels_;
  std::vector<std::shared_ptr<const PosedVolume>> volumes_;
  std::vector<std::uint32_t> free_;   // slots to use again
  std::vector<std::uint32_t> order_;  // position -> slot
  Clusters clusters_;
};

}  // namespace restroke::implicit
