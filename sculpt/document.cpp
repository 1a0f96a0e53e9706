#include "sculpt/document.h"

#include <chrono>
#include <cmath>
#include <utility>

#include "implicit/errors.h"
#include "sculpt/base_change.h"

namespace restroke::sculpt {

namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

LogHeader validated(LogHeader header) {
  validate(header, "header");
  return header;
}

}  // namespace

void validate(const LogHeader& header, const std::string& where) {
  if (header.unit != "mm" && header.unit != "cm" && header.unit != "m")
    throw InputError(fmt::format("{}: unit is \"{}\", but must be mm, cm or m", where, header.unit));
  if (!std::isfinite(header.density) || !(header.density > 0))
    throw InputError(
        fmt::format("{}: density is {}, but must be finite and more than 0", where, header.density));
  int exponent = 0;
  if (!std::isfinite(header.grid) || !(header.grid > 0) || std::frexp(header.grid, &exponent) != 0.5f ||
      exponent < -39 || exponent > 11)
    throw InputError(
        fmt::format("{}: grid is {}, but must be a power of two from 2^-40 to 2^10", where, header.grid));
  if (!header.base.isSphere()) return;  // checked when it was posed
  const implicit::Sphere& base = header.base.ball();
  const float limit = kMaxCoordinate;
  for (const float value : {base.center.x, base.center.y, base.center.z})
    if (!(std::fabs(value) <= limit))
      throw InputError(fmt::format("{}: base.sphere.center holds {}, but coordinates must lie within +-{}",
                                   where, value, limit));
  if (!(base.radius > 0) || !(base.radius <= limit))
    throw InputError(fmt::format("{}: base.sphere.radius is {}, but must be more than 0 and at most {}",
                                 where, base.radius, limit));
}

implicit::ClusterOptions clustersFor(const LogHeader& header) {
  return {.cell = 0.2f * header.base.ball().radius};
}

std::vector<implicit::Primitive> primitivesOf(const FixedCommand& fixed) {
  std::vector<implicit::Primitive> primitives;
  primitives.reserve(fixed.size());
  for (const implicit::Sphere& stamp : fixed.stamps) primitives.push_back({stamp, signOf(fixed.mode)});
  for (const implicit::Shape& shape : fixed.shapes) primitives.push_back({shape, signOf(fixed.mode)});
  return primitives;
}

Document::Document(const LogHeader& header, DocumentOptions options, const Execution& execution)
    : header_(validated(header)),
      options_(options),
      execution_(execution),
      model_({.density = header.density}, clustersFor(header)),
      history_(options.history),
      chains_(header.base),
      base_{{}, header.base} {
  const implicit::Primitive base{header.base, implicit::Sign::Positive};
  model_.append({&base, 1}, execution_);
}

CommandReport Document::apply(const Command& command) {
  const auto start = Clock::now();
  CommandReport report;
  if (const auto* stroke = std::get_if<StrokeCommand>(&command))
    report = addStroke(*stroke);
  else if (const auto* fixed = std::get_if<FixedCommand>(&command))
    report = addFixed(*fixed);
  else if (isNode(command))
    report = addBaseChange(command);
  else
    report = edit(command);
  report.seconds = secondsSince(start);
  return report;
}

StrokeSite Document::site(std::span<const PlacedNode> before, std::size_t prefix) const {
  return {.model = model_,
          .before = before,
          .prefix = prefix,
          .base = base_.history,
          .grid = header_.grid,
          .execution = execution_,
          .discs = discs_.get()};
}

void Document::appendStamps(std::span<const implicit::Primitive> stamps) {
  if (!options_.timeStamps) {
    if (!stamps.empty()) model_.append(stamps, execution_);
    return;
  }
  const std::size_t before = model_.list().size();
  const std::size_t timesBefore = stampSeconds_.size();
  try {
    for (const implicit::Primitive& stamp : stamps) {
      const auto start = Clock::now();
      model_.append({&stamp, 1}, execution_);
      stampSeconds_.push_back(static_cast<float>(secondsSince(start)));
    }
  } catch (...) {
    model_.remove(before, model_.list().size() - before, execution_);
    stampSeconds_.resize(timesBefore);
    throw;
  }
}

