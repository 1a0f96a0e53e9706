#pragma once
// How a computation is run. Nothing in here changes a result; what does is in each function's own options.

namespace restroke {

inline constexpr int kMaxThreads = 1024;

/// Passed to everything that may take long.
struct Execution {
  /// Worker threads, 1 to kMaxThreads; 0 takes all that the machine has. Never changes a result
  /// (tests/determinism).
  int threads = 0;
};

}  // namespace restroke
