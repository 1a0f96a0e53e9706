#pragma once
// GLSL that sorts the fragments of each line (gl_peeling_shaders.h says what they are): by depth, and at one
// depth by triangle. Every program is kDexelHead, kLineItems and pieces of this file.
//
// Short lines are sorted by one work item each. Longer ones are sorted in chunks, and the chunks merged, each
// item making one chunk of the result (O. Green, R. McColl, D. Bader, GPU Merge Path, ICS 2012): no item's
// loops are long, as they must not be on Mesa's software driver (gl_dexel_shaders.h), and a long line keeps
// many items busy.

#include <cstddef>

namespace restroke::points {

/// Fragments of a chunk, kChunk below. Items that are counted together go through the gaps and places of the
/// sort together, so that loops come to 48,000 rounds at most, whatever the orders.
inline constexpr std::size_t kFragmentsPerChunk = 256;

inline constexpr const char* kSortHead = R"(
const uint kChunk = 256u;
layout(std430, binding = 0) readonly buffer Offsets { uint offsets[]; };
bool isAfter(uvec2 a, uvec2 b) { return a.x > b.x || (a.x == b.x && a.y > b.y); }
)";

/// Which chunk is this item's: lines have their chunks one after another, and for each line and each kChunk
/// fragments before it there is one item, so that there are enough, and some that have nothing to do.
inline constexpr const char* kTakeChunk = R"(
uint lineFirst, lineStop, chunk;  // where they begin and end
bool takeChunk() {
  uint item = gl_GlobalInvocationID.x, line = 0u;
  for (uint stop = lineCount; stop - line > 1u;) {
    uint middle = (line + stop) / 2u;
    if (offsets[middle] / kChunk + middle <= item)
      line = middle;
    else
      stop = middle;
  }
  lineFirst = offsets[line];
  lineStop = offsets[line + 1u];
  chunk = lineFirst + (item - (lineFirst / kChunk + line)) * kChunk;
  return chunk < lineStop;
}
)";

/// By D. Shell's sort (1959): short lists at the price of an insertion sort, in place. With CHUNKS each
/// chunk, without each line.
inline constexpr const char* kSortMain = R"(
layout(std430, binding = 1) buffer Fragments { uvec2 fragments[]; };
uniform uint longest;  // not less than any list
void main() {
#ifdef CHUNKS
  if (!takeChunk()) return;
  uint first = chunk, count = min(kChunk, lineStop - chunk);
#else
  uint line = gl_GlobalInvocationID.x;
  if (line >= lineCount) return;
  uint first = offsets[line], count = offsets[line + 1u] - first;
#endif
  uint gap = 1u;
  while (gap < longest / 3u) gap = 3u * gap + 1u;
  for (; gap > 0u; gap /= 3u)
    for (uint i = gap; i < count; ++i) {
      uvec2 moving = fragments[first + i];
      uint place = i;
      for (; place >= gap; place -= gap) {
        uvec2 other = fragments[first + place - gap];
        if (!isAfter(other, moving)) break;
        fragments[first + place] = other;
      }
      fragments[first + place] = moving;
    }
}
)";

/// Runs of sorted fragments become runs twice as long.
inline constexpr const char* kMergeMain = R"(
layout(std430, binding = 1) readonly buffer Fragments { uvec2 fragments[]; };
layout(std430, binding = 2) writeonly buffer Merged { uvec2 merged[]; };
uniform uint run;  // fragments: kChunk, or twice as many as the last time
void main() {
  if (!takeChunk()) return;
  uint begin = lineFirst + (chunk - lineFirst) / (2u * run) * (2u * run);
  uint middle = min(begin + run, lineStop), end = min(begin + 2u * run, lineStop);
  // So many of the first run come before the chunk.
  uint before = chunk - begin, right = end - middle;
  uint low = before > right ? before - right : 0u, high = min(before, middle - begin);
  while (low < high) {
    uint tried = (low + high) / 2u;
    if (isAfter(fragments[begin + tried], fragments[middle + (before - 1u - tried)]))
      high = tried;
    else
      low = tried + 1u;
  }
  uint i = begin + low, j = middle + (before - low), stop = min(chunk + kChunk, end);
  uvec2 first = i < middle ? fragments[i] : uvec2(kNone), second = j < end ? fragments[j] : uvec2(kNone);
  for (uint place = chunk; place < stop; ++place) {
    bool takesSecond = i >= middle || (j < end && isAfter(first, second));
    merged[place] = takesSecond ? second : first;
    uint next = takesSecond ? ++j : ++i;
    if (next >= (takesSecond ? end : middle)) continue;
    uvec2 loaded = fragments[next];
    if (takesSecond)
      second = loaded;
    else
      first = loaded;
  }
}
)";

}  // namespace restroke::points
