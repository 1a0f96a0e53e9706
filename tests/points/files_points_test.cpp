// PLY and XYZ export with normals.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "implicit/errors.h"
#include "points/files/point_files.h"
#include "tests/points/image_support.h"

namespace restroke::points {
namespace {

namespace fs = std::filesystem;

class PointFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* const info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(::testing::TempDir()) / ("restroke_points_" + std::string(info->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] fs::path file(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] bool folderIsEmpty() const { return fs::is_empty(folder_); }

 private:
  fs::path folder_;
};

std::string bytesOf(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

std::vector<float> valuesOf(const std::vector<Surfel>& surfels, bool withRadius) {
  std::vector<float> values;
  for (const Surfel& s : surfels) {
    values.insert(values.end(),
                  {s.position.x, s.position.y, s.position.z, s.normal.x, s.normal.y, s.normal.z});
    if (withRadius) values.push_back(s.radius);
  }
  return values;
}

/// Numbers of a text, read by the C library, which rounds correctly.
std::vector<float> numbersIn(const std::string& text) {
  std::vector<float> numbers;
  const char* at = text.c_str();
  char* end = nullptr;
  for (float value = std::strtof(at, &end); end != at; value = std::strtof(at, &end)) {
    numbers.push_back(value);
    at = end;
  }
  return numbers;
}

std::vector<Surfel> surfels() {
  std::vector<Surfel> s = testing::ballSurfels({{0.1f, -20.3f, 1e-7f}, 0.7f}, 300);
  s.push_back({{1e6f, -0.0f, 1.17549435e-38f}, {0, 0, 1}, 3.4e-5f});
  return s;
}

const char* const kProperties =
    "property float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty "
    "float nz\n"
    "property float radius\nend_header\n";

TEST_F(PointFiles, BinaryPlyHoldsEveryNumberBitForBit) {
  writePly(file("a.ply"), surfels(), {.comments = {"unit mm"}});
  const std::string bytes = bytesOf(file("a.ply"));
  const std::string header =
      std::string("ply\nformat binary_little_endian 1.0\ncomment unit mm\nelement vertex 301\n") +
      kProperties;
  ASSERT_EQ(bytes.substr(0, header.size()), header);
  const std::vector<float> expected = valuesOf(surfels(), true);
  ASSERT_EQ(bytes.size(), header.size() + 4 * expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    std::uint32_t bits = 0;
    for (std::size_t b = 0; b < 4; ++b)
      bits |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[header.size() + 4 * i + b]))
              << (8 * b);
    std::uint32_t expectedBits = 0;
    std::memcpy(&expectedBits, &expected[i], 4);
    ASSERT_EQ(bits, expectedBits) << i;
  }
}

TEST_F(PointFiles, AsciiPlyAndXyzReadBackAsTheSameNumbers) {
  writePly(file("a.ply"), surfels(), {.format = PlyFormat::Ascii});
  const std::string header = std::string("ply\nformat ascii 1.0\nelement vertex 301\n") + kProperties;
  const std::string ply = bytesOf(file("a.ply"));
  ASSERT_EQ(ply.substr(0, header.size()), header);
  EXPECT_EQ(numbersIn(ply.substr(header.size())), valuesOf(surfels(), true));

  writeXyz(file("a.xyz"), surfels());
  const std::string xyz = bytesOf(file("a.xyz"));
  EXPECT_EQ(numbersIn(xyz), valuesOf(surfels(), false));
  EXPECT_EQ(std::count(xyz.begin(), xyz.end(), '\n'), 301);
  EXPECT_EQ(xyz.find('\t'), std::string::npos);
}

TEST_F(PointFiles, NoSurfelsGiveValidEmptyFiles) {
  writePly(file("a.ply"), {});
  EXPECT_EQ(bytesOf(file("a.ply")),
            std::string("ply\nformat binary_little_endian 1.0\nelement vertex 0\n") + kProperties);
  writeXyz(file("a.xyz"), {});
  EXPECT_EQ(bytesOf(file("a.xyz")), "");
}

TEST_F(PointFiles, NumbersThatAreNotFiniteAreRefusedAndLeaveNoFile) {
  std::vector<Surfel> bad = surfels();
  bad[17].normal.y = std::numeric_limits<float>::quiet_NaN();
  try {
    writePly(file("a.ply"), bad);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("point 17"), std::string::npos) << error.what();
  }
  EXPECT_THROW(writeXyz(file("a.xyz"), bad), InputError);
  EXPECT_THROW(writePly(file("a.ply"), surfels(), {.comments = {"two\nlines"}}), InputError);
  EXPECT_THROW(writePly(file("absent/a.ply"), surfels()), InputError);
  EXPECT_TRUE(folderIsEmpty());
}

}  // namespace
}  // namespace restroke::points
