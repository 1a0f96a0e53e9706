// Surfels as a pure function of the list (SPEC S3). A sample of primitive i is a surfel when
//   - just outside P_i along its normal, S_(i-1) is outside (i adds) or inside (i carves), and
//   - no later primitive contains it, boundary included.
// Both tests ask only primitives near the sample, and neither asks other samples, so any set of samples may
// be evaluated at any time in any order. What is kept is one bit a sample; positions and normals are made
// again when they are asked for.

#include "points/surfel_model.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <numeric>

#include "implicit/errors.h"
#include "implicit/geometry/morton.h"
#include "implicit/parallel.h"
#include "implicit/shapes/sphere_samples.h"

namespace restroke::points {

using implicit::DropBall;
using implicit::kPatch;
using implicit::NearBalls;
using implicit::Prefix;
using implicit::Primitive;
using implicit::PrimitiveId;
using implicit::PrimitiveList;
using implicit::SampledShape;
using implicit::SampleTable;

namespace {

constexpr auto kWholeList = std::numeric_limits<PrimitiveList::Label>::max();

// A primitive with more patches than this is evaluated in runs of one node of its tree.
constexpr std::uint32_t kRunPatches = kPatch * kPatch;

// A primitive of at most so many patches is looked at as one.
constexpr std::uint32_t kSmall = 4 * kPatch;

// In Edits::touched, in the place of a ball's number.
constexpr std::uint32_t kAllPatches = ~0u;

// From this many on, the primitives of one call are evaluated together.
constexpr std::size_t kTogether = 4;

}  // namespace

SurfelModel::SurfelModel(SamplingOptions sampling, implicit::ClusterOptions clusters)
    : list_(clusters), sampling_(sampling) {
  if (!(std::isfinite(sampling.density) && sampling.density > 0))
    throw InputError(
        fmt::format("the density is {}; it must be finite and greater than 0", sampling.density));
}

const SampleTable& SurfelModel::tableIn(std::uint32_t slot) const {
  const std::uint32_t count = samples_[slot].patches * std::uint32_t{kPatch};
  const implicit::PosedVolume* volume = list_.volumeIn(slot);
  return volume ? volume->volume().samples(count) : implicit::sphereSamples(count);
}

SampledShape SurfelModel::shapeIn(std::uint32_t slot) const {
  const implicit::PosedVolume* volume = list_.volumeIn(slot);
  SampledShape shape = volume ? implicit::sampled(*volume, tableIn(slot))
                              : implicit::sampled(list_.balls()[slot], tableIn(slot));
  shape.positive = list_.isPositive(slot);
  return shape;
}

NearBalls::Place SurfelModel::placeOf(std::uint32_t slot) const {
  return {.label = list_.labels()[slot], .slot = slot};
}

DropBall SurfelModel::regionIn(std::uint32_t slot) const {
  return implicit::regionOf(list_[PrimitiveId{slot}].shape);
}

template <class F>
void SurfelModel::forEach(std::size_t count, const Execution& execution, const F& f) const {
  const std::size_t grain = list_.clusters().crowded() ? 64 : 8;  // long enough to wake a thread for
  if (execution.threads == 1 || count < 2 * grain) {
    NearBalls near;
    for (std::size_t i = 0; i < count; ++i) f(i, near);
    return;
  }
  tbb::enumerable_thread_specific<NearBalls> nears;
  inArena(execution, [&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto& range) {
      NearBalls& near = nears.local();
      for (std::size_t i = range.begin(); i < range.end(); ++i) f(i, near);
    });
  });
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
    const PrimitiveList::Label label = list_.labelEnd({position});
    for (const Primitive& p : primitives) noteTouched(*edits_, p.shape, label);
    insertUnseen(position, primitives);
    for (std::size_t i = 0; i < primitives.size(); ++i)
      edits_->touched.push_back(std::uint64_t{PrimitiveList::slotOf(list_.idAt(position + i))} << 32 |
                                kAllPatches);
  } else if (position == list_.size() && primitives.size() >= kTogether) {
    appendTogether(primitives, execution);
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
  if (samples_.size() < list_.slotCount()) samples_.resize(list_.slotCount());
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const std::uint32_t slot = PrimitiveList::slotOf(list_.idAt(position + i));
    const std::uint32_t count = implicit::sampleCount(primitives[i].shape, sampling_.density);
    Samples& own = samples_[slot];
    own = {.patches = count / std::uint32_t{kPatch}};
    own.patches = tableIn(slot).patches();  // a volume may have fewer
    own.masks = masks_.take(own.patches);
    std::fill_n(masksIn(slot), own.patches, std::uint16_t{0});
  }
}

