// `.tridexel` files of version 2: cutters and what they did, runs, histories of lines.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "tests/points/tridexel_file_support.h"
#include "tests/support/effort.h"

namespace restroke::points {
namespace {

using namespace testing;
using restroke::testing::kSanitized;

std::vector<Cutter> cutters() {
  return {
      {.kind = Cutter::Kind::Flat, .radius = 0.125, .length = 2},
      {.kind = Cutter::Kind::Ball, .radius = 0.25, .length = 3, .orientation = {0, 0, 1, 1, 0, 0, 0, 1, 0}},
      {.kind = Cutter::Kind::BullNose, .radius = 0.375, .length = 4, .cornerRadius = 0.0625}};
}

// A list whose lines keep histories, and moves of cutters that changed nothing.
TriDexelDocument withEverything(const std::vector<Primitive>& primitives, int resolution) {
  TriDexelDocument out = documentOf(primitives, resolution);
  PrimitiveList list;
  for (const Primitive& primitive : primitives) list.append(primitive);
  out.model = triDexelOf(list, out.model.grid(), {.lines = {.history = true}});
  out.cutters = cutters();
  const auto move = [&](std::uint32_t cutter, PathElement element) {
    out.operations.push_back({DexelOperation::Subtraction, CutterMove{cutter, element}});
  };
  move(0, {.from = {5, 6, 7}, .to = {8, 9, 10}});
  move(2, {.from = {5, 6, 7}, .to = {5, 6, 7}});
  move(1, {.kind = PathElement::Kind::Arc,
           .from = {51, 0, 0},
           .to = {0, 51, 3},
           .center = {0.5, -0.25, 0},
           .axis = 1,
           .clockwise = true});
  const auto count = static_cast<std::uint32_t>(out.operations.size());
  out.runs = {{static_cast<OperationId>(count - 3), 2}, {static_cast<OperationId>(count - 1), 2}};
  return out;
}

TriDexelDocument small() {
  return withEverything({{{{0, 0, 0}, 1.0f}, Sign::Positive},
                         {{{0.5f, 0, 0.5f}, 0.6f}, Sign::Negative},
                         {{{0, 0.5f, 0.5f}, 0.5f}, Sign::Positive},
                         {{{0, 0.5f, 0.9f}, 0.5f}, Sign::Negative}},
                        4);
}

TriDexelDocument large(std::uint64_t seed) {
  Random random(seed);
  std::vector<Primitive> primitives = {{{{0, 0, 0}, 1.0f}, Sign::Positive}};
  while (primitives.size() < (kSanitized ? 20 : 80))
    primitives.push_back(restroke::testing::randomMixedPrimitive(random, primitives));
  return withEverything(primitives, 20);
}

void expectAsWritten(const TriDexelDocument& document) {
  const std::string contents = formatTriDexel(document, "x");
  EXPECT_EQ(contents[8], 2);
  expectSame(parseTriDexel(contents, "x"), document);
}

TEST(TriDexelFileOfVersion2, R2bR10CuttersRunsAndHistoriesComeBackBitForBit) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    SCOPED_TRACE(seed);
    const TriDexelDocument document = large(seed);
    ASSERT_GT(document.model.historySize().entries, kSanitized ? 200u : 500u);
    expectAsWritten(document);
  }
}

TEST(TriDexelFileOfVersion2, IsWrittenWhenAnythingNeedsIt) {
  TriDexelDocument document = smallDocument();
  EXPECT_EQ(formatTriDexel(document, "x")[8], 1);
  document.cutters = cutters();
  expectAsWritten(document);
  document = smallDocument();
  document.runs = {{OperationId{1}, 2}};
  expectAsWritten(document);
  document = smallDocument();
  document.model.startHistory();
  expectAsWritten(document);
  document.model = TriDexel(DexelGrid(), {.history = true});
  document.operations.clear();
  expectAsWritten(document);
}

TEST(TriDexelFileOfVersion2, ARunsOperationsAreNamedByTheFirst) {
  TriDexelDocument document = small();
  document.runs = {{OperationId{1}, 2}};
  EXPECT_THROW((void)formatTriDexel(document, "x"), InputError) << "operation 2 changed lines";
  // Histories that name the first only.
  TriDexel model = document.model;
  model.startHistory();
  std::vector<OperationId> ids;
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t line = 0; line < model.family(axis).lineCount(); ++line) {
      ids.clear();
      document.model.family(axis).changesOf(line, ids);
      for (const OperationId id : ids)
        model.family(axis).noteChange(line, id == OperationId{2} ? OperationId{1} : id);
    }
  document.model = model;
  expectAsWritten(document);
}

