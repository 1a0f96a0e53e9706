// Surface of revolution whose profile is a clamped uniform cubic B-spline in the half plane (radius, height),
// from axis to axis. The spline is cut into short stretches along which radius and height only grow or only
// shrink. Side test: stretches passed on the way straight out from the axis, odd or even. Clearance: the
// distance to the nearest point of the profile, by Newton's method on stretches that may hold it, which a
// grid over the half plane lists.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "implicit/errors.h"
#include "implicit/sampling/charts.h"
#include "implicit/shapes/kinds.h"
#include "implicit/shapes/ray_intervals.h"

namespace restroke::implicit {

namespace {

constexpr std::size_t kMostPoints = 1024;
constexpr int kStretches = 8;  // of one span of the spline, before those that turn back are cut

// A polynomial of third degree over [0, 1].
struct Cubic {
  double a = 0, b = 0, c = 0, d = 0;  // a + b t + c t^2 + d t^3
  [[nodiscard]] double at(double t) const { return a + t * (b + t * (c + t * d)); }
  [[nodiscard]] double slope(double t) const { return b + t * (2 * c + 3 * t * d); }
  [[nodiscard]] double curvature(double t) const { return 2 * c + 6 * t * d; }
  // Where the slope is 0 within (0, 1).
  void appendTurns(std::vector<double>& turns) const {
    const double p = 3 * d, q = c, discriminant = q * q - p * b;  // p t^2 + 2 q t + b
    const auto append = [&](double t) {
      if (t > 0 && t < 1) turns.push_back(t);
    };
    if (discriminant < 0) return;
    const double root = q + (q < 0 ? -1 : 1) * std::sqrt(discriminant);
    if (p != 0) append(-root / p);
    if (root != 0) append(-b / root);
  }
};

struct Stretch {
  std::size_t span;
  double from, to;        // parameters
  double r0, r1, z0, z1;  // at its ends
  [[nodiscard]] double boxDistanceSquared(double r, double z) const {
    const double dr = std::max({std::min(r0, r1) - r, r - std::max(r0, r1), 0.0});
    const double dz = std::max({std::min(z0, z1) - z, z - std::max(z0, z1), 0.0});
    return dr * dr + dz * dz;
  }
};

class Revolution final : public VolumeOf<Revolution> {
 public:
  explicit Revolution(VolumeParameters parameters) : VolumeOf(revolutionKind(), std::move(parameters)) {
    const std::vector<float>& values = this->parameters().values[0];
    if (values.size() % 2 != 0 || values.size() < 8 || values.size() > 2 * kMostPoints)
      throw InputError(
          fmt::format("a revolution has a profile of {} numbers; it must have 4 to {} points (radius, "
                      "height)",
                      values.size(), kMostPoints));
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!std::isfinite(values[i]))
        throw InputError(fmt::format(
            "point {} of the profile of a revolution is not finite; all numbers must be", i / 2 + 1));
    if (values[0] != 0 || values[values.size() - 2] != 0)
      throw InputError(
          fmt::format("the profile of a revolution begins at radius {} and ends at radius {}; both "
                      "ends must lie on the axis, at radius 0",
                      values[0], values[values.size() - 2]));
    cutUp(values);
    refuseBadProfiles();
    measure();
    makeGrid();
  }

