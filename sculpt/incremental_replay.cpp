// The shape at the cursor, made of the one that stands: after an edit of the tree, or a jump of the cursor,
// the old and the new sequence of nodes are matched; what is gone is taken off the list, what is new is
// applied, and what stays is cast anew if it read a place where something has changed before it (DESIGN
// invariant 6). Strokes whose stamps come out the same end the cascade there.

#include <algorithm>
#include <optional>
#include <utility>

#include "implicit/errors.h"
#include "sculpt/document.h"

namespace restroke::sculpt {

namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// For each node of `target` from `same` on, where it stands in `old`, or kNone: as many as can be matched in
/// order. Longest increasing subsequence by patience sorting.
std::vector<std::size_t> matchInOrder(const std::vector<PlacedNode>& old, const std::vector<NodeId>& target,
                                      std::size_t same) {
  std::vector<std::size_t> match(target.size() - same, kNone);
  std::size_t oldEnd = old.size(), targetEnd = target.size();
  while (oldEnd > same && targetEnd > same && old[oldEnd - 1].node == target[targetEnd - 1])
    match[--targetEnd - same] = --oldEnd;

  std::vector<std::pair<NodeId, std::size_t>> places;  // of what is left of `old`, by node
  for (std::size_t i = same; i < oldEnd; ++i) places.emplace_back(old[i].node, i);
  std::sort(places.begin(), places.end());
  struct Pile {
    std::size_t place, target;
  };
  std::vector<Pile> tops;  // of the piles: the lowest last place of each length
  std::vector<std::size_t> before(targetEnd - same, kNone), placeOf(targetEnd - same, kNone);
  for (std::size_t t = same; t < targetEnd; ++t) {
    const auto found = std::lower_bound(places.begin(), places.end(), std::pair(target[t], std::size_t{0}));
    if (found == places.end() || found->first != target[t]) continue;
    const std::size_t place = placeOf[t - same] = found->second;
    const auto pile = std::lower_bound(tops.begin(), tops.end(), place,
                                       [](const Pile& p, std::size_t value) { return p.place < value; });
    if (pile != tops.begin()) before[t - same] = pile[-1].target;
    if (pile == tops.end())
      tops.push_back({place, t});
    else
      *pile = {place, t};
  }
  if (!tops.empty())
    for (std::size_t t = tops.back().target; t != kNone; t = before[t - same])
      match[t - same] = placeOf[t - same];
  return match;
}

}  // namespace

struct Document::Walk {
  const Consequences& recorded;
  CommandReport& report;
  std::size_t at = 1;                       // primitives before the place that was come to
  bool baseMoved = false;                   // the base is another one, or came here another way
  std::vector<ChangedPlaces> changes = {};  // before that place
};

void Document::realizeOr(const HistoryTree& before, const Consequences& recorded, CommandReport& report) {
  try {
    realize(recorded, report);
  } catch (...) {
    history_.restoreTree(before);
    realizeFromScratch();
    throw;
  }
}

void Document::realize(const Consequences& recorded, CommandReport& report) {
  const std::vector<NodeId> path = history_.pathTo(history_.cursor());
  const BaseChains::Base base = chains_.at(history_, path);
  std::vector<NodeId> target;
  target.reserve(path.size());
  for (const NodeId node : path)
    if (history_.kind(node) <= NodeKind::Fixed && !history_.tree().isCancelled(node)) target.push_back(node);

  std::vector<PlacedNode> old = std::exchange(placed_, {});
  placed_.reserve(target.size());
  Walk walk{recorded, report};
  model_.beginEdits();
  try {
    changeBase(walk, base);
    std::size_t same = 0;
    if (!walk.baseMoved) {
      for (; same < old.size() && same < target.size() && old[same].node == target[same]; ++same) {
        walk.at += old[same].count;
        placed_.push_back(std::move(old[same]));
      }
    }
    const std::vector<std::size_t> match = matchInOrder(old, target, same);
    std::size_t next = same;
    for (std::size_t t = same; t < target.size(); ++t) {
      const std::size_t place = match[t - same];
      if (place == kNone) {
        insertNode(walk, target[t]);
        continue;
      }
      for (; next < place; ++next) discard(walk, old[next]);
      keepNode(walk, std::move(old[next++]));
    }
    for (; next < old.size(); ++next) discard(walk, old[next]);
  } catch (...) {
    model_.endEdits(execution_);
    throw;
  }
  model_.endEdits(execution_);
}

void Document::realizeFromScratch() {
  model_.remove(0, model_.list().size(), execution_);
  placed_.clear();
  base_ = {{}, header_.base};
  const implicit::Primitive base{header_.base, implicit::Sign::Positive};
  model_.append({&base, 1}, execution_);
  CommandReport unread;
  realize({}, unread);
}

void Document::changeBase(Walk& walk, const BaseChains::Base& base) {
  if (base.history == base_.history) return;
  walk.baseMoved = true;
  if (base.shape != base_.shape) {
    ChangedPlaces change;
    change.add(base_.shape.ball());
    change.add(base.shape.ball());
    const implicit::Primitive primitive{base.shape, implicit::Sign::Positive};
    // Refuses a base that the model cannot hold before the old one is gone.
    model_.insert(0, {&primitive, 1}, execution_);
    model_.remove(1, 1, execution_);
    walk.changes.push_back(std::move(change));
  }
  base_ = base;
}

