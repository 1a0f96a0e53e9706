#pragma once
// GLSL of the OpenGL renderer. The algebra is that of simd/project.inc and simd/raster.inc, the look that of
// shading.h and occlusion.cpp. Every program is `kGlslVersion`, then constants (lookConstants), then one of
// these.

#include <fmt/format.h>

#include <string>

#include "points/images/screen_disc.h"
#include "points/images/shading.h"

namespace restroke::points {

inline constexpr const char* kGlslVersion = "#version 330 core\n";

/// The constants of the look and of the geometry as GLSL.
inline std::string lookConstants(const Look& look) {
  const auto vector = [](const char* name, Vec3 v) {
    return fmt::format("const vec3 {} = vec3({:.9e}, {:.9e}, {:.9e});\n", name, v.x, v.y, v.z);
  };
  const auto scalar = [](const char* name, double v) {
    return fmt::format("const float {} = {:.9e};\n", name, v);
  };
  std::string text = vector("kKey", look.key) + vector("kFill", look.fill) + vector("kRim", look.rim) +
                     vector("kKeyColor", look.keyColor) + vector("kFillColor", look.fillColor) +
                     vector("kRimColor", look.rimColor) + vector("kSky", look.sky) +
                     vector("kGround", look.ground) + scalar("kWrap", look.wrap) +
                     scalar("kGloss", look.gloss) + scalar("kSheen", look.sheen) +
                     scalar("kEdgeOnCosine", kEdgeOnCosine) + scalar("kRadius", occlusion::kRadius) +
                     scalar("kStrength", occlusion::kStrength) + scalar("kDarkest", occlusion::kDarkest) +
                     scalar("kBias", occlusion::kBias) + scalar("kCavityDark", occlusion::kCavityDark) +
                     scalar("kCavityLight", occlusion::kCavityLight);
  text += fmt::format("const int kTapCount = {};\nconst vec2 kTaps[kTapCount] = vec2[](",
                      occlusion::kTaps.size());
  for (std::size_t i = 0; i < occlusion::kTaps.size(); ++i)
    text +=
        fmt::format("{}vec2({:.6f}, {:.6f})", i ? ", " : "", occlusion::kTaps[i].x, occlusion::kTaps[i].y);
  return text + ");\n";
}

/// A disc's box on the screen, as a strip of four corners; discs that are not seen end outside the clip
/// volume. Row 0 of the image is row 0 of the framebuffer: y is not turned over.
inline constexpr const char* kDiscVertexShader = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float radius;
layout(location = 3) in float kind;
uniform vec3 eye, rightAxis, upAxis, forwardAxis;
uniform vec2 tangent;    // half extents of the image at unit distance
uniform vec2 size;       // of the framebuffer, pixels
uniform vec2 clip;       // near, far
flat out ivec2 discPixel;
flat out vec2 discFraction;
flat out vec3 wTerms, uTerms, vTerms;  // constant, per dx, per dy
flat out vec4 normalAndWindow;
flat out float discKind;

vec2 tangents(float c, float n, float cz, float nz, float r2) {
  float a = cz * cz - r2 * (1.0 - nz * nz);
  float b = c * cz + r2 * n * nz;
  float e = c * c - r2 * (1.0 - n * n);
  float root = sqrt(max(b * b - a * e, 0.0));
  return vec2(b - root, b + root) / a;
}

void main() {
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  discPixel = ivec2(0);
  discFraction = vec2(0.0);
  wTerms = uTerms = vTerms = vec3(0.0);
  normalAndWindow = vec4(0.0);
  discKind = kind;
  vec3 d = position - eye;
  vec3 c = vec3(dot(d, rightAxis), dot(d, upAxis), dot(d, forwardAxis));
  vec3 n = vec3(dot(normal, rightAxis), dot(normal, upAxis), dot(normal, forwardAxis));
  float h = dot(n, c);
  if (!(h < 0.0) || !(h * h > kEdgeOnCosine * kEdgeOnCosine * dot(c, c)) || !(radius > 0.0)) return;
  float reach = radius * sqrt(max(1.0 - n.z * n.z, 0.0));
  if (!(c.z + reach >= clip.x) || !(c.z - reach <= clip.y)) return;

  vec2 first = vec2(-tangent.x, tangent.y);
  vec2 perPixel = vec2(2.0, -2.0) * tangent / size;
  vec2 low = vec2(0.0), high = size;
  if (c.z - reach > 1e-6 * abs(c.z)) {
    vec2 x = tangents(c.x, n.x, c.z, n.z, radius * radius);
    vec2 y = tangents(c.y, n.y, c.z, n.z, radius * radius);
    // Half a pixel more than the exact box: rasterisation then includes every pixel whose centre is in it.
    low = max(low, vec2((x.x - first.x) / perPixel.x, (y.y - first.y) / perPixel.y) - 0.5);
    high = min(high, vec2((x.y - first.x) / perPixel.x, (y.x - first.y) / perPixel.y) + 0.5);
    if (!(low.x < high.x && low.y < high.y)) return;
  }
  vec2 reference = 0.5 * size;
  bool atCenter = false;
  if (c.z > 0.0) {
    vec2 p = (c.xy / c.z - first) / perPixel;
    if (all(greaterThan(p, -size)) && all(lessThan(p, 2.0 * size))) {
      reference = p;
      atCenter = true;
    }
  }
  vec2 whole = floor(reference);
  vec3 towards = vec3(first + perPixel * reference, 1.0);

  vec3 axis = vec3(1.0, 0.0, 0.0);
  vec3 a = abs(n);
  if (a.y <= a.x && a.y <= a.z) axis = vec3(0.0, 1.0, 0.0);
  if (a.z <= a.x && a.z < a.y) axis = vec3(0.0, 0.0, 1.0);
  vec3 u = normalize(cross(n, axis)) / radius;
  vec3 v = cross(n, u);
  vec2 uvc = vec2(dot(u, c), dot(v, c));
  wTerms = vec3(dot(n, towards), n.xy * perPixel) / h;
  uTerms = vec3(dot(u, towards), u.xy * perPixel) - wTerms * uvc.x;
  vTerms = vec3(dot(v, towards), v.xy * perPixel) - wTerms * uvc.y;
  // At the centre w is 1 / depth, u and v are 0; what would be left is rounding.
  if (atCenter) {
    wTerms.x = 1.0 / c.z;
    uTerms.x = vTerms.x = 0.0;
  }
  discPixel = ivec2(whole);
  discFraction = reference - whole;
  normalAndWindow = vec4(n.xy, -n.z, 2.0 * radius * wTerms.x * wTerms.x);
  vec2 corner = mix(low, high, vec2(gl_VertexID & 1, gl_VertexID >> 1));
  gl_Position = vec4(2.0 * corner / size - 1.0, 0.0, 1.0);
}
)";

