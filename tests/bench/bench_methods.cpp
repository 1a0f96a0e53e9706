// What each method costs a stroke: before its first point, and for each point after that (SPEC S7: the paper
// complains that drawing the depth makes redo lag). Every stroke of a log is cast on the log's end state.
//
//   bench_methods [--smoke] [LOG]      the example of the paper's scale without one

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "implicit/errors.h"
#include "retarget/anchors.h"
#include "retarget/method.h"
#include "retarget/trail.h"
#include "sculpt/document.h"
#include "sculpt/replay.h"
#include "sculpt/stroke_log.h"

namespace restroke::bench {
namespace {

using retarget::CasterInput;
using retarget::Method;

/// Primitives of the list itself, named by position: nothing has changed.
class OwnersOfList final : public retarget::Owners {
 public:
  explicit OwnersOfList(const implicit::PrimitiveList& list) : list_(list) {}
  [[nodiscard]] std::optional<implicit::Primitive> find(retarget::OwnerKey owner) const override {
    return owner.index < list_.size() ? std::optional(list_.at(owner.index)) : std::nullopt;
  }

 private:
  const implicit::PrimitiveList& list_;
};

/// None is left.
class NoOwners final : public retarget::Owners {
 public:
  [[nodiscard]] std::optional<implicit::Primitive> find(retarget::OwnerKey) const override {
    return std::nullopt;
  }
};

/// A map that is not affine: it bends space by the square of a coordinate.
class Bend final : public SpaceMap {
 public:
  [[nodiscard]] DVec3 point(DVec3 p) const override { return {p.x + 0.1 * p.y * p.y, p.y, p.z}; }
  [[nodiscard]] DVec3 normal(DVec3 p, DVec3 n) const override { return {n.x, n.y - 0.2 * p.y * n.x, n.z}; }
  [[nodiscard]] double scaleAt(DVec3) const override { return 1; }
};

struct DrawnStroke {
  const retarget::Stroke* stroke;
  retarget::Trail trail;  ///< on the end state, with anchors
};

struct Cost {
  std::vector<double> before;    ///< seconds, of each stroke: the caster and the first point
  std::vector<double> perPoint;  ///< seconds, of each stroke: the mean of its further points
  std::vector<double> whole;     ///< seconds, of each stroke
};

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double medianOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

/// One row of the table.
struct Row {
  std::string name;
  Method method;
  std::function<retarget::Change(const DrawnStroke&)> change = [](const DrawnStroke&) {
    return retarget::Change{};
  };
};

void castStroke(const Row& row, const points::SurfelModel& model, const DrawnStroke& drawn, Cost& cost) {
  const auto& points = drawn.stroke->points;
  const auto start = std::chrono::steady_clock::now();
  const auto caster =
      makeCaster(row.method, {.model = model, .camera = drawn.stroke->camera, .change = row.change(drawn)});
  std::size_t hits = caster->cast({points[0].screen, 0}).has_value();
  cost.before.push_back(secondsSince(start));
  const auto first = std::chrono::steady_clock::now();
  for (std::size_t i = 1; i < points.size(); ++i)
    hits += caster->cast({points[i].screen, static_cast<double>(i)}).has_value();
  if (points.size() > 1)
    cost.perPoint.push_back(secondsSince(first) / static_cast<double>(points.size() - 1));
  cost.whole.push_back(secondsSince(start));
  if (hits > points.size()) fmt::print("more hits than points\n");  // hits are used
}

std::vector<DrawnStroke> drawnStrokes(const sculpt::StrokeLog& log, const points::SurfelModel& model) {
  std::vector<DrawnStroke> drawn;
  for (const sculpt::Command& command : log.commands) {
    const auto* stroke = std::get_if<sculpt::StrokeCommand>(&command);
    if (!stroke) continue;
    const auto exact = makeCaster(Method::Exact, model, stroke->stroke.camera);
    retarget::TrailRecorder recorder(*exact);
    for (std::size_t i = 0; i < stroke->stroke.points.size(); ++i)
      static_cast<void>(recorder.cast({stroke->stroke.points[i].screen, static_cast<double>(i)}));
    drawn.push_back({&stroke->stroke, recorder.take()});
    setAnchors(drawn.back().trail, model.list(), [&](implicit::PrimitiveId id) {
      return retarget::OwnerKey{0, static_cast<std::uint32_t>(model.list().positionOf(id))};
    });
  }
  return drawn;
}

int main(int argc, char** argv) {
  bool smoke = false;
  std::filesystem::path file =
      std::filesystem::path(RESTROKE_SOURCE_DIR) / "experiments/examples/paper-scale.log";
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--smoke") == 0)
      smoke = true;
    else
      file = argv[i];
  }
  const sculpt::StrokeLog log = sculpt::readLog(file);
  const sculpt::Document document = sculpt::replay(log);
  const points::SurfelModel& model = document.model();
  const std::vector<DrawnStroke> drawn = drawnStrokes(log, model);
  std::size_t points = 0;
  for (const DrawnStroke& d : drawn) points += d.stroke->points.size();
  fmt::print("{}: {} primitives, {} surfels, {} strokes of {:.0f} points\n", file.filename().string(),
             model.list().size(), model.surfelCount(), drawn.size(),
             drawn.empty() ? 0.0 : static_cast<double>(points) / static_cast<double>(drawn.size()));

  const OwnersOfList owners(model.list());
  const NoOwners none;
  const AffineMap affine({.offset = {0.01, 0, 0}});
  const Bend bend;
  const auto with = [](retarget::Change change) {
    return [change](const DrawnStroke& d) {
      retarget::Change filled = change;
      filled.original = &d.trail;
      return filled;
    };
  };
  const std::vector<Row> rows{{"depth", Method::Depth},
                              {"depth-cpu", Method::DepthCpu},
                              {"embree", Method::Embree},
                              {"exact", Method::Exact},
                              {"fixed", Method::Fixed, with({})},
                              {"nearest", Method::Nearest, with({})},
                              {"mapped, affine", Method::Mapped, with({.map = &affine})},
                              {"mapped, bent", Method::Mapped, with({.map = &bend})},
                              {"surface", Method::Surface, with({.owners = &owners})},
                              {"surface, owners gone", Method::Surface, with({.owners = &none})}};
  fmt::print("{:<22}{:>10}{:>22}{:>16}{:>18}\n", "method", "strokes", "before 1st point, ms", "a point, us",
             "a stroke, ms");
  for (const Row& row : rows) {
    Cost cost;
    try {
      // Once unmeasured: what a process makes once (an OpenGL context, a thread pool) is no stroke's cost.
      Cost warmUp;
      if (!drawn.empty()) castStroke(row, model, drawn[0], warmUp);
      const std::size_t most = smoke ? 1 : 27, step = std::max<std::size_t>(1, drawn.size() / most);
      for (std::size_t i = 0; i < drawn.size() && cost.before.size() < most; i += step)
        castStroke(row, model, drawn[i], cost);
    } catch (const InputError& error) {
      fmt::print("{:<22}{}\n", row.name, error.what());
      continue;
    }
    fmt::print("{:<22}{:>10}{:>22.3f}{:>16.3f}{:>18.3f}\n", row.name, cost.before.size(),
               1e3 * medianOf(cost.before), 1e6 * medianOf(cost.perPoint), 1e3 * medianOf(cost.whole));
  }
  return 0;
}

}  // namespace
}  // namespace restroke::bench

int main(int argc, char** argv) {
  return restroke::bench::main(argc, argv);
}
