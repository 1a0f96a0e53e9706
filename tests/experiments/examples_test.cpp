// The logs that ship with the project: what they promise, and that the program still makes them.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "experiments/examples/example_logs.h"
#include "experiments/paper_table.h"
#include "experiments/provenance.h"
#include "implicit/errors.h"
#include "sculpt/document.h"

namespace restroke::experiments {
namespace {

namespace fs = std::filesystem;

const fs::path kExamples = fs::path(RESTROKE_SOURCE_DIR) / "experiments" / "examples";

struct Replayed {
  std::vector<std::size_t> stamps;  // per stroke
  std::size_t misses = 0;
  std::set<sculpt::Mode> modes;
  std::size_t cameras = 0;
  std::size_t surfels = 0;
};

Replayed replay(const sculpt::StrokeLog& log) {
  Replayed result;
  std::vector<Camera> cameras;
  sculpt::Document document(log.header);
  for (const sculpt::Command& command : log.commands) {
    const sculpt::CommandReport report = document.apply(command);
    result.stamps.push_back(report.primitivesAdded);
    result.misses += report.misses;
    const auto* stroke = std::get_if<sculpt::StrokeCommand>(&command);
    if (stroke == nullptr) continue;
    result.modes.insert(stroke->brush.mode);
    if (std::find(cameras.begin(), cameras.end(), stroke->stroke.camera) == cameras.end())
      cameras.push_back(stroke->stroke.camera);
  }
  result.cameras = cameras.size();
  result.surfels = document.model().surfelCount();
  return result;
}

TEST(ShippedLogs, S12Table2HasExactlyThePapersStamps) {
  const Replayed result = replay(sculpt::readLog(kExamples / "table2.log"));
  EXPECT_EQ(result.stamps, (std::vector<std::size_t>{454, 1, 1, 1, 1, 1, 96, 1}));
  EXPECT_TRUE(isPaperTable2(result.stamps));
  EXPECT_EQ(result.misses, 0u);
}

TEST(ShippedLogs, S11PaperScaleHas108StrokesAnd3426Stamps) {
  const Replayed result = replay(sculpt::readLog(kExamples / "paper-scale.log"));
  EXPECT_EQ(result.stamps.size(), 108u);
  std::size_t sum = 0;
  for (const std::size_t n : result.stamps) sum += n;
  EXPECT_EQ(sum, 3426u);
  EXPECT_EQ(result.modes.size(), 2u) << "it is to add and to carve";
  EXPECT_GE(result.cameras, 12u);
  EXPECT_GE(result.surfels, 270'000u);
  EXPECT_LE(result.surfels, 290'000u);
}

TEST(ShippedLogs, S9RabbitIsAFoundationThenAFace) {
  const sculpt::StrokeLog log = sculpt::readLog(kExamples / "rabbit.log");
  const Replayed result = replay(log);
  for (std::size_t i = 0; i < result.stamps.size(); ++i)
    EXPECT_GT(result.stamps[i], 0u) << "stroke " << i + 1;
  // Foundation: nothing but added strokes, then the first carved one opens the face.
  std::size_t added = 0;
  while (added < log.commands.size() &&
         std::get<sculpt::StrokeCommand>(log.commands[added]).brush.mode == sculpt::Mode::Add)
    ++added;
  EXPECT_GE(added, 10u);
  EXPECT_LT(added, log.commands.size());
  EXPECT_GE(result.cameras, 3u);
}

TEST(ShippedLogs, AreWhatTheProgramMakes) {
  const fs::path folder = fs::temp_directory_path() / ("restroke-examples-" + std::to_string(::getpid()));
  fs::create_directories(folder);
  for (const char* name : {"table2", "paper-scale", "rabbit", "figure10", "gallery"}) {
    const fs::path made = folder / (std::string(name) + ".log");
    sculpt::writeLog(made, exampleLog(name));
    // Not EXPECT_EQ on the bytes: a difference would print a hundred kilobytes.
    EXPECT_EQ(hashOfFile(made), hashOfFile(kExamples / made.filename())) << name;
  }
  fs::remove_all(folder);
}

TEST(ShippedLogs, AreSmall) {
  std::uintmax_t bytes = 0;
  for (const char* name : {"table2.log", "paper-scale.log", "rabbit.log", "figure10.log", "gallery.log"})
    bytes += fs::file_size(kExamples / name);
  EXPECT_LT(bytes, 1'000'000u);
}

TEST(ExampleLog, RefusesANameThatItDoesNotKnow) {
  EXPECT_THROW((void)exampleLog("hare"), InputError);
  EXPECT_THROW((void)exampleLog(""), InputError);
}

}  // namespace
}  // namespace restroke::experiments