void Document::discard(Walk& walk, const PlacedNode& placed) {
  if (placed.count == 0) return;
  ChangedPlaces change;
  for (std::size_t i = 0; i < placed.count; ++i) change.add(model_.list().at(walk.at + i).shape.ball());
  model_.remove(walk.at, placed.count, execution_);
  walk.report.primitivesRemoved += placed.count;
  walk.changes.push_back(std::move(change));
}

void Document::insertNode(Walk& walk, NodeId node) {
  PlacedNode placed{.node = node};
  const Command command = history_.command(node);
  if (const auto* stroke = std::get_if<StrokeCommand>(&command)) {
    applyInPlace(walk, placed, *stroke);
  } else {
    replacePrimitives(walk, placed, primitivesOf(std::get<FixedCommand>(command)));
    history_.setResult(node, {.stamps = placed.count, .misses = 0});
  }
  walk.at += placed.count;
  placed_.push_back(std::move(placed));
}

void Document::keepNode(Walk& walk, PlacedNode placed) {
  // The bounds are at hand; the reads themselves lie elsewhere in memory, and most nodes are far from any
  // change.
  const auto mayTouch = [&](const ChangedPlaces& change) { return change.mayMeet(placed.readBounds); };
  const bool isNear = std::any_of(walk.changes.begin(), walk.changes.end(), mayTouch);
  const bool touched = (isNear || walk.baseMoved) && placed.reads &&
                       (placed.reads->everything() || (isNear && placed.reads->touchedBy(walk.changes)));
  if (touched) {
    ++walk.report.retargeted;
    const auto stroke = std::get<StrokeCommand>(history_.command(placed.node));
    if (applyInPlace(walk, placed, stroke)) ++walk.report.changed;
  }
  walk.at += placed.count;
  placed_.push_back(std::move(placed));
}

bool Document::applyInPlace(Walk& walk, PlacedNode& placed, const StrokeCommand& stroke) {
  const NodeId node = placed.node;
  const Recast* recorded = recastOf(node, walk.recorded);
  AppliedStroke applied = Evaluation(history_, chains_)
                              .apply(node, stroke, site(placed_, walk.at),
                                     {.former = placed.reads.get(),
                                      .recorded = recorded,
                                      .recompute = options_.recompute,
                                      .keepTrail = options_.keepTrails});
  store(node, applied);
  noteRecast(node, applied, recorded, walk.report);
  if (!applied.note.empty()) walk.report.notes.push_back(noteOf(node, applied));
  walk.report.misses += applied.outcome.misses;
  placed.setReads(std::move(applied.reads));
  const bool changed = replacePrimitives(walk, placed, primitivesOf(applied.outcome, stroke.brush));
  history_.setResult(node,
                     {.stamps = placed.count, .misses = static_cast<std::uint32_t>(applied.outcome.misses)});
  return changed;
}

bool Document::replacePrimitives(Walk& walk, PlacedNode& placed,
                                 std::span<const implicit::Primitive> primitives) {
  const implicit::PrimitiveList& list = model_.list();
  const std::size_t former = placed.count, common = std::min(former, primitives.size());
  std::size_t head = 0, tail = 0;
  while (head < common && list.at(walk.at + head) == primitives[head]) ++head;
  while (tail < common - head &&
         list.at(walk.at + former - 1 - tail) == primitives[primitives.size() - 1 - tail])
    ++tail;
  const std::size_t gone = former - head - tail, come = primitives.size() - head - tail;
  if (gone == 0 && come == 0) return false;
  ChangedPlaces change;
  for (std::size_t i = 0; i < gone; ++i) change.add(list.at(walk.at + head + i).shape.ball());
  for (std::size_t i = 0; i < come; ++i) change.add(primitives[head + i].shape.ball());
  // Refuses what the list cannot hold before anything is gone.
  model_.insert(walk.at + head, primitives.subspan(head, come), execution_);
  model_.remove(walk.at + head + come, gone, execution_);
  placed.count = static_cast<std::uint32_t>(primitives.size());
  walk.report.primitivesAdded += come;
  walk.report.primitivesRemoved += gone;
  walk.changes.push_back(std::move(change));
  return true;
}

std::string Document::noteOf(NodeId node, const AppliedStroke& applied) {
  return fmt::format("node {}: {}", indexOf(node), applied.note);
}

points::SurfelModel Document::replayedFromScratch() const {
  points::SurfelModel model({.density = header_.density}, clustersFor(header_));
  const implicit::Primitive base{base_.shape, implicit::Sign::Positive};
  model.append({&base, 1}, execution_);
  std::vector<PlacedNode> placed;
  retarget::KeptDiscs discs;
  for (const NodeId node : history_.pathTo(history_.cursor())) {
    if (history_.kind(node) > NodeKind::Fixed || history_.tree().isCancelled(node)) continue;
    const Command command = history_.command(node);
    std::vector<implicit::Primitive> primitives;
    if (const auto* stroke = std::get_if<StrokeCommand>(&command)) {
      const StrokeSite site{.model = model,
                            .before = placed,
                            .prefix = model.list().size(),
                            .base = base_.history,
                            .grid = header_.grid,
                            .execution = execution_,
                            .discs = &discs};
      primitives =
          primitivesOf(Evaluation(history_, chains_).apply(node, *stroke, site).outcome, stroke->brush);
    } else {
      primitives = primitivesOf(std::get<FixedCommand>(command));
    }
    model.append(primitives, execution_);
    placed.push_back({.node = node, .count = static_cast<std::uint32_t>(primitives.size())});
  }
  return model;
}

}  // namespace restroke::sculpt
