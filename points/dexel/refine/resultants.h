#pragma once
// A history merged into fewer operations with the same result (SPEC R7).

#include <cstddef>
#include <cstdint>
#include <vector>

#include "implicit/execution.h"
#include "points/dexel/dexel_document.h"

namespace restroke::points {

struct ResultantOptions {
  /// Histories of lines name runs of operations in place of their members.
  bool runs = true;
  /// Operations in a run, at most; >= 2. Longer runs make histories shorter, and what is replayed for one of
  /// their members more.
  std::uint32_t longestRun = 64;
};

/// What merging a history has saved.
struct ResultantReport {
  std::size_t operationsBefore = 0, operationsAfter = 0;
  std::size_t withoutEffect = 0;  ///< dropped: they had changed nothing
  std::size_t hidden = 0;         ///< dropped: one later operation decides all that they decided
  std::size_t covered = 0;        ///< dropped: several later ones do, together
  /// Of all operations: those that an end of the model refers to, which are never dropped.
  std::size_t referred = 0;
  std::size_t runs = 0, operationsInRuns = 0;
  /// Bytes of operations, tools, cutters, runs and the volumes they share.
  std::size_t documentBytesBefore = 0, documentBytesAfter = 0;
  std::size_t historyEntriesBefore = 0, historyEntriesAfter = 0;
  std::size_t historyBytesBefore = 0, historyBytesAfter = 0;
};

struct Resultants {
  TriDexelDocument document;
  ResultantReport report;
};

/// The same model with fewer operations, by two means:
///
/// - Operations that decide nothing (hidden_operations.h) are dropped, unless an end of the model refers to
///   them; the others get new numbers.
/// - Where the model keeps histories of its lines, operations of one kind that follow each other, each near
///   the one before, become runs (TriDexelDocument::Run), and histories name runs.
///
/// What stays: the model's ends, to the last bit, but for the new numbers of the operations that they refer
/// to; no end refers to another operation than before. A replay of the new operations on any line gives the
/// depths, normals and flags that one of the old ones gives, as far as float32 tells lines apart (to depths
/// of 16 times the greatest coordinate of model and operations). What such a replay takes for the operations
/// beside an end may differ where the old one took it over from a dropped operation's end.
///
/// Histories name, in place of a dropped operation, what decides in its place on that line, whether or not it
/// has changed the line itself; what else they name they named before. Whoever replays what a line's history
/// names, on the initial solid, gets the line.
///
/// Throws InputError as DexelHistory does. The same for any number of threads. O(operations x those that
/// touch the same cluster cell + lines + ends + entries of histories).
[[nodiscard]] Resultants resultantsOf(TriDexelDocument document, const ResultantOptions& options = {},
                                      const Execution& execution = {});

/// Appends the operations that an entry of a line's history stands for: it, or all of its run. O(log runs).
void appendMembers(const TriDexelDocument& document, OperationId entry, std::vector<OperationId>& ids);

}  // namespace restroke::points
