// Lines for a zone: denser, in another direction, fewer (SPEC R3).

#include <algorithm>
#include <cmath>

#include "implicit/errors.h"
#include "implicit/process_memory.h"
#include "points/dexel/refine/refine.h"

namespace restroke::points {

namespace {

// A Dexels with operations, the depths that count, and a little for lines with several spans.
constexpr double kBytesPerLine = 48;

void refuseTooMany(double lines) {
  const auto available = availableBytes();
  if (lines <= 0x1p31 && !(available && lines * kBytesPerLine > static_cast<double>(*available))) return;
  throw InputError(fmt::format(
      "{:.3g} lines take {:.3g} GB{}; they must fit, and be no more than 2^31", lines,
      lines * kBytesPerLine * 1e-9,
      available ? fmt::format(" of the {:.3g} GB that are free", static_cast<double>(*available) * 1e-9)
                : ""));
}

bool isUpright(const OrientedBox& box) {
  return box.axes[0] == DVec3(1, 0, 0) && box.axes[1] == DVec3(0, 1, 0) && box.axes[2] == DVec3(0, 0, 1);
}

// As DexelGrid has them: a depth is the coordinate along the axis.
std::vector<LineFamily> alongCoordinates(const DexelGrid& grid) {
  std::vector<LineFamily> out;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    LineFamily family{.width = grid.width(axis), .height = grid.height(axis)};
    family.direction = DVec3(0);
    family.direction[axis] = 1;
    family.origin[u] = static_cast<double>(grid.at(u, 0));
    family.origin[v] = static_cast<double>(grid.at(v, 0));
    family.originStep[u] = grid.cell();
    family.originRowStep[v] = grid.cell();
    out.push_back(family);
  }
  return out;
}

double cellOf(double longest, const NewLines& options) {
  if (options.resolution && options.cell)
    throw InputError("lines: a resolution and a cell are given; at most one of them must be");
  if (options.cell) return *options.cell;
  const int lines = options.resolution.value_or(kDefaultLines);
  if (lines < 1 || lines > kMostLines)
    throw InputError(
        fmt::format("lines: {} along the longest side; there must be 1 to {}", lines, kMostLines));
  return longest / lines;
}

std::vector<LineFamily> alongAxes(const OrientedBox& box, double cell) {
  if (!(std::isfinite(cell) && cell > 0))
    throw InputError(fmt::format("lines: {} apart; it must be greater than 0", cell));
  std::array<int, 3> counts;
  for (int a = 0; a < 3; ++a) {
    const double lines = std::max(1.0, std::ceil(2 * box.half[a] / cell - 1e-9));
    if (lines > kMostLines)
      throw InputError(fmt::format("lines: {:.6g} apart there would be {} in a row; at most {} are allowed",
                                   cell, lines, kMostLines));
    counts[static_cast<std::size_t>(a)] = static_cast<int>(lines);
  }
  std::vector<LineFamily> out;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    LineFamily family{.width = counts[u], .height = counts[v]};
    family.direction = box.axes[axis];
    family.originStep = cell * box.axes[u];
    family.originRowStep = cell * box.axes[v];
    family.origin =
        box.center - (counts[u] - 1) / 2.0 * family.originStep - (counts[v] - 1) / 2.0 * family.originRowStep;
    out.push_back(family);
  }
  return out;
}

std::vector<LineFamily> inBox(const OrientedBox& box, const Box& bounds, const NewLines& options) {
  if (options.perPixel) throw InputError("lines: one a pixel is for frustums; a box has no pixels");
  const double cell = cellOf(2 * std::max({box.half.x, box.half.y, box.half.z}), options);
  if (options.direction) return {latticeAlong(*options.direction, bounds, cell)};
  if (!isUpright(box)) return alongAxes(box, cell);
  const Box exact{Point(box.center - box.half), Point(box.center + box.half)};
  return alongCoordinates(dexelGridFor(exact, {.resolution = std::nullopt, .cell = cell}));
}

LineFamily inFrustum(Camera camera, const NewLines& options) {
  if (options.cell)
    throw InputError("lines: a frustum's lines spread, and have no cell; a resolution must be given");
  if (options.direction)
    throw InputError("lines: a frustum's lines are its rays; no direction must be given");
  if (options.perPixel && options.resolution)
    throw InputError("lines: one a pixel and a resolution are given; at most one of them must be");
  if (options.resolution) {
    const double scale = cellOf(1.0, options) * std::max(camera.width, camera.height);
    const auto scaled = [&](std::uint32_t pixels) {
      return static_cast<std::uint32_t>(std::max(1.0, std::floor(pixels / scale + 0.5)));
    };
    camera.width = scaled(camera.width);
    camera.height = scaled(camera.height);
  }
  return raysOf(camera);
}

}  // namespace

std::vector<LineFamily> newLines(const Zone& zone, const NewLines& options) {
  std::vector<LineFamily> out;
  if (const auto* box = std::get_if<OrientedBox>(&zone.shape())) {
    out = inBox(*box, zone.bounds(), options);
  } else if (const auto* ball = std::get_if<implicit::Sphere>(&zone.shape())) {
    const double r = static_cast<double>(ball->radius);
    out = inBox({.center = DVec3(ball->center), .half = DVec3(r)}, zone.bounds(), options);
  } else {
    out = {inFrustum(std::get<Camera>(zone.shape()), options)};
  }
  double lines = 0;
  for (const LineFamily& family : out) lines += static_cast<double>(family.width) * family.height;
  refuseTooMany(lines);
  return out;
}

}  // namespace restroke::points
