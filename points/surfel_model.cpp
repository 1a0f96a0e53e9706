// Surfels as a pure function of the list (SPEC S3). A sample of primitive i is a surfel when
//   - just outside P_i along its normal, S_(i-1) is outside (i adds) or inside (i carves), and
//   - no later primitive contains it, boundary included.
// Both tests ask only primitives near the sample, and neither asks other samples, so any set of samples may
// be evaluated at any time in any order. What is kept is one bit a sample; positions and normals are made
// again when they are asked for.

#include "points/surfel_model.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <numeric>

#include "implicit/errors.h"
#include "implicit/parallel.h"
#include "implicit/shapes/sphere_samples.h"

namespace restroke::points {

using implicit::DropBall;
using implicit::kPatch;
using implicit::PatchTree;
using implicit::Prefix;
using implicit::Primitive;
using implicit::PrimitiveId;
using implicit::PrimitiveList;
using implicit::SampledShape;
using implicit::SampleTable;
using implicit::Sign;

namespace {

// Disc radius in units of the square root of the area per sample. The lattice's largest gap is 0.8 of it away
// from any sample; the rest overlaps, so that discs seen at a slant leave no gap.
constexpr float kDiscRadius = 0.95f;

// A primitive with more patches than this is evaluated in runs of one node of its tree.
constexpr std::uint32_t kRunPatches = kPatch * kPatch;

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

}  // namespace

struct SurfelModel::Run {
  std::uint32_t slot = 0;
  int level = 0;           // of the tree
  std::uint32_t node = 0;  // all nodes of the level when the primitive is small
  bool whole = true;
};

SurfelModel::SurfelModel(SamplingOptions sampling, implicit::ClusterOptions clusters)
    : list_(clusters), sampling_(sampling) {
  if (!(std::isfinite(sampling.density) && sampling.density > 0))
    throw InputError(
        fmt::format("the density is {}; it must be finite and greater than 0", sampling.density));
}

const SampleTable& SurfelModel::tableIn(std::uint32_t slot) const {
  const Samples& own = samples_[slot];
  return own.table ? *own.table
                   : implicit::samplesOf(list_[PrimitiveId{slot}].shape, own.patches * std::uint32_t{kPatch});
}

SampledShape SurfelModel::shapeIn(std::uint32_t slot) const {
  const Primitive& p = list_[PrimitiveId{slot}];
  SampledShape shape = implicit::sampled(p.shape, tableIn(slot));
  shape.positive = p.sign == Sign::Positive;
  return shape;
}

void SurfelModel::append(std::span<const Primitive> primitives, const Execution& execution) {
  insert(list_.size(), primitives, execution);
}

void SurfelModel::insert(std::size_t position, std::span<const Primitive> primitives,
                         const Execution& execution) {
  RESTROKE_CHECK_LE(position, list_.size());
  for (const Primitive& p : primitives) {
    implicit::validate(p);
    (void)implicit::sampleCount(p.shape, sampling_.density);
  }
  if (edits_) {
    insertUnseen(position, primitives);
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      edits_->balls.push_back(implicit::dropBall(primitives[i].shape));
      if (!primitives[i].shape.isSphere()) edits_->shapes.push_back(primitives[i].shape);
      edits_->inserted.push_back(PrimitiveList::slotOf(list_.idAt(position + i)));
    }
  } else if (position < list_.size() && primitives.size() > 1) {
    beginEdits();
    insert(position, primitives, execution);
    endEdits(execution);
  } else {
    for (std::size_t i = 0; i < primitives.size(); ++i) insertOne(position + i, primitives[i]);
  }
}

void SurfelModel::insertUnseen(std::size_t position, std::span<const Primitive> primitives) {
  list_.insert(position, primitives);
  samples_.resize(std::max(samples_.size(), list_.slotCount()));
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const implicit::Shape& shape = primitives[i].shape;
    const SampleTable& table = implicit::samplesOf(shape, implicit::sampleCount(shape, sampling_.density));
    Samples& own = samples_[PrimitiveList::slotOf(list_.idAt(position + i))];
    own.table = implicit::keepsSamples(shape) ? &table : nullptr;
    own.patches = table.patches();
    own.visible = std::make_unique<std::uint16_t[]>(own.patches);
    visibleBytes_ += own.patches * sizeof(std::uint16_t);
  }
}