  [[nodiscard]] bool inside(DVec3 p, double dilation) const {
    const double rho = std::sqrt(p.x * p.x + p.y * p.y);
    const Known known = knownAt(rho, p.z);
    if (known.cell == kFar) return known.clearance < 0;
    if (encloses(rho, p.z)) return true;
    return dilation > 0 && isWithin(dilation, {rho, p.z}, known.cell);
  }
  [[nodiscard]] double clearance(DVec3 p) const override {
    const double rho = std::sqrt(p.x * p.x + p.y * p.y);
    const Known known = knownAt(rho, p.z);
    if (known.cell == kFar) return known.clearance;
    const double distance = distanceAt(rho, p.z, known.cell);
    return encloses(rho, p.z) ? -distance : distance;
  }
  [[nodiscard]] DVec3 outwardNormal(DVec3 p) const override {
    const double rho = std::sqrt(p.x * p.x + p.y * p.y);
    Place place;
    const Known known = knownAt(rho, p.z);
    if (known.cell != kFar) {
      (void)nearest({rho, p.z}, nearby(known.cell), &place);
    } else {
      std::vector<std::uint32_t> all(stretches_.size());
      std::iota(all.begin(), all.end(), 0u);
      (void)nearest({rho, p.z}, all, &place);
    }
    const ProfilePoint at = profileAt(place.span, place.t);
    return rho > 0 ? DVec3(at.normalRadius * p.x / rho, at.normalRadius * p.y / rho, at.normalHeight)
                   : DVec3(at.normalRadius, 0, at.normalHeight);
  }
  void intersect(const Ray& ray, std::vector<RayInterval>& intervals) const override {
    appendMarchedIntervals(*this, ray, intervals);
  }
  [[nodiscard]] double support(DVec3 direction) const override {
    const double across = std::sqrt(direction.x * direction.x + direction.y * direction.y);
    double most = -std::numeric_limits<double>::max();
    std::vector<double> places;
    for (const auto& [r, z] : spans_) {
      const Cubic sum{across * r.a + direction.z * z.a, across * r.b + direction.z * z.b,
                      across * r.c + direction.z * z.c, across * r.d + direction.z * z.d};
      places = {0, 1};
      sum.appendTurns(places);
      for (const double t : places) most = std::max(most, sum.at(t));
    }
    return most;
  }

 protected:
  [[nodiscard]] SampleTable makeSamples(std::uint32_t count) const override {
    const Chart whole = chart();
    return SampleTable(sampleCharts({&whole, 1}, count));
  }
  [[nodiscard]] std::size_t ownBytes() const override {
    std::size_t bytes = rows_.capacity() * sizeof(rows_.front());
    for (const auto& row : rows_) bytes += row.capacity() * sizeof(std::uint32_t);
    return bytes + spans_.capacity() * sizeof(spans_.front()) + stretches_.capacity() * sizeof(Stretch) +
           (distances_.capacity() + candidates_.capacity() + nearby_.capacity()) * sizeof(float);
  }

 private:
  struct Place {
    std::size_t span = 0;
    double t = 0;
  };
  struct HalfPlanePoint {
    double rho, z;
  };

  // The spline's spans as polynomials, by its blossom (Ramshaw, "Blossoms are polar forms", CAGD 6, 1989),
  // then its stretches.
  void cutUp(const std::vector<float>& values) {
    const std::size_t n = values.size() / 2, spans = n - 3;
    const auto knot = [&](std::size_t i) {  // clamped: four equal ones at both ends
      return static_cast<double>(i < 3 ? 0 : std::min(i - 3, spans));
    };
    const auto blossom = [&](std::size_t span, std::size_t row, std::array<double, 3> u) {
      double d[4];
      for (std::size_t i = 0; i < 4; ++i) d[i] = static_cast<double>(values[2 * (span + i) + row]);
      for (std::size_t level = 1; level <= 3; ++level)
        for (std::size_t i = 3; i >= level; --i) {
          const double lo = knot(span + i), hi = knot(span + i + 4 - level);
          const double f = (u[level - 1] - lo) / (hi - lo);
          d[i] = (1 - f) * d[i - 1] + f * d[i];
        }
      return d[3];
    };
    for (std::size_t s = 0; s < spans; ++s) {
      const auto lo = static_cast<double>(s), hi = lo + 1;
      Cubic out[2];
      for (std::size_t row = 0; row < 2; ++row) {
        const double b0 = blossom(s, row, {lo, lo, lo}), b1 = blossom(s, row, {lo, lo, hi}),
                     b2 = blossom(s, row, {lo, hi, hi}), b3 = blossom(s, row, {hi, hi, hi});
        out[row] = {b0, 3 * (b1 - b0), 3 * (b2 - 2 * b1 + b0), b3 - 3 * b2 + 3 * b1 - b0};
      }
      spans_.push_back({out[0], out[1]});
      std::vector<double> cuts;
      for (int i = 0; i <= kStretches; ++i) cuts.push_back(static_cast<double>(i) / kStretches);
      out[0].appendTurns(cuts);
      out[1].appendTurns(cuts);
      std::sort(cuts.begin(), cuts.end());
      for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        if (!(cuts[i] < cuts[i + 1])) continue;
        Stretch stretch{s,
                        cuts[i],
                        cuts[i + 1],
                        out[0].at(cuts[i]),
                        out[0].at(cuts[i + 1]),
                        out[1].at(cuts[i]),
                        out[1].at(cuts[i + 1])};
        // Neighbours share their ends bit for bit, or a ray could slip between them.
        if (!stretches_.empty()) {
          stretch.r0 = stretches_.back().r1;
          stretch.z0 = stretches_.back().z1;
        }
        stretches_.push_back(stretch);
      }
    }
    stretches_.front().r0 = 0;
    stretches_.back().r1 = 0;
  }

