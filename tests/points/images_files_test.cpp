// PNG and OpenEXR: layers and camera attributes as README.md states them.

#include <ImathMatrix.h>
#include <ImathVec.h>
#include <ImfChannelList.h>
#include <ImfCompression.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>
#include <half.h>
#include <png.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "implicit/errors.h"
#include "points/images/cpu_renderer.h"
#include "points/images/exr.h"
#include "points/images/png.h"
#include "tests/points/image_support.h"

namespace restroke::points {
namespace {

namespace fs = std::filesystem;
using testing::ballSurfels;
using testing::cameraAt;

class ImageFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* const info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(::testing::TempDir()) / ("restroke_images_" + std::string(info->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] fs::path file(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] std::size_t filesInFolder() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

 private:
  fs::path folder_;
};

struct Picture {
  Camera camera;
  RenderedImage image;
};

Picture picture() {
  Camera camera = cameraAt(4, 120, 90);
  camera.position = {1, 2, 3};
  camera.view = {-1, -2, -3};
  const std::vector<Surfel> surfels = ballSurfels({{0, 0, 0}, 1}, 3000, 0);
  const std::vector<std::uint32_t> strokes = {42};
  return {camera, render({.surfels = surfels, .strokeOfPrimitive = strokes}, camera)};
}

DisplayImage readPng(const fs::path& path) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_file(&png, path.c_str())) << png.message;
  png.format = PNG_FORMAT_RGBA;
  DisplayImage image{png.width, png.height, std::vector<std::uint8_t>(PNG_IMAGE_SIZE(png))};
  EXPECT_TRUE(png_image_finish_read(&png, nullptr, image.rgba.data(), 0, nullptr)) << png.message;
  return image;
}

TEST_F(ImageFiles, PngReadsBackWithLibpngAsItWasDisplayed) {
  const Picture p = picture();
  for (const Backdrop backdrop : {Backdrop::Studio, Backdrop::Transparent}) {
    const DisplayImage display = toDisplay(p.image, {.backdrop = backdrop});
    writePng(file("a.png"), p.image, {.backdrop = backdrop});  // the second replaces the first
    const DisplayImage back = readPng(file("a.png"));
    EXPECT_EQ(back.width, 120u);
    EXPECT_EQ(back.height, 90u);
    EXPECT_EQ(back.rgba, display.rgba);
    EXPECT_EQ(display.rgba[3], backdrop == Backdrop::Studio ? 255 : 0);
    EXPECT_EQ(display.rgba[4 * (45 * 120 + 60) + 3], 255);
  }
  EXPECT_EQ(filesInFolder(), 1u);  // no temporary is left
}

TEST_F(ImageFiles, DisplayFollowsTheSrgbCurveWithinADitherStep) {
  RenderedImage image;
  image.width = 256;
  image.height = 4;
  image.rgba.resize(4 * image.pixels());
  for (std::size_t p = 0; p < image.pixels(); ++p) {
    for (std::size_t c = 0; c < 3; ++c)
      image.rgba[4 * p + c] = static_cast<float>(p % 256) / 200.0f;  // beyond 1, too
    image.rgba[4 * p + 3] = 1;
  }
  const DisplayImage display = toDisplay(image);
  for (std::size_t p = 0; p < image.pixels(); ++p) {
    const double x = std::fmin(static_cast<double>(image.rgba[4 * p]), 1.0);
    const double srgb = 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055);
    ASSERT_NEAR(display.rgba[4 * p], srgb, 1.01) << p;
  }
}

TEST_F(ImageFiles, ImagesWithoutPixelsAndUnwritablePlacesAreRefusedAndLeaveNoFile) {
  const Picture p = picture();
  EXPECT_THROW(writePng(file("a.png"), DisplayImage{}), InputError);
  EXPECT_THROW(writeExr(file("a.exr"), RenderedImage{}, p.camera), InputError);
  EXPECT_THROW(writePng(file("absent/a.png"), p.image), InputError);
  EXPECT_THROW(writeExr(file("absent/a.exr"), p.image, p.camera), InputError);
  Camera other = p.camera;
  other.width = 121;
  EXPECT_THROW(writeExr(file("a.exr"), p.image, other), InputError);
  EXPECT_EQ(filesInFolder(), 0u);
}

/// All channels of a file, as they are stored.
struct ExrContents {
  std::vector<half> rgba[4];
  std::vector<float> depth, normal[3];
  std::vector<std::uint32_t> primitive, stroke;
};

ExrContents readChannels(Imf::InputFile& in, std::size_t width, std::size_t height) {
  ExrContents out;
  Imf::FrameBuffer frame;
  const auto add = [&](const char* name, Imf::PixelType type, auto& values) {
    values.resize(width * height);
    frame.insert(name, Imf::Slice(type, reinterpret_cast<char*>(values.data()), sizeof(values[0]),
                                  sizeof(values[0]) * width));
  };
  const char* const colors[4] = {"R", "G", "B", "A"};
  const char* const normals[3] = {"N.X", "N.Y", "N.Z"};
  for (int i = 0; i < 4; ++i) add(colors[i], Imf::HALF, out.rgba[i]);
  for (int i = 0; i < 3; ++i) add(normals[i], Imf::FLOAT, out.normal[i]);
  add("Z", Imf::FLOAT, out.depth);
  add("id.primitive", Imf::UINT, out.primitive);
  add("id.stroke", Imf::UINT, out.stroke);
  in.setFrameBuffer(frame);
  in.readPixels(0, static_cast<int>(height) - 1);
  return out;
}

