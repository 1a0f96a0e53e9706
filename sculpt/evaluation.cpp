#include "sculpt/evaluation.h"

#include <algorithm>
#include <utility>

#include "implicit/errors.h"
#include "retarget/anchors.h"
#include "sculpt/aligned_view.h"

namespace restroke::sculpt {

namespace {

using retarget::Method;

/// Finds primitives by the nodes that made them, and the other way round.
class ListOwners final : public retarget::Owners {
 public:
  explicit ListOwners(const StrokeSite& site) : list_(site.model.list()) {
    starts_.push_back({0, 0});
    std::size_t at = 1;
    for (const PlacedNode& placed : site.before) {
      if (at >= site.prefix) break;
      starts_.push_back({indexOf(placed.node), at});
      at += placed.count;
    }
    end_ = at;
    byNode_ = starts_;
    std::sort(byNode_.begin(), byNode_.end(), [](const Start& a, const Start& b) { return a.node < b.node; });
  }

  [[nodiscard]] std::optional<implicit::Primitive> find(retarget::OwnerKey owner) const override {
    const auto found = std::lower_bound(byNode_.begin(), byNode_.end(), owner.node,
                                        [](const Start& s, std::uint32_t node) { return s.node < node; });
    if (found == byNode_.end() || found->node != owner.node) return std::nullopt;
    const std::size_t position = found->position + owner.index;
    const auto own = std::upper_bound(starts_.begin(), starts_.end(), found->position,
                                      [](std::size_t p, const Start& s) { return p < s.position; });
    const std::size_t end = own == starts_.end() ? end_ : own->position;
    return position < end ? std::optional(list_.at(position)) : std::nullopt;
  }

  [[nodiscard]] retarget::OwnerKey keyOf(implicit::PrimitiveId id) const {
    const std::size_t position = list_.positionOf(id);
    const auto next = std::upper_bound(starts_.begin(), starts_.end(), position,
                                       [](std::size_t p, const Start& s) { return p < s.position; });
    const Start& start = next[-1];
    return {start.node, static_cast<std::uint32_t>(position - start.position)};
  }

