#pragma once
// What each method of refinement loses, zone by zone.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/refine/differences.h"
#include "experiments/refine/histories.h"

namespace restroke::experiments {

/// A method with its options, as the rows name it.
struct RefineVariant {
  const char* name;   ///< in tables
  const char* title;  ///< for people
  points::RefineOptions options;
};
/// document; ends, and ends with the zone not widened, widened by two cells, and without correction;
/// touching; clusters.
[[nodiscard]] const std::vector<RefineVariant>& refineVariants();

/// What is varied.
enum class LossSweep : std::uint8_t {
  Lines,      ///< of the model along its longest side
  Zoom,       ///< the zone's part of the volume of the model's bounds
  Feature,    ///< mean radius of balls, in cells of the model
  Density,    ///< operations that cover a point
  Additions,  ///< part of them that add
  Thin        ///< thickness of plates, rods and grains, in cells
};
inline constexpr LossSweep kLossSweeps[] = {LossSweep::Lines,   LossSweep::Zoom,      LossSweep::Feature,
                                            LossSweep::Density, LossSweep::Additions, LossSweep::Thin};
struct LossSweepInfo {
  const char* name;   ///< in tables
  const char* title;  ///< for people
  const char* value;  ///< what `value` of a row is
};
[[nodiscard]] const LossSweepInfo& infoOf(LossSweep sweep);

/// What changes the result.
struct LossOptions {
  std::vector<int> resolutions{32, 64, 128, 258};  ///< of Lines, ascending; Zoom takes the last
  std::size_t operations = 20'000;                 ///< of most histories; one has less, one more
  int fineLines = 128;                             ///< along the zone's side, in each of three families
  int places = 4;                                  ///< zones of each size
  double part = 0.01;                              ///< the zone's part of the volume of the model's bounds
  std::vector<double> parts{0.001, 0.01, 0.1};     ///< of Zoom
  int featureLines = 32;                           ///< of the model, for Feature
  std::vector<double> features{0.5, 1, 2, 4, 8};
  int densityLines = 128;    ///< for Density and Additions
  double densityRadius = 4;  ///< mean, in cells, for Density
  std::vector<double> densities{0.5, 1, 2, 4, 8, 16, 32};
  std::vector<double> additions{0, 0.25, 0.5, 0.75, 1};
  int thinLines = 64;
  int thinPlaces = 8;  ///< zones, as each has but a few features
  std::vector<double> thicknesses{0.125, 0.25, 0.5, 1, 2};
};

/// A model to be refined, and where.
struct LossModel {
  LossSweep sweep = LossSweep::Lines;
  double value = 0;
  RefineHistory history;
  int resolution = 0;
  std::vector<double> parts;
  /// Dense, adds and carves at random: what the target is about.
  bool denseMixed = false;
};
/// A sweep's models, made one after the other: f(make, what) where make() is the model, what its name for
/// people. `logs`: histories from files, measured by Lines.
struct LossPlan {
  std::string what;
  std::function<LossModel()> make;
};
[[nodiscard]] std::vector<LossPlan> lossPlans(const LossOptions& options,
                                              const std::vector<RefineHistory>& logs, std::uint64_t seed);

/// One zone of one model, refined by one method.
struct LossRow {
  LossSweep sweep = LossSweep::Lines;
  double value = 0;
  std::string history;
  bool denseMixed = false;
  std::size_t operations = 0;  ///< of the history
  double additions = 0;        ///< part of them
  std::size_t ids = 0;         ///< that meet the zone, the initial solid among them
  int resolution = 0;          ///< of the model's lines
  double cell = 0;             ///< of the model
  double fineCell = 0;         ///< of the new lines
  double part = 0;             ///< of the volume of the model's bounds
  int place = 0;
  std::size_t modelBytes = 0;        ///< with references (R2)
  std::size_t lineHistoryBytes = 0;  ///< of the lines' histories (R2b), besides
  std::string method;                ///< RefineVariant::name
  std::size_t collected = 0;         ///< ids that were replayed
  double length = 0;                 ///< inside the reference, all families, model units
  std::size_t ends = 0;              ///< of the reference within the zone
  Recall recall;
  Differences differences;
  /// By the length inside the reference; nothing where that is empty.
  [[nodiscard]] std::optional<double> wrong() const;
  /// What is too much less what is missing, by the reference.
  [[nodiscard]] std::optional<double> wrongVolume() const;
};

/// A cube of a part of the box's volume about a place, moved so far that it is within the box, and cut to the
/// box where that is thinner.
[[nodiscard]] points::Zone zoneAt(const Box& box, double part, DVec3 place);
/// Ends of the model's lines picked at random. Throws InputError when it has none.
[[nodiscard]] std::vector<DVec3> placesOnSurface(const points::TriDexel& model, int count,
                                                 std::uint64_t seed);
/// Middles of operations picked at random.
[[nodiscard]] std::vector<DVec3> placesOfOperations(const RefineHistory& history, int count,
                                                    std::uint64_t seed);

/// All zones of a model by all methods. `seed`: of the places.
[[nodiscard]] std::vector<LossRow> measureLoss(const LossModel& model, const LossOptions& options,
                                               std::uint64_t seed, const Execution& execution = {});

}  // namespace restroke::experiments
