// The leaf brush as one would write it without knowing the instruction set: the buffer's own pointer, rows of
// 8 voxels, no branches inside a row.

#include <algorithm>
#include <cmath>

#include "tests/bench/brush_kernels.h"

namespace restroke::bench {

void brushLeafPlainly(const BrushedLeaf& leaf, const BrushBall& ball) {
  constexpr std::size_t kRow = 8;
  const float reach = ball.radius + ball.band, reach2 = reach * reach;
  float along[kRow];
  for (std::size_t z = 0; z < kRow; ++z) {
    const float dz = leaf.z + static_cast<float>(z) * ball.voxel;
    along[z] = dz * dz;
  }
  const float nearest = *std::min_element(along, along + kRow);
  for (std::size_t x = 0; x < kRow; ++x)
    for (std::size_t y = 0; y < kRow; ++y) {
      const float dx = leaf.x + static_cast<float>(x) * ball.voxel,
                  dy = leaf.y + static_cast<float>(y) * ball.voxel;
      const float across = dx * dx + dy * dy;
      if (!(across + nearest < reach2)) continue;
      float* const row = leaf.values + kRow * (kRow * x + y);
      if (ball.adds) {
        for (std::size_t z = 0; z < kRow; ++z)
          row[z] = std::min(row[z], std::max(std::sqrt(across + along[z]) - ball.radius, -ball.band));
      } else {
        for (std::size_t z = 0; z < kRow; ++z)
          row[z] = std::max(row[z], std::min(ball.radius - std::sqrt(across + along[z]), ball.band));
      }
      std::uint64_t inBand = 0;
      for (std::size_t z = 0; z < kRow; ++z)
        inBand |= static_cast<std::uint64_t>(-ball.band < row[z] && row[z] < ball.band) << z;
      leaf.active[x] = (leaf.active[x] & ~(std::uint64_t{0xFF} << (kRow * y))) | inBand << (kRow * y);
    }
}

}  // namespace restroke::bench
