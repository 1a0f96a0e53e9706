#include "experiments/backends/history_backend.h"

#include <xxhash.h>

#include <array>
#include <cstring>

#include "experiments/backends/kinds.h"
#include "implicit/errors.h"

namespace restroke::experiments {

std::unique_ptr<HistoryBackend> makeBackend(BackendKind kind, const Start& start) {
  switch (kind) {
    case BackendKind::Strokes:
      return makeStrokes(start);
    case BackendKind::ListSnapshots:
      return makeListSnapshots(start);
    case BackendKind::SurfelSnapshots:
      return makeSurfelSnapshots(start);
    case BackendKind::SurfelDeltas:
      return makeSurfelDeltas(start);
    case BackendKind::SurfelDeltasZstd:
      return makeSurfelDeltasZstd(start);
    case BackendKind::DexelDeltas:
      return makeDexelDeltas(start);
  }
  throw InternalError("makeBackend: a kind of history back end that does not exist");
}

std::uint64_t HistoryBackend::hashOfShape(const ShapeView& shape) const {
  return hashOf(shape.surfels);
}

std::uint64_t hashOf(std::span<const points::Surfel> surfels) {
  // Fields are copied out in blocks: a Surfel has padding, whose bytes mean nothing.
  constexpr std::size_t kFields = 9;
  constexpr std::size_t kBlock = 256;
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                              XXH3_freeState);
  XXH3_64bits_reset(state.get());
  const std::uint64_t count = surfels.size();
  XXH3_64bits_update(state.get(), &count, sizeof count);
  std::array<std::uint32_t, kFields * kBlock> words{};
  for (std::size_t begin = 0; begin < surfels.size(); begin += kBlock) {
    const std::size_t n = surfels.size() - begin < kBlock ? surfels.size() - begin : kBlock;
    for (std::size_t i = 0; i < n; ++i) {
      const points::Surfel& s = surfels[begin + i];
      const float values[] = {s.position.x, s.position.y, s.position.z, s.normal.x,
                              s.normal.y,   s.normal.z,   s.radius};
      std::memcpy(&words[i * kFields], values, sizeof values);
      words[i * kFields + 7] = s.primitive;
      words[i * kFields + 8] = static_cast<std::uint32_t>(s.sign);
    }
    XXH3_64bits_update(state.get(), words.data(), n * kFields * sizeof(std::uint32_t));
  }
  return XXH3_64bits_digest(state.get());
}

}  // namespace restroke::experiments
