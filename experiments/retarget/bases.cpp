#include "experiments/retarget/bases.h"

#include <array>

#include "experiments/retarget/fine_mesh.h"
#include "implicit/geometry/deformations.h"
#include "implicit/volume.h"
#include "sculpt/shape_text.h"

namespace restroke::experiments {
namespace {

/// A ball with bulges and a dent, no two alike.
implicit::Shape lump(double edge) {
  std::vector<std::shared_ptr<const SmoothMap>> maps;
  const auto bulge = [&](DVec3 center, double radius, double amplitude) {
    maps.push_back(std::make_shared<BulgeMap>(center, radius, amplitude));
  };
  bulge({0.15, 0.1, 0.45}, 0.7, 0.9);
  bulge({0.5, 0.55, 0.05}, 0.8, 1.1);
  bulge({-0.45, -0.5, 0.25}, 0.7, 0.8);
  bulge({-0.5, 0.2, -0.6}, 0.75, 1.2);
  bulge({0.5, -0.45, 0.65}, 0.5, -0.5);
  const SurfaceMesh ball = fineMeshOf(implicit::Shape(Point(0), 0.8f), {.edge = edge});
  return shapeOf(mapped(ball, ComposedMap(std::move(maps))).mesh);
}

implicit::Shape made(std::string_view kind, std::vector<std::vector<float>> values) {
  return std::make_shared<const implicit::PosedVolume>(
      implicit::volumeKindNamed(kind).make({.values = std::move(values)}), implicit::Pose{});
}

}  // namespace

std::vector<RetargetBase> builtInBases(double lumpEdge) {
  return {{.name = "sphere", .shape = implicit::Shape(Point(0), 1), .tellsMotion = false},
          {.name = "ellipsoid", .shape = made("ellipsoid", {{1}, {0.8f}, {0.6f}}), .tellsMotion = false},
          {.name = "superellipsoid",
           .shape = made("superellipsoid", {{0.9f}, {0.75f}, {0.6f}, {0.5f}, {0.5f}}),
           .tellsMotion = false},
          {.name = "lump", .shape = lump(lumpEdge)}};
}

std::vector<RetargetBase> meshBases(const std::filesystem::path& folder) {
  struct Choice {
    const char* file;
    bool tellsMotion;
  };
  constexpr std::array kChoices{Choice{"bunny.off", true}, Choice{"spot.obj", true},
                                Choice{"elephant.off", true}, Choice{"fandisk.obj", true},
                                Choice{"knot1.off", false}};
  std::vector<RetargetBase> bases;
  for (const Choice& choice : kChoices) {
    const std::filesystem::path file = folder / choice.file;
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) continue;
    bases.push_back({.name = file.stem().string(),
                     .shape = sculpt::shapeNamed(file.string(), sculpt::Repair::None, "retarget"),
                     .tellsMotion = choice.tellsMotion,
                     .file = file.string()});
  }
  return bases;
}

}  // namespace restroke::experiments
