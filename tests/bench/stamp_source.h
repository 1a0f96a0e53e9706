#pragma once
// The list of stamps that measurements run on.

#include <filesystem>
#include <string>
#include <vector>

#include "implicit/errors.h"
#include "implicit/primitive.h"
#include "sculpt/document.h"
#include "sculpt/stroke_log.h"

namespace restroke::bench {

struct StampSource {
  std::string name;
  std::vector<implicit::Primitive> primitives;  ///< the base first
  std::vector<std::size_t> strokes;             ///< primitives of each stroke
};

/// The log or stamp list `file`; without one the shared list of 108 strokes and 3,426 stamps, else the
/// example of the same size that ships. Throws InputError when the file cannot be read, or does more than
/// stroke.
inline StampSource loadStamps(std::filesystem::path file = {}) {
  if (file.empty()) {
    file = std::filesystem::path(RESTROKE_SHARED_DIR) / "data/stamps/paper-108x3426.stamps";
    if (!std::filesystem::exists(file))
      file = std::filesystem::path(RESTROKE_SOURCE_DIR) / "experiments/examples/paper-scale.log";
  }
  const sculpt::StrokeLog log = sculpt::readLog(file);
  sculpt::Document document(log.header);
  StampSource out;
  out.name = file.filename().string();
  for (const sculpt::Command& command : log.commands) {
    const std::size_t before = document.model().list().size();
    document.apply(command);
    if (document.model().list().size() < before)
      throw InputError(
          fmt::format("{}: holds a command that takes stamps away; only strokes are measured", out.name));
    out.strokes.push_back(document.model().list().size() - before);
  }
  for (std::size_t i = 0; i < document.model().list().size(); ++i)
    out.primitives.push_back(document.model().list().at(i));
  return out;
}

}  // namespace restroke::bench
