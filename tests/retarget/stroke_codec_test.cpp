#include "retarget/stroke_codec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "implicit/errors.h"
#include "tests/retarget/test_strokes.h"

namespace restroke::retarget {
namespace {

using Points = std::vector<StrokePoint>;
using Bytes = std::vector<std::uint8_t>;

Bytes packed(const Points& points, PackedChannels channels = {}) {
  Bytes bytes;
  encodePoints(points, bytes, channels);
  return bytes;
}

Points unpacked(const Bytes& bytes) {
  std::span<const std::uint8_t> in(bytes);
  Points points = decodePoints(in);
  EXPECT_TRUE(in.empty());
  return points;
}

void expectRoundTrip(const Points& points) {
  EXPECT_EQ(unpacked(packed(points)), points);
}

Points randomPoints(std::mt19937_64& random, std::size_t count) {
  // A walk whose steps have a scale of their own in every stroke, with some wild jumps.
  const std::int64_t scale = std::int64_t{1} << uniform(random, 0, 22);
  const std::int64_t pause = std::int64_t{1} << uniform(random, 0, 12);
  const auto clampScreen = [](std::int64_t v) {
    return static_cast<std::int32_t>(
        std::min<std::int64_t>(std::max<std::int64_t>(v, -kMaxScreen), kMaxScreen));
  };
  Points points;
  StrokePoint p{{static_cast<std::int32_t>(uniform(random, -kMaxScreen, kMaxScreen)), 0}, 0, 0};
  for (std::size_t i = 0; i < count; ++i) {
    points.push_back(p);
    p.screen = {clampScreen(p.screen.x + uniform(random, -scale, scale)),
                clampScreen(p.screen.y + uniform(random, 0, scale))};
    if (uniform(random, 0, 40) == 0)
      p.screen.y = static_cast<std::int32_t>(uniform(random, -kMaxScreen, kMaxScreen));
    p.time = static_cast<std::uint32_t>(std::min<std::int64_t>(p.time + uniform(random, 0, pause), kMaxTime));
    p.pressure = static_cast<std::uint16_t>(uniform(random, 0, kMaxPressure));
  }
  return points;
}

TEST(StrokeCodec, OneStrokeComesBackEqual) {
  expectRoundTrip({{{100, 200}, 0, 10}, {{110, 190}, 8, 20}, {{125, 185}, 16, 25}, {{125, 185}, 300, 25}});
}

TEST(StrokeCodec, NoPointsTakeOneByte) {
  EXPECT_EQ(packed({}).size(), 1u);
  expectRoundTrip({});
}

TEST(StrokeCodec, OneAndTwoPointsComeBackEqual) {
  expectRoundTrip({{{-5, 7}, 0, 512}});
  expectRoundTrip({{{-5, 7}, 0, 512}, {{-5, 7}, 0, 512}});
  expectRoundTrip({{{-5, 7}, 0, 512}, {{kMaxScreen, -kMaxScreen}, kMaxTime, 0}});
}

TEST(StrokeCodec, ExtremesThatAlternateComeBackEqual) {
  Points points;
  for (int i = 0; i < 100; ++i) {
    const int side = i % 2 == 0 ? 1 : -1;
    points.push_back({{side * kMaxScreen, -side * kMaxScreen},
                      i % 2 == 0 ? kMaxTime : 0,  // times that fall are packed all the same
                      static_cast<std::uint16_t>(i % 2 == 0 ? kMaxPressure : 0)});
  }
  expectRoundTrip(points);
}

TEST(StrokeCodec, RandomStrokesComeBackEqual) {
  const std::uint64_t seed = 20240611;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  for (int i = 0; i < 2000; ++i)
    expectRoundTrip(randomPoints(random, static_cast<std::size_t>(uniform(random, 0, 60))));
}

TEST(StrokeCodec, ChannelsLeftOutComeBackAsDefaults) {
  const Points points{{{1, 2}, 0, 3}, {{4, 5}, 6, 7}, {{9, 9}, 10, 700}};
  Points expected = points;
  for (StrokePoint& p : expected) p.time = 0;
  EXPECT_EQ(unpacked(packed(points, {.time = false})), expected);
  for (StrokePoint& p : expected) p.pressure = kMaxPressure;
  EXPECT_EQ(unpacked(packed(points, {.time = false, .pressure = false})), expected);
  expected = points;
  for (StrokePoint& p : expected) p.pressure = kMaxPressure;
  EXPECT_EQ(unpacked(packed(points, {.pressure = false})), expected);
}

TEST(StrokeCodec, StrokesFollowOneAnotherInOneBuffer) {
  std::mt19937_64 random(5);
  std::vector<Points> strokes;
  Bytes bytes;
  for (std::size_t i = 0; i < 20; ++i) encodePoints(strokes.emplace_back(randomPoints(random, i)), bytes);
  std::span<const std::uint8_t> in(bytes);
  for (const Points& points : strokes) EXPECT_EQ(decodePoints(in), points);
  EXPECT_TRUE(in.empty());
}

TEST(StrokeCodec, SamePointsGiveTheBytesOfTheFormat) {
  // Pins the format: logs hold these bytes.
  const Points points{
      {{100, 200}, 0, 512}, {{103, 198}, 8, 512}, {{107, 195}, 16, 512}, {{112, 191}, 24, 512}};
  const Bytes expected{0x0f, 0x44, 0x90, 0x15, 0x4e, 0x92, 0x40, 0x16,
                       0xb8, 0x02, 0x50, 0xc0, 0x05, 0x80, 0x00, 0x00};
  EXPECT_EQ(packed(points), expected);
  EXPECT_EQ(unpacked(expected), points);
}

TEST(StrokeCodec, ConstantTimeStepAndPressureCostNothingAPoint) {
  std::mt19937_64 random(9);
  Points points = randomPoints(random, 1000);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].time = static_cast<std::uint32_t>(8 * i);
    points[i].pressure = 512;
  }
  EXPECT_LE(packed(points).size(), packed(points, {.time = false, .pressure = false}).size() + 8);
}

