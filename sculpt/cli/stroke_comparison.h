#pragma once
// The strokes of a document beside those of the document that they came from: the measures of
// retarget/measures.h as JSON and in words (SPEC X2).

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "retarget/measures.h"
#include "sculpt/cli/commands.h"
#include "sculpt/document.h"

namespace restroke::cli {

/// Both documents hold the same strokes under the same numbers and have kept their trails. Where the base was
/// only transformed, the truth is known: what the map makes of the strokes as they were.
class StrokeComparison {
 public:
  StrokeComparison(const sculpt::Document& before, const sculpt::Document& after,
                   const RetargetOptions& options, const Execution& execution);

  /// Null for a stroke that is not on the shape at the cursor, or has no trail.
  [[nodiscard]] nlohmann::ordered_json of(sculpt::NodeId node) const;
  [[nodiscard]] nlohmann::ordered_json overall() const;
  /// Some lines for people; empty when nothing was compared.
  [[nodiscard]] std::string text() const;

 private:
  std::map<sculpt::NodeId, retarget::StrokeObservations> observed_;
  retarget::Measures overall_;
  bool knowsTruth_ = false;
};

}  // namespace restroke::cli
