// The worked example of the paper's figure 10, (a) to (e), as one log with its history commands (SPEC S9).
//
// The paper says what was done, not how the animal looked: "a foundation shape imitating a rabbit-like animal
// head"; then "the eyes and the mouth are carved off and the nose is dished up"; then "the user has undone
// all the past operations and has made a new series of dish-up operations"; then the undone ones are
// retargeted; last "the user canceled a series of preceding operations in the middle of the history", and
// "the carving operations are reflected onto the shape even when the application order is changed".

#include <array>
#include <memory>
#include <vector>

#include "experiments/examples/example_logs.h"
#include "experiments/examples/pen.h"
#include "implicit/errors.h"
#include "implicit/volume.h"

namespace restroke::experiments {
namespace {

using sculpt::Brush;
using sculpt::Extent;
using sculpt::Mode;
using sculpt::NodeId;

constexpr double kSides[] = {-1, 1};

std::shared_ptr<const implicit::Volume> ellipsoid(float x, float y, float z) {
  return implicit::volumeKindNamed("ellipsoid").make({{{x}, {y}, {z}}});
}

/// Nodes from the first to the last, all on one path, none in between left out.
struct Series {
  NodeId first{}, last{};
};

class Figure10Pen {
 public:
  explicit Figure10Pen(const sculpt::LogHeader& header) : sculptor_(header) {}

  Figure10 carryOut() {
    foundation();
    const NodeId bare = cursor();
    stage(0, "foundation");

    const Series face = series([&] { drawFace(); });
    stage(1, "face carved and added");

    sculptor_.carryOut(sculpt::GotoCommand{{}, bare});
    for (const double side : kSides) mound(side);
    const Series brows = series([&] {
      for (const double side : kSides) brow(side);
    });
    const Series snout = series([&] { drawSnout(); });
    for (const double side : kSides) fatCheek(side);
    tuft();
    const NodeId other = cursor();
    stage(2, "undone; another series added");

    const auto copies = static_cast<std::uint32_t>(sculptor_.document().history().size());
    const std::uint32_t copied = sculpt::indexOf(face.last) - sculpt::indexOf(face.first) + 1;
    sculptor_.carryOut(sculpt::CopyCommand{face.first, other, Extent::Branch});
    const NodeId end{copies + copied - 1};
    sculptor_.carryOut(sculpt::GotoCommand{{}, end});
    stage(3, "face copied, redone on it");

    for (std::uint32_t i = sculpt::indexOf(snout.first); i <= sculpt::indexOf(snout.last); ++i)
      sculptor_.carryOut(sculpt::CancelCommand{{}, NodeId{i}});
    // The brows come after the eyes now: these find the bare head, and the brows hang over them.
    sculptor_.carryOut(sculpt::MoveCommand{{}, brows.first, end, Extent::Single});
    sculptor_.carryOut(sculpt::MoveCommand{{}, brows.last, brows.first, Extent::Single});
    sculptor_.carryOut(sculpt::GotoCommand{{}, brows.last});
    stage(4, "snout cancelled, brows moved");
    return {sculptor_.log(), stages_};
  }

 private:
  [[nodiscard]] NodeId cursor() const { return sculptor_.document().history().cursor(); }

  void stage(std::size_t i, std::string_view what) {
    stages_[i] = {static_cast<char>('a' + i), sculptor_.log().commands.size(), cursor(), what};
  }

  template <class Draw>
  Series series(const Draw& draw) {
    const NodeId before = cursor();
    draw();
    return {NodeId{sculpt::indexOf(before) + 1}, cursor()};
  }

  /// A click of the pen, seen from the front.
  void dab(DVec3 at, const Brush& brush) { sculptor_.drawOn(front_, std::vector<Aim>{{at, 1}}, brush); }

  void foundation() {
    for (const double side : kSides) ear(side);
    for (const double side : kSides) dab({side * 0.45, -0.42, 0.8}, {.radius = 0.33f});  // jowls
    dab({0, -0.4, 1.0}, {.radius = 0.4f, .tip = ellipsoid(1.1f, 0.9f, 0.8f)});           // muzzle
  }

  /// A stalk, and on its tip the middle of a flat blade.
  void ear(double side) {
    const DVec3 root = normalized({side * 0.29, 0.95, -0.02});
    const Camera above = cameraAt(root * 5.0, root, {0, 0, -1});
    sculptor_.drawOn(above, std::vector<Aim>{{root, 1}},
                     {.radius = 0.6f, .tip = ellipsoid(0.22f, 0.2f, 1.0f)});
    const DVec3 tip = sculptor_.surfaceSeen(root * 5.0, root);
    earMiddle_[side > 0 ? 1 : 0] = tip;
    sculptor_.drawOn(above, std::vector<Aim>{{tip, 1}},
                     {.radius = 0.78f, .tip = ellipsoid(0.38f, 0.18f, 1.0f)});
  }

  void drawFace() {
    for (const double side : kSides) eye(side);
    dab({0, -0.2, 1.22}, {.radius = 0.14f, .tip = ellipsoid(1.0f, 0.72f, 0.8f)});  // nose
    mouth();
    for (const double side : kSides) whiskers(side);
    for (const double side : kSides) earHollow(side);
  }

