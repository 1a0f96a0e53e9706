// `.tridexel` files: bit for bit there and back, and nothing else is read.

#include "points/dexel/tridexel_file.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <xxhash.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <string>

#include "implicit/errors.h"
#include "implicit/shapes/kinds.h"
#include "tests/points/tridexel_file_support.h"
#include "tests/points/tridexel_version1.h"

namespace restroke::points {
namespace {

using namespace testing;

TEST(TriDexelFile, R10ModelsOfAllKindsOfVolumeComeBackBitForBit) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const TriDexelDocument document = randomDocument(seed, 60, 24);
    expectSame(parseTriDexel(formatTriDexel(document, "x"), "x"), document);
  }
}

TEST(TriDexelFile, R10WhatWasReadCanBeRefinedByDoingTheOperationsAgain) {
  const TriDexelDocument document = parseTriDexel(formatTriDexel(randomDocument(4, 50, 20), "x"), "x");
  TriDexel fine(dexelGridFor(document.model.bounds(), {.cell = document.model.grid().cell() / 2}));
  TriDexel same(document.model.grid());
  for (TriDexel* model : {&fine, &same}) {
    model->apply(std::get<std::vector<Primitive>>(document.initial), OperationId::Initial);
    for (std::uint32_t i = 0; i + 1 < document.operations.size(); ++i) {
      const auto& operation = document.operations[i];
      const Primitive primitive{std::get<Shape>(operation.tool), operation.operation == DexelOperation::Union
                                                                     ? Sign::Positive
                                                                     : Sign::Negative};
      model->apply({&primitive, 1}, static_cast<OperationId>(i + 1));
    }
  }
  EXPECT_EQ(same, document.model);
  EXPECT_NEAR(fine.volume(), document.model.volume(), 0.05 * fine.volume());
}

TEST(TriDexelFile, R10AnInitialMeshOrNothingAndModelsWithoutOperationsAreKept) {
  TriDexelDocument document = smallDocument();
  document.initial = tetrahedron();
  expectSame(parseTriDexel(formatTriDexel(document, "x"), "x"), document);
  document.initial = std::monostate();
  document.operations.clear();
  document.tools.clear();
  TriDexel plain(document.model.grid(), {.operations = false});
  LineEnds ends;
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t line = 0; line < plain.family(axis).lineCount(); ++line) {
      document.model.family(axis).read(line, ends);
      for (SpanEnd& end : ends) end.inner = end.outer = OperationId::None;
      plain.family(axis).write(line, ends);
    }
  document.model = plain;
  expectSame(parseTriDexel(formatTriDexel(document, "x"), "x"), document);
  document.model = TriDexel();
  expectSame(parseTriDexel(formatTriDexel(document, "x"), "x"), document);
}

TEST(TriDexelFile, R10FilesOfTheFirstVersionAreReadAndStillWritten) {
  const struct {
    std::string_view file;
    std::uint64_t hash;
    std::size_t operations;
  } kept[] = {{kToolsOfVersion1, 0x41e6637e94513a34, 3}, {kKindsOfVersion1, 0x820b4a3fbf2d6814, 22}};
  for (const auto& [file, hash, operations] : kept) {
    const std::string contents = bytesOf(file);
    ASSERT_EQ(contents[8], 1);
    const TriDexelDocument document = parseTriDexel(contents, "x");
    EXPECT_EQ(document.model.stateHash(), hash);
    EXPECT_EQ(document.operations.size(), operations);
    EXPECT_FALSE(document.model.keepsHistory());
    const std::string again = formatTriDexel(document, "x");
    EXPECT_EQ(again[8], 1);
    // The frame may be packed otherwise by another zstd.
    EXPECT_EQ(unpackedFile(again).body, unpackedFile(contents).body);
  }
}

