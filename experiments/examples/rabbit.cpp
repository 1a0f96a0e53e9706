// A rabbit's head, after figure 10 (a) and (b) of the paper (SPEC S9): first the foundation (head, cheeks,
// muzzle, ears, a curl), then the face (eyes, mouth, whiskers and the hollows of the ears carved, pupils,
// nose and teeth added).
//
// Stamps lie on the surface that the camera sees when the stroke begins. Ears are therefore grown like a coil
// pot: each stroke is seen from above the tip that the last one left, and lands on it.

#include <algorithm>
#include <array>

#include "experiments/examples/example_logs.h"
#include "experiments/examples/pen.h"

namespace restroke::experiments {
namespace {

using sculpt::Brush;
using sculpt::Mode;

class Rabbit {
 public:
  explicit Rabbit(const sculpt::LogHeader& header) : sculptor_(header) {}

  void foundation() {
    for (const double side : {1.0, -1.0})
      draw(face_, {{{side * 0.47, -0.34, 0.81}, 1}}, {.radius = 0.33f});                      // cheeks
    for (const double side : {1.0, -1.0}) dab({side * 0.17, -0.32, 1.1}, {.radius = 0.23f});  // muzzle
    dab({0, -0.70, 0.85}, {.radius = 0.2f});                                                  // chin
    for (const double side : {1.0, -1.0}) ear(side);
    curl();
  }

  void features() {
    for (const double side : {1.0, -1.0}) eye(side);
    mouth();
    nose();
    teeth();
    whiskers();
    for (const double side : {1.0, -1.0}) earHollow(side);
  }

  [[nodiscard]] const sculpt::StrokeLog& log() const { return sculptor_.log(); }

 private:
  static constexpr int kEarLayers = 21;

  /// Half the width of the ear's core at layer k: narrow at the root, widest below the middle, pointed.
  static double earHalfWidth(int k) {
    const double t = static_cast<double>(k) / (kEarLayers - 1);
    return 0.03 + 0.15 * 4 * t * (1 - t) * (1.25 - 0.6 * t);
  }
  /// Radius of the brush at layer k, which is also what the layer adds to the ear's height.
  static double earRadius(int k) {
    const double t = static_cast<double>(k) / (kEarLayers - 1);
    return 0.095 - 0.035 * t * t;
  }
  /// Direction in which the ear grows at layer k: up and outwards, leaning back.
  static DVec3 earDirection(double side, int k) {
    const double t = static_cast<double>(k) / kEarLayers;
    return normalized({side * (0.10 + 0.42 * t), 1, -0.10 - 0.12 * t});
  }

  /// A line on the surface between two places, seen by the camera.
  void bow(const Camera& camera, DVec3 from, DVec3 to, const Brush& brush) {
    draw(camera, straight(from, to, 25), brush);
  }

  /// A click of the pen, seen from the front.
  void dab(DVec3 at, const Brush& brush) { draw(front_, {{at, 1}}, brush); }

  void draw(const Camera& camera, const std::vector<Aim>& aims, const Brush& brush) {
    sculptor_.drawOn(camera, aims, brush);
  }

  void ear(double side) {
    auto& spine = spine_[side > 0 ? 0 : 1];
    DVec3 tip = normalized({side * 0.34, 0.93, -0.08});
    for (int k = 0; k < kEarLayers; ++k) {
      const DVec3 grow = earDirection(side, k);
      const DVec3 across = normalized(cross(grow, DVec3(0, 0, 1)));
      const DVec3 eye = tip + grow * 3.0;
      tip = sculptor_.surfaceSeen(eye, tip);
      spine[static_cast<std::size_t>(k)] = tip;
      std::vector<Aim> aims;
      constexpr int kPoints = 16;
      for (int i = 0; i <= kPoints; ++i)
        aims.push_back({tip + across * ((2.0 * i / kPoints - 1) * earHalfWidth(k)), 1});
      draw(cameraAt(eye, tip, {0, 0, 1}), aims,
           {.radius = static_cast<float>(earRadius(k)), .spacing = 0.2f});
      tip = tip + grow * earRadius(k);
    }
  }

