#include "points/dexel/refine/collect.h"

#include <bit>
#include <cstdint>

#include "implicit/errors.h"
#include "points/dexel/refine/resultants.h"

namespace restroke::points {

namespace {

// A set of ids: a bit each, so that looking at an end costs a bit, however many ends name the same operation.
class IdSet {
 public:
  explicit IdSet(std::size_t ids) : ids_(ids), words_((ids + 63) / 64) {}
  void add(OperationId id) {
    if (id == OperationId::None) return;
    const auto number = static_cast<std::uint32_t>(id);
    RESTROKE_CHECK_EQ(number < ids_, true);
    words_[number / 64] |= std::uint64_t{1} << number % 64;
  }
  [[nodiscard]] std::vector<OperationId> ascending() const {
    std::vector<OperationId> out;
    for (std::size_t w = 0; w < words_.size(); ++w)
      for (std::uint64_t bits = words_[w]; bits != 0; bits &= bits - 1)
        out.push_back(static_cast<OperationId>(64 * w + static_cast<std::size_t>(std::countr_zero(bits))));
    return out;
  }

 private:
  std::size_t ids_;
  std::vector<std::uint64_t> words_;
};

// Calls f(dexels, line, p) for each line of each family that passes through the bounds of a zone: `p` is its
// place, with the coordinate along the axis 0.
template <class F>
void forLinesThrough(const TriDexel& model, const Box& bounds, const F& f) {
  const DexelGrid& grid = model.grid();
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const DexelGrid::Range columns = grid.pointsIn(u, bounds), rows = grid.pointsIn(v, bounds);
    const Dexels& dexels = model.family(axis);
    for (int row = rows.begin; row < rows.end; ++row)
      for (int column = columns.begin; column < columns.end; ++column) {
        DVec3 p(0);
        p[u] = static_cast<double>(grid.at(u, column));
        p[v] = static_cast<double>(grid.at(v, row));
        f(axis, dexels, dexels.lineAt(column, row), p);
      }
  }
}

}  // namespace

std::vector<OperationId> referencesIn(const TriDexel& model, const Zone& zone, EndReferences references,
                                      std::size_t ids) {
  IdSet found(ids);
  const Box& bounds = zone.bounds();
  LineEnds ends;
  forLinesThrough(model, bounds, [&](int axis, const Dexels& dexels, std::size_t line, DVec3 p) {
    dexels.read(line, ends);
    for (const SpanEnd& end : ends) {
      if (end.depth < bounds.min[axis] || end.depth > bounds.max[axis]) continue;
      p[axis] = static_cast<double>(end.depth);
      if (!zone.contains(p)) continue;
      if (references == EndReferences::Both) {
        found.add(end.inner);
        found.add(end.outer);
      } else {
        // None is the greatest number.
        const bool innerIsLater =
            end.outer == OperationId::None || (end.inner != OperationId::None && end.inner > end.outer);
        found.add(innerIsLater ? end.inner : end.outer);
      }
    }
  });
  return found.ascending();
}

std::vector<OperationId> changesIn(const TriDexelDocument& document, const AskedZone& zone,
                                   const DexelHistory& history) {
  IdSet found(history.idCount());
  std::vector<OperationId> changes;
  forLinesThrough(document.model, zone.asked.bounds(),
                  [&](int axis, const Dexels& dexels, std::size_t line, DVec3 p) {
                    DVec3 direction(0);
                    direction[axis] = 1;
                    if (!zone.asked.clip({p, direction})) return;
                    changes.clear();
                    dexels.changesOf(line, changes);
                    for (const OperationId id : changes) found.add(id);
                  });
  std::vector<OperationId> members, out;
  for (const OperationId entry : found.ascending()) appendMembers(document, entry, members);
  for (const OperationId id : members)
    if (zone.wanted.mayMeet(history.boundsOf(id))) out.push_back(id);
  return out;
}

}  // namespace restroke::points
