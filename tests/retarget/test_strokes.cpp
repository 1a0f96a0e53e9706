#include "tests/retarget/test_strokes.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace restroke::retarget {

namespace {

std::filesystem::path sharedData() {
  const char* shared = std::getenv("RESTROKE_SHARED");
  return std::filesystem::path(shared != nullptr ? shared : RESTROKE_SHARED_DIR) / "data";
}

}  // namespace

std::filesystem::path sharedStrokesFolder() {
  return sharedData() / "strokes";
}
std::filesystem::path sharedStampsFolder() {
  return sharedData() / "stamps";
}

std::vector<std::vector<StrokePoint>> readStrokeFile(const std::filesystem::path& file) {
  std::ifstream in(file);
  const auto json = nlohmann::json::parse(in);
  std::vector<std::vector<StrokePoint>> strokes;
  for (const auto& stroke : json.at("strokes")) {
    const auto& points = stroke.at("points");
    const double start = points.at(0).at(2).get<double>();
    auto& out = strokes.emplace_back();
    for (const auto& p : points)
      out.push_back({{static_cast<std::int32_t>(std::lround(p.at(0).get<double>() * kSubPixels)),
                      static_cast<std::int32_t>(std::lround(p.at(1).get<double>() * kSubPixels))},
                     static_cast<std::uint32_t>(std::lround((p.at(2).get<double>() - start) * 1000)),
                     static_cast<std::uint16_t>(std::lround(p.at(3).get<double>() * kMaxPressure))});
  }
  return strokes;
}

std::vector<implicit::Primitive> readStampFile(const std::filesystem::path& file) {
  std::vector<implicit::Primitive> primitives;
  auto sign = implicit::Sign::Positive;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    if (line.starts_with('S')) {
      std::string s;
      int direction = 0;
      words >> s >> direction;
      sign = direction > 0 ? implicit::Sign::Positive : implicit::Sign::Negative;
      continue;
    }
    if (line.starts_with('B')) words.ignore(1);
    implicit::Sphere sphere;
    if (words >> sphere.center.x >> sphere.center.y >> sphere.center.z >> sphere.radius)
      primitives.push_back({sphere, sign});
  }
  return primitives;
}

}  // namespace restroke::retarget
