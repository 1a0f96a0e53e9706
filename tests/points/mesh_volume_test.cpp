// Volumes that are meshes against the winding number, on the files that other people made
// (shared/data/README.md), and what becomes of files that are no boundary of a solid (S13).

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "implicit/errors.h"
#include "implicit/geometry/mesh_faults.h"
#include "implicit/geometry/ray.h"
#include "implicit/geometry/winding_number.h"
#include "implicit/posed_volume.h"
#include "implicit/primitive_list.h"
#include "implicit/side.h"
#include "implicit/volume.h"
#include "implicit/volume_kinds.h"
#include "points/files/mesh_files.h"
#include "points/isosurface/winding_source.h"
#include "tests/points/isosurface_support.h"
#include "tests/support/brute_force.h"
#include "tests/support/effort.h"
#include "tests/support/meshes.h"
#include "tests/support/shared_meshes.h"

namespace restroke::points {
namespace {

namespace fs = std::filesystem;
using implicit::MeshSource;
using implicit::Side;
using implicit::Volume;
using restroke::testing::ballMesh;
using restroke::testing::boxMesh;
using restroke::testing::insideOut;
using restroke::testing::meshesIn;
using restroke::testing::meshFolder;
using restroke::testing::Random;
using testing::distanceFrom;

std::shared_ptr<const Volume> solidOf(TriangleMesh mesh, const std::string& file = {}) {
  auto source = std::make_shared<MeshSource>();
  source->mesh = std::move(mesh);
  source->file = file;
  return implicit::volumeKindNamed("mesh").make({{{}}, source});
}

double sizeOf(const Box& box) {
  return static_cast<double>(box.halfDiagonal()) * 2;
}

/// Anywhere in 1.2 times the box.
DVec3 randomAround(Random& random, const Box& box) {
  const DVec3 u(random.inCube(1.2f));
  return DVec3(box.center()) + u * (DVec3(box.max) - DVec3(box.min)) * 0.5;
}

/// Once for all tests: reading is quick, the making of a volume takes a while.
struct Closed {
  std::string name;
  TriangleMesh mesh;
  std::shared_ptr<const Volume> volume;
};
const std::vector<Closed>& closedMeshes() {
  static const std::vector<Closed> all = [] {
    std::vector<Closed> made;
    for (const fs::path& file : meshesIn("closed")) {
      TriangleMesh mesh = readMesh(file);
      auto volume = solidOf(mesh, file.string());
      made.push_back({file.filename().string(), std::move(mesh), std::move(volume)});
    }
    return made;
  }();
  return all;
}

class MeshVolumeData : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::is_directory(meshFolder())) GTEST_SKIP() << "no shared data: " << meshFolder();
  }
};

TEST_F(MeshVolumeData, S13SideTestsAgreeWithTheWindingNumber) {
  // RESTROKE_MESH_POINTS=100000 asks about as many points of each mesh; the default keeps the test short.
  const char* asked = std::getenv("RESTROKE_MESH_POINTS");
  const int points = asked ? std::max(1000, std::atoi(asked)) : restroke::testing::kSanitized ? 1000 : 10'000;
  const int exactly = points / 100;
  for (const Closed& closed : closedMeshes()) {
    SCOPED_TRACE(closed.name);
    const WindingNumber winding(closed.mesh);
    const Box box = boundsOf(closed.mesh);
    const double near = 1e-5 * sizeOf(box);
    Random random(21);
    int inside = 0, disagree = 0, wrong = 0;
    for (int i = 0; i < points; ++i) {
      const DVec3 p = randomAround(random, box);
      const bool mine = closed.volume->contains(p, 0);
      const bool truth = i < exactly ? winding.exactAt(p) > 0.5 : winding.isInside(p);
      inside += truth ? 1 : 0;
      if (mine == truth) continue;
      ++disagree;
      wrong += distanceFrom(closed.mesh, p, 2 * near) > near ? 1 : 0;
    }
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(inside, points / 50);
    std::printf("%-22s %6d of %d points inside, %d disagree, %d of them away from the surface\n",
                closed.name.c_str(), inside, points, disagree, wrong);
  }
}