void SurfelModel::insertOne(std::size_t position, const Primitive& primitive) {
  // What is near is asked for before the primitive hides anything of it (CrowdedCell).
  const DropBall drop = implicit::dropBall(primitive.shape);
  const PrimitiveList::Label label = list_.labelEnd({position});
  near_.gather(list_, drop, kWholeList, {.label = label});
  const implicit::BallArrays balls = near_.arrays();
  Edits younger;
  for (std::size_t i = balls.earlier; i < near_.size(); ++i)
    younger.touched.push_back(std::uint64_t{near_.slot(i)} << 32);

  // Its own samples.
  const implicit::BallKernels& kernels = implicit::ballKernels();
  insertUnseen(position, {&primitive, 1});
  const std::uint32_t slot = PrimitiveList::slotOf(list_.idAt(position));
  const SampledShape shape = shapeIn(slot);
  const int top = shape.tree->levels - 1;
  std::size_t visible = 0;
  for (std::uint32_t node = 0; node < shape.tree->level[top].count; ++node)
    visible += kernels.evaluateNode(shape, top, node, balls, masksIn(slot));
  samples_[slot].visible = static_cast<std::uint32_t>(visible);
  surfelCount_ += visible;

  // Older samples in it go; younger ones may go or come, because what they were added to or carved from has
  // changed.
  for (std::size_t i = 0; i < balls.earlier; ++i) {
    const std::uint32_t other = near_.slot(i);
    if (samples_[other].visible == 0) continue;
    const std::size_t dropped = kernels.dropSamples(shapeIn(other), drop, masksIn(other));
    samples_[other].visible -= static_cast<std::uint32_t>(dropped);
    surfelCount_ -= dropped;
  }
  if (younger.touched.empty()) return;
  younger.balls.push_back(drop);
  evaluateTouched(younger, {.threads = 1});
}

// A stroke's stamps lie on each other, so that most of their samples would be evaluated only to be dropped by
// the next stamp. Put on the list together, each sample is evaluated once, and the older primitives drop
// theirs, each on one thread.
void SurfelModel::appendTogether(std::span<const Primitive> primitives, const Execution& execution) {
  // Older primitives with the number of each new one that reaches into them, before these hide any.
  std::vector<std::uint64_t> older;
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    near_.gather(list_, implicit::dropBall(primitives[i].shape), kWholeList);
    for (std::size_t k = 0; k < near_.size(); ++k)
      if (samples_[near_.slot(k)].visible != 0) older.push_back(std::uint64_t{near_.slot(k)} << 32 | i);
  }

  const std::size_t first = list_.size();
  insertUnseen(first, primitives);
  evaluateInPlace(runsOf(first, list_.size()), execution);

  std::sort(older.begin(), older.end());
  std::vector<std::size_t> groups;
  for (std::size_t i = 0; i < older.size(); ++i)
    if (i == 0 || older[i] >> 32 != older[i - 1] >> 32) groups.push_back(i);
  groups.push_back(older.size());
  std::vector<std::uint32_t> dropped(groups.size() - 1, 0);
  forEach(dropped.size(), execution, [&](std::size_t g, NearBalls&) {
    const auto slot = static_cast<std::uint32_t>(older[groups[g]] >> 32);
    const SampledShape shape = shapeIn(slot);
    for (std::size_t i = groups[g]; i < groups[g + 1] && dropped[g] < samples_[slot].visible; ++i)
      dropped[g] += static_cast<std::uint32_t>(implicit::ballKernels().dropSamples(
          shape, implicit::dropBall(primitives[older[i] & 0xFFFFFFFF].shape), masksIn(slot)));
    samples_[slot].visible -= dropped[g];
  });
  surfelCount_ -= std::accumulate(dropped.begin(), dropped.end(), std::size_t{0});
}

void SurfelModel::remove(std::size_t first, std::size_t count, const Execution& execution) {
  RESTROKE_CHECK_LE(first, list_.size());
  RESTROKE_CHECK_LE(count, list_.size() - first);
  std::vector<implicit::Shape> shapes;
  for (std::size_t i = 0; i < count; ++i) {
    const PrimitiveId id = list_.idAt(first + i);
    shapes.push_back(list_[id].shape);
    Samples& own = samples_[PrimitiveList::slotOf(id)];
    surfelCount_ -= own.visible;
    masks_.giveBack(own.masks, own.patches);
    own = {};
  }
  list_.remove(first, count);
  // What was in a removed ball, or asked about it, is evaluated again.
  Edits now;
  Edits& edits = edits_ ? *edits_ : now;
  for (const implicit::Shape& shape : shapes) noteTouched(edits, shape, 0);
  if (!edits_) evaluateTouched(now, execution);
}

