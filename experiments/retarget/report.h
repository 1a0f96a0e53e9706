#pragma once
// The retargeting experiment as one page: which method when, what was promised and measured, tables, figures,
// pictures.

#include <string>
#include <vector>

#include "experiments/output.h"
#include "experiments/retarget.h"

namespace restroke::experiments {

/// Images as files' bytes.
struct ReportImages {
  std::vector<std::vector<std::string>> rows;  ///< PNG, as RetargetResults::pictures
  std::string tellingSvg, symmetricSvg;        ///< errors against strength; empty where there are none
};

/// One result at least.
[[nodiscard]] std::string retargetReport(const RetargetResults& results, const ReportImages& images,
                                         const Setup& setup, const Provenance& origin);

/// Which method to use when, by what was measured: a sentence for each kind of change that was tried.
[[nodiscard]] std::vector<std::string> adviceOf(const RetargetResults& results);

/// The table of median errors as text, of the bases that tell their motion, and what was promised.
[[nodiscard]] std::string retargetTable(const RetargetResults& results);

}  // namespace restroke::experiments
