// Mesh tools in poses: against Booleans of whole models, and what is refused (D1, D6).

#include "points/dexel/dexel_tool.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "implicit/atomic_file.h"
#include "implicit/errors.h"
#include "points/dexel/mesh_dexels.h"
#include "points/dexel/tool_pose.h"
#include "tests/support/brute_force.h"
#include "tests/support/effort.h"
#include "tests/support/meshes.h"

namespace restroke::points {
namespace {

using implicit::Primitive;
using implicit::Sign;
using restroke::testing::ballMesh;
using restroke::testing::boxMesh;
using restroke::testing::insideOut;
using restroke::testing::kSanitized;
using restroke::testing::Random;
using restroke::testing::together;

// Equal bit for bit; if not, the first line that differs.
void expectSame(const TriDexel& model, const TriDexel& expected) {
  ASSERT_EQ(model.grid(), expected.grid());
  LineEnds a, b;
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t line = 0; line < expected.family(axis).lineCount(); ++line) {
      model.family(axis).read(line, a);
      expected.family(axis).read(line, b);
      ASSERT_EQ(a.size(), b.size()) << "axis " << axis << ", line " << line;
      for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_EQ(a[i].depth, b[i].depth) << "axis " << axis << ", line " << line << ", end " << i;
        ASSERT_EQ(a[i].normal, b[i].normal) << "axis " << axis << ", line " << line << ", end " << i;
        ASSERT_EQ(a[i].inner, b[i].inner) << "axis " << axis << ", line " << line << ", end " << i;
        ASSERT_EQ(a[i].outer, b[i].outer) << "axis " << axis << ", line " << line << ", end " << i;
      }
    }
}

constexpr std::array kOperations{DexelOperation::Union, DexelOperation::Subtraction,
                                 DexelOperation::Intersection};

// Two balls and a cavity: several spans on many lines.
TriangleMesh severalShells(int level) {
  TriangleMesh mesh = ballMesh(level);
  TriangleMesh other = ballMesh(level);
  for (Point& p : other.vertices) p = p * 0.5f + Vec3(0.25f, 2, 0.125f);
  TriangleMesh cavity = insideOut(ballMesh(level));
  for (Point& p : cavity.vertices) p = p * 0.5f;
  return together(together(std::move(mesh), other), cavity);
}

TriangleMesh posedMesh(TriangleMesh mesh, const PoseMatrix& pose) {
  for (Point& p : mesh.vertices) p = Point(posed(pose, DVec3(p)));
  return mesh;
}

PoseMatrix randomPose(Random& random, double scale) {
  DVec3 x = normalized(DVec3(random.inCube(1)) + DVec3(0.1, 0, 0)), y(random.inCube(1));
  y = normalized(y - dot(x, y) * x);
  const DVec3 z = cross(x, y), t(random.inCube(0.8f));
  x *= scale;
  y *= scale;
  const DVec3 w = scale * z;
  return {x.x, y.x, w.x, t.x, x.y, y.y, w.y, t.y, x.z, y.z, w.z, t.z, 0, 0, 0, 1};
}

TEST(DexelTool, InAPoseIsTheBooleanWithTheModelOfThePosedMesh) {
  const TriangleMesh workpiece = ballMesh(4), mesh = severalShells(3);
  const DexelGrid grid = dexelGridFor(boundsOf(workpiece), {.resolution = 70});
  const std::vector<PoseMatrix> poses = {
      kIdentityPose,
      {0, -0.5, 0, 0.25, 0.5, 0, 0, -0.5, 0, 0, 0.5, 0.125, 0, 0, 0, 1},
      {0, 0, 0.25, 0.75, 0.25, 0, 0, 0.25, 0, 0.25, 0, -0.5, 0, 0, 0, 1},
      {-0.125, 0, 0, 0.5, 0, -0.125, 0, 0.5, 0, 0, 0.125, 0.5, 0, 0, 0, 1},
      {1, 0, 0, 50, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},  // nowhere near
  };
  for (const DexelOperation operation : kOperations) {
    TriDexel model = triDexelOf(workpiece, grid), expected = model;
    std::uint32_t id = 0;
    for (const PoseMatrix& pose : poses) {
      SCOPED_TRACE(id);
      const auto own = OperationId{++id};
      // Float32 has room for some of the posed digits only: both get the same.
      const TriangleMesh there = posedMesh(mesh, pose);
      apply(model, DexelTool(there), {kIdentityPose, operation, own});
      expected.apply(triDexelOf(there, grid), operation, own);
      expectSame(model, expected);
    }
  }
}