void SurfelModel::beginEdits() {
  RESTROKE_CHECK_EQ(edits_ != nullptr, false);
  edits_ = std::make_unique<Edits>();
}

void SurfelModel::endEdits(const Execution& execution) {
  RESTROKE_CHECK_EQ(edits_ != nullptr, true);
  const std::unique_ptr<Edits> edits = std::move(edits_);
  evaluateTouched(*edits, execution);
}

// Notes which primitives the shape touches: just before it comes, or just after it has gone, since what it
// hides is not on the lists in between (CrowdedCell). Of those with labels under `before`, samples can only
// go.
void SurfelModel::noteTouched(Edits& edits, const implicit::Shape& shape, PrimitiveList::Label before) {
  const std::size_t number = edits.balls.size();
  edits.balls.push_back(implicit::dropBall(shape));
  if (!shape.isSphere()) edits.shapes.push_back(shape);
  near_.gather(list_, edits.balls.back(), kWholeList, {.label = before});
  const std::uint32_t earlier = near_.arrays().earlier;
  for (std::size_t i = 0; i < near_.size(); ++i)
    if (i >= earlier || samples_[near_.slot(i)].visible != 0)
      edits.touched.push_back(std::uint64_t{near_.slot(i)} << 32 | number);
}

// Patches of one primitive that are evaluated with one look at what is near.
struct SurfelModel::Touch {
  std::uint32_t slot = 0;
  std::uint32_t block = kWhole;     // of 16 patches
  std::uint16_t bits = 0;           // of the block's patches
  std::size_t first = 0, last = 0;  // in Edits::touched
  static constexpr std::uint32_t kWhole = ~0u;
};

std::vector<SurfelModel::Touch> SurfelModel::touchesOf(const Edits& edits) const {
  std::vector<Touch> touches;
  for (std::size_t i = 0; i < edits.touched.size();) {
    const auto slot = static_cast<std::uint32_t>(edits.touched[i] >> 32);
    Touch touch{.slot = slot, .first = i};
    while (i < edits.touched.size() && edits.touched[i] >> 32 == slot) ++i;
    touch.last = i;
    if (samples_[slot].patches == 0) continue;  // gone since
    if (samples_[slot].patches <= kSmall)
      touches.push_back(touch);
    else
      touchBlocks(edits, touch, touches);
  }
  return touches;
}

// A large primitive block by block.
void SurfelModel::touchBlocks(const Edits& edits, const Touch& touch, std::vector<Touch>& touches) const {
  const SampledShape shape = shapeIn(touch.slot);
  std::vector<std::uint16_t> bits((samples_[touch.slot].patches + kPatch - 1) / kPatch, 0);
  for (std::size_t i = touch.first; i < touch.last; ++i) markTouched(shape, edits, edits.touched[i], bits);
  for (std::uint32_t block = 0; block < bits.size(); ++block)
    if (bits[block] != 0) touches.push_back({.slot = touch.slot, .block = block, .bits = bits[block]});
}

void SurfelModel::markTouched(const SampledShape& shape, const Edits& edits, std::uint64_t touched,
                              std::span<std::uint16_t> blocks) {
  const auto ball = static_cast<std::uint32_t>(touched);
  if (ball != kAllPatches) {
    implicit::ballKernels().touchedPatches(shape, edits.balls[ball], blocks.data());
    return;
  }
  const std::uint32_t patches = shape.tree->level[0].count;
  for (std::uint32_t p = 0; p < patches; ++p)
    blocks[p / kPatch] |= static_cast<std::uint16_t>(1u << p % kPatch);
}

std::ptrdiff_t SurfelModel::evaluateTouch(const Edits& edits, const Touch& touch, NearBalls& near) {
  const SampledShape shape = shapeIn(touch.slot);
  std::uint16_t bits[kSmall / kPatch] = {};
  const bool whole = touch.block == Touch::kWhole;
  if (whole)
    for (std::size_t i = touch.first; i < touch.last; ++i) markTouched(shape, edits, edits.touched[i], bits);
  else
    bits[0] = touch.bits;
  std::uint32_t patches[kSmall];
  std::size_t n = 0;
  for (std::uint32_t block = 0; block < std::size(bits); ++block)
    for (std::uint32_t rest = bits[block]; rest != 0; rest &= rest - 1)
      patches[n++] = (whole ? block : touch.block) * std::uint32_t{kPatch} +
                     static_cast<std::uint32_t>(std::countr_zero(rest));
  if (n == 0) return 0;
  const DropBall region = whole ? regionIn(touch.slot) : implicit::regionOfNode(shape, 1, touch.block);
  near.gatherShared(list_, region, kWholeList, placeOf(touch.slot));
  return implicit::ballKernels().evaluatePatches(shape, {patches, n}, near.arrays(), masksIn(touch.slot));
}

