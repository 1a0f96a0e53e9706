#include "sculpt/cli/words.h"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "implicit/errors.h"
#include "sculpt/document.h"

namespace restroke::cli {

namespace {

// The numbers between separators; nothing when one of them is not a finite number.
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

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(' ');
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

// Rodrigues' formula. Only here do sine and cosine decide anything; the log holds what came of it.
DVec3 rotated(DVec3 p, DVec3 axis, double degrees) {
  constexpr double kDegree = 3.141592653589793 / 180;
  const DVec3 k = normalized(axis);
  const double c = std::cos(degrees * kDegree), s = std::sin(degrees * kDegree);
  return p * c + cross(k, p) * s + k * (dot(k, p) * (1 - c));
}

}  // namespace

namespace {

// A base on its way through a transform, in double.
struct Moving {
  DVec3 position{0};
  std::array<double, 4> rotation{0, 0, 0, 1};
  double scale = 1;
  std::shared_ptr<const implicit::Volume> volume;  // null: a sphere, whose radius is `scale`

  [[nodiscard]] implicit::Shape shape() const {
    if (!volume) {
      const implicit::Shape sphere(Point(position), static_cast<float>(scale));
      validate(implicit::Primitive{sphere, implicit::Sign::Positive});
      return sphere;
    }
    implicit::Pose pose{.position = Point(position), .scale = static_cast<float>(scale)};
    for (std::size_t i = 0; i < 4; ++i) pose.rotation[i] = static_cast<float>(rotation[i]);
    return std::make_shared<const implicit::PosedVolume>(volume, pose);
  }
};

Moving movingOf(const implicit::Shape& base) {
  Moving moving;
  if (base.isSphere()) {
    moving.position = DVec3(base.ball().center);
    moving.scale = static_cast<double>(base.ball().radius);
    return moving;
  }
  const implicit::Pose& pose = base.volume()->pose();
  moving.position = DVec3(pose.position);
  moving.scale = static_cast<double>(pose.scale);
  for (std::size_t i = 0; i < 4; ++i) moving.rotation[i] = static_cast<double>(pose.rotation[i]);
  moving.volume = base.volume()->sharedVolume();
  return moving;
}

void rotate(Moving& moving, DVec3 axis, double degrees) {
  moving.position = rotated(moving.position, axis, degrees);
  const double half = degrees * 3.141592653589793 / 360, s = std::sin(half), w = std::cos(half);
  const DVec3 v = normalized(axis) * s, u(moving.rotation[0], moving.rotation[1], moving.rotation[2]);
  const double uw = moving.rotation[3];
  const DVec3 product = w * u + uw * v + cross(v, u);
  moving.rotation = {product.x, product.y, product.z, w * uw - dot(v, u)};
}

void stretch(Moving& moving, DVec3 factors, std::string_view part) {
  if (!(factors.x > 0 && factors.y > 0 && factors.z > 0))
    throw InputError(
        fmt::format("--transform: \"{}\" scales by a factor that is not more than 0, but must", part));
  moving.position = moving.position * factors;
  if (factors.x == factors.y && factors.y == factors.z) {
    moving.scale *= factors.x;
  } else if (!moving.volume) {
    const DVec3 axes = factors * moving.scale;
    moving.volume =
        implicit::volumeKindNamed("ellipsoid")
            .make(
                {{{static_cast<float>(axes.x)}, {static_cast<float>(axes.y)}, {static_cast<float>(axes.z)}}});
    moving.scale = 1;
  } else {
    throw InputError(
        fmt::format("--transform: \"{}\" scales a {} by different factors, but only a sphere (which "
                    "becomes an ellipsoid) can be",
                    part, moving.volume->kind().name));
  }
}

}  // namespace

implicit::Shape transformed(const implicit::Shape& base, std::string_view transform) {
  Moving moving = movingOf(base);
  while (!transform.empty()) {
    const std::size_t end = transform.find(';');
    const std::string_view part = trimmed(transform.substr(0, end));
    transform.remove_prefix(end == std::string_view::npos ? transform.size() : end + 1);
    if (part.empty() && transform.empty()) break;
    const std::size_t space = part.find(' ');
    const std::string_view verb = part.substr(0, space);
    std::string spaced(space == std::string_view::npos ? std::string_view() : trimmed(part.substr(space)));
    for (std::size_t at; (at = spaced.find("  ")) != std::string::npos;) spaced.erase(at, 1);
    const auto numbers = numbersIn(spaced, ' ');
    const std::size_t count = numbers ? numbers->size() : 0;
    if (verb == "translate" && count == 3) {
      moving.position += DVec3((*numbers)[0], (*numbers)[1], (*numbers)[2]);
    } else if (verb == "rotate" && count == 4) {
      const DVec3 axis((*numbers)[0], (*numbers)[1], (*numbers)[2]);
      if (!(dot(axis, axis) > 0))
        throw InputError(fmt::format(
            "--transform: \"{}\" turns about an axis of length 0, but the axis must have a direction", part));
      rotate(moving, axis, (*numbers)[3]);
    } else if (verb == "scale" && (count == 1 || count == 3)) {
      const double s = (*numbers)[0];
      stretch(moving, count == 3 ? DVec3(s, (*numbers)[1], (*numbers)[2]) : DVec3(s), part);
    } else {
      throw InputError(fmt::format(
          "--transform: \"{}\" is not understood, but parts must be translate x y z, rotate ax ay az degrees "
          "or scale s, with ; between them",
          part));
    }
  }
  try {
    return moving.shape();
  } catch (const InputError& error) {
    throw InputError(fmt::format("--transform: {}", error.what()));
  }
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