TEST(DexelTool, GoesWhereItsPoseTakesIt) {
  const TriangleMesh workpiece = ballMesh(4);
  TriangleMesh mesh = severalShells(3);
  // Ten digits after the point: exact under the poses below.
  for (Point& p : mesh.vertices)
    p = {std::round(p.x * 1024) / 1024, std::round(p.y * 1024) / 1024, std::round(p.z * 1024) / 1024};
  const DexelGrid grid = dexelGridFor(boundsOf(workpiece), {.resolution = 70});
  const DexelTool tool(mesh);
  const std::vector<PoseMatrix> poses = {
      {0, -0.5, 0, 0.25, 0.5, 0, 0, -0.5, 0, 0, 0.5, 0.125, 0, 0, 0, 1},
      {0, 0, 0.25, 0.75, 0.25, 0, 0, 0.25, 0, 0.25, 0, -0.5, 0, 0, 0, 1},
      {-0.125, 0, 0, 0.5, 0, -0.125, 0, 0.5, 0, 0, 0.125, 0.5, 0, 0, 0, 1},
  };
  for (const DexelOperation operation : kOperations)
    for (const bool keepsOperations : {true, false}) {
      TriDexel model(grid, {.operations = keepsOperations});
      model.apply(triDexelOf(workpiece, grid), DexelOperation::Union, OperationId::Initial);
      TriDexel expected = model;
      std::uint32_t id = 0;
      for (const PoseMatrix& pose : poses) {
        const auto own = OperationId{++id};
        apply(model, tool, {pose, operation, own});
        expected.apply(triDexelOf(posedMesh(mesh, pose), grid), operation, own);
        SCOPED_TRACE(::testing::Message() << "operation " << static_cast<int>(operation) << " pose " << id);
        expectSame(model, expected);
      }
    }
}

TEST(DexelTool, InAnyPoseIsWithinRoundingOfTheMeshRoundedToFloat32) {
  Random random(4);
  const TriangleMesh workpiece = ballMesh(4), mesh = severalShells(3);
  const DexelGrid grid = dexelGridFor(boundsOf(workpiece), {.resolution = 60});
  const TriDexel before = triDexelOf(workpiece, grid);
  const DexelTool tool(mesh);
  for (int round = 0; round < 20; ++round) {
    const PoseMatrix pose = randomPose(random, 0.2 + 0.02 * round);
    for (const DexelOperation operation : kOperations) {
      TriDexel model = before, other = before;
      apply(model, tool, {pose, operation, OperationId{1}});
      other.apply(triDexelOf(posedMesh(mesh, pose), grid), operation, OperationId{1});
      EXPECT_NEAR(model.volume(), other.volume(), 1e-4);
      if (operation == DexelOperation::Subtraction) {
        EXPECT_LT(model.volume(), before.volume());
      }
    }
  }
}

TEST(DexelTool, IsTheSameForAnyNumberOfThreads) {
  const TriangleMesh workpiece = ballMesh(4);
  const DexelGrid grid = dexelGridFor(boundsOf(workpiece), {.resolution = kSanitized ? 90 : 160});
  const TriDexel before = triDexelOf(workpiece, grid);
  const DexelTool tool(severalShells(kSanitized ? 4 : 5));  // enough to be worth threads
  const PoseMatrix pose = {0.6,   -0.48, 0, 0.25, 0.48, 0.6, 0, -0.5, 0, 0, 0.7683749084919418,
                           0.125, 0,     0, 0,    1};
  for (const DexelOperation operation : kOperations) {
    TriDexel expected = before;
    apply(expected, tool, {pose, operation, OperationId{1}}, {.threads = 1});
    EXPECT_FALSE(expected == before);
    for (const int threads : {2, 8}) {
      TriDexel model = before;
      apply(model, tool, {pose, operation, OperationId{1}}, {.threads = threads});
      EXPECT_EQ(model, expected);
    }
  }
}

TEST(DexelTool, AnInsideOutToolCutsTheSame) {
  const DexelGrid grid = dexelGridFor(boundsOf(ballMesh(3)), {.resolution = 50});
  TriDexel a = triDexelOf(ballMesh(3), grid), b = a;
  const TriangleMesh box = boxMesh({0, 0, 0}, {2, 2, 2});
  apply(a, DexelTool(box), {.id = OperationId{7}});
  apply(b, DexelTool(insideOut(box)), {.id = OperationId{7}});
  EXPECT_EQ(a, b);
  EXPECT_NEAR(a.volume(), 7.0 / 8 * triDexelOf(ballMesh(3), grid).volume(), 0.02);
}