TEST_F(ImageFiles, ExrHasTheLayersOfTheContractBitForBit) {
  const Picture p = picture();
  writeExr(file("a.exr"), p.image, p.camera,
           {.attributes = {{"restroke:revision", "1a2b3c"}, {"restroke:log", "a.log"}}});
  EXPECT_EQ(filesInFolder(), 1u);
  Imf::InputFile in(file("a.exr").c_str());
  const Imf::Header& header = in.header();
  EXPECT_EQ(header.compression(), Imf::ZIP_COMPRESSION);
  std::vector<std::string> names;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) names.emplace_back(c.name());
  EXPECT_EQ(names, (std::vector<std::string>{"A", "B", "G", "N.X", "N.Y", "N.Z", "R", "Z", "id.primitive",
                                             "id.stroke"}));
  for (const char* name : {"Z", "N.X", "N.Y", "N.Z"}) EXPECT_EQ(header.channels()[name].type, Imf::FLOAT);
  for (const char* name : {"id.primitive", "id.stroke"}) EXPECT_EQ(header.channels()[name].type, Imf::UINT);
  EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("restroke:revision").value(), "1a2b3c");
  EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("restroke:log").value(), "a.log");

  const ExrContents contents = readChannels(in, 120, 90);
  EXPECT_EQ(contents.depth, p.image.depth);
  EXPECT_EQ(contents.primitive, p.image.primitive);
  EXPECT_EQ(contents.stroke, p.image.stroke);
  EXPECT_EQ(contents.stroke[45 * 120 + 60], 42u);
  EXPECT_EQ(contents.primitive[0], 4294967295u);
  for (std::size_t i = 0; i < p.image.pixels(); ++i) {
    for (std::size_t c = 0; c < 4; ++c)
      ASSERT_EQ(contents.rgba[c][i].bits(), half(p.image.rgba[4 * i + c]).bits());
    for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(contents.normal[c][i], p.image.normal[3 * i + c]);
  }
}

TEST_F(ImageFiles, ExrCameraTakesModelPointsToPixelsAndDepths) {
  const Picture p = picture();
  writeExr(file("a.exr"), p.image, p.camera);
  Imf::InputFile in(file("a.exr").c_str());
  ASSERT_TRUE(Imf::hasWorldToCamera(in.header()) && Imf::hasWorldToNDC(in.header()));
  const Imath::M44f toCamera = Imf::worldToCamera(in.header()), toNdc = Imf::worldToNDC(in.header());
  const CameraFrame frame = frameOf(p.camera);
  restroke::testing::Random random(5);
  for (int i = 0; i < 50; ++i) {
    const Point q = random.inCube(1);
    const Projection expected = project(frame, p.camera, DVec3(q));
    // Imath multiplies row vectors from the left, and divides by w.
    const Imath::V3f c = Imath::V3f(q.x, q.y, q.z) * toCamera, n = Imath::V3f(q.x, q.y, q.z) * toNdc;
    EXPECT_NEAR(c.z, expected.depth, 1e-5);
    EXPECT_NEAR(n.x * 120, expected.x, 1e-3);
    EXPECT_NEAR(n.y * 90, expected.y, 1e-3);
    EXPECT_NEAR(c.x, dot(DVec3(q) - frame.position, frame.right), 1e-5);
    EXPECT_NEAR(c.y, dot(DVec3(q) - frame.position, frame.up), 1e-5);
  }
  // Pixels lead back to the surface: the depth layer is distance along camera z.
  const std::size_t middle = 45 * 120 + 60;
  const Imath::V3f hit = Imath::V3f(0, 0, p.image.depth[middle]) * toCamera.inverse();
  EXPECT_NEAR(hit.length(), 1, 0.02);
}

TEST_F(ImageFiles, ExrAttributesOutOfRangeAreRefusedAndLeaveNoFile) {
  const Picture p = picture();
  EXPECT_THROW(writeExr(file("a.exr"), p.image, p.camera, {.attributes = {{"", "x"}}}), InputError);
  EXPECT_THROW(writeExr(file("a.exr"), p.image, p.camera, {.attributes = {{std::string(256, 'a'), "x"}}}),
               InputError);
  EXPECT_THROW(writeExr(file("a.exr"), p.image, p.camera, {.attributes = {{"a", "x"}, {"a", "y"}}}),
               InputError);
  EXPECT_THROW(writeExr(file("a.exr"), p.image, p.camera, {.attributes = {{"worldToNDC", "x"}}}), InputError);
  EXPECT_EQ(filesInFolder(), 0u);
}

TEST_F(ImageFiles, SamePictureSameBytes) {
  const Picture p = picture();
  const auto bytes = [](const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  writeExr(file("a.exr"), p.image, p.camera);
  writeExr(file("b.exr"), p.image, p.camera);
  writePng(file("a.png"), p.image);
  writePng(file("b.png"), p.image);
  EXPECT_EQ(bytes(file("a.exr")), bytes(file("b.exr")));
  EXPECT_EQ(bytes(file("a.png")), bytes(file("b.png")));
}

}  // namespace
}  // namespace restroke::points