// Where very many primitives lie in one place, what is near is gathered for several at once
// (NearBalls::gatherShared), if they follow each other.
template <class Work>
void SurfelModel::orderInSpace(std::vector<Work>& work) const {
  if (!list_.clusters().crowded()) return;
  const float cell = list_.clusters().grids()[list_.clusters().finestInUse()].cell() * 0.03125f;
  std::vector<std::pair<std::uint64_t, std::size_t>> order;
  for (const Work& w : work) {
    const Point c = list_.balls()[w.slot].center;
    order.emplace_back(implicit::mortonCode(c * (1 / cell)), order.size());
  }
  std::sort(order.begin(), order.end());
  std::vector<Work> sorted;
  sorted.reserve(work.size());
  for (const auto& [code, i] : order) sorted.push_back(work[i]);
  work = std::move(sorted);
}

void SurfelModel::evaluateTouched(Edits& edits, const Execution& execution) {
  std::sort(edits.touched.begin(), edits.touched.end());
  std::vector<Touch> touches = touchesOf(edits);
  orderInSpace(touches);
  std::vector<std::ptrdiff_t> grown(touches.size());
  forEach(touches.size(), execution,
          [&](std::size_t i, NearBalls& near) { grown[i] = evaluateTouch(edits, touches[i], near); });
  for (std::size_t i = 0; i < grown.size(); ++i) {
    samples_[touches[i].slot].visible += static_cast<std::uint32_t>(grown[i]);
    surfelCount_ += static_cast<std::size_t>(grown[i]);
  }
}

std::vector<SurfelModel::Run> SurfelModel::runsOf(std::size_t first, std::size_t last) const {
  std::vector<Run> runs;
  runs.reserve(last - first);
  for (std::size_t i = first; i < last; ++i) {
    const std::uint32_t slot = PrimitiveList::slotOf(list_.idAt(i));
    const SampleTable& table = tableIn(slot);
    if (table.patches() <= kRunPatches) {
      runs.push_back({slot, table.tree().levels - 1, 0, true});
    } else {
      for (std::uint32_t node = 0; node < table.tree().level[1].count; ++node)
        runs.push_back({slot, 1, node, false});
    }
  }
  orderInSpace(runs);
  return runs;
}

void SurfelModel::evaluate(std::span<Run> runs, Prefix prefix, const Execution& execution) const {
  const PrimitiveList::Label end = list_.labelEnd(prefix);
  const implicit::BallKernels& kernels = implicit::ballKernels();
  const auto evaluateRun = [&](Run& run, NearBalls& near) {
    const SampledShape shape = shapeIn(run.slot);
    const DropBall region =
        run.whole ? regionIn(run.slot) : implicit::regionOfNode(shape, run.level, run.node);
    near.gatherShared(list_, region, end, placeOf(run.slot));
    const std::uint32_t first = run.whole ? 0 : run.node;
    const std::uint32_t last = run.whole ? shape.tree->level[run.level].count : run.node + 1;
    std::size_t visible = 0;
    for (std::uint32_t node = first; node < last; ++node)
      visible += kernels.evaluateNode(shape, run.level, node, near.arrays(), run.masks);
    run.visible = static_cast<std::uint32_t>(visible);
  };
  forEach(runs.size(), execution, [&](std::size_t i, NearBalls& near) { evaluateRun(runs[i], near); });
}

// Of primitives whose samples do not count yet.
void SurfelModel::evaluateInPlace(std::vector<Run> runs, const Execution& execution) {
  for (Run& run : runs) run.masks = masksIn(run.slot);
  evaluate(runs, {}, execution);
  for (const Run& run : runs) {
    samples_[run.slot].visible += run.visible;
    surfelCount_ += run.visible;
  }
}

void SurfelModel::rebuild(const Execution& execution) {
  for (Samples& s : samples_) s.visible = 0;
  surfelCount_ = 0;
  evaluateInPlace(runsOf(0, list_.size()), execution);
}

ModelBytes SurfelModel::bytes() const {
  return {.list = list_.bytes(),
          .clusters = list_.clusters().bytes(),
          .surfels = samples_.capacity() * sizeof(Samples) + masks_.bytes(),
          .scratch = near_.bytes(),
          .tables = implicit::bytesOfSphereSamples()};
}

}  // namespace restroke::points