AppliedStroke Document::appendStroke(NodeId node, const StrokeCommand& stroke, const Recast* recorded,
                                     CommandReport& report) {
  AppliedStroke applied =
      Evaluation(history_, chains_)
          .apply(node, stroke, site(placed_, model_.list().size()),
                 {.recorded = recorded, .recompute = options_.recompute, .keepTrail = options_.keepTrails});
  const std::vector<implicit::Primitive> primitives = primitivesOf(applied.outcome, stroke.brush);
  appendStamps(primitives);
  report.primitivesAdded = primitives.size();
  report.misses = applied.outcome.misses;
  report.pieces = applied.outcome.pieces;
  if (!applied.note.empty()) report.notes.push_back(applied.note);
  return applied;
}

CommandReport Document::addStroke(StrokeCommand stroke) {
  retarget::validate(stroke.stroke, "stroke");
  validate(stroke.brush, "stroke");
  CommandReport report;
  const Recast recorded{.outcome = std::move(stroke.outcome)};
  stroke.outcome.reset();
  AppliedStroke applied = appendStroke(kRootNode, stroke, recorded.outcome ? &recorded : nullptr, report);
  report.outcomeDiffers = recorded.outcome && *recorded.outcome != applied.outcome;
  report.node = history_.add(stroke, {.stamps = static_cast<std::uint32_t>(report.primitivesAdded),
                                      .misses = static_cast<std::uint32_t>(report.misses)});
  place(report.node, report.primitivesAdded, applied);
  return report;
}

CommandReport Document::addFixed(const FixedCommand& fixed) {
  CommandReport report;
  appendStamps(primitivesOf(fixed));
  report.primitivesAdded = fixed.size();
  report.pieces = fixed.size() == 0 ? 0 : 1;
  report.node = history_.add(fixed, {.stamps = static_cast<std::uint32_t>(fixed.size()), .misses = 0});
  placed_.push_back({.node = report.node, .count = static_cast<std::uint32_t>(fixed.size())});
  return report;
}

void Document::place(NodeId node, std::size_t primitives, AppliedStroke& applied) {
  store(node, applied);
  placed_.push_back({.node = node, .count = static_cast<std::uint32_t>(primitives)});
  placed_.back().setReads(std::move(applied.reads));
}

void Document::store(NodeId node, AppliedStroke& applied) {
  if (options_.keepTrails) trails_[node] = std::move(applied.trail);
  if (applied.original) history_.setOriginal(node, applied.original);
  if (!applied.kept) return;
  KeptRecast kept = *applied.kept;
  kept.recast.node = node;
  history_.keepRecast(kept);
}

CommandReport Document::addBaseChange(const Command& command) {
  // Refuses what cannot be carried out before there is a node for it.
  if (const auto* transform = std::get_if<TransformCommand>(&command))
    (void)mappedShape(base_.shape, affineOf(transform->matrix), "transform");
  else
    implicit::validate({std::get<BaseCommand>(command).base, implicit::Sign::Positive});
  CommandReport report;
  const HistoryTree before = history_.tree();
  report.node = history_.add(command);
  realizeOr(before, *consequencesOf(command), report);
  return report;
}

CommandReport Document::edit(const Command& command) {
  CommandReport report;
  const Consequences* consequences = consequencesOf(command);
  const NodeId left = history_.cursor();
  const auto isStep = [&](NodeId node) {
    return history_.kind(node) == NodeKind::Stroke || history_.kind(node) == NodeKind::Fixed;
  };
  if (std::holds_alternative<UndoCommand>(command)) {
    if (!canUndo()) throw InputError(kNothingToUndo);
    report.node = left;
    if (isStep(left)) {
      undoStep(report);
      return report;
    }
  } else if (std::holds_alternative<RedoCommand>(command)) {
    if (!canRedo()) throw InputError(kNothingToRedo);
    report.node = history_.redoTarget(left);
    if (isStep(report.node)) {
      redoStep(*consequences, report);
      return report;
    }
  } else {
    report.node = std::visit(
        [](const auto& c) {
          if constexpr (requires { c.node; })
            return c.node;
          else
            return kRootNode;
        },
        command);
  }
  const HistoryTree before = history_.tree();
  history_.edit(command);
  // Copies lie ahead: nothing has become another shape.
  if (consequences) realizeOr(before, *consequences, report);
  return report;
}

