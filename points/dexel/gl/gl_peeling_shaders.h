#pragma once
// GLSL of sampling a mesh by drawing it (gl_tri_dexel.h says how). A fragment is two numbers: its depth as
// orderOf gives it, and twice the triangle's number, plus 1 where the triangle faces along the line. In their
// order no two fragments of a line are alike but those of one triangle drawn twice, and these are one.

namespace restroke::points {

/// Triangles of the posed mesh, rounded to float32, and their packed normals.
inline constexpr const char* kPoseMain = R"(
layout(local_size_x = 256) in;
layout(std430, binding = 0) readonly buffer Source { float source[]; };
layout(std430, binding = 1) writeonly buffer Posed { float posed[]; };
layout(std430, binding = 2) writeonly buffer Normals { uint normals[]; };
uniform uint triangleCount;
uniform dvec4 pose[3];  // rows

// packNormal, in double.
uint packNormal(dvec3 n) {
  double sum = abs(n.x) + abs(n.y) + abs(n.z);
  if (!(sum > 0.0lf)) return packFolded(ivec2(0));
  double scale = double(kMost) / sum;
  dvec2 f = n.xy * scale;
  ivec2 i = ivec2(int(f.x + (f.x < 0.0lf ? -0.5lf : 0.5lf)), int(f.y + (f.y < 0.0lf ? -0.5lf : 0.5lf)));
  return packFolded(n.z < 0.0lf ? fold(i) : i);
}
float along(dvec4 row, dvec3 p) {
  precise double sum = row.x * p.x;
  precise double y = row.y * p.y, z = row.z * p.z;
  sum = sum + y;
  sum = sum + z;
  sum = sum + row.w;
  return float(sum);
}
void main() {
  uint triangle = gl_GlobalInvocationID.x;
  if (triangle >= triangleCount) return;
  dvec3 corners[3];
  for (uint corner = 0u; corner < 3u; ++corner) {
    uint i = 9u * triangle + 3u * corner;
    dvec3 p = dvec3(source[i], source[i + 1u], source[i + 2u]);
    vec3 moved = vec3(along(pose[0], p), along(pose[1], p), along(pose[2], p));
    for (uint k = 0u; k < 3u; ++k) posed[i + k] = moved[k];
    corners[corner] = dvec3(moved);
  }
  normals[triangle] = packNormal(cross(corners[1] - corners[0], corners[2] - corners[0]));
}
)";

/// The polygons to draw: each triangle, with a square about every corner, convex (J. Hasselgren, T.
/// Akenine-Moeller, L. Ohlsson, Conservative Rasterization, GPU Gems 2, 2005, chapter 42). Whatever the
/// driver's rounding of places on the screen, the triangle's own lines are among those drawn. Of a triangle
/// that reaches far beyond the screen it is the triangle's box within the screen. Triangles seen edge-on have
/// none, where that is sure.
inline constexpr const char* kHullMain = R"(
layout(local_size_x = 256) in;
layout(std430, binding = 0) readonly buffer Posed { float posed[]; };
layout(std430, binding = 1) writeonly buffer Places { float places[]; };  // pixels
uniform uint triangleCount;
uniform ivec2 axes;
uniform dvec2 firstLine;  // coordinates of the line of pixel (0, 0)
uniform double cell;
uniform ivec2 lineCounts;  // columns, rows

const float kMargin = 0.125;    // drivers round places to 1/16 pixel or better
const double kFar = 32768.0lf;  // beyond, they clip, with rounding of their own
const vec2 kCorners[4] = vec2[](vec2(1, 1), vec2(-1, 1), vec2(-1, -1), vec2(1, -1));

