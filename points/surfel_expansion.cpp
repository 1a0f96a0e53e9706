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
using implicit::PlacedPatch;
using implicit::Prefix;
using implicit::Primitive;
using implicit::PrimitiveList;
using implicit::SampledShape;
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

// Calls f(row) for the visible samples of a shape, in order.
template <class F>
void forVisible(const SampledShape& shape, const std::uint16_t* masks, const F& f) {
  const auto place = implicit::ballKernels().placePatch;
  const std::uint32_t patches = shape.tree->level[0].count;
  PlacedPatch patch;
  for (std::uint32_t p = 0; p < patches; ++p) {
    std::uint32_t bits = masks[p];
    if (bits == 0) continue;
    place(shape, p, patch);
    for (; bits != 0; bits &= bits - 1) f(patch.row[std::countr_zero(bits)]);
  }
}

}  // namespace

SurfelModel::MasksBySlot SurfelModel::masksBySlot() const {
  MasksBySlot masks(samples_.size(), nullptr);
  for (std::uint32_t slot = 0; slot < samples_.size(); ++slot)
    if (samples_[slot].patches != 0) masks[slot] = masksIn(slot);
  return masks;
}

SurfelModel::FirstOf SurfelModel::firstSurfels() const {
  FirstOf first(list_.size() + 1, 0);
  for (std::size_t i = 0; i < list_.size(); ++i)
    first[i + 1] = first[i] + samples_[PrimitiveList::slotOf(list_.idAt(i))].visible;
  return first;
}

void SurfelModel::expand(const MasksBySlot& masks, const FirstOf& first, std::vector<Surfel>& out,
                         const Execution& execution) const {
  out.resize(first.back());
  inArena(execution, [&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, first.size() - 1, 16), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        if (first[i] == first[i + 1]) continue;
        const std::uint32_t slot = PrimitiveList::slotOf(list_.idAt(i));
        const Primitive primitive = list_.at(i);
        const SampledShape shape = shapeIn(slot);
        const float radius =
            discRadius(primitive.shape, samples_[slot].patches * static_cast<std::uint32_t>(kPatch));
        Surfel* next = out.data() + first[i];
        forVisible(shape, masks[slot], [&](const PlacedPatch::Row& row) {
          *next++ = {{row.x, row.y, row.z},
                     {row.nx, row.ny, row.nz},
                     radius,
                     static_cast<std::uint32_t>(i),
                     primitive.sign};
        });
      }
    });
  });
}

void SurfelModel::surfels(std::vector<Surfel>& out, const Execution& execution) const {
  expand(masksBySlot(), firstSurfels(), out, execution);
}

std::vector<Surfel> SurfelModel::surfels(const Execution& execution) const {
  std::vector<Surfel> out;
  surfels(out, execution);
  return out;
}

std::vector<Surfel> SurfelModel::surfels(Prefix prefix, const Execution& execution) const {
  if (prefix.count >= list_.size() && !edits_) return surfels(execution);
  prefix.count = std::min(prefix.count, list_.size());
  std::vector<std::uint16_t> room;
  const std::vector<std::uint16_t*> masks = evaluatePrefix(prefix, room, execution);
  FirstOf first(prefix.count + 1, 0);
  for (std::size_t i = 0; i < prefix.count; ++i) {
    const std::uint32_t slot = PrimitiveList::slotOf(list_.idAt(i));
    first[i + 1] = first[i];
    for (std::uint32_t p = 0; p < samples_[slot].patches; ++p)
      first[i + 1] += static_cast<unsigned>(std::popcount(masks[slot][p]));
  }
  std::vector<Surfel> out;
  expand({masks.begin(), masks.end()}, first, out, execution);
  return out;
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
          forVisible(shape, masksIn(slot), [&](const PlacedPatch::Row& row) {
            numbers.insert(numbers.end(), {row.x, row.y, row.z, row.nx, row.ny, row.nz});
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