/// Common head of the two fragment shaders of discs.
inline constexpr const char* kDiscFragmentHead = R"(
flat in ivec2 discPixel;
flat in vec2 discFraction;
flat in vec3 wTerms, uTerms, vTerms;
flat in vec4 normalAndWindow;
flat in float discKind;
uniform vec2 clip;

// 1 / depth where the ray meets the plane, and the squared distance from the centre in radii, times w^2.
vec2 meet() {
  vec3 d = vec3(1.0, (floor(gl_FragCoord.xy) - vec2(discPixel)) + (0.5 - discFraction));
  float w = dot(wTerms, d), u = dot(uTerms, d), v = dot(vTerms, d);
  return vec2(w, u * u + v * v);
}
)";

/// Nearest disc; the depth buffer holds near / depth.
inline constexpr const char* kDepthFragmentShader = R"(
void main() {
  vec2 m = meet();
  if (!(m.y <= m.x * m.x) || !(m.x * clip.x <= 1.0) || !(m.x * clip.y > 1.0)) discard;
  gl_FragDepth = clip.x * m.x;
}
)";

/// Sums of what lies within a disc's window behind the nearest.
inline constexpr const char* kBlendFragmentShader = R"(
uniform sampler2D nearest;
layout(location = 0) out vec4 normalSum;
layout(location = 1) out vec4 kindSum;
void main() {
  vec2 m = meet();
  float best = texelFetch(nearest, ivec2(gl_FragCoord.xy), 0).r / clip.x;
  float w2 = m.x * m.x;
  if (!(m.y <= w2) || !(m.x <= best * 1.0000005) || !(m.x + normalAndWindow.w >= best)) discard;
  float inside = 1.0 - m.y / w2;
  float weight = inside * inside + 1e-4;
  normalSum = vec4(normalAndWindow.xyz, 1.0) * weight;
  kindSum = vec4(discKind == 1.0, discKind == 2.0, 0.0, 0.0) * weight;
}
)";

/// A triangle that covers the framebuffer.
inline constexpr const char* kScreenVertexShader = R"(
void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
)";

/// One pixel of the picture from its scale x scale samples, with occlusion at its middle sample.
inline constexpr const char* kShadeFragmentShader = R"(
uniform sampler2D nearest, normals, kinds;
uniform vec2 tangent, size, clip;  // size: of the picture, pixels
uniform int scale;
uniform bool occluded;
uniform vec3 baseColor, addedColor, carvedColor;
out vec4 color;

