#include "experiments/refine/differences.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "implicit/errors.h"
#include "implicit/parallel.h"

namespace restroke::experiments {
namespace {

using points::Dexels;
using points::LineEnds;
using points::OperationId;
using points::RefinedFamily;
using points::RefinedModel;
using points::SpanEnd;
using points::Surfel;

// Half of a cell's diagonal: discs of neighbours meet.
constexpr double kDiscOfCell = 0.71;
// A line is drawn where it meets the surface at least at half of the angle that the best of three families
// may have.
constexpr double kLeastCosine = 0.5;

bool isAtBorder(const points::LinesInZone& lines, std::size_t line, float depth) {
  return depth == lines.from[line] || depth == lines.to[line];
}

bool isOperation(OperationId id) {
  return id != OperationId::None && id != OperationId::Initial;
}

/// The operation that made an end: what is on the one side was there before what is on the other.
OperationId trimmerOf(const SpanEnd& end) {
  if (end.inner == OperationId::None) return end.outer;
  if (end.outer == OperationId::None) return end.inner;
  return std::max(end.inner, end.outer);
}

double spacingOf(const points::LineFamily& family) {
  return length(family.originStep);
}

/// f(family, line, column, row, ends of the line) for all lines that have ends.
template <class F>
void forLines(const RefinedModel& model, const F& f) {
  LineEnds ends;
  for (std::size_t k = 0; k < model.families.size(); ++k) {
    const RefinedFamily& family = model.families[k];
    for (int row = 0; row < family.dexels.height(); ++row)
      for (int column = 0; column < family.dexels.width(); ++column) {
        const std::size_t line = family.dexels.lineAt(column, row);
        if (family.dexels.isEmpty(line)) continue;
        family.dexels.read(line, ends);
        f(k, line, column, row, std::as_const(ends));
      }
  }
}

/// f(family, line, column, row, ends of the reference, ends of the judged model) for all lines on which one
/// of the two has any.
template <class F>
void forPairs(const RefinedModel& reference, const RefinedModel& judged, const F& f) {
  RESTROKE_CHECK_EQ(reference.families.size(), judged.families.size());
  LineEnds a, b;
  for (std::size_t k = 0; k < reference.families.size(); ++k) {
    const Dexels &first = reference.families[k].dexels, &second = judged.families[k].dexels;
    RESTROKE_CHECK_EQ(first.width(), second.width());
    RESTROKE_CHECK_EQ(first.height(), second.height());
    for (int row = 0; row < first.height(); ++row)
      for (int column = 0; column < first.width(); ++column) {
        const std::size_t line = first.lineAt(column, row);
        if (first.isEmpty(line) && second.isEmpty(line)) continue;
        first.read(line, a);
        second.read(line, b);
        f(k, line, column, row, std::as_const(a), std::as_const(b));
      }
  }
}

Surfel surfelAt(const RefinedModel& model, std::size_t family, int column, int row, const SpanEnd& end) {
  const points::LineFamily& lines = model.families[family].lines.family;
  const Ray ray = lines.line(column, row);
  Surfel surfel;
  surfel.position = Point(ray.at(static_cast<double>(end.depth)));
  surfel.normal = points::unpackNormal(end.normal);
  surfel.radius = static_cast<float>(kDiscOfCell * spacingOf(lines));
  return surfel;
}

/// Is it an end of the line, whatever else is known of it?
bool has(const LineEnds& ends, const SpanEnd& end, bool exit) {
  for (std::size_t i = exit ? 1 : 0; i < ends.size(); i += 2)
    if (ends[i].depth == end.depth) return true;
  return false;
}

/// Greatest distance from the places to the nearest surfel.
std::optional<double> farthest(const std::vector<Surfel>& places, const retarget::NearestSurfels& from,
                               const Execution& execution) {
  if (from.surfels().empty()) return std::nullopt;
  if (places.empty()) return 0;
  std::vector<double> distances(places.size());
  inArena(execution, [&] {
    tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
      const Point p = places[i].position;
      distances[i] = length(DVec3(from.surfels()[*from.nearest(p)].position) - DVec3(p));
    });
  });
  return *std::ranges::max_element(distances);
}

/// Those that a model has and another has not, line by line, within the zone; `all` gets all of the first.
struct EndsAlone {
  std::vector<Surfel> all, alone;
  void add(const RefinedModel& model, std::size_t family, int column, int row, const LineEnds& ends,
           const LineEnds& others) {
    const points::LinesInZone& lines = model.families[family].lines;
    const std::size_t line = model.families[family].dexels.lineAt(column, row);
    for (std::size_t i = 0; i < ends.size(); ++i) {
      if (isAtBorder(lines, line, ends[i].depth)) continue;
      all.push_back(surfelAt(model, family, column, row, ends[i]));
      if (!has(others, ends[i], i % 2 == 1)) alone.push_back(all.back());
    }
  }
};

}  // namespace

