// What a model says of itself.

#include "sculpt/cli/dexel_output.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>
#include <variant>

#include "implicit/simd/dispatch.h"
#include "sculpt/cli/replaying.h"

namespace restroke::cli {

namespace {

using points::TriDexel;
using points::TriDexelDocument;

// [[least x, y, z], [greatest x, y, z]]; null for an empty solid.
nlohmann::ordered_json boundsOf(const TriDexel& model) {
  const Box box = model.bounds();
  if (box.empty()) return nullptr;
  return {{box.min.x, box.min.y, box.min.z}, {box.max.x, box.max.y, box.max.z}};
}

}  // namespace

void checkDevice(const std::string& device) {
  if (device != "cpu" && device != "opengl")
    throw InputError(fmt::format("--device: \"{}\" must be cpu or opengl", device));
}

void report(Output& output, const DexelReport& report, const nlohmann::ordered_json& more) {
  const TriDexelDocument& document = report.document;
  const TriDexel& model = document.model;
  const std::size_t lines = model.grid().lineCount(), ends = model.endCount(), bytes = model.bytes();
  std::error_code error;
  const std::uintmax_t fileBytes = std::filesystem::file_size(report.file, error);
  const char* const initial = std::holds_alternative<std::monostate>(document.initial) ? "none"
                              : std::holds_alternative<TriangleMesh>(document.initial) ? "mesh"
                                                                                       : "primitives";
  const points::GridCounts& n = model.grid().counts();
  output.say(
      fmt::format("{}: {} x {} x {} lines {:.4g} apart ({}), {} span ends; volume {:.6g}\n"
                  "initial solid: {}; {}, {}, {}\n"
                  "memory {} bytes, {:.1f} a line, {:.1f} an end; file {} bytes; {:.3f} s\n",
                  report.file, n[0], n[1], n[2], model.grid().cell(), plural(lines, "line"), grouped(ends),
                  model.volume(), initial, plural(document.tools.size(), "tool mesh"),
                  plural(document.cutters.size(), "cutter"), plural(document.operations.size(), "operation"),
                  grouped(bytes), static_cast<double>(bytes) / static_cast<double>(lines),
                  ends == 0 ? 0.0 : static_cast<double>(bytes) / static_cast<double>(ends),
                  grouped(fileBytes), report.seconds));
  nlohmann::ordered_json json{{"file", report.file},
                              {"counts", {n[0], n[1], n[2]}},
                              {"cell", model.grid().cell()},
                              {"lines", lines},
                              {"ends", ends},
                              {"bounds", boundsOf(model)},
                              {"volume", model.volume()},
                              {"volumes", {model.volumeOf(0), model.volumeOf(1), model.volumeOf(2)}},
                              {"initial", initial},
                              {"tools", document.tools.size()},
                              {"cutters", document.cutters.size()},
                              {"operations", document.operations.size()},
                              {"state_hash", hexHash(model.stateHash())},
                              {"simd", implicit::simdLevelName()},
                              {"model_bytes", bytes},
                              {"file_bytes", fileBytes}};
  json.update(more);
  json["seconds"] = report.seconds;
  output.finish(json);
}

}  // namespace restroke::cli
