// How far a refined model is from another: exact figures of lines made by hand, and the definition (SPEC X5).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "experiments/random.h"
#include "experiments/refine/differences.h"
#include "experiments/refine/pictures.h"

namespace restroke::experiments {
namespace {

using points::Dexels;
using points::LineEnds;
using points::OperationId;
using points::RefinedModel;
using points::SpanEnd;

constexpr OperationId kInitial = OperationId::Initial, kNone = OperationId::None;

OperationId id(std::uint32_t n) {
  return OperationId{n};
}

LineEnds line(std::initializer_list<float> depths) {
  LineEnds ends;
  for (const float depth : depths) ends.push_back({.depth = depth});
  return ends;
}

std::vector<WrongStretch> wrong(const LineEnds& reference, const LineEnds& judged) {
  std::vector<WrongStretch> out{{9, 10, false}};  // what was there before does not stay
  findWrongStretches(reference, judged, out);
  return out;
}

using Stretches = std::vector<WrongStretch>;

TEST(RefineDifferences, OfEqualLinesAreNone) {
  EXPECT_EQ(wrong({}, {}), Stretches{});
  EXPECT_EQ(wrong(line({1, 2, 4, 8}), line({1, 2, 4, 8})), Stretches{});
}

TEST(RefineDifferences, WhatOnlyTheReferenceHasIsMissingAndWhatItHasNotIsExtra) {
  EXPECT_EQ(wrong(line({1, 3}), {}), (Stretches{{1, 3, false}}));
  EXPECT_EQ(wrong({}, line({1, 3, 5, 6})), (Stretches{{1, 3, true}, {5, 6, true}}));
  EXPECT_EQ(wrong(line({1, 3}), line({1.5f, 4})), (Stretches{{1, 1.5f, false}, {3, 4, true}}));
  EXPECT_EQ(wrong(line({0, 10}), line({2, 3, 4, 5})),
            (Stretches{{0, 2, false}, {3, 4, false}, {5, 10, false}}));
  EXPECT_EQ(wrong(line({1, 2, 3, 4}), line({1, 4})), (Stretches{{2, 3, true}}));
}

TEST(RefineDifferences, StretchesThatMeetAreOfDifferentKinds) {
  EXPECT_EQ(wrong(line({1, 2}), line({2, 3})), (Stretches{{1, 2, false}, {2, 3, true}}));
  EXPECT_EQ(wrong(line({2, 3}), line({1, 2})), (Stretches{{1, 2, true}, {2, 3, false}}));
}

// Ends at whole numbers: the unit stretches between them are the oracle.
TEST(RefineDifferences, OfRandomLinesAreThoseOfTheirUnitStretches) {
  constexpr std::uint64_t kSeed = 5;
  SCOPED_TRACE(kSeed);
  Random random(kSeed);
  constexpr int kUnits = 24;
  for (int trial = 0; trial < 2000; ++trial) {
    std::array<std::array<bool, kUnits>, 2> inside{};
    std::array<LineEnds, 2> lines;
    for (std::size_t which = 0; which < 2; ++which) {
      for (bool& unit : inside[which]) unit = random.below(2) == 0;
      for (int u = 0; u <= kUnits; ++u) {
        const bool before = u > 0 && inside[which][static_cast<std::size_t>(u - 1)],
                   after = u < kUnits && inside[which][static_cast<std::size_t>(u)];
        if (before != after) lines[which].push_back({.depth = static_cast<float>(u)});
      }
    }
    std::array<int, kUnits> found{};
    const Stretches stretches = wrong(lines[0], lines[1]);
    for (std::size_t i = 0; i < stretches.size(); ++i) {
      const WrongStretch& s = stretches[i];
      ASSERT_LT(s.from, s.to);
      if (i > 0) {
        ASSERT_TRUE(stretches[i - 1].to < s.from ||
                    (stretches[i - 1].to == s.from && stretches[i - 1].extra != s.extra));
      }
      for (int u = static_cast<int>(s.from); u < static_cast<int>(s.to); ++u)
        found[static_cast<std::size_t>(u)] = s.extra ? 1 : -1;
    }
    for (std::size_t u = 0; u < kUnits; ++u)
      ASSERT_EQ(found[u], static_cast<int>(inside[1][u]) - static_cast<int>(inside[0][u])) << trial;
  }
}

/// Lines along z, one unit apart, from (0, 0) on, in a zone from depth 0 to 10.
RefinedModel modelOf(const std::vector<LineEnds>& lines) {
  points::RefinedFamily family;
  const int width = static_cast<int>(lines.size());
  family.lines.family = {.width = width, .height = 1, .originStep = {1, 0, 0}, .originRowStep = {0, 1, 0}};
  family.lines.from.assign(lines.size(), 0);
  family.lines.to.assign(lines.size(), 10);
  family.dexels = Dexels(width, 1, {.operations = true});
  for (std::size_t i = 0; i < lines.size(); ++i) family.dexels.write(i, lines[i]);
  RefinedModel model;
  model.families.push_back(std::move(family));
  return model;
}

SpanEnd end(float depth, OperationId inner, OperationId outer) {
  return {.depth = depth, .normal = points::packNormal({0, 0, 1}), .inner = inner, .outer = outer};
}

RefinedModel threeLines() {
  return modelOf(
      {{end(1, kInitial, kNone), end(4, id(2), id(5))},
       {end(0, kInitial, kNone), end(3, kInitial, id(5)), end(6, id(7), id(2)), end(10, id(7), kNone)},
       {}});
}

TEST(RefineReference, KnowsLengthEndsAndTheOperationsThatShow) {
  const Reference reference(threeLines());
  EXPECT_EQ(reference.length(), 3.0 + 3 + 4);
  EXPECT_EQ(reference.ends(), 4u) << "two are at the zone's border";
  ASSERT_EQ(reference.visible().size(), 3u) << "the initial solid is no operation";
  const auto& visible = reference.visible();
  EXPECT_EQ(visible[0].id, id(2));
  EXPECT_EQ(visible[0].trims, 0u) << "at both of its ends a later one made the end";
  EXPECT_EQ(visible[0].sides, 2u);
  EXPECT_EQ(visible[1].id, id(5));
  EXPECT_EQ(visible[1].trims, 2u);
  EXPECT_EQ(visible[1].sides, 2u);
  EXPECT_EQ(visible[2].id, id(7));
  EXPECT_EQ(visible[2].trims, 1u) << "the border is not its";
  EXPECT_EQ(visible[2].sides, 1u);
}

TEST(RefineReference, OfNothingIsEmpty) {
  const Reference reference(modelOf({{}, {}}));
  EXPECT_EQ(reference.length(), 0);
  EXPECT_EQ(reference.ends(), 0u);
  EXPECT_TRUE(reference.visible().empty());
  const Differences none = differencesOf(reference, modelOf({{}, {}}));
  EXPECT_TRUE(none.identical);
  EXPECT_EQ(none.missing + none.extra, 0);
  EXPECT_FALSE(none.toJudged);
  EXPECT_FALSE(none.toReference);
}

TEST(RefineReference, RecallCountsOperationsAndEnds) {
  const Reference reference(threeLines());
  const auto recall = [&](std::vector<OperationId> ids) { return recallOf(reference, ids); };
  Recall all = recall({kInitial, id(2), id(3), id(5), id(7), id(9)});
  EXPECT_EQ(all.sides, 3u);
  EXPECT_EQ(all.trimming, 2u);
  EXPECT_EQ(all.sidesMissed + all.trimmingMissed + all.endsMissed, 0u);
  const Recall none = recall({});
  EXPECT_EQ(none.sidesMissed, 3u);
  EXPECT_EQ(none.trimmingMissed, 2u);
  EXPECT_EQ(none.endsMissed, 3u);
  const Recall some = recall({kInitial, id(7)});
  EXPECT_EQ(some.sidesMissed, 2u);
  EXPECT_EQ(some.trimmingMissed, 1u);
  EXPECT_EQ(some.endsMissed, 2u);
}

TEST(RefineReference, LengthsAndDistancesAreThoseOfTheLines) {
  const Reference reference(threeLines());
  const Differences same = differencesOf(reference, threeLines());
  EXPECT_TRUE(same.identical);
  EXPECT_EQ(same.missing + same.extra, 0);
  EXPECT_EQ(same.toJudged, 0);
  EXPECT_EQ(same.toReference, 0);
  // Another reference at an end is no difference of shape, but not the same bits.
  RefinedModel renamed = threeLines();
  renamed.families[0].dexels.write(0, LineEnds{end(1, kInitial, kNone), end(4, id(2), id(6))});
  EXPECT_FALSE(differencesOf(reference, renamed).identical);
  EXPECT_EQ(differencesOf(reference, renamed).toJudged, 0);

  // The first line ends half a unit later; the second has no gap; the third has a grain.
  const RefinedModel judged = modelOf({{end(1, kInitial, kNone), end(4.5f, id(2), id(5))},
                                       {end(0, kInitial, kNone), end(10, id(7), kNone)},
                                       {end(8, id(3), kNone), end(8.25f, id(3), kNone)}});
  const Differences d = differencesOf(reference, judged);
  EXPECT_EQ(d.missing, 0);
  EXPECT_EQ(d.extra, 0.5 + 3 + 0.25);
  // From the lost ends (line 0: 4; line 1: 3 and 6) the farthest to what is left (line 0: 1 and 4.5; line 2:
  // 8 and 8.25) is that of 6, to 4.5 on the line beside.
  EXPECT_DOUBLE_EQ(*d.toJudged, std::sqrt(1.5 * 1.5 + 1));
  // And back: 8.25 is nearest to 6 on the line beside.
  EXPECT_DOUBLE_EQ(*d.toReference, std::sqrt(2.25 * 2.25 + 1));
  EXPECT_FALSE(d.identical);

  const Differences lost = differencesOf(reference, modelOf({{}, {}, {}}));
  EXPECT_EQ(lost.missing, reference.length());
  EXPECT_FALSE(lost.toJudged) << "there is nothing to be near to";
  EXPECT_EQ(lost.toReference, 0);
}

TEST(RefinePictures, MarkWhatIsWrongAndStandInForWhatIsMissing) {
  const Reference reference(modelOf({{end(1, id(1), kNone), end(4, id(1), kNone)},
                                     {end(1, id(1), kNone), end(4, id(1), kNone)},
                                     {end(2, id(1), kNone), end(5, id(1), kNone)}}));
  const RefinedModel judged = modelOf(
      {{end(1, id(1), kNone), end(4, id(1), kNone)}, {end(1, id(1), kNone), end(6, id(1), kNone)}, {}});
  std::array<int, 3> count{};
  for (const MarkedEnd& each : markedEnds(reference, judged)) {
    ++count[static_cast<std::size_t>(each.kind)];
    EXPECT_EQ(each.surfel.position.x == 2, each.kind == EndKind::Missing);
    EXPECT_EQ(each.surfel.position.z == 6, each.kind == EndKind::Extra);
    EXPECT_FLOAT_EQ(each.surfel.radius, 0.71f);
  }
  EXPECT_EQ(count, (std::array<int, 3>{3, 1, 2}));
}

TEST(RefinePictures, ASliceHasTheColoursOfItsLines) {
  // Two lines; from the foot: one with all four kinds, one of nothing.
  const std::vector<SliceLine> lines{{line({0, 4}), line({2, 6})}, {}};
  const points::DisplayImage image = sliceImage(lines, 0, 8, 8);
  ASSERT_EQ(image.width, 8u);
  ASSERT_EQ(image.rgba.size(), 4u * 64);
  const auto at = [&](std::size_t x, std::size_t y) {
    return std::vector<std::uint8_t>(image.rgba.begin() + std::ptrdiff_t(4 * (8 * y + x)),
                                     image.rgba.begin() + std::ptrdiff_t(4 * (8 * y + x) + 3));
  };
  const auto missing = at(0, 7), right = at(2, 7), extra = at(4, 7), outside = at(6, 7);
  EXPECT_GT(missing[0], missing[2] + 100) << "red";
  EXPECT_GT(extra[2], extra[0] + 100) << "blue";
  EXPECT_NE(right, outside);
  for (std::size_t x = 0; x < 8; ++x) {
    EXPECT_EQ(at(x, 4), x < 2 ? missing : x < 4 ? right : x < 6 ? extra : outside);
    EXPECT_EQ(at(x, 3), outside);
  }
}

}  // namespace
}  // namespace restroke::experiments
