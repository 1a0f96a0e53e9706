#include "sculpt/history.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "implicit/errors.h"
#include "retarget/stroke_codec.h"
#include "sculpt/lean_vector.h"

namespace restroke::sculpt {

namespace {

constexpr int kKindShift = 56;
constexpr std::uint64_t kOffsetMask = (std::uint64_t{1} << kKindShift) - 1;

// First byte of fixed stamps that carve, and flags of a packed recast. A stroke has its method there.
constexpr std::uint8_t kCarves = 1, kHasOutcome = 1, kHasCamera = 2;

void putCount(std::vector<std::uint8_t>& out, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) out.push_back(static_cast<std::uint8_t>(value | 0x80));
  out.push_back(static_cast<std::uint8_t>(value));
}

std::uint64_t takeCount(std::span<const std::uint8_t>& in) {
  std::uint64_t value = 0;
  for (int shift = 0;; shift += 7) {
    RESTROKE_CHECK_LT(shift, 64);
    RESTROKE_CHECK_LT(std::size_t{0}, in.size());
    const std::uint8_t byte = in.front();
    in = in.subspan(1);
    value |= std::uint64_t{byte & 0x7fu} << shift;
    if ((byte & 0x80) == 0) return value;
  }
}

void putFloat(std::vector<std::uint8_t>& out, float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::uint8_t>(bits >> shift));
}

float takeFloat(std::span<const std::uint8_t>& in) {
  RESTROKE_CHECK_LE(std::size_t{4}, in.size());
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < 4; ++i) bits |= std::uint32_t{in[i]} << (8 * i);
  in = in.subspan(4);
  return std::bit_cast<float>(bits);
}

// Only what the brush uses: of a ball 16 bytes, of a sweep 17, of a tip 32.
void putStamp(std::vector<std::uint8_t>& out, const Stamp& stamp, const Brush& brush) {
  for (const float value : {stamp.center.x, stamp.center.y, stamp.center.z, stamp.radius})
    putFloat(out, value);
  if (brush.trace == Trace::Sweep) out.push_back(stamp.joined ? 1 : 0);
  if (brush.tip)
    for (const float value : stamp.rotation) putFloat(out, value);
}

Stamp takeStamp(std::span<const std::uint8_t>& in, const Brush& brush) {
  Stamp stamp;
  for (float* value : {&stamp.center.x, &stamp.center.y, &stamp.center.z, &stamp.radius})
    *value = takeFloat(in);
  if (brush.trace == Trace::Sweep) stamp.joined = takeCount(in) != 0;
  if (brush.tip)
    for (float& value : stamp.rotation) value = takeFloat(in);
  return stamp;
}

void putSphere(std::vector<std::uint8_t>& out, const implicit::Sphere& sphere) {
  for (const float value : {sphere.center.x, sphere.center.y, sphere.center.z, sphere.radius})
    putFloat(out, value);
}

implicit::Sphere takeSphere(std::span<const std::uint8_t>& in) {
  implicit::Sphere sphere;
  for (float* value : {&sphere.center.x, &sphere.center.y, &sphere.center.z, &sphere.radius})
    *value = takeFloat(in);
  return sphere;
}

void putCamera(std::vector<std::uint8_t>& out, const Camera& camera) {
  for (const Vec3 v : {camera.position, camera.view, camera.up})
    for (const float value : {v.x, v.y, v.z}) putFloat(out, value);
  for (const float value : {camera.halfHeight, camera.near, camera.far}) putFloat(out, value);
  putCount(out, camera.width);
  putCount(out, camera.height);
}

Camera takeCamera(std::span<const std::uint8_t>& in) {
  Camera camera;
  for (Vec3* v : {&camera.position, &camera.view, &camera.up})
    for (float* value : {&v->x, &v->y, &v->z}) *value = takeFloat(in);
  for (float* value : {&camera.halfHeight, &camera.near, &camera.far}) *value = takeFloat(in);
  camera.width = static_cast<std::uint32_t>(takeCount(in));
  camera.height = static_cast<std::uint32_t>(takeCount(in));
  return camera;
}

