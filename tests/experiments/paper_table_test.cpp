// SPEC S12: the paper's eight pairs and the two formulas behind them.

#include "experiments/paper_table.h"

#include <gtest/gtest.h>

#include <vector>

namespace restroke::experiments {
namespace {

TEST(PaperTable, S12TheEightPairsAreThePapers) {
  const std::size_t strokes[] = {5752, 6068, 6384, 6700, 7016, 7332, 8788, 9104};
  const std::size_t snapshots[] = {21792, 43632, 65520, 87456, 109440, 131472, 158112, 184800};
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(kPaperTable2[i].strokeBytes, strokes[i]) << "step " << i + 1;
    EXPECT_EQ(kPaperTable2[i].snapshotBytes, snapshots[i]) << "step " << i + 1;
  }
}

TEST(PaperTable, S12BothFormulasGiveAllEightPairs) {
  std::size_t strokes = 0, snapshots = 0, primitives = 0;
  for (const PaperStep& step : kPaperTable2) {
    primitives += step.stamps;
    strokes += paperStrokeBytes(step.stamps);
    snapshots += paperSnapshotBytes(primitives);
    EXPECT_EQ(strokes, step.strokeBytes) << primitives << " primitives so far";
    EXPECT_EQ(snapshots, step.snapshotBytes) << primitives << " primitives so far";
  }
  EXPECT_EQ(primitives, 556u);
}

TEST(PaperTable, IsRecognisedByItsStampsAloneAndOnlyWhole) {
  std::vector<std::size_t> stamps = {454, 1, 1, 1, 1, 1, 96, 1};
  EXPECT_TRUE(isPaperTable2(stamps));
  stamps[6] = 95;
  EXPECT_FALSE(isPaperTable2(stamps));
  stamps[6] = 96;
  stamps.push_back(1);
  EXPECT_FALSE(isPaperTable2(stamps));
  EXPECT_FALSE(isPaperTable2({}));
}

}  // namespace
}  // namespace restroke::experiments
