#include "points/dexel/refine/history.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <mutex>
#include <utility>

#include "implicit/errors.h"
#include "points/dexel/mesh_solid.h"
#include "points/dexel/refine/box_tree.h"
#include "points/dexel/toolpath/swept_cutter.h"

namespace restroke::points {

namespace {

using implicit::Primitive;
using implicit::Shape;
using implicit::Sign;
using implicit::Sphere;

// A posed volume of another kind than the ball.
class ShapeSolid final : public ToolSolid {
 public:
  explicit ShapeSolid(const Shape& shape) : shape_(shape) { setBounds(boundsOf(shape)); }
  void intersect(const Ray& line, std::vector<SolidSpan>& spans) const override {
    thread_local std::vector<RayInterval> intervals;
    intervals.clear();
    implicit::intersect(shape_, line, intervals);
    for (const RayInterval& in : intervals)
      spans.push_back({in.enter, in.exit, Vec3(outwardNormal(shape_, line.at(in.enter))),
                       Vec3(outwardNormal(shape_, line.at(in.exit)))});
  }

 private:
  Shape shape_;
};

const Box& everything() {
  static const Box box{Point(-std::numeric_limits<float>::max()), Point(std::numeric_limits<float>::max())};
  return box;
}

// A ball about a box.
Sphere ballAround(const Box& box) {
  if (box.empty()) return {Point(0), 0};
  return {box.center(), box.halfDiagonal() * (1 + 0x1p-20f)};
}

}  // namespace

struct DexelHistory::State {
  // Of each step: the initial solid's, then one for each operation.
  std::vector<Sphere> balls;  // of other solids a ball around them
  std::vector<DexelOperation> operations;
  std::vector<std::uint8_t> isBall;
  std::vector<std::uint32_t> solidOf;  // only if some are no balls
  std::vector<std::unique_ptr<const ToolSolid>> solids;
  std::vector<std::uint32_t> everywhere;  // steps that no bounds hold: intersections
  std::size_t initialSteps = 0;

  // Of all steps that are not everywhere.
  std::unique_ptr<const BoxTree> clusters;

  void add(const Sphere& ball, DexelOperation operation) {
    if (operation == DexelOperation::Intersection)
      everywhere.push_back(static_cast<std::uint32_t>(balls.size()));
    balls.push_back(ball);
    operations.push_back(operation);
  }
  void addBall(const Sphere& ball, DexelOperation operation) {
    add(ball, operation);
    isBall.push_back(1);
    if (!solidOf.empty()) solidOf.push_back(0);
  }
  void addSolid(std::unique_ptr<const ToolSolid> solid, DexelOperation operation) {
    solidOf.resize(balls.size());
    solidOf.push_back(static_cast<std::uint32_t>(solids.size()));
    add(ballAround(solid->bounds()), operation);
    isBall.push_back(0);
    solids.push_back(std::move(solid));
  }
  void addShape(const Shape& shape, DexelOperation operation) {
    if (shape.isSphere())
      addBall(shape.ball(), operation);
    else
      addSolid(std::make_unique<ShapeSolid>(shape), operation);
  }
  [[nodiscard]] Box boundsAt(std::size_t step) const {
    if (operations[step] == DexelOperation::Intersection) return everything();
    return isBall[step] != 0 ? implicit::boundsOf(balls[step]) : solids[solidOf[step]]->bounds();
  }
  // By an id's number.
  [[nodiscard]] std::size_t firstStep(std::size_t id) const { return id == 0 ? 0 : initialSteps + id - 1; }
  [[nodiscard]] std::size_t stepCount(std::size_t id) const { return id == 0 ? initialSteps : 1; }
  [[nodiscard]] OperationId idOf(std::size_t step) const {
    return static_cast<OperationId>(step < initialSteps ? 0 : step - initialSteps + 1);
  }
  [[nodiscard]] bool mayMeet(std::size_t step, const Zone& zone) const {
    if (operations[step] != DexelOperation::Intersection) {
      // Quickly, in float32, with more room than rounding takes: most are far away.
      const Box& box = zone.bounds();
      const Sphere& ball = balls[step];
      const float r = ball.radius;
      const auto apart = [&](int a) {
        const float by = r + (std::fabs(ball.center[a]) + r) * 0x1p-20f;
        return ball.center[a] + by < box.min[a] || ball.center[a] - by > box.max[a];
      };
      if (apart(0) || apart(1) || apart(2)) return false;
    }
    return zone.mayMeet(boundsAt(step));
  }
};

DexelHistory::DexelHistory(const TriDexelDocument& document, const Execution&)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  std::map<const TriangleMesh*, std::shared_ptr<const MeshForLines>> meshes;
  const auto lined = [&](const TriangleMesh& mesh) {
    std::shared_ptr<const MeshForLines>& known = meshes[&mesh];
    if (!known) known = std::make_shared<const MeshForLines>(mesh);
    return known;
  };
  if (const auto* mesh = std::get_if<TriangleMesh>(&document.initial))
    s.addSolid(std::make_unique<MeshSolid>(lined(*mesh), kIdentityPose), DexelOperation::Union);
  if (const auto* primitives = std::get_if<std::vector<Primitive>>(&document.initial))
    for (const Primitive& primitive : *primitives)
      s.addShape(primitive.shape,
                 primitive.sign == Sign::Positive ? DexelOperation::Union : DexelOperation::Subtraction);
  s.initialSteps = s.balls.size();
  const std::size_t steps = s.initialSteps + document.operations.size();
  s.balls.reserve(steps);
  s.operations.reserve(steps);
  s.isBall.reserve(steps);
  for (std::size_t i = 0; i < document.operations.size(); ++i) {
    const TriDexelDocument::Operation& operation = document.operations[i];
    try {
      if (const auto* shape = std::get_if<Shape>(&operation.tool)) {
        s.addShape(*shape, operation.operation);
      } else if (const auto* posed = std::get_if<TriDexelDocument::PosedTool>(&operation.tool)) {
        s.addSolid(std::make_unique<MeshSolid>(lined(document.tools.at(posed->tool)), posed->pose),
                   operation.operation);
      } else {
        const CutterMove& move = std::get<CutterMove>(operation.tool);
        s.addSolid(std::make_unique<SweptCutter>(document.cutters.at(move.cutter), move.element),
                   operation.operation);
      }
    } catch (const InputError& error) {
      throw InputError(fmt::format("operation {}: {}", i + 1, error.what()));
    }
  }
}