// Index of an equal value among the latest, else of a new one at the end.
template <class T>
std::size_t shared(std::vector<T>& table, const T& value) {
  const std::size_t oldest = table.size() - std::min(table.size(), History::kReuseWindow);
  for (std::size_t i = table.size(); i > oldest; --i)
    if (table[i - 1] == value) return i - 1;
  makeRoom(table, 1);
  table.push_back(value);
  return table.size() - 1;
}

template <class List>
auto placeIn(List& list, NodeId node) {
  return std::lower_bound(list.begin(), list.end(), node, [](const auto& a, NodeId n) { return a.node < n; });
}

}  // namespace

History::History(HistoryOptions options) : options_(options) {
  makeRoom(records_, 1);
  records_.push_back({});
}

void History::packStroke(const StrokeCommand& drawn, std::vector<std::uint8_t>& out) {
  out.push_back(static_cast<std::uint8_t>(drawn.method));
  putCount(out, shared(cameras_, drawn.stroke.camera));
  putCount(out, shared(brushes_, drawn.brush));
  retarget::encodePoints(drawn.stroke.points, out, {.time = options_.times, .pressure = options_.pressures});
}

StrokeCommand History::unpackStroke(std::span<const std::uint8_t> in) const {
  StrokeCommand drawn;
  drawn.method = static_cast<retarget::Method>(in.front());
  in = in.subspan(1);
  drawn.stroke.camera = cameras_[takeCount(in)];
  drawn.brush = brushes_[takeCount(in)];
  drawn.stroke.points = retarget::decodePoints(in);
  return drawn;
}

const Brush& History::brush(NodeId node) const {
  std::span<const std::uint8_t> in = packed(node).subspan(1);
  (void)takeCount(in);  // the camera
  return brushes_[takeCount(in)];
}

retarget::Method History::method(NodeId node) const {
  RESTROKE_CHECK_EQ(static_cast<int>(kind(node)), static_cast<int>(NodeKind::Stroke));
  return static_cast<retarget::Method>(packed(node).front());
}

void History::packFixed(const FixedCommand& fixed, std::vector<std::uint8_t>& out) {
  out.push_back(fixed.mode == Mode::Carve ? kCarves : std::uint8_t{0});
  putCount(out, fixed.stamps.size());
  for (const implicit::Sphere& stamp : fixed.stamps) putSphere(out, stamp);
  // Other volumes are shared with the list, and kept by reference.
  putCount(out, fixed.shapes.size());
  if (!fixed.shapes.empty()) putCount(out, shapes_.size());
  makeRoom(shapes_, fixed.shapes.size());
  shapes_.insert(shapes_.end(), fixed.shapes.begin(), fixed.shapes.end());
}

FixedCommand History::unpackFixed(std::span<const std::uint8_t> in) const {
  FixedCommand fixed;
  fixed.mode = (in.front() & kCarves) != 0 ? Mode::Carve : Mode::Add;
  in = in.subspan(1);
  fixed.stamps.resize(takeCount(in));
  for (implicit::Sphere& stamp : fixed.stamps) stamp = takeSphere(in);
  const std::size_t count = takeCount(in);
  if (count > 0) {
    const auto first = shapes_.begin() + static_cast<std::ptrdiff_t>(takeCount(in));
    fixed.shapes.assign(first, first + static_cast<std::ptrdiff_t>(count));
  }
  return fixed;
}

