#include "sculpt/document.h"

#include <chrono>
#include <cmath>
#include <utility>

#include "implicit/errors.h"

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
      history_(options.history) {
  const implicit::Primitive base{header.base, implicit::Sign::Positive};
  model_.append({&base, 1}, execution_);
}

CommandReport Document::apply(const Command& command) {
  if (const auto* stroke = std::get_if<StrokeCommand>(&command)) return addStroke(*stroke);
  if (const auto* fixed = std::get_if<FixedCommand>(&command)) return addFixed(*fixed);
  return std::holds_alternative<UndoCommand>(command) ? undo() : redo();
}

StrokeOutcome Document::castStroke(const StrokeCommand& stroke) const {
  const auto caster = retarget::makeCaster(stroke.method, model_, stroke.stroke.camera, {}, execution_);
  return stampsAlong(stroke.stroke, stroke.brush, header_.grid, *caster);
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

CommandReport Document::addStroke(StrokeCommand stroke) {
  retarget::validate(stroke.stroke, "stroke");
  validate(stroke.brush, "stroke");
  const auto start = Clock::now();
  CommandReport report;
  StrokeOutcome outcome;
  if (stroke.outcome && !options_.recompute) {
    outcome = *stroke.outcome;
  } else {
    outcome = castStroke(stroke);
    report.outcomeDiffers = stroke.outcome && *stroke.outcome != outcome;
  }
  const std::vector<implicit::Primitive> primitives = primitivesOf(outcome, stroke.brush);
  appendStamps(primitives);
  report.primitivesAdded = primitives.size();
  report.misses = outcome.misses;
  report.pieces = outcome.pieces;
  // What this machine made is kept where another one could make something else.
  if (retarget::isDeterministic(stroke.method))
    stroke.outcome.reset();
  else
    stroke.outcome = std::move(outcome);
  report.node = history_.add(stroke, {.stamps = static_cast<std::uint32_t>(report.primitivesAdded),
                                      .misses = static_cast<std::uint32_t>(report.misses)});
  report.seconds = secondsSince(start);
  return report;
}

CommandReport Document::addFixed(const FixedCommand& fixed) {
  const auto start = Clock::now();
  CommandReport report;
  appendStamps(primitivesOf(fixed));
  report.primitivesAdded = fixed.size();
  report.pieces = fixed.size() == 0 ? 0 : 1;
  report.node = history_.add(fixed, {.stamps = static_cast<std::uint32_t>(fixed.size()), .misses = 0});
  report.seconds = secondsSince(start);
  return report;
}

CommandReport Document::undo() {
  if (!canUndo()) throw InputError(kNothingToUndo);
  const auto start = Clock::now();
  CommandReport report;
  report.node = history_.cursor();
  report.primitivesRemoved = history_.result(report.node).stamps;
  if (report.primitivesRemoved > 0)
    model_.remove(model_.list().size() - report.primitivesRemoved, report.primitivesRemoved, execution_);
  history_.moveCursor(history_.parent(report.node));
  report.seconds = secondsSince(start);
  return report;
}

CommandReport Document::redo() {
  if (!canRedo()) throw InputError(kNothingToRedo);
  const auto start = Clock::now();
  CommandReport report;
  report.node = history_.redoTarget(history_.cursor());
  const Command command = history_.command(report.node);
  if (const auto* stroke = std::get_if<StrokeCommand>(&command)) {
    const StrokeOutcome outcome = stroke->outcome ? *stroke->outcome : castStroke(*stroke);
    const std::vector<implicit::Primitive> primitives = primitivesOf(outcome, stroke->brush);
    appendStamps(primitives);
    report.primitivesAdded = primitives.size();
    report.misses = outcome.misses;
    report.pieces = outcome.pieces;
  } else {
    const std::vector<implicit::Primitive> stamps = primitivesOf(std::get<FixedCommand>(command));
    appendStamps(stamps);
    report.primitivesAdded = stamps.size();
    report.pieces = stamps.empty() ? 0 : 1;
  }
  history_.setResult(report.node, {.stamps = static_cast<std::uint32_t>(report.primitivesAdded),
                                   .misses = static_cast<std::uint32_t>(report.misses)});
  history_.moveCursor(report.node);
  report.seconds = secondsSince(start);
  return report;
}

std::vector<std::uint32_t> Document::nodeOfPrimitive() const {
  std::vector<std::uint32_t> nodes{0};
  nodes.reserve(model_.list().size());
  for (const NodeId node : history_.pathTo(history_.cursor()))
    nodes.insert(nodes.end(), history_.result(node).stamps, static_cast<std::uint32_t>(node));
  RESTROKE_CHECK_EQ(nodes.size(), model_.list().size());
  return nodes;
}

}  // namespace restroke::sculpt
