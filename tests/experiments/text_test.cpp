#include "experiments/text.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "experiments/examples/pen.h"
#include "experiments/random.h"

namespace restroke::experiments {
namespace {

TEST(Text, GroupsDigitsByThrees) {
  EXPECT_EQ(grouped(0), "0");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(1000), "1,000");
  EXPECT_EQ(grouped(1234567), "1,234,567");
}

TEST(Text, QuotesCsvFieldsOnlyWhereNeeded) {
  EXPECT_EQ(csvField("plain"), "plain");
  EXPECT_EQ(csvField("a,b"), "\"a,b\"");
  EXPECT_EQ(csvField("say \"hi\"\n"), "\"say \"\"hi\"\"\n\"");
}

TEST(Text, EscapesWhatWouldEndATagOrAnAttribute) {
  EXPECT_EQ(escapeHtml("<a href=\"x\">&"), "&lt;a href=&quot;x&quot;&gt;&amp;");
}

TEST(Text, Base64IsThatOfRfc4648) {
  // The test vectors of section 10.
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe"), "//4=");
}

TEST(Text, ThinningKeepsFirstAndLastAndNeverRepeats) {
  EXPECT_TRUE(thinned(0, 5).empty());
  EXPECT_EQ(thinned(1, 5), std::vector<std::size_t>{0});
  EXPECT_EQ(thinned(3, 5), (std::vector<std::size_t>{0, 1, 2}));
  const auto thin = thinned(109, 10);
  ASSERT_EQ(thin.size(), 10u);
  EXPECT_EQ(thin.front(), 0u);
  EXPECT_EQ(thin.back(), 108u);
  for (std::size_t i = 1; i < thin.size(); ++i) EXPECT_LT(thin[i - 1], thin[i]);
}

TEST(Text, NamesThatAreTakenGetTheFirstFreeNumber) {
  const std::set<std::string, std::less<>> taken = {"rabbit", "rabbit-2", "rabbit-4"};
  const auto isTaken = [&](std::string_view name) { return taken.contains(name); };
  EXPECT_EQ(untakenName("gallery", isTaken), "gallery");
  EXPECT_EQ(untakenName("rabbit", isTaken), "rabbit-3");
}

TEST(Text, TablesLineUp) {
  const std::vector<std::vector<std::string>> lines = {{"name", "n"}, {"a", "1,000"}};
  EXPECT_EQ(alignedTable(lines, 1), "name      n\na     1,000\n");
}

TEST(Random, GivesTheNumbersOfSplitMix64) {
  // From the algorithm's reference implementation, seed 1234567.
  Random random(1234567);
  EXPECT_EQ(random.next(), 6457827717110365317u);
  EXPECT_EQ(random.next(), 3203168211198807973u);
  EXPECT_EQ(random.next(), 9817491932198370423u);
}

TEST(Turn, IsSineAndCosine) {
  constexpr double kTau = 6.283185307179586;
  for (int i = -500; i <= 500; ++i) {
    const double turns = i / 77.0;
    EXPECT_NEAR(turn(turns).cos, std::cos(kTau * turns), 1e-12) << turns;
    EXPECT_NEAR(turn(turns).sin, std::sin(kTau * turns), 1e-12) << turns;
  }
}

}  // namespace
}  // namespace restroke::experiments
