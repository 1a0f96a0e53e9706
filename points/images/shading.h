#pragma once
// How clay looks: lights, material, background. Internal to the renderers; gl_shaders.h has the same formulas
// in GLSL. No libm but sqrt, so that pictures are the same on every machine.

#include <array>
#include <cmath>

#include "points/images/scene.h"

namespace restroke::points {

/// Lights, in camera space: x right, y up, z towards the viewer. Directions are unit vectors towards the
/// light.
struct Look {
  Vec3 key = {-0.4862f, 0.6806f, 0.5480f};  // from the upper left, as in a studio
  Vec3 fill = {0.8216f, 0.0657f, 0.5663f};  // opposite, weak and cool
  Vec3 rim = {0.4045f, 0.5300f, -0.7453f};  // from behind: draws the silhouette
  Vec3 keyColor = {1.06f, 1.00f, 0.91f};
  Vec3 fillColor = {0.16f, 0.20f, 0.27f};
  Vec3 rimColor = {0.50f, 0.55f, 0.62f};
  Vec3 sky = {0.30f, 0.33f, 0.38f};
  Vec3 ground = {0.17f, 0.14f, 0.12f};
  float wrap = 0.22f;   // how far the key light reaches round the terminator
  float gloss = 0.10f;  // strength of the broad highlight
  float sheen = 0.16f;  // brightening at grazing angles, as on dry clay
};

/// Screen-space occlusion (occlusion.h), shared with the GLSL.
namespace occlusion {

struct Tap {
  float x, y;  // in radii of the pattern
};
/// A spiral by the golden angle, denser near the centre, where creases are. No two taps share a distance, so
/// that no rings show.
inline constexpr std::array<Tap, 32> kTaps = {{
    {0.0442f, 0.0000f},   {-0.0743f, 0.0680f},  {0.0129f, -0.1472f}, {0.1157f, 0.1509f},
    {-0.2261f, -0.0400f}, {0.2252f, -0.1433f},  {-0.0785f, 0.2922f}, {-0.1553f, -0.2989f},
    {0.3475f, 0.1269f},   {-0.3718f, 0.1535f},  {0.1838f, -0.3927f}, {0.1389f, 0.4429f},
    {-0.4275f, -0.2477f}, {0.5113f, -0.1124f},  {-0.3176f, 0.4518f}, {-0.0746f, -0.5758f},
    {0.4653f, 0.3921f},   {-0.6354f, 0.0263f},  {0.4700f, -0.4677f}, {-0.0319f, 0.6890f},
    {-0.4588f, -0.5498f}, {0.7355f, 0.0990f},   {-0.6303f, 0.4385f}, {0.1741f, -0.7740f},
    {0.4069f, 0.7102f},   {-0.8035f, -0.2563f}, {0.7881f, -0.3641f}, {-0.3446f, 0.8234f},
    {-0.3103f, -0.8627f}, {0.8328f, 0.4377f},   {-0.9328f, 0.2459f}, {0.5345f, -0.8313f},
}};
/// The pattern's radius on the screen, as a part of the image's height.
inline constexpr float kRadius = 1.0f / 15.0f;
inline constexpr float kStrength = 2.4f;
inline constexpr float kDarkest = 0.30f;
/// Surfaces that a tap meets at a lower angle than this (sine) are taken for flat.
inline constexpr float kBias = 0.06f;
inline constexpr float kCavityDark = 0.30f, kCavityLight = 0.14f;

}  // namespace occlusion

/// Colour of a point with unit normal n, unit direction v towards the viewer, and the albedo.
[[nodiscard]] inline Vec3 shade(const Look& look, Vec3 n, Vec3 v, Vec3 albedo) {
  const auto positive = [](float x) { return x > 0.0f ? x : 0.0f; };
  const float key = dot(n, look.key);
  float diffuse = positive((key + look.wrap) / (1.0f + look.wrap));
  diffuse *= 0.35f + 0.65f * diffuse;  // between linear and squared: soft terminator, no flat plateau
  const float fill = positive(0.5f + 0.5f * dot(n, look.fill));
  const float rim = positive(dot(n, look.rim));
  const float up = 0.5f + 0.5f * n.y;
  const float facing = positive(dot(n, v));
  const float graze = 1.0f - facing;
  const float graze2 = graze * graze;
  // Highlight: the key light's mirror direction against the viewer's.
  const float mirror = positive(2.0f * key * dot(n, v) - dot(look.key, v));
  const float m2 = mirror * mirror, m4 = m2 * m2, m8 = m4 * m4;
  const float highlight = look.gloss * (0.35f * m4 + 0.65f * m8 * m8 * m2);
  const float sheen = look.sheen * graze2 * graze;
  const Vec3 ambient = look.ground + (look.sky - look.ground) * up;
  const Vec3 light = look.keyColor * diffuse + look.fillColor * (fill * fill) + ambient;
  return albedo * light + look.keyColor * highlight + look.rimColor * (rim * graze2 * 0.9f) +
         (albedo * 0.5f + Vec3(0.5f)) * (sheen * up);
}

/// Albedo of a blend: parts of added and carved surface, the rest is base.
[[nodiscard]] inline Vec3 albedoOf(const Palette& palette, float added, float carved) {
  const auto color = [](const LinearColor& c) { return Vec3(c[0], c[1], c[2]); };
  return color(palette.base) * (1.0f - added - carved) + color(palette.added) * added +
         color(palette.carved) * carved;
}

}  // namespace restroke::points
