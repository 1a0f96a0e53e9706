#include "points/dexel/refine/new_lines.h"

#include <algorithm>
#include <cmath>

#include "implicit/errors.h"
#include "implicit/process_memory.h"

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

DexelGridOptions checked(const NewLines& options) {
  if (options.perPixel) throw InputError("lines: one a pixel is for frustums; a box has no pixels");
  if ((options.resolution ? 1 : 0) + (options.cell ? 1 : 0) + (options.among ? 1 : 0) > 1)
    throw InputError(
        "lines: of a resolution, a cell and the model's own lines more than one is given; at most one must "
        "be");
  if (options.resolution && (*options.resolution < 1 || *options.resolution > kMostLines))
    throw InputError(fmt::format("lines: {} along the longest side; there must be 1 to {}",
                                 *options.resolution, kMostLines));
  return {.resolution = options.resolution, .cell = options.cell};
}

// The points of a finer grid that are in the bounds, with those of the grid itself among them.
DexelGrid gridAmong(const NewLines::Among& among, const Box& bounds) {
  if (among.times < 1 || among.times > kMostLines)
    throw InputError(
        fmt::format("lines: {} times as many were asked for; it must be 1 to {}", among.times, kMostLines));
  DexelGrid::Parts parts = among.grid.parts();
  parts.cell /= among.times;
  for (int a = 0; a < 3; ++a) {
    const auto i = static_cast<std::size_t>(a);
    const double low = std::ceil((static_cast<double>(bounds.min[a]) - parts.anchor[a]) / parts.cell),
                 high = std::floor((static_cast<double>(bounds.max[a]) - parts.anchor[a]) / parts.cell);
    constexpr double kFarthest = 1 << 28;
    if (high - low + 1 > kMostLines || low < -kFarthest || high > kFarthest)
      throw InputError(
          fmt::format("lines: {:.6g} apart there would be {:.6g} along an axis; at most {} are allowed",
                      parts.cell, high - low + 1, kMostLines));
    parts.first[i] = static_cast<int>(low);
    parts.counts[i] = std::max(0, static_cast<int>(high - low) + 1);
  }
  return DexelGrid(parts);
}

// A ball's is the cube around it.
OrientedBox boxOf(const Zone& zone) {
  if (const auto* box = std::get_if<OrientedBox>(&zone.shape())) return *box;
  const auto& ball = std::get<implicit::Sphere>(zone.shape());
  return {.center = DVec3(ball.center), .half = DVec3(static_cast<double>(ball.radius))};
}

LineFamily inFrustum(Camera camera, const NewLines& options) {
  if (options.cell)
    throw InputError("lines: a frustum's lines spread, and have no cell; a resolution must be given");
  if (options.direction)
    throw InputError("lines: a frustum's lines are its rays; no direction must be given");
  if (options.perPixel && options.resolution)
    throw InputError("lines: one a pixel and a resolution are given; at most one of them must be");
  if (options.resolution) {
    if (*options.resolution < 1 || *options.resolution > kMostLines)
      throw InputError(fmt::format("lines: {} along the picture's longer side; there must be 1 to {}",
                                   *options.resolution, kMostLines));
    const double scale = static_cast<double>(std::max(camera.width, camera.height)) / *options.resolution;
    const auto scaled = [&](std::uint32_t pixels) {
      return static_cast<std::uint32_t>(std::max(1.0, std::floor(pixels / scale + 0.5)));
    };
    camera.width = scaled(camera.width);
    camera.height = scaled(camera.height);
  }
  return raysOf(camera);
}

}  // namespace

LineFamily familyOf(const ZoneGrid& zone, int axis) {
  const DexelGrid& grid = zone.grid;
  const auto a = static_cast<std::size_t>(axis), u = (a + 1) % 3, v = (a + 2) % 3;
  DVec3 first(0);
  first[static_cast<int>(u)] = static_cast<double>(grid.at(static_cast<int>(u), 0));
  first[static_cast<int>(v)] = static_cast<double>(grid.at(static_cast<int>(v), 0));
  return {.width = grid.width(axis),
          .height = grid.height(axis),
          .origin = zone.inModel(first),
          .direction = zone.axes[a],
          .originStep = grid.cell() * zone.axes[u],
          .originRowStep = grid.cell() * zone.axes[v]};
}

std::optional<ZoneGrid> gridFor(const Zone& zone, const NewLines& options) {
  if (std::holds_alternative<Camera>(zone.shape()) || options.direction) return std::nullopt;
  const DexelGridOptions lines = checked(options);
  const OrientedBox box = boxOf(zone);
  if (options.among) {
    if (!isUpright(box))
      throw InputError("lines: the zone is turned, and the model's own lines are not; it must not be");
    return ZoneGrid{
        .grid = gridAmong(*options.among, {Point(box.center - box.half), Point(box.center + box.half)})};
  }
  if (isUpright(box))
    return ZoneGrid{.grid =
                        dexelGridFor({Point(box.center - box.half), Point(box.center + box.half)}, lines)};
  return ZoneGrid{.grid = dexelGridFor({Point(-box.half), Point(box.half)}, lines),
                  .origin = box.center,
                  .axes = box.axes};
}

std::vector<LineFamily> newLines(const Zone& zone, const NewLines& options) {
  std::vector<LineFamily> out;
  if (const auto grid = gridFor(zone, options)) {
    for (int axis = 0; axis < 3; ++axis) out.push_back(familyOf(*grid, axis));
  } else if (const auto* camera = std::get_if<Camera>(&zone.shape())) {
    out = {inFrustum(*camera, options)};
  } else {
    const DexelGridOptions lines = checked(options);
    if (options.among)
      throw InputError("lines: a direction and the model's own lines are given; at most one of them must be");
    const OrientedBox box = boxOf(zone);
    const double longest = 2 * std::max({box.half.x, box.half.y, box.half.z});
    out = {latticeAlong(*options.direction, zone.bounds(),
                        lines.cell.value_or(longest / lines.resolution.value_or(kDefaultLines)))};
  }
  double lines = 0;
  for (const LineFamily& family : out) lines += static_cast<double>(family.width) * family.height;
  refuseTooMany(lines);
  return out;
}

}  // namespace restroke::points
