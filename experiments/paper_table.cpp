#include "experiments/paper_table.h"

#include <algorithm>

namespace restroke::experiments {

bool isPaperTable2(std::span<const std::size_t> stampsPerStroke) {
  return std::ranges::equal(stampsPerStroke, kPaperTable2, {}, {}, &PaperStep::stamps);
}

}  // namespace restroke::experiments
