#include "experiments/output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "experiments/text.h"
#include "implicit/atomic_file.h"
#include "implicit/errors.h"

namespace restroke::experiments {

namespace fs = std::filesystem;

Json originOf(const Setup& setup, const Provenance& p) {
  return {{"revision", p.revision},
          {"dirty", p.dirty},
          {"compiler", p.compiler},
          {"options_hash", hexHash(setup.options)},
          {"seed", setup.seed}};
}

Json manifestHead(const Setup& setup, const Provenance& p) {
  Json manifest = {{"experiment", setup.experiment}};
  manifest.update(originOf(setup, p));
  manifest["flags"] = p.flags;
  manifest["cpu"] = p.cpu;
  manifest["processors"] = p.processors;
  manifest["system"] = p.system;
  return manifest;
}

void addInputs(Json& manifest, std::span<const std::pair<std::string, std::string>> inputs) {
  manifest["hash"] = "XXH3, 64 bit";
  manifest["inputs"] = Json::array();
  for (const auto& [file, hash] : inputs) manifest["inputs"].push_back({{"file", file}, {"hash", hash}});
}

std::string csvOf(const Json& rows) {
  std::string text;
  if (rows.empty()) return text;
  const auto line = [&](auto field) {
    std::string out;
    for (const auto& item : rows.front().items()) {
      if (!out.empty()) out += ',';
      out += field(item.key());
    }
    text += out;
    text += '\n';
  };
  line([](const std::string& key) { return csvField(key); });
  for (const Json& row : rows)
    line([&](const std::string& key) {
      const Json& value = row[key];
      if (value.is_null()) return std::string();
      return csvField(value.is_string() ? value.get<std::string>() : value.dump());
    });
  return text;
}

std::string rowsText(const Setup& setup, const Json& rows) {
  std::string text = fmt::format("{{\"experiment\": \"{}\", \"rows\": [\n", setup.experiment);
  for (std::size_t i = 0; i < rows.size(); ++i) text += rows[i].dump() + (i + 1 < rows.size() ? ",\n" : "\n");
  return text + "]}\n";
}

Json jsonOf(std::span<const Claim> claims) {
  Json array = Json::array();
  for (const Claim& claim : claims)
    array.push_back({{"claim", claim.text},
                     {"measured", claim.measured},
                     {"holds", claim.holds ? Json(*claim.holds) : Json(nullptr)}});
  return array;
}

std::string textOf(std::span<const Claim> claims) {
  std::string text;
  for (const Claim& claim : claims)
    text +=
        fmt::format("{}: {}{}{}\n", claim.holds ? (*claim.holds ? "holds" : "DOES NOT HOLD") : "not tried",
                    claim.text, claim.measured.empty() ? "" : ": ", claim.measured);
  return text;
}

void makeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder))
    throw InputError(fmt::format("{}: cannot be made a folder ({}); --out names the folder for the results",
                                 folder.string(), error ? error.message() : "a file is in its place"));
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    throw InputError(
        fmt::format("{}: nothing can be written there ({}); --out names the folder for the results",
                    folder.string(), std::strerror(errno)));
}

ResultFolder::ResultFolder(fs::path folder) : folder_(std::move(folder)) {
  makeFolder(folder_);
}

void ResultFolder::write(const std::string& name, std::string_view bytes) {
  writeFileAtomically(folder_ / name, bytes);
  files_.push_back(name);
}

void ResultFolder::write(const std::string& name, const points::DisplayImage& image) {
  points::writePng(folder_ / name, image);
  files_.push_back(name);
}

}  // namespace restroke::experiments