void SurfelModel::insertOne(std::size_t position, const Primitive& primitive) {
  const implicit::BallKernels& kernels = implicit::ballKernels();
  insertUnseen(position, {&primitive, 1});
  const std::uint32_t slot = PrimitiveList::slotOf(list_.idAt(position));
  const DropBall drop = implicit::dropBall(primitive.shape);
  near_.gather(list_, drop, std::numeric_limits<PrimitiveList::Label>::max(), list_.labels()[slot]);
  const implicit::BallArrays balls = near_.arrays();

  // Its own samples.
  Samples& own = samples_[slot];
  const SampledShape shape = shapeIn(slot);
  const int top = shape.tree->levels - 1;
  for (std::uint32_t node = 0; node < shape.tree->level[top].count; ++node)
    kernels.evaluateNode(shape, top, node, balls, own.visible.get());
  for (std::uint32_t p = 0; p < own.patches; ++p)
    surfelCount_ += static_cast<unsigned>(std::popcount(own.visible[p]));

  // Older samples in it go; younger ones may go or come, because what they were added to or carved from has
  // changed.
  std::vector<std::uint64_t> changed;
  for (std::size_t i = 0; i < balls.earlier; ++i) {
    const std::uint32_t other = near_.slot(i);
    surfelCount_ -= kernels.dropSamples(shapeIn(other), drop, samples_[other].visible.get());
  }
  for (std::size_t i = balls.earlier; i < near_.size(); ++i) addTouched(near_.slot(i), drop, changed);
  reevaluate(changed, {.threads = 1});
}

void SurfelModel::remove(std::size_t first, std::size_t count, const Execution& execution) {
  RESTROKE_CHECK_LE(first, list_.size());
  RESTROKE_CHECK_LE(count, list_.size() - first);
  Edits now;
  Edits& edits = edits_ ? *edits_ : now;
  for (std::size_t i = count; i-- > 0;) {
    const PrimitiveId id = list_.idAt(first + i);
    const std::uint32_t slot = PrimitiveList::slotOf(id);
    const implicit::Shape& shape = list_[id].shape;
    edits.balls.push_back(implicit::dropBall(shape));
    if (!shape.isSphere()) edits.shapes.push_back(shape);
    Samples& own = samples_[slot];
    for (std::uint32_t p = 0; p < own.patches; ++p)
      surfelCount_ -= static_cast<unsigned>(std::popcount(own.visible[p]));
    visibleBytes_ -= own.patches * sizeof(std::uint16_t);
    own = {};
  }
  list_.remove(first, count);
  if (edits_) return;
  // What was in a removed ball, or asked about it, is evaluated again.
  std::vector<std::uint64_t> changed;
  reevaluateAround(now.balls, changed, execution);
}

void SurfelModel::beginEdits() {
  RESTROKE_CHECK_EQ(edits_ != nullptr, false);
  edits_ = std::make_unique<Edits>();
}

void SurfelModel::endEdits(const Execution& execution) {
  RESTROKE_CHECK_EQ(edits_ != nullptr, true);
  const std::unique_ptr<Edits> edits = std::move(edits_);
  std::vector<std::uint64_t> changed;
  for (const std::uint32_t slot : edits->inserted) {
    const Samples& own = samples_[slot];
    if (!own.visible) continue;  // removed since
    for (std::uint32_t p = 0; p < own.patches; ++p) changed.push_back(std::uint64_t{slot} << 32 | p);
  }
  reevaluateAround(edits->balls, changed, execution);
}

void SurfelModel::reevaluateAround(std::span<const DropBall> balls, std::vector<std::uint64_t>& patches,
                                   const Execution& execution) {
  for (const DropBall& ball : balls) {
    near_.gather(list_, ball, std::numeric_limits<PrimitiveList::Label>::max());
    for (std::size_t i = 0; i < near_.size(); ++i) addTouched(near_.slot(i), ball, patches);
  }
  reevaluate(patches, execution);
}

void SurfelModel::addTouched(std::uint32_t slot, const DropBall& ball, std::vector<std::uint64_t>& patches) {
  touched_.resize(std::max<std::size_t>(touched_.size(), samples_[slot].patches));
  const std::size_t n = implicit::ballKernels().touchedPatches(shapeIn(slot), ball, touched_.data());
  for (std::size_t k = 0; k < n; ++k) patches.push_back(std::uint64_t{slot} << 32 | touched_[k]);
}

