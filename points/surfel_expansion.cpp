// What a SurfelModel shows: its surfels with their places and normals, made from the bits that it keeps, and
// its hashes.

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>

#include "implicit/parallel.h"
#include "points/surfel_model.h"

namespace restroke::points {

using implicit::kPatch;
using implicit::Prefix;
using implicit::Primitive;
using implicit::PrimitiveList;
using implicit::SampledShape;
using implicit::SampleTable;
using implicit::Sign;

namespace {

// Disc radius in units of the square root of the area per sample. The lattice's largest gap is 0.8 of it away
// from any sample; the rest overlaps, so that discs seen at a slant leave no gap.
constexpr float kDiscRadius = 0.95f;

float discRadius(const implicit::Shape& shape, std::uint32_t samples) {
  return kDiscRadius * static_cast<float>(std::sqrt(areaOf(shape) / samples));
}

// What a primitive is, as numbers: equal primitives, equal numbers.
void describe(const Primitive& primitive, std::vector<float>& numbers) {
  const implicit::Sphere& ball = primitive.shape.ball();
  numbers.assign({ball.center.x, ball.center.y, ball.center.z, ball.radius,
                  primitive.sign == Sign::Positive ? 1.0f : -1.0f});
  const implicit::PosedVolume* volume = primitive.shape.volume();
  if (!volume) return;
  for (const char c : volume->volume().kind().name) numbers.push_back(static_cast<float>(c));
  const implicit::Pose& pose = volume->pose();
  numbers.insert(numbers.end(), {pose.position.x, pose.position.y, pose.position.z, pose.rotation[0],
                                 pose.rotation[1], pose.rotation[2], pose.rotation[3], pose.scale});
  const implicit::VolumeParameters& parameters = volume->volume().parameters();
  for (const std::vector<float>& values : parameters.values) {
    numbers.push_back(static_cast<float>(values.size()));
    numbers.insert(numbers.end(), values.begin(), values.end());
  }
  if (!parameters.mesh) return;
  for (const Point v : parameters.mesh->mesh.vertices) numbers.insert(numbers.end(), {v.x, v.y, v.z});
  for (const auto& triangle : parameters.mesh->mesh.triangles)
    for (const std::uint32_t v : triangle) numbers.push_back(std::bit_cast<float>(v));
}

// Calls f(sample) for the visible samples of a shape, in order.
template <class F>
void forVisible(const SampledShape& shape, const std::uint16_t* masks, std::uint32_t patches, const F& f) {
  for (std::uint32_t p = 0; p < patches; ++p)
    for (std::uint32_t bits = masks[p]; bits != 0; bits &= bits - 1)
      f(implicit::placedSample(shape, p * static_cast<std::uint32_t>(kPatch) +
                                          static_cast<std::uint32_t>(std::countr_zero(bits))));
}

}  // namespace

SurfelModel::MasksBySlot SurfelModel::masksBySlot() const {
  MasksBySlot masks(samples_.size(), nullptr);
  for (std::uint32_t slot = 0; slot < samples_.size(); ++slot)
    if (samples_[slot].patches != 0) masks[slot] = masksIn(slot);
  return masks;
}

std::vector<Surfel> SurfelModel::expand(const MasksBySlot& masks, std::size_t primitives,
                                        const Execution& execution) const {
  std::vector<std::size_t> first(primitives + 1, 0);
  for (std::size_t i = 0; i < primitives; ++i) {
    const std::uint32_t slot = PrimitiveList::slotOf(list_.idAt(i));
    std::size_t n = 0;
    for (std::uint32_t p = 0; p < samples_[slot].patches; ++p)
      n += static_cast<unsigned>(std::popcount(masks[slot][p]));
    first[i + 1] = first[i] + n;
  }
  std::vector<Surfel> out(first.back());
  inArena(execution, [&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, primitives, 16), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        if (first[i] == first[i + 1]) continue;
        const std::uint32_t slot = PrimitiveList::slotOf(list_.idAt(i));
        const Primitive primitive = list_.at(i);
        const SampleTable& table = tableIn(slot);
        const SampledShape shape = shapeIn(slot);
        const float radius = discRadius(primitive.shape, table.count());
        std::size_t at = first[i];
        forVisible(shape, masks[slot], table.patches(), [&](const implicit::PlacedSample& s) {
          out[at++] = {s.position, shape.positive ? s.normal : -s.normal, radius,
                       static_cast<std::uint32_t>(i), primitive.sign};
        });
      }
    });
  });
  return out;
}

std::vector<Surfel> SurfelModel::surfels(const Execution& execution) const {
  return expand(masksBySlot(), list_.size(), execution);
}

std::vector<Surfel> SurfelModel::surfels(Prefix prefix, const Execution& execution) const {
  if (prefix.count >= list_.size() && !edits_) return surfels(execution);
  prefix.count = std::min(prefix.count, list_.size());
  std::vector<std::uint16_t> room;
  const std::vector<std::uint16_t*> masks = evaluatePrefix(prefix, room, execution);
  return expand({masks.begin(), masks.end()}, prefix.count, execution);
}

float SurfelModel::discRadiusOf(implicit::PrimitiveId id) const {
  return discRadius(list_[id].shape, tableIn(PrimitiveList::slotOf(id)).count());
}

std::uint64_t SurfelModel::stateHash(const Execution& execution) const {
  // One hash a primitive, in parallel; then one over these, in list order.
  std::vector<std::uint64_t> hashes(list_.size());
  inArena(execution, [&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, hashes.size(), 16), [&](const auto& range) {
      std::vector<float> numbers;
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        const std::uint32_t slot = PrimitiveList::slotOf(list_.idAt(i));
        describe(list_.at(i), numbers);
        if (samples_[slot].visible != 0) {
          const SampledShape shape = shapeIn(slot);
          forVisible(shape, masksIn(slot), samples_[slot].patches, [&](const implicit::PlacedSample& at) {
            const Vec3 n = shape.positive ? at.normal : -at.normal;
            numbers.insert(numbers.end(), {at.position.x, at.position.y, at.position.z, n.x, n.y, n.z});
          });
        }
        hashes[i] = XXH3_64bits(numbers.data(), numbers.size() * sizeof(float));
      }
    });
  });
  return XXH3_64bits_withSeed(hashes.data(), hashes.size() * sizeof(std::uint64_t),
                              std::bit_cast<std::uint32_t>(sampling_.density));
}

std::uint64_t listHash(const PrimitiveList& list, Prefix prefix) {
  std::vector<float> numbers, all;
  const std::size_t end = std::min(prefix.count, list.size());
  for (std::size_t i = 0; i < end; ++i) {
    describe(list.at(i), numbers);
    all.insert(all.end(), numbers.begin(), numbers.end());
  }
  return XXH3_64bits(all.data(), all.size() * sizeof(float));
}

}  // namespace restroke::points
