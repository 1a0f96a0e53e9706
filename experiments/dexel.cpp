#include "experiments/dexel.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "experiments/pictures.h"
#include "experiments/provenance.h"
#include "experiments/shipped.h"
#include "experiments/text.h"
#include "implicit/errors.h"
#include "sculpt/document.h"
#include "sculpt/stroke_log.h"

namespace restroke::experiments {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBall = "ball";

void validate(const DexelOptions& options) {
  if (options.resolutions.empty() || options.points == 0 || !(options.samplesPerCell > 0))
    throw InputError(
        fmt::format("{} resolutions, {} points and {:g} samples a cell; each must be greater than 0",
                    options.resolutions.size(), options.points, options.samplesPerCell));
  for (std::size_t i = 0; i < options.resolutions.size(); ++i) {
    const int n = options.resolutions[i];
    if (n < kLeastDexelResolution || n > kMostDexelResolution)
      throw InputError(fmt::format("the resolution is {}; it must be {} to {}", n, kLeastDexelResolution,
                                   kMostDexelResolution));
    if (i > 0 && n <= options.resolutions[i - 1])
      throw InputError(
          fmt::format("resolution {} comes after {}; they must ascend", n, options.resolutions[i - 1]));
  }
}

/// Samples a square model unit: so many for each square of the finest cell.
float densityFor(const DexelSource& source, const DexelOptions& options) {
  Box bounds;
  for (const implicit::Primitive& p : source.primitives)
    if (p.sign == implicit::Sign::Positive) bounds.add(boundsOf(p.shape));
  const double cell = points::dexelGridFor(bounds, {.resolution = options.resolutions.back()}).cell();
  return static_cast<float>(options.samplesPerCell / (cell * cell));
}

/// The one that is drawn.
int pictureResolution(const DexelOptions& options) {
  int chosen = options.resolutions.front();
  for (const int n : options.resolutions)
    if (n <= options.pictureResolution) chosen = n;
  return chosen;
}

void drawElements(const std::vector<std::vector<points::Surfel>>& elements, const Truth& truth,
                  const DexelRow& row, DexelResults& results, const DexelOptions& options) {
  PictureBall ball{truth.bounds().center()};
  ball.add(truth.surface().surfels());
  const Camera camera = frameSphere(ball.center, ball.radius,
                                    {.view = {-0.55f, -0.45f, -1},
                                     .width = options.pictureSize,
                                     .height = options.pictureSize,
                                     .fill = 0.94f});
  for (std::size_t k = 0; k < elements.size(); ++k)
    results.pictures.push_back(
        {row.source, kRepresentations[k], row.resolution, drawPicture({.surfels = elements[k]}, camera)});
}

}  // namespace

const RepresentationInfo& infoOf(Representation representation) {
  static constexpr std::array<RepresentationInfo, 3> kInfos{{
      {"voxels", "voxels"},
      {"one-family", "one family of dexels, along z"},
      {"three-families", "three families of dexels"},
  }};
  return kInfos.at(static_cast<std::size_t>(representation));
}

DexelOptions smokeSize(DexelOptions options) {
  options.resolutions = {8, 16, 32};
  options.points = std::min<std::size_t>(options.points, 100'000);
  options.pictureSize = std::min(options.pictureSize, 160u);
  options.smoke = true;
  return options;
}

std::string describe(const DexelOptions& options) {
  return fmt::format("resolutions={} points={} samplesPerCell={} picture={} of {} seed={} smoke={}",
                     fmt::join(options.resolutions, ","), options.points, options.samplesPerCell,
                     options.pictureSize, options.pictureResolution, options.seed, options.smoke);
}

DexelSource analyticBall() {
  return {kBall, {{{{0, 0, 0}, 1.0f}, implicit::Sign::Positive}}};
}

DexelSource sourceOf(const fs::path& log) {
  const sculpt::StrokeLog read = sculpt::readLog(log);
  sculpt::Document document(read.header);
  for (const sculpt::Command& command : read.commands) document.apply(command);
  const implicit::PrimitiveList& list = document.model().list();
  DexelSource source{log.stem().string(), {}};
  for (std::size_t i = 0; i < list.size(); ++i) source.primitives.push_back(list.at(i));
  return source;
}

std::vector<fs::path> defaultDexelLogs(bool smoke) {
  if (smoke) return {shippedFile("examples/gallery.log")};
  return {shippedFile("examples/paper-scale.log"), shippedFile("examples/gallery.log"),
          shippedFile("examples/rabbit.log")};
}

DexelResults measureDexels(const std::vector<fs::path>& logs, const DexelOptions& options,
                           const Execution& execution, const DexelProgress& progress) {
  validate(options);
  DexelResults results;
  std::vector<DexelSource> sources{analyticBall()};
  for (const fs::path& log : logs) {
    results.inputs.emplace_back(log.filename().string(), hashOfFile(log));
    DexelSource source = sourceOf(log);
    source.name = untakenName(source.name, [&](std::string_view name) {
      return std::ranges::any_of(sources, [&](const DexelSource& s) { return s.name == name; });
    });
    sources.push_back(std::move(source));
  }
  const std::size_t all = sources.size() * options.resolutions.size();
  std::size_t done = 0;
  for (DexelSource& source : sources) {
    try {
      const std::size_t primitives = source.primitives.size();
      const float density = densityFor(source, options);
      const Truth truth(std::move(source.primitives),
                        {.points = options.points, .seed = options.seed, .density = density}, execution);
      for (const int n : options.resolutions) {
        if (progress) progress(fmt::format("{} at {}, solid and resolution", source.name, n), done++, all);
        const bool drawn = n == pictureResolution(options) && options.pictureSize > 0;
        std::vector<std::vector<points::Surfel>> elements;
        for (const DexelMeasured& measured : measureAt(truth, n, execution, drawn ? &elements : nullptr))
          results.rows.push_back({source.name, primitives, truth.surface().surfels().size(), n, measured});
        drawElements(elements, truth, results.rows.back(), results, options);
      }
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", source.name, error.what()));
    }
  }
  return results;
}

}  // namespace restroke::experiments