 private:
  struct Start {
    std::uint32_t node;
    std::size_t position;
  };
  const implicit::PrimitiveList& list_;
  std::vector<Start> starts_, byNode_;
  std::size_t end_ = 1;
};

retarget::CasterInput inputFor(const StrokeCommand& stroke, const StrokeSite& site) {
  return {.model = site.model,
          .camera = stroke.stroke.camera,
          .prefix = {site.prefix},
          .execution = site.execution,
          .discs = site.discs};
}

std::uint64_t shapeBefore(const StrokeSite& site) {
  return points::listHash(site.model.list(), {site.prefix});
}

/// The map that the base went through since the original, where both stand on the same one.
std::optional<Affine> mapBetween(const BaseHistory& original, const BaseHistory& now) {
  if (original.node != now.node) return std::nullopt;
  if (original.since == now.since) return Affine{};
  return composed(now.since, inverse(original.since));
}

}  // namespace

AppliedStroke Evaluation::cast(const StrokeCommand& stroke, const retarget::CasterInput& input,
                               const StrokeSite& site, const Shortcuts& shortcuts) const {
  const auto caster = retarget::makeCaster(stroke.method, input);
  ReadingCaster reading(*caster, shortcuts.former);
  retarget::TrailRecorder recorder(reading);
  retarget::Caster& asked = shortcuts.keepTrail ? static_cast<retarget::Caster&>(recorder) : reading;
  AppliedStroke applied;
  applied.outcome = stampsAlong(stroke.stroke, stroke.brush, site.grid, asked);
  if (shortcuts.keepTrail) applied.trail = recorder.take();
  applied.reads = std::make_unique<StrokeReads>(reading.take());
  return applied;
}

AppliedStroke Evaluation::apply(NodeId node, const StrokeCommand& stroke, const StrokeSite& site,
                                const Shortcuts& shortcuts) const {
  if (retarget::needsTrail(stroke.method)) {
    if (node == kRootNode || !history_.original(node)) return first(stroke, site, shortcuts);
    return follow(node, stroke, site, shortcuts);
  }
  if (!retarget::isDeterministic(stroke.method)) return recordedOrCast(node, stroke, site, shortcuts);
  return cast(stroke, inputFor(stroke, site), site, shortcuts);
}

AppliedStroke Evaluation::first(const StrokeCommand& stroke, const StrokeSite& site,
                                const Shortcuts& shortcuts) const {
  const auto caster = retarget::makeCaster(stroke.method, inputFor(stroke, site));
  retarget::TrailRecorder recorder(*caster);
  AppliedStroke applied;
  applied.outcome = stampsAlong(stroke.stroke, stroke.brush, site.grid, recorder);
  // The next time it is another caster that is asked, about anything that has changed.
  applied.reads = std::make_unique<StrokeReads>(StrokeReads::ofEverything());
  retarget::Trail trail = recorder.take();
  if (shortcuts.keepTrail) applied.trail = trail;
  auto original = std::make_shared<Original>();
  original->shapeBefore = shapeBefore(site);
  original->base = site.base;
  if (stroke.method != Method::Mapped) original->trail = std::move(trail);
  if (stroke.method == Method::Surface) {
    const ListOwners owners(site);
    retarget::setAnchors(original->trail, site.model.list(),
                         [&](implicit::PrimitiveId id) { return owners.keyOf(id); });
  }
  if (stroke.method == Method::Aligned) {
    original->patch = patchBefore(original->trail, stroke.brush, site);
    original->trail = {};
  }
  original->trail.points.shrink_to_fit();
  applied.original = std::move(original);
  return applied;
}

AppliedStroke Evaluation::follow(NodeId node, const StrokeCommand& stroke, const StrokeSite& site,
                                 const Shortcuts& shortcuts) const {
  const std::shared_ptr<const Original> original = history_.original(node);
  retarget::CasterInput input = inputFor(stroke, site);
  // On the shape that it was drawn on, the stroke is where it was drawn.
  const bool asDrawn = original->base == site.base && original->shapeBefore == shapeBefore(site);
  if (!asDrawn && stroke.method == Method::Aligned) return aligned(node, stroke, site, shortcuts);
  const std::optional<Affine> affine = mapBetween(original->base, site.base);
  const AffineMap map(affine.value_or(Affine{}));
  const ListOwners owners(site);
  if (!asDrawn) {
    input.change = {.original = &original->trail, .owners = &owners};
    if (affine) input.change.map = &map;
  }
  AppliedStroke applied = cast(stroke, input, site, {.keepTrail = shortcuts.keepTrail});
  if (stroke.method == Method::Fixed)
    applied.reads = std::make_unique<StrokeReads>();
  else
    applied.reads = std::make_unique<StrokeReads>(StrokeReads::ofEverything());
  return applied;
}

AppliedStroke Evaluation::recordedOrCast(NodeId node, const StrokeCommand& stroke, const StrokeSite& site,
                                         const Shortcuts& shortcuts) const {
  AppliedStroke applied;
  applied.reads = std::make_unique<StrokeReads>(StrokeReads::ofEverything());
  const std::uint64_t before = shapeBefore(site);
  const auto use = [&](const StrokeOutcome& outcome) {
    applied.outcome = outcome;
    applied.kept = KeptRecast{before, {.node = node, .outcome = outcome}};
  };
  if (!shortcuts.recompute) {
    if (shortcuts.recorded && shortcuts.recorded->outcome) {
      use(*shortcuts.recorded->outcome);
      return applied;
    }
    if (node != kRootNode)
      if (const auto kept = history_.keptRecast(node);
          kept && kept->shapeBefore == before && kept->recast.outcome) {
        use(*kept->recast.outcome);
        return applied;
      }
  }
  AppliedStroke made = cast(stroke, inputFor(stroke, site), site, {.keepTrail = shortcuts.keepTrail});
  use(made.outcome);
  applied.trail = std::move(made.trail);
  applied.isNew = true;
  return applied;
}

AppliedStroke Evaluation::aligned(NodeId node, const StrokeCommand& stroke, const StrokeSite& site,
                                  const Shortcuts& shortcuts) const {
  const std::uint64_t before = shapeBefore(site);
  std::optional<Recast> recast;
  bool isNew = false;
  std::string note;
  if (!shortcuts.recompute) {
    if (shortcuts.recorded && shortcuts.recorded->camera) recast = *shortcuts.recorded;
    if (!recast)
      if (const auto kept = history_.keptRecast(node);
          kept && kept->shapeBefore == before && kept->recast.camera)
        recast = kept->recast;
  }
  if (!recast) {
    const AlignedView view = alignedView(*history_.original(node), stroke, site, {history_, bases_});
    recast = Recast{.node = node, .camera = view.camera, .scale = view.scale};
    note = view.note;
    isNew = true;
  }
  recast->node = node;
  retarget::CasterInput input = inputFor(stroke, site);
  input.camera = *recast->camera;
  input.change.scale = recast->scale;
  AppliedStroke applied = cast(stroke, input, site, {.keepTrail = shortcuts.keepTrail});
  applied.reads = std::make_unique<StrokeReads>(StrokeReads::ofEverything());
  applied.kept = KeptRecast{before, *recast};
  applied.isNew = isNew;
  applied.note = std::move(note);
  return applied;
}

}  // namespace restroke::sculpt
