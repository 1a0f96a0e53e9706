#include "sculpt/base_chain.h"

#include "implicit/errors.h"
#include "sculpt/base_change.h"

namespace restroke::sculpt {

BaseChains::Base BaseChains::at(const History& history, std::span<const NodeId> path) {
  std::vector<NodeId> chain;
  for (const NodeId node : path) {
    const NodeKind kind = history.kind(node);
    if (kind != NodeKind::Base && kind != NodeKind::Transform) continue;
    if (!history.tree().isCancelled(node)) chain.push_back(node);
  }
  if (chain.empty()) return {{}, header_};
  if (const auto known = known_.find(chain); known != known_.end()) return known->second;
  Base base{{}, header_};
  for (const NodeId node : chain) {
    const Command command = history.command(node);
    if (const auto* other = std::get_if<BaseCommand>(&command)) {
      base = {{.node = indexOf(node), .since = {}}, other->base};
    } else {
      const Affine map = affineOf(std::get<TransformCommand>(command).matrix);
      base.shape = mappedShape(base.shape, map, "transform");
      base.history.since = composed(map, base.history.since);
    }
  }
  known_.emplace(std::move(chain), base);
  return base;
}

implicit::Shape BaseChains::shapeOf(const History& history, const BaseHistory& base) const {
  const implicit::Shape own =
      base.node == 0 ? header_ : std::get<BaseCommand>(history.command(NodeId{base.node})).base;
  return base.since == Affine{} ? own : mappedShape(own, base.since, "transform");
}

}  // namespace restroke::sculpt