TEST(TriDexelFileOfVersion2, EveryTruncationAndEveryFlippedBitIsRefused) {
  const std::string contents = formatTriDexel(small(), "x");
  for (std::size_t size = 0; size < contents.size(); ++size)
    ASSERT_NE(refusalOf(contents.substr(0, size)), "") << size;
  for (std::size_t bit = 0; bit < 8 * contents.size(); ++bit) {
    std::string flipped = contents;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ 1 << bit % 8);
    ASSERT_NE(refusalOf(flipped), "") << "bit " << bit;
  }
}

TEST(TriDexelFileOfVersion2, SoundFilesWithWrongContentsAreRefusedOrModels) {
  const std::string body = unpackedFile(formatTriDexel(small(), "x")).body;
  ASSERT_EQ(refusalOf(packedFile(body, 2)), "");
  std::size_t refused = 0;
  for (std::size_t at = 0; at < body.size(); at += kSanitized ? 7 : 1)
    for (const int value : {1, 0xff}) {
      std::string changed = body;
      changed[at] = static_cast<char>(value);
      try {
        const TriDexelDocument read = parseTriDexel(packedFile(changed, 2), "x");
        const std::string again = formatTriDexel(read, "x");
        if (again[8] == 2) expectSame(parseTriDexel(again, "x"), read);
      } catch (const InputError&) {
        ++refused;
      }
    }
  EXPECT_GT(refused, body.size() / (kSanitized ? 20 : 3));
  for (std::size_t size = 0; size < body.size(); ++size)
    ASSERT_NE(refusalOf(packedFile(body.substr(0, size), 2)), "") << size;
  EXPECT_NE(refusalOf(packedFile(body + '\0', 2)), "");
}

TEST(TriDexelFileOfVersion2, WhatIsOfVersion2IsRefusedInVersion1) {
  EXPECT_NE(refusalOf(packedFile(unpackedFile(formatTriDexel(small(), "x")).body, 1)), "");
  EXPECT_NE(refusalOf(packedFile(unpackedFile(formatTriDexel(smallDocument(), "x")).body, 2)), "");
}

// The document with something wrong that the writer lets pass is refused when it is read.
void expectRefused(const std::function<void(TriDexelDocument&)>& change, const std::string& part) {
  TriDexelDocument document = small();
  change(document);
  const std::string refusal = refusalOf(formatTriDexel(document, "x"));
  EXPECT_NE(refusal.find(part), std::string::npos) << part << ": " << refusal;
  EXPECT_EQ(refusal.rfind("x.tridexel: byte 40 and on, unpacked, byte ", 0), 0u) << refusal;
}

TEST(TriDexelFileOfVersion2, EveryRuleForCuttersIsKept) {
  const auto cutter = [](std::size_t i, auto change) {
    return [=](TriDexelDocument& document) { change(document.cutters[i]); };
  };
  expectRefused(cutter(0, [](Cutter& c) { c.kind = static_cast<Cutter::Kind>(3); }), "of kind 3");
  expectRefused(cutter(0, [](Cutter& c) { c.radius = 0; }), "radius 0");
  expectRefused(cutter(0, [](Cutter& c) { c.radius = -1; }), "greater than 0");
  expectRefused(cutter(0, [](Cutter& c) { c.length = 0; }), "greater than 0");
  expectRefused(cutter(1, [](Cutter& c) { c.length = c.radius / 2; }), "at least as long");
  expectRefused(cutter(0, [](Cutter& c) { c.cornerRadius = 0.01; }), "corner radius 0.01");
  expectRefused(cutter(2, [](Cutter& c) { c.cornerRadius = 0; }), "corner radius 0");
  expectRefused(cutter(2, [](Cutter& c) { c.cornerRadius = c.radius; }), "corner radius");
  expectRefused(cutter(2, [](Cutter& c) { c.length = c.cornerRadius / 2; }), "corner radius");
  expectRefused(cutter(0, [](Cutter& c) { c.orientation = {2, 0, 0, 0, 2, 0, 0, 0, 2}; }), "scales by 2");
  expectRefused(cutter(0, [](Cutter& c) { c.orientation[1] = 0.5; }), "no rotation");
  expectRefused(cutter(0, [](Cutter& c) { c.orientation = {1, 0, 0, 0, 1, 0, 0, 0, -1}; }), "no rotation");
}

// What the writer refuses, made in the bytes of a body: the first place with `from` gets `to`.
std::string refusalWith(const TriDexelDocument& document, const std::string& from, const std::string& to) {
  std::string body = unpackedFile(formatTriDexel(document, "x")).body;
  const std::size_t at = body.find(from);
  EXPECT_NE(at, std::string::npos);
  body.replace(at, from.size(), to);
  return refusalOf(packedFile(body, 2));
}
template <class... T>
std::string packed(T... numbers) {
  std::string out;
  (out.append(reinterpret_cast<const char*>(&numbers), sizeof numbers), ...);
  return out;
}

