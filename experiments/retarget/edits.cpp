#include "experiments/retarget/edits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <variant>

#include "experiments/retarget/drawing.h"
#include "experiments/retarget/trials.h"
#include "retarget/alignment.h"
#include "retarget/anchors.h"
#include "retarget/measures.h"
#include "sculpt/document.h"

namespace restroke::experiments {
namespace {

using retarget::Method;
using retarget::OwnerKey;

/// A list that strokes are put on one after another, with where its primitives come from.
class Sculpture final : public retarget::Owners {
 public:
  Sculpture(const implicit::Shape& base, const sculpt::LogHeader& header, const Execution& execution)
      : execution_(execution), model_({.density = header.density}, sculpt::clustersFor(header)) {
    const implicit::Primitive primitive{base, implicit::Sign::Positive};
    model_.append({&primitive, 1}, execution_);
    owners_.push_back({});
    runs_[0] = {0, 1};
  }
  [[nodiscard]] const points::SurfelModel& model() const { return model_; }
  [[nodiscard]] OwnerKey ownerOf(implicit::PrimitiveId id) const {
    return owners_[model_.list().positionOf(id)];
  }
  void append(std::uint32_t node, std::span<const implicit::Primitive> primitives) {
    if (!primitives.empty()) model_.append(primitives, execution_);
    runs_[node] = {owners_.size(), primitives.size()};
    for (std::uint32_t i = 0; i < primitives.size(); ++i) owners_.push_back({node, i});
  }
  [[nodiscard]] std::optional<implicit::Primitive> find(OwnerKey owner) const override {
    const auto run = runs_.find(owner.node);
    if (run == runs_.end() || owner.index >= run->second.count) return std::nullopt;
    return model_.list().at(run->second.first + owner.index);
  }

