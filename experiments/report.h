#pragma once
// The memory experiment as one page that needs nothing else: tables, figures and pictures are inside.

#include <string>
#include <vector>

#include "experiments/memory.h"
#include "experiments/output.h"

namespace restroke::experiments {

/// Images of one log, as files' bytes.
struct LogImages {
  std::vector<std::string> pngs;  ///< one for each of MemoryLog::pictures
  std::string linearSvg;          ///< figure 12; empty where there is none
  std::string logarithmicSvg;
};

/// HTML 5, UTF-8, without scripts and without anything to fetch. One LogImages a log; at least one log.
[[nodiscard]] std::string memoryReport(const std::vector<MemoryLog>& logs,
                                       const std::vector<LogImages>& images, const Setup& setup,
                                       const Provenance& origin);

}  // namespace restroke::experiments
