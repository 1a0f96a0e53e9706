#include "experiments/refine/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "experiments/pictures.h"
#include "implicit/errors.h"
#include "implicit/geometry/camera.h"
#include "points/images/cpu_renderer.h"

namespace restroke::experiments {
namespace {

using points::DisplayImage;
using points::LineEnds;
using points::RefinedModel;
using points::RefineMethod;
using points::SpanEnd;
using points::Zone;

// Red and blue stand out from what is right, also in print.
constexpr points::Palette kPalette{
    .base = {0.62f, 0.60f, 0.56f}, .added = {0.05f, 0.16f, 0.62f}, .carved = {0.70f, 0.04f, 0.03f}};
constexpr std::array<std::uint8_t, 3> kOutside{250, 249, 246}, kInside{178, 174, 166}, kExtra{43, 87, 178},
    kMissing{179, 38, 30};

// Lines along x, whose rows are planes across z.
constexpr std::size_t kSliced = 0;

constexpr std::array kDrawn{RefineMethod::All, RefineMethod::Document, RefineMethod::Ends,
                            RefineMethod::Touching};

DisplayImage surfaceImage(const Reference& reference, const RefinedModel& judged, const Camera& camera,
                          const Execution& execution) {
  std::vector<points::Surfel> surfels;
  for (const MarkedEnd& end : markedEnds(reference, judged)) {
    points::Surfel surfel = end.surfel;
    // Base, added and carved of the palette.
    surfel.primitive = end.kind == EndKind::Extra ? 1 : 0;
    surfel.sign = end.kind == EndKind::Missing ? implicit::Sign::Negative : implicit::Sign::Positive;
    surfels.push_back(surfel);
  }
  const points::Scene scene{.surfels = surfels};
  return points::toDisplay(points::render(scene, camera, {.palette = kPalette}, execution));
}

/// The lines of the plane with row `row`.
std::vector<SliceLine> linesOf(const Reference& reference, const RefinedModel& judged, int row) {
  const points::Dexels &a = reference.model().families.at(kSliced).dexels,
                       &b = judged.families.at(kSliced).dexels;
  std::vector<SliceLine> lines(static_cast<std::size_t>(a.width()));
  for (int column = 0; column < a.width(); ++column) {
    SliceLine& line = lines[static_cast<std::size_t>(column)];
    a.read(a.lineAt(column, row), line.reference);
    b.read(b.lineAt(column, row), line.judged);
  }
  return lines;
}

/// The row that has most wrong length; the middle one where nothing is wrong.
int worstRow(const Reference& reference, const RefinedModel& judged) {
  const int rows = reference.model().families.at(kSliced).dexels.height();
  int worst = rows / 2;
  double most = 0;
  std::vector<WrongStretch> stretches;
  for (int row = 0; row < rows; ++row) {
    double wrong = 0;
    for (const SliceLine& line : linesOf(reference, judged, row)) {
      findWrongStretches(line.reference, line.judged, stretches);
      for (const WrongStretch& s : stretches)
        wrong += static_cast<double>(s.to) - static_cast<double>(s.from);
    }
    if (wrong > most) {
      most = wrong;
      worst = row;
    }
  }
  return worst;
}

double wrongOf(const Reference& reference, const RefinedModel& judged, const Execution& execution) {
  const Differences d = differencesOf(reference, judged, execution);
  return reference.length() > 0 ? (d.missing + d.extra) / reference.length() : 0;
}

std::pair<float, float> depthsOf(const points::LinesInZone& lines) {
  float from = INFINITY, to = -INFINITY;
  for (std::size_t i = 0; i < lines.from.size(); ++i) {
    from = std::min(from, lines.from[i]);
    to = std::max(to, lines.to[i]);
  }
  return {from, to};
}

bool isInside(const LineEnds& ends, float depth) {
  const auto after = std::ranges::upper_bound(ends, depth, {}, &SpanEnd::depth);
  return (after - ends.begin()) % 2 == 1;
}

}  // namespace

DisplayImage sliceImage(const std::vector<SliceLine>& lines, float from, float to, std::uint32_t size) {
  RESTROKE_CHECK_LT(0u, lines.size());
  DisplayImage image{size, size, std::vector<std::uint8_t>(std::size_t{4} * size * size, 255)};
  for (std::uint32_t y = 0; y < size; ++y) {
    const SliceLine& line = lines[(size - 1 - y) * lines.size() / size];
    for (std::uint32_t x = 0; x < size; ++x) {
      const double part = (x + 0.5) / size;
      const auto depth =
          static_cast<float>(static_cast<double>(from) * (1 - part) + static_cast<double>(to) * part);
      const bool is = isInside(line.judged, depth), should = isInside(line.reference, depth);
      const auto& colour = is ? (should ? kInside : kExtra) : (should ? kMissing : kOutside);
      std::copy(colour.begin(), colour.end(), image.rgba.begin() + std::ptrdiff_t{4} * (y * size + x));
    }
  }
  return image;
}

std::vector<PictureCase> pictureCases(const LossOptions& options, std::uint64_t seed) {
  std::vector<PictureCase> cases;
  const auto add = [&](std::string title, std::string slug, LossModel model) {
    model.parts = {options.part};
    cases.push_back({std::move(title), std::move(slug), std::move(model)});
  };
  const int coarse = options.resolutions.front();
  add(fmt::format("{} random adds and carves, {} lines", options.operations, coarse), "dense",
      {.history = strewnBalls({.operations = options.operations, .seed = seed}),
       .resolution = coarse,
       .parts = {}});
  add(fmt::format("milled by {} places of a cutter, {} lines", options.operations, coarse), "milled",
      {.history = milledBlock(options.operations, seed), .resolution = coarse, .parts = {}});
  add(fmt::format("rods half a cell thick between the lines, {} lines", options.thinLines), "rods",
      {.sweep = LossSweep::Thin,
       .history = thinFeatures({.thin = Thin::Rods,
                                .thickness = 0.5,
                                .resolution = options.thinLines,
                                .between = true,
                                .seed = seed}),
       .resolution = options.thinLines,
       .parts = {}});
  return cases;
}

std::vector<LossPicture> drawLoss(const PictureCase& drawn, const PictureOptions& options, std::uint64_t seed,
                                  const Execution& execution) {
  const LossModel& model = drawn.model;
  const points::TriDexelDocument document =
      documentOf(model.history, model.resolution, Kept::Histories, execution);
  const points::DexelHistory history(document, execution);
  const auto places = model.sweep == LossSweep::Thin ? placesOfOperations(model.history, options.places, seed)
                                                     : placesOnSurface(document.model, options.places, seed);
  const auto by = [&](const Zone& zone, RefineMethod method) {
    return points::refine({document, history}, {zone, newLines(zone, {.resolution = options.fineLines})},
                          {.method = method}, execution);
  };
  std::optional<Zone> zone;
  double most = -1;
  for (const DVec3 place : places) {
    const Zone candidate = zoneAt(boundsOf(model.history), options.part, place);
    const double wrong =
        wrongOf(Reference(by(candidate, RefineMethod::All)), by(candidate, RefineMethod::Ends), execution);
    if (wrong <= most) continue;
    most = wrong;
    zone = candidate;
  }
  const Reference reference(by(*zone, RefineMethod::All));
  const int row = worstRow(reference, by(*zone, RefineMethod::Ends));
  const auto [from, to] = depthsOf(reference.model().families.at(kSliced).lines);
  const Box box = zone->bounds();
  const Camera camera = frameSphere(
      box.center(), box.halfDiagonal(),
      {.view = {-0.55f, -0.45f, -1}, .width = options.size, .height = options.size, .fill = 1.0f});
  std::vector<LossPicture> pictures;
  for (const RefineMethod method : kDrawn) {
    const RefinedModel refined = by(*zone, method);
    pictures.push_back({drawn.title, std::string(nameOf(method)), drawn.slug,
                        wrongOf(reference, refined, execution),
                        surfaceImage(reference, refined, camera, execution),
                        sliceImage(linesOf(reference, refined, row), from, to, options.size)});
  }
  return pictures;
}

}  // namespace restroke::experiments