  void refuseBadProfiles() const {
    double widest = 0;
    for (const Stretch& s : stretches_) widest = std::max({widest, s.r0, s.r1});
    for (const Stretch& s : stretches_)
      if (std::min(s.r0, s.r1) < -1e-12 * widest)
        throw InputError(
            fmt::format("the profile of a revolution crosses the axis near height {:.6g}; its radius "
                        "must be at least 0 everywhere",
                        s.r0 < s.r1 ? s.z0 : s.z1));
    // Stretches are nearly straight: their chords tell whether the profile meets itself.
    for (std::size_t i = 0; i < stretches_.size(); ++i)
      for (std::size_t j = i + 2; j < stretches_.size(); ++j)
        if (chordsMeet(stretches_[i], stretches_[j]))
          throw InputError(
              fmt::format("the profile of a revolution meets itself near radius {:.6g} and height "
                          "{:.6g}; it must not",
                          stretches_[j].r0, stretches_[j].z0));
  }
  static bool chordsMeet(const Stretch& a, const Stretch& b) {
    const auto turn = [](double r0, double z0, double r1, double z1, double r, double z) {
      return (r1 - r0) * (z - z0) - (z1 - z0) * (r - r0);
    };
    return turn(a.r0, a.z0, a.r1, a.z1, b.r0, b.z0) * turn(a.r0, a.z0, a.r1, a.z1, b.r1, b.z1) < 0 &&
           turn(b.r0, b.z0, b.r1, b.z1, a.r0, a.z0) * turn(b.r0, b.z0, b.r1, b.z1, a.r1, a.z1) < 0;
  }

  struct Extent {
    double widest = 0, lowest = std::numeric_limits<double>::max(), highest = -lowest;
  };
  [[nodiscard]] Extent extent() const {
    Extent e;
    for (const Stretch& s : stretches_) {
      e.widest = std::max({e.widest, s.r0, s.r1});
      e.lowest = std::min({e.lowest, s.z0, s.z1});
      e.highest = std::max({e.highest, s.z0, s.z1});
    }
    return e;
  }

  void measure() {
    const auto [widest, lowest, highest] = extent();
    double volume = 0;
    // pi r^2 dz, a polynomial of eighth degree, by Gauss and Legendre with five points: exact.
    constexpr double kAt[5] = {0.5, 0.23076534494715845, 0.76923465505284155, 0.04691007703066800,
                               0.95308992296933200};
    constexpr double kWeight[5] = {0.28444444444444444, 0.23931433524968324, 0.23931433524968324,
                                   0.11846344252809454, 0.11846344252809454};
    for (const auto& [r, z] : spans_)
      for (int i = 0; i < 5; ++i)
        volume += kWeight[i] * 3.141592653589793 * r.at(kAt[i]) * r.at(kAt[i]) * z.slope(kAt[i]);
    outwards_ = volume < 0 ? -1 : 1;
    const double thickness = std::min(2 * widest, highest - lowest);
    if (!(thickness > 0) || !(std::fabs(volume) > 1e-12 * widest * widest * (highest - lowest)))
      throw InputError("the profile of a revolution encloses nothing; its solid must have a volume");
    const DVec3 center(0, 0, (lowest + highest) / 2);
    double radius = 0;
    for (const Stretch& s : stretches_) {
      // Monotone: the corner of its box is at least as far.
      const double r = std::max(s.r0, s.r1);
      const double z = std::max(std::fabs(s.z0 - center.z), std::fabs(s.z1 - center.z));
      radius = std::max(radius, std::sqrt(r * r + z * z));
    }
    setMeasures({.center = center,
                 .radius = radius,
                 .area = chart().area(),
                 .volume = std::fabs(volume),
                 .thickness = thickness});
  }

