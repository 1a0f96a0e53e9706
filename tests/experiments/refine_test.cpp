// The refine experiment at a tiny size, and the histories and zones that it is made of (SPEC X5).

#include "experiments/refine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "experiments/output.h"
#include "experiments/random.h"
#include "experiments/refine/report.h"
#include "experiments/refine/summary.h"
#include "implicit/errors.h"
#include "tests/experiments/folder.h"
#include "tests/support/effort.h"

namespace restroke::experiments {
namespace {

namespace fs = std::filesystem;
using implicit::Primitive;
using implicit::Sign;

std::size_t additionsOf(const RefineHistory& history) {
  return static_cast<std::size_t>(std::ranges::count(history.operations, Sign::Positive, &Primitive::sign));
}

// Mean number of balls that cover a point of the ground, away from its border.
double coveringOf(const RefineHistory& history, double inner) {
  Random random(7);
  constexpr int kPoints = 400;
  std::size_t covers = 0;
  for (int i = 0; i < kPoints; ++i) {
    Point p;
    for (int a = 0; a < 3; ++a) p[a] = static_cast<float>(random.between(0.5 - inner, 0.5 + inner));
    for (const Primitive& each : history.operations) covers += contains(each.shape, p) ? 1 : 0;
  }
  return static_cast<double>(covers) / kPoints;
}

TEST(RefineHistories, StrewnBallsHaveTheDensityAndTheAdditionsThatWereAskedFor) {
  const BallsOptions options{.operations = 20'000, .density = 6, .additions = 0.25, .seed = 2};
  const RefineHistory history = strewnBalls(options);
  ASSERT_EQ(history.operations.size(), 20'000u);
  EXPECT_EQ(history.initial.size(), 1u);
  EXPECT_NEAR(static_cast<double>(additionsOf(history)) / 20'000, 0.25, 0.01);
  EXPECT_NEAR(coveringOf(history, 0.3), 6, 0.5);
  const double mean = meanRadiusOf(options);
  for (const Primitive& each : history.operations) {
    ASSERT_TRUE(each.shape.isSphere());
    ASSERT_GE(static_cast<double>(each.shape.ball().radius), 0.499 * mean);
    ASSERT_LE(static_cast<double>(each.shape.ball().radius), 1.501 * mean);
  }
  const auto count = static_cast<double>(operationsFor(options.density, mean, options.ground));
  EXPECT_NEAR(count, 20'000, 1) << "the one is the other's inverse";
}

TEST(RefineHistories, OnABallCentresAreInIt) {
  const RefineHistory history = strewnBalls({.operations = 500, .ground = Ground::Ball});
  for (const Primitive& each : history.operations)
    EXPECT_LE(length(DVec3(each.shape.ball().center)), 1 + 1e-6);
  EXPECT_TRUE(strewnBalls({.operations = 5, .ground = Ground::Nothing}).initial.empty());
}

TEST(RefineHistories, TheSameSeedGivesTheSameOperations) {
  const RefineHistory a = strewnBalls({.operations = 200, .seed = 3}),
                      b = strewnBalls({.operations = 200, .seed = 3}),
                      c = strewnBalls({.operations = 200, .seed = 4});
  EXPECT_EQ(a.operations, b.operations);
  EXPECT_NE(a.operations, c.operations);
}

TEST(RefineHistories, MillingOnlyTakesAway) {
  const RefineHistory history = milledBlock(2000, 1);
  EXPECT_EQ(additionsOf(history), 0u);
  EXPECT_NEAR(static_cast<double>(history.operations.size()), 2000, 200);
  const points::TriDexelDocument document = documentOf(history, 32, Kept::References);
  EXPECT_LT(document.model.volume(), 0.4) << "of 0.5";
  EXPECT_GT(document.model.volume(), 0.1);
}

TEST(RefineHistories, WhatIsThinAndBetweenTheLinesIsMetByNone) {
  for (const Thin thin : {Thin::Rods, Thin::Grains}) {
    const ThinOptions options{.thin = thin, .thickness = 0.75, .resolution = 32, .between = true};
    const RefineHistory history = thinFeatures(options);
    ASSERT_EQ(history.operations.size(), 64u);
    RefineHistory bare = history;
    bare.operations.clear();
    const points::TriDexelDocument with = documentOf(history, 32, Kept::References),
                                   without = documentOf(bare, 32, Kept::References);
    EXPECT_TRUE(with.model == without.model) << nameOf(thin);
    // Anywhere, or thicker than a cell, some are met.
    ThinOptions others = options;
    others.between = false;
    EXPECT_FALSE(documentOf(thinFeatures(others), 32, Kept::References).model == without.model);
    others = options;
    others.thickness = 1.5;
    EXPECT_FALSE(documentOf(thinFeatures(others), 32, Kept::References).model == without.model);
  }
  const RefineHistory plates = thinFeatures({.thin = Thin::Plates, .thickness = 0.25, .resolution = 32});
  EXPECT_EQ(boundsOf(plates).max.x, boundsOf(plates.initial.front().shape).max.x) << "within the cube";
}

TEST(RefineHistories, WhatGrowsElsewhereLeavesTheZoneAsItIs) {
  const Box near{Point(0.3f), Point(0.6f)};
  const auto local = [&](std::size_t operations) {
    std::vector<Primitive> out;
    const RefineHistory history = grownHistory(Growth::Elsewhere, operations, near, 1);
    EXPECT_EQ(history.operations.size(), operations);
    for (const Primitive& each : history.operations) {
      const Box b = boundsOf(each.shape);
      bool meets = true;
      for (int a = 0; a < 3; ++a) meets = meets && b.max[a] >= near.min[a] && b.min[a] <= near.max[a];
      if (meets) out.push_back(each);
    }
    return out;
  };
  const auto few = local(600), many = local(3000);
  EXPECT_GT(few.size(), 300u);
  EXPECT_EQ(few, many);
}

TEST(RefineHistories, DeeperKeepsTheRadiusAndFinerTheDensity) {
  const auto meanRadius = [](const RefineHistory& history) {
    double sum = 0;
    for (const Primitive& each : history.operations) sum += static_cast<double>(each.shape.ball().radius);
    return sum / static_cast<double>(history.operations.size());
  };
  const auto grown = [](Growth growth, std::size_t n) { return grownHistory(growth, n, {}, 1); };
  EXPECT_NEAR(meanRadius(grown(Growth::Deeper, 1000)), meanRadius(grown(Growth::Deeper, 8000)), 0.002);
  EXPECT_NEAR(meanRadius(grown(Growth::Finer, 1000)), 2 * meanRadius(grown(Growth::Finer, 8000)), 0.005);
  EXPECT_NEAR(coveringOf(grown(Growth::Finer, 1000), 0.3), 8, 1);
}

TEST(RefineLoss, ZonesAreCubesOfTheirPartWithinTheBounds) {
  const Box box{Point(-1, 0, 0), Point(1, 2, 1)};
  for (const DVec3 place : {DVec3(0, 1, 0.5), DVec3(-1, 0, 0), DVec3(1, 2, 1), DVec3(5, -5, 0.2)})
    for (const double part : {0.001, 0.01, 0.1}) {
      const points::Zone zone = zoneAt(box, part, place);
      EXPECT_NEAR(zone.volume(), part * 4, 1e-12);
      for (int a = 0; a < 3; ++a) {
        EXPECT_GE(zone.bounds().min[a], box.min[a] - 1e-5f);
        EXPECT_LE(zone.bounds().max[a], box.max[a] + 1e-5f);
      }
    }
  EXPECT_TRUE(zoneAt(box, 0.001, {0.3, 1, 0.5}).contains({0.3, 1, 0.5}));
  // Thinner than the cube: cut to the bounds.
  EXPECT_LT(zoneAt({Point(0), Point(10, 10, 0.1f)}, 0.1, {5, 5, 0}).volume(), 1);
}

TEST(RefineLoss, PlacesAreOnTheSurfaceAndNothingHasNone) {
  const RefineHistory history = strewnBalls({.operations = 1, .density = 1e-6, .ground = Ground::Ball});
  const points::TriDexelDocument document = documentOf(history, 16, Kept::References);
  const auto places = placesOnSurface(document.model, 20, 1);
  ASSERT_EQ(places.size(), 20u);
  for (const DVec3 p : places) EXPECT_NEAR(length(p), 1, 0.05);
  EXPECT_EQ(places, placesOnSurface(document.model, 20, 1));
  EXPECT_THROW((void)placesOnSurface(points::TriDexel(document.model.grid()), 1, 1), InputError);
}

TEST(RefineGrowth, QuartilesAreValuesOfTheSample) {
  const Quartiles one = quartilesOf({4}), five = quartilesOf({5, 1, 4, 2, 3}),
                  four = quartilesOf({4, 3, 2, 1});
  EXPECT_EQ(one.low, 4);
  EXPECT_EQ(one.high, 4);
  EXPECT_EQ(five.low, 2);
  EXPECT_EQ(five.median, 3);
  EXPECT_EQ(five.high, 4);
  EXPECT_EQ(four.median, 2);
}

TEST(RefineGrowth, PowersAreThoseOfTheSeconds) {
  std::vector<GrowthRow> rows;
  for (const std::size_t n : {1000u, 10'000u, 30'000u, 100'000u}) {
    GrowthRow row;
    row.growth = Growth::Deeper;
    row.operations = n;
    row.method = "ends";
    row.seconds.median = n == 1000 ? 99 : 3e-6 * std::pow(static_cast<double>(n), 0.75);
    rows.push_back(row);
  }
  EXPECT_NEAR(*powerOfGrowth(rows, Growth::Deeper, "ends", 10'000), 0.75, 1e-9);
  EXPECT_FALSE(powerOfGrowth(rows, Growth::Deeper, "ends", 100'000)) << "one size is no growth";
  EXPECT_FALSE(powerOfGrowth(rows, Growth::Deeper, "all", 1));
  EXPECT_EQ(growthUpTo(1000), (std::vector<std::size_t>{1000}));
  EXPECT_EQ(growthUpTo(20'000), (std::vector<std::size_t>{1000, 3000, 10'000, 20'000}));
}

TEST(RefineSummary, PoolsZonesBySummingLengthsAndCounts) {
  LossRow a;
  a.history = "x";
  a.method = "ends";
  a.length = 10;
  a.cell = 0.5;
  a.differences.missing = 1;
  a.differences.toJudged = 2;
  a.recall = {.trimming = 4, .trimmingMissed = 1, .sides = 8, .sidesMissed = 4, .endsMissed = 5};
  a.ends = 100;
  LossRow b = a;
  b.place = 1;
  b.length = 30;
  b.differences = {.missing = 0, .extra = 3, .toJudged = 1, .toReference = {}, .identical = false};
  b.recall = {.trimming = 6, .trimmingMissed = 1, .sides = 8, .sidesMissed = 0, .endsMissed = 0};
  LossRow other = a;
  other.history = "y";
  other.length = 0;
  const std::vector<LossRow> rows{a, b, other};
  const std::vector<PooledLoss> pools = pooled(rows);
  ASSERT_EQ(pools.size(), 2u);
  EXPECT_EQ(pools[0].zones, 2u);
  EXPECT_DOUBLE_EQ(*pools[0].wrong, 0.1);
  EXPECT_DOUBLE_EQ(*pools[0].volume, 0.05);
  EXPECT_DOUBLE_EQ(pools[0].worst, 0.1);
  EXPECT_DOUBLE_EQ(*pools[0].trimmingMissed, 0.2);
  EXPECT_DOUBLE_EQ(*pools[0].sidesMissed, 0.25);
  EXPECT_DOUBLE_EQ(*pools[0].endsMissed, 0.025);
  EXPECT_DOUBLE_EQ(*pools[0].toJudged, 4) << "in cells";
  EXPECT_FALSE(pools[0].toReference);
  EXPECT_FALSE(pools[1].wrong) << "nothing is no part of nothing";
  const Failures failures = failuresOf(rows, LossSweep::Lines, "ends");
  EXPECT_EQ(failures.zones, 2u);
  EXPECT_EQ(failures.beyond, 2u);
  EXPECT_EQ(failures.badly, 2u);
}

RefinementOptions tiny() {
  RefinementOptions options = smokeSize({});
  options.loss.operations = 600;
  options.loss.places = 1;
  options.loss.fineLines = 16;  // closer than a rod is thick
  options.loss.resolutions = {16};
  options.loss.features = {2};
  options.loss.densities = {2};
  options.loss.thicknesses = {0.5};
  options.growth.operations = {600};
  options.growth.fineLines = 12;
  options.growth.resolution = 24;
  options.loss.thinPlaces = 1;
  options.picturePlaces = 1;
  options.growth.repeats = 1;
  options.pictureSize = restroke::testing::kSanitized ? 32 : 64;
  return options;
}

const RefinementResults& results() {
  static const RefinementResults made = measureRefinement({}, tiny(), {.threads = 1});
  return made;
}

void everyMethodIsMeasuredInEveryZone() {
  std::set<std::string> sweeps;
  std::size_t clusters = 0;
  for (const LossRow& row : results().losses) {
    sweeps.insert(infoOf(row.sweep).name);
    if (row.method != "clusters") continue;
    ++clusters;
    EXPECT_TRUE(row.differences.identical) << row.history;
    EXPECT_EQ(row.recall.sidesMissed, 0u);
    EXPECT_EQ(row.collected, row.ids);
  }
  EXPECT_EQ(sweeps.size(), std::size(kLossSweeps));
  EXPECT_EQ(results().losses.size(), clusters * refineVariants().size());
  EXPECT_EQ(results().growths.size(), std::size(kGrowths) * timedMethods().size());
  for (const GrowthRow& row : results().growths) {
    EXPECT_GT(row.seconds.median, 0);
    EXPECT_EQ(row.identical, row.method == "clusters" || row.method.starts_with("all") || row.identical);
  }
  EXPECT_EQ(results().pictures.size(), 3u * 4);
}

void theSameSeedGivesTheSameFiguresAtAnyNumberOfThreads() {
  const RefinementResults again = measureRefinement({}, tiny(), {.threads = 2});
  ASSERT_EQ(again.losses.size(), results().losses.size());
  for (std::size_t i = 0; i < again.losses.size(); ++i) {
    const LossRow &a = results().losses[i], &b = again.losses[i];
    EXPECT_EQ(a.method, b.method);
    EXPECT_EQ(a.length, b.length);
    EXPECT_EQ(a.differences.missing, b.differences.missing);
    EXPECT_EQ(a.differences.extra, b.differences.extra);
    EXPECT_EQ(a.differences.toJudged, b.differences.toJudged);
    EXPECT_EQ(a.recall.sidesMissed, b.recall.sidesMissed);
    EXPECT_EQ(a.collected, b.collected);
  }
  for (std::size_t i = 0; i < again.pictures.size(); ++i)
    EXPECT_EQ(again.pictures[i].slice.rgba, results().pictures[i].slice.rgba);
}

void saysWhatHoldsAndWhatWasNotTried() {
  const std::vector<Claim> all = claims(results());
  ASSERT_EQ(all.size(), 16u);
  EXPECT_EQ(all[0].holds, true) << "clusters is all";
  for (std::size_t i = 1; i <= 11; ++i) EXPECT_FALSE(all[i].holds) << all[i].text;
  EXPECT_EQ(all[14].holds, true) << "rods between the lines are not found";
  EXPECT_EQ(all[15].holds, true) << "plates are";
  for (const Claim& claim : claims(RefinementResults{})) EXPECT_FALSE(claim.holds) << claim.text;
}

void writesWhatItPromises() {
  const Folder folder;
  const std::vector<std::string> files = writeRefinement(results(), tiny(), folder.path());
  for (const char* name : {"results.csv", "results.json", "times.csv", "times.json", "manifest.json",
                           "report.html", "refine-lines.png", "refine-lines.svg", "refine-thin.svg",
                           "refine-time.png", "lost-dense-ends.png", "lost-rods-document-slice.png"})
    EXPECT_NE(std::ranges::find(files, name), files.end()) << name;
  for (const std::string& name : files) EXPECT_GT(fs::file_size(folder.path() / name), 0u) << name;

  const auto json = nlohmann::json::parse(bytesOfFile(folder.path() / "results.json"));
  ASSERT_EQ(json.at("rows").size(), results().losses.size());
  for (const char* key :
       {"sweep", "value", "history", "resolution", "method", "wrong", "missing", "extra", "wrong_volume",
        "sides_missed", "trimming_missed", "ends_missed", "farthest_lost_cells", "identical", "model_bytes",
        "line_history_bytes", "revision", "options_hash", "seed"})
    EXPECT_TRUE(json["rows"][0].contains(key)) << key;
  const auto times = nlohmann::json::parse(bytesOfFile(folder.path() / "times.json"));
  ASSERT_EQ(times.at("rows").size(), results().growths.size());
  for (const char* key :
       {"growth", "operations", "method", "seconds", "seconds_p25", "collect", "approximate", "replay",
        "by_ends", "scale", "cluster_seconds", "history_model_bytes"})
    EXPECT_TRUE(times["rows"][0].contains(key)) << key;
  for (const char* name : {"results.csv", "times.csv"}) {
    const std::string csv = bytesOfFile(folder.path() / name);
    EXPECT_EQ(csv.find("inf"), std::string::npos);
    EXPECT_EQ(csv.find("nan"), std::string::npos);
  }
  const auto manifest = nlohmann::json::parse(bytesOfFile(folder.path() / "manifest.json"));
  EXPECT_EQ(manifest.at("options_hash"), hexHash(describe(tiny())));
  EXPECT_EQ(manifest.at("claims").size(), claims(results()).size());

  const std::string page = bytesOfFile(folder.path() / "report.html");
  EXPECT_EQ(page.find("http"), std::string::npos);
  EXPECT_EQ(page.find("<script"), std::string::npos);
  for (const char* word : {"Promised and measured", "What each method promises", "How often it fails",
                           "What is lost", "Beforehand", "How it was measured"})
    EXPECT_NE(page.find(word), std::string::npos) << word;
  const std::string table = refinementTable(results());
  for (const char* word : {"milled-600", "touching", "all-plain", "clusters gives the bits of all"})
    EXPECT_NE(table.find(word), std::string::npos) << word;
}

// One test for all of them: each test is a process of its own.
TEST(Refine, X5TheTinyRunMeasuresEveryMethodAndWritesWhatItPromises) {
  const auto check = [](const char* what, void (*expectations)()) {
    SCOPED_TRACE(what);
    expectations();
  };
  check("everyMethodIsMeasuredInEveryZone", everyMethodIsMeasuredInEveryZone);
  check("theSameSeedGivesTheSameFiguresAtAnyNumberOfThreads",
        theSameSeedGivesTheSameFiguresAtAnyNumberOfThreads);
  check("saysWhatHoldsAndWhatWasNotTried", saysWhatHoldsAndWhatWasNotTried);
  check("writesWhatItPromises", writesWhatItPromises);
}

TEST(Refine, RefusesLogsWithoutOperationsAndOptionsOutOfRange) {
  const Folder folder;
  const auto refused = [](const std::vector<fs::path>& logs, const RefinementOptions& options,
                          const char* says) {
    try {
      (void)measureRefinement(logs, options);
      ADD_FAILURE() << says;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  };
  const fs::path garbage = folder.path() / "garbage.log", bare = folder.path() / "bare.stamps";
  std::ofstream(garbage) << "hello\n";
  std::ofstream(bare) << "B 0 0 0 1\n";
  refused({folder.path() / "absent.log"}, tiny(), "absent.log");
  refused({garbage}, tiny(), "garbage.log");
  refused({bare}, tiny(), "bare");
  RefinementOptions options = tiny();
  options.loss.places = 0;
  refused({}, options, "0 places");
  options = tiny();
  options.loss.operations = 10;
  refused({}, options, "10 operations");
  options = tiny();
  options.growth.operations = {10};
  refused({}, options, "grows to 10");
}

TEST(Refine, OptionsThatChangeTheResultChangeItsHash) {
  RefinementOptions other;
  other.seed = 2;
  EXPECT_NE(describe(RefinementOptions{}), describe(other));
  other = {};
  other.growth.operations.pop_back();
  EXPECT_NE(describe(RefinementOptions{}), describe(other));
  other = {};
  other.loss.fineLines = 64;
  EXPECT_NE(describe(RefinementOptions{}), describe(other));
}

}  // namespace
}  // namespace restroke::experiments
