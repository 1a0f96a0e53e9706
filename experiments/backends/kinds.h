#pragma once
// The makers behind makeBackend, one for each kind.

#include <memory>

#include "experiments/backends/history_backend.h"

namespace restroke::experiments {

[[nodiscard]] std::unique_ptr<HistoryBackend> makeStrokes(const Start& start);
[[nodiscard]] std::unique_ptr<HistoryBackend> makeListSnapshots(const Start& start);
[[nodiscard]] std::unique_ptr<HistoryBackend> makeSurfelSnapshots(const Start& start);
[[nodiscard]] std::unique_ptr<HistoryBackend> makeSurfelDeltas(const Start& start);
[[nodiscard]] std::unique_ptr<HistoryBackend> makeSurfelDeltasZstd(const Start& start);
[[nodiscard]] std::unique_ptr<HistoryBackend> makeDexelDeltas(const Start& start);

}  // namespace restroke::experiments
