#include "points/dexel/refine/resultants.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <set>
#include <span>
#include <utility>

#include "implicit/errors.h"
#include "implicit/parallel.h"
#include "points/dexel/refine/hidden_operations.h"

namespace restroke::points {

namespace {

using implicit::Shape;
using implicit::Sphere;

std::size_t numberIn(OperationId id) {
  return static_cast<std::size_t>(id);
}
OperationId idOf(std::size_t number) {
  return static_cast<OperationId>(number);
}

std::size_t bytesOf(const TriangleMesh& mesh) {
  return mesh.vertices.size() * sizeof(mesh.vertices[0]) + mesh.triangles.size() * sizeof(mesh.triangles[0]);
}

std::size_t bytesOf(const TriDexelDocument& document) {
  std::size_t bytes = document.operations.size() * sizeof(TriDexelDocument::Operation) +
                      document.cutters.size() * sizeof(Cutter) +
                      document.runs.size() * sizeof(TriDexelDocument::Run);
  for (const TriangleMesh& tool : document.tools) bytes += bytesOf(tool);
  std::set<const void*> counted;
  for (const TriDexelDocument::Operation& operation : document.operations)
    if (const auto* shape = std::get_if<Shape>(&operation.tool); shape && !shape->isSphere()) {
      if (counted.insert(shape->volume()).second) bytes += shape->volume()->bytes();
      if (counted.insert(&shape->volume()->volume()).second) bytes += shape->volume()->volume().bytes();
    }
  return bytes;
}

// By operation's index, whether an end refers to it.
std::vector<std::uint8_t> referredIn(const TriDexelDocument& document) {
  std::vector<std::uint8_t> referred(document.operations.size());
  LineEnds ends;
  for (int axis = 0; axis < 3; ++axis) {
    const Dexels& dexels = document.model.family(axis);
    for (std::size_t line = 0; dexels.keepsOperations() && line < dexels.lineCount(); ++line) {
      dexels.read(line, ends);
      for (const SpanEnd& end : ends)
        for (const OperationId id : {end.inner, end.outer})
          if (id != OperationId::None && id != OperationId::Initial) {
            RESTROKE_CHECK_LE(numberIn(id), referred.size());
            referred[numberIn(id) - 1] = 1;
          }
    }
  }
  return referred;
}

bool meet(const Sphere& a, const Sphere& b) {
  const DVec3 d = DVec3(a.center) - DVec3(b.center);
  const double most = static_cast<double>(a.radius) + static_cast<double>(b.radius);
  return dot(d, d) <= most * most;
}

// What becomes of each operation of the old document. Indices of operations count from 0, ids from 1.
class Merging {
 public:
  Merging(TriDexelDocument& document, HiddenOperations hidden)
      : document_(document), hidden_(std::move(hidden)), newIds_(document.operations.size() + 1) {
    for (const TriDexelDocument::Operation& operation : document.operations)
      intersects_.push_back(operation.operation == DexelOperation::Intersection ? 1 : 0);
    std::size_t next = 1;
    for (std::size_t i = 0; i < document.operations.size(); ++i)
      if (isNeeded(i)) newIds_[i + 1] = idOf(next++);
  }

  void mergeOperations() {
    std::vector<TriDexelDocument::Operation> kept;
    for (std::size_t i = 0; i < document_.operations.size(); ++i)
      if (isNeeded(i)) {
        kept.push_back(std::move(document_.operations[i]));
        keptBalls_.push_back(hidden_.balls[i]);
      }
    kept.shrink_to_fit();
    document_.operations = std::move(kept);
  }

  void renumberEnds(const Execution& execution) {
    inArena(execution, [&] {
      for (int axis = 0; axis < 3; ++axis) {
        Dexels& dexels = document_.model.family(axis);
        if (!dexels.keepsOperations()) continue;
        tbb::parallel_for(0, dexels.height(), [&](int row) {
          LineEnds ends;
          for (int column = 0; column < dexels.width(); ++column) {
            const std::size_t line = dexels.lineAt(column, row);
            dexels.read(line, ends);
            for (SpanEnd& end : ends)
              for (OperationId* id : {&end.inner, &end.outer})
                if (*id != OperationId::None) *id = newIds_[numberIn(*id)];
            if (!ends.empty()) dexels.write(line, ends);
          }
        });
      }
    });
  }

