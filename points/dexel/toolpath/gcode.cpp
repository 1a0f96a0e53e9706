#include "points/dexel/toolpath/gcode.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "points/dexel/toolpath/gcode_block.h"
#include "points/files/mesh_formats.h"

namespace restroke::points {

namespace {

constexpr double kMillimetresPerInch = 25.4;

enum class Motion : std::uint8_t { None, Rapid, Feed, Clockwise, CounterClockwise };

// What one block says.
struct Words {
  std::array<std::optional<double>, 3> place, center;  // X Y Z, I J K
  std::optional<double> radius, turns;
  std::optional<Motion> motion;
  std::optional<int> planeAxis;
  std::optional<double> unit;
  std::optional<bool> isAbsolute;
  std::optional<std::uint32_t> tool;
  bool dwells = false, ends = false;

  [[nodiscard]] bool hasPlace() const { return place[0] || place[1] || place[2]; }
  [[nodiscard]] bool hasCenter() const { return center[0] || center[1] || center[2]; }
};

// The words of G that move nothing, times ten.
bool isPassedOver(int tenths) {
  constexpr std::array kPassed{400, 430, 490, 540, 610, 611, 640, 911};
  return std::find(kPassed.begin(), kPassed.end(), tenths) != kPassed.end() ||
         (tenths >= 930 && tenths <= 990 && tenths % 10 == 0);
}

const char* whyRefused(int tenths) {
  const int whole = tenths / 10;
  if (tenths == 901) return "places the centres of arcs absolutely; they must be relative (G91.1)";
  switch (whole) {
    case 10:
    case 52:
    case 92:
      return "shifts the coordinates, which is not understood";
    case 28:
    case 30:
      return "moves to a place that the program does not say";
    case 41:
    case 42:
      return "moves beside the path; paths must be those of the tool's own centre (G40)";
    case 43:
      return "shifts the tool; positions must be those of its tip";
    case 50:
    case 51:
    case 68:
    case 69:
      return "scales or turns the coordinates, which is not understood";
    case 53:
    case 55:
    case 56:
    case 57:
    case 58:
    case 59:
      return "is of another coordinate system; there must be one (G54)";
    default:
      break;
  }
  if (whole == 5 || whole == 6 || whole == 33 || whole == 38 || whole == 73 || whole == 76 ||
      (whole >= 81 && whole <= 89))
    return "moves in a way that is not understood; motion must be G0, G1, G2 or G3";
  return "is not known";
}

class Program {
 public:
  Program(const std::filesystem::path& name, const GcodeOptions& options)
      : name_(name), tool_(options.tool) {}

  // False at the end of the program.
  bool run(const GcodeBlock& block) {
    line_ = block.line;
    const Words words = understood(block);
    if (words.tool) tool_ = words.tool;
    if (words.planeAxis) axis_ = *words.planeAxis;
    if (words.unit) unit_ = *words.unit;
    if (words.isAbsolute) isAbsolute_ = *words.isAbsolute;
    if (words.motion) motion_ = *words.motion;
    const bool isArc = motion_ == Motion::Clockwise || motion_ == Motion::CounterClockwise;
    const bool saysArc = words.hasCenter() || words.radius;
    if (saysArc && !isArc) refuse("there is I, J, K or R; only arcs (G2, G3) have it");
    if (words.dwells && words.hasPlace() && !words.motion) refuse("G4 has X, Y or Z; a dwell has P alone");
    if (words.hasPlace() || saysArc)
      move(words, isArc);
    else if (words.motion && isArc)
      refuse("an arc has neither an end nor a centre; it must have X, Y or Z, and I, J, K or R");
    return !words.ends;
  }

  GcodeProgram result;

 private:
  [[noreturn]] void refuse(const std::string& what) const { refuseGcode(name_, line_, what); }

  template <class T>
  void put(std::optional<T>& to, T value, const GcodeWord& word) const {
    if (to)
      refuse(fmt::format("{} is the second word of its kind in the block; there must be one", word.text));
    to = value;
  }

