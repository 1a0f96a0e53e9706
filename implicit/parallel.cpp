#include "implicit/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>

#include <atomic>
#include <memory>
#include <mutex>

namespace restroke {

void allowThreads(int threads) {
  // oneTBB starts a thread whenever one is wanted and none is idle, up to its limit: a limit that nobody has
  // asked for lets callers that make many short arenas end up with all the threads that it allows.
  static std::atomic<int> allowed{tbb::info::default_concurrency()};
  if (threads <= allowed.load(std::memory_order_relaxed)) return;
  static std::mutex mutex;
  static std::unique_ptr<tbb::global_control> limit;
  const std::lock_guard lock(mutex);
  if (threads <= allowed.load(std::memory_order_relaxed)) return;
  // The least of all limits that there are counts: the old one goes first.
  limit.reset();
  limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                static_cast<std::size_t>(threads));
  allowed.store(threads, std::memory_order_relaxed);
}

}  // namespace restroke