TEST_F(MeshVolumeData, S4CarvedFromASphereTheListComposesThem) {
  constexpr int kPoints = restroke::testing::kSanitized ? 500 : 10'000;
  for (const Closed& closed : closedMeshes()) {
    SCOPED_TRACE(closed.name);
    const implicit::VolumeMeasures& m = closed.volume->measures();
    Random random(22);
    implicit::Pose pose;
    for (float& q : pose.rotation) q = random.between(-1, 1);
    pose.scale = static_cast<float>(0.7 / m.radius);
    // The mesh's middle to where it reaches half out of the sphere.
    const DVec3 middle = implicit::PosedVolume(closed.volume, pose).toModel(m.center);
    pose.position = Point(DVec3(0.7, 0.2, -0.3) - middle);
    const auto posed = std::make_shared<const implicit::PosedVolume>(closed.volume, pose);
    implicit::PrimitiveList list;
    list.append({implicit::Sphere{}, implicit::Sign::Positive});
    list.append({posed, implicit::Sign::Negative});
    const WindingNumber winding(closed.mesh);
    std::vector<Point> points;  // by turns around both, and where the tool is
    const Box box = boundsOf(closed.mesh);
    for (int i = 0; i < kPoints; i += 2) {
      points.push_back(Point(0.35f, 0.1f, -0.15f) + random.inCube(1));
      points.push_back(Point(posed->toModel(randomAround(random, box))));
    }
    std::vector<Side> sides(points.size());
    sidesOf(list, points, sides);
    int carved = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const DVec3 p(points[i]), local = posed->toLocal(p);
      const double near = 1e-5 * m.radius;
      const bool inTool = winding.isInside(local), inBall = dot(p, p) <= 1;
      carved += inTool && inBall ? 1 : 0;
      const Side truth = inBall && !inTool ? Side::Inside : Side::Outside;
      ASSERT_EQ(sides[i], sideOf(list, points[i]));
      if (sides[i] == truth || std::fabs(length(p) - 1) < 1e-5) continue;
      ASSERT_LE(distanceFrom(closed.mesh, local, 2 * near), near) << "point " << i;
    }
    EXPECT_GT(carved, kPoints / 200);
  }
}

TEST_F(MeshVolumeData, S7RayIntervalsAgreeWithDenseSideTests) {
  constexpr int kRays = restroke::testing::kSanitized ? 10 : 200;
  for (const Closed& closed : closedMeshes()) {
    SCOPED_TRACE(closed.name);
    const Volume& volume = *closed.volume;
    const Box box = boundsOf(closed.mesh);
    const double size = volume.measures().radius, near = size * 0x1p-20;
    Random random(23);
    std::vector<RayInterval> in;
    int hits = 0;
    for (int k = 0; k < kRays; ++k) {
      const DVec3 through = randomAround(random, box);
      DVec3 d = normalized(randomAround(random, box) - through);
      if (k % 5 == 0) d = DVec3(k % 3 == 0, k % 3 == 1, k % 3 == 2);
      const Ray ray{through - 3 * size * d, d, 0, 6 * size};
      in.clear();
      volume.intersect(ray, in);
      hits += !in.empty() ? 1 : 0;
      for (std::size_t i = 0; i < in.size(); ++i) {
        ASSERT_LE(in[i].enter, in[i].exit);
        if (i > 0) {
          ASSERT_LT(in[i - 1].exit, in[i].enter);
        }
      }
      for (int j = 0; j < 1000; ++j) {
        const double t = ray.tMax * (j + 0.5) / 1000;
        bool inside = false, undecided = false;
        for (const RayInterval& i : in) {
          inside = inside || (i.enter <= t && t <= i.exit);
          undecided = undecided || std::min(std::fabs(t - i.enter), std::fabs(t - i.exit)) < near;
        }
        if (undecided || volume.contains(ray.at(t), 0) == inside) continue;
        // A ray that runs along the surface.
        ASSERT_LE(distanceFrom(closed.mesh, ray.at(t), 2 * near), near) << "line " << k << " at " << t;
      }
    }
    EXPECT_GT(hits, kRays / 10);
  }
}