void SurfelModel::reevaluate(std::vector<std::uint64_t>& patches, const Execution& execution) {
  if (patches.empty()) return;
  std::sort(patches.begin(), patches.end());
  patches.erase(std::unique(patches.begin(), patches.end()), patches.end());
  // Patches of one node of the tree, or of one small primitive, share what is near them.
  std::vector<std::size_t> groups;  // where each begins
  for (std::size_t i = 0; i < patches.size(); ++i)
    if (i == 0 || patches[i] / kPatch != patches[i - 1] / kPatch) groups.push_back(i);
  groups.push_back(patches.size());

  const auto evaluateGroup = [&](std::size_t g, implicit::NearBalls& near) {
    const std::size_t first = groups[g], n = groups[g + 1] - first;
    const auto slot = static_cast<std::uint32_t>(patches[first] >> 32);
    const SampledShape shape = shapeIn(slot);
    std::uint32_t numbers[kPatch];
    std::uint16_t masks[kPatch];
    for (std::size_t k = 0; k < n; ++k) numbers[k] = static_cast<std::uint32_t>(patches[first + k]);
    const DropBall region = shape.tree->levels > 1
                                ? implicit::regionOfNode(shape, 1, numbers[0] / std::uint32_t{kPatch})
                                : implicit::regionOf(list_[PrimitiveId{slot}].shape);
    near.gather(list_, region, std::numeric_limits<PrimitiveList::Label>::max(), list_.labels()[slot]);
    implicit::ballKernels().evaluatePatches(shape, numbers, n, near.arrays(), masks);
    std::ptrdiff_t difference = 0;
    for (std::size_t k = 0; k < n; ++k) {
      std::uint16_t& mask = samples_[slot].visible[numbers[k]];
      difference += std::popcount(masks[k]) - std::popcount(mask);
      mask = masks[k];
    }
    return difference;
  };

  std::vector<std::ptrdiff_t> differences(groups.size() - 1);
  if (execution.threads == 1 || differences.size() < 16) {
    for (std::size_t g = 0; g < differences.size(); ++g) differences[g] = evaluateGroup(g, near_);
  } else {
    inArena(execution, [&] {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, differences.size(), 8), [&](const auto& range) {
        thread_local implicit::NearBalls near;
        for (std::size_t g = range.begin(); g < range.end(); ++g) differences[g] = evaluateGroup(g, near);
      });
    });
  }
  const std::ptrdiff_t total = std::accumulate(differences.begin(), differences.end(), std::ptrdiff_t{0});
  surfelCount_ = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(surfelCount_) + total);
}

std::vector<SurfelModel::Run> SurfelModel::runsOf(Prefix prefix) const {
  std::vector<Run> runs;
  const std::size_t end = std::min(prefix.count, list_.size());
  for (std::size_t i = 0; i < end; ++i) {
    const std::uint32_t slot = PrimitiveList::slotOf(list_.idAt(i));
    const SampleTable& table = tableIn(slot);
    if (table.patches() <= kRunPatches) {
      runs.push_back({slot, table.tree().levels - 1, 0, true});
    } else {
      for (std::uint32_t node = 0; node < table.tree().level[1].count; ++node)
        runs.push_back({slot, 1, node, false});
    }
  }
  return runs;
}

void SurfelModel::evaluate(std::span<const Run> runs, std::span<std::uint16_t* const> visible, Prefix prefix,
                           const Execution& execution) const {
  const PrimitiveList::Label end = list_.labelEnd(prefix);
  const implicit::BallKernels& kernels = implicit::ballKernels();
  inArena(execution, [&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, runs.size(), 16), [&](const auto& range) {
      thread_local implicit::NearBalls near;
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        const Run& run = runs[i];
        const SampledShape shape = shapeIn(run.slot);
        const DropBall region = run.whole ? implicit::regionOf(list_[PrimitiveId{run.slot}].shape)
                                          : implicit::regionOfNode(shape, run.level, run.node);
        near.gather(list_, region, end, list_.labels()[run.slot]);
        const implicit::BallArrays balls = near.arrays();
        if (!run.whole) {
          kernels.evaluateNode(shape, run.level, run.node, balls, visible[run.slot]);
          continue;
        }
        for (std::uint32_t node = 0; node < shape.tree->level[run.level].count; ++node)
          kernels.evaluateNode(shape, run.level, node, balls, visible[run.slot]);
      }
    });
  });
}

std::vector<std::uint16_t*> SurfelModel::visibleBySlot() const {
  std::vector<std::uint16_t*> visible(samples_.size());
  for (std::size_t s = 0; s < samples_.size(); ++s) visible[s] = samples_[s].visible.get();
  return visible;
}