ivec2 middle(ivec2 pixel) { return pixel * scale + scale / 2; }
vec3 directionAt(vec2 place) {
  return vec3((2.0 * place.x / size.x - 1.0) * tangent.x, (1.0 - 2.0 * place.y / size.y) * tangent.y, -1.0);
}
float depthAt(ivec2 pixel) {
  float d = texelFetch(nearest, middle(pixel), 0).r;
  return d > 0.0 ? clip.x / d : -1.0;
}
vec3 normalAt(ivec2 pixel) {
  vec3 sum = texelFetch(normals, middle(pixel), 0).xyz;
  return sum / max(length(sum), 1e-20);
}
vec3 positionAt(ivec2 pixel, float depth) { return directionAt(vec2(pixel) + 0.5) * depth; }
bool isInside(ivec2 p) { return p.x >= 0 && p.y >= 0 && p.x < int(size.x) && p.y < int(size.y); }

vec3 shade(vec3 n, vec3 v, vec3 albedo) {
  float key = dot(n, kKey);
  float diffuse = max((key + kWrap) / (1.0 + kWrap), 0.0);
  diffuse *= 0.35 + 0.65 * diffuse;
  float fill = max(0.5 + 0.5 * dot(n, kFill), 0.0);
  float rim = max(dot(n, kRim), 0.0);
  float up = 0.5 + 0.5 * n.y;
  float graze = 1.0 - max(dot(n, v), 0.0);
  float graze2 = graze * graze;
  float mirror = max(2.0 * key * dot(n, v) - dot(kKey, v), 0.0);
  float m2 = mirror * mirror, m4 = m2 * m2, m8 = m4 * m4;
  float highlight = kGloss * (0.35 * m4 + 0.65 * m8 * m8 * m2);
  float sheen = kSheen * graze2 * graze;
  vec3 light = kKeyColor * diffuse + kFillColor * (fill * fill) + kGround + (kSky - kGround) * up;
  return albedo * light + kKeyColor * highlight + kRimColor * (rim * graze2 * 0.9) +
         (albedo * 0.5 + 0.5) * (sheen * up);
}

float blocked(ivec2 pixel, float depth) {
  vec3 p = positionAt(pixel, depth), n = normalAt(pixel);
  float pixels = kRadius * size.y;
  float reach = pixels * 2.0 * tangent.x / size.x * depth;
  float sum = 0.0;
  for (int i = 0; i < kTapCount; ++i) {
    ivec2 at = pixel + ivec2(kTaps[i] * pixels);
    if (!isInside(at) || at == pixel) continue;
    float tapDepth = depthAt(at);
    if (tapDepth < 0.0) continue;
    vec3 d = positionAt(at, tapDepth) - p;
    float d2 = dot(d, d);
    if (d2 >= reach * reach) continue;
    sum += max(dot(d, n) / sqrt(d2 + 1e-20) - kBias, 0.0) * (1.0 - d2 / (reach * reach));
  }
  return min(sum * kStrength / float(kTapCount), 1.0);
}

vec3 neighbour(ivec2 pixel, ivec2 at, float depth, float limit) {
  if (!isInside(at)) return normalAt(pixel);
  float d = depthAt(at);
  return d > 0.0 && abs(d - depth) < limit ? normalAt(at) : normalAt(pixel);
}

float cavity(ivec2 pixel, float depth) {
  int s = max(1, int(size.y) / 500);
  float limit = 6.0 * float(s) * 2.0 * tangent.x / size.x * depth;
  ivec2 dx = ivec2(s, 0), dy = ivec2(0, s);
  float bendX = neighbour(pixel, pixel + dx, depth, limit).x - neighbour(pixel, pixel - dx, depth, limit).x;
  float bendY = neighbour(pixel, pixel - dy, depth, limit).y - neighbour(pixel, pixel + dy, depth, limit).y;
  float bend = clamp(bendX + bendY, -1.0, 1.0);
  return 1.0 + (bend < 0.0 ? kCavityDark : kCavityLight) * bend;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  color = vec4(0.0);
  for (int j = 0; j < scale; ++j)
    for (int i = 0; i < scale; ++i) {
      ivec2 at = pixel * scale + ivec2(i, j);
      if (texelFetch(nearest, at, 0).r <= 0.0) continue;
      vec4 sum = texelFetch(normals, at, 0);
      vec2 kind = texelFetch(kinds, at, 0).xy / sum.w;
      vec3 albedo = baseColor * (1.0 - kind.x - kind.y) + addedColor * kind.x + carvedColor * kind.y;
      vec3 v = -normalize(directionAt(vec2(pixel) + (vec2(i, j) + 0.5) / float(scale)));
      color += vec4(shade(normalize(sum.xyz), v, albedo), 1.0);
    }
  color /= float(scale * scale);
  float depth = depthAt(pixel);
  if (occluded && depth > 0.0)
    color.rgb *= (1.0 - (1.0 - kDarkest) * blocked(pixel, depth)) * cavity(pixel, depth);
}
)";

}  // namespace restroke::points