  [[nodiscard]] Words understood(const GcodeBlock& block) const {
    Words words;
    for (const GcodeWord& w : block.words) {
      switch (w.letter) {
        case 'X':
        case 'Y':
        case 'Z':
          put(words.place[static_cast<std::size_t>(w.letter - 'X')], w.value, w);
          break;
        case 'I':
        case 'J':
        case 'K':
          put(words.center[static_cast<std::size_t>(w.letter - 'I')], w.value, w);
          break;
        case 'R':
          put(words.radius, w.value, w);
          break;
        case 'G':
          takeG(w, words);
          break;
        case 'M':
          takeM(w, words);
          break;
        case 'T':
          put(words.tool, toolOf(w), w);
          break;
        case 'P':
          put(words.turns, w.value, w);
          break;
        case 'F':
        case 'S':
        case 'D':
        case 'H':
        case 'L':
        case 'Q':
          break;
        default:
          refuse(
              fmt::format("{}: the letter {} is not understood; the axes are X, Y and Z", w.text, w.letter));
      }
    }
    return words;
  }

  [[nodiscard]] std::uint32_t toolOf(const GcodeWord& word) const {
    constexpr double kMostTools = 1e9;
    if (word.value != std::floor(word.value) || word.value < 0 || word.value > kMostTools)
      refuse(fmt::format("{}: a tool's number must be a whole number from 0 to 1e9", word.text));
    return static_cast<std::uint32_t>(word.value);
  }

  void takeG(const GcodeWord& word, Words& words) const {
    const double tenths = word.value * 10;
    constexpr double kMost = 999;
    if (!(tenths >= 0 && tenths <= kMost) || std::fabs(tenths - std::floor(tenths + 0.5)) > 1e-6)
      refuse(fmt::format("{} is not known", word.text));
    switch (const int code = static_cast<int>(std::floor(tenths + 0.5))) {
      case 0:
        return put(words.motion, Motion::Rapid, word);
      case 10:
        return put(words.motion, Motion::Feed, word);
      case 20:
        return put(words.motion, Motion::Clockwise, word);
      case 30:
        return put(words.motion, Motion::CounterClockwise, word);
      case 800:
        return put(words.motion, Motion::None, word);
      case 40:
        words.dwells = true;
        return;
      case 170:
        return put(words.planeAxis, 2, word);
      case 180:
        return put(words.planeAxis, 1, word);
      case 190:
        return put(words.planeAxis, 0, word);
      case 200:
        return put(words.unit, kMillimetresPerInch, word);
      case 210:
        return put(words.unit, 1.0, word);
      case 900:
        return put(words.isAbsolute, true, word);
      case 910:
        return put(words.isAbsolute, false, word);
      default:
        if (!isPassedOver(code)) refuse(fmt::format("{} {}", word.text, whyRefused(code)));
    }
  }

  void takeM(const GcodeWord& word, Words& words) const {
    if (word.value == 98 || word.value == 99)
      refuse(fmt::format("{} is of subprograms, which are not understood", word.text));
    if (word.value == 2 || word.value == 30) words.ends = true;
  }

  void move(const Words& words, bool isArc) {
    if (motion_ == Motion::None)
      refuse("there is X, Y or Z, but no motion is set; G0, G1, G2 or G3 must come first");
    if (!tool_) refuse("the tool moves, but no T has selected one; T must come first");
    if (*tool_ == 0) refuse("the tool moves, but T0 has put it away; T must select one first");
    DVec3 to = place_;
    for (int a = 0; a < 3; ++a)
      if (const auto& word = words.place[static_cast<std::size_t>(a)])
        to[a] = (isAbsolute_ ? 0 : place_[a]) + *word * unit_;
    for (int a = 0; a < 3; ++a)
      if (!(std::fabs(to[a]) <= static_cast<double>(kMaxCoordinate)))
        refuse(fmt::format("the tool moves to {} = {:.6g} mm; it must stay within +-{:g}", "XYZ"[a], to[a],
                           static_cast<double>(kMaxCoordinate)));
    PathElement element{.from = place_, .to = to};
    if (isArc) bend(element, words);
    place_ = to;
    add(element, words.place[2].has_value());
  }

  void add(PathElement element, bool hasHeight) {
    const bool isRapid = motion_ == Motion::Rapid;
    if (isRapid && isApproaching_) {
      ++result.approaches;
      if (!hasHeight) return;
      element.from = element.to;
    }
    isApproaching_ = false;
    if (element.kind == PathElement::Kind::Line && element.from == element.to && !result.elements.empty()) {
      ++result.still;
      return;
    }
    result.elements.push_back({element, *tool_, line_, isRapid});
  }

