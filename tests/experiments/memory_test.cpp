// The memory experiment at its smoke size (SPEC S12, X3).

#include "experiments/memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "experiments/figures.h"
#include "experiments/paper_table.h"
#include "experiments/provenance.h"
#include "implicit/errors.h"
#include "sculpt/stroke_log.h"
#include "tests/experiments/folder.h"

namespace restroke::experiments {
namespace {

namespace fs = std::filesystem;

const fs::path kExamples = fs::path(RESTROKE_SOURCE_DIR) / "experiments" / "examples";

fs::path stampFile(const Folder& folder, const std::string& name, const std::string& text) {
  const fs::path file = folder.path() / name;
  std::ofstream(file) << text;
  return file;
}

const MemoryRow& row(const MemoryStep& step, const std::string& backend) {
  const auto it = std::ranges::find(step.rows, backend, &MemoryRow::backend);
  if (it == step.rows.end()) throw std::out_of_range("no row " + backend);
  return *it;
}

const MemoryLog& table2() {
  static const MemoryLog log = measureMemory(kExamples / "table2.log", smokeSize({}));
  return log;
}

TEST(Memory, S12StrokesAreBelowThePapersAtEveryStepOfTable2) {
  ASSERT_EQ(table2().steps.size(), 9u);
  std::size_t paper = 0;
  for (std::size_t i = 1; i <= 8; ++i) {
    const MemoryStep& step = table2().steps[i];
    paper += paperStrokeBytes(step.stamps);
    EXPECT_LT(row(step, "strokes").bytes, paper) << "step " << i;
    EXPECT_GT(row(step, "strokes").bytes, 0u);
  }
}

TEST(Memory, S12ThePapersEightPairsStandBesideTheMeasuredOnes) {
  ASSERT_TRUE(table2().paperTable2);
  for (std::size_t i = 1; i <= 8; ++i) {
    const MemoryStep& step = table2().steps[i];
    EXPECT_EQ(row(step, "strokes-table2").bytes, kPaperTable2[i - 1].strokeBytes);
    EXPECT_EQ(row(step, "strokes-paper").bytes, kPaperTable2[i - 1].strokeBytes);
    EXPECT_EQ(row(step, "list-snapshots-table2").bytes, kPaperTable2[i - 1].snapshotBytes);
    EXPECT_EQ(row(step, "list-snapshots-paper").bytes, kPaperTable2[i - 1].snapshotBytes);
    EXPECT_FALSE(row(step, "strokes-table2").measured);
  }
}

TEST(Memory, HypothesisHoldsOnTable2StrokesAreSmallestAtEveryStep) {
  for (const MemoryStep& step : table2().steps) {
    if (step.step == 0) continue;
    for (const MemoryRow& other : step.rows) {
      if (other.backend == "strokes") continue;
      EXPECT_LT(row(step, "strokes").bytes, other.bytes) << other.backend << ", step " << step.step;
    }
  }
}

TEST(Memory, EveryStepHasTheSameBackEndsInTheSameOrder) {
  const auto names = [](const MemoryStep& step) {
    std::vector<std::string> all;
    for (const MemoryRow& each : step.rows) all.push_back(each.backend);
    return all;
  };
  for (const MemoryStep& step : table2().steps) EXPECT_EQ(names(step), names(table2().steps.front()));
  EXPECT_GT(table2().walked, 0u) << "the histories were to be walked and checked";
}

TEST(Memory, IsTheSameAtAnyNumberOfThreads) {
  const MemoryLog one = measureMemory(kExamples / "table2.log", smokeSize({}), {.threads = 1});
  for (std::size_t i = 0; i < one.steps.size(); ++i)
    for (std::size_t j = 0; j < one.steps[i].rows.size(); ++j)
      EXPECT_EQ(one.steps[i].rows[j].bytes, table2().steps[i].rows[j].bytes)
          << one.steps[i].rows[j].backend << ", step " << i;
  EXPECT_EQ(one.pictures.back().image.rgba, table2().pictures.back().image.rgba);
}

TEST(Memory, MeasuresAStampListAndSaysThatItCannotBeRetargeted) {
  const Folder folder;
  const fs::path file =
      stampFile(folder, "two.stamps", "B 0 0 0 1\nS 1 2\n0 0 1 0.1\n0 0.1 1 0.1\nS -1 1\n1 0 0 0.2\n");
  const MemoryLog log = measureMemory(file, smokeSize({}));
  EXPECT_EQ(log.strokes, 2u);
  EXPECT_EQ(log.stamps, 3u);
  EXPECT_FALSE(log.paperTable2);
  EXPECT_FALSE(row(log.steps.back(), "strokes").abilities.retarget);
  EXPECT_TRUE(row(log.steps.front(), "strokes").abilities.retarget);
}

TEST(Memory, MeasuresALogWithoutStrokes) {
  const Folder folder;
  const fs::path file = stampFile(folder, "none.stamps", "B 0 0 0 1\n");
  const MemoryLog log = measureMemory(file, smokeSize({}));
  EXPECT_EQ(log.strokes, 0u);
  ASSERT_EQ(log.steps.size(), 1u);
  const std::vector<std::string> files = writeMemory({log}, smokeSize({}), folder.path() / "out");
  EXPECT_TRUE(fs::exists(folder.path() / "out" / "report.html"));
}

TEST(Memory, FollowsUndoAndRedoInTheLog) {
  const Folder folder;
  sculpt::StrokeLog log = sculpt::readLog(kExamples / "table2.log");
  log.commands.insert(log.commands.begin() + 3,
                      {sculpt::UndoCommand{}, sculpt::UndoCommand{}, sculpt::RedoCommand{}});
  sculpt::writeLog(folder.path() / "undo.log", log);
  const MemoryLog measured = measureMemory(folder.path() / "undo.log", smokeSize({}));
  EXPECT_EQ(measured.steps[4].command, "undo");
  EXPECT_EQ(measured.steps[6].command, "redo");
  EXPECT_EQ(measured.steps[6].primitives, measured.steps[2].primitives);
  EXPECT_EQ(measured.steps[6].surfels, measured.steps[2].surfels);
}

TEST(Memory, RefusesALogThatIsNotThereOrNotOneWithASentenceThatNamesIt) {
  const Folder folder;
  for (const fs::path& file :
       {folder.path() / "absent.log", stampFile(folder, "garbage.log", "hello\n"),
        stampFile(folder, "nan.stamps", "B 0 0 0 nan\n"), stampFile(folder, "empty.log", "")}) {
    try {
      (void)measureMemory(file, smokeSize({}));
      ADD_FAILURE() << file << " was accepted";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(file.filename().string()), std::string::npos) << error.what();
    }
  }
}

TEST(Memory, RefusesAFolderThatCannotBeMade) {
  const Folder folder;
  const fs::path file = stampFile(folder, "taken", "here is a file\n");
  EXPECT_THROW((void)writeMemory({table2()}, smokeSize({}), file), InputError);
  EXPECT_THROW((void)writeMemory({table2()}, smokeSize({}), file / "below"), InputError);
}

TEST(Memory, WritesWhatItPromises) {
  const Folder folder;
  const MemoryOptions options = smokeSize({});
  const std::vector<std::string> files = writeMemory({table2()}, options, folder.path());
  for (const char* name : {"results.csv", "results.json", "manifest.json", "figure12-linear.png",
                           "figure12-linear.svg", "figure12-log.png", "figure12-log.svg", "report.html"})
    EXPECT_NE(std::ranges::find(files, name), files.end()) << name;
  std::size_t found = 0;
  for (const auto& entry : fs::directory_iterator(folder.path())) {
    EXPECT_NE(std::ranges::find(files, entry.path().filename().string()), files.end())
        << entry.path() << " was not announced";
    EXPECT_GT(entry.file_size(), 0u) << entry.path();
    ++found;
  }
  EXPECT_EQ(found, files.size());

  // One row per step and back end in both tables, each with where it comes from.
  const auto json = nlohmann::json::parse(bytesOfFile(folder.path() / "results.json"));
  std::size_t rows = 0;
  for (const MemoryStep& step : table2().steps) rows += step.rows.size();
  ASSERT_EQ(json.at("rows").size(), rows);
  for (const char* key : {"log", "step", "backend", "bytes", "undo_in_order", "undo_anywhere", "branch",
                          "retarget", "revision", "dirty", "compiler", "options_hash", "seed", "density"})
    EXPECT_TRUE(json["rows"][0].contains(key)) << key;
  const std::string csv = bytesOfFile(folder.path() / "results.csv");
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(csv, '\n')), rows + 1);

  const auto manifest = nlohmann::json::parse(bytesOfFile(folder.path() / "manifest.json"));
  EXPECT_EQ(manifest.at("inputs").at(0).at("hash"), hashOfFile(kExamples / "table2.log"));
  EXPECT_EQ(manifest.at("options_hash"), hexHash(describe(options)));
  for (const char* key : {"revision", "dirty", "compiler", "cpu", "seed"})
    EXPECT_TRUE(manifest.contains(key)) << key;

  // The page needs nothing else: no address but those inside data URIs and the SVG's name spaces, which are
  // encoded.
  const std::string page = bytesOfFile(folder.path() / "report.html");
  EXPECT_EQ(page.find("http"), std::string::npos);
  EXPECT_EQ(page.find("src=\"data:"), page.find("src="));
  EXPECT_NE(page.find("184,800"), std::string::npos);
  EXPECT_EQ(page.find("<script"), std::string::npos);
}