  // The needed operations that decide together what each dropped one decided.
  void resolveCovers() {
    covers_.resize(newIds_.size() - 1);
    for (std::size_t i = covers_.size(); i-- > 0;) {
      std::vector<std::uint32_t>& own = covers_[i];
      for (std::uint32_t c = hidden_.coverBegin[i]; c < hidden_.coverBegin[i + 1]; ++c) {
        const std::uint32_t cover = hidden_.covers[c];
        if (isNeeded(cover)) {
          own.push_back(cover);
          continue;
        }
        for (const std::uint32_t last : covers_[cover])
          if (decidesFor(last, i)) own.push_back(last);
      }
      std::sort(own.begin(), own.end());
      own.erase(std::unique(own.begin(), own.end()), own.end());
    }
  }

  void mergeHistories(std::span<const TriDexelDocument::Run> oldRuns, const Execution& execution) {
    std::vector<OperationId> runOf(newIds_.size());  // by new id
    for (std::size_t id = 0; id < runOf.size(); ++id) runOf[id] = idOf(id);
    for (const TriDexelDocument::Run& run : document_.runs)
      std::fill_n(runOf.begin() + static_cast<std::ptrdiff_t>(run.first), run.count, run.first);
    for (std::size_t i = 0; i + 1 < newIds_.size(); ++i) entries_.push_back(runOf[numberIn(newIds_[i + 1])]);
    std::vector<std::uint32_t> lengths(newIds_.size(), 1);  // by old id
    for (const TriDexelDocument::Run& run : oldRuns) lengths[numberIn(run.first)] = run.count;
    inArena(execution, [&] {
      for (int axis = 0; axis < 3; ++axis) {
        Dexels& dexels = document_.model.family(axis);
        const LineHistories old = dexels.histories();
        dexels.startHistory();
        tbb::parallel_for(tbb::blocked_range<int>(0, dexels.height(), kRows),
                          [&](const tbb::blocked_range<int>& rows) {
                            Names names(newIds_.size());
                            for (int row = rows.begin(); row < rows.end(); ++row)
                              mergeRow({axis, row}, old, lengths, names);
                          });
      }
    });
  }

  // Operations of one kind that follow each other, each near the one before.
  void findRuns(std::uint32_t longest) {
    const auto& operations = document_.operations;
    for (std::size_t first = 0; first < operations.size();) {
      std::size_t next = first + 1;
      if (operations[first].operation != DexelOperation::Intersection)
        while (next < operations.size() && next - first < longest &&
               operations[next].operation == operations[first].operation &&
               meet(keptBalls_[next], keptBalls_[next - 1]))
          ++next;
      if (next - first > 1)
        document_.runs.push_back({idOf(first + 1), static_cast<std::uint32_t>(next - first)});
      first = next;
    }
  }

 private:
  // Rows that a thread works on at a time.
  static constexpr int kRows = 16;
  struct Place {
    int axis;
    double u, v;
  };
  struct Row {
    int axis, row;
  };
  [[nodiscard]] bool isNeeded(std::size_t i) const { return hidden_.verdicts[i] == OperationVerdict::Needed; }
  // Of what is dropped; else the cover has nothing to decide there.
  [[nodiscard]] bool decidesFor(std::size_t cover, std::size_t i) const {
    return isEverywhere(cover) || meet(hidden_.balls[cover], hidden_.balls[i]);
  }
  [[nodiscard]] bool isEverywhere(std::size_t i) const { return intersects_[i] != 0; }
  [[nodiscard]] bool meetsLine(std::size_t i, const Place& place) const {
    if (isEverywhere(i)) return true;
    const Sphere& ball = hidden_.balls[i];
    const double u = place.u - static_cast<double>(ball.center[(place.axis + 1) % 3]),
                 v = place.v - static_cast<double>(ball.center[(place.axis + 2) % 3]),
                 r = static_cast<double>(ball.radius);
    return u * u + v * v <= r * r;
  }
  // What a line's history comes to name.
  class Names {
   public:
    explicit Names(std::size_t ids) : lineOf_(ids), askedOn_(ids) {}
    void beginLine() {
      ids_.clear();
      ++line_;
    }
    void add(OperationId id) {
      if (std::exchange(lineOf_[numberIn(id)], line_) != line_) ids_.push_back(id);
    }
    /// Once for each operation and line: true.
    [[nodiscard]] bool asksFirst(std::size_t i) { return std::exchange(askedOn_[i], line_) != line_; }
    [[nodiscard]] std::span<const OperationId> ascending() {
      std::sort(ids_.begin(), ids_.end());
      return ids_;
    }