NodeId History::add(const Command& command, NodeResult result) {
  std::vector<std::uint8_t> packed;
  NodeKind kind = NodeKind::Stroke;
  if (const auto* drawn = std::get_if<StrokeCommand>(&command)) {
    packStroke(*drawn, packed);
  } else if (const auto* fixed = std::get_if<FixedCommand>(&command)) {
    kind = NodeKind::Fixed;
    packFixed(*fixed, packed);
  } else if (const auto* base = std::get_if<BaseCommand>(&command)) {
    kind = NodeKind::Base;
    putCount(packed, shapes_.size());
    makeRoom(shapes_, 1);
    shapes_.push_back(base->base);
  } else if (const auto* transform = std::get_if<TransformCommand>(&command)) {
    kind = NodeKind::Transform;
    for (const float value : transform->matrix) putFloat(packed, value);
  } else {
    throw InternalError("History::add: edits of the tree and moves of its cursor are no nodes");
  }

  makeRoom(records_, 1);
  makeRoom(packed_, packed.size());
  const std::uint64_t offset = packed_.size();
  packed_.insert(packed_.end(), packed.begin(), packed.end());
  const NodeId node = tree_.add();
  records_.push_back({result, offset | static_cast<std::uint64_t>(kind) << kKindShift});
  if (const auto* drawn = std::get_if<StrokeCommand>(&command); drawn && drawn->outcome)
    keepRecast({.recast = {.node = node, .outcome = drawn->outcome}});
  return node;
}

void History::edit(const Command& command) {
  if (std::holds_alternative<UndoCommand>(command)) {
    if (cursor() == kRootNode) throw InputError(kNothingToUndo);
    tree_.moveCursor(parent(cursor()));
  } else if (std::holds_alternative<RedoCommand>(command)) {
    if (redoTarget(cursor()) == cursor()) throw InputError(kNothingToRedo);
    tree_.moveCursor(redoTarget(cursor()));
  } else if (const auto* to = std::get_if<GotoCommand>(&command)) {
    tree_.moveCursor(to->node);
  } else if (const auto* cancel = std::get_if<CancelCommand>(&command)) {
    tree_.cancel(cancel->node, cancel->extent);
  } else if (const auto* restore = std::get_if<RestoreCommand>(&command)) {
    tree_.restore(restore->node, restore->extent);
  } else if (const auto* move = std::get_if<MoveCommand>(&command)) {
    tree_.move(move->node, move->to, move->extent);
  } else if (const auto* copy = std::get_if<CopyCommand>(&command)) {
    const std::vector<NodeId> sources = tree_.copy(copy->node, copy->to, copy->extent);
    makeRoom(records_, sources.size());
    for (const NodeId source : sources) {
      records_.push_back(records_[indexOf(source)]);
      const NodeId node{static_cast<std::uint32_t>(records_.size() - 1)};
      if (const auto first = original(source)) setOriginal(node, first);
      if (std::optional<KeptRecast> kept = keptRecast(source)) {
        kept->recast.node = node;
        keepRecast(*kept);
      }
    }
  } else {
    throw InternalError("History::edit: a node is added, not an edit");
  }
}

void History::restoreTree(const HistoryTree& tree) {
  tree_ = tree;
  records_.resize(tree_.size());
  const auto isGone = [&](const auto& of) { return indexOf(of.node) >= tree_.size(); };
  std::erase_if(originals_, isGone);
  std::erase_if(kept_, isGone);
}

NodeKind History::kind(NodeId node) const {
  RESTROKE_CHECK_LT(std::uint32_t{0}, indexOf(node));
  return static_cast<NodeKind>(records_[indexOf(node)].place >> kKindShift);
}

std::span<const std::uint8_t> History::packed(NodeId node) const {
  RESTROKE_CHECK_LT(std::uint32_t{0}, indexOf(node));
  RESTROKE_CHECK_LT(std::size_t{indexOf(node)}, records_.size());
  return std::span(packed_).subspan(records_[indexOf(node)].place & kOffsetMask);
}

Command History::command(NodeId node) const {
  std::span<const std::uint8_t> in = packed(node);
  switch (kind(node)) {
    case NodeKind::Stroke: {
      StrokeCommand drawn = unpackStroke(in);
      if (auto kept = keptRecast(node)) drawn.outcome = std::move(kept->recast.outcome);
      return drawn;
    }
    case NodeKind::Fixed:
      return unpackFixed(in);
    case NodeKind::Base:
      return BaseCommand{{}, shapes_[takeCount(in)]};
    case NodeKind::Transform:
      break;
  }
  TransformCommand transform;
  for (float& value : transform.matrix) value = takeFloat(in);
  return transform;
}

