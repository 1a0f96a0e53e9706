#pragma once

#include <tbb/task_arena.h>

#include "implicit/execution.h"

namespace restroke {

/// Lets oneTBB use as many threads as an Execution may ask for, also on a machine with fewer cores. Once a
/// process.
void allowManyThreads();

/// Runs f with the threads that the execution asks for; oneTBB's algorithms inside it use those.
template <class F>
void inArena(const Execution& execution, const F& f) {
  allowManyThreads();
  tbb::task_arena arena(execution.threads > 0 ? execution.threads : tbb::task_arena::automatic);
  arena.execute(f);
}

}  // namespace restroke