TEST(DexelTool, AnIntersectionClearsWhatIsOutsideTheTool) {
  const DexelGrid grid = dexelGridFor(boundsOf(ballMesh(3)), {.resolution = 50});
  const TriDexel ball = triDexelOf(ballMesh(3), grid);
  TriDexel model = ball;
  apply(model, DexelTool(boxMesh({-2, -2, 0}, {2, 2, 2})),
        {kIdentityPose, DexelOperation::Intersection, OperationId{1}});
  EXPECT_NEAR(model.volume(), ball.volume() / 2, 0.01);
  EXPECT_GE(model.bounds().min.z, 0);
  apply(model, DexelTool(boxMesh({5, 5, 5}, {6, 6, 6})),
        {kIdentityPose, DexelOperation::Intersection, OperationId{2}});
  EXPECT_EQ(model.endCount(), 0u);
}

// A fine mesh of a ball does what the ball does.
TEST(DexelTool, ManyCutsWithAMeshOfABallComeToThoseOfTheBall) {
  const DexelGrid grid = dexelGridFor(boundsOf(ballMesh(4)), {.resolution = 64});
  TriDexel model = triDexelOf(ballMesh(4), grid), expected = model;
  const DexelTool tool(ballMesh(kSanitized ? 3 : 4));
  Random random(11);
  for (std::uint32_t i = 1; i <= (kSanitized ? 50u : 300u); ++i) {
    Point c = random.inCube(1);
    c = c / std::fmax(length(c), 0.2f);
    const float radius = random.between(0.05f, 0.2f);
    const bool fills = i % 2 == 0;
    const auto r = static_cast<double>(radius);
    const DVec3 t(c);
    apply(model, tool,
          {{r, 0, 0, t.x, 0, r, 0, t.y, 0, 0, r, t.z, 0, 0, 0, 1},
           fills ? DexelOperation::Union : DexelOperation::Subtraction,
           OperationId{i}});
    const Primitive ball{{c, radius}, fills ? Sign::Positive : Sign::Negative};
    expected.apply({&ball, 1}, OperationId{i});
  }
  EXPECT_NEAR(model.volume(), expected.volume(), 0.01 * expected.volume());
}

