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

bool meets(const Box& a, const Box& b) {
  for (int c = 0; c < 3; ++c)
    if (a.min[c] > b.max[c] || b.min[c] > a.max[c]) return false;
  return true;
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
        keptBounds_.push_back(hidden_.bounds[i]);
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
    std::vector<OperationId> entries(newIds_.size());  // by new id: what histories name in its place
    for (std::size_t id = 0; id < entries.size(); ++id) entries[id] = idOf(id);
    for (const TriDexelDocument::Run& run : document_.runs)
      for (std::uint32_t k = 1; k < run.count; ++k) entries[numberIn(run.first) + k] = run.first;
    std::vector<std::uint32_t> lengths(newIds_.size(), 1);  // by old id
    for (const TriDexelDocument::Run& run : oldRuns) lengths[numberIn(run.first)] = run.count;
    inArena(execution, [&] {
      for (int axis = 0; axis < 3; ++axis) {
        Dexels& dexels = document_.model.family(axis);
        const LineHistories old = dexels.histories();
        dexels.startHistory();
        tbb::parallel_for(0, dexels.height(), [&](int row) {
          std::vector<OperationId> before, after;
          for (int column = 0; column < dexels.width(); ++column) {
            const std::size_t line = dexels.lineAt(column, row);
            before.clear();
            after.clear();
            old.appendOf(line, before);
            const Place place{axis, document_.model.grid().at((axis + 1) % 3, column),
                              document_.model.grid().at((axis + 2) % 3, row)};
            for (const OperationId id : before) {
              const std::uint32_t length = lengths[numberIn(id)];
              for (std::size_t i = numberIn(id) - 1; i < numberIn(id) - 1 + length; ++i)
                if (length == 1 || meetsLine(i, place)) addInstead(i, place, after);
            }
            for (OperationId& id : after) id = entries[numberIn(id)];
            std::sort(after.begin(), after.end());
            after.erase(std::unique(after.begin(), after.end()), after.end());
            for (const OperationId id : after) dexels.noteChange(line, id);
          }
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
               meets(keptBounds_[next], keptBounds_[next - 1]))
          ++next;
      if (next - first > 1)
        document_.runs.push_back({idOf(first + 1), static_cast<std::uint32_t>(next - first)});
      first = next;
    }
  }

 private:
  struct Place {
    int axis;
    float u, v;
  };
  [[nodiscard]] bool isNeeded(std::size_t i) const { return hidden_.verdicts[i] == OperationVerdict::Needed; }
  // Of what is dropped; else the cover has nothing to decide there.
  [[nodiscard]] bool decidesFor(std::size_t cover, std::size_t i) const {
    return isEverywhere(cover) || meets(hidden_.bounds[cover], hidden_.bounds[i]);
  }
  [[nodiscard]] bool isEverywhere(std::size_t i) const { return intersects_[i] != 0; }
  [[nodiscard]] bool meetsLine(std::size_t i, const Place& place) const {
    const Box& box = hidden_.bounds[i];
    const int u = (place.axis + 1) % 3, v = (place.axis + 2) % 3;
    return isEverywhere(i) ||
           (box.min[u] <= place.u && place.u <= box.max[u] && box.min[v] <= place.v && place.v <= box.max[v]);
  }
  void addInstead(std::size_t i, const Place& place, std::vector<OperationId>& ids) const {
    if (isNeeded(i)) {
      ids.push_back(newIds_[i + 1]);
      return;
    }
    for (const std::uint32_t cover : covers_[i])
      if (meetsLine(cover, place)) ids.push_back(newIds_[cover + 1]);
  }

  TriDexelDocument& document_;
  HiddenOperations hidden_;
  std::vector<OperationId> newIds_;  // by old id; of dropped ones Initial
  std::vector<std::uint8_t> intersects_;
  std::vector<Box> keptBounds_;
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