bool isBefore(dvec2 a, dvec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }
void swap(inout dvec2 a, inout dvec2 b) {
  dvec2 c = a;
  a = b;
  b = c;
}
// Which corner of a square is farthest to the right of an edge.
int cornerOf(dvec2 edge) {
  return edge.y >= 0.0lf ? (edge.x <= 0.0lf ? 0 : 3) : (edge.x <= 0.0lf ? 1 : 2);
}
void main() {
  uint triangle = gl_GlobalInvocationID.x;
  if (triangle >= triangleCount) return;
  dvec2 p[3];
  for (uint k = 0u; k < 3u; ++k)
    p[k] = dvec2(posed[9u * triangle + 3u * k + uint(axes.x)], posed[9u * triangle + 3u * k + uint(axes.y)]);
  precise double right = (p[1].x - p[0].x) * (p[2].y - p[0].y);
  precise double left = (p[1].y - p[0].y) * (p[2].x - p[0].x);
  uint written = 14u * triangle, stop = written + 14u;
  vec2 place = vec2(-16.0);  // not seen
  int corners = 3;
  if (right == left) {
    // For sure seen edge-on, or it may be rounding: then it is drawn as the segment that it seems to be.
    corners = 0;
    if (!(p[0].x == p[1].x && p[1].x == p[2].x) && !(p[0].y == p[1].y && p[1].y == p[2].y)) {
      corners = 2;
      if (isBefore(p[1], p[0])) swap(p[0], p[1]);
      if (isBefore(p[2], p[0])) swap(p[0], p[2]);
      if (isBefore(p[1], p[2])) swap(p[1], p[2]);
    }
  } else if (right < left) {
    swap(p[1], p[2]);
  }
  if (corners > 0) {
    dvec2 pixel[3];
    for (int k = 0; k < 3; ++k) pixel[k] = (p[k] - firstLine) / cell + 0.5lf;
    dvec2 low = min(pixel[0], min(pixel[1], pixel[2])), high = max(pixel[0], max(pixel[1], pixel[2]));
    if (all(greaterThan(low, dvec2(-kFar))) && all(lessThan(high, dvec2(kFar)))) {
      for (int k = 0; k < corners; ++k) {
        int corner = cornerOf(p[k] - p[(k + corners - 1) % corners]);
        int last = cornerOf(p[(k + 1) % corners] - p[k]);
        for (int turns = (last - corner + 4) % 4; turns >= 0 && written < stop; --turns) {
          place = vec2(pixel[k]) + kMargin * kCorners[corner];
          places[written++] = place.x;
          places[written++] = place.y;
          corner = (corner + 1) % 4;
        }
      }
    } else {
      low = max(low - double(kMargin), dvec2(-1.0lf));
      high = min(high + double(kMargin), dvec2(lineCounts) + 1.0lf);
      if (low.x < high.x && low.y < high.y)
        for (int k = 0; k < 4; ++k) {
          place = vec2(kCorners[k].x > 0.0 ? high.x : low.x, kCorners[k].y > 0.0 ? high.y : low.y);
          places[written++] = place.x;
          places[written++] = place.y;
        }
    }
  }
  while (written < stop) {
    places[written++] = place.x;
    places[written++] = place.y;
  }
}
)";

inline constexpr const char* kPeelVertexMain = R"(
layout(location = 0) in vec2 place;
uniform vec2 size;
uniform float firstRow;
flat out uint triangle;
void main() {
  triangle = uint(gl_VertexID) / 7u;
  gl_Position = vec4(2.0 * place.x / size.x - 1.0, 2.0 * (place.y - firstRow) / size.y - 1.0, 0.0, 1.0);
}
)";

/// Does the line of this pixel pass through the triangle, and where? The rest of the programs is one of the
/// mains below.
///
/// The side of an edge is the sign of a difference of products in double, computed in the same way for both
/// triangles at the edge; products are exact unless the corners' magnitudes are far apart. A line through an
/// edge or a corner is taken as moved by a distance smaller than any number in u, and one smaller still in v,
/// as crossingOf (exact_predicates.h) does. A ray across the line's plane meets each edge or not, whichever
/// triangle asks, so that a closed mesh is crossed an even number of times whatever the rounding.
inline constexpr const char* kPeelFragment = R"(
layout(std430, binding = 0) readonly buffer Triangles { float triangles[]; };
layout(std430, binding = 1) readonly buffer Columns { float columns[]; };
layout(std430, binding = 2) readonly buffer Rows { float rows[]; };
uniform uint firstTriangle;  // of those that are bound
uniform uint firstRowOfBand;
uniform uint width;
uniform ivec3 axes;  // along, columns, rows
flat in uint triangle;

