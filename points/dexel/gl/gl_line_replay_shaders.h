#pragma once
// GLSL of replays on lines (gl_line_replay.h): LinePainter and StepsOnLine of points/dexel/refine, one work
// item a line. Every program is kDexelHead, kLineItems, kReplayHead and pieces of this file.
//
// What decides a result is what the CPU does, operation by operation: in double, and what is float32 there in
// float32. Everything is `precise`, so that nothing is fused, and divisions of float32, which drivers may
// round badly, go by double, which rounds them as IEEE 754 does.
//
// Mesa's software driver ends the loops of a work item, without a word, when all loops together have gone
// round 65,535 times, where those of up to 16 work items count together. So lines have kMostReplayPieces at
// most, and stop painting in time, to be gone on with.

#include <cstdint>

namespace restroke::points {

inline constexpr std::uint32_t kMostReplayPieces = 2048;

inline constexpr const char* kReplayHead = R"(
// An owner is the number of a step, or one of these.
const uint kUndecided = 0xffffffffu, kKnownFull = 0xfffffffeu, kKnownEmpty = 0xfffffffdu;
const uint kOverflow = 0xffffffffu;  // in place of a number of pieces: the room was too small

layout(std430, binding = 0) readonly buffer Lines { uvec4 lines[]; };  // column, row, from, to
float fromOf(uint line) { return uintBitsToFloat(lines[line].z); }
float toOf(uint line) { return uintBitsToFloat(lines[line].w); }
)";

/// The pieces of all lines: the first of each, then the second of each, and so on. They are chained from the
/// first one on, and those that are undecided once more among themselves.
inline constexpr const char* kReplayPieces = R"(
layout(std430, binding = 1) buffer Pieces { uvec4 pieces[]; };  // begin, owner, the next, the next undecided
// How many pieces; the first undecided (kNone: all is decided); where to go on (kNone: it was not stopped),
// the item and its stretch.
layout(std430, binding = 2) buffer States { uvec4 states[]; };
uvec4 pieceAt(uint line, uint i) { return pieces[i * lineCount + line]; }
float endOf(uint line, uvec4 piece) {
  return piece.z == kNone ? toOf(line) : uintBitsToFloat(pieceAt(line, piece.z).x);
}
)";

/// Lines as they are before any step.
inline constexpr const char* kReplayStartMain = R"(
layout(std430, binding = 3) readonly buffer Known { uint known[]; };  // of each line where and how many, pieces
uniform uint room;
uniform uint hasKnown;
void main() {
  uint line = gl_GlobalInvocationID.x;
  if (line >= lineCount) return;
  uint at = 0u, count = 1u;
  if (hasKnown != 0u) {
    at = known[2u * line];
    count = known[2u * line + 1u];
  }
  if (count > room) {
    states[line] = uvec4(kOverflow, kNone, kNone, 0u);
    return;
  }
  uint next = kNone, open = kNone;
  for (uint i = count; i > 0u; --i) {
    uvec2 piece = uvec2(lines[line].z, kUndecided);
    if (hasKnown != 0u) piece = uvec2(known[at + 2u * i - 2u], known[at + 2u * i - 1u]);
    pieces[(i - 1u) * lineCount + line] = uvec4(piece, next, open);
    next = i - 1u;
    if (piece.y == kUndecided) open = next;
  }
  states[line] = uvec4(count, open, kNone, 0u);
}
)";

/// Lines in space, and balls on them: LineFamily::line, and implicit::intersect and outwardNormal of balls.
inline constexpr const char* kReplayBalls = R"(
// Centre, and a radius that is negative where the ball is taken away, infinite where it is no ball.
layout(std430, binding = 7) readonly buffer Balls { uvec4 balls[]; };
bool isFilling(uint step) { return (balls[step].w >> 31) == 0u; }
bool isBall(uint step) { return (balls[step].w & 0x7fffffffu) != 0x7f800000u; }

// Origin, what the next line of a row adds, and the next row; the same of the direction.
uniform dvec3 family[6];
dvec3 rayOrigin, rayDirection;
double rayDd;

void takeRay(uint line) {
  double c = double(lines[line].x), r = double(lines[line].y);
  precise dvec3 origin = family[0] + c * family[1];
  precise dvec3 originAtRow = origin + r * family[2];
  precise dvec3 direction = family[3] + c * family[4];
  precise dvec3 directionAtRow = direction + r * family[5];
  precise double square = directionAtRow.x * directionAtRow.x + directionAtRow.y * directionAtRow.y +
                          directionAtRow.z * directionAtRow.z;
  precise double size = sqrt(square);
  precise dvec3 unit = directionAtRow / size;
  precise double dd = unit.x * unit.x + unit.y * unit.y + unit.z * unit.z;
  rayOrigin = originAtRow;
  rayDirection = unit;
  rayDd = dd;
}

