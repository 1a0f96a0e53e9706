// One stroke log drives every back end (SPEC X1): logs and stamp lists as tri-dexels against the ordered list
// itself. Sides of points may differ within one cell of the surface, nowhere else.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "implicit/side.h"
#include "points/dexel/tri_dexel.h"
#include "sculpt/replay.h"
#include "sculpt/stroke_log.h"
#include "tests/support/brute_force.h"
#include "tests/support/effort.h"

namespace restroke {
namespace {

namespace fs = std::filesystem;
using restroke::testing::Random;

std::vector<fs::path> logs() {
  std::vector<fs::path> files;
  for (const char* name : {"table2", "paper-scale", "rabbit", "gallery", "figure10"})
    files.push_back(fs::path(RESTROKE_SOURCE_DIR) / "experiments" / "examples" /
                    (std::string(name) + ".log"));
  for (const char* name : {"paper-8x556", "paper-108x3426"})
    files.push_back(fs::path(RESTROKE_SHARED_DIR) / "data" / "stamps" / (std::string(name) + ".stamps"));
  return files;
}

// What most of the nearest lines of the three families say.
bool isInside(const points::TriDexel& model, Point p) {
  const points::DexelGrid& grid = model.grid();
  int votes = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const points::Dexels& family = model.family(axis);
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    votes += family.contains(family.lineAt(grid.nearestTo(u, p[u]), grid.nearestTo(v, p[v])), p[axis]);
  }
  return votes >= 2;
}

class DexelsOfLogs : public ::testing::TestWithParam<fs::path> {};

TEST_P(DexelsOfLogs, X1DifferFromTheListOnlyWithinACellOfTheSurface) {
  if (!fs::exists(GetParam())) GTEST_SKIP() << "no shared data: " << GetParam();
  const sculpt::Document document = sculpt::replay(sculpt::readLog(GetParam()), {.file = GetParam()}, {});
  const implicit::PrimitiveList& list = document.model().list();
  const points::DexelGrid grid =
      points::dexelGridFor(list.bounds(), {.resolution = restroke::testing::kSanitized ? 24 : 128});
  const points::TriDexel model = triDexelOf(list, grid);

  Random random(31);
  const Box bounds = list.bounds();
  const auto cell = static_cast<float>(grid.cell());
  std::size_t inside = 0, different = 0;
  constexpr std::size_t kPoints = 40'000;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const Point p = bounds.center() + random.inCube(0.5f) * (bounds.max - bounds.min);
    const bool expected = sideOf(list, p) == implicit::Side::Inside;
    inside += expected;
    if (isInside(model, p) == expected) continue;
    ++different;
    bool isNear = false;
    for (int k = 0; k < 2000 && !isNear; ++k) {
      const Vec3 offset = random.inCube(1);
      if (dot(offset, offset) <= 1)
        isNear = (sideOf(list, p + cell * offset) == implicit::Side::Inside) != expected;
    }
    EXPECT_TRUE(isNear) << p.x << ", " << p.y << ", " << p.z;
  }
  EXPECT_GT(inside, kPoints / 50);
  // A share of the cells that the surface passes through.
  EXPECT_LT(different, kPoints / (restroke::testing::kSanitized ? 8 : 50));
}

INSTANTIATE_TEST_SUITE_P(All, DexelsOfLogs, ::testing::ValuesIn(logs()), [](const auto& each) {
  std::string name = each.param.stem().string();
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
});

}  // namespace
}  // namespace restroke