void findWrongStretches(std::span<const SpanEnd> reference, std::span<const SpanEnd> judged,
                        std::vector<WrongStretch>& stretches) {
  stretches.clear();
  std::size_t i = 0, j = 0;
  float from = 0;
  while (i < reference.size() || j < judged.size()) {
    const float to = i == reference.size() ? judged[j].depth
                     : j == judged.size()  ? reference[i].depth
                                           : std::min(reference[i].depth, judged[j].depth);
    // An odd number of ends before a place: it is inside.
    const bool inReference = i % 2 == 1, inJudged = j % 2 == 1;
    if (inReference != inJudged && from < to) {
      if (!stretches.empty() && stretches.back().to == from && stretches.back().extra == inJudged)
        stretches.back().to = to;
      else
        stretches.push_back({from, to, inJudged});
    }
    while (i < reference.size() && reference[i].depth == to) ++i;
    while (j < judged.size() && judged[j].depth == to) ++j;
    from = to;
  }
}

Reference::Reference(RefinedModel model) : model_(std::move(model)) {
  std::vector<std::pair<OperationId, bool>> seen;  // and whether it made the end
  std::vector<Surfel> surfels;
  forLines(model_, [&](std::size_t family, std::size_t line, int column, int row, const LineEnds& ends) {
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const double depth = static_cast<double>(ends[i].depth);
      length_ += i % 2 == 0 ? -depth : depth;
      if (isAtBorder(model_.families[family].lines, line, ends[i].depth)) continue;
      surfels.push_back(surfelAt(model_, family, column, row, ends[i]));
      const OperationId trimmer = trimmerOf(ends[i]), inner = ends[i].inner, outer = ends[i].outer;
      if (isOperation(inner)) seen.emplace_back(inner, inner == trimmer);
      if (isOperation(outer) && outer != inner) seen.emplace_back(outer, outer == trimmer);
    }
  });
  surface_ = std::make_unique<const retarget::NearestSurfels>(std::move(surfels));
  std::ranges::sort(seen);
  for (const auto& [id, trims] : seen) {
    if (visible_.empty() || visible_.back().id != id) visible_.push_back({id, 0, 0});
    ++visible_.back().sides;
    visible_.back().trims += trims ? 1 : 0;
  }
}

Recall recallOf(const Reference& reference, std::span<const OperationId> ids) {
  Recall out;
  std::size_t at = 0;
  for (const VisibleOperation& each : reference.visible()) {
    while (at < ids.size() && ids[at] < each.id) ++at;
    const bool missed = at == ids.size() || ids[at] != each.id;
    ++out.sides;
    out.sidesMissed += missed ? 1 : 0;
    if (each.trims == 0) continue;
    ++out.trimming;
    out.trimmingMissed += missed ? 1 : 0;
    out.endsMissed += missed ? each.trims : 0;
  }
  return out;
}

Differences differencesOf(const Reference& reference, const RefinedModel& judged,
                          const Execution& execution) {
  Differences out;
  out.identical = reference.model().families.size() == judged.families.size();
  for (std::size_t k = 0; out.identical && k < judged.families.size(); ++k)
    out.identical = reference.model().families[k].dexels == judged.families[k].dexels;
  if (out.identical) {
    if (reference.ends() > 0) out.toJudged = out.toReference = 0;
    return out;
  }
  // Ends that both have are at no distance: only the others are looked up.
  EndsAlone lost, added;
  std::vector<WrongStretch> stretches;
  forPairs(reference.model(), judged,
           [&](std::size_t family, std::size_t, int column, int row, const LineEnds& a, const LineEnds& b) {
             findWrongStretches(a, b, stretches);
             for (const WrongStretch& s : stretches)
               (s.extra ? out.extra : out.missing) += static_cast<double>(s.to) - static_cast<double>(s.from);
             lost.add(reference.model(), family, column, row, a, b);
             added.add(judged, family, column, row, b, a);
           });
  if (!added.all.empty())
    out.toJudged = lost.alone.empty()
                       ? 0
                       : farthest(lost.alone, retarget::NearestSurfels(std::move(added.all)), execution);
  out.toReference = farthest(added.alone, reference.surface(), execution);
  return out;
}

std::vector<MarkedEnd> markedEnds(const Reference& reference, const RefinedModel& judged) {
  std::vector<MarkedEnd> out;
  std::vector<WrongStretch> stretches;
  forPairs(
      reference.model(), judged,
      [&](std::size_t family, std::size_t, int column, int row, const LineEnds& a, const LineEnds& b) {
        findWrongStretches(a, b, stretches);
        const DVec3 along = judged.families[family].lines.family.line(column, row).direction;
        const auto mark = [&](const SpanEnd& end, bool ofReference) {
          const auto bounds = [&](const WrongStretch& s) { return s.from == end.depth || s.to == end.depth; };
          const auto wrong = std::ranges::find_if(stretches, bounds);
          const EndKind kind = wrong == stretches.end() ? EndKind::Right
                               : wrong->extra           ? EndKind::Extra
                                                        : EndKind::Missing;
          if (ofReference && kind != EndKind::Missing) return;
          const MarkedEnd marked{surfelAt(judged, family, column, row, end), kind};
          if (judged.families.size() > 1 && std::fabs(dot(DVec3(marked.surfel.normal), along)) < kLeastCosine)
            return;
          out.push_back(marked);
        };
        for (const SpanEnd& end : b) mark(end, false);
        for (const SpanEnd& end : a) mark(end, true);
      });
  return out;
}

}  // namespace restroke::experiments