void SurfelModel::rebuild(const Execution& execution) {
  evaluate(runsOf({}), visibleBySlot(), {}, execution);
  surfelCount_ = 0;
  for (const Samples& s : samples_)
    for (std::uint32_t p = 0; p < s.patches; ++p)
      surfelCount_ += static_cast<unsigned>(std::popcount(s.visible[p]));
}

std::vector<Surfel> SurfelModel::expand(std::span<std::uint16_t* const> visible, std::size_t primitives,
                                        const Execution& execution) const {
  std::vector<std::size_t> first(primitives + 1, 0);
  for (std::size_t i = 0; i < primitives; ++i) {
    const std::uint32_t slot = PrimitiveList::slotOf(list_.idAt(i));
    std::size_t n = 0;
    for (std::uint32_t p = 0; p < samples_[slot].patches; ++p)
      n += static_cast<unsigned>(std::popcount(visible[slot][p]));
    first[i + 1] = first[i] + n;
  }
  std::vector<Surfel> out(first.back());
  inArena(execution, [&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, primitives, 16), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        const Primitive& primitive = list_.at(i);
        const std::uint32_t slot = PrimitiveList::slotOf(list_.idAt(i));
        const SampleTable& table = tableIn(slot);
        const SampledShape shape = shapeIn(slot);
        const float radius = discRadius(primitive.shape, table.count());
        std::size_t at = first[i];
        for (std::uint32_t p = 0; p < table.patches(); ++p)
          for (std::uint32_t bits = visible[slot][p]; bits != 0; bits &= bits - 1) {
            const implicit::PlacedSample s =
                implicit::placedSample(shape, p * static_cast<std::uint32_t>(kPatch) +
                                                  static_cast<std::uint32_t>(std::countr_zero(bits)));
            out[at++] = {s.position, shape.positive ? s.normal : -s.normal, radius,
                         static_cast<std::uint32_t>(i), primitive.sign};
          }
      }
    });
  });
  return out;
}

std::vector<Surfel> SurfelModel::surfels(const Execution& execution) const {
  return expand(visibleBySlot(), list_.size(), execution);
}

std::vector<Surfel> SurfelModel::surfels(Prefix prefix, const Execution& execution) const {
  if (prefix.count >= list_.size() && !edits_) return surfels(execution);
  prefix.count = std::min(prefix.count, list_.size());
  std::vector<std::vector<std::uint16_t>> masks(samples_.size());
  std::vector<std::uint16_t*> visible(samples_.size(), nullptr);
  for (std::size_t i = 0; i < prefix.count; ++i) {
    const std::uint32_t slot = PrimitiveList::slotOf(list_.idAt(i));
    masks[slot].resize(samples_[slot].patches);
    visible[slot] = masks[slot].data();
  }
  evaluate(runsOf(prefix), visible, prefix, execution);
  return expand(visible, prefix.count, execution);
}

std::uint64_t SurfelModel::stateHash(const Execution& execution) const {
  // One hash a primitive, in parallel; then one over these, in list order.
  std::vector<std::uint64_t> hashes(list_.size());
  inArena(execution, [&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, hashes.size(), 16), [&](const auto& range) {
      std::vector<float> numbers;
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        const Primitive& primitive = list_.at(i);
        const std::uint32_t slot = PrimitiveList::slotOf(list_.idAt(i));
        const Samples& s = samples_[slot];
        const SampledShape shape = shapeIn(slot);
        describe(primitive, numbers);
        for (std::uint32_t p = 0; p < s.patches; ++p)
          for (std::uint32_t bits = s.visible[p]; bits != 0; bits &= bits - 1) {
            const implicit::PlacedSample at =
                implicit::placedSample(shape, p * static_cast<std::uint32_t>(kPatch) +
                                                  static_cast<std::uint32_t>(std::countr_zero(bits)));
            const Vec3 n = shape.positive ? at.normal : -at.normal;
            numbers.insert(numbers.end(), {at.position.x, at.position.y, at.position.z, n.x, n.y, n.z});
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

ModelBytes SurfelModel::bytes() const {
  return {.list = list_.bytes(),
          .clusters = list_.clusters().bytes(),
          .surfels = samples_.capacity() * sizeof(Samples) + visibleBytes_,
          .scratch = near_.bytes() + touched_.capacity() * sizeof(std::uint32_t),
          .tables = implicit::bytesOfSphereSamples()};
}

}  // namespace restroke::points
