// The scaling experiment at its smoke size, and the lists that it is made of (SPEC S4, S11, X1).

#include "experiments/scaling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "experiments/output.h"
#include "experiments/scaling/report.h"
#include "implicit/errors.h"
#include "implicit/process_memory.h"
#include "tests/experiments/folder.h"
#include "tests/support/effort.h"

namespace restroke::experiments {
namespace {

namespace fs = std::filesystem;
using implicit::Primitive;
using implicit::Sign;

const fs::path kExamples = fs::path(RESTROKE_SOURCE_DIR) / "experiments" / "examples";

std::vector<Primitive> allOf(const Layout& layout) {
  std::vector<Primitive> all = layout.bases;
  for (std::size_t k = 0; k < layout.strokes; ++k) {
    const std::vector<Primitive> stroke = layout.stroke(k);
    all.insert(all.end(), stroke.begin(), stroke.end());
  }
  return all;
}

double reach(const Primitive& a, const Primitive& b) {
  return static_cast<double>(length(a.shape.ball().center - b.shape.ball().center)) -
         static_cast<double>(a.shape.ball().radius) - static_cast<double>(b.shape.ball().radius);
}

/// Mean number of primitives of the list that a further stroke's stamp meets, every pair tried.
double crowdingOf(const Layout& layout) {
  const std::vector<Primitive> all = allOf(layout);
  std::size_t met = 0, stamps = 0;
  for (std::size_t k = layout.strokes; k < layout.strokes + 12; ++k)
    for (const Primitive& stamp : layout.stroke(k)) {
      ++stamps;
      met += static_cast<std::size_t>(
          std::ranges::count_if(all, [&](const Primitive& p) { return reach(stamp, p) < 0; }));
    }
  return static_cast<double>(met) / static_cast<double>(stamps);
}

TEST(ScalingLayouts, S4AStampMeetsAsManyInAListThirtyTimesAsLong) {
  for (Layout (*const layout)(std::size_t, std::uint64_t) : {extentLayout, detailLayout}) {
    const double small = crowdingOf(layout(1000, 3)), large = crowdingOf(layout(30'000, 3));
    EXPECT_GT(small, 5) << "strokes cross, and there is a base";
    EXPECT_LT(small, 25);
    EXPECT_NEAR(large / small, 1, 0.25) << small << " and " << large;
  }
}

TEST(ScalingLayouts, AStampHasAsManySamplesAtEverySize) {
  for (Layout (*const layout)(std::size_t, std::uint64_t) : {extentLayout, detailLayout})
    for (const std::size_t n : {std::size_t{1000}, std::size_t{1'000'000}}) {
      const Layout made = layout(n, 1);
      const auto samples = implicit::sampleCount(made.stroke(0).front().shape, made.density);
      EXPECT_NEAR(samples, 448, 16);
    }
}

TEST(ScalingLayouts, PebblesDoNotMeetEachOthersStamps) {
  const Layout layout = extentLayout(5000, 1);
  ASSERT_EQ(layout.bases.size(), 5u);
  std::map<std::size_t, std::size_t> stampsOf;
  for (std::size_t k = 0; k < layout.strokes; ++k)
    for (const Primitive& stamp : layout.stroke(k)) {
      std::size_t met = 0;
      for (std::size_t b = 0; b < layout.bases.size(); ++b)
        if (reach(stamp, layout.bases[b]) < 0) {
          ++met;
          ++stampsOf[b];
        }
      ASSERT_EQ(met, 1u);
    }
  const auto [least, most] =
      std::ranges::minmax_element(stampsOf, {}, [](const auto& e) { return e.second; });
  EXPECT_LE(most->second - least->second, kStrokeStamps) << "one stroke more or less";
}

TEST(ScalingLayouts, EveryKindMixesSignsAndIsAcceptedWhole) {
  for (const Layout& layout : {extentLayout(3000, 1), detailLayout(3000, 1), crowdedLayout(1000, 0.1, 1),
                               spreadLayout(2000, 10'000, 1)}) {
    std::size_t added = 0, carved = 0;
    for (const Primitive& p : allOf(layout)) {
      EXPECT_NO_THROW(implicit::validate(p));
      ++(p.sign == Sign::Positive ? added : carved);
    }
    EXPECT_GT(carved, added / 2);
    EXPECT_GT(added, carved / 2);
    for (std::size_t k = 0; k < 4; ++k) {
      const std::vector<Primitive> stroke = layout.stroke(k);
      ASSERT_EQ(stroke.size(), kStrokeStamps);
      for (std::size_t i = 1; i < stroke.size(); ++i) {
        EXPECT_EQ(stroke[i].sign, stroke[0].sign);
        const auto r = static_cast<double>(stroke[i].shape.ball().radius);
        const auto step =
            static_cast<double>(length(stroke[i].shape.ball().center - stroke[i - 1].shape.ball().center));
        // float32 places the smallest ones, a 16,384th of the sphere, to a thousandth of their radius.
        EXPECT_NEAR(step / r, kStampSpacing, 0.02);
      }
    }
  }
}

TEST(ScalingLayouts, StampsOfACapLieOnItAndOnEachOther) {
  const double cap = 0.1;
  const Layout layout = crowdedLayout(2000, cap, 1);
  for (const Primitive& stamp : allOf(layout)) {
    if (stamp == layout.bases[0]) continue;
    const Vec3 fromMiddle = stamp.shape.ball().center - Point(0, 0, 1);
    EXPECT_LE(length(fromMiddle), cap * 1.1);
  }
  EXPECT_GT(crowdingOf(layout), 200) << "a tenth of all";
  EXPECT_GT(crowdingOf(layout), 10 * crowdingOf(crowdedLayout(2000, 2, 1)));
}

TEST(ScalingLayouts, RadiiReallySpanWhatTheySay) {
  for (const double spread : {1.0, 10.0, 10'000.0}) {
    const Layout layout = spreadLayout(4000, spread, 1);
    double least = 1e9, most = 0, square = 0;
    std::size_t below = 0, count = 0;
    for (std::size_t k = 0; k < layout.strokes; ++k) {
      const auto r = static_cast<double>(layout.stroke(k).front().shape.ball().radius);
      least = std::min(least, r);
      most = std::max(most, r);
      square += r * r;
      ++count;
      below += r < std::sqrt(radiiOf(spread).least * radiiOf(spread).most);
    }
    EXPECT_LE(most / least, spread * 1.001);
    EXPECT_GE(most / least, std::pow(spread, 0.95)) << "of 125 strokes the outermost are near the ends";
    if (spread > 1) {
      EXPECT_NEAR(static_cast<double>(below) / static_cast<double>(count), 0.5, 0.05) << "log-uniform";
    }
    EXPECT_NEAR(std::sqrt(square / static_cast<double>(count)), 0.15, 0.01) << "the mean area is kept";
  }
}

TEST(ScalingLayouts, TheSameSeedGivesTheSameStrokesInAnyOrder) {
  const auto make = [](std::uint64_t seed) {
    return std::vector<Layout>{extentLayout(2000, seed), detailLayout(2000, seed),
                               crowdedLayout(2000, 0.2, seed), spreadLayout(2000, 100, seed)};
  };
  const std::vector<Layout> one = make(1), again = make(1), other = make(2);
  for (std::size_t i = 0; i < one.size(); ++i) {
    for (std::size_t k = one[i].strokes; k-- > 0;) EXPECT_EQ(one[i].stroke(k), again[i].stroke(k));
    EXPECT_NE(one[i].stroke(5), other[i].stroke(5));
    std::set<float> starts;
    for (std::size_t k = 0; k < one[i].strokes; ++k)
      starts.insert(one[i].stroke(k).front().shape.ball().center.x);
    EXPECT_EQ(starts.size(), one[i].strokes) << "no two strokes are the same";
  }
}

TEST(ScalingLayouts, AShippedListComesBackStrokeByStroke) {
  const Layout layout = listLayout(kExamples / "paper-scale.log");
  EXPECT_EQ(layout.strokes, 108u);
  EXPECT_EQ(layout.bases.size(), 1u);
  EXPECT_EQ(allOf(layout).size(), 3427u);
  EXPECT_FALSE(layout.endless);
}

TEST(ProcessMemory, GrowsWithWhatIsTouchedAndItsPeakCanBeginAnew) {
  if (restroke::testing::kSanitized) GTEST_SKIP() << "sanitizers keep what is freed";
  constexpr std::size_t kBlock = 64'000'000;
  resetPeak();
  const std::size_t before = peakResidentBytes();
  {
    const std::vector<char> block(kBlock, 1);
    [[maybe_unused]] const char* volatile used = block.data();  // clang leaves out what nobody can see
    EXPECT_GT(residentBytes(), kBlock);
  }
  EXPECT_GE(peakResidentBytes(), before + kBlock / 2);
  resetPeak();
  EXPECT_LT(peakResidentBytes(), before + kBlock / 2);
  ASSERT_TRUE(availableBytes().has_value());
  EXPECT_GT(*availableBytes(), 1'000'000u);
}

ScalingOptions tiny() {
  ScalingOptions options;
  if (restroke::testing::kSanitized) {
    options.most = 1000;
    options.surfels = {10'000};
    options.crowd = options.spreadPrimitives = 300;
  }
  options = smokeSize(options);
  options.measure.width = 96;
  options.measure.height = 54;
  options.measure.stamps = 64;
  options.measure.undos = 3;
  return options;
}

const ScalingResults& smoke() {
  static const ScalingResults results = measureScaling(defaultScalingLogs(), tiny(), {.threads = 2});
  return results;
}

void everySweepIsMeasuredAtEverySize() {
  std::map<Sweep, std::set<double>> values;
  for (const ScalingRow& row : smoke().rows) {
    EXPECT_TRUE(values[row.sweep].insert(row.value).second);
    EXPECT_EQ(row.source.empty(), row.sweep != Sweep::Surfels);
  }
  EXPECT_EQ(values.size(), std::size(kSweeps));
  for (const auto& [sweep, of] : values)
    EXPECT_GE(of.size(), restroke::testing::kSanitized ? 1u : 2u) << infoOf(sweep).name;
  EXPECT_TRUE(smoke().notes.empty()) << smoke().notes.front();
}

void everyFigureIsThere() {
  for (const ScalingRow& row : smoke().rows) {
    const Measured& m = row.measured;
    SCOPED_TRACE(fmt::format("{} {}", infoOf(row.sweep).name, row.value));
    EXPECT_GT(m.surfels, 0u);
    EXPECT_GE(m.timedStamps, kStrokeStamps);
    EXPECT_GT(m.stampMedian, 0);
    EXPECT_GE(m.stampHigh, m.stampMedian);
    EXPECT_GE(m.undone, 1u);
    EXPECT_GE(m.undoHigh, m.undoMedian);
    EXPECT_GT(m.rebuild, 0);
    EXPECT_GT(m.rebuildOne, 0);
    EXPECT_GT(m.raysASecond, 0);
    EXPECT_GT(m.raysPrefixed, 0);
    EXPECT_GT(m.rayHits, 0.2) << "the shape fills the picture";
    EXPECT_TRUE(m.listing && m.picture);
    EXPECT_GT(m.bytes.total(), 20 * m.primitives);
    EXPECT_GE(m.peakResident, m.bytes.total());
    EXPECT_GT(m.met, 1);
    EXPECT_GE(m.metMost, m.met);
  }
}

void densitiesGiveTheSurfelsThatWereAskedFor() {
  for (const ScalingRow& row : smoke().rows)
    if (row.sweep == Sweep::Surfels) {
      EXPECT_NEAR(static_cast<double>(row.measured.surfels) / row.value, 1, 0.15);
    }
}

void rowsAreReplayedToTheSameStateAtAnyNumberOfThreads() {
  // One small list is enough: tests/determinism has the rest.
  const ScalingRow& row = smoke().rows.front();
  ScalingOptions options = tiny();
  const Measured again = measure(extentLayout(1000, options.seed), options.measure, {.threads = 1});
  EXPECT_EQ(again.stateHash, row.measured.stateHash);
  EXPECT_NE(measure(extentLayout(1000, 7), options.measure, {.threads = 1}).stateHash,
            row.measured.stateHash);
}

void writesWhatItPromises() {
  const Folder folder;
  const std::vector<std::string> files = writeScaling(smoke(), tiny(), folder.path());
  for (const char* name :
       {"results.csv", "results.json", "manifest.json", "report.html", "scaling-primitives.png",
        "scaling-primitives.svg", "scaling-surfels.svg", "scaling-crowding.png", "scaling-spread.png"})
    EXPECT_NE(std::ranges::find(files, name), files.end()) << name;
  EXPECT_EQ(std::ranges::count_if(files, [](const std::string& f) { return f.ends_with("-whole.png"); }), 2);
  for (const std::string& name : files) EXPECT_GT(fs::file_size(folder.path() / name), 0u) << name;

  const auto json = nlohmann::json::parse(bytesOfFile(folder.path() / "results.json"));
  ASSERT_EQ(json.at("rows").size(), smoke().rows.size());
  for (const char* key : {"sweep",
                          "source",
                          "parameter",
                          "value",
                          "primitives",
                          "surfels",
                          "density",
                          "least_radius",
                          "most_radius",
                          "met",
                          "stamp_us_p50",
                          "stamp_us_p99",
                          "replay_s",
                          "undo_ms_p50",
                          "undo_ms_p99",
                          "rebuild_1_ms",
                          "rebuild_ms",
                          "rays_per_s",
                          "rays_per_s_prefix",
                          "ray_hits",
                          "listing_ms",
                          "picture_ms",
                          "list_bytes",
                          "cluster_bytes",
                          "surfel_bytes",
                          "table_bytes",
                          "bytes_per_primitive",
                          "bytes_per_surfel",
                          "peak_resident_bytes",
                          "state_hash",
                          "simd",
                          "threads",
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
  EXPECT_EQ(manifest.at("inputs").at(0).at("hash"), hashOfFile(kExamples / "paper-scale.log"));
  EXPECT_EQ(manifest.at("options_hash"), hexHash(describe(tiny())));
  EXPECT_EQ(manifest.at("claims").size(), claims(smoke()).size());

  const std::string page = bytesOfFile(folder.path() / "report.html");
  EXPECT_EQ(page.find("http"), std::string::npos);
  EXPECT_EQ(page.find("src=\"data:"), page.find("src="));
  EXPECT_EQ(page.find("<script"), std::string::npos);
  for (const char* word :
       {"Promised and measured", "Growth", "pebbles", "What it looks like", "bytes a surfel"})
    EXPECT_NE(page.find(word), std::string::npos) << word;
}

TEST(Scaling, WhatMemoryDoesNotSufficeForIsLeftOutWithAReason) {
  // A list of 10^12 primitives is more than any machine holds; it is not begun.
  ScalingOptions options = tiny();
  options.sweeps = {Sweep::Spread};
  options.spreadPrimitives = 1'000'000'000'000;
  const ScalingResults results = measureScaling({}, options);
  EXPECT_EQ(results.notes.size(), 3u) << "one for each spread";
  for (const std::string& note : results.notes) {
    EXPECT_NE(note.find("spread"), std::string::npos) << note;
    EXPECT_NE(note.find("GB"), std::string::npos) << note;
  }
  EXPECT_TRUE(results.rows.empty());
}

TEST(Scaling, WhatTheSamplingRefusesIsLeftOutWithAReason) {
  ScalingOptions options = tiny();
  options.sweeps = {Sweep::Surfels};
  options.surfels = {1'000'000'000};
  const ScalingResults results = measureScaling(defaultScalingLogs(), options);
  ASSERT_EQ(results.notes.size(), 1u);
  EXPECT_NE(results.notes[0].find("paper-scale.log, surfels 1,000,000,000"), std::string::npos)
      << results.notes[0];
  EXPECT_NE(results.notes[0].find("67108864"), std::string::npos) << results.notes[0];
}

TEST(Scaling, RefusesWhatIsNoLogAndWhatHasNoStrokes) {
  const Folder folder;
  const fs::path bare = folder.path() / "bare.stamps", garbage = folder.path() / "garbage.log";
  std::ofstream(bare) << "B 0 0 0 1\nS 1 1\n0 0 1 0.1\n";
  std::ofstream(garbage) << "hello\n";
  for (const fs::path& file : {bare, garbage, folder.path() / "absent.log"}) {
    try {
      (void)measureScaling({file}, tiny());
      ADD_FAILURE() << file << " was accepted";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(file.filename().string()), std::string::npos) << error.what();
    }
  }
}

TEST(Scaling, OptionsThatChangeTheResultChangeItsHash) {
  ScalingOptions other;
  other.seed = 2;
  EXPECT_NE(describe(ScalingOptions{}), describe(other));
  other = {};
  other.sweeps = {Sweep::Extent};
  EXPECT_NE(describe(ScalingOptions{}), describe(other));
}

// One test for all of them: each test is a process of its own, and the run takes seconds.
TEST(Scaling, S4S11X1TheSmokeRunMeasuresEverySizeAndWritesWhatItPromises) {
  const auto check = [](const char* what, void (*expectations)()) {
    SCOPED_TRACE(what);
    expectations();
  };
  check("everySweepIsMeasuredAtEverySize", everySweepIsMeasuredAtEverySize);
  check("everyFigureIsThere", everyFigureIsThere);
  check("densitiesGiveTheSurfelsThatWereAskedFor", densitiesGiveTheSurfelsThatWereAskedFor);
  check("rowsAreReplayedToTheSameStateAtAnyNumberOfThreads",
        rowsAreReplayedToTheSameStateAtAnyNumberOfThreads);
  check("writesWhatItPromises", writesWhatItPromises);
}

}  // namespace
}  // namespace restroke::experiments
