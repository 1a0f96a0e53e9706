#pragma once
// A closed volume other than the sphere, in its own frame (SPEC S1, S13): what each kind provides.

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "implicit/geometry/ray.h"
#include "implicit/sampling/sample_table.h"
#include "implicit/volume_kinds.h"

namespace restroke::implicit {

/// Sixteen points in a volume's frame.
struct LocalPoints {
  double x[kPatch], y[kPatch], z[kPatch];
};

/// What is known of a volume as a whole, in its own frame.
struct VolumeMeasures {
  DVec3 center{0};       ///< of a ball that holds the volume
  double radius = 1;     ///< of that ball
  double area = 0;       ///< of the surface
  double volume = 0;     ///< enclosed
  double thickness = 0;  ///< smallest size that matters: float32 must be able to tell its sides apart
};

/// Tables of samples that each thread remembers of those that no volume keeps.
inline constexpr std::size_t kRecentSamples = 32;

/// Immutable. Everything that decides a result is computed in double, from + - * / and sqrt in a fixed order:
/// the same bits everywhere. A kind derives from VolumeOf (below) and is listed in volume_kinds.cpp;
/// implicit/README.md tells how, and tests/conformance checks whatever is listed.
class Volume {
 public:
  virtual ~Volume() = default;
  Volume(const Volume&) = delete;
  Volume& operator=(const Volume&) = delete;

  [[nodiscard]] const VolumeKind& kind() const { return kind_; }
  [[nodiscard]] const VolumeParameters& parameters() const { return parameters_; }
  [[nodiscard]] const VolumeMeasures& measures() const { return measures_; }

  /// The side test that defines the volume: in it or on its boundary. With a dilation > 0 (far below
  /// `thickness`) also true within about that distance of it. NaN: false.
  [[nodiscard]] virtual bool contains(DVec3 p, double dilation) const = 0;
  /// Those of the lanes for which contains is true, bit for bit.
  [[nodiscard]] virtual std::uint32_t containsLanes(const LocalPoints& points, std::uint32_t lanes,
                                                    double dilation) const = 0;
  /// Signed bound of the distance to the boundary, positive outside, 0 where nothing is known: no point
  /// nearer to p than -clearance(p) is outside, none nearer than clearance(p) - d fulfils contains(q, d).
  [[nodiscard]] virtual double clearance(DVec3 p) const = 0;
  /// Unit normal that points out, at a surface point or close to one; on an edge, that of a face there.
  [[nodiscard]] virtual DVec3 outwardNormal(DVec3 p) const = 0;
  /// Appends where the ray's whole line is inside, in order and apart from each other. A line that only
  /// touches the volume may yield nothing. Each kind says how exact it is.
  virtual void intersect(const Ray& ray, std::vector<RayInterval>& intervals) const = 0;
  /// Greatest dot(p, direction) over the volume: its extent that way. `direction` is a unit vector.
  [[nodiscard]] virtual double support(DVec3 direction) const = 0;

  /// Near-uniform samples, about `count` of them (a value of sampleCountFor). Thread-safe. Made at the first
  /// call and kept as long as the volume, where keepsSamples(); else made anew when need be, and to be used
  /// before this thread has asked for kRecentSamples others.
  [[nodiscard]] const SampleTable& samples(std::uint32_t count) const;
  /// False for volumes that stand in one place only and can make their samples quickly: the legs of a swept
  /// stroke, whose samples would be most of what a model holds. Once true, it stays so.
  [[nodiscard]] bool keepsSamples() const {
    return !makesSamplesQuickly() || places_.load(std::memory_order_relaxed) > 1;
  }
  /// To be called by whatever places it in a model.
  void countPlace() const { places_.fetch_add(1, std::memory_order_relaxed); }
  /// Where sidesOfCells (clearance_grid.h) can be read. Null there until countAsked has come to as many
  /// points as a grid has cells: a volume that is asked little never pays for one. No result depends on it.
  /// To be read atomically.
  [[nodiscard]] const std::int8_t* const* cells() const { return &cells_; }
  /// So many points were asked about one by one. Thread-safe.
  void countAsked(std::uint32_t points) const;
  /// Bytes held, the samples made so far included.
  [[nodiscard]] std::size_t bytes() const;

 protected:
  Volume(const VolumeKind& kind, VolumeParameters parameters);
  /// To be called in the constructor.
  void setMeasures(const VolumeMeasures& measures) { measures_ = measures; }
  /// The samples, a multiple of kPatch of them: always the same for the same volume and count.
  [[nodiscard]] virtual SampleTable makeSamples(std::uint32_t count) const = 0;
  /// Whether makeSamples takes no longer than a few side tests a sample.
  [[nodiscard]] virtual bool makesSamplesQuickly() const { return false; }
  /// Bytes that the kind holds beyond its own size.
  [[nodiscard]] virtual std::size_t ownBytes() const { return 0; }

 private:
  const VolumeKind& kind_;
  VolumeParameters parameters_;
  VolumeMeasures measures_;
  mutable std::mutex mutex_;
  mutable std::vector<std::pair<std::uint32_t, std::unique_ptr<SampleTable>>> tables_;  // by count asked for
  std::uint64_t id_;  // of this volume alone in the process
  mutable std::atomic<std::uint32_t> places_{0}, asked_{0};
  mutable std::vector<std::int8_t> sidesOfCells_;
  mutable const std::int8_t* cells_ = nullptr;
};

/// Writes the batch once for all kinds: `Kind` has `bool inside(DVec3 p, double dilation) const`.
template <class Kind>
class VolumeOf : public Volume {
 public:
  using Volume::Volume;
  [[nodiscard]] bool contains(DVec3 p, double dilation) const final {
    const double sum = p.x + p.y + p.z;
    return sum == sum && self().inside(p, dilation);  // greatest-of tests would pass over a NaN
  }
  [[nodiscard]] std::uint32_t containsLanes(const LocalPoints& points, std::uint32_t lanes,
                                            double dilation) const final {
    std::uint32_t in = 0;
    for (std::uint32_t left = lanes; left != 0; left &= left - 1) {
      const auto i = static_cast<unsigned>(__builtin_ctz(left));
      if (VolumeOf::contains({points.x[i], points.y[i], points.z[i]}, dilation)) in |= 1u << i;
    }
    return in;
  }

 private:
  [[nodiscard]] const Kind& self() const { return static_cast<const Kind&>(*this); }
};

}  // namespace restroke::implicit
