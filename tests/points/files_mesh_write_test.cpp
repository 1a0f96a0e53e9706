// What is written reads back equal (S13, P12), and what cannot be written leaves no file.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "implicit/errors.h"
#include "points/files/mesh_files.h"
#include "points/files/zip.h"
#include "tests/points/mesh_file_support.h"
#include "tests/support/meshes.h"

namespace restroke::points {
namespace {

namespace fs = std::filesystem;
using testing::ballMesh;
using testing::boxMesh;
using testing::bytesOf;
using testing::floats;
using testing::kTriangle;
using testing::littleEndian;
using testing::MeshFiles;

TEST_F(MeshFiles, WhatIsNoFileIsRefused) {
  EXPECT_THROW((void)readMesh(file("absent.stl")), InputError);
  EXPECT_THROW((void)readMesh(file("")), InputError);
  EXPECT_THROW((void)readMesh("/dev/zero"), InputError);
  try {
    (void)readMesh("/no/such/file.stl");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "/no/such/file.stl: cannot read this file: No such file or directory");
  }
}

/// With vertices numbered in the order of the triangles, as STL readers do.
TriangleMesh renumbered(const TriangleMesh& mesh) {
  TriangleMesh out;
  std::vector<std::int64_t> number(mesh.vertices.size(), -1);
  for (auto t : mesh.triangles) {
    for (auto& v : t) {
      if (number[v] < 0) {
        number[v] = static_cast<std::int64_t>(out.vertices.size());
        out.vertices.push_back(mesh.vertices[v]);
      }
      v = static_cast<std::uint32_t>(number[v]);
    }
    out.triangles.push_back(t);
  }
  return out;
}

/// Coordinates of all sizes, and none that is short in decimal.
TriangleMesh awkward() {
  TriangleMesh mesh = ballMesh(3);
  std::mt19937_64 random(2);
  for (Point& p : mesh.vertices) p = p * 123.456f + Point(1e-3f, -77.7f, 1.0f / 3);
  mesh.vertices[0] = {1.17549435e-38f, 1e-45f, 999999.9f};
  mesh.vertices[1] = {-1e-7f, 16777217.0f, 3e8f};
  return mesh;
}

TEST_F(MeshFiles, WhatIsWrittenReadsBackEqualInEveryFormat) {
  for (const TriangleMesh& mesh : {awkward(), boxMesh({0, 0, 0}, {1, 2, 3})})
    for (const char* name : {"a.stl", "a.ply", "a.obj", "a.amf", "a.3mf", "A.STL"})
      for (const auto encoding : {MeshEncoding::Binary, MeshEncoding::Ascii}) {
        writeMesh(file(name), mesh, {.encoding = encoding, .unit = LengthUnit::Metre});
        const bool isStl = std::string(name).size() == 5 && (name[2] == 's' || name[2] == 'S');
        EXPECT_TRUE(readMesh(file(name)) == (isStl ? renumbered(mesh) : mesh)) << name;
        // By its contents too.
        EXPECT_TRUE(parseMesh(bytesOf(file(name)), "noname") == (isStl ? renumbered(mesh) : mesh)) << name;
      }
  EXPECT_EQ(std::distance(fs::directory_iterator(file("")), fs::directory_iterator()), 6)
      << "no temporary is left";
}

TEST_F(MeshFiles, FilesOfOneTriangleAreAsTheFormatsSay) {
  writeMesh(file("a.stl"), kTriangle);
  const std::string stl = bytesOf(file("a.stl"));
  ASSERT_EQ(stl.size(), 134u);
  EXPECT_FALSE(stl.starts_with("solid"));
  EXPECT_EQ(stl.substr(80),
            littleEndian(1) + floats({0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0}) + std::string(2, '\0'));
  writeMesh(file("a.stl"), kTriangle, {.encoding = MeshEncoding::Ascii, .scale = 0.1});
  EXPECT_EQ(bytesOf(file("a.stl")),
            "solid restroke\n  facet normal 0 0 1\n    outer loop\n      vertex 0 0 0\n      vertex 0.1 0 0\n"
            "      vertex 0 0.1 0\n    endloop\n  endfacet\nendsolid restroke\n");
  writeMesh(file("a.ply"), kTriangle,
            {.encoding = MeshEncoding::Ascii, .unit = LengthUnit::Centimetre, .comments = {"of paper"}});
  EXPECT_EQ(
      bytesOf(file("a.ply")),
      "ply\nformat ascii 1.0\ncomment unit centimeter\ncomment of paper\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nelement face 1\nproperty list uchar uint "
      "vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  writeMesh(file("a.obj"), kTriangle);
  EXPECT_EQ(bytesOf(file("a.obj")), "# unit millimeter\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  writeMesh(file("a.amf"), kTriangle, {.unit = LengthUnit::Metre});
  EXPECT_NE(bytesOf(file("a.amf")).find("<amf unit=\"meter\""), std::string::npos);
}

TEST_F(MeshFiles, CentimetresBecomeMillimetresInAmfAndStayIn3mf) {
  TriangleMesh mesh = boxMesh({0, 0, 0}, {0.1f, 2, 3});
  writeMesh(file("a.amf"), mesh, {.unit = LengthUnit::Centimetre});
  EXPECT_NE(bytesOf(file("a.amf")).find("<amf unit=\"millimeter\""), std::string::npos);
  TriangleMesh tenfold = mesh;
  for (Point& p : tenfold.vertices) p = Point(DVec3(p) * 10.0);
  EXPECT_TRUE(readMesh(file("a.amf")) == tenfold);
  writeMesh(file("a.3mf"), mesh, {.unit = LengthUnit::Centimetre});
  EXPECT_TRUE(readMesh(file("a.3mf")) == mesh);
  const std::string bytes = bytesOf(file("a.3mf"));
  const auto members = zipMembers(bytes);
  ASSERT_EQ(members.size(), 3u);
  EXPECT_NE(unzip(bytes, members[2], kUnpackedLimit).find("unit=\"centimeter\""), std::string::npos);
}

TEST_F(MeshFiles, TheSameMeshGivesTheSameBytes) {
  for (const char* name : {"a.stl", "a.ply", "a.obj", "a.amf", "a.3mf"}) {
    writeMesh(file(name), awkward());
    const std::string first = bytesOf(file(name));
    writeMesh(file(name), awkward());
    EXPECT_TRUE(bytesOf(file(name)) == first) << name;
  }
}

TEST_F(MeshFiles, AnEmptyMeshGivesAnEmptyFileWhereTheFormatHasOne) {
  for (const char* name : {"a.stl", "a.ply", "a.obj", "a.amf"})
    for (const auto encoding : {MeshEncoding::Binary, MeshEncoding::Ascii}) {
      writeMesh(file(name), {}, {.encoding = encoding});
      EXPECT_EQ(readMesh(file(name)), TriangleMesh{}) << name;
    }
  EXPECT_THROW(writeMesh(file("a.3mf"), {}), InputError);
}

TEST_F(MeshFiles, MeshesThatCannotBeWrittenAreRefusedAndLeaveNoFile) {
  const auto refusal = [&](const char* name, const TriangleMesh& mesh, const MeshWriteOptions& options = {}) {
    try {
      writeMesh(file(name), mesh, options);
      return std::string("written");
    } catch (const InputError& error) {
      const std::string sentence = error.what();
      EXPECT_TRUE(sentence.starts_with(file(name).string() + ": ")) << sentence;
      return sentence.substr(file(name).string().size() + 2);
    }
  };
  EXPECT_EQ(refusal("a.xyz", kTriangle),
            "the ending is \".xyz\"; meshes are written as .stl, .ply, .obj, .amf or .3mf");
  EXPECT_EQ(refusal("a", kTriangle),
            "the ending is \"\"; meshes are written as .stl, .ply, .obj, .amf or .3mf");
  EXPECT_EQ(refusal("a.stl", kTriangle, {.scale = 0}), "the scale is 0; it has to be positive and finite");
  EXPECT_EQ(refusal("a.stl", kTriangle, {.scale = NAN}),
            "the scale is nan; it has to be positive and finite");
  EXPECT_EQ(refusal("a.stl", kTriangle, {.scale = 1e39}),
            "vertex 1 would be at (inf, 0, 0); only finite numbers can be stored");
  EXPECT_EQ(refusal("a.obj", kTriangle, {.comments = {"a\nb"}}),
            "a comment has a line break; a header has one comment a line");
  TriangleMesh bad = kTriangle;
  bad.triangles[0][2] = 3;
  EXPECT_EQ(refusal("a.ply", bad), "triangle 0 names vertex 3, but the mesh has 3 vertices, from 0 on");
  bad = kTriangle;
  bad.vertices[1].z = INFINITY;
  EXPECT_EQ(refusal("a.ply", bad), "vertex 1 would be at (1, 0, inf); only finite numbers can be stored");
  bad.vertices[1].z = 2e9f;
  EXPECT_EQ(refusal("a.3mf", bad), "vertex 1 has the coordinate 2e+09; 3MF files hold coordinates up to 1e9");
  bad = kTriangle;
  bad.triangles[0][2] = 0;
  EXPECT_EQ(refusal("a.3mf", bad), "triangle 0 names a vertex twice; in a 3MF file its vertices differ");
  EXPECT_TRUE(fs::is_empty(file("")));
  EXPECT_THROW(writeMesh(file("absent/a.stl"), kTriangle), InputError);
}

}  // namespace
}  // namespace restroke::points