TEST(DexelTool, RefusesMeshesWithoutAnInside) {
  const auto sentenceOf = [](const TriangleMesh& mesh) -> std::string {
    try {
      (void)DexelTool(mesh);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  TriangleMesh open = boxMesh({0, 0, 0}, {4, 4, 4});
  open.triangles.pop_back();
  EXPECT_NE(sentenceOf(open).find("odd number of triangles: 3, the first, of 1, from (4, "),
            std::string::npos)
      << sentenceOf(open);
  EXPECT_NE(sentenceOf({}), "");
  TriangleMesh bad = boxMesh({0, 0, 0}, {4, 4, 4});
  bad.vertices[0].x = std::numeric_limits<float>::infinity();
  EXPECT_NE(sentenceOf(bad), "");
  // Four triangles at an edge are an even number.
  TriangleMesh touching = boxMesh({0, 0, 0}, {1, 1, 1});
  const TriangleMesh second = boxMesh({1, 1, 0}, {2, 2, 1});
  touching.vertices.insert(touching.vertices.end(), second.vertices.begin(), second.vertices.end());
  for (auto t : second.triangles) {
    for (std::uint32_t& v : t) v = v == 0 ? 3 : v == 4 ? 7 : v + 8;
    touching.triangles.push_back(t);
  }
  EXPECT_EQ(sentenceOf(touching), "");
}

PoseMatrix withNumber(std::size_t i, double value) {
  PoseMatrix pose = kIdentityPose;
  pose[i] = value;
  return pose;
}

const std::vector<std::pair<PoseMatrix, const char*>>& badPoses() {
  static const std::vector<std::pair<PoseMatrix, const char*>> all = {
      {withNumber(3, std::numeric_limits<double>::quiet_NaN()), "finite"},
      {withNumber(0, std::numeric_limits<double>::infinity()), "finite"},
      {withNumber(12, 1e-9), "0 0 0 1"},
      {withNumber(15, 2), "0 0 0 1"},
      {{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, "singular"},
      {withNumber(5, 0), "singular"},
      {{1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 9, 0, 0, 0, 0, 1}, "singular"},
      {withNumber(0, 1.001), "uniform scale"},
      {withNumber(1, 0.001), "shears"},
      {withNumber(0, -1), "mirrors"},
      {{-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1}, "mirrors"},
  };
  return all;
}

TEST(ToolPose, RefusesWhatIsNoSimilarityAndSaysWhichRuleItBreaks) {
  const DexelGrid grid = dexelGridFor(boundsOf(ballMesh(2)), {.resolution = 20});
  const TriDexel before = triDexelOf(ballMesh(2), grid);
  const DexelTool tool(ballMesh(1));
  for (const auto& [pose, rule] : badPoses()) {
    SCOPED_TRACE(rule);
    TriDexel model = before;
    try {
      apply(model, tool, {.pose = pose});
      FAIL() << "accepted";
    } catch (const InputError& error) {
      const std::string sentence = error.what();
      EXPECT_NE(sentence.find(rule), std::string::npos) << sentence;
    }
    EXPECT_EQ(model, before);
  }
  TriDexel model = before;
  EXPECT_THROW(apply(model, tool, {.pose = withNumber(3, 1e39)}), InputError);
  EXPECT_THROW(apply(model, tool, {.pose = withNumber(3, -1e300)}), InputError);
  EXPECT_EQ(model, before);
}

TEST(ToolPose, AcceptsTurnsShiftsAndUniformScalesWithFewDigits) {
  checkPose(kIdentityPose);
  checkPose(
      {0.866, -0.5, 0, 5, 0.5, 0.866, 0, -1e20, 0, 0, 1, 0, 0, 0, 0, 1});  // shorter by 4e-5 of its length
  checkPose({0.70711, -0.70711, 0, 5, 0.70711, 0.70711, 0, 7, 0, 0, 1, 0, 0, 0, 0, 1});
  for (const double scale : {1e-200, 1e-10, 3.5, 1e200}) {
    PoseMatrix pose = kIdentityPose;
    for (const std::size_t i : {0u, 5u, 10u}) pose[i] = scale;
    checkPose(pose);
  }
}

TEST(PosesFile, HoldsOnePoseALine) {
  const auto poses = parsePoses(
      "# a comment\n\n1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1\r\n   \n  # another\n"
      "\t0 -1 0 +2.5 1 0 0 -3e-1 0 0 1 1e3 0 0 0 1 # a third",
      "p.txt");
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[0], kIdentityPose);
  EXPECT_EQ(poses[1], (PoseMatrix{0, -1, 0, 2.5, 1, 0, 0, -0.3, 0, 0, 1, 1000, 0, 0, 0, 1}));
  EXPECT_TRUE(parsePoses("", "p.txt").empty());
  const auto file = std::filesystem::temp_directory_path() / "restroke-poses-test.txt";
  writeFileAtomically(file, "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n");
  EXPECT_EQ(readPoses(file), std::vector{kIdentityPose});
  std::filesystem::remove(file);
}

TEST(PosesFile, ErrorsNameTheFileAndTheLine) {
  const auto expect = [](const std::string& contents, const std::string& sentence) {
    try {
      (void)parsePoses(contents, "p.txt");
      ADD_FAILURE() << "accepted: " << contents;
    } catch (const InputError& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with(sentence)) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  };
  const std::string good = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n";
  expect(good + "\n1 2 3\n", "p.txt: line 3: 3 numbers; a pose has 16");
  expect(good + "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 0\n", "p.txt: line 2: 17 numbers; a pose has 16");
  expect("1 0 0 x 0 1 0 0 0 0 1 0 0 0 0 1\n", "p.txt: line 1: a number of a pose is \"x\"");
  expect("1 0 0 nan 0 1 0 0 0 0 1 0 0 0 0 1\n", "p.txt: line 1: a number of a pose is \"nan\"");
  expect("1 0 0 1e999 0 1 0 0 0 0 1 0 0 0 0 1\n", "p.txt: line 1: a number of a pose is \"1e999\"");
  expect("# c\n1 0 0 0 0 1 0 0 0 0 -1 0 0 0 0 1\n", "p.txt: line 2: the pose mirrors the tool");
  expect("2 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n", "p.txt: line 1: the pose scales the tool's axes by 2, 1 and 1");
  expect(std::string("\0\x01\xff", 3), "p.txt: line 1: a number of a pose is");
  for (const char* missing : {"/nowhere/poses.txt", "/tmp"}) {
    try {
      (void)readPoses(missing);
      ADD_FAILURE() << "read " << missing;
    } catch (const InputError& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with(std::string(missing) + ": ")) << error.what();
    }
  }
}

}  // namespace
}  // namespace restroke::points
