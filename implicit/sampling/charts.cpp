#include "implicit/sampling/charts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "implicit/errors.h"
#include "implicit/geometry/powers.h"

namespace restroke::implicit {

namespace {

constexpr double kPi = 3.141592653589793;

// Where a table that begins at 0 and never decreases reaches `value`, as a fraction of its whole length.
double inverse(const std::vector<double>& table, double value, std::size_t& cell) {
  const auto it = std::upper_bound(table.begin(), table.end(), value);
  cell = std::min(static_cast<std::size_t>(it - table.begin()), table.size() - 1);
  const double before = cell == 0 ? 0 : table[cell - 1], size = table[cell] - before;
  const double part = size > 0 ? std::clamp((value - before) / size, 0.0, 1.0) : 0.5;
  return (static_cast<double>(cell) + part) / static_cast<double>(table.size());
}

double triangleArea(DVec3 a, DVec3 b, DVec3 c) {
  return length(cross(b - a, c - a)) / 2;
}

SurfaceSample turned(const ProfilePoint& p, double turns) {
  const SineCosine angle = sineCosineOfTurns(turns);
  return {{p.radius * angle.cosine, p.radius * angle.sine, p.height},
          {p.normalRadius * angle.cosine, p.normalRadius * angle.sine, p.normalHeight}};
}

}  // namespace

Chart Chart::uniform(double area, Map map) {
  Chart chart;
  chart.map_ = std::move(map);
  chart.rows_ = {area};
  return chart;
}

Chart Chart::measured(int rows, int columns, Map map) {
  Chart chart;
  chart.map_ = std::move(map);
  const auto corner = [&](int r, int c) {
    return chart.map_(static_cast<double>(r) / rows, static_cast<double>(c) / columns).position;
  };
  std::vector<DVec3> below(static_cast<std::size_t>(columns) + 1), above(below.size());
  for (int c = 0; c <= columns; ++c) below[static_cast<std::size_t>(c)] = corner(0, c);
  double area = 0;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c <= columns; ++c) above[static_cast<std::size_t>(c)] = corner(r + 1, c);
    std::vector<double> cells(static_cast<std::size_t>(columns));
    double row = 0;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      row +=
          triangleArea(below[c], below[c + 1], above[c]) + triangleArea(above[c + 1], above[c], below[c + 1]);
      cells[c] = row;
    }
    area += row;
    chart.rows_.push_back(area);
    chart.columns_.push_back(std::move(cells));
    std::swap(below, above);
  }
  return chart;
}

SurfaceSample Chart::at(double areaBelow, double along) const {
  std::size_t row = 0, column = 0;
  const double s = inverse(rows_, areaBelow, row);
  if (columns_.empty()) return map_(s, along);
  const std::vector<double>& cells = columns_[row];
  return map_(s, inverse(cells, along * cells.back(), column));
}

Chart revolved(int rows, std::function<ProfilePoint(double s)> profile) {
  // Equal steps in area: the rings' areas, inverted by a table.
  std::vector<double> rings;
  double area = 0;
  ProfilePoint before = profile(0);
  for (int r = 1; r <= rows; ++r) {
    const ProfilePoint p = profile(static_cast<double>(r) / rows);
    const double dr = p.radius - before.radius, dz = p.height - before.height;
    area += kPi * (p.radius + before.radius) * std::sqrt(dr * dr + dz * dz);
    rings.push_back(area);
    before = p;
  }
  return Chart::uniform(area, [rings = std::move(rings), profile = std::move(profile)](double s, double t) {
    std::size_t ring = 0;
    return turned(profile(inverse(rings, s * rings.back(), ring)), t);
  });
}

Chart revolvedUniformly(double area, std::function<ProfilePoint(double s)> profile) {
  return Chart::uniform(area,
                        [profile = std::move(profile)](double s, double t) { return turned(profile(s), t); });
}

std::vector<Chart> starShaped(int cells, const std::function<SurfaceSample(DVec3 direction)>& map) {
  std::vector<Chart> charts;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      charts.push_back(Chart::measured(cells, cells, [map, axis, side](double s, double t) {
        // Closer to equal angles than even steps on the cube are.
        const auto bend = [](double a) { return a * (0.75 + 0.25 * a * a); };
        const double a = bend(2 * s - 1), b = bend(2 * t - 1);
        return map(axis == 0 ? DVec3(side, a, b) : axis == 1 ? DVec3(b, side, a) : DVec3(a, b, side));
      }));
  return charts;
}

double areaOf(std::span<const Chart> charts) {
  double area = 0;
  for (const Chart& chart : charts) area += chart.area();
  return area;
}

std::vector<SurfaceSample> sampleCharts(std::span<const Chart> charts, std::uint32_t count) {
  const double step = areaOf(charts) / count;
  std::vector<SurfaceSample> samples;
  samples.reserve(count);
  std::size_t chart = 0;
  double before = 0;   // area of the charts before this one
  double along = 0.5;  // not on a chart's border: an edge would have two normals
  for (std::uint32_t k = 0; k < count; ++k) {
    const double below = (k + 0.5) * step;
    while (chart + 1 < charts.size() && below >= before + charts[chart].area())
      before += charts[chart++].area();
    samples.push_back(charts[chart].at(std::min(below - before, charts[chart].area()), along));
    along += 0.6180339887498949;
    if (along >= 1) along -= 1;
  }
  return samples;
}

}  // namespace restroke::implicit
