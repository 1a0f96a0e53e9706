#pragma once
// Documents for tests of `.tridexel` files, and files whose parts are not what they should be.

#include <gtest/gtest.h>
#include <xxhash.h>
#include <zstd.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "implicit/errors.h"
#include "points/dexel/tridexel_file.h"
#include "tests/support/random_volumes.h"

namespace restroke::points::testing {

using implicit::Primitive;
using implicit::PrimitiveList;
using implicit::Shape;
using implicit::Sign;
using restroke::testing::Random;

inline TriangleMesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

/// A list on its first primitive, with operations for the others and some tools in poses that changed
/// nothing.
inline TriDexelDocument documentOf(const std::vector<Primitive>& primitives, int resolution) {
  PrimitiveList list;
  for (const Primitive& primitive : primitives) list.append(primitive);
  TriDexelDocument out;
  out.initial = std::vector<Primitive>{primitives[0]};
  for (std::size_t i = 1; i < primitives.size(); ++i)
    out.operations.push_back(
        {primitives[i].sign == Sign::Positive ? DexelOperation::Union : DexelOperation::Subtraction,
         primitives[i].shape});
  out.tools = {tetrahedron(), TriangleMesh{}};
  TriDexelDocument::PosedTool posed{1};
  posed.pose[3] = 0.1;
  out.operations.push_back({DexelOperation::Intersection, posed});
  out.model = triDexelOf(list, dexelGridFor(list.bounds(), {.resolution = resolution}));
  return out;
}

inline TriDexelDocument randomDocument(std::uint64_t seed, std::size_t count, int resolution) {
  Random random(seed);
  std::vector<Primitive> primitives = {{{{0, 0, 0}, 1.0f}, Sign::Positive}};
  while (primitives.size() < count)
    primitives.push_back(restroke::testing::randomMixedPrimitive(random, primitives));
  return documentOf(primitives, resolution);
}

inline TriDexelDocument smallDocument() {
  return documentOf({{{{0, 0, 0}, 1.0f}, Sign::Positive}, {{{0.5f, 0, 0.5f}, 0.6f}, Sign::Negative}}, 4);
}

inline void expectSame(const TriDexelDocument& a, const TriDexelDocument& b) {
  EXPECT_EQ(a.initial, b.initial);
  EXPECT_EQ(a.tools, b.tools);
  EXPECT_EQ(a.operations, b.operations);
  EXPECT_EQ(a.cutters, b.cutters);
  EXPECT_EQ(a.runs, b.runs);
  EXPECT_EQ(a.model, b.model);
  std::vector<OperationId> own, other;
  for (int axis = 0; axis < 3; ++axis) {
    const Dexels &first = a.model.family(axis), &second = b.model.family(axis);
    EXPECT_EQ(first.keepsOperations(), second.keepsOperations());
    ASSERT_EQ(first.keepsHistory(), second.keepsHistory());
    for (std::size_t line = 0; first.keepsHistory() && line < first.lineCount(); ++line) {
      own.clear();
      other.clear();
      first.changesOf(line, own);
      second.changesOf(line, other);
      ASSERT_EQ(own, other) << axis << ": " << line;
    }
  }
}

/// The sentence that refuses these contents; "" when they are read.
inline std::string refusalOf(const std::string& contents) {
  try {
    (void)parseTriDexel(contents, "x.tridexel");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

struct File {
  std::string head, body;
};

inline File unpackedFile(const std::string& contents) {
  File out{contents.substr(0, 40), {}};
  std::uint64_t size = 0;
  std::memcpy(&size, contents.data() + 16, 8);
  out.body.resize(size);
  EXPECT_EQ(ZSTD_decompress(out.body.data(), size, contents.data() + 40, contents.size() - 40), size);
  return out;
}

/// With a header that fits.
inline std::string packedFile(const std::string& body, char version = 1) {
  std::string frame(ZSTD_compressBound(body.size()), '\0');
  frame.resize(ZSTD_compress(frame.data(), frame.size(), body.data(), body.size(), 1));
  std::string out("TRIDEXEL\1\0\0\0\0\0\0\0", 16);
  out[8] = version;
  const std::uint64_t sizes[2] = {body.size(), frame.size()};
  out.append(reinterpret_cast<const char*>(sizes), 16);
  const std::string hashed = out + frame;
  const std::uint64_t hash = XXH3_64bits(hashed.data(), hashed.size());
  out.append(reinterpret_cast<const char*>(&hash), 8);
  return out + frame;
}

}  // namespace restroke::points::testing
