#include "tests/sculpt/random_trees.h"

#include "sculpt/base_change.h"
#include "tests/sculpt/test_commands.h"

namespace restroke::sculpt {
namespace {

using restroke::testing::Random;

int whole(Random& random, int from, int to) {
  return from + static_cast<int>(random.below(static_cast<std::size_t>(to - from + 1)));
}

StrokeCommand randomStroke(Random& random, const Methods& methods) {
  StrokeCommand command;
  command.stroke.camera = frontCamera();
  if (random.below(3) == 0) {
    // From the side, so that strokes cross that did not see each other.
    command.stroke.camera = frameSphere({}, 1, {.view = {-1, -0.3f, -0.4f}, .width = 400, .height = 400});
  }
  command.brush.radius = 0.06f + 0.02f * static_cast<float>(random.below(6));
  command.brush.spacing = 0.5f;
  command.brush.mode = random.below(3) == 0 ? Mode::Carve : Mode::Add;
  command.brush.radii = random.below(2) == 0 ? Radii::Keep : Radii::Follow;
  if (random.below(8) == 0) command.brush.trace = Trace::Sweep;
  command.method = methods[random.below(methods.size())];
  const int x = whole(random, 60, 340), y = whole(random, 60, 340);
  const int dx = whole(random, -14, 14), dy = whole(random, -14, 14), count = whole(random, 1, 9);
  for (int i = 0; i < count; ++i)
    command.stroke.points.push_back(
        {.screen = {16 * (x + i * dx) + whole(random, -20, 20), 16 * (y + i * dy)},
         .time = static_cast<std::uint32_t>(8 * i)});
  return command;
}

TransformCommand randomTransform(Random& random) {
  Affine map;
  for (double& e : map.matrix) e += 0.06 * static_cast<double>(random.between(-1, 1));
  map.offset = 0.1 * DVec3(random.inCube(1));
  return {{}, matrixOf(map)};
}

implicit::Shape randomBase(Random& random) {
  if (random.below(2) == 0)
    return implicit::Shape(0.1f * random.inCube(1), 0.8f + 0.1f * static_cast<float>(random.below(4)));
  const auto ellipsoid = implicit::volumeKindNamed("ellipsoid").make({{{1.1f}, {0.8f}, {0.9f}}});
  return std::make_shared<const implicit::PosedVolume>(ellipsoid, implicit::Pose{0.1f * random.inCube(1)});
}

}  // namespace

Command randomCommand(Random& random, std::size_t nodes, const Methods& methods) {
  // Now and then one that does not exist.
  const auto node = [&] { return NodeId{static_cast<std::uint32_t>(random.below(nodes + nodes / 8 + 1))}; };
  const Extent extent = random.below(2) == 0 ? Extent::Single : Extent::Branch;
  switch (random.below(24)) {
    case 0:
    case 1:
      return UndoCommand{};
    case 2:
      return RedoCommand{};
    case 3:
    case 4:
      return GotoCommand{{}, node()};
    case 5:
    case 6:
      return CancelCommand{{}, node(), extent};
    case 7:
      return RestoreCommand{{}, node(), extent};
    case 8:
    case 9:
      return MoveCommand{{}, node(), node(), extent};
    case 10:
      return CopyCommand{node(), node(), extent};
    case 11:
      return randomTransform(random);
    case 12:
      if (random.below(2) == 0) return BaseCommand{{}, randomBase(random)};
      return FixedCommand{random.below(2) == 0 ? Mode::Add : Mode::Carve,
                          {{0.9f * random.inCube(1), 0.15f}, {random.inCube(1), 0.1f}}};
    default:
      return randomStroke(random, methods);
  }
}

}  // namespace restroke::sculpt