dvec3 cornerAt(uint k) {
  uint i = 9u * triangle + 3u * k;
  return dvec3(triangles[i + uint(axes.x)], triangles[i + uint(axes.y)], triangles[i + uint(axes.z)]);
}
bool isCrossed(dvec3 a, dvec3 b, dvec2 p) {
  bool above = a.z > p.y;
  if (above == (b.z > p.y)) return false;
  dvec2 low = above ? b.yz : a.yz, high = above ? a.yz : b.yz;
  precise double right = (high.x - low.x) * (p.y - low.y);
  precise double left = (high.y - low.y) * (p.x - low.x);
  return right > left;
}
uint lineOfPixel() { return uint(gl_FragCoord.y) * width + uint(gl_FragCoord.x); }

bool meets(out uvec2 fragment) {
  fragment = uvec2(0u);
  dvec2 p = dvec2(columns[uint(gl_FragCoord.x)], rows[uint(gl_FragCoord.y) + firstRowOfBand]);
  dvec3 a = cornerAt(0u), b = cornerAt(1u), c = cornerAt(2u);
  if ((isCrossed(a, b, p) != isCrossed(b, c, p)) == isCrossed(c, a, p)) return false;
  dvec3 ab = b - a, ac = c - a;
  precise dvec3 n = dvec3(ab.y * ac.z - ab.z * ac.y, ab.z * ac.x - ab.x * ac.z, ab.x * ac.y - ab.y * ac.x);
  double low = min(a.x, min(b.x, c.x)), high = max(a.x, max(b.x, c.x));
  double depth = low;
  if (n.x != 0.0lf) {
    precise double rise = (n.y * (p.x - a.y) + n.z * (p.y - a.z)) / n.x;
    depth = clamp(a.x - rise, low, high);
  }
  fragment = uvec2(orderOf(floatBitsToUint(float(depth))), 2u * (firstTriangle + triangle) + uint(n.x > 0.0lf));
  return true;
}
)";

/// How many there are on each line.
inline constexpr const char* kCountFragmentsMain = R"(
layout(std430, binding = 3) buffer Counts { uint counts[]; };
void main() {
  uvec2 fragment;
  if (meets(fragment)) atomicAdd(counts[lineOfPixel()], 1u);
}
)";

/// All of them, in the order in which they come.
inline constexpr const char* kGatherFragmentsMain = R"(
layout(std430, binding = 3) buffer Cursors { uint cursors[]; };
layout(std430, binding = 4) writeonly buffer Fragments { uvec2 fragments[]; };
void main() {
  uvec2 fragment;
  if (meets(fragment)) fragments[atomicAdd(cursors[lineOfPixel()], 1u)] = fragment;
}
)";

/// The nearest beyond the layer before: first its depth, then, with SECOND, which of those at this depth.
inline constexpr const char* kLayerMain = R"(
layout(std430, binding = 3) readonly buffer Before { uvec2 layerBefore[]; };
layout(std430, binding = 4) buffer Nearest { uint nearest[]; };
void main() {
  uvec2 fragment;
  if (!meets(fragment)) return;
  uint line = lineOfPixel();
  uvec2 last = layerBefore[line];
  if (fragment.x < last.x || (fragment.x == last.x && fragment.y <= last.y)) return;
#ifdef SECOND
  if (nearest[2u * line] == fragment.x) atomicMin(nearest[2u * line + 1u], fragment.y);
#else
  atomicMin(nearest[2u * line], fragment.x);
#endif
}
)";

/// Counts a layer, and how many of its lines have something.
inline constexpr const char* kTakeLayerMain = R"(
layout(std430, binding = 3) readonly buffer Layer { uvec2 layer[]; };
layout(std430, binding = 4) buffer Counts { uint counts[]; };
layout(std430, binding = 5) buffer Found { uint found; };
void main() {
  uint line = gl_GlobalInvocationID.x;
  if (line >= lineCount || layer[line].x == kNone) return;
  ++counts[line];
  atomicAdd(found, 1u);
}
)";

