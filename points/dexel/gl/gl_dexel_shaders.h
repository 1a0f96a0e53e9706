#pragma once
// GLSL of the Booleans on lines: the algorithm of change_line.h, as one sweep along each line. Every program
// is kDexelHead, then pieces of this file (and of gl_peeling_shaders.h). Depths are compared as whole
// numbers, since drivers may take denormal numbers for zero.
//
// Mesa's software driver ends the loops of a work item, without a word, when all of them together have gone
// round 65,535 times, and it counts those of up to 16 items together. So lines with many ends have programs
// of their own (PARTS): an item stops in time, and the program runs again to go on.

#include <cstddef>

namespace restroke::points {

/// What loops of the sixteen items may come to, with room for what is not counted exactly.
inline constexpr std::size_t kMostRounds = 60'000;
/// How far an item goes before it stops, kMostWork below: in fragments, or in ends and stretches.
inline constexpr std::size_t kWorkPerPart = 2048;
/// Of one work item between its parts.
inline constexpr std::size_t kBytesPerState = 48;

inline constexpr const char* kDexelHead = R"(#version 430 core
const uint kFlag = 0x80000000u;
const uint kNone = 0xffffffffu;
const int kMost = 16383;  // of packed_normal.h

// Whole numbers in the order of the float32 numbers with these bits; -0 is 0.
uint orderOf(uint bits) {
  if ((bits & 0x7fffffffu) == 0u) return 0x80000000u;
  return (bits >> 31) != 0u ? ~bits : bits | 0x80000000u;
}
uint bitsOf(uint order) { return (order >> 31) != 0u ? order & 0x7fffffffu : ~order; }

ivec2 fold(ivec2 f) { return (kMost - abs(f.yx)) * ivec2(f.x < 0 ? -1 : 1, f.y < 0 ? -1 : 1); }
uint packFolded(ivec2 f) { return uint(f.x + kMost) | uint(f.y + kMost) << 15; }
uint turnedAround(uint normal) {
  ivec2 f = ivec2(int(normal & 0x7fffu), int(normal >> 15 & 0x7fffu)) - kMost;
  bool lower = abs(f.x) + abs(f.y) > kMost;
  if (lower) f = fold(f);
  f = -f;
  if (!lower && abs(f.x) + abs(f.y) < kMost) f = fold(f);
  return packFolded(f) | (normal & 0xc0000000u);
}
)";

/// One work item a line.
inline constexpr const char* kLineItems = R"(
layout(local_size_x = 256) in;
uniform uint lineCount;
)";

/// How many ends each line has, summed up within work groups: newOffsets becomes the number of ends of the
/// lines before it in its group, groupSums that of all of its group (G. Blelloch, Prefix Sums and Their
/// Applications, 1990). Within a group 16 items sum up 16 numbers each: few barriers, which cost most on a
/// software driver and hardly less on others than the steps that they save.
inline constexpr const char* kScan = R"(
layout(std430, binding = 4) buffer NewOffsets { uint newOffsets[]; };
layout(std430, binding = 5) buffer GroupSums { uint groupSums[]; };
shared uint values[256];
shared uint sixteens[16];
uint sumOfGroup;

// Sum over the work items before this one; sumOfGroup over all. Every item must call it.
uint sumBefore(uint value) {
  uint i = gl_LocalInvocationID.x;
  values[i] = value;
  barrier();
  if (i < 16u) {
    uint sum = 0u;
    for (uint k = 16u * i; k < 16u * i + 16u; ++k) {
      uint own = values[k];
      values[k] = sum;
      sum += own;
    }
    sixteens[i] = sum;
  }
  barrier();
  uint before = 0u;
  sumOfGroup = 0u;
  for (uint k = 0u; k < 16u; ++k) {
    if (k == i / 16u) before = sumOfGroup;
    sumOfGroup += sixteens[k];
  }
  return before + values[i];
}
void storeCount(uint count) {
  uint before = sumBefore(count);
  if (gl_GlobalInvocationID.x < lineCount) newOffsets[gl_GlobalInvocationID.x] = before;
  if (gl_LocalInvocationID.x == 0u) groupSums[gl_WorkGroupID.x] = sumOfGroup;
}
)";

/// newOffsets holds counts, and behind them and the place for the last offset a 0, which becomes the largest
/// count if that is more than kFewFragments: most often there is nothing to write.
inline constexpr const char* kScanCountsMain = R"(
void main() {
  uint line = gl_GlobalInvocationID.x;
  uint count = line < lineCount ? newOffsets[line] : 0u;
  if (count > 16u) atomicMax(newOffsets[lineCount + 1u], count);
  storeCount(count);
}
)";
inline constexpr std::size_t kFewFragments = 16;

