// Mesh files: what is read, and what is refused with which sentence (S13, D1).

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "implicit/errors.h"
#include "implicit/geometry/mesh_faults.h"
#include "points/files/mesh_files.h"
#include "points/files/zip.h"
#include "tests/points/mesh_file_support.h"

namespace restroke::points {
namespace {

using testing::floats;
using testing::kTriangle;
using testing::littleEndian;

/// The sentence with which contents are refused; empty when they are read.
std::string refusalOf(std::string_view contents, const std::string& name) {
  try {
    (void)parseMesh(contents, name);
    return {};
  } catch (const InputError& error) {
    return error.what();
  }
}

/// A quadrilateral as a fan.
const TriangleMesh kFan = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};

std::string binaryStl(const std::string& header, std::uint32_t count, const std::string& facets) {
  std::string bytes = header;
  bytes.resize(80, ' ');
  return bytes + littleEndian(count) + facets;
}

std::string zipped(const std::string& name, const std::string& contents) {
  return makeZip({{name, contents}});
}

std::string amf(const std::string& inside) {
  return "<?xml version=\"1.0\"?>\n<!-- made by hand -->\n<amf unit=\"millimeter\">" + inside + "</amf>";
}
std::string amfObject(const std::string& id, const std::string& lastVertex = "2") {
  return "<object id=\"" + id +
         "\"><mesh><vertices><vertex><coordinates><x>0</x><y>0</y><z>0</z></coordinates></vertex>"
         "<vertex><coordinates><x> 1 </x><y>0</y><z>0</z></coordinates></vertex>\n"
         "<vertex><coordinates><x>0</x><y>+1.0e0</y><z>-0.0</z></coordinates></vertex></vertices>"
         "<volume><triangle><v1>0</v1><v2>1</v2><v3>" +
         lastVertex + "</v3></triangle></volume></mesh></object>";
}

std::string model3mf(const std::string& resources, const std::string& build) {
  return makeZip({{"[Content_Types].xml",
                   "<?xml version=\"1.0\"?><Types "
                   "xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">"
                   "<Default Extension=\"rels\" "
                   "ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>"
                   "<Default Extension=\"model\" "
                   "ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>"},
                  {"_rels/.rels",
                   "<?xml version=\"1.0\"?><Relationships "
                   "xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">"
                   "<Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" "
                   "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>"},
                  {"3D/3dmodel.model",
                   "<?xml version=\"1.0\"?><model unit=\"inch\" xml:lang=\"en-US\" "
                   "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources>" +
                       resources + "</resources><build>" + build + "</build></model>"}});
}
std::string mesh3mf(const std::string& x, const std::string& lastVertex = "3") {
  return "<object id=\"1\" type=\"model\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"" + x +
         "\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"1\" z=\"0\"/><vertex x=\"0\" y=\"0\" "
         "z=\"1\"/></vertices><triangles>"
         "<triangle v1=\"0\" v2=\"2\" v3=\"1\"/><triangle v1=\"0\" v2=\"1\" v3=\"3\"/><triangle v1=\"0\" "
         "v2=\"3\" "
         "v3=\"2\"/><triangle v1=\"1\" v2=\"2\" v3=\"" +
         lastVertex + "\"/></triangles></mesh></object>";
}

// Reading, by hand ------------------------------------------------------------------------------------------

TEST(ReadMesh, AsciiStlMayHaveSeveralSolidsOddNormalsAndAnyLayout) {
  const std::string facet =
      "FACET NORMAL nan -nan(ind) 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\r\n vertex 0 +1.0E0 "
      "-0.0\nendloop endfacet\n";
  EXPECT_EQ(parseMesh("solid a b facet\n" + facet + "endsolid a b\n", "x.stl"), kTriangle);
  TriangleMesh twice = kTriangle;
  twice.triangles.push_back({0, 1, 2});
  EXPECT_EQ(parseMesh("\n solid\n" + facet + "endsolid\n\nsolid two\n" + facet + "endsolid", "x"), twice);
  EXPECT_EQ(parseMesh("solid nothing\nendsolid nothing\n", "x.stl"), TriangleMesh{});
  EXPECT_EQ(
      parseMesh("solid one line facet\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 "
                "endloop endfacet endsolid",
                "x.stl"),
      kTriangle);
}

TEST(ReadMesh, BinaryStlIsToldByItsSizeWhateverItsHeader) {
  const std::string facet = floats({0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, -0.0f}) + std::string(2, '\0');
  for (const char* header : {"", "solid facet normal", "ply", "OFF 1 1 1"}) {
    EXPECT_EQ(parseMesh(binaryStl(header, 1, facet), "x"), kTriangle) << header;
    EXPECT_EQ(parseMesh(binaryStl(header, 1, facet), "x.obj"), kTriangle) << header;
  }
  EXPECT_EQ(parseMesh(binaryStl("", 0, ""), "empty.STL"), TriangleMesh{});
}

TEST(ReadMesh, OffMayHaveCommentsColoursAndPolygons) {
  EXPECT_EQ(parseMesh("OFF\n3 1 3\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "x"), kTriangle);
  EXPECT_EQ(parseMesh("# first\n\nCOFF 4 1\n# second\n0 0 0 255 0 0 255\n\n1 0 0 1 1 1 1 # third\n1 1 0 0 0 "
                      "0 0\n 0 1 0 1 1 "
                      "1 1\n4 0 1 2 3 0.5 0.5 0.5",
                      "x"),
            kFan);
}

TEST(ReadMesh, ObjMayCountBackContinueLinesAndHaveEverythingElse) {
  EXPECT_EQ(parseMesh("# x\nmtllib a b.mtl\no name\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0 0.5 0.5 0.5\nv 0 1 0\nvt 0 "
                      "0\nvn 0 0 1\n"
                      "usemtl none\ns off\nf 1/1/1 2//1 3/1 4\nl 1 2\np 1\n",
                      "x.obj"),
            kFan);
  EXPECT_EQ(parseMesh("v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf -3 -2 \\\r\n -1\r\nv 5 5 5\r\n", "x").triangles,
            kTriangle.triangles);
  EXPECT_EQ(parseMesh("v 0 0\\\n 0\nv 1 0 0\nv 0 1 0\ng a \\\n b\nf 1 2 3", "x"), kTriangle);
  EXPECT_EQ(parseMesh("# nothing\n", "x.obj"), TriangleMesh{});
}

TEST(ReadMesh, PlyMayHaveAnyTypesOrdersAndExtraElements) {
  const std::string ascii =
      "ply\nformat ascii 1.0\ncomment c\nobj_info i\nelement nothing 1000\nelement face 1\nproperty uchar "
      "red\n"
      "property list uchar int vertex_indices\nproperty list int float extra\nelement vertex 4\nproperty "
      "double z\n"
      "property list uchar uchar rest\nproperty int x\nproperty float y\nend_header\n";
  EXPECT_EQ(parseMesh(ascii + "255 4 0 1 2 3 2 0.5 0.5\n0 0 0 0\n0 1 9 1 0 0 2 8 8\n1 1 0 0 0 1\n", "x"),
            kFan);
  const std::string header =
      "ply\r\nformat binary_big_endian 1.0\r\nelement vertex 3\r\nproperty double x\r\nproperty short "
      "y\r\nproperty char "
      "z\r\nelement face 1\r\nproperty list ushort uint vertex_index\r\nend_header\r\n";
  const auto vertex = [](char x, char y) {
    // A double of 0 or 1, most significant byte first, then 16 bits and 8 bits.
    return (x ? std::string("\x3f\xf0", 2) + std::string(6, '\0') : std::string(8, '\0')) +
           std::string{0, y, 0};
  };
  const std::string body =
      vertex(0, 0) + vertex(1, 0) + vertex(0, 1) + std::string("\0\3\0\0\0\0\0\0\0\1\0\0\0\2", 14);
  EXPECT_EQ(parseMesh(header + body, "x"), kTriangle);
  EXPECT_EQ(
      parseMesh(
          "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n"
          "element face 0\nproperty list uchar int vertex_indices\nend_header\n",
          "x"),
      TriangleMesh{});
}

TEST(ReadMesh, AmfMayBeZippedAndHaveAConstellation) {
  EXPECT_EQ(parseMesh(amf(amfObject("1")), "x"), kTriangle);
  EXPECT_EQ(parseMesh(zipped("a/B.AMF", amf(amfObject("1"))), "x"), kTriangle);
  // Two objects; a constellation of one of them, twice, once moved.
  EXPECT_EQ(parseMesh(amf(amfObject("1") + amfObject("2")), "x.amf").triangles.size(), 2u);
  const TriangleMesh placed = parseMesh(
      amf(amfObject("1") + amfObject("b") +
          "<constellation id=\"9\"><instance objectid=\"b\"/><instance objectid=\"b\"><deltax>1</deltax>"
          "<deltay>0</deltay><rz>0</rz></instance></constellation>"),
      "x.amf");
  TriangleMesh expected = kTriangle;
  expected.vertices.insert(expected.vertices.end(), {{2, 0, 0}, {1, 1, 0}});
  expected.triangles.push_back({1, 3, 4});
  EXPECT_EQ(placed, expected);
}

TEST(ReadMesh, ModelsOf3mfArePlacedAsTheBuildSays) {
  const TriangleMesh plain = parseMesh(model3mf(mesh3mf("1"), "<item objectid=\"1\"/>"), "x");
  EXPECT_TRUE(faultsOf(plain).none());
  EXPECT_NEAR(faultsOf(plain).volume, 1 / 6., 1e-12);
  // Twice as large along y, moved, and once more through a component; mirrored solids still face out.
  const TriangleMesh placed = parseMesh(
      model3mf(mesh3mf("1") + "<object id=\"2\" type=\"model\"><components><component objectid=\"1\" "
                              "transform=\"-1 0 0 0 1 0 0 0 1 0 0 10\"/></components></object>",
               "<item objectid=\"1\" transform=\"1 0 0 0 2 0 0 0 1 5 6 7\"/><item objectid=\"2\" "
               "transform=\"3 0 0 0 1 0 0 "
               "0 1 100 0 0\"/>"),
      "x");
  const MeshFaults f = faultsOf(placed);
  EXPECT_TRUE(f.none()) << describe(f);
  EXPECT_NEAR(f.volume, 2 / 6. + 3 / 6., 1e-5);
  EXPECT_EQ(placed.vertices[1], Point(6, 6, 7));
  EXPECT_EQ(placed.vertices[2], Point(5, 8, 7));
  EXPECT_EQ(placed.vertices[5], Point(97, 0, 10));
  // Nothing is built: all there is.
  EXPECT_EQ(parseMesh(model3mf(mesh3mf("1"), ""), "x"), plain);
}

TEST(ReadMesh, NumbersTooSmallForAnyTypeAreZero) {
  const std::string zeros(400, '0');
  const TriangleMesh mesh =
      parseMesh("OFF 3 1 0\n1e-400 0." + zeros + "1 -1e-60\n1 0 0\n0 1 0\n3 0 1 2\n", "x");
  EXPECT_EQ(mesh, kTriangle);
  for (const std::string& large : std::vector<std::string>{"1e400", "1" + zeros, "0.5e+400", "-1e60"})
    EXPECT_NE(refusalOf("v " + large + " 0 0\n", "x.obj").find("finite float32"), std::string::npos) << large;
}

TEST(ReadMesh, EqualPositionsBecomeOneVertexAndUnusedOnesStay) {
  const TriangleMesh mesh =
      parseMesh("OFF 6 2 0\n0 0 0\n1 0 0\n0 1 0\n7 7 7\n-0 0 0\n1.0 -0.0 0e5\n3 0 1 2\n3 4 2 5\n", "x");
  EXPECT_EQ(mesh.vertices, (std::vector<Point>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {7, 7, 7}}));
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 1}}));
  EXPECT_FALSE(std::signbit(mesh.vertices[0].x));
}