/// What a file that is no boundary of a solid gives.
enum class Outcome : std::uint8_t {
  Fine,          ///< nothing is wrong with it: bad for other programs
  Empty,         ///< no solid can be made of it
  TurnedAround,  ///< only inside out
  Remeshed       ///< repaired
};
struct Bad {
  const char* file;
  Outcome outcome;
  const char* fault;  ///< part of the sentence that refuses it
};
const std::vector<Bad>& badFiles() {
  static const std::vector<Bad> rows = {
      {"10_000.stl", Outcome::TurnedAround, "inside out"},
      {"20mmbox.stl", Outcome::Empty, "no triangles"},
      {"Spider_ascii.stl", Outcome::Remeshed, "72 edges belong to one triangle only"},
      {"Spider_binary.stl", Outcome::Remeshed, "72 edges belong to one triangle only"},
      {"blobby-shuffled.off", Outcome::Remeshed,
       "3069 edges have two triangles that are wound in opposite senses"},
      {"bones.off", Outcome::Remeshed, "366 pairs of triangles meet"},
      {"cube-shuffled.off", Outcome::Remeshed,
       "9 edges have two triangles that are wound in opposite senses"},
      {"elephant-with-holes.off", Outcome::Remeshed, "1353 edges belong to one triangle only"},
      {"idler_riser.STL", Outcome::Remeshed, "44 edges belong to one triangle only"},
      {"off_formatDetection", Outcome::Fine, ""},
      {"prim.off", Outcome::Fine, ""},
      {"shared.STL", Outcome::Remeshed, "one edge belongs to more than two triangles"},
      {"soup.stl", Outcome::Remeshed, "300 edges belong to one triangle only"},
      {"sphereWithHole.stl", Outcome::Remeshed, "9 edges belong to one triangle only"},
      {"stanford-bunny.obj", Outcome::Remeshed, "223 edges belong to one triangle only"},
      {"stl_formatDetection", Outcome::Empty, "3 edges belong to one triangle only"},
      {"suzanne.obj", Outcome::Remeshed, "42 edges belong to one triangle only"},
      {"teapot.obj", Outcome::Remeshed, "160 edges belong to one triangle only"},
      {"tetrahedron.off", Outcome::TurnedAround, "inside out"},
      {"triangle_with_two_solids.stl", Outcome::Empty, "6 edges belong to one triangle only"},
  };
  return rows;
}

/// Calls f, which must be refused in one sentence that has all of the parts.
template <class F>
void expectRefused(const F& f, const std::vector<std::string>& parts) {
  try {
    f();
    ADD_FAILURE() << "was taken";
  } catch (const InputError& error) {
    const std::string sentence = error.what();
    EXPECT_EQ(sentence.find('\n'), std::string::npos) << sentence;
    for (const std::string& part : parts) EXPECT_NE(sentence.find(part), std::string::npos) << sentence;
  }
}