/// One work group: groupSums becomes what is before each group, and behind them the sum of all.
inline constexpr const char* kScanGroupsMain = R"(
void main() {
  uint groups = (lineCount + 255u) / 256u, before = 0u;
  for (uint first = 0u; first < groups; first += 256u) {
    uint group = first + gl_LocalInvocationID.x;
    uint own = group < groups ? groupSums[group] : 0u;
    uint within = sumBefore(own);
    if (group < groups) groupSums[group] = before + within;
    before += sumOfGroup;
    barrier();
  }
  if (gl_LocalInvocationID.x == 0u) groupSums[groups] = before;
}
)";

/// For programs that write what was counted: where a line's begins. The last line tells the end.
inline constexpr const char* kTakeOffset = R"(
layout(std430, binding = 4) buffer NewOffsets { uint newOffsets[]; };
layout(std430, binding = 5) readonly buffer GroupSums { uint groupSums[]; };
uint takeOffset(uint line) {
  uint offset = newOffsets[line] + groupSums[line / 256u];
  newOffsets[line] = offset;
  if (line == lineCount - 1u) newOffsets[lineCount] = groupSums[(lineCount + 255u) / 256u];
  return offset;
}
)";

/// With PARTS: what each item needs to go on, two or three to an item.
inline constexpr const char* kParts = R"(
const uint kMostWork = 2048u;
layout(std430, binding = 7) buffer States { uvec4 states[]; };
uniform uint goesOn;  // 0: from the beginning
)";

/// For programs that write, after kTakeOffset.
inline constexpr const char* kBaseOf = R"(
uint baseOf(uint line) {
#ifdef PARTS
  if (goesOn != 0u) return newOffsets[line];
#endif
  return takeOffset(line);
}
)";

/// The most ends that a line has.
inline constexpr const char* kLongestMain = R"(
layout(std430, binding = 0) readonly buffer Offsets { uint offsets[]; };
layout(std430, binding = 5) buffer Longest { uint longest; };
void main() {
  uint line = gl_GlobalInvocationID.x;
  if (line < lineCount) atomicMax(longest, offsets[line + 1u] - offsets[line]);
}
)";

/// Offsets alone, and a copy of them.
inline constexpr const char* kOffsetsMain = R"(
layout(std430, binding = 6) writeonly buffer Cursors { uint cursors[]; };
void main() {
  uint line = gl_GlobalInvocationID.x;
  if (line < lineCount) cursors[line] = takeOffset(line);
}
)";

/// A line against the tool's same line. With WRITES the new ends are written, without they are counted. As
/// the stretches come in ascending order, what lies before one is done with: it is `before`, the last end
/// given out, that the next stretch may still look at.
///
/// With PARTS an item stops when it has given out, skipped and looked at kMostWork ends and stretches. It
/// goes on with the same stretch: what was done of it is not done twice, as `at` is beyond it.
inline constexpr const char* kCombine = R"(
layout(std430, binding = 0) readonly buffer LineOffsets { uint lineOffsets[]; };
layout(std430, binding = 1) readonly buffer LineEnds { uvec4 lineEnds[]; };  // depth, normal, inner, outer
layout(std430, binding = 2) readonly buffer ToolOffsets { uint toolOffsets[]; };
layout(std430, binding = 3) readonly buffer ToolEnds { uvec4 toolEnds[]; };
#ifdef WRITES
layout(std430, binding = 6) writeonly buffer NewEnds { uvec4 newEnds[]; };
#endif
uniform uint operation;  // 0 union, 1 subtraction, 2 intersection
uniform uint operationId;
const uint kMinusInfinity = 0xff800000u, kInfinity = 0x7f800000u;

uint at, stop;        // the line's ends that are still to come
uint given, base;     // how many were given out, and where
uvec4 before;         // the last of them
bool fills;

#ifdef PARTS
uint work, skipped;
#define STOP_IF_DUE if (work++ >= kMostWork) return false
#else
#define STOP_IF_DUE
#endif

void give(uvec4 end) {
#ifdef WRITES
  newEnds[base + given] = end;
#endif
  ++given;
  before = end;
}
uint orderAt(uint i) { return orderOf(lineEnds[i].x); }

