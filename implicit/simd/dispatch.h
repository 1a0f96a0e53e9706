#pragma once
// Which instruction set the kernels use. Never changes a result (tests/determinism).

#include <string_view>
#include <vector>

namespace restroke::implicit {

enum class SimdLevel { Sse2, Avx2, Avx512 };

/// "sse2", "avx2" or "avx512".
[[nodiscard]] std::string_view nameOf(SimdLevel level);

/// The levels that this processor runs, lowest first.
[[nodiscard]] std::vector<SimdLevel> supportedSimdLevels();

/// The level in use: the highest supported one, or what the environment variable RESTROKE_SIMD names, if
/// supported.
[[nodiscard]] SimdLevel simdLevel();
[[nodiscard]] std::string_view simdLevelName();

/// Uses another supported level from now on; for tests and benchmarks. Throws InputError when the processor
/// lacks it.
void useSimdLevel(SimdLevel level);

/// Of three tables of kernels the level's.
template <class Kernels>
[[nodiscard]] const Kernels& chosen(SimdLevel level, const Kernels& sse2, const Kernels& avx2,
                                    const Kernels& avx512) {
  return level == SimdLevel::Avx512 ? avx512 : level == SimdLevel::Avx2 ? avx2 : sse2;
}

}  // namespace restroke::implicit