TEST(ReadMesh, NumbersAreRoundedOnceToTheNearestFloat) {
  const TriangleMesh mesh = parseMesh(
      "OFF 4 1 0\n0.08156099999999999 1.00000005960464477539063 1.00000005960464477539062\n16777217 16777219 "
      "1e-46\n"
      "1e-45 3.4028235e38 .5\n0 0 0\n3 0 1 2\n",
      "x");
  EXPECT_EQ(mesh.vertices[0], Point(0.08156099999999999f, 1.00000011920928955078125f, 1.0f));
  EXPECT_EQ(mesh.vertices[1], Point(16777216.0f, 16777220.0f, 0.0f));
  EXPECT_EQ(mesh.vertices[2],
            Point(std::numeric_limits<float>::denorm_min(), std::numeric_limits<float>::max(), 0.5f));
}

// Refusing --------------------------------------------------------------------------------------------------

struct Refusal {
  const char* name;
  std::string contents;
  const char* sentence;  ///< all of it
};

TEST(ReadMesh, MalformedFilesAreRefusedWithTheFileThePlaceAndTheRule) {
  const std::string facet = floats({0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0}) + std::string(2, '\0');
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string plyFaces = ply + "element face 1\nproperty list char int vertex_indices\nend_header\n";
  const std::string plyBinary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
      "float z\n"
      "element face 1\nproperty list uint int vertex_indices\nend_header\n";
  const std::vector<Refusal> refusals = {
      {"a.stl", "", "a.stl: the file is empty; a mesh file has at least a header"},
      {"a", "hello", "a: not a mesh file that is known here (STL, PLY, OBJ, OFF, 3MF, AMF)"},
      {"a.off", "hello",
       "a.off: line 1: the file does not begin with OFF, COFF or the like, as an OFF file does"},
      {"a.ply", "hello", "a.ply: line 1: the file does not begin with \"ply\", as a PLY file does"},
      {"a.amf", "hello", "a.amf: neither XML with an <amf> element nor a zip archive"},
      {"a.3mf", "hello", "a.3mf: not a zip archive, as a 3MF file is"},
      {"a.obj", "v 0 0 0\nhello\n", "a.obj: line 2: the line begins with a word that OBJ files do not have"},
      // STL
      {"a.stl", "hello", "a.stl: byte 5: the file ends; a binary STL file has 84 bytes before its triangles"},
      {"a.stl", binaryStl("x", 4000000000u, facet),
       "a.stl: byte 80: the count is 4000000000, for which a binary STL file has 200000000084 bytes, not "
       "134"},
      {"a.stl", binaryStl("solid", 2, facet),
       "a.stl: byte 80: the count is 2, for which a binary STL file has 184 bytes, not 134"},
      {"a.stl", binaryStl("x", 1, floats({0, 0, 1, 0, 0, 0, 1, NAN, 0, 0, 1, 0}) + "  "),
       "a.stl: byte 112 (triangle 0): the coordinate is nan; coordinates are finite numbers"},
      {"a.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n",
       "a.stl: line 6: \"vertex\" is expected here, in an ascii STL file"},
      {"a.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 inf",
       "a.stl: line 4: the coordinate is \"inf\"; coordinates are finite float32 numbers"},
      {"a.stl", "solid x\n", "a.stl: line 1: the file ends inside a solid; \"endsolid\" closes it"},
      {"a.stl", "solid x\nendsolid x\nhello",
       "a.stl: line 3: \"solid\" is expected here, which begins an ascii STL file"},
      {"a.stl", "solid x\nfacet 1 2 3 4 5 6",
       "a.stl: line 2: \"outer\" is expected here, after a facet's normal, in an ascii STL file"},
      // OFF
      {"a.off", "4OFF 1 1 1",
       "a.off: line 1: the file begins with 4OFF; OFF files are read in three dimensions only"},
      {"a.off", "OFF BINARY\n", "a.off: line 1: this is a binary OFF file; ascii ones are read only"},
      {"a.off", "OFF\n-1 0 0\n",
       "a.off: line 2: the number of vertices is -1, but the file has room for 0 to 2"},
      {"a.off", "OFF\n3 9999999999999 0\n",
       "a.off: line 2: the number of faces is 9999999999999, but the file has room for 0 to 4"},
      {"a.off", "OFF\n3 99999999999999999999 0\n",
       "a.off: line 2: the number of faces is \"99999999999999999999\"; it has to be an integer"},
      {"a.off", "OFF", "a.off: line 1: the number of vertices is missing"},
      {"a.off", "OFF 3 1 0\n0 0 0\n1 0 0\n", "a.off: line 3: the file ends after 2 of its 3 vertices"},
      {"a.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1\n",
       "a.off: line 4: a coordinate is missing; a vertex has three"},
      {"a.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 1e39\n",
       "a.off: line 4: the coordinate is \"1e39\"; coordinates are finite float32 numbers"},
      {"a.off", "OFF 3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
       "a.off: line 5: the file ends after 1 of its 2 faces"},
      {"a.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n",
       "a.off: line 5: a face has 2 corners; it needs three or more"},
      {"a.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
       "a.off: line 5: a face names vertex 3, but there are 3, from 0 on"},
      {"a.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", "a.off: line 5: a face's vertex is missing"},
      {"a.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n999999999999 0 1 2\n",
       "a.off: line 5: a face's vertex is missing"},
      // OBJ
      {"a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n",
       "a.obj: line 3: a face names vertex 3, but 2 have been listed, from 1 on"},
      {"a.obj", "v 0 0 0\nf 1 1 0\n",
       "a.obj: line 2: a face names vertex 0, but 1 have been listed, from 1 on"},
      {"a.obj", "v 0 0 0\nf -2 1 1\n",
       "a.obj: line 2: a face names vertex -2, but 1 have been listed, from 1 on"},
      {"a.obj", "v 0 0 0\nf 1 1\n", "a.obj: line 2: a face has 2 corners; it needs three or more"},
      {"a.obj", "v 0 0 0\nf 1 1 x\n", "a.obj: line 2: a face's vertex is \"x\"; it has to be an integer"},
      {"a.obj", "v 0 nan 0\n",
       "a.obj: line 1: the coordinate is \"nan\"; coordinates are finite float32 numbers"},
      {"a.obj", "v 0 0 0\n",
       "a.obj: line 1: the file ends without a face (f); a mesh is needed, not points or curves"},
      // PLY
      {"a", "ply\n", "a: line 1: the file ends inside the header; \"end_header\" closes it"},
      {"a", "plywood\n", "a: line 1: the first line is not \"ply\", as in a PLY file"},
      {"a", "ply\nformat utf8 1.0\n",
       "a: line 2: the format is none of: ascii, binary_little_endian, binary_big_endian"},
      {"a", "ply\nformat ascii 2.0\n",
       "a: line 2: the format's version is not 1.0, the only one that is known"},
      {"a", "ply\nend_header\n", "a: line 2: the header ends without a format line"},
      {"a", "ply\nproperty float x\n", "a: line 2: a property stands before any element"},
      {"a", "ply\nelement vertex 99999999999\nproperty char x\n",
       "a: line 3: there are 99999999999 elements of this property, but the file has room for 0 to 47"},
      {"a", "ply\nelement vertex -1\n", "a: line 2: the number of elements is -1; it cannot be negative"},
      {"a", "ply\nelement vertex 1\nproperty real x\n", "a: line 3: a property's type is none that PLY has"},
      {"a", "ply\nelement vertex 1\nproperty list float int x\n",
       "a: line 3: a list's length is of a type that is not integer"},
      {"a", "ply\nhello\n",
       "a: line 2: the line begins with none of: format, comment, obj_info, element, property, end_header"},
      {"a", ply + "end_header\n0 0 0\n1 0 0\n0 1 0\n",
       "a: line 10: the file has no element \"face\"; a mesh is needed, not a point cloud"},
      {"a", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n",
       "a: line 5: the element \"vertex\" has no property y"},
      {"a",
       ply + "element face 1\nproperty list char float vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n",
       "a: line 12: the element \"face\" has no list of integers named vertex_indices or vertex_index"},
      {"a", plyFaces + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
       "a: line 13: face 0 names vertex 3, but there are 3, from 0 on"},
      {"a", plyFaces + "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n",
       "a: line 13: face 0 names vertex -1, but there are 3, from 0 on"},
      {"a", plyFaces + "0 0 0\n1 0 0\n0 1 0\n2 0 1\n",
       "a: line 13: a face has 2 corners; it needs three or more"},
      {"a", plyFaces + "0 0 0\n1 0 0\n0 1 0\n-4 0 1\n",
       "a: line 13: the length of a list is -4; it cannot be negative"},
      {"a", plyFaces + "0 0 0\n1 0 0\n0 1 -inf\n",
       "a: line 12: the coordinate is \"-inf\"; coordinates are finite float32 numbers"},
      {"a", plyFaces + "0 0 0\n1 0 0\n0 1 0\n3 0 1", "a: line 13: a value is missing"},
      {"a", plyBinary + floats({0, 0, 0, 1, 0, 0, 0, 1}),
       "a: byte 200: the file ends before its last element"},
      {"a", plyBinary + floats({0, 0, 0, 1, 0, INFINITY}) + "   ",
       "a: byte 192: the coordinate is inf; coordinates are finite float32 numbers"},
      {"a", plyBinary + floats({0, 0, 0, 1, 0, 0, 0, 1, 0}) + littleEndian(4000000000u) + littleEndian(0),
       "a: byte 212: the file ends before its last element"},
      // AMF
      {"a.amf", amf("<object>"), "a.amf: line 3: the XML is malformed: start-end tags mismatch"},
      {"a.amf", "<amfx/>", "a.amf: the root of the XML is not <amf>, as in an AMF file"},
      {"a.amf", amf(amfObject("1", "3")),
       "a.amf: line 4: <v3> of a triangle is \"3\"; it has to be one of the mesh's 3 vertices, numbered from "
       "0 on"},
      {"a.amf", amf(amfObject("1", "")),
       "a.amf: line 4: <v3> of a triangle is \"\"; it has to be one of the mesh's 3 vertices, numbered from "
       "0 on"},
      {"a.amf", amf("<object><mesh><vertices><vertex/></vertices></mesh></object>"),
       "a.amf: line 3: a <vertex> has no <coordinates>"},
      {"a.amf",
       amf("<object><mesh><vertices><vertex><coordinates><x>NaN</x></coordinates></vertex></vertices></"
           "mesh></object>"),
       "a.amf: line 3: <x> of a vertex is \"NaN\"; it has to be a finite float32 number"},
      {"a.amf", amf(amfObject("1") + "<constellation><instance objectid=\"2\"/></constellation>"),
       "a.amf: line 4: an instance names object \"2\", which is not in the file (nested constellations are "
       "not read)"},
      {"a.amf",
       amf(amfObject("1") + "<constellation><instance objectid=\"1\"><ry>90</ry></instance></constellation>"),
       "a.amf: line 4: an instance is turned (<ry>); only instances that are moved are read"},
      {"a.amf",
       amf("<object><mesh><vertices><vertex><coordinates><x>1\n2</x></coordinates></vertex></vertices></"
           "mesh></object>"),
       "a.amf: line 3: <x> of a vertex is \"1?2\"; it has to be a finite float32 number"},
      // Zip archives
      {"a.zip", zipped("readme.txt", "hello"),
       "a.zip: a zip archive without a 3MF model and without a member that ends in .amf"},
      {"a.amf", zipped("a.amf", amf("")).substr(0, 100),
       "a.amf: a zip archive without its directory at the end; is the file complete?"},
      // 3MF
      {"a.3mf", zipped("3D/3dmodel.model", "<model/>"), nullptr},
      {"a.3mf", model3mf(mesh3mf("1", "4"), "<item objectid=\"1\"/>"), nullptr},
      {"a.3mf", model3mf(mesh3mf("1", "1"), "<item objectid=\"1\"/>"), nullptr},
      {"a.3mf", model3mf(mesh3mf("nan"), "<item objectid=\"1\"/>"), nullptr},
      {"a.3mf", model3mf(mesh3mf("1e30"), "<item objectid=\"1\"/>"), nullptr},
      {"a.3mf", model3mf(mesh3mf("1"), "<item objectid=\"7\"/>"), nullptr},
      {"a.3mf", model3mf(mesh3mf("1"), "<item objectid=\"1\" transform=\"1 0 0\"/>"), nullptr},
  };
  for (const Refusal& r : refusals) {
    const std::string sentence = refusalOf(r.contents, r.name);
    if (r.sentence != nullptr) {
      EXPECT_EQ(sentence, r.sentence);
    } else {
      EXPECT_TRUE(sentence.starts_with("a.3mf: lib3mf ")) << '"' << sentence << '"';
      EXPECT_EQ(sentence.find('\n'), std::string::npos);
    }
  }
}