  /// A tall hollow with a pupil in it.
  void eye(double side) {
    sculptor_.drawOn(front_, straight({side * 0.36, 0.3, 0.9}, {side * 0.36, 0.12, 0.9}, 20),
                     {.radius = 0.17f, .spacing = 0.1f, .mode = Mode::Carve});
    dab({side * 0.36 - 0.02 * side, 0.17, 0.8}, {.radius = 0.125f});
  }

  /// An open smile.
  void mouth() {
    std::vector<Aim> aims;
    constexpr int kPoints = 40;
    for (int i = 0; i <= kPoints; ++i) {
      const double t = 2.0 * i / kPoints - 1;
      aims.push_back({DVec3(0.22 * t, -0.52 + 0.1 * t * t, 1.2), 1 - 0.5 * t * t});
    }
    sculptor_.drawOn(front_, aims,
                     {.radius = 0.085f, .spacing = 0.1f, .pressureToRadius = 1, .mode = Mode::Carve});
  }

  void whiskers(double side) {
    for (const double row : {0.0, 1.0}) {
      std::vector<Aim> aims;
      constexpr int kPoints = 30;
      for (int i = 0; i <= kPoints; ++i) {
        const double t = static_cast<double>(i) / kPoints;
        aims.push_back(
            {DVec3(side * (0.36 + 0.3 * t), -0.4 - 0.11 * row + (0.1 - 0.08 * row) * t, 1.05), 1 - 0.5 * t});
      }
      sculptor_.drawOn(front_, aims,
                       {.radius = 0.035f, .spacing = 0.2f, .pressureToRadius = 1, .mode = Mode::Carve});
    }
  }

  /// Along the blade of the ear, from a camera that stands upright to it.
  void earHollow(double side) {
    const DVec3 middle = earMiddle_[side > 0 ? 1 : 0];
    const Camera camera =
        cameraAt(middle + DVec3(side * 0.6, 0.3, 4.0), middle, normalized({side * 0.29, 0.95, 0}));
    sculptor_.drawOn(camera, std::vector<Aim>{{middle + DVec3(side * 0.01, 0.1, 0.1), 1}},
                     {.radius = 0.52f, .mode = Mode::Carve, .tip = ellipsoid(0.36f, 1.0f, 0.2f)});
  }

  // Another animal: eyes that bulge, brows, a long snout, fat cheeks and a tuft of hair.
  void mound(double side) { dab({side * 0.36, 0.2, 0.9}, {.radius = 0.31f}); }

  void brow(double side) {
    std::vector<Aim> aims;
    constexpr int kPoints = 24;
    for (int i = 0; i <= kPoints; ++i) {
      const double t = static_cast<double>(i) / kPoints;
      aims.push_back(
          {DVec3(side * (0.14 + 0.40 * t), 0.36 + 0.3 * t * (1 - t) - 0.02 * t, 1.1), 1 - 0.25 * t});
    }
    sculptor_.drawOn(front_, aims, {.radius = 0.13f, .spacing = 0.08f, .pressureToRadius = 1});
  }

  void drawSnout() {
    dab({0, -0.32, 1.2}, {.radius = 0.5f, .tip = ellipsoid(0.72f, 0.62f, 1.0f)});
    for (const double side : kSides) dab({side * 0.17, -0.42, 1.6}, {.radius = 0.24f});
  }

  void fatCheek(double side) { dab({side * 0.67, -0.4, 0.64}, {.radius = 0.35f}); }

  void tuft() {
    const DVec3 crown = normalized({0, 0.95, 0.4});
    const Camera above = cameraAt(crown * 4.5, crown, {0, 1, 0});
    for (const double at : {-0.12, 0.12, 0.0})
      sculptor_.drawOn(above, std::vector<Aim>{{crown + DVec3(at, 0, at == 0 ? 0.06 : 0), 1}},
                       {.radius = at == 0 ? 0.3f : 0.22f, .tip = ellipsoid(0.35f, 0.35f, 1.0f)});
  }

  Sculptor sculptor_;
  Camera front_ = cameraAt({0, 0.3, 5.2}, {0, 0.1, 0.3});
  std::array<DVec3, 2> earMiddle_{};
  std::array<Figure10Stage, 5> stages_{};
};

}  // namespace

Figure10 figure10() {
  sculpt::LogHeader header;
  header.density = 12000;
  header.base = implicit::Sphere{.center = {0, 0, 0}, .radius = 1};
  return Figure10Pen(header).carryOut();
}

std::string stagesText(const Figure10& figure) {
  std::string text =
      "# Stages of figure10.log. Columns: stage; the log's lines up to there, header included; node at the\n"
      "# cursor; what it is.\n";
  for (const Figure10Stage& stage : figure.stages)
    text += fmt::format("{} {} {} {}\n", stage.name, stage.commands + 1, sculpt::indexOf(stage.cursor),
                        stage.what);
  return text;
}

}  // namespace restroke::experiments