   private:
    std::vector<OperationId> ids_;
    std::vector<std::uint32_t> lineOf_;   // by id, the last line that named it
    std::vector<std::uint32_t> askedOn_;  // by old index
    std::uint32_t line_ = 0;
  };
  void addInstead(std::size_t i, const Place& place, Names& names) const {
    if (isNeeded(i)) {
      names.add(entries_[i]);
      return;
    }
    for (const std::uint32_t cover : covers_[i])
      if (names.asksFirst(cover) && meetsLine(cover, place)) names.add(entries_[cover]);
  }

  void mergeRow(Row where, const LineHistories& old, std::span<const std::uint32_t> lengths, Names& names) {
    Dexels& dexels = document_.model.family(where.axis);
    const DexelGrid& grid = document_.model.grid();
    const int u = (where.axis + 1) % 3, v = (where.axis + 2) % 3;
    std::vector<OperationId> before;
    for (int column = 0; column < dexels.width(); ++column) {
      const std::size_t line = dexels.lineAt(column, where.row);
      before.clear();
      old.appendOf(line, before);
      const Place place{where.axis, static_cast<double>(grid.at(u, column)),
                        static_cast<double>(grid.at(v, where.row))};
      names.beginLine();
      for (const OperationId id : before) {
        const std::size_t first = numberIn(id) - 1, length = lengths[numberIn(id)];
        for (std::size_t i = first; i < first + length; ++i)
          if (length == 1 || meetsLine(i, place)) addInstead(i, place, names);
      }
      for (const OperationId id : names.ascending()) dexels.noteChange(line, id);
    }
  }

  TriDexelDocument& document_;
  HiddenOperations hidden_;
  std::vector<OperationId> newIds_;   // by old id; of dropped ones Initial
  std::vector<OperationId> entries_;  // of needed operations, what histories name in their place
  std::vector<std::uint8_t> intersects_;
  std::vector<Sphere> keptBalls_;
  std::vector<std::vector<std::uint32_t>> covers_;
};

}  // namespace

Resultants resultantsOf(TriDexelDocument document, const ResultantOptions& options,
                        const Execution& execution) {
  RESTROKE_CHECK_EQ(options.longestRun >= 2, true);
  Resultants out{std::move(document), {}};
  TriDexelDocument& merged = out.document;
  ResultantReport& report = out.report;
  const bool keepsHistory = merged.model.keepsHistory();
  report.operationsBefore = merged.operations.size();
  report.documentBytesBefore = bytesOf(merged);
  report.historyEntriesBefore = merged.model.historySize().entries;
  report.historyBytesBefore = merged.model.historySize().bytes;

  const std::vector<std::uint8_t> referred = referredIn(merged);
  HiddenOperations hidden = hiddenOperations(merged, referred, execution);
  for (const std::uint8_t is : referred) report.referred += is;
  for (const OperationVerdict verdict : hidden.verdicts) {
    report.withoutEffect += verdict == OperationVerdict::WithoutEffect ? 1 : 0;
    report.hidden += verdict == OperationVerdict::Hidden ? 1 : 0;
    report.covered += verdict == OperationVerdict::Covered ? 1 : 0;
  }
  Merging merging(merged, std::move(hidden));
  if (keepsHistory) merging.resolveCovers();
  merging.mergeOperations();
  merging.renumberEnds(execution);
  if (keepsHistory) {
    const std::vector<TriDexelDocument::Run> oldRuns = std::exchange(merged.runs, {});
    if (options.runs) merging.findRuns(options.longestRun);
    merging.mergeHistories(oldRuns, execution);
  } else {
    merged.runs.clear();
  }

  report.operationsAfter = merged.operations.size();
  report.documentBytesAfter = bytesOf(merged);
  report.historyEntriesAfter = merged.model.historySize().entries;
  report.historyBytesAfter = merged.model.historySize().bytes;
  report.runs = merged.runs.size();
  for (const TriDexelDocument::Run& run : merged.runs) report.operationsInRuns += run.count;
  return out;
}

void appendMembers(const TriDexelDocument& document, OperationId entry, std::vector<OperationId>& ids) {
  const auto run =
      std::lower_bound(document.runs.begin(), document.runs.end(), entry,
                       [](const TriDexelDocument::Run& a, OperationId id) { return a.first < id; });
  const std::uint32_t count = run != document.runs.end() && run->first == entry ? run->count : 1;
  for (std::uint32_t k = 0; k < count; ++k) ids.push_back(idOf(numberIn(entry) + k));
}

}  // namespace restroke::points