void checkRemeshed(const Bad& bad, const TriangleMesh& mesh, const Repaired& repaired) {
  ASSERT_TRUE(faultsOf(repaired.mesh).none()) << describe(faultsOf(repaired.mesh));
  const auto volume = solidOf(repaired.mesh);
  const WindingNumber winding(mesh);
  const Box box = boundsOf(repaired.mesh);
  const Box domain = WindingSource(mesh).bounds();
  const DVec3 extent(domain.max - domain.min);
  const double cell = std::max({extent.x, extent.y, extent.z}) / kRepairResolution;
  constexpr int kLookedAt = 100;  // each takes a look at all triangles
  Random random(24);
  int inside = 0, disagree = 0;
  for (int i = 0; i < 10'000; ++i) {
    const DVec3 p = randomAround(random, box);
    const bool truth = winding.isInside(p);
    inside += truth ? 1 : 0;
    if (volume->contains(p, 0) == truth) continue;
    if (++disagree > kLookedAt) continue;
    // The solid is sampled at grid points. A point it gets wrong is less than a cell from its surface, or
    // from where the winding number says otherwise (sheets thinner than a cell).
    bool close = distanceFrom(repaired.mesh, p, 2 * cell) <= cell;
    for (int k = 0; k < 400 && !close; ++k)
      close = winding.isInside(p + DVec3(random.inCube(1)) * cell) != truth;
    EXPECT_TRUE(close) << fmt::format("point ({}, {}, {})", p.x, p.y, p.z);
  }
  std::printf("%-22s %6zu triangles to %6zu, %5d of 10000 points inside, %d disagree, within a cell\n",
              bad.file, mesh.triangles.size(), repaired.mesh.triangles.size(), inside, disagree);
}

TEST_F(MeshVolumeData, S13BadFilesAreRefusedOrRepaired) {
  if (restroke::testing::kSanitized) GTEST_SKIP() << "takes minutes with sanitizers; the plain builds run it";
  std::size_t files = 0;
  for (const fs::path& path : meshesIn("bad")) {
    ++files;
    const auto row = std::find_if(badFiles().begin(), badFiles().end(),
                                  [&](const Bad& b) { return path.filename().string() == b.file; });
    if (row == badFiles().end()) {
      ADD_FAILURE() << path.filename() << " is not in the table";
      continue;
    }
    SCOPED_TRACE(row->file);
    const std::string name = path.string();
    const TriangleMesh mesh = readMesh(path);
    if (row->outcome == Outcome::Fine) {
      EXPECT_NO_THROW((void)solidOf(mesh, name));
      EXPECT_EQ(repairByWinding(mesh).way, Repaired::Way::None);
      continue;
    }
    expectRefused([&] { (void)solidOf(mesh, name); }, {name, row->fault});
    if (row->outcome == Outcome::Empty) {
      expectRefused([&] { (void)repairByWinding(mesh); }, {"winding number", row->fault});
      continue;
    }
    const Repaired repaired = repairByWinding(mesh);
    if (row->outcome == Outcome::TurnedAround) {
      EXPECT_EQ(repaired.way, Repaired::Way::TurnedAround);
      EXPECT_EQ(repaired.mesh, insideOut(mesh));
      EXPECT_TRUE(faultsOf(repaired.mesh).none());
    } else {
      ASSERT_EQ(repaired.way, Repaired::Way::Remeshed);
      checkRemeshed(*row, mesh, repaired);
    }
  }
  EXPECT_EQ(files, badFiles().size());
}

TEST_F(MeshVolumeData, S13TheElephantWithHolesBecomesTheElephant) {
  if (restroke::testing::kSanitized) GTEST_SKIP() << "takes minutes with sanitizers; the plain builds run it";
  const TriangleMesh whole = readMesh(meshFolder() / "closed" / "elephant.off");
  const auto truth = solidOf(whole);
  const auto mine = solidOf(repairByWinding(readMesh(meshFolder() / "bad" / "elephant-with-holes.off")).mesh);
  Random random(25);
  int agree = 0, either = 0, both = 0;
  constexpr int kPoints = 50'000;
  for (int i = 0; i < kPoints; ++i) {
    const DVec3 p = randomAround(random, boundsOf(whole));
    const bool a = truth->contains(p, 0), b = mine->contains(p, 0);
    agree += a == b ? 1 : 0;
    either += a || b ? 1 : 0;
    both += a && b ? 1 : 0;
  }
  std::printf("elephant: %.2f %% of points agree, intersection over union %.4f\n", 100.0 * agree / kPoints,
              static_cast<double>(both) / either);
  EXPECT_GE(agree, 0.97 * kPoints);
}

