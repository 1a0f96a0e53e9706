#pragma once
// What the subcommands of `restroke dexel` share: checks of words, and the report on a model.

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "implicit/errors.h"
#include "points/dexel/tridexel_file.h"
#include "points/surfel.h"
#include "sculpt/cli/output.h"

namespace restroke::cli {

/// "cpu" or "opengl"; throws InputError.
void checkDevice(const std::string& device);

/// "x", "y", "z", or "all": nothing. Throws InputError.
[[nodiscard]] std::optional<int> familyNamed(const std::string& family);
/// Appends the spans of one family or all as rods of a thickness that leaves them apart, in the base's
/// colour.
void appendRods(const points::TriDexel& model, std::optional<int> family, std::vector<points::Surfel>& out);

/// A model that was made or read.
struct DexelReport {
  const std::string& file;
  const points::TriDexelDocument& document;
  double seconds;
};
/// Says what the model is, in text and JSON; `more` stands before the time in the JSON. Finishes the output.
void report(Output& output, const DexelReport& report, const nlohmann::ordered_json& more);

/// Merges the document's history (points/dexel/refine/resultants.h), says what that saved, and returns it as
/// the JSON's "resultants"; does nothing, and returns an empty object, unless it is wanted.
[[nodiscard]] nlohmann::ordered_json mergedIf(bool isWanted, points::TriDexelDocument& document,
                                              const Output& output, const Execution& execution);

/// What f returns; sentences of InputErrors begin with the file's name.
template <class F>
auto named(const std::string& file, const F& f) {
  try {
    return f();
  } catch (const InputError& error) {
    throw InputError(file + ": " + error.what());
  }
}

}  // namespace restroke::cli
