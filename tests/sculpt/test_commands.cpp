#include "tests/sculpt/test_commands.h"

#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

namespace restroke::sculpt {

Camera frontCamera() {
  return frameSphere({}, 1, {.view = {0, 0, -1}, .width = 400, .height = 400, .fill = 0.9f});
}

StrokeCommand line(int offset, Mode mode) {
  StrokeCommand command;
  command.stroke.camera = frontCamera();
  command.brush.radius = 0.1f;
  command.brush.mode = mode;
  for (int i = 0; i <= 20; ++i)
    command.stroke.points.push_back({.screen = {16 * (100 + 10 * i), 16 * (200 + offset)},
                                     .time = static_cast<std::uint32_t>(8 * i),
                                     .pressure = static_cast<std::uint16_t>(500 + i)});
  return command;
}

StrokeCommand miss() {
  StrokeCommand command = line(0);
  for (retarget::StrokePoint& point : command.stroke.points) point.screen = {3, point.screen.x / 200};
  return command;
}

LogHeader coarseHeader() {
  return {.unit = "mm", .density = 300, .base = {}};
}

std::filesystem::path sharedData() {
  const char* given = std::getenv("RESTROKE_SHARED");
  const std::filesystem::path data = std::filesystem::path(given ? given : RESTROKE_SHARED_DIR) / "data";
  return std::filesystem::is_directory(data) ? data : std::filesystem::path();
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "restroke-test-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) std::abort();
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path TemporaryFolder::file(const std::string& name, const std::string& text) const {
  std::ofstream(path_ / name, std::ios::binary) << text;
  return path_ / name;
}

std::string textOf(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace restroke::sculpt