TEST(ReadMesh, DamagedZipMembersAreRefused) {
  const std::string good = zipped("a.amf", amf(amfObject("1")));
  ASSERT_EQ(refusalOf(good, "a.amf"), "");
  const std::size_t data = good.find("a.amf") + 5;
  std::string bad = good;
  bad[data + 3] = static_cast<char>(bad[data + 3] ^ 0x55);
  EXPECT_TRUE(refusalOf(bad, "a.amf").starts_with("a.amf: the zip member a.amf is damaged"))
      << refusalOf(bad, "a.amf");
  const std::size_t entry = good.rfind("PK\1\2");
  bad = good;
  bad[entry + 8] = 1;
  EXPECT_EQ(refusalOf(bad, "a.amf"), "a.amf: the zip member a.amf is encrypted; that is not read");
  bad = good;
  bad[entry + 10] = 12;
  EXPECT_EQ(refusalOf(bad, "a.amf"),
            "a.amf: the zip member a.amf is packed in a way that is neither stored nor deflated");
  bad = good;
  bad[entry + 42] = 1;
  EXPECT_EQ(refusalOf(bad, "a.amf"), "a.amf: the zip member a.amf does not begin where the directory says");
  bad = good;
  bad.replace(entry + 20, 4, "\xff\xff\xff\x7f", 4);
  EXPECT_EQ(refusalOf(bad, "a.amf"), "a.amf: the zip member a.amf leaves the file");
  bad = good;
  bad.replace(entry + 24, 4, "\xff\xff\xff\xff", 4);
  EXPECT_EQ(refusalOf(bad, "a.amf"),
            "a.amf: the zip member a.amf is of the zip64 kind (4 GB or more); that is not read");
  // A bomb: the limit ends it.
  const std::string bomb = zipped("a.amf", std::string(1 << 20, ' '));
  const auto members = zipMembers(bomb);
  ASSERT_EQ(members.size(), 1u);
  EXPECT_LT(bomb.size(), 2000u);
  EXPECT_EQ(unzip(bomb, members[0], 1 << 20).size(), 1u << 20);
  EXPECT_THROW((void)unzip(bomb, members[0], (1 << 20) - 1), InputError);
}

}  // namespace
}  // namespace restroke::points