std::shared_ptr<const Original> History::original(NodeId node) const {
  const auto place = placeIn(originals_, node);
  return place != originals_.end() && place->node == node ? place->value : nullptr;
}

void History::setOriginal(NodeId node, std::shared_ptr<const Original> original) {
  const auto place = placeIn(originals_, node);
  if (place != originals_.end() && place->node == node) {
    place->value = std::move(original);
  } else {
    makeRoom(originals_, 1);  // invalidates `place`
    originals_.insert(placeIn(originals_, node), {node, std::move(original)});
  }
}

std::optional<KeptRecast> History::keptRecast(NodeId node) const {
  const auto place = placeIn(kept_, node);
  if (place == kept_.end() || place->node != node) return std::nullopt;
  std::span<const std::uint8_t> in = place->value.packed;
  KeptRecast kept{.shapeBefore = place->value.shapeBefore, .recast = {.node = node}};
  const std::uint8_t flags = in.front();
  in = in.subspan(1);
  kept.recast.scale = takeFloat(in);
  if ((flags & kHasOutcome) != 0) {
    StrokeOutcome& outcome = kept.recast.outcome.emplace();
    outcome.misses = takeCount(in);
    outcome.pieces = takeCount(in);
    outcome.stamps.resize(takeCount(in));
    for (Stamp& stamp : outcome.stamps) stamp = takeStamp(in, brush(node));
  }
  if ((flags & kHasCamera) != 0) kept.recast.camera = takeCamera(in);
  return kept;
}

void History::keepRecast(const KeptRecast& kept) {
  const NodeId node = kept.recast.node;
  std::vector<std::uint8_t> packed;
  packed.push_back(static_cast<std::uint8_t>((kept.recast.outcome ? kHasOutcome : 0u) |
                                             (kept.recast.camera ? kHasCamera : 0u)));
  putFloat(packed, kept.recast.scale);
  if (const auto& outcome = kept.recast.outcome) {
    putCount(packed, outcome->misses);
    putCount(packed, outcome->pieces);
    putCount(packed, outcome->stamps.size());
    for (const Stamp& stamp : outcome->stamps) putStamp(packed, stamp, brush(node));
  }
  if (kept.recast.camera) putCamera(packed, *kept.recast.camera);
  packed.shrink_to_fit();
  const auto place = placeIn(kept_, node);
  if (place != kept_.end() && place->node == node) {
    place->value = {kept.shapeBefore, std::move(packed)};
  } else {
    makeRoom(kept_, 1);  // invalidates `place`
    kept_.insert(placeIn(kept_, node), {node, {kept.shapeBefore, std::move(packed)}});
  }
}

std::size_t History::bytes() const {
  std::size_t tips = 0;  // brushes may share one
  for (std::size_t i = 0; i < brushes_.size(); ++i) {
    const implicit::Volume* tip = brushes_[i].tip.get();
    const auto same = [tip](const Brush& brush) { return brush.tip.get() == tip; };
    if (tip && std::none_of(brushes_.begin(), brushes_.begin() + static_cast<std::ptrdiff_t>(i), same))
      tips += sizeof(*tip) + implicit::bytesOf(tip->parameters());
  }
  std::size_t originals = originals_.capacity() * sizeof(originals_[0]);
  const Original* last = nullptr;  // copies share one, and mostly follow each other
  for (const auto& of : originals_) {
    if (of.value.get() != last) originals += of.value->bytes();
    last = of.value.get();
  }
  std::size_t kept = kept_.capacity() * sizeof(kept_[0]);
  for (const auto& of : kept_) kept += of.value.packed.capacity();
  return tree_.bytes() + records_.capacity() * sizeof(Record) + cameras_.capacity() * sizeof(Camera) +
         brushes_.capacity() * sizeof(Brush) + tips + packed_.capacity() +
         shapes_.capacity() * sizeof(implicit::Shape) + originals + kept;
}

}  // namespace restroke::sculpt
