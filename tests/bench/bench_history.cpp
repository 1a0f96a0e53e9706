// Bytes of history per stroke, header and camera counted: every pen-stroke file of the shared data, with and
// without the channels time and pressure, beside what plain float32 points and the paper's layout take.
//
//   bench_history [STROKES.json...]

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "sculpt/history.h"
#include "sculpt/pen_strokes.h"

namespace restroke::bench {
namespace {

std::size_t bytesOf(const sculpt::StrokeLog& log, sculpt::HistoryOptions options) {
  sculpt::History history(options);
  for (const sculpt::Command& command : log.commands) history.add(command);
  return history.bytes();
}

int main(int argc, char** argv) {
  std::vector<std::filesystem::path> files(argv + 1, argv + argc);
  const std::filesystem::path folder = std::filesystem::path(RESTROKE_SHARED_DIR) / "data/strokes";
  if (files.empty() && std::filesystem::is_directory(folder))
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty()) fmt::print("no stroke files: {} is absent and none was named\n", folder.string());
  fmt::print("{:<36}{:>8}{:>8} |{:>10}{:>10}{:>10} |{:>10}{:>10}{:>10} |{:>12}{:>12}\n", "file", "strokes",
             "points", "bytes", "64 + 4 n", "a point", "no t, p", "48+2.5 n", "a point", "float32 16n",
             "304 + 12 n");
  bool within = true;
  for (const std::filesystem::path& file : files) {
    const sculpt::StrokeLog log = sculpt::readPenStrokes(file);
    std::size_t points = 0;
    for (const sculpt::Command& command : log.commands)
      points += std::get<sculpt::StrokeCommand>(command).stroke.points.size();
    const double strokes = static_cast<double>(log.commands.size()), n = static_cast<double>(points);
    const double all = static_cast<double>(bytesOf(log, {}));
    const double places = static_cast<double>(bytesOf(log, {.times = false, .pressures = false}));
    fmt::print("{:<36}{:>8}{:>8} |{:>10}{:>10}{:>10.2f} |{:>10}{:>10}{:>10.2f} |{:>12}{:>12}\n",
               file.filename().string(), strokes, n, all, 64 * strokes + 4 * n, all / n, places,
               48 * strokes + 2.5 * n, places / n, 16 * n, 304 * strokes + 12 * n);
    within = within && all <= 64 * strokes + 4 * n && places <= 48 * strokes + 2.5 * n;
  }
  fmt::print("{}\n", within ? "every file is within its bound" : "A FILE IS OVER ITS BOUND");
  return within ? 0 : 1;
}

}  // namespace
}  // namespace restroke::bench

int main(int argc, char** argv) {
  return restroke::bench::main(argc, argv);
}