TEST(RepairByWinding, AMeshWithoutFaultsStaysAsItIs) {
  const TriangleMesh box = boxMesh({0, 0, 0}, {1, 2, 3});
  const Repaired repaired = repairByWinding(box);
  EXPECT_EQ(repaired.way, Repaired::Way::None);
  EXPECT_EQ(repaired.mesh, box);
}

TEST(RepairByWinding, AMeshInsideOutIsTurnedAroundExactly) {
  const TriangleMesh box = boxMesh({0, 0, 0}, {1, 2, 3});
  const Repaired repaired = repairByWinding(insideOut(box));
  EXPECT_EQ(repaired.way, Repaired::Way::TurnedAround);
  EXPECT_EQ(repaired.mesh, box);
}

TEST(RepairByWinding, AMissingFaceIsClosedWhereTheWindingNumberIsOneHalf) {
  TriangleMesh box = boxMesh({-1, -1, -1}, {1, 1, 1});
  box.triangles.erase(box.triangles.begin());  // half of the bottom
  for (const int resolution : {24, 64}) {
    const Repaired repaired = repairByWinding(box, {.resolution = resolution});
    ASSERT_EQ(repaired.way, Repaired::Way::Remeshed);
    ASSERT_TRUE(faultsOf(repaired.mesh).none()) << describe(faultsOf(repaired.mesh));
    // The hole's cover bends in by some of its size; elsewhere the box is as it was, its corners sharp.
    EXPECT_NEAR(restroke::volumeOf(repaired.mesh), 8, 0.35);
    const Box bounds = boundsOf(repaired.mesh);
    EXPECT_NEAR(bounds.max.x, 1, 1e-5);
    EXPECT_NEAR(bounds.max.y, 1, 1e-5);
    EXPECT_NEAR(bounds.max.z, 1, 1e-5);
    EXPECT_LT(distanceFrom(repaired.mesh, DVec3(1, 1, 1), 1), 1e-5);
  }
}

TEST(RepairByWinding, ShellsThatOverlapBecomeOneSolid) {
  const TriangleMesh two =
      restroke::testing::together(boxMesh({0, 0, 0}, {2, 2, 2}), boxMesh({1, 1, 1}, {3, 3, 3}));
  const Repaired repaired = repairByWinding(two, {.resolution = 48});
  ASSERT_TRUE(faultsOf(repaired.mesh).none());
  EXPECT_NEAR(restroke::volumeOf(repaired.mesh), 15, 0.01);
}

TEST(RepairByWinding, TheSameBitsWithEveryNumberOfThreads) {
  TriangleMesh ball = ballMesh(3);
  ball.triangles.resize(ball.triangles.size() - 40);
  const Repaired one = repairByWinding(ball, {.resolution = 40}, {.threads = 1});
  for (const int threads : {2, 8})
    EXPECT_EQ(repairByWinding(ball, {.resolution = 40}, {.threads = threads}).mesh, one.mesh);
}

TEST(RepairByWinding, NothingToFillIsRefused) {
  const TriangleMesh triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  expectRefused([&] { (void)repairByWinding({}); }, {"winding number"});
  expectRefused([&] { (void)repairByWinding(triangle); }, {"winding number", "edges"});
  const TriangleMesh point{{{1, 2, 3}}, {{0, 0, 0}}};
  expectRefused([&] { (void)repairByWinding(point); }, {"winding number"});
  // Half of a box inside out: no more than 0 anywhere.
  TriangleMesh half = insideOut(boxMesh({0, 0, 0}, {1, 1, 1}));
  half.triangles.resize(8);
  expectRefused([&] { (void)repairByWinding(half); }, {"winding number"});
}

}  // namespace
}  // namespace restroke::points