 private:
  Execution execution_;
  points::SurfelModel model_;
  struct Run {
    std::size_t first = 0, count = 0;
  };
  std::vector<OwnerKey> owners_;       // by position
  std::map<std::uint32_t, Run> runs_;  // of each node
};

/// One stroke of the log as it was.
struct Recorded {
  const sculpt::StrokeCommand* command = nullptr;
  retarget::Trail trail;
  std::vector<retarget::OrientedPoint> before;  // the surfels that it was drawn on
};

struct Edit {
  std::string name, kind;
  implicit::Shape base;
  std::vector<std::size_t> order;  // strokes of the log, in their new order
  std::size_t unchanged = 0;       // of them, at the beginning
};

std::vector<Edit> editsOf(std::size_t strokes, const implicit::Shape& base,
                          std::span<const RetargetBase> bases) {
  std::vector<Edit> edits;
  std::vector<std::size_t> all(strokes);
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::set<std::size_t> cancelled{0, strokes / 4, strokes / 2, 3 * strokes / 4};
  for (const std::size_t k : cancelled) {
    if (k + 1 >= strokes) continue;
    Edit edit{fmt::format("cancel {}", k + 1), "cancel", base, all, k};
    edit.order.erase(edit.order.begin() + static_cast<std::ptrdiff_t>(k));
    edits.push_back(std::move(edit));
  }
  if (strokes >= 2) {
    const std::size_t k = strokes / 2 - 1;
    Edit edit{fmt::format("exchange {} and {}", k + 1, k + 2), "reorder", base, all, k};
    std::swap(edit.order[k], edit.order[k + 1]);
    edits.push_back(std::move(edit));
  }
  for (const RetargetBase& each : bases) {
    const double size = static_cast<double>(each.shape.ball().radius);
    const double factor = static_cast<double>(base.ball().radius) / size;
    edits.push_back(
        {"base " + each.name, "base",
         similarTo(each.shape, factor, DVec3(base.ball().center) - factor * DVec3(each.shape.ball().center)),
         all, 0});
  }
  return edits;
}

/// What is left of a stroke after an edit.
RetargetEdit measuredEdit(const Recorded& stroke, const points::SurfelModel& model,
                          const retarget::Trail& found) {
  const retarget::StrokeObservations seen = retarget::observe(
      {.result = found, .original = &stroke.trail, .camera = stroke.command->stroke.camera});
  const retarget::Measures m = retarget::summarise({&seen, 1});
  RetargetEdit row;
  row.places = seen.expected;
  row.lost = seen.expected > 0 ? m.missRate : 0;
  row.surface = offSurface(found, retarget::SurfaceDistance(model)).rms /
                (2 * static_cast<double>(model.list().bounds().halfDiagonal()));
  row.drift = m.driftRms;
  row.stretch = m.stretchMedian;
  return row;
}

struct Replay {
  const EditSubject& subject;
  const std::vector<Recorded>& strokes;
  const RetargetOptions& options;
  const Execution& execution;
};

void replay(const Replay& replay, const Edit& edit, Method method, RetargetResults& results) {
  Sculpture sculpture(edit.base, replay.subject.log.header, replay.execution);
  for (std::size_t i = 0; i < edit.order.size(); ++i) {
    const std::size_t number = edit.order[i];
    const Recorded& stroke = replay.strokes[number];
    const sculpt::StrokeCommand& command = *stroke.command;
    const bool changed = i >= edit.unchanged;
    retarget::CasterInput input{.model = sculpture.model(),
                                .camera = command.stroke.camera,
                                .execution = replay.execution,
                                .change = {.original = &stroke.trail, .owners = &sculpture}};
    Method by = changed ? method : Method::Exact;
    bool fellBack = false;
    if (by == Method::Aligned) {
      const auto after = retarget::orientedPoints(sculpture.model().surfels(replay.execution));
      const retarget::Alignment found = retarget::alignSurfels(
          stroke.before, after, {.points = replay.options.alignmentPoints, .seed = replay.options.seed});
      fellBack = found.verdict != retarget::AlignmentVerdict::Found;
      if (fellBack) {
        by = Method::Exact;
      } else {
        input.camera = moved(found.motion, input.camera);
        input.change.scale = static_cast<float>(found.motion.scale);
      }
    }
    const auto caster = retarget::makeCaster(by, input);
    if (changed) {
      RetargetEdit row = measuredEdit(stroke, sculpture.model(), castAt(stroke.trail, *caster));
      row.log = replay.subject.name;
      row.edit = edit.name;
      row.kind = edit.kind;
      row.stroke = number;
      row.method = method;
      row.fellBack = fellBack;
      results.edits.push_back(row);
    }
    const auto outcome =
        sculpt::stampsAlong(command.stroke, command.brush, replay.subject.log.header.grid, *caster);
    sculpture.append(static_cast<std::uint32_t>(number + 1), sculpt::primitivesOf(outcome, command.brush));
  }
}

}  // namespace

void measureEdits(const EditSubject& subject, std::span<const RetargetBase> bases,
                  const RetargetOptions& options, const Execution& execution, RetargetResults& results) {
  std::vector<Recorded> strokes;
  Sculpture original(subject.log.header.base, subject.log.header, execution);
  for (const sculpt::Command& command : subject.log.commands) {
    const auto* each = std::get_if<sculpt::StrokeCommand>(&command);
    if (each == nullptr || (options.logStrokes != 0 && strokes.size() == options.logStrokes)) continue;
    Recorded stroke{.command = each, .trail = {}, .before = {}};
    stroke.before = retarget::orientedPoints(original.model().surfels(execution));
    const auto caster = retarget::makeCaster(Method::Exact, original.model(), each->stroke.camera);
    retarget::TrailRecorder recorder(*caster);
    const auto outcome = sculpt::stampsAlong(each->stroke, each->brush, subject.log.header.grid, recorder);
    stroke.trail = recorder.take();
    retarget::setAnchors(stroke.trail, original.model().list(),
                         [&](implicit::PrimitiveId id) { return original.ownerOf(id); });
    strokes.push_back(std::move(stroke));
    original.append(static_cast<std::uint32_t>(strokes.size()), sculpt::primitivesOf(outcome, each->brush));
  }
  const Replay all{subject, strokes, options, execution};
  for (const Edit& edit : editsOf(strokes.size(), subject.log.header.base, bases))
    for (const Method method : results.methods)
      // Without a known map it casts as `exact` does.
      if (method != Method::Mapped) replay(all, edit, method, results);
}

}  // namespace restroke::experiments
