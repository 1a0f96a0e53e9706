#include "points/dexel/refine/refine.h"

#include <tbb/parallel_for.h>
#include <xxhash.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "implicit/errors.h"
#include "implicit/parallel.h"
#include "points/dexel/refine/collect.h"
#include "points/dexel/refine/model_cells.h"

namespace restroke::points {

namespace {

using Clock = std::chrono::steady_clock;

// Adds the time that f takes to `seconds`.
template <class F>
auto timed(double& seconds, const F& f) {
  const auto start = Clock::now();
  struct Stop {
    double& seconds;
    Clock::time_point start;
    ~Stop() { seconds += std::chrono::duration<double>(Clock::now() - start).count(); }
  } const stop{seconds, start};
  return f();
}

// What cells say of lines: inside in full ones, and with `upper` in all that are not empty.
Dexels approximation(const LinesInZone& lines, const ModelCells& cells, bool upper,
                     const Execution& execution) {
  Dexels out(lines.family.width, lines.family.height, {.operations = true});
  inArena(execution, [&] {
    tbb::parallel_for(0, lines.family.height, [&](int row) {
      LineEnds ends;
      for (int column = 0; column < lines.family.width; ++column) {
        const std::size_t line = out.lineAt(column, row);
        const float from = lines.from[line], to = lines.to[line];
        if (!(from < to)) continue;
        const Ray ray = lines.family.line(column, row);
        const PackedNormal along = packNormal(Vec3(ray.direction));
        ends.clear();
        cells.forStretches(ray, {static_cast<double>(from), static_cast<double>(to)},
                           [&](ModelCells::Kind kind, double enter, double exit) {
                             using Kind = ModelCells::Kind;
                             if (kind != Kind::Full && (!upper || kind == Kind::Empty)) return;
                             const auto begin = static_cast<float>(enter),
                                        end = std::min(static_cast<float>(exit), to);
                             if (!(begin < end)) return;
                             // Neighbouring stretches are one.
                             if (!ends.empty() && ends.back().depth == begin)
                               ends.pop_back();
                             else
                               ends.push_back({begin, turnedAround(along)});
                             ends.push_back({end, along});
                           });
        out.write(line, ends);
      }
    });
  });
  return out;
}

void refuse(const TriDexel& model, RefineMethod method) {
  for (int axis = 0; axis < 3; ++axis) {
    if ((method == RefineMethod::Ends || method == RefineMethod::Document) &&
        !model.family(axis).keepsOperations())
      throw InputError(fmt::format(
          "the model's ends do not say which operations made them; they must for the method \"{}\"",
          nameOf(method)));
    if (method == RefineMethod::Touching && !model.family(axis).keepsHistory())
      throw InputError(
          "the model's lines do not keep which operations changed them; they must for the method "
          "\"touching\"");
  }
}

// The document's: whether there are only removals, only additions, or both.
struct Sorts {
  bool adds = false, removes = false;
};
Sorts sortsOf(const TriDexelDocument& document, const std::vector<OperationId>& ids) {
  Sorts sorts;
  for (const OperationId id : ids) {
    if (id == OperationId::Initial) continue;
    const auto operation = document.operations[static_cast<std::size_t>(id) - 1].operation;
    (operation == DexelOperation::Union ? sorts.adds : sorts.removes) = true;
  }
  return sorts;
}

class Refinement {
 public:
  Refinement(const RefineSource& source, const Zone& zone, const RefineOptions& options)
      : document_(source.document),
        history_(source.history),
        zone_(zone),
        options_(options),
        replay_(options.replayer ? options.replayer : replay) {}

  RefinedModel run(const std::vector<LineFamily>& families, const Execution& execution) {
    out_.ids = timed(out_.times.collect, [&] { return collect(); });
    const bool asksCells = options_.method == RefineMethod::Document ||
                           (options_.method == RefineMethod::Ends && options_.corrected);
    std::optional<ModelCells> cells;
    if (asksCells)
      timed(out_.times.approximate, [&] { cells.emplace(document_.model, zone_.bounds(), execution); });
    for (const LineFamily& family : families) {
      RefinedFamily refined;
      timed(out_.times.replay, [&] { refined.lines = linesInZone(family, zone_, execution); });
      if (options_.method == RefineMethod::Document)
        refined.dexels = byDocument(refined.lines, *cells, execution);
      else if (options_.method == RefineMethod::All && options_.plain)
        timed(out_.times.replay,
              [&] { refined.dexels = replayPlainly({history_, out_.ids}, refined.lines, execution); });
      else
        refined.dexels = replayed(refined.lines, cells ? &*cells : nullptr, execution);
      out_.families.push_back(std::move(refined));
    }
    return std::move(out_);
  }

 private:
  [[nodiscard]] std::vector<OperationId> collect() const {
    const TriDexel& model = document_.model;
    switch (options_.method) {
      case RefineMethod::Document:
        return referencesIn(model, zone_, EndReferences::Trimming, history_.idCount());
      case RefineMethod::Ends:
        return referencesIn(model, zone_.widened(options_.widening * model.grid().cell()),
                            EndReferences::Both, history_.idCount());
      case RefineMethod::Touching: {
        std::vector<OperationId> ids = changesIn(document_, zone_, history_);
        if (ids.empty() || ids.front() != OperationId::Initial) ids.insert(ids.begin(), OperationId::Initial);
        return ids;
      }
      case RefineMethod::Clusters:
        return history_.idsByClusters(zone_);
      case RefineMethod::All:
        break;
    }
    if (!options_.plain) return history_.idsByBounds(zone_);
    std::vector<OperationId> ids(history_.idCount());
    for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = static_cast<OperationId>(i);
    return ids;
  }