TEST(TriDexelFile, EveryDepthAndEveryNormalComesBack) {
  TriDexelDocument document;
  Box box;
  box.add({{-1, -1, -1}, {1, 1, 1}});
  document.model = TriDexel(dexelGridFor(box, {.resolution = 9}));
  Random random(3);
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t line = 0; line < document.model.family(axis).lineCount(); ++line) {
      LineEnds ends;
      float depth = random.below(4) == 0 ? -3e38f : random.between(-2, 0);
      for (std::size_t k = 2 * random.below(4); k > 0; --k) {
        const Vec3 n = random.inCube(1) + Vec3(0, 0, 1e-3f);
        ends.push_back({depth, packNormal(n) | static_cast<PackedNormal>(random.below(4)) << 30});
        depth = random.below(5) == 0 && depth < -0.0f
                    ? -0.0f
                    : std::nextafter(depth + random.between(0, 1e-3f), 1e30f);
      }
      document.model.family(axis).write(line, ends);
    }
  expectSame(parseTriDexel(formatTriDexel(document, "x"), "x"), document);
}

TEST(TriDexelFile, VolumesThatWereSharedAreSharedAgainAndWrittenOnce) {
  const auto volume = implicit::boxKind().make(implicit::boxKind().examples()[0]);
  std::vector<Primitive> primitives;
  for (int i = 0; i < 5; ++i) {
    implicit::Pose pose;
    pose.position = {0.1f * static_cast<float>(i), 0, 0};
    primitives.push_back({std::make_shared<const implicit::PosedVolume>(volume, pose), Sign::Positive});
  }
  const TriDexelDocument read = parseTriDexel(formatTriDexel(documentOf(primitives, 8), "x"), "x");
  const auto volumeOf = [&](std::size_t i) {
    return std::get<Shape>(read.operations[i].tool).volume()->sharedVolume();
  };
  EXPECT_EQ(volumeOf(0), volumeOf(3));
}

TEST(TriDexelFile, AFileIsWrittenBesideAndRenamedAndReadAgain) {
  const auto path = std::filesystem::temp_directory_path() / fmt::format("restroke_{}.tridexel", ::getpid());
  const TriDexelDocument document = randomDocument(5, 20, 16);
  writeTriDexel(path, document);
  expectSame(readTriDexel(path), document);
  writeTriDexel(path, smallDocument());
  expectSame(readTriDexel(path), smallDocument());
  std::filesystem::remove(path);
  EXPECT_THROW((void)readTriDexel(path), InputError);
  EXPECT_THROW((void)readTriDexel(path.parent_path()), InputError);
  EXPECT_THROW(writeTriDexel(path / "no" / "folder", document), InputError);
}

TEST(TriDexelFile, LinesOfOneBallTakeLessThanHalfTheirMemory) {
  PrimitiveList list;
  list.append({{{0, 0, 0}, 1.0f}, Sign::Positive});
  TriDexelDocument document;
  document.model = triDexelOf(list, dexelGridFor(list.bounds(), {.resolution = 128}));
  EXPECT_LT(formatTriDexel(document, "x").size(), document.model.bytes() / 2);
}

TEST(TriDexelFile, EveryTruncationAndWhatFollowsIsRefused) {
  const std::string contents = formatTriDexel(smallDocument(), "x");
  for (std::size_t size = 0; size < contents.size(); ++size) {
    const std::string refusal = refusalOf(contents.substr(0, size));
    ASSERT_NE(refusal, "") << size;
    ASSERT_EQ(refusal.rfind("x.tridexel: byte ", 0), 0u) << refusal;
  }
  EXPECT_NE(refusalOf(contents + '\0'), "");
  EXPECT_NE(refusalOf(contents + contents), "");
}

TEST(TriDexelFile, EveryFlippedBitIsRefused) {
  const std::string contents = formatTriDexel(smallDocument(), "x");
  for (std::size_t bit = 0; bit < 8 * contents.size(); ++bit) {
    std::string flipped = contents;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ 1 << bit % 8);
    ASSERT_NE(refusalOf(flipped), "") << "bit " << bit;
  }
}

