#include "experiments/dexel/slice.h"

#include <fmt/format.h>

#include <cmath>

#include "experiments/dexel.h"
#include "implicit/primitive_list.h"
#include "implicit/side.h"
#include "points/dexel/tri_dexel.h"

namespace restroke::experiments {
namespace {

using points::DexelGrid;

std::string line(const char* kind, DVec3 from, DVec3 to) {
  return fmt::format("{},{:.7g},{:.7g},{:.7g},{:.7g}\n", kind, from.x, from.y, to.x, to.y);
}

std::string cells(const implicit::PrimitiveList& list, const DexelGrid& grid, int z) {
  std::string text;
  const DVec3 half = DVec3(grid.cell() / 2);
  for (int y = 0; y < grid.counts()[1]; ++y)
    for (int x = 0; x < grid.counts()[0]; ++x) {
      const Point middle = grid.at({x, y, z});
      if (sideOf(list, middle) == implicit::Side::Inside)
        text += line("cell", DVec3(middle) - half, DVec3(middle) + half);
    }
  return text;
}

/// Spans of the family along x or y whose lines are in the plane.
std::string spans(const points::TriDexel& model, int axis, int z) {
  const int across = 1 - axis;
  const points::Dexels& dexels = model.family(axis);
  std::string text;
  points::LineEnds ends;
  for (int i = 0; i < model.grid().counts()[static_cast<std::size_t>(across)]; ++i) {
    dexels.read(axis == 0 ? dexels.lineAt(i, z) : dexels.lineAt(z, i), ends);
    const auto place = [&](const points::SpanEnd& end) {
      DVec3 p{0};
      p[axis] = static_cast<double>(end.depth);
      p[across] = static_cast<double>(model.grid().at(across, i));
      return p;
    };
    for (std::size_t k = 0; k < ends.size(); k += 2)
      text += line(axis == 0 ? "row" : "column", place(ends[k]), place(ends[k + 1]));
    for (const points::SpanEnd& end : ends)
      text += line("end", place(end), DVec3(points::unpackNormal(end.normal)));
  }
  return text;
}

}  // namespace

std::string sliceTable(int resolution) {
  implicit::PrimitiveList list;
  const DexelSource source = analyticBall();
  list.insert(0, source.primitives);
  const DexelGrid grid = points::dexelGridFor(list.bounds(), {.resolution = resolution});
  const points::TriDexel model = triDexelOf(list, grid);
  const int z = grid.counts()[2] / 2;

  const auto ball = source.primitives.front().shape.ball();
  const double height = static_cast<double>(grid.at(2, z)) - static_cast<double>(ball.center.z),
               radius = static_cast<double>(ball.radius);
  std::string text = "kind,x0,y0,x1,y1\n";
  text += line("cells", {grid.cell(), 0, 0}, {grid.counts()[0], grid.counts()[1], 0});
  text += line("disc", DVec3(ball.center), {std::sqrt(radius * radius - height * height), 0, 0});
  return text + cells(list, grid, z) + spans(model, 1, z) + spans(model, 0, z);
}

}  // namespace restroke::experiments