  [[nodiscard]] Dexels replayed(const LinesInZone& lines, const ModelCells* known,
                                const Execution& execution) {
    return timed(out_.times.replay,
                 [&] { return replay_({history_, out_.ids, {.known = known}}, lines, execution); });
  }

  [[nodiscard]] Dexels byDocument(const LinesInZone& lines, const ModelCells& cells,
                                  const Execution& execution) {
    const Sorts sorts = sortsOf(document_, out_.ids);
    const bool upper = sorts.removes && !sorts.adds;
    Dexels start =
        timed(out_.times.approximate, [&] { return approximation(lines, cells, upper, execution); });
    return timed(out_.times.replay, [&] {
      std::span<const OperationId> ids = out_.ids;
      if (upper && !ids.empty() && ids.front() == OperationId::Initial) {
        // Of the upper approximation only what the initial solid holds.
        start = both(start, replay_({history_, ids.first(1), {}}, lines, execution));
        ids = ids.subspan(1);
      }
      return replay_({history_, ids, {.start = &start}}, lines, execution);
    });
  }

  // What is in both; where the second one ends, its ends stay.
  [[nodiscard]] static Dexels both(const Dexels& approximation, Dexels solid) {
    LineEnds rough, ends;
    std::vector<ToolSpan> spans;
    for (std::size_t line = 0; line < solid.lineCount(); ++line) {
      if (solid.isEmpty(line)) continue;
      approximation.read(line, rough);
      solid.read(line, ends);
      spans.clear();
      for (std::size_t i = 0; i < rough.size(); i += 2)
        spans.push_back({rough[i].depth, rough[i + 1].depth, rough[i].normal & ~kPackedFlag,
                         rough[i + 1].normal & ~kPackedFlag});
      if (applyToLine(ends, spans, DexelOperation::Intersection, OperationId::None)) solid.write(line, ends);
    }
    return solid;
  }

  const TriDexelDocument& document_;
  const DexelHistory& history_;
  const Zone& zone_;
  const RefineOptions& options_;
  LineReplayer replay_;
  RefinedModel out_;
};

}  // namespace

std::string_view nameOf(RefineMethod method) {
  switch (method) {
    case RefineMethod::Document:
      return "document";
    case RefineMethod::Ends:
      return "ends";
    case RefineMethod::Touching:
      return "touching";
    case RefineMethod::Clusters:
      return "clusters";
    case RefineMethod::All:
      break;
  }
  return "all";
}

std::optional<double> RefinedModel::volume() const {
  double sum = 0;
  for (const RefinedFamily& family : families) {
    const LineFamily& lines = family.lines.family;
    if (lines.directionStep != DVec3(0) || lines.directionRowStep != DVec3(0)) return std::nullopt;
    sum += family.dexels.totalLength() * length(cross(lines.originStep, lines.originRowStep));
  }
  if (families.empty()) return std::nullopt;
  return sum / static_cast<double>(families.size());
}

namespace {

// From the model's frame into the grid's.
void turnNormals(Dexels& dexels, const ZoneGrid& grid) {
  LineEnds ends;
  for (std::size_t line = 0; line < dexels.lineCount(); ++line) {
    if (dexels.isEmpty(line)) continue;
    dexels.read(line, ends);
    for (SpanEnd& end : ends) {
      const DVec3 n(unpackNormal(end.normal));
      const Vec3 turned(DVec3(dot(grid.axes[0], n), dot(grid.axes[1], n), dot(grid.axes[2], n)));
      end.normal = packNormal(turned) | (end.normal & kPackedFlag);
    }
    dexels.write(line, ends);
  }
}

}  // namespace

std::uint64_t stateHash(const RefinedModel& refined) {
  static_assert(sizeof(SpanEnd) == 16);
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                              XXH3_freeState);
  XXH3_64bits_reset(state.get());
  LineEnds ends;
  for (const RefinedFamily& family : refined.families) {
    const std::int32_t size[2] = {family.dexels.width(), family.dexels.height()};
    XXH3_64bits_update(state.get(), size, sizeof size);
    for (std::size_t line = 0; line < family.dexels.lineCount(); ++line) {
      family.dexels.read(line, ends);
      const auto count = static_cast<std::uint32_t>(ends.size());
      XXH3_64bits_update(state.get(), &count, sizeof count);
      XXH3_64bits_update(state.get(), ends.data(), ends.size() * sizeof(SpanEnd));
    }
  }
  return XXH3_64bits_digest(state.get());
}

TriDexel modelOn(const ZoneGrid& grid, RefinedModel refined) {
  RESTROKE_CHECK_EQ(refined.families.size(), 3u);
  TriDexel out(grid.grid);
  for (int axis = 0; axis < 3; ++axis) {
    Dexels& dexels = refined.families[static_cast<std::size_t>(axis)].dexels;
    RESTROKE_CHECK_EQ(
        dexels.width() == out.family(axis).width() && dexels.height() == out.family(axis).height(), true);
    out.family(axis) = std::move(dexels);
    if (grid.isTurned()) turnNormals(out.family(axis), grid);
  }
  return out;
}

RefinedModel refine(const RefineSource& source, const RefineTarget& target, const RefineOptions& options,
                    const Execution& execution) {
  refuse(source.document.model, options.method);
  if (!(std::isfinite(options.widening) && options.widening >= 0 && options.widening <= kMostLines))
    throw InputError(fmt::format("the zone is to be widened by {} cells; it must be 0 to {}",
                                 options.widening, kMostLines));
  return Refinement(source, target.zone, options).run(target.lines, execution);
}

}  // namespace restroke::points
