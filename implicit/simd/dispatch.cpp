#include "implicit/simd/dispatch.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>

#include "implicit/errors.h"
#include "implicit/simd/ball_kernels.h"
#include "implicit/simd/ray_kernels.h"

namespace restroke::implicit {

extern const BallKernels kBallKernelsSse2, kBallKernelsAvx2, kBallKernelsAvx512;
extern const RayKernels kRayKernelsSse2, kRayKernelsAvx2, kRayKernelsAvx512;

std::string_view nameOf(SimdLevel level) {
  switch (level) {
    case SimdLevel::Sse2:
      return "sse2";
    case SimdLevel::Avx2:
      return "avx2";
    case SimdLevel::Avx512:
      return "avx512";
  }
  return "?";
}

std::vector<SimdLevel> supportedSimdLevels() {
  std::vector<SimdLevel> levels{SimdLevel::Sse2};
  if (__builtin_cpu_supports("avx2")) levels.push_back(SimdLevel::Avx2);
  if (__builtin_cpu_supports("avx512f")) levels.push_back(SimdLevel::Avx512);
  return levels;
}

namespace {

SimdLevel initialLevel() {
  const std::vector<SimdLevel> levels = supportedSimdLevels();
  if (const char* name = std::getenv("RESTROKE_SIMD")) {
    for (SimdLevel level : levels)
      if (nameOf(level) == name) return level;
  }
  return levels.back();
}

std::atomic<SimdLevel>& current() {
  static std::atomic<SimdLevel> level{initialLevel()};
  return level;
}

}  // namespace

SimdLevel simdLevel() {
  return current().load(std::memory_order_relaxed);
}
std::string_view simdLevelName() {
  return nameOf(simdLevel());
}

void useSimdLevel(SimdLevel level) {
  const std::vector<SimdLevel> levels = supportedSimdLevels();
  if (std::find(levels.begin(), levels.end(), level) == levels.end())
    throw InputError(fmt::format("SIMD level {}: this processor lacks it; it runs up to {}", nameOf(level),
                                 nameOf(levels.back())));
  current().store(level, std::memory_order_relaxed);
}

const BallKernels& ballKernels(SimdLevel level) {
  return chosen(level, kBallKernelsSse2, kBallKernelsAvx2, kBallKernelsAvx512);
}

const BallKernels& ballKernels() {
  return ballKernels(simdLevel());
}

const RayKernels& rayKernels(SimdLevel level) {
  return chosen(level, kRayKernelsSse2, kRayKernelsAvx2, kRayKernelsAvx512);
}

const RayKernels& rayKernels() {
  return rayKernels(simdLevel());
}

}  // namespace restroke::implicit