// `hasBefore`: there is an end before the place, `previous`; `next`: the one after it, if it is below stop.
uvec4 newEnd(uint depth, uint normal, bool hasBefore, uvec4 previous, uint next) {
  uint beyond = kNone;
  if (hasBefore || next < stop) {
    bool takesAfter = !hasBefore;
    if (hasBefore && next < stop) {
      precise float ahead = uintBitsToFloat(lineEnds[next].x) - uintBitsToFloat(depth);
      precise float behind = uintBitsToFloat(depth) - uintBitsToFloat(previous.x);
      takesAfter = ahead < behind;
    }
    uvec4 near = previous;
    if (takesAfter) near = lineEnds[next];
    beyond = fills ? near.w : near.z;
  }
  return uvec4(depth, normal | kFlag, fills ? operationId : beyond, fills ? beyond : operationId);
}

// False: it stopped.
bool changeStretch(uint enter, uint exit, uint enterNormal, uint exitNormal) {
  uint enterOrder = orderOf(enter), exitOrder = orderOf(exit);
  STOP_IF_DUE;
  if (enterOrder >= exitOrder) return true;
  uint done = fills ? 1u : 0u;
  while (at < stop && orderAt(at) < enterOrder) {
    STOP_IF_DUE;
    give(lineEnds[at++]);
  }
  if (at < stop && orderAt(at) == enterOrder && ((given + 1u) & 1u) == done) give(lineEnds[at++]);
#ifdef PARTS
  skipped = max(skipped, at);
#else
  uint skipped = at;
#endif
  while (skipped < stop && orderAt(skipped) < exitOrder) {
    STOP_IF_DUE;
    ++skipped;
  }
  if (skipped < stop && orderAt(skipped) == exitOrder && ((given + skipped - at + 1u) & 1u) == done) ++skipped;
  uint last = given + skipped - at;
  if (skipped == at && (given & 1u) == done) return true;
  bool opens = (given & 1u) != done, closes = (last & 1u) != done;
  uvec4 opening = uvec4(0u), closing = uvec4(0u);
  if (opens) opening = newEnd(enter, enterNormal, given > 0u, before, at);
  if (closes) {
    uvec4 previous = before;
    if (skipped > at) previous = lineEnds[skipped - 1u];
    closing = newEnd(exit, exitNormal, last > 0u, previous, skipped);
  }
  at = skipped;
  if (opens) give(opening);
  if (closes) give(closing);
  return true;
}

uint turnedIf(bool turned, uint normal) {
  normal &= ~kFlag;
  return turned ? turnedAround(normal) : normal;
}

uint tool, toolStop;
uvec2 previous;  // of an intersection: where the tool's last span ended

bool combine() {
  if (operation == 2u) {
    // What is between the tool's spans is cleared.
    if (at < stop) {
      for (; tool < toolStop; tool += 2u) {
        uvec2 enter = toolEnds[tool].xy, exit = toolEnds[tool + 1u].xy;
        if (!changeStretch(previous.x, enter.x, previous.y, enter.y & ~kFlag)) return false;
        previous = uvec2(exit.x, exit.y & ~kFlag);
      }
      if (!changeStretch(previous.x, kInfinity, previous.y, 0u)) return false;
    }
  } else if (fills || at < stop) {
    for (; tool < toolStop; tool += 2u) {
      uvec2 enter = toolEnds[tool].xy, exit = toolEnds[tool + 1u].xy;
      if (!changeStretch(enter.x, exit.x, turnedIf(!fills, enter.y), turnedIf(!fills, exit.y))) return false;
    }
  }
#ifdef WRITES
  while (at < stop) {
    STOP_IF_DUE;
    give(lineEnds[at++]);
  }
#else
  given += stop - at;
  at = stop;
#endif
  return true;
}

void combine(uint line) {
  at = lineOffsets[line];
  stop = lineOffsets[line + 1u];
  given = 0u;
  before = uvec4(0u);
  fills = operation == 0u;
  tool = toolOffsets[line];
  toolStop = toolOffsets[line + 1u];
  previous = uvec2(kMinusInfinity, 0u);
#ifdef PARTS
  work = 0u;
  skipped = 0u;
  if (goesOn != 0u) {
    uvec4 places = states[3u * line];
    at = places.x;
    given = places.y;
    tool = places.z;
    skipped = places.w;
    before = states[3u * line + 1u];
    previous = states[3u * line + 2u].xy;
  }
#endif
  combine();
#ifdef PARTS
  states[3u * line] = uvec4(at, given, tool, skipped);
  states[3u * line + 1u] = before;
  states[3u * line + 2u] = uvec4(previous, 0u, 0u);
#endif
}

void main() {
  uint line = gl_GlobalInvocationID.x;
#ifdef WRITES
  if (line >= lineCount) return;
  base = baseOf(line);
  combine(line);
#else
  given = 0u;
  if (line < lineCount) combine(line);
  storeCount(given);
#endif
}
)";

}  // namespace restroke::points
