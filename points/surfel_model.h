#pragma once
// A shape with its surfels, kept up to date (SPEC S3, S6; DESIGN invariant 2: surfels are a pure function of
// the list).

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "implicit/execution.h"
#include "implicit/near_balls.h"
#include "implicit/primitive_list.h"
#include "points/surfel.h"

namespace restroke::points {

/// Bytes held, from the containers' real capacity (DESIGN invariant 11).
struct ModelBytes {
  std::size_t list = 0;      ///< primitives and their order
  std::size_t clusters = 0;  ///< cluster lists
  std::size_t surfels = 0;   ///< visibility of all samples
  std::size_t scratch = 0;   ///< kept between operations, to be used again
  std::size_t tables = 0;    ///< sample directions, shared by all models of the process
  [[nodiscard]] std::size_t total() const { return list + clusters + surfels + scratch; }
};

/// Which samples of the first primitives of a list are surfels.
struct VisibleSamples {
  /// By list position: bit k of the p-th says so of sample 16 p + k.
  std::vector<std::span<const std::uint16_t>> of;
  std::vector<std::uint16_t> room;  ///< what `of` refers to, where the model does not have it already
};

/// The list of primitives together with which samples of each are visible. Whatever the order of appends,
/// insertions and removals that led to a list, the surfels are those of the list, bit for bit.
class SurfelModel {
 public:
  /// Throws InputError when the density is not finite or not positive.
  explicit SurfelModel(SamplingOptions sampling, implicit::ClusterOptions clusters = {});

  [[nodiscard]] const implicit::PrimitiveList& list() const { return list_; }
  [[nodiscard]] const SamplingOptions& sampling() const { return sampling_; }

  /// Adds at the end, in order. Throws InputError, and then changes nothing, when a primitive is refused by
  /// PrimitiveList or would have more than implicit::kMaxSamples samples.
  void append(std::span<const implicit::Primitive> primitives, const Execution& execution = {});
  void insert(std::size_t position, std::span<const implicit::Primitive> primitives,
              const Execution& execution = {});
  /// Takes out the primitives at positions first .. first + count - 1.
  void remove(std::size_t first, std::size_t count, const Execution& execution = {});
  /// Many insertions and removals at once: until endEdits they change the list only, so that what several of
  /// them touch is evaluated once. In between, ask for surfels with a prefix (which are evaluated then), for
  /// no count and no hash. The result is the same.
  void beginEdits();
  void endEdits(const Execution& execution = {});
  /// Forgets all surfels and evaluates every sample anew. Changes no result; for measurements and tests.
  void rebuild(const Execution& execution = {});

  /// Number of visible samples. O(1).
  [[nodiscard]] std::size_t surfelCount() const { return surfelCount_; }
  /// All surfels, by list position, then by sample number. O(samples).
  [[nodiscard]] std::vector<Surfel> surfels(const Execution& execution = {}) const;
  /// The same into `out`, whose memory is used again: for what is drawn again and again.
  void surfels(std::vector<Surfel>& out, const Execution& execution = {}) const;
  /// The surfels that a list of only the prefix would have, without changing anything.
  [[nodiscard]] std::vector<Surfel> surfels(implicit::Prefix prefix, const Execution& execution = {}) const;

  /// What `surfels(prefix)` lays out, before it is laid out: for those who keep something of each primitive
  /// and look for what has changed. Valid until the model changes. O(primitives) for the whole list, else as
  /// surfels(prefix).
  [[nodiscard]] VisibleSamples visibleSamples(implicit::Prefix prefix, const Execution& execution = {}) const;
  /// The samples of a primitive as implicit::placedSample takes them, and the radius of its discs.
  [[nodiscard]] implicit::SampledShape sampledShape(implicit::PrimitiveId id) const {
    return shapeIn(implicit::PrimitiveList::slotOf(id));
  }
  [[nodiscard]] float discRadiusOf(implicit::PrimitiveId id) const;

  /// Hash of the density, of the list and of the position and normal of every visible sample: equal states,
  /// equal hashes, on every machine, thread count, instruction set and compiler.
  [[nodiscard]] std::uint64_t stateHash(const Execution& execution = {}) const;

  [[nodiscard]] ModelBytes bytes() const;