TEST(TriDexelFileOfVersion2, NumbersOfCuttersElementsRunsAndHistoriesAreChecked) {
  const TriDexelDocument document = small();
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto has = [](const std::string& refusal, const std::string& part) {
    EXPECT_NE(refusal.find(part), std::string::npos) << part << ": " << refusal;
  };
  has(refusalWith(document, packed(0.375), packed(kNan)), "a cutter has the number nan");
  has(refusalWith(document, packed(10.0), packed(HUGE_VAL)), "an element of a path has the number inf");
  has(refusalWith(document, packed(10.0), packed(1e300)), "the coordinate 1e+300");
  const char subtraction = 1, moves = 3;
  has(refusalWith(document, packed(subtraction, moves, 2u), packed(subtraction, moves, 3u)),
      "uses cutter 3 of 3");
  has(refusalWith(document, packed(subtraction, moves, 2u), packed(subtraction, char{4}, 2u)), "sort 4");
  has(refusalWith(document, packed(51.0, 3.0, 0.5, -0.25, 0.0, char{1}),
                  packed(51.0, 3.0, 0.5, -0.25, 0.0, char{3})),
      "about axis 3");
  has(refusalWith(document, packed(-0.25, 0.0, char{1}, char{1}), packed(-0.25, 0.0, char{1}, char{2})),
      "sense of an arc is 2");
  const auto count = static_cast<std::uint32_t>(document.operations.size());
  const std::string runs = packed(2u, count - 3, 2u, count - 1, 2u);
  for (const std::string& bad :
       {packed(2u, count - 3, 1u, count - 1, 2u), packed(2u, 0u, 2u, count - 1, 2u),
        packed(2u, count - 3, 3u, count - 1, 2u), packed(2u, count - 3, 2u, count - 1, 3u),
        packed(2u, count - 3, 2u, count + 1, 2u), packed(2u, count - 3, 2u, count - 1, 0xffffffffu)})
    has(refusalWith(document, runs, bad), "a run has");
  // Operation 1, which some lines name first, within a run; and its last.
  has(refusalWith(document, runs, packed(2u, 1u, 2u, 3u, 2u)), "of a run be the first");
}

TEST(TriDexelFileOfVersion2, HistoriesMustAscendAndAllFamiliesHaveThem) {
  const TriDexelDocument document = small();
  const std::string body = unpackedFile(formatTriDexel(document, "x")).body;
  // The last family's words are the last bytes: the lowest byte of each comes first.
  const Dexels& last = document.model.family(2);
  const std::size_t entries = last.histories().entryCount(), lines = last.lineCount();
  ASSERT_GT(entries, 10u);
  const std::size_t words = body.size() - 4 * entries, counts = words - 4 * lines;
  const auto with = [&](std::size_t at, int value) {
    std::string changed = body;
    changed[at] = static_cast<char>(value);
    return refusalOf(packedFile(changed, 2));
  };
  for (const int word : {0, 1, 200}) {
    const std::string refusal = with(words, word);
    EXPECT_NE(refusal.find("they must ascend"), std::string::npos) << word << ": " << refusal;
  }
  EXPECT_NE(with(counts, 250).find("it must be"), std::string::npos);
  EXPECT_NE(with(counts - 8, static_cast<int>(entries) - 1), "");
  EXPECT_NE(with(counts - 1, 1).find("must be there"), std::string::npos);
  TriDexelDocument other = document;
  other.model.family(1) = Dexels(last.width(), last.height(), {});
  EXPECT_THROW((void)formatTriDexel(other, "x"), InputError);
}

TEST(TriDexelFileOfVersion2, WhatTheFormatCannotHoldIsNotWritten) {
  const auto refuses = [](const std::function<void(TriDexelDocument&)>& change) {
    TriDexelDocument document = small();
    change(document);
    EXPECT_THROW((void)formatTriDexel(document, "x"), InputError);
  };
  const auto moveOf = [](TriDexelDocument& d) -> CutterMove& {
    return std::get<CutterMove>(d.operations.back().tool);
  };
  refuses([&](TriDexelDocument& d) { moveOf(d).cutter = 3; });
  refuses([&](TriDexelDocument& d) { moveOf(d).element.to.y = std::nan(""); });
  refuses([&](TriDexelDocument& d) { moveOf(d).element.axis = 3; });
  refuses([](TriDexelDocument& d) { d.cutters[1].orientation[4] = HUGE_VAL; });
  refuses([](TriDexelDocument& d) { d.runs[0].count = 1; });
  refuses([](TriDexelDocument& d) { d.runs[0].count = 3; });
  refuses([](TriDexelDocument& d) { d.runs[1].count = 3; });
  refuses([](TriDexelDocument& d) { d.runs[0].first = OperationId::Initial; });
  refuses([](TriDexelDocument& d) {
    d.model.family(1).noteChange(0, static_cast<OperationId>(d.operations.size() + 1));
  });
}

}  // namespace
}  // namespace restroke::points
