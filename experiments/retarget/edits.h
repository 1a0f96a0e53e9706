#pragma once
// Changes without a known truth: a whole log is replayed with one stroke less, with two strokes in the other
// order, or on another base, and what becomes of the later strokes is measured by itself (SPEC S7, S8).

#include <span>

#include "experiments/retarget.h"
#include "experiments/retarget/bases.h"
#include "sculpt/stroke_log.h"

namespace restroke::experiments {

struct EditSubject {
  std::string name;
  sculpt::StrokeLog log;  ///< of its commands the strokes, each on what the ones before it made
};

/// Replays the log once with `exact`, keeping every stroke's trail; then for every edit and method once more,
/// each stroke cast by that method from its recorded input on the list as it has become. Strokes before the
/// edit are as they were and are not counted. The edits: a stroke cancelled at the first, second and third
/// quarter of the log and at its beginning; the strokes in its middle exchanged; the base replaced by each of
/// `bases`, scaled and moved to the ball of the log's own.
void measureEdits(const EditSubject& subject, std::span<const RetargetBase> bases,
                  const RetargetOptions& options, const Execution& execution, RetargetResults& results);

}  // namespace restroke::experiments