void Document::undoStep(CommandReport& report) {
  if (!history_.tree().isCancelled(report.node)) {
    RESTROKE_CHECK_EQ(indexOf(placed_.back().node), indexOf(report.node));
    report.primitivesRemoved = placed_.back().count;
    if (report.primitivesRemoved > 0)
      model_.remove(model_.list().size() - report.primitivesRemoved, report.primitivesRemoved, execution_);
    placed_.pop_back();
  }
  history_.moveCursor(history_.parent(report.node));
}

void Document::redoStep(const Consequences& recorded, CommandReport& report) {
  if (!history_.tree().isCancelled(report.node)) {
    const Command command = history_.command(report.node);
    if (const auto* stroke = std::get_if<StrokeCommand>(&command)) {
      const Recast* recast = recastOf(report.node, recorded);
      AppliedStroke applied = appendStroke(report.node, *stroke, recast, report);
      noteRecast(report.node, applied, recast, report);
      place(report.node, report.primitivesAdded, applied);
    } else {
      const std::vector<implicit::Primitive> stamps = primitivesOf(std::get<FixedCommand>(command));
      appendStamps(stamps);
      report.primitivesAdded = stamps.size();
      report.pieces = stamps.empty() ? 0 : 1;
      placed_.push_back({.node = report.node, .count = static_cast<std::uint32_t>(stamps.size())});
    }
    history_.setResult(report.node, {.stamps = static_cast<std::uint32_t>(report.primitivesAdded),
                                     .misses = static_cast<std::uint32_t>(report.misses)});
  }
  history_.moveCursor(report.node);
}

const Recast* Document::recastOf(NodeId node, const Consequences& recorded) {
  for (const Recast& recast : recorded.recasts)
    if (recast.node == node) return &recast;
  return nullptr;
}

void Document::noteRecast(NodeId node, const AppliedStroke& applied, const Recast* recorded,
                          CommandReport& report) {
  if (!applied.kept || !applied.isNew) return;
  report.recasts.push_back(applied.kept->recast);
  Recast& recast = report.recasts.back();
  recast.node = node;
  report.outcomeDiffers = report.outcomeDiffers || (recorded && *recorded != recast);
}

std::vector<std::uint32_t> Document::nodeOfPrimitive() const {
  std::vector<std::uint32_t> nodes{0};
  nodes.reserve(model_.list().size());
  for (const PlacedNode& placed : placed_) nodes.insert(nodes.end(), placed.count, indexOf(placed.node));
  RESTROKE_CHECK_EQ(nodes.size(), model_.list().size());
  return nodes;
}

const retarget::Trail* Document::trailOf(NodeId node) const {
  const auto found = trails_.find(node);
  return found == trails_.end() || found->second.points.empty() ? nullptr : &found->second;
}

std::vector<Document::StrokePlaceOnList> Document::strokesOnList() const {
  std::vector<StrokePlaceOnList> strokes;
  std::size_t at = 1;
  for (const PlacedNode& placed : placed_) {
    if (history_.kind(placed.node) == NodeKind::Stroke) strokes.push_back({placed.node, at});
    at += placed.count;
  }
  return strokes;
}

std::size_t Document::cacheBytes() const {
  std::size_t bytes = placed_.capacity() * sizeof(PlacedNode);
  for (const PlacedNode& placed : placed_) bytes += placed.reads ? placed.reads->bytes() : 0;
  return bytes;
}

}  // namespace restroke::sculpt
