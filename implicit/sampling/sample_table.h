#pragma once
// A primitive's samples before it is placed (SPEC S3): positions and normals in compact patches of 16, under
// a tree of bounding spheres.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "implicit/geometry/vec.h"
#include "implicit/simd/ball_kernels.h"

namespace restroke::implicit {

/// A point of a surface with the unit normal that points out of the volume.
struct SurfaceSample {
  DVec3 position{0};
  DVec3 normal{0, 0, 1};
};

/// Most samples that one primitive may have.
inline constexpr std::uint32_t kMaxSamples = 1u << 26;

/// Samples reordered so that every run of 16^k from a multiple of 16^k on is compact, with the tree of those
/// runs' bounding spheres. The same samples in the same order give the same table, bit for bit.
class SampleTable {
 public:
  /// Their number is a multiple of kPatch, more than 0. O(n log n).
  explicit SampleTable(std::span<const SurfaceSample> samples);
  /// Of samples that are compact in the order that they come in; their number as above. O(n).
  struct Columns {
    std::vector<float> x, y, z, nx, ny, nz;
  };
  explicit SampleTable(Columns samples);
  /// A unit sphere's: positions are normals, and kept once.
  static SampleTable ofDirections(std::span<const Vec3> directions);

  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(x_.size()); }
  [[nodiscard]] std::uint32_t patches() const { return count() / static_cast<std::uint32_t>(kPatch); }
  [[nodiscard]] Vec3 position(std::uint32_t i) const { return {x_[i], y_[i], z_[i]}; }
  [[nodiscard]] Vec3 normal(std::uint32_t i) const { return {tree_.nx[i], tree_.ny[i], tree_.nz[i]}; }
  [[nodiscard]] const PatchTree& tree() const { return tree_; }
  [[nodiscard]] std::size_t bytes() const;

  SampleTable(SampleTable&&) = default;
  SampleTable& operator=(SampleTable&&) = default;
  SampleTable(const SampleTable&) = delete;
  SampleTable& operator=(const SampleTable&) = delete;
  ~SampleTable() = default;

 private:
  SampleTable() = default;
  void arrange(std::span<const Vec3> positions, std::vector<std::uint32_t>& order);
  void makeTree();
  // Of the positions from `first` up to `last`, multiples of 4.
  [[nodiscard]] DVec3 meanOf(std::size_t first, std::size_t last) const;
  [[nodiscard]] float farthestFrom(Point center, std::size_t first, std::size_t last) const;

  struct Bounds {
    std::vector<float> x, y, z, radius;
  };
  std::vector<float> x_, y_, z_, nx_, ny_, nz_;  // no normals: they are the positions
  std::vector<Bounds> bounds_;
  PatchTree tree_{};
};

/// The number of samples for an area at a density (samples per square unit): the nearest number of a ladder
/// whose steps are at most 1/32, so that few tables serve many sizes; at least kPatch, always a multiple of
/// it. More than kMaxSamples is for the caller to refuse.
[[nodiscard]] std::uint32_t sampleCountFor(double area, double density);

}  // namespace restroke::implicit
