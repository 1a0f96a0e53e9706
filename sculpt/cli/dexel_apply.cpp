// restroke dexel apply: a tool cuts, or is added, in one pose after the other or along a path.

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "points/dexel/dexel_tool.h"
#include "points/dexel/gl/gl_tri_dexel.h"
#include "points/dexel/tool_pose.h"
#include "points/files/mesh_files.h"
#include "sculpt/base_change.h"
#include "sculpt/cli/commands.h"
#include "sculpt/cli/dexel_output.h"
#include "sculpt/cli/dexel_toolpath.h"
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
  if (mode.empty() || mode == "cut") return DexelOperation::Subtraction;
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

// One tool in each of the poses; returns what is to be reported.
nlohmann::ordered_json applyInPoses(const DexelApplyOptions& options, TriDexelDocument& document) {
  const DexelOperation operation = operationNamed(options.mode);
  if (options.device == "opengl" && document.model.keepsHistory())
    throw InputError(
        fmt::format("{}: its lines keep every operation that changes them, which --device opengl does not "
                    "note; it must be cpu",
                    options.model));
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
  return {{"poses", poses.size()}};
}

}  // namespace

int runDexelApply(const DexelApplyOptions& options) {
  const auto start = Clock::now();
  checkDevice(options.device);
  checkToolpathOptions(options);
  Output output(options.common);
  TriDexelDocument document = points::readTriDexel(options.model);
  nlohmann::ordered_json more =
      options.toolpath.empty() ? applyInPoses(options, document) : applyToolpath(options, document);
  more.update(mergedIf(options.resultants, document, output, executionOf(options.common)));
  points::writeTriDexel(options.out, document);
  report(output, {options.out, document, std::chrono::duration<double>(Clock::now() - start).count()}, more);
  return 0;
}

}  // namespace restroke::cli
