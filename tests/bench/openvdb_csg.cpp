#include "tests/bench/openvdb_csg.h"

#include <openvdb/tools/Composite.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <chrono>

#include "tests/bench/openvdb_grid.h"

namespace restroke::bench {

OpenVdbResult replayWithOpenVdb(const std::vector<implicit::Primitive>& list, double voxel) {
  using Clock = std::chrono::steady_clock;
  openvdb::initialize();
  OpenVdbResult out;
  openvdb::FloatGrid::Ptr shape;
  const auto begin = Clock::now();
  for (const implicit::Primitive& p : list) {
    const auto start = Clock::now();
    const openvdb::Vec3f c(p.shape.ball().center.x, p.shape.ball().center.y, p.shape.ball().center.z);
    openvdb::FloatGrid::Ptr ball = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(
        p.shape.ball().radius, c, static_cast<float>(voxel), kHalfWidth);
    if (!shape) {
      shape = ball;
      continue;
    }
    if (p.sign == implicit::Sign::Positive)
      openvdb::tools::csgUnion(*shape, *ball);
    else
      openvdb::tools::csgDifference(*shape, *ball);
    out.stampMicroseconds.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
  }
  out.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  if (shape) {
    out.bytes = shape->memUsage();
    out.activeVoxels = shape->activeVoxelCount();
    out.grid = std::make_shared<OpenVdbGrid>(OpenVdbGrid{shape});
  }
  return out;
}

}  // namespace restroke::bench