TEST(Figures, SayInOneSentenceWhyTheyCannotBeDrawn) {
  const Folder folder;
  const auto sentence = [](const std::string& script, const std::vector<std::string>& arguments) {
    try {
      drawFigure(script, arguments);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("drawn");
  };
  const std::string missing = sentence("no-such.py", {});
  EXPECT_NE(missing.find("no-such.py"), std::string::npos) << missing;
  const std::string prefix = (folder.path() / "f").string();
  const std::string noTable = sentence("figure12.py", {(folder.path() / "absent.csv").string(), "x", prefix});
  EXPECT_NE(noTable.find("absent.csv"), std::string::npos) << noTable;
  const fs::path table = stampFile(folder, "t.csv", "log,step,backend,bytes\n");
  const std::string noRows = sentence("figure12.py", {table.string(), "x", prefix});
  EXPECT_NE(noRows.find("no rows of x"), std::string::npos) << noRows;
  for (const std::string& each : {missing, noTable, noRows})
    EXPECT_EQ(each.find('\n'), std::string::npos) << each;
  EXPECT_FALSE(fs::exists(prefix + "-linear.png"));
}

TEST(Memory, SaysTheTableInText) {
  const std::string text = memoryTable(table2());
  for (const char* word : {"5,752", "184,800", "strokes", "retarget", "454"})
    EXPECT_NE(text.find(word), std::string::npos) << word;
}

TEST(Memory, TellsLogsWithOneNameApart) {
  std::vector<MemoryLog> logs(3);
  for (MemoryLog& log : logs) log.name = "head";
  makeNamesUnique(logs);
  EXPECT_EQ(logs[0].name, "head");
  EXPECT_EQ(logs[1].name, "head-2");
  EXPECT_EQ(logs[2].name, "head-3");
}

TEST(Memory, OptionsThatChangeTheResultChangeItsHash) {
  MemoryOptions other;
  other.density = 123;
  EXPECT_NE(describe(MemoryOptions{}), describe(other));
  other = {};
  other.seed = 2;
  EXPECT_NE(describe(MemoryOptions{}), describe(other));
}

}  // namespace
}  // namespace restroke::experiments