// False: the line misses the ball for sure. In float32, which cards are far better at, with more room than
// rounding takes.
bool mayMeet(uvec4 ball) {
  vec4 f = uintBitsToFloat(ball);
  vec3 direction = vec3(rayDirection), origin = vec3(rayOrigin);
  vec3 to = f.xyz - origin;
  vec3 q = to - dot(to, direction) * direction;
  float size = dot(abs(origin) + abs(f.xyz), vec3(1.0));
  return !(dot(q, q) > f.w * f.w * 1.001 + size * size * (1.0 / 65536.0));
}
// x: enter, y: exit; x > y: the line misses the ball.
dvec2 spanOfBall(uvec4 ball) {
  vec4 f = uintBitsToFloat(ball);
  precise double r = double(f.w);
  precise dvec3 to = dvec3(f.xyz) - rayOrigin;
  precise double along = to.x * rayDirection.x + to.y * rayDirection.y + to.z * rayDirection.z;
  precise double middle = along / rayDd;
  precise dvec3 q = to - middle * rayDirection;
  precise double square = r * r;
  precise double beside = q.x * q.x + q.y * q.y + q.z * q.z;
  precise double discriminant = square - beside;
  if (!(discriminant > 0.0lf)) return dvec2(1.0lf, 0.0lf);
  precise double ratio = discriminant / rayDd;
  precise double halfLength = sqrt(ratio);
  precise double enter = middle - halfLength;
  precise double exit = middle + halfLength;
  return dvec2(enter, exit);
}
)";

/// Steps on lines, the last one first. A line's items are numbers of steps; those that are no balls are
/// marked, and followed by where the table has the line's stretches.
inline constexpr const char* kReplayPaintMain = R"(
layout(std430, binding = 3) readonly buffer LineTiles { uint lineTiles[]; };
layout(std430, binding = 4) readonly buffer Tiles { uvec4 tiles[]; };  // items: from, to; their first line
layout(std430, binding = 5) readonly buffer Items { uint items[]; };
layout(std430, binding = 6) readonly buffer Table { uint table[]; };
uniform uint room;
uniform uint goesOn;  // 1: what was stopped, 0: whatever is undecided
const uint kTabled = 0x80000000u;
const uint kMostWork = 2048u;

uint line, count, open;
float low;  // where what is undecided begins
uint work;  // not less than loops have gone round

void setOpen(uint first) {
  open = first;
  if (first != kNone) low = uintBitsToFloat(pieceAt(line, first).x);
}
void setPiece(uint i, float begin, uint owner, uvec2 next) {
  pieces[i * lineCount + line] = uvec4(floatBitsToUint(begin), owner, next);
}
// Gives what is undecided to an owner. False: there is no room.
bool paint(float enter, float exit, uint owner) {
  work += 2u;
  if (!(enter < exit && exit > low)) return true;
  uint before = kNone, i = open;
  while (i != kNone) {
    uvec4 piece = pieceAt(line, i);
    float begin = uintBitsToFloat(piece.x), end = endOf(line, piece);
    if (!(begin < exit)) break;
    ++work;
    if (!(end > enter)) {
      before = i;
      i = piece.w;
      continue;
    }
    if (count + 2u > room) return false;
    uvec2 next = piece.zw;
    if (exit < end) {
      setPiece(count, exit, kUndecided, next);
      next = uvec2(count++);
    }
    if (enter > begin) {
      setPiece(count, enter, owner, uvec2(next.x, kNone));
      setPiece(i, begin, kUndecided, uvec2(count++, next.y));
      before = i;
    } else {
      setPiece(i, begin, owner, uvec2(next.x, kNone));
      if (before == kNone)
        setOpen(next.y);
      else
        pieces[before * lineCount + line].w = next.y;
    }
    i = next.y;
  }
  return true;
}

void main() {
  line = gl_GlobalInvocationID.x;
  if (line >= lineCount) return;
  uvec4 state = states[line];
  if (state.y == kNone || (goesOn != 0u && state.z == kNone)) return;
  count = state.x;
  setOpen(state.y);
  float from = fromOf(line), to = toOf(line);
  takeRay(line);
  uvec4 tile = tiles[lineTiles[line]];
  bool fits = true;
  work = 0u;
  uint i = goesOn != 0u ? state.z : tile.x, stretch = goesOn != 0u ? state.w : 0u;
  while (i < tile.y && open != kNone && fits && work < kMostWork) {
    uint step = items[i];
    if ((step & kTabled) != 0u) {
      uint at = items[i + 1u] + line - tile.z;
      uint k = table[at] + 2u * stretch, stop = table[at + 1u];
      for (; k < stop && fits && work < kMostWork; k += 2u) {
        fits = paint(max(uintBitsToFloat(table[k]), from), min(uintBitsToFloat(table[k + 1u]), to),
                     step & ~kTabled);
        ++stretch;
        ++work;
      }
      if (k < stop) continue;
      stretch = 0u;
      i += 2u;
    } else {
      uvec4 ball = balls[step];
      if (mayMeet(ball)) {
        dvec2 span = spanOfBall(ball);
        if (span.x < span.y) fits = paint(max(float(span.x), from), min(float(span.y), to), step);
      }
      ++i;
    }
  }
  bool isStopped = open != kNone && i < tile.y;
  states[line] = fits ? uvec4(count, open, isStopped ? i : kNone, stretch) : uvec4(kOverflow, kNone, kNone, 0u);
}
)";

