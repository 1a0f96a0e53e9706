// Which samples of a prefix are surfels, without laying them out.

#include <algorithm>

#include "points/surfel_model.h"

namespace restroke::points {

using implicit::Prefix;
using implicit::PrimitiveList;

// The masks of the prefix's primitives as a list of only these would have them: by slot, kept in `room`.
std::vector<std::uint16_t*> SurfelModel::evaluatePrefix(Prefix prefix, std::vector<std::uint16_t>& room,
                                                        const Execution& execution) const {
  std::vector<Run> runs = runsOf(0, prefix.count);
  std::size_t patches = 0;
  for (std::size_t i = 0; i < prefix.count; ++i)
    patches += samples_[PrimitiveList::slotOf(list_.idAt(i))].patches;
  room.resize(patches);
  std::vector<std::uint16_t*> masks(samples_.size(), nullptr);
  std::uint16_t* next = room.data();
  for (std::size_t i = 0; i < prefix.count; ++i) {
    const std::uint32_t slot = PrimitiveList::slotOf(list_.idAt(i));
    masks[slot] = next;
    next += samples_[slot].patches;
  }
  for (Run& run : runs) run.masks = masks[run.slot];
  evaluate(runs, prefix, execution);
  return masks;
}

VisibleSamples SurfelModel::visibleSamples(Prefix prefix, const Execution& execution) const {
  const bool known = prefix.count >= list_.size() && !edits_;
  prefix.count = std::min(prefix.count, list_.size());
  VisibleSamples visible;
  std::vector<std::uint16_t*> masks;
  if (!known) masks = evaluatePrefix(prefix, visible.room, execution);
  visible.of.reserve(prefix.count);
  for (std::size_t i = 0; i < prefix.count; ++i) {
    const std::uint32_t slot = PrimitiveList::slotOf(list_.idAt(i));
    visible.of.emplace_back(known ? masksIn(slot) : masks[slot], samples_[slot].patches);
  }
  return visible;
}

}  // namespace restroke::points