/// Puts a layer in its place among the fragments of its lines.
inline constexpr const char* kPlaceLayerMain = R"(
layout(std430, binding = 0) readonly buffer Offsets { uint offsets[]; };
layout(std430, binding = 1) writeonly buffer Fragments { uvec2 fragments[]; };
layout(std430, binding = 3) readonly buffer Layer { uvec2 layer[]; };
uniform uint number;
void main() {
  uint line = gl_GlobalInvocationID.x;
  if (line < lineCount && layer[line].x != kNone) fragments[offsets[line] + number] = layer[line];
}
)";

/// Entries and exits in turn. Of crossings at one depth an even number is none, and an odd one is one, of a
/// triangle that faces as it should where there is such. Without its exit the last entry of a line is
/// dropped, and the line marked as odd. With PARTS an item stops after kMostWork fragments, to be gone on
/// with.
inline constexpr const char* kPairMain = R"(
layout(std430, binding = 0) readonly buffer Offsets { uint offsets[]; };
layout(std430, binding = 1) readonly buffer Fragments { uvec2 fragments[]; };
layout(std430, binding = 2) readonly buffer Normals { uint normals[]; };
#ifdef WRITES
layout(std430, binding = 6) writeonly buffer NewEnds { uvec4 newEnds[]; };
#else
layout(std430, binding = 3) buffer OddLines { uint oddLines[]; };
#endif

uvec4 endOf(uvec2 fragment, bool exits) {
  uint normal = normals[fragment.y >> 1];
  if (((fragment.y & 1u) != 0u) != exits) normal = turnedAround(normal);
  return uvec4(bitsOf(fragment.x), normal, 0u, kNone);
}
uint pairUp(uint line, uint base) {
  uint i = offsets[line], stop = offsets[line + 1u], crossings = 0u;
  uvec2 entry = uvec2(0u);
#ifdef PARTS
  uint work = 0u;
  uvec4 stopped = uvec4(0u), run = uvec4(0u);  // where, crossings, how many are alike, whether one fits; run, entry
  if (goesOn != 0u) {
    stopped = states[2u * line];
    run = states[2u * line + 1u];
    i = stopped.x;
    crossings = stopped.y;
    entry = run.zw;
  }
#endif
  while (i < stop) {
    uvec2 chosen = fragments[i];
    uint alike = 0u, last = kNone;
    bool exits = (crossings & 1u) != 0u, fits = false;
#ifdef PARTS
    if (stopped.z != 0u) {
      chosen = run.xy;
      alike = stopped.z;
      fits = stopped.w != 0u;
      last = fragments[i - 1u].y;
      stopped.z = 0u;
    }
#endif
    for (; i < stop && fragments[i].x == chosen.x; ++i) {
#ifdef PARTS
      if (work++ == kMostWork) {
        states[2u * line] = uvec4(i, crossings, alike, uint(fits));
        states[2u * line + 1u] = uvec4(chosen, entry);
        return crossings & ~1u;
      }
#endif
      uint id = fragments[i].y;
      if (id == last) continue;
      last = id;
      ++alike;
      if (fits || ((id & 1u) != 0u) != exits) continue;
      chosen.y = id;
      fits = true;
    }
    if ((alike & 1u) == 0u) continue;
#ifdef WRITES
    if (exits) {
      newEnds[base + crossings - 1u] = endOf(entry, false);
      newEnds[base + crossings] = endOf(chosen, true);
    }
    entry = chosen;
#endif
    ++crossings;
  }
#ifdef PARTS
  states[2u * line] = uvec4(stop, crossings, 0u, 0u);
#endif
#ifndef WRITES
  if ((crossings & 1u) != 0u) atomicOr(oddLines[line / 32u], 1u << (line % 32u));
#endif
  return crossings & ~1u;
}

void main() {
  uint line = gl_GlobalInvocationID.x;
#ifdef WRITES
  if (line < lineCount) pairUp(line, baseOf(line));
#else
  storeCount(line < lineCount ? pairUp(line, 0u) : 0u);
#endif
}
)";

}  // namespace restroke::points