TEST(TriDexelFile, OtherVersionsAndOtherFilesAreNamed) {
  std::string contents = formatTriDexel(smallDocument(), "x");
  for (const char version : {char{0}, char{3}}) {
    contents[8] = version;
    EXPECT_EQ(refusalOf(contents),
              fmt::format("x.tridexel: byte 8: this is version {} of the format; versions 1 to 2 can be read",
                          static_cast<int>(version)));
  }
  EXPECT_EQ(refusalOf("solid cube"),
            "x.tridexel: byte 0: this is no tri-dexel model; those begin with \"TRIDEXEL\"");
}

// Files whose checksum is right and whose contents are not: any byte of the body set to anything. They are
// refused, or are models that can be written again.
TEST(TriDexelFile, SoundFilesWithWrongContentsAreRefusedOrModels) {
  const std::string body = unpackedFile(formatTriDexel(smallDocument(), "x")).body;
  ASSERT_EQ(refusalOf(packedFile(body)), "");
  std::size_t refused = 0;
  for (std::size_t at = 0; at < body.size(); ++at)
    for (const int value : {0, 1, 2, 0x7f, 0x80, 0xff}) {
      std::string changed = body;
      changed[at] = static_cast<char>(value);
      try {
        const TriDexelDocument read = parseTriDexel(packedFile(changed), "x");
        (void)formatTriDexel(read, "x");
      } catch (const InputError&) {
        ++refused;
      }
    }
  EXPECT_GT(refused, body.size());
  for (std::size_t size = 0; size < body.size(); ++size)
    ASSERT_NE(refusalOf(packedFile(body.substr(0, size))), "") << size;
  EXPECT_NE(refusalOf(packedFile(body + '\0')), "");
}

TEST(TriDexelFile, SizesThatLieAreRefusedBeforeMemoryIsTaken) {
  const std::string body = unpackedFile(formatTriDexel(smallDocument(), "x")).body;
  const auto with = [&](std::size_t at, std::uint32_t number) {
    std::string changed = body;
    std::memcpy(changed.data() + at, &number, 4);
    return refusalOf(packedFile(changed));
  };
  // The counts of the grid: lines that the file does not have.
  for (std::size_t at = 44; at < 56; at += 4) {
    EXPECT_NE(with(at, 8000), "");
    EXPECT_NE(with(at, 8193), "");
    EXPECT_NE(with(at, 0xffffffffu), "");
  }
  EXPECT_NE(with(56, 0xffffffffu).find("volumes take 4294967295 x"), std::string::npos) << with(56, ~0u);
  // A body that says it is larger than it is, with a checksum that fits.
  std::string contents = packedFile(body);
  const std::uint64_t huge = std::uint64_t{1} << 60;
  std::memcpy(contents.data() + 16, &huge, 8);
  const std::string hashed = contents.substr(0, 32) + contents.substr(40);
  const std::uint64_t hash = XXH3_64bits(hashed.data(), hashed.size());
  std::memcpy(contents.data() + 32, &hash, 8);
  EXPECT_NE(refusalOf(contents).find("byte 40: there is no zstd frame"), std::string::npos);
}

TEST(TriDexelFile, WhatTheFormatCannotHoldIsNotWritten) {
  TriDexelDocument document = smallDocument();
  std::get<TriDexelDocument::PosedTool>(document.operations.back().tool).tool = 2;
  EXPECT_THROW((void)formatTriDexel(document, "x"), InputError);
  document = smallDocument();
  document.operations.clear();  // ends were made by them
  EXPECT_THROW((void)formatTriDexel(document, "x"), InputError);
  document = smallDocument();
  document.tools[0].triangles[0][0] = 4;
  EXPECT_THROW((void)formatTriDexel(document, "x"), InputError);
  document = smallDocument();
  std::get<TriDexelDocument::PosedTool>(document.operations.back().tool).pose[5] = std::nan("");
  EXPECT_THROW((void)formatTriDexel(document, "x"), InputError);
}

}  // namespace
}  // namespace restroke::points