TEST(StrokeCodec, AMillionPointsComeBackEqual) {
  std::mt19937_64 random(11);
  Points points = randomPoints(random, 1'000'000);
  expectRoundTrip(points);
  for (StrokePoint& p : points) p = {};
  const Bytes still = packed(points);
  EXPECT_LE(still.size(), 125'100u);  // a pen that rests costs one bit an event
  EXPECT_EQ(unpacked(still), points);
}

TEST(StrokeCodec, ValuesOutOfRangeAreRejectedAndLeaveTheBytesAlone) {
  Bytes bytes{1, 2, 3};
  const auto rejected = [&](StrokePoint p) {
    const Points points{{}, p};
    EXPECT_THROW(encodePoints(points, bytes), InputError);
    EXPECT_EQ(bytes, (Bytes{1, 2, 3}));
  };
  rejected({{kMaxScreen + 1, 0}, 0, 0});
  rejected({{0, -kMaxScreen - 1}, 0, 0});
  rejected({{0, 0}, kMaxTime + 1, 0});
  rejected({{0, 0}, 0, kMaxPressure + 1});
}

TEST(StrokeCodec, EveryTruncationIsRejected) {
  std::mt19937_64 random(3);
  for (std::size_t count = 0; count < 40; ++count) {
    const Bytes bytes = packed(randomPoints(random, count));
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      std::span<const std::uint8_t> in(bytes.data(), length);
      EXPECT_THROW(static_cast<void>(decodePoints(in)), InputError)
          << count << " points, " << length << " bytes";
      EXPECT_EQ(in.size(), length) << "a failed call must not move the span";
    }
  }
}

TEST(StrokeCodec, ACountBeyondTheBytesIsRejectedBeforeMemoryIsTaken) {
  // Flags 3, width 31, count 2^31 - 1: 16 bytes a point would be 32 GB.
  Bytes bytes{0x7f, 0xff, 0xff, 0xff, 0x7f};
  bytes.resize(64);
  std::span<const std::uint8_t> in(bytes);
  try {
    static_cast<void>(decodePoints(in));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("points are announced"), std::string::npos) << error.what();
  }
}

TEST(StrokeCodec, HostileBytesGivePointsInRangeOrAnInputError) {
  const std::uint64_t seed = 77;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  std::size_t accepted = 0, rejected = 0;
  const auto tryBytes = [&](const Bytes& bytes) {
    std::span<const std::uint8_t> in(bytes);
    try {
      const Points points = decodePoints(in);
      ++accepted;
      ASSERT_LE(points.size(), 8 * bytes.size());
      expectRoundTrip(points);  // throws when a value is out of range
    } catch (const InputError&) {
      ++rejected;
    }
  };
  for (int i = 0; i < 20'000; ++i) {
    Bytes bytes(static_cast<std::size_t>(uniform(random, 0, 48)));
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    tryBytes(bytes);
  }
  for (int i = 0; i < 20'000; ++i) {
    Bytes bytes = packed(randomPoints(random, static_cast<std::size_t>(uniform(random, 1, 30))));
    for (std::int64_t flips = uniform(random, 1, 3); flips > 0; --flips)
      bytes[static_cast<std::size_t>(uniform(random, 0, std::ssize(bytes) - 1))] ^=
          static_cast<std::uint8_t>(1 << uniform(random, 0, 7));
    tryBytes(bytes);
  }
  EXPECT_GT(accepted, 1000u);
  EXPECT_GT(rejected, 1000u);
}

TEST(StrokeCodec, PrintsBytesPerPointOfEverySharedFile) {
  const auto folder = sharedStrokesFolder();
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "no shared stroke files in " << folder;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  ASSERT_FALSE(files.empty());
  for (const auto& file : files) {
    std::size_t points = 0, all = 0, screen = 0, strokes = 0;
    for (const Points& stroke : readStrokeFile(file)) {
      expectRoundTrip(stroke);
      ++strokes;
      points += stroke.size();
      all += packed(stroke).size();
      screen += packed(stroke, {.time = false, .pressure = false}).size();
    }
    const auto n = static_cast<double>(points), s = static_cast<double>(strokes);
    std::printf("%-36s %3zu strokes %5zu points: %.3f bytes a point, %.3f without time and pressure\n",
                file.filename().c_str(), strokes, points, static_cast<double>(all) / n,
                static_cast<double>(screen) / n);
    // The budget: 64 + 4 n and 48 + 2.5 n bytes a stroke, header and camera counted. The history keeps 32
    // bytes and a quarter of the points' bytes for itself.
    EXPECT_LE(static_cast<double>(all), 32 * s + 3.0 * n);
    EXPECT_LE(static_cast<double>(screen), 16 * s + 2.0 * n);
  }
}

}  // namespace
}  // namespace restroke::retarget