/// The ends of painted lines. With WRITES they are written, without they are counted. In an end's places for
/// operations are owners; the flag is set where the later one is a step.
inline constexpr const char* kReplayEndsMain = R"(
layout(std430, binding = 3) readonly buffer Start { uint start[]; };  // of each line where and how many, ends
#ifdef WRITES
layout(std430, binding = 6) writeonly buffer NewEnds { uvec4 newEnds[]; };
#endif
uniform uint hasStart;
const uint kAsk = 0x40000000u;  // the normal is that of a solid that is no ball: to be found by others

uint line, base, given;
uint before;        // the owner of the piece before this one
bool insideBefore;  // and whether it is solid

#ifdef WRITES
uint packNormal(vec3 n) {
  precise float sum = abs(n.x) + abs(n.y) + abs(n.z);
  precise float scale = float(double(kMost) / double(sum));
  precise vec2 f = n.xy * scale;
  precise vec2 moved = f + vec2(n.x < 0.0 ? -0.5 : 0.5, n.y < 0.0 ? -0.5 : 0.5);
  ivec2 i = ivec2(moved);
  return packFolded(n.z < 0.0 ? fold(i) : i);
}
uint normalOfBall(uint step, double t) {
  precise dvec3 place = rayOrigin + t * rayDirection;
  precise dvec3 d = place - dvec3(uintBitsToFloat(balls[step].xyz));
  precise double square = d.x * d.x + d.y * d.y + d.z * d.z;
  precise double size = sqrt(square);
  precise dvec3 n = d / size;
  if (!(size > 0.0lf)) n = dvec3(1.0lf, 0.0lf, 0.0lf);
  return packNormal(vec3(isFilling(step) ? n : -n));
}
// `at`: of the end of the line's start that is here, or the last one before.
uint normalBetween(float depth, uint owner, uint at) {
  if (before == kUndecided && owner == kUndecided && at != kNone && uintBitsToFloat(start[at]) == depth)
    return start[at + 1u] & ~kFlag;
  bool begins = owner + 1u > before + 1u;
  uint later = begins ? owner : before;
  uint found = packNormal(vec3(insideBefore ? rayDirection : -rayDirection));
  if (later >= kKnownEmpty) return found;
  if (!isBall(later)) return kAsk | kFlag;
  dvec2 span = spanOfBall(balls[later]);
  double t = begins ? span.x : span.y;
  if (span.x < span.y && float(t) == depth) found = normalOfBall(later, t);
  return found | kFlag;
}
#endif

void give(float depth, uint normal, uint inner, uint outer) {
#ifdef WRITES
  newEnds[base + given] = uvec4(floatBitsToUint(depth), normal, inner, outer);
#endif
  ++given;
}
void takePiece(bool isFirst, float begin, uint owner, bool inside, uint at) {
  if (inside != insideBefore) {
#ifdef WRITES
    uint normal = isFirst ? packNormal(-vec3(rayDirection)) : normalBetween(begin, owner, at);
#else
    uint normal = 0u;
#endif
    uint beyond = isFirst ? kUndecided : before;
    give(begin, normal, inside ? owner : beyond, inside ? beyond : owner);
  }
  before = owner;
  insideBefore = inside;
}

void takePieces() {
  given = 0u;
  before = kUndecided;
  insideBefore = false;
  uint count = states[line].x;
  if (count == kOverflow) return;
  uint at = 0u, stop = 0u;
  if (hasStart != 0u) {
    at = start[2u * line];
    stop = at + 2u * start[2u * line + 1u];
  }
  uint first = at;
  for (uint i = count > 0u ? 0u : kNone; i != kNone;) {
    uvec4 piece = pieceAt(line, i);
    bool isFirst = i == 0u;
    i = piece.z;
    float begin = uintBitsToFloat(piece.x);
    if (piece.y != kUndecided) {
      takePiece(isFirst, begin, piece.y, piece.y < kKnownEmpty ? isFilling(piece.y) : piece.y == kKnownFull,
                kNone);
      continue;
    }
    // What the line held before, in parts that no step has decided.
    float end = endOf(line, piece);
    while (at < stop && uintBitsToFloat(start[at]) <= begin) at += 2u;
    takePiece(isFirst, begin, kUndecided, ((at - first) / 2u & 1u) != 0u, at > first ? at - 2u : kNone);
    for (; at < stop && uintBitsToFloat(start[at]) < end; at += 2u)
      takePiece(false, uintBitsToFloat(start[at]), kUndecided, ((at - first) / 2u & 1u) == 0u, at);
  }
  if (insideBefore) {
#ifdef WRITES
    give(toOf(line), packNormal(vec3(rayDirection)), before, kUndecided);
#else
    give(toOf(line), 0u, before, kUndecided);
#endif
  }
}

void main() {
  line = gl_GlobalInvocationID.x;
#ifdef WRITES
  if (line >= lineCount) return;
  base = takeOffset(line);
  takeRay(line);
  takePieces();
#else
  given = 0u;
  if (line < lineCount) takePieces();
  storeCount(given);
#endif
}
)";

}  // namespace restroke::points
