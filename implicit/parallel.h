#pragma once

#include <tbb/task_arena.h>

#include "implicit/execution.h"

namespace restroke {

/// Lets oneTBB use so many threads, also on a machine with fewer cores, from now on.
void allowThreads(int threads);

/// Runs f with the threads that the execution asks for; oneTBB's algorithms inside it use those.
template <class F>
void inArena(const Execution& execution, const F& f) {
  allowThreads(execution.threads);
  tbb::task_arena arena(execution.threads > 0 ? execution.threads : tbb::task_arena::automatic);
  arena.execute(f);
}

}  // namespace restroke