  // What the grid knows of a place: a clearance far from the profile, or the cell whose candidates are near.
  static constexpr std::size_t kFar = std::numeric_limits<std::size_t>::max();
  struct Known {
    double clearance = 0;
    std::size_t cell = kFar;
  };
  [[nodiscard]] Known knownAt(double rho, double z) const {
    const double r = rho / cell_, h = (z - lowest_) / cell_;
    if (!(r < across_ && h >= 0 && h < upwards_)) {
      // Beyond the grid, which goes two cells farther than the profile.
      const double dr = std::max(rho - (across_ - 2) * cell_, 0.0);
      const double dz = std::max({lowest_ + 2 * cell_ - z, z - (lowest_ + (upwards_ - 2) * cell_), 0.0});
      return {std::sqrt(dr * dr + dz * dz), kFar};
    }
    const auto column = static_cast<std::size_t>(r), row = static_cast<std::size_t>(h);
    const std::size_t cell = row * static_cast<std::size_t>(across_) + column;
    if (candidates_[cell] != candidates_[cell + 1]) return {0, cell};
    const double dr = rho - (static_cast<double>(column) + 0.5) * cell_,
                 dz = z - (lowest_ + (static_cast<double>(row) + 0.5) * cell_);
    const double way = std::sqrt(dr * dr + dz * dz), known = static_cast<double>(distances_[cell]);
    return {known > 0 ? known - way : known + way, kFar};
  }
  void makeGrid() {
    constexpr double kCells = 64;  // along the longer side
    const auto [widest, lowest, highest] = extent();
    cell_ = std::max(widest, highest - lowest) / kCells;
    lowest_ = lowest - 2 * cell_;
    across_ = std::floor(widest / cell_) + 3;
    upwards_ = std::floor((highest - lowest) / cell_) + 5;
    const auto columns = static_cast<std::size_t>(across_), rows = static_cast<std::size_t>(upwards_);
    const double half = cell_ * 0.7072;
    for (std::size_t row = 0; row < rows; ++row) {
      rows_.emplace_back();
      const double from = lowest_ + (static_cast<double>(row) - 1e-6) * cell_;
      for (std::uint32_t i = 0; i < stretches_.size(); ++i) {
        const Stretch& s = stretches_[i];
        if (std::max(s.z0, s.z1) >= from && std::min(s.z0, s.z1) <= from + (1 + 2e-6) * cell_)
          rows_.back().push_back(i);
      }
    }
    std::vector<std::uint32_t> all(stretches_.size());
    std::iota(all.begin(), all.end(), 0u);
    candidates_.push_back(0);
    for (std::size_t row = 0; row < rows; ++row)
      for (std::size_t column = 0; column < columns; ++column) {
        const double r = (static_cast<double>(column) + 0.5) * cell_,
                     z = lowest_ + (static_cast<double>(row) + 0.5) * cell_;
        const double d = nearest({r, z}, all, nullptr);
        // Rounded towards 0, so that float32 promises no more than was measured.
        distances_.push_back(static_cast<float>(encloses(r, z) ? -d * (1 - 1e-6) : d * (1 - 1e-6)));
        if (d <= 2 * half) {
          const double reach = (d + 2 * half) * (d + 2 * half);
          for (const std::uint32_t i : all)
            if (stretches_[i].boxDistanceSquared(r, z) <= reach) nearby_.push_back(i);
        }
        candidates_.push_back(static_cast<std::uint32_t>(nearby_.size()));
      }
  }