  /// Carved from the front, in lines along the ear that keep off its rim.
  void earHollow(double side) {
    const auto& spine = spine_[side > 0 ? 0 : 1];
    const DVec3 middle = spine[kEarLayers / 2];
    const Camera camera = cameraAt(middle + DVec3(side * 0.5, 0.1, 4.2), middle);
    for (const double column : {-0.7, 0.7, -0.25, 0.25}) {
      std::vector<Aim> aims;
      constexpr int kPoints = 80;
      const double from = 3.5 + 3 * std::fabs(column), to = kEarLayers - 2.5 - 4 * std::fabs(column);
      for (int i = 0; i <= kPoints; ++i) {
        const double t = static_cast<double>(i) / kPoints, layer = from + (to - from) * t;
        const int k = static_cast<int>(layer);
        const double f = layer - k;
        const DVec3 at =
            spine[static_cast<std::size_t>(k)] * (1 - f) + spine[static_cast<std::size_t>(k) + 1] * f;
        const double width = earHalfWidth(k) * (1 - f) + earHalfWidth(k + 1) * f;
        const DVec3 across = normalized(cross(earDirection(side, k), DVec3(0, 0, 1)));
        aims.push_back({at + across * (column * width), 0.6 + 0.4 * 4 * t * (1 - t)});
      }
      draw(camera, aims, {.radius = 0.07f, .spacing = 0.15f, .pressureToRadius = 1.0f, .mode = Mode::Carve});
    }
  }

  /// A curl on the forehead, from inside out, that ends in a lock.
  void curl() {
    const DVec3 middle = normalized({0.02, 0.86, 0.52});
    const Camera camera = cameraAt(middle * 4.5 + DVec3(0.3, 0, 0), middle);
    const DVec3 right = normalized(cross(DVec3(0, 1, 0), middle)), up = cross(middle, right);
    std::vector<Aim> aims;
    constexpr int kPoints = 70;
    for (int i = 0; i <= kPoints; ++i) {
      const double t = static_cast<double>(i) / kPoints, away = 0.19 * t;
      const Turn at = turn(0.35 - 1.75 * t);
      const DVec3 aim = middle + right * (away * at.cos) + up * (away * at.sin);
      aims.push_back({normalized(aim), t < 0.7 ? 0.55 + 0.45 * t / 0.7 : 1 - 0.8 * (t - 0.7) / 0.3});
    }
    draw(camera, aims, {.radius = 0.065f, .spacing = 0.15f, .pressureToRadius = 1.0f});
  }

  /// A tall hollow with a pupil in it.
  void eye(double side) {
    bow(front_, {side * 0.34, 0.31, 0.9}, {side * 0.34, 0.15, 0.9},
        {.radius = 0.155f, .spacing = 0.1f, .mode = Mode::Carve});
    dab({side * 0.34 - 0.01, 0.18, 0.84}, {.radius = 0.115f});
  }

  /// An open smile between muzzle and chin.
  void mouth() {
    std::vector<Aim> aims;
    constexpr int kPoints = 40;
    for (int i = 0; i <= kPoints; ++i) {
      const double t = 2.0 * i / kPoints - 1;
      aims.push_back({DVec3(0.13 * t, -0.61 + 0.05 * t * t, 1.0), 1 - 0.5 * t * t});
    }
    draw(front_, aims, {.radius = 0.09f, .spacing = 0.1f, .pressureToRadius = 1.0f, .mode = Mode::Carve});
  }

  void nose() { dab({0, -0.19, 1.28}, {.radius = 0.12f}); }

  void teeth() {
    for (const double side : {1.0, -1.0}) dab({side * 0.06, -0.55, 1.05}, {.radius = 0.07f});
  }

  void whiskers() {
    for (const double side : {1.0, -1.0})
      for (const double row : {-1.0, 0.0, 1.0}) {
        const Camera camera = cameraAt({side * 2.4, 0.2, 3.6}, {side * 0.4, -0.3, 0.8});
        std::vector<Aim> aims;
        constexpr int kPoints = 30;
        for (int i = 0; i <= kPoints; ++i) {
          const double t = static_cast<double>(i) / kPoints;
          aims.push_back(
              {DVec3(side * (0.34 + 0.34 * t), -0.34 + 0.07 * row + 0.07 * row * t + 0.05 * t * (1 - t),
                     1.12 - 0.45 * t * t),
               1 - 0.7 * t});
        }
        draw(camera, aims,
             {.radius = 0.022f, .spacing = 0.25f, .pressureToRadius = 1.0f, .mode = Mode::Carve});
      }
  }

  Sculptor sculptor_;
  Camera front_ = cameraAt({0, 0.3, 5.2}, {0, 0.1, 0.3});
  Camera face_ = cameraAt({0.9, 0.5, 5.2}, {0, 0.1, 0.3});
  std::array<std::array<DVec3, kEarLayers>, 2> spine_{};
};

}  // namespace

sculpt::StrokeLog rabbitLog() {
  sculpt::LogHeader header;
  header.density = 12000;
  header.base = implicit::Sphere{.center = {0, 0, 0}, .radius = 1};
  Rabbit rabbit(header);
  rabbit.foundation();
  rabbit.features();
  return rabbit.log();
}

}  // namespace restroke::experiments
