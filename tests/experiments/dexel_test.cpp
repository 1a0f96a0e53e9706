// The dexel experiment at its smoke size, and the figures that it is made of (SPEC D11).

#include "experiments/dexel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "experiments/dexel/report.h"
#include "experiments/dexel/slice.h"
#include "experiments/output.h"
#include "implicit/errors.h"
#include "points/dexel/tri_dexel.h"
#include "tests/experiments/folder.h"
#include "tests/support/effort.h"

namespace restroke::experiments {
namespace {

namespace fs = std::filesystem;
using implicit::Sign;

const fs::path kExamples = fs::path(RESTROKE_SOURCE_DIR) / "experiments" / "examples";

Truth ballTruth(std::size_t points = 50'000, float density = 1000) {
  return Truth(analyticBall().primitives, {.points = points, .seed = 3, .density = density}, {.threads = 2});
}

TEST(DexelTruth, OfABallHasItsVolumeItsSurfaceAndItsDistances) {
  const Truth truth = ballTruth();
  EXPECT_NEAR(static_cast<double>(truth.pointsInside()) / 50'000, 3.14159265 / 6, 0.01);
  const auto samples = static_cast<double>(truth.surface().surfels().size());
  EXPECT_NEAR(samples, 4 * 3.14159265 * 1000, 100);
  // The analytic oracle, from both sides, whatever the normal that is given.
  for (const double radius : {0.93, 0.999, 1.0, 1.0004, 1.06})
    for (const Vec3 way : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(normalized(DVec3(1, 2, -3))),
                           Vec3(normalized(DVec3(-5, 1, 1)))}) {
      const Point p = way * static_cast<float>(radius);
      const double distance = std::fabs(length(DVec3(p)) - 1);
      EXPECT_NEAR(truth.distanceFromSurface(p, way, 0.1), distance, 1e-6) << radius;
      const double askew =
          truth.distanceFromSurface(p, Vec3(normalized(DVec3(way + Vec3(0.3f, 0.2f, 0)))), 0.1);
      EXPECT_GE(askew, distance - 1e-6) << "never less than the truth";
      EXPECT_LE(askew, 1.01 * distance + 1e-6) << "the nearest sample's normal is about right";
    }
}

TEST(DexelTruth, RefusesWhatIsNotThere) {
  const auto refused = [](const std::vector<implicit::Primitive>& primitives, const char* says) {
    try {
      (void)Truth(primitives, {.points = 1000, .density = 100}, {});
      ADD_FAILURE() << says;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  };
  refused({}, "positive primitive");
  refused({{{{0, 0, 0}, 1.0f}, Sign::Negative}}, "positive primitive");
  refused({{{{0, 0, 0}, 1.0f}, Sign::Positive}, {{{0, 0, 0}, 2.0f}, Sign::Negative}}, "0 are inside");
}

// The definition, point by point and element by element.
TEST(DexelMeasure, CountsWrongPointsAndDistancesAsTheDefinitionSays) {
  const Truth truth = ballTruth(20'000, 100);
  constexpr int kResolution = 11;
  std::vector<std::vector<points::Surfel>> elements;
  const std::vector<DexelMeasured> measured = measureAt(truth, kResolution, {.threads = 2}, &elements);
  ASSERT_EQ(measured.size(), 3u);
  ASSERT_EQ(elements.size(), 3u);
  const points::DexelGrid grid = points::dexelGridFor(truth.bounds(), {.resolution = kResolution});
  // In a ball a line's span is known without any container.
  const auto inBall = [](DVec3 p) { return dot(p, p) <= 1; };
  std::size_t wrong[3] = {};
  for (std::size_t i = 0; i < truth.points().size(); ++i) {
    const Point p = truth.points()[i];
    DVec3 near;
    for (int a = 0; a < 3; ++a) {
      double best = 1e9;
      for (int k = 0; k < kResolution; ++k) {
        const auto place = static_cast<double>(grid.at(a, k));
        if (std::fabs(place - static_cast<double>(p[a])) >= best) continue;
        best = std::fabs(place - static_cast<double>(p[a]));
        near[a] = place;
      }
    }
    int votes = 0;
    bool alongZ = false;
    for (int a = 0; a < 3; ++a) {
      DVec3 on = near;
      on[a] = static_cast<double>(p[a]);
      alongZ = inBall(on);
      votes += alongZ;
    }
    const bool truly = truth.sides()[i] == implicit::Side::Inside;
    wrong[0] += inBall(near) != truly;
    wrong[1] += alongZ != truly;
    wrong[2] += (votes >= 2) != truly;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const DexelMeasured& m = measured[k];
    SCOPED_TRACE(infoOf(kRepresentations[k]).name);
    EXPECT_EQ(m.representation, kRepresentations[k]);
    EXPECT_GT(wrong[k], 100u);
    EXPECT_EQ(m.wrongPoints, wrong[k]);
    EXPECT_DOUBLE_EQ(m.wrongVolume,
                     static_cast<double>(wrong[k]) / static_cast<double>(truth.pointsInside()));
    EXPECT_EQ(m.elements, elements[k].size());

    std::vector<double> coverage, accuracy;
    for (const points::Surfel& sample : truth.surface().surfels()) {
      double least = 1e9;
      for (const points::Surfel& e : elements[k])
        least = std::min(least, length(DVec3(e.position) - DVec3(sample.position)));
      coverage.push_back(least);
    }
    for (const points::Surfel& e : elements[k]) accuracy.push_back(std::fabs(length(DVec3(e.position)) - 1));
    for (auto* of : {&coverage, &accuracy}) {
      const Distances& d = of == &coverage ? m.coverage : m.accuracy;
      double sum = 0;
      for (const double x : *of) sum += x;
      // Of a face the axis is not the surface's normal: its distance is found to a part of a thousand.
      EXPECT_NEAR(d.mean, sum / static_cast<double>(of->size()), 1e-3 * m.cell);
      EXPECT_NEAR(d.most, *std::ranges::max_element(*of), 1e-2 * m.cell);
      const auto above = std::ranges::count_if(*of, [&](double x) { return x > d.high + 1e-2 * m.cell; });
      EXPECT_LE(static_cast<double>(above), 0.011 * static_cast<double>(of->size()));
    }
  }
}

TEST(DexelMeasure, CountsBytesLinesAndElements) {
  const Truth truth = ballTruth(1000, 100);
  const std::vector<DexelMeasured> measured = measureAt(truth, 32, {});
  EXPECT_EQ(measured[0].bytes, 32u * 32 * 32 / 8) << "a bit a voxel";
  EXPECT_FALSE(measured[0].bytesWithoutOperations);
  EXPECT_EQ(measured[0].lines, 0u);
  EXPECT_EQ(measured[1].lines, 1024u);
  EXPECT_EQ(measured[2].lines, 3072u);
  EXPECT_GE(measured[1].bytes, 36u * 1024);
  EXPECT_LE(*measured[1].bytesWithoutOperations + 16 * 1024, measured[1].bytes);
  EXPECT_EQ(measured[2].elements, 3 * measured[1].elements) << "a ball is alike along all axes";
  // Two ends on each line through the disc, half of its axis-parallel faces.
  EXPECT_NEAR(static_cast<double>(measured[1].elements), 2 * 3.14159 * 256, 60);
  EXPECT_NEAR(static_cast<double>(measured[0].elements), static_cast<double>(measured[2].elements), 300);
}

TEST(DexelMeasure, D11OneFamilyLeavesGapsWhereTheSurfaceRunsAlongItAndThreeFamiliesClose) {
  const Truth truth = ballTruth(1000, 2000);
  for (const int n : {16, 32, 64}) {
    const std::vector<DexelMeasured> m = measureAt(truth, n, {});
    EXPECT_LT(m[2].coverage.most, 1.25 * m[2].cell) << n;
    EXPECT_GT(m[1].coverage.most, 1.7 * m[2].coverage.most) << n;
    EXPECT_LT(m[2].accuracy.most, 1e-3 * m[2].cell) << "ends are on the surface";
    EXPECT_NEAR(m[0].accuracy.mean, m[0].cell / 6, 0.01 * m[0].cell) << "faces of voxels are not";
    EXPECT_LT(m[0].accuracy.most, 0.501 * m[0].cell);
  }
}

TEST(DexelSlice, OfTheBallIsWhatItSaysItIs) {
  std::istringstream table(sliceTable(14));
  std::string text;
  std::getline(table, text);
  EXPECT_EQ(text, "kind,x0,y0,x1,y1");
  std::map<std::string, std::size_t> count;
  double radius = 0, cell = 0;
  while (std::getline(table, text)) {
    std::ranges::replace(text, ',', ' ');
    std::istringstream words(text);
    std::string kind;
    double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    words >> kind >> x0 >> y0 >> x1 >> y1;
    ++count[kind];
    if (kind == "disc") radius = x1;
    if (kind == "cells") cell = x0;
    if (kind == "column" || kind == "row") {
      EXPECT_NEAR(std::hypot(x0, y0), radius, 1e-6) << "ends are on the circle";
      EXPECT_NEAR(std::hypot(x1, y1), radius, 1e-6);
      EXPECT_EQ(kind == "column" ? x0 : y0, kind == "column" ? x1 : y1) << "along its axis";
    }
    if (kind == "end") {
      EXPECT_NEAR(std::hypot(x0, y0), radius, 1e-6);
      EXPECT_GT(x0 * x1 + y0 * y1, 0.98) << "normals point out of the ball";
    }
    if (kind == "cell") {
      EXPECT_LE(std::hypot((x0 + x1) / 2, (y0 + y1) / 2), radius) << "middles are inside";
    }
  }
  EXPECT_NEAR(cell, 2.0 / 14, 1e-6);
  EXPECT_EQ(count["column"], 14u);
  EXPECT_EQ(count["row"], 14u);
  EXPECT_EQ(count["end"], 56u);
  EXPECT_NEAR(static_cast<double>(count["cell"]), 3.14159 * 49, 8);
}

DexelOptions tiny() {
  DexelOptions options;
  if (restroke::testing::kSanitized) options.points = 20'000;
  options = smokeSize(options);
  options.pictureSize = 64;
  return options;
}

const DexelResults& smoke() {
  static const DexelResults results = measureDexels(defaultDexelLogs(true), tiny(), {.threads = 2});
  return results;
}

const DexelMeasured& measuredOf(const std::string& source, Representation representation, int resolution) {
  for (const DexelRow& row : smoke().rows)
    if (row.source == source && row.measured.representation == representation && row.resolution == resolution)
      return row.measured;
  throw InternalError("no such row");
}

void everySolidIsMeasuredEveryWayAtEveryResolution() {
  EXPECT_EQ(sourcesOf(smoke()), (std::vector<std::string>{"ball", "gallery"}));
  std::set<std::string> seen;
  for (const DexelRow& row : smoke().rows)
    EXPECT_TRUE(seen.insert(fmt::format("{} {} {}", row.source, row.resolution,
                                        infoOf(row.measured.representation).name))
                    .second);
  EXPECT_EQ(seen.size(), 2u * 3 * 3);
  EXPECT_EQ(smoke().pictures.size(), 2u * 3);
}

void errorsFallWithResolution() {
  for (const std::string source : {"ball", "gallery"})
    for (const Representation representation : kRepresentations) {
      SCOPED_TRACE(source + " " + infoOf(representation).name);
      for (const int n : {8, 16}) {
        const DexelMeasured &coarse = measuredOf(source, representation, n),
                            &fine = measuredOf(source, representation, 2 * n);
        // With the fewer random points of sanitized builds the gallery is close to this.
        EXPECT_LT(fine.wrongVolume, (restroke::testing::kSanitized ? 0.9 : 0.8) * coarse.wrongVolume);
        // One family need not come nearer: a side that runs along it stays bare.
        if (representation != Representation::OneFamily) {
          EXPECT_LT(fine.coverage.mean, 0.8 * coarse.coverage.mean);
        }
        EXPECT_GT(fine.bytes, coarse.bytes);
      }
    }
}

void threeFamiliesLeaveSmallerGapsThanOne() {
  for (const std::string source : {"ball", "gallery"})
    for (const int n : {8, 16, 32}) {
      const DexelMeasured &one = measuredOf(source, Representation::OneFamily, n),
                          &three = measuredOf(source, Representation::ThreeFamilies, n);
      EXPECT_LT(three.coverage.most, one.coverage.most) << source << " " << n;
      EXPECT_LT(three.coverage.mean, one.coverage.mean) << source << " " << n;
    }
}

void theSameSeedGivesTheSameFiguresAtAnyNumberOfThreads() {
  const DexelResults again = measureDexels({}, tiny(), {.threads = 1});
  DexelOptions otherSeed = tiny();
  otherSeed.seed = 2;
  const DexelResults other = measureDexels({}, otherSeed, {.threads = 8});
  bool differs = false;
  ASSERT_EQ(again.rows.size(), 9u);
  for (std::size_t i = 0; i < again.rows.size(); ++i) {
    const DexelMeasured &a = smoke().rows[i].measured, &b = again.rows[i].measured;
    EXPECT_EQ(a.wrongPoints, b.wrongPoints);
    EXPECT_EQ(a.bytes, b.bytes);
    EXPECT_EQ(a.coverage.mean, b.coverage.mean);
    EXPECT_EQ(a.coverage.high, b.coverage.high);
    EXPECT_EQ(a.accuracy.mean, b.accuracy.mean);
    EXPECT_EQ(a.accuracy.most, b.accuracy.most);
    differs = differs || other.rows[i].measured.wrongPoints != b.wrongPoints;
  }
  EXPECT_TRUE(differs) << "another seed has other points";
}

void saysWhatHoldsAndWhatWasNotTried() {
  const std::vector<Claim> all = claims(smoke());
  ASSERT_EQ(all.size(), 7u);
  for (std::size_t i = 0; i < all.size(); ++i) {
    SCOPED_TRACE(all[i].text);
    if (all[i].text.starts_with("what is on the wrong side")) {
      EXPECT_FALSE(all[i].holds) << "a finest resolution of 32 is too coarse to tell";
      EXPECT_TRUE(all[i].measured.empty());
    } else {
      EXPECT_EQ(all[i].holds, !all[i].text.starts_with("the paper"))
          << "voxels of a bit are small while n is";
      EXPECT_FALSE(all[i].measured.empty());
    }
  }
  // Nothing measured, nothing claimed.
  for (const Claim& claim : claims(DexelResults{})) EXPECT_FALSE(claim.holds) << claim.text;
}

void writesWhatItPromises() {
  const Folder folder;
  const std::vector<std::string> files = writeDexels(smoke(), tiny(), folder.path());
  for (const char* name : {"results.csv", "results.json", "manifest.json", "report.html", "figure1.csv",
                           "figure1.png", "figure1.svg", "dexel-ball.png", "dexel-ball.svg",
                           "dexel-gallery.png", "ball-32-voxels.png", "gallery-32-one-family.png"})
    EXPECT_NE(std::ranges::find(files, name), files.end()) << name;
  for (const std::string& name : files) EXPECT_GT(fs::file_size(folder.path() / name), 0u) << name;

  const auto json = nlohmann::json::parse(bytesOfFile(folder.path() / "results.json"));
  ASSERT_EQ(json.at("rows").size(), smoke().rows.size());
  for (const char* key : {"source",
                          "primitives",
                          "representation",
                          "axis",
                          "resolution",
                          "cell",
                          "lines",
                          "elements",
                          "bytes",
                          "bytes_without_operations",
                          "bytes_per_line",
                          "bytes_per_end",
                          "wrong_volume",
                          "coverage_mean",
                          "coverage_p99",
                          "coverage_max",
                          "coverage_max_cells",
                          "accuracy_mean_cells",
                          "accuracy_max",
                          "surface_samples",
                          "revision",
                          "dirty",
                          "compiler",
                          "options_hash",
                          "seed"})
    EXPECT_TRUE(json["rows"][0].contains(key)) << key;
  const std::string csv = bytesOfFile(folder.path() / "results.csv");
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(csv, '\n')), smoke().rows.size() + 1);
  EXPECT_EQ(csv.find("inf"), std::string::npos);
  EXPECT_EQ(csv.find("nan"), std::string::npos);

  const auto manifest = nlohmann::json::parse(bytesOfFile(folder.path() / "manifest.json"));
  EXPECT_EQ(manifest.at("inputs").at(0).at("hash"), hashOfFile(kExamples / "gallery.log"));
  EXPECT_EQ(manifest.at("options_hash"), hexHash(describe(tiny())));
  EXPECT_EQ(manifest.at("claims").size(), claims(smoke()).size());

  const std::string page = bytesOfFile(folder.path() / "report.html");
  EXPECT_EQ(page.find("http"), std::string::npos);
  EXPECT_EQ(page.find("<script"), std::string::npos);
  for (const char* word :
       {"Promised and measured", "figure 1", "gallery", "three families", "How it was measured"})
    EXPECT_NE(page.find(word), std::string::npos) << word;
  const std::string table = dexelTable(smoke());
  for (const char* word :
       {"ball: 1 primitive,", "gallery: 23 primitives,", "one-family", "coverage", "every end of a dexel"})
    EXPECT_NE(table.find(word), std::string::npos) << word;
}

TEST(Dexel, RefusesBadResolutionsAndWhatIsNoLog) {
  const Folder folder;
  const auto refused = [](const std::vector<fs::path>& logs, const DexelOptions& options, const char* says) {
    try {
      (void)measureDexels(logs, options);
      ADD_FAILURE() << says;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  };
  const auto with = [](std::vector<int> resolutions) {
    DexelOptions options = tiny();
    options.resolutions = std::move(resolutions);
    return options;
  };
  refused({}, with({}), "0 resolutions");
  refused({}, with({16, 7}), "the resolution is 7");
  refused({}, with({8, 2048}), "the resolution is 2048");
  refused({}, with({16, 16}), "must ascend");
  DexelOptions none = tiny();
  none.points = 0;
  refused({}, none, "0 points");
  const fs::path garbage = folder.path() / "garbage.log", hollow = folder.path() / "hollow.stamps";
  std::ofstream(garbage) << "hello\n";
  std::ofstream(hollow) << "B 0 0 0 1\nS -1 1\n0 0 0 1.5\n";
  refused({folder.path() / "absent.log"}, tiny(), "absent.log");
  refused({garbage}, tiny(), "garbage.log");
  refused({hollow}, tiny(), "hollow");
}

TEST(Dexel, StampListsAreMeasuredAndTwoOfOneNameToldApart) {
  const Folder one, two;
  std::ofstream(one.path() / "dent.stamps") << "B 0 0 0 1\nS -1 1\n0 0 1 0.5\n";
  std::ofstream(two.path() / "dent.stamps") << "B 0 0 0 1\nS -1 2\n0 0 1 0.5\n0 1 0 0.5\n";
  DexelOptions options = tiny();
  options.resolutions = {8};
  options.points = 1000;
  options.pictureSize = 0;
  const DexelResults results =
      measureDexels({one.path() / "dent.stamps", two.path() / "dent.stamps"}, options);
  EXPECT_EQ(sourcesOf(results), (std::vector<std::string>{"ball", "dent", "dent-2"}));
  ASSERT_EQ(results.rows.size(), 9u);
  EXPECT_EQ(results.rows[3].primitives, 2u);
  EXPECT_EQ(results.rows[6].primitives, 3u);
  EXPECT_TRUE(results.pictures.empty());
}

TEST(Dexel, OptionsThatChangeTheResultChangeItsHash) {
  DexelOptions other;
  other.seed = 2;
  EXPECT_NE(describe(DexelOptions{}), describe(other));
  other = {};
  other.resolutions.pop_back();
  EXPECT_NE(describe(DexelOptions{}), describe(other));
}

// One test for all of them: each test is a process of its own, and the run takes seconds.
TEST(Dexel, D11TheSmokeRunMeasuresEverySolidAndWritesWhatItPromises) {
  const auto check = [](const char* what, void (*expectations)()) {
    SCOPED_TRACE(what);
    expectations();
  };
  check("everySolidIsMeasuredEveryWayAtEveryResolution", everySolidIsMeasuredEveryWayAtEveryResolution);
  check("errorsFallWithResolution", errorsFallWithResolution);
  check("threeFamiliesLeaveSmallerGapsThanOne", threeFamiliesLeaveSmallerGapsThanOne);
  check("theSameSeedGivesTheSameFiguresAtAnyNumberOfThreads",
        theSameSeedGivesTheSameFiguresAtAnyNumberOfThreads);
  check("saysWhatHoldsAndWhatWasNotTried", saysWhatHoldsAndWhatWasNotTried);
  check("writesWhatItPromises", writesWhatItPromises);
}

}  // namespace
}  // namespace restroke::experiments