  // Odd number of stretches farther from the axis at this height. The boundary counts as inside.
  [[nodiscard]] bool encloses(double rho, double z) const {
    const double h = (z - lowest_) / cell_;
    if (!(h >= 0 && h < upwards_)) return false;
    bool odd = false;
    for (const std::uint32_t i : rows_[static_cast<std::size_t>(h)]) {
      const Stretch& s = stretches_[i];
      const double lo = std::min(s.z0, s.z1), hi = std::max(s.z0, s.z1);
      if (lo == hi) {
        if (z == lo && rho >= std::min(s.r0, s.r1) && rho <= std::max(s.r0, s.r1)) return true;
        continue;
      }
      if (!(z >= lo && z < hi)) continue;
      if (rho > std::max(s.r0, s.r1)) continue;
      if (rho < std::min(s.r0, s.r1)) {
        odd = !odd;
        continue;
      }
      const double r = spans_[s.span].first.at(heightAt(s, z));
      if (r == rho) return true;
      if (r > rho) odd = !odd;
    }
    return odd;
  }
  // The parameter at which a stretch has a height between its ends'.
  [[nodiscard]] double heightAt(const Stretch& s, double z) const {
    const Cubic& height = spans_[s.span].second;
    const bool rising = s.z0 < s.z1;
    double lo = s.from, hi = s.to;
    // Newton's method, halving where it would leave the bracket.
    double t = lo + (hi - lo) * (z - s.z0) / (s.z1 - s.z0);
    for (int k = 0; k < 64; ++k) {
      const double error = height.at(t) - z;
      ((error < 0) == rising ? lo : hi) = t;
      double next = t - error / height.slope(t);
      if (!(next > lo && next < hi)) next = lo + (hi - lo) / 2;
      const bool settled = std::fabs(next - t) <= 1e-16 * (1 + std::fabs(t));
      t = next;
      if (settled) break;
    }
    return t;
  }

  // The stretches that may be nearest to places in a cell close to the profile.
  [[nodiscard]] std::span<const std::uint32_t> nearby(std::size_t cell) const {
    return std::span(nearby_).subspan(candidates_[cell], candidates_[cell + 1] - candidates_[cell]);
  }
  [[nodiscard]] double distanceAt(double rho, double z, std::size_t cell) const {
    return nearest({rho, z}, nearby(cell), nullptr);
  }
  // Whether distanceAt is at most a distance that is small beside the stretches: few of them come near.
  [[nodiscard]] bool isWithin(double distance, HalfPlanePoint p, std::size_t cell) const {
    const double reach = distance * distance * (1 + 1e-6);
    for (const std::uint32_t i : nearby(cell))
      if (stretches_[i].boxDistanceSquared(p.rho, p.z) <= reach && nearest(p, {&i, 1}, nullptr) <= distance)
        return true;
    return false;
  }
  // Distance to the nearest of the stretches.
  double nearest(HalfPlanePoint p, std::span<const std::uint32_t> among, Place* place) const {
    const auto [rho, z] = p;
    double best = std::numeric_limits<double>::max();
    // The nearest box first, so that most others are passed over.
    std::uint32_t first = among.front();
    double nearestBox = std::numeric_limits<double>::max();
    for (const std::uint32_t i : among) {
      const double d = stretches_[i].boxDistanceSquared(rho, z);
      if (d < nearestBox) {
        nearestBox = d;
        first = i;
      }
    }
    const auto look = [&](const Stretch& s) {
      const auto& [r, h] = spans_[s.span];
      // The foot of the perpendicular: where (c - p) . c' changes from - to +.
      const auto ahead = [&](double t) { return (r.at(t) - rho) * r.slope(t) + (h.at(t) - z) * h.slope(t); };
      double lo = s.from, hi = s.to;
      if (ahead(lo) >= 0) {
        hi = lo;
      } else if (ahead(hi) <= 0) {
        lo = hi;
      } else {
        // Newton's method, halving where it would leave the bracket.
        double t = (lo + hi) / 2;
        for (int k = 0; k < 64; ++k) {
          const double value = ahead(t);
          (value < 0 ? lo : hi) = t;
          const double slope = r.slope(t) * r.slope(t) + h.slope(t) * h.slope(t) +
                               (r.at(t) - rho) * r.curvature(t) + (h.at(t) - z) * h.curvature(t);
          double next = t - value / slope;
          if (!(next > lo && next < hi)) next = lo + (hi - lo) / 2;
          const bool settled = std::fabs(next - t) < 1e-13;
          t = next;
          if (settled) break;
        }
        lo = t;
      }
      const double dr = r.at(lo) - rho, dz = h.at(lo) - z, d = dr * dr + dz * dz;
      if (d < best) {
        best = d;
        if (place) *place = {s.span, lo};
      }
    };
    look(stretches_[first]);
    for (const std::uint32_t i : among)
      if (i != first && stretches_[i].boxDistanceSquared(rho, z) < best) look(stretches_[i]);
    return std::sqrt(best);
  }