  void bend(PathElement& element, const Words& words) const {
    if (words.turns && *words.turns != 1) refuse("an arc has P, several turns; it must have one at most");
    if (words.radius && words.hasCenter()) refuse("an arc has both R and I, J, K; it must have one of them");
    if (!words.radius && !words.hasCenter()) refuse("an arc has no centre; it must have I, J, K or R");
    if (words.center[static_cast<std::size_t>(axis_)])
      refuse(fmt::format("an arc has {}, across its plane; in {} its centre is {}", "IJK"[axis_], planeName(),
                         axis_ == 2   ? "I and J"
                         : axis_ == 1 ? "I and K"
                                      : "J and K"));
    element.kind = PathElement::Kind::Arc;
    element.axis = axis_;
    element.clockwise = motion_ == Motion::Clockwise;
    element.center = element.from;
    if (words.radius)
      centerByRadius(element, *words.radius * unit_);
    else
      centerByOffsets(element, words);
  }
  [[nodiscard]] const char* planeName() const {
    return axis_ == 2 ? "G17 (XY)" : axis_ == 1 ? "G18 (XZ)" : "G19 (YZ)";
  }

  void centerByOffsets(PathElement& element, const Words& words) const {
    const int u = (axis_ + 1) % 3, v = (axis_ + 2) % 3;
    for (const int a : {u, v})
      element.center[a] += words.center[static_cast<std::size_t>(a)].value_or(0) * unit_;
    const auto distanceOf = [&](DVec3 p) {
      const double x = p[u] - element.center[u], y = p[v] - element.center[v];
      return std::sqrt(x * x + y * y);
    };
    const double from = distanceOf(element.from), to = distanceOf(element.to);
    if (!(from > 0)) refuse("an arc has its centre where it begins; it must have a radius");
    if (!(from <= 2 * static_cast<double>(kMaxCoordinate)))
      refuse(fmt::format("an arc has the radius {:.6g} mm; it must be at most {:g}", from,
                         2 * static_cast<double>(kMaxCoordinate)));
    if (std::fabs(from - to) > std::max(kArcTolerance * from, kArcToleranceMillimetres))
      refuse(fmt::format(
          "an arc begins {:.6g} mm from its centre and ends {:.6g} mm from it; the distances must be "
          "the same (to within {:g} % or {} mm)",
          from, to, 100 * kArcTolerance, kArcToleranceMillimetres));
  }

  void centerByRadius(PathElement& element, double radius) const {
    const int u = (axis_ + 1) % 3, v = (axis_ + 2) % 3;
    const double x = element.to[u] - element.from[u], y = element.to[v] - element.from[v];
    const double chord = std::sqrt(x * x + y * y), half = chord / 2, size = std::fabs(radius);
    if (!(chord > 0)) refuse("an arc with R ends where it begins; a whole turn must have I, J or K");
    if (!(size <= 2 * static_cast<double>(kMaxCoordinate)))
      refuse(fmt::format("an arc has the radius {:.6g} mm; it must be at most {:g}", size,
                         2 * static_cast<double>(kMaxCoordinate)));
    if (half - size > std::max(kArcTolerance * size, kArcToleranceMillimetres) || !(size > 0))
      refuse(fmt::format(
          "an arc has the radius {:.6g} mm, and its ends are {:.6g} mm apart; the radius must be at "
          "least half of that",
          size, chord));
    const double square = size * size - half * half, height = square > 0 ? std::sqrt(square) : 0;
    // Counter-clockwise by less than half a turn has the centre to the left of the way.
    const double side = (element.clockwise ? -1 : 1) * (radius < 0 ? -1 : 1) * height / chord;
    element.center[u] = element.from[u] + x / 2 - side * y;
    element.center[v] = element.from[v] + y / 2 + side * x;
  }

  const std::filesystem::path& name_;
  std::size_t line_ = 0;
  std::optional<std::uint32_t> tool_;
  DVec3 place_{0};
  Motion motion_ = Motion::None;
  int axis_ = 2;
  double unit_ = 1;
  bool isAbsolute_ = true, isApproaching_ = true;
};

}  // namespace

GcodeProgram parseGcode(std::string_view contents, const std::filesystem::path& name,
                        const GcodeOptions& options) {
  Program program(name, options);
  GcodeReader reader(contents, name);
  GcodeBlock block;
  for (bool isFirst = true; reader.next(block); isFirst = false)
    if (block.isPercent ? !isFirst : !program.run(block)) break;
  return std::move(program.result);
}

GcodeProgram readGcode(const std::filesystem::path& path, const GcodeOptions& options) {
  const std::string contents = formats::contentsOf(path, "a G-code file");
  return parseGcode(contents, path, options);
}

}  // namespace restroke::points
