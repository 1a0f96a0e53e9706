#include "implicit/parallel.h"

#include <tbb/global_control.h>

namespace restroke {

void allowManyThreads() {
  static const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, kMaxThreads);
}

}  // namespace restroke