  [[nodiscard]] ProfilePoint profileAt(std::size_t span, double t) const {
    const auto& [r, z] = spans_[span];
    double dr = r.slope(t), dz = z.slope(t);
    if (dr == 0 && dz == 0) {  // repeated points: the direction just beside
      const double beside = t < 0.5 ? t + 1e-6 : t - 1e-6;
      dr = r.slope(beside);
      dz = z.slope(beside);
    }
    const double l = std::sqrt(dr * dr + dz * dz);
    return {std::max(0.0, r.at(t)), z.at(t), l > 0 ? outwards_ * dz / l : 1, l > 0 ? -outwards_ * dr / l : 0};
  }
  [[nodiscard]] Chart chart() const {
    const auto spans = static_cast<double>(spans_.size());
    return revolved(static_cast<int>(64 * spans_.size()), [this, spans](double s) {
      const double at = s * spans;
      const auto span = std::min(static_cast<std::size_t>(at), spans_.size() - 1);
      return profileAt(span, at - static_cast<double>(span));
    });
  }

  std::vector<std::pair<Cubic, Cubic>> spans_;  // radius and height
  std::vector<Stretch> stretches_;              // in order along the profile
  // A grid over the half plane: the signed distance from each cell's middle, the stretches that may be
  // nearest to places in cells close to the profile, and those that each row of cells crosses.
  double cell_ = 1, lowest_ = 0, across_ = 0, upwards_ = 0;
  std::vector<float> distances_;
  std::vector<std::uint32_t> candidates_, nearby_;
  std::vector<std::vector<std::uint32_t>> rows_;
  double outwards_ = 1;  // +1 when the profile runs upwards
};

}  // namespace

const VolumeKind& revolutionKind() {
  static const VolumeKind kind{
      .name = "revolution",
      .summary = "a profile turned about the z axis",
      .parameters =
          {{.name = "profile",
            .meaning = "4 to 1,024 control points (radius, height) of a clamped uniform cubic B-spline that "
                       "begins and ends on the axis and does not meet itself",
            .form = ParameterInfo::Form::ProfilePoints}},
      .make = [](const VolumeParameters& p) -> std::shared_ptr<const Volume> {
        return std::make_shared<Revolution>(p);
      },
      .examples =
          [] {
            return std::vector<VolumeParameters>{
                // A vase, a drop, a bowl whose profile goes back down, a disc with flat ends.
                {{{0, -0.8f, 0.5f, -0.8f, 0.7f, -0.3f, 0.15f, 0.1f, 0.2f, 0.5f, 0.45f, 0.8f, 0, 0.75f}}},
                {{{0, -1, 0.9f, -1, 0.4f, 0.3f, 0, 1}}},
                {{{0, -0.5f, 0.8f, -0.5f, 1, 0.2f, 0.95f, 0.6f, 0.8f, 0.3f, 0.6f, -0.3f, 0, -0.35f}}},
                {{{0, 0.05f, 0.5f, 0.05f, 1, 0.05f, 1, -0.05f, 0.5f, -0.05f, 0, -0.05f}}}};
          }};
  return kind;
}

}  // namespace restroke::implicit
