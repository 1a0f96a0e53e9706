#include "sculpt/cli/words.h"

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <span>

#include "implicit/errors.h"
#include "sculpt/document.h"

namespace restroke::cli {

std::optional<std::vector<double>> numbersIn(std::string_view text, char separator) {
  std::vector<double> numbers;
  while (true) {
    const std::size_t end = text.find(separator);
    const std::string_view word = text.substr(0, end);
    double value = 0;
    const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || rest != word.data() + word.size() || !std::isfinite(value))
      return std::nullopt;
    numbers.push_back(value);
    if (end == std::string_view::npos) return numbers;
    text.remove_prefix(end + 1);
  }
}

std::string extensionOf(const std::string& file) {
  std::string extension = std::filesystem::path(file).extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

sculpt::Repair repairNamed(std::string_view text) {
  if (text.empty()) return sculpt::Repair::None;
  if (text == "winding") return sculpt::Repair::Winding;
  throw InputError(fmt::format("--repair: \"{}\" must be winding", text));
}

std::pair<std::uint32_t, std::uint32_t> sizeNamed(std::string_view text) {
  const auto numbers = numbersIn(text, 'x');
  const auto isSize = [](double n) { return n >= 1 && n <= 65536 && n == std::floor(n); };
  if (!numbers || numbers->size() != 2 || !isSize((*numbers)[0]) || !isSize((*numbers)[1]))
    throw InputError(
        fmt::format("--size: \"{}\" must be WIDTHxHEIGHT in whole pixels, each from 1 to 65536", text));
  return {static_cast<std::uint32_t>((*numbers)[0]), static_cast<std::uint32_t>((*numbers)[1])};
}

float checkedDensity(float density) {
  if (!std::isfinite(density) || !(density > 0))
    throw InputError(fmt::format("--density: {} must be finite and more than 0", density));
  return density;
}

implicit::Sphere framed(std::span<const points::Surfel> surfels) {
  Box box;
  for (const points::Surfel& surfel : surfels) box.add({surfel.position, surfel.position});
  const Point center = box.center();
  float radius = 0;
  for (const points::Surfel& surfel : surfels) radius = std::fmax(radius, length(surfel.position - center));
  return {center, radius};
}

Camera viewNamed(std::string_view text, const ViewSubject& subject) {
  struct Named {
    std::string_view name;
    Vec3 view;
  };
  const auto framing = [&](Vec3 view) {
    return Framing{.view = view, .width = subject.width, .height = subject.height, .fill = 0.92f};
  };
  static const std::array<Named, 7> kViews{{{"front", {0, 0, -1}},
                                            {"back", {0, 0, 1}},
                                            {"left", {1, 0, 0}},
                                            {"right", {-1, 0, 0}},
                                            {"top", {0, -1, 0}},
                                            {"bottom", {0, 1, 0}},
                                            {"three-quarter", {-0.35f, -0.25f, -1}}}};
  for (const Named& named : kViews)
    if (text == named.name)
      return frameSphere(subject.bounds.center, subject.bounds.radius, framing(named.view));

  constexpr std::string_view kStroke = "stroke:";
  if (text.starts_with(kStroke)) {
    const auto number = numbersIn(text.substr(kStroke.size()), ',');
    double node = 0;
    for (const sculpt::Command& command : subject.log.commands) {
      const auto* stroke = std::get_if<sculpt::StrokeCommand>(&command);
      if (stroke || std::holds_alternative<sculpt::FixedCommand>(command)) ++node;
      if (!number || number->size() != 1 || (*number)[0] != node || !stroke) continue;
      Camera camera = stroke->stroke.camera;
      // All that the stroke's camera saw stays in view.
      const double was = static_cast<double>(camera.width) / camera.height;
      const double is = static_cast<double>(subject.width) / subject.height;
      if (is < was) camera.halfHeight = static_cast<float>(static_cast<double>(camera.halfHeight) * was / is);
      camera.width = subject.width;
      camera.height = subject.height;
      return camera;
    }
    throw InputError(fmt::format(
        "--view: \"{}\" must name one of the log's strokes that has a camera (history show numbers them)",
        text));
  }

  if (const std::size_t colon = text.find(':'); colon != std::string_view::npos) {
    const auto position = numbersIn(text.substr(0, colon), ','),
               view = numbersIn(text.substr(colon + 1), ',');
    if (position && view && position->size() == 3 && view->size() == 3) {
      const auto vec = [](const std::vector<double>& n) {
        return Vec3(static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2]));
      };
      const Vec3 direction = vec(*view);
      if (!(dot(direction, direction) > 0) || !isFinite(direction))
        throw InputError(
            fmt::format("--view: \"{}\" looks in a direction of length 0, but must have one", text));
      Camera camera = frameSphere(subject.bounds.center, subject.bounds.radius, framing(direction));
      const float distance = length(camera.position - subject.bounds.center);
      camera.position = vec(*position);
      // Distances to the shape may be anything from here: keep the near plane small beside the shape.
      camera.far = 2 * (length(camera.position - subject.bounds.center) + distance + camera.far);
      camera.near = camera.far * 1e-5f;
      validate(camera, "--view");
      return camera;
    }
  }
  throw InputError(
      fmt::format("--view: \"{}\" must be front, back, left, right, top, bottom, three-quarter, stroke:N or "
                  "px,py,pz:vx,vy,vz",
                  text));
}

}  // namespace restroke::cli