DexelHistory::~DexelHistory() = default;
DexelHistory::DexelHistory(DexelHistory&&) noexcept = default;
DexelHistory& DexelHistory::operator=(DexelHistory&&) noexcept = default;

std::size_t DexelHistory::idCount() const {
  return state_->balls.size() - state_->initialSteps + 1;
}

void DexelHistory::stepsOf(OperationId id, std::vector<HistoryStep>& steps) const {
  const State& s = *state_;
  const auto number = static_cast<std::size_t>(id);
  const std::size_t first = s.firstStep(number);
  for (std::size_t i = first; i < first + s.stepCount(number); ++i) {
    HistoryStep step{.operation = s.operations[i], .id = id};
    if (s.isBall[i] != 0)
      step.ball = &s.balls[i];
    else
      step.solid = s.solids[s.solidOf[i]].get();
    steps.push_back(step);
  }
}

Box DexelHistory::boundsOf(OperationId id) const {
  const auto number = static_cast<std::size_t>(id);
  Box box;
  for (std::size_t i = 0; i < state_->stepCount(number); ++i)
    box.add(state_->boundsAt(state_->firstStep(number) + i));
  return box;
}

std::vector<OperationId> DexelHistory::idsByBounds(const Zone& zone) const {
  const State& s = *state_;
  std::vector<OperationId> ids;
  for (std::size_t i = 0; i < s.balls.size(); ++i) {
    const OperationId id = s.idOf(i);
    if (!ids.empty() && ids.back() == id) continue;
    if (s.mayMeet(i, zone)) ids.push_back(id);
  }
  return ids;
}

void DexelHistory::makeClusters() const {
  State& s = *state_;
  if (s.clusters) return;
  std::vector<Box> boxes(s.balls.size());
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if (s.operations[i] != DexelOperation::Intersection) boxes[i] = s.boundsAt(i);
  s.clusters = std::make_unique<const BoxTree>(boxes);
}

std::vector<OperationId> DexelHistory::idsByClusters(const Zone& zone) const {
  makeClusters();
  const State& s = *state_;
  // A bit for each step puts them in order.
  std::vector<std::uint64_t> found((s.balls.size() + 63) / 64);
  const auto take = [&](std::uint32_t step) {
    if (s.mayMeet(step, zone)) found[step / 64] |= std::uint64_t{1} << step % 64;
  };
  for (const std::uint32_t step : s.everywhere) take(step);
  s.clusters->forEachNear(zone.bounds(), take);
  std::vector<OperationId> ids;
  for (std::size_t word = 0; word < found.size(); ++word)
    for (std::uint64_t rest = found[word]; rest != 0; rest &= rest - 1) {
      const OperationId id = s.idOf(64 * word + static_cast<std::size_t>(std::countr_zero(rest)));
      if (ids.empty() || ids.back() != id) ids.push_back(id);
    }
  return ids;
}

std::size_t DexelHistory::bytes() const {
  const State& s = *state_;
  return s.balls.capacity() * sizeof(Sphere) + s.operations.capacity() + s.isBall.capacity() +
         s.solidOf.capacity() * sizeof(std::uint32_t) +
         s.solids.capacity() * (sizeof(void*) + sizeof(ShapeSolid));
}

std::size_t DexelHistory::clusterBytes() const {
  return state_->clusters ? state_->clusters->bytes() : 0;
}

}  // namespace restroke::points