 private:
  using Masks = implicit::Arena<std::uint16_t>;
  /// The samples of the primitive in one slot of the list.
  struct Samples {
    Masks::Handle masks = Masks::kNone;  ///< bit k of the p-th: sample 16 p + k is a surfel
    std::uint32_t patches = 0;
    std::uint32_t visible = 0;  ///< how many are
  };
  /// A run of patches of one primitive: the unit of parallel work.
  struct Run {
    std::uint32_t slot = 0;
    int level = 0;                   ///< of the tree
    std::uint32_t node = 0;          ///< all nodes of the level when the primitive is small
    bool whole = true;               ///< it is small
    std::uint32_t visible = 0;       ///< samples: what came of it
    std::uint16_t* masks = nullptr;  ///< of the primitive, where it goes
  };
  using MasksBySlot = std::vector<const std::uint16_t*>;
  using FirstOf = std::vector<std::size_t>;  // by list position, and the end: which surfel is the first
  [[nodiscard]] const implicit::SampleTable& tableIn(std::uint32_t slot) const;
  [[nodiscard]] implicit::SampledShape shapeIn(std::uint32_t slot) const;
  [[nodiscard]] implicit::DropBall regionIn(std::uint32_t slot) const;
  [[nodiscard]] implicit::NearBalls::Place placeOf(std::uint32_t slot) const;
  [[nodiscard]] std::uint16_t* masksIn(std::uint32_t slot) { return masks_.at(samples_[slot].masks); }
  [[nodiscard]] const std::uint16_t* masksIn(std::uint32_t slot) const {
    return masks_.at(samples_[slot].masks);
  }
  void insertOne(std::size_t position, const implicit::Primitive& primitive);
  void appendTogether(std::span<const implicit::Primitive> primitives, const Execution& execution);
  void insertUnseen(std::size_t position, std::span<const implicit::Primitive> primitives);
  struct Edits;
  void noteTouched(Edits& edits, const implicit::Shape& shape, implicit::PrimitiveList::Label before);
  void evaluateTouched(Edits& edits, const Execution& execution);
  struct Touch;
  [[nodiscard]] std::vector<Touch> touchesOf(const Edits& edits) const;
  void touchBlocks(const Edits& edits, const Touch& touch, std::vector<Touch>& touches) const;
  static void markTouched(const implicit::SampledShape& shape, const Edits& edits, std::uint64_t touched,
                          std::span<std::uint16_t> blocks);
  std::ptrdiff_t evaluateTouch(const Edits& edits, const Touch& touch, implicit::NearBalls& near);
  void evaluate(std::span<Run> runs, implicit::Prefix prefix, const Execution& execution) const;
  void evaluateInPlace(std::vector<Run> runs, const Execution& execution);
  /// Calls f(i, near) for i from 0 to count - 1, on the execution's threads.
  template <class F>
  void forEach(std::size_t count, const Execution& execution, const F& f) const;
  template <class Work>
  void orderInSpace(std::vector<Work>& work) const;
  [[nodiscard]] MasksBySlot masksBySlot() const;
  [[nodiscard]] std::vector<std::uint16_t*> evaluatePrefix(implicit::Prefix prefix,
                                                           std::vector<std::uint16_t>& room,
                                                           const Execution& execution) const;
  [[nodiscard]] FirstOf firstSurfels() const;
  [[nodiscard]] std::vector<Run> runsOf(std::size_t first, std::size_t last) const;
  void expand(const MasksBySlot& masks, const FirstOf& first, std::vector<Surfel>& out,
              const Execution& execution) const;

  implicit::PrimitiveList list_;
  SamplingOptions sampling_;
  std::size_t surfelCount_ = 0;
  Masks masks_;
  std::vector<Samples> samples_;  // by slot
  implicit::NearBalls near_;

  /// What has been changed since beginEdits.
  struct Edits {
    std::vector<implicit::DropBall> balls;  // of what came and what went
    std::vector<implicit::Shape> shapes;    // keeps the volumes that `balls` refers to
    // Primitives with a ball that reaches into them, slot << 32 | ball; the ball kAllPatches for new ones.
    std::vector<std::uint64_t> touched;
  };
  std::unique_ptr<Edits> edits_;
};

/// Hash of the prefix's primitives in order: equal lists, equal hashes. O(primitives).
[[nodiscard]] std::uint64_t listHash(const implicit::PrimitiveList& list, implicit::Prefix prefix = {});

}  // namespace restroke::points
