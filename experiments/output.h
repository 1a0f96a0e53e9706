#pragma once
// What every experiment writes in the same way: rows as CSV and JSON, a manifest, and where results come
// from.

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/provenance.h"
#include "points/images/png.h"

namespace restroke::experiments {

using Json = nlohmann::ordered_json;

/// What an experiment was asked to do, as far as its rows and its report say so.
struct Setup {
  std::string_view experiment;  ///< name of the subcommand
  std::string options;          ///< canonical text; its hash is in every row
  std::uint64_t seed = 0;
};

/// revision, dirty, compiler, options_hash, seed: the columns that every row ends with.
[[nodiscard]] Json originOf(const Setup& setup, const Provenance& p);

/// experiment, the columns of originOf, flags, cpu, processors, system: what every manifest begins with.
[[nodiscard]] Json manifestHead(const Setup& setup, const Provenance& p);

/// Adds to a manifest the files that were read, each with its hash.
void addInputs(Json& manifest, std::span<const std::pair<std::string, std::string>> inputs);

/// A row for each item, as `rowOf` makes it, with the columns of `origin` behind.
template <class Items, class F>
[[nodiscard]] Json rowsOf(const Items& items, const Json& origin, const F& rowOf) {
  Json rows = Json::array();
  for (const auto& item : items) {
    Json row = rowOf(item);
    row.update(origin);
    rows.push_back(std::move(row));
  }
  return rows;
}

/// An array of flat objects with the same keys as a table with a head; empty without rows. Null is an empty
/// field.
[[nodiscard]] std::string csvOf(const Json& rows);

/// Rows, one a line: short for programs, and a difference between two files shows which row it is in.
[[nodiscard]] std::string rowsText(const Setup& setup, const Json& rows);

/// What SPEC, hypothesis and targets promise, with what was measured.
struct Claim {
  std::string text;
  std::string measured;
  std::optional<bool> holds;  ///< nothing: nothing was measured for it
};
/// An array of claim, measured, holds (or null).
[[nodiscard]] Json jsonOf(std::span<const Claim> claims);
/// A line for each.
[[nodiscard]] std::string textOf(std::span<const Claim> claims);

/// Makes the folder, and those above it, unless it is there. Throws InputError when it cannot be made or
/// written.
void makeFolder(const std::filesystem::path& folder);

/// The folder of one experiment's results, and the names of what was put there.
class ResultFolder {
 public:
  /// As makeFolder.
  explicit ResultFolder(std::filesystem::path folder);
  /// Throw InputError when the file cannot be written.
  void write(const std::string& name, std::string_view bytes);
  void write(const std::string& name, const points::DisplayImage& image);
  /// Something else has written this file.
  void note(const std::string& name) { files_.push_back(name); }
  [[nodiscard]] std::filesystem::path at(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] const std::vector<std::string>& files() const { return files_; }

 private:
  std::filesystem::path folder_;
  std::vector<std::string> files_;
};

}  // namespace restroke::experiments
