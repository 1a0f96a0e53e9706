// restroke dexel apply: a tool cuts, or is added, in one pose after the other; and the report on a model.

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "implicit/simd/dispatch.h"
#include "points/dexel/dexel_tool.h"
#include "points/dexel/gl/gl_tri_dexel.h"
#include "points/dexel/tool_pose.h"
#include "points/files/mesh_files.h"
#include "sculpt/base_change.h"
#include "sculpt/cli/commands.h"
#include "sculpt/cli/dexel_output.h"
#include "sculpt/cli/replaying.h"
#include "sculpt/cli/sources.h"
#include "sculpt/shape_text.h"

namespace restroke::cli {

namespace {

using Clock = std::chrono::steady_clock;
using points::DexelOperation;
using points::OperationId;
using points::PoseMatrix;
using points::TriDexel;
using points::TriDexelDocument;

Affine affineOf(const PoseMatrix& m) {
  std::array<float, 12> rows;
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = static_cast<float>(m[i]);
  return sculpt::affineOf(rows);
}

// A run of one tool.
struct Run {
  TriDexelDocument& document;
  DexelOperation operation;
  const std::vector<PoseMatrix>& poses;
  Execution execution;

  [[nodiscard]] OperationId nextId() const {
    return static_cast<OperationId>(static_cast<std::uint32_t>(document.operations.size()) + 1);
  }
  [[nodiscard]] std::string placeOf(std::size_t pose) const { return fmt::format("pose {}", pose + 1); }
};

DexelOperation operationNamed(const std::string& mode) {
  if (mode == "cut") return DexelOperation::Subtraction;
  if (mode == "add") return DexelOperation::Union;
  if (mode == "intersect") return DexelOperation::Intersection;
  throw InputError(fmt::format("--mode: \"{}\" must be cut, add or intersect", mode));
}

void applyShape(const Run& run, const implicit::Shape& shape) {
  const bool adds = run.operation == DexelOperation::Union;
  TriDexel& model = run.document.model;
  Progress progress("apply", run.poses.size());
  for (std::size_t i = 0; i < run.poses.size(); ++i) {
    const implicit::Primitive primitive{sculpt::mappedShape(shape, affineOf(run.poses[i]), run.placeOf(i)),
                                        adds ? implicit::Sign::Positive : implicit::Sign::Negative};
    if (adds) model.growTo(boundsOf(primitive.shape));
    if (run.operation == DexelOperation::Intersection)
      model.intersect(primitive.shape, run.nextId(), run.execution);
    else
      model.apply({&primitive, 1}, run.nextId(), run.execution);
    run.document.operations.push_back({run.operation, primitive.shape});
    progress.update(i + 1);
  }
}

// The number that the tool has, or gets, in the document.
std::uint32_t numberOf(TriDexelDocument& document, const TriangleMesh& tool) {
  const auto known = std::find(document.tools.begin(), document.tools.end(), tool);
  const auto number = static_cast<std::uint32_t>(known - document.tools.begin());
  if (known == document.tools.end()) document.tools.push_back(tool);
  return number;
}

void growTo(const Run& run, const points::DexelTool& tool) {
  if (run.operation != DexelOperation::Union) return;
  Box box;
  for (std::size_t i = 0; i < run.poses.size(); ++i)
    box.add(named(run.placeOf(i), [&] { return tool.in(run.poses[i]).box; }));
  run.document.model.growTo(box);
}

void applyTool(const Run& run, const points::DexelTool& tool) {
  const std::uint32_t number = numberOf(run.document, tool.mesh());
  growTo(run, tool);
  Progress progress("apply", run.poses.size());
  for (std::size_t i = 0; i < run.poses.size(); ++i) {
    named(run.placeOf(i), [&] {
      apply(run.document.model, tool, {run.poses[i], run.operation, run.nextId()}, run.execution);
    });
    run.document.operations.push_back({run.operation, TriDexelDocument::PosedTool{number, run.poses[i]}});
    progress.update(i + 1);
  }
}

// The model and the tool stay on the graphics card from the first pose to the last.
void applyToolDrawn(const Run& run, const points::DexelTool& tool) {
  const std::uint32_t number = numberOf(run.document, tool.mesh());
  growTo(run, tool);
  const points::GlDexelContext context;
  points::GlTriDexel model(context, run.document.model.grid()), posed(context, run.document.model.grid());
  const points::GlMesh mesh(context, tool.mesh());
  model.upload(run.document.model);
  Progress progress("apply", run.poses.size());
  for (std::size_t i = 0; i < run.poses.size(); ++i) {
    named(run.placeOf(i), [&] {
      points::checkPose(run.poses[i]);
      posed.peel(mesh, {.pose = run.poses[i]});
    });
    model.apply(posed, run.operation, run.nextId());
    run.document.operations.push_back({run.operation, TriDexelDocument::PosedTool{number, run.poses[i]}});
    progress.update(i + 1);
  }
  run.document.model = model.download();
}

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
                  "initial solid: {}; {}, {}\n"
                  "memory {} bytes, {:.1f} a line, {:.1f} an end; file {} bytes; {:.3f} s\n",
                  report.file, n[0], n[1], n[2], model.grid().cell(), plural(lines, "line"), grouped(ends),
                  model.volume(), initial, plural(document.tools.size(), "tool mesh"),
                  plural(document.operations.size(), "operation"), grouped(bytes),
                  static_cast<double>(bytes) / static_cast<double>(lines),
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
                              {"operations", document.operations.size()},
                              {"state_hash", hexHash(model.stateHash())},
                              {"simd", implicit::simdLevelName()},
                              {"model_bytes", bytes},
                              {"file_bytes", fileBytes}};
  json.update(more);
  json["seconds"] = report.seconds;
  output.finish(json);
}

int runDexelApply(const DexelApplyOptions& options) {
  const auto start = Clock::now();
  checkDevice(options.device);
  const DexelOperation operation = operationNamed(options.mode);
  Output output(options.common);
  TriDexelDocument document = points::readTriDexel(options.model);
  const std::vector<PoseMatrix> poses =
      options.poses.empty() ? std::vector{points::kIdentityPose} : points::readPoses(options.poses);
  const Run run{document, operation, poses, executionOf(options.common)};
  if (sourceKindOf(options.tool) == SourceKind::Mesh) {
    const TriangleMesh mesh = points::readMesh(options.tool);
    const points::DexelTool tool =
        named(options.tool, [&] { return points::DexelTool(mesh, run.execution); });
    options.device == "opengl" ? applyToolDrawn(run, tool) : applyTool(run, tool);
  } else if (options.device == "opengl") {
    throw InputError(fmt::format("{}: is no mesh file, but --device opengl draws meshes", options.tool));
  } else {
    applyShape(run, sculpt::shapeNamed(options.tool, sculpt::Repair::None, "--tool"));
  }
  points::writeTriDexel(options.out, document);
  report(output, {options.out, document, std::chrono::duration<double>(Clock::now() - start).count()},
         {{"poses", poses.size()}});
  return 0;
}

}  // namespace restroke::cli
