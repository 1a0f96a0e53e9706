#include "sculpt/history.h"

#include <algorithm>
#include <bit>
#include <type_traits>
#include <utility>

#include "implicit/errors.h"
#include "retarget/stroke_codec.h"

namespace restroke::sculpt {

namespace {

// First byte of a packed command. A stroke has its method in bits 2 and up.
constexpr std::uint8_t kFixedFlag = 1;
constexpr std::uint8_t kSecondFlag = 2;  // fixed: carves; stroke: has a recorded outcome
constexpr int kMethodShift = 2;

std::uint32_t indexOf(NodeId node) {
  return static_cast<std::uint32_t>(node);
}

// Doubling would leave half of a buffer unused; an eighth keeps appending linear and wastes little.
template <class T>
void makeRoom(std::vector<T>& buffer, std::size_t extra) {
  if (buffer.size() + extra > buffer.capacity())
    buffer.reserve(std::max(buffer.size() + extra, buffer.capacity() + buffer.capacity() / 8));
}

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

}  // namespace

History::History(HistoryOptions options) : options_(options) {
  makeRoom(nodes_, 1);
  nodes_.push_back({});
}

NodeId History::add(const Command& command, NodeResult result) {
  std::vector<std::uint8_t> packed;
  if (const auto* fixed = std::get_if<FixedCommand>(&command)) {
    packed.push_back(static_cast<std::uint8_t>(kFixedFlag | (fixed->mode == Mode::Carve ? kSecondFlag : 0)));
    putCount(packed, fixed->stamps.size());
    for (const implicit::Sphere& stamp : fixed->stamps) putSphere(packed, stamp);
    // Other volumes are shared with the list, and kept by reference.
    putCount(packed, fixed->shapes.size());
    if (!fixed->shapes.empty()) putCount(packed, shapes_.size());
    makeRoom(shapes_, fixed->shapes.size());
    shapes_.insert(shapes_.end(), fixed->shapes.begin(), fixed->shapes.end());
  } else if (const auto* drawn = std::get_if<StrokeCommand>(&command)) {
    packed.push_back(static_cast<std::uint8_t>((static_cast<unsigned>(drawn->method) << kMethodShift) |
                                               (drawn->outcome ? kSecondFlag : 0u)));
    putCount(packed, shared(cameras_, drawn->stroke.camera));
    putCount(packed, shared(brushes_, drawn->brush));
    if (drawn->outcome) {
      putCount(packed, drawn->outcome->misses);
      putCount(packed, drawn->outcome->pieces);
      putCount(packed, drawn->outcome->stamps.size());
      for (const Stamp& stamp : drawn->outcome->stamps) putStamp(packed, stamp, drawn->brush);
    }
    retarget::encodePoints(drawn->stroke.points, packed,
                           {.time = options_.times, .pressure = options_.pressures});
  } else {
    throw InternalError("History::add: undo and redo are moves of the cursor, not nodes");
  }

  makeRoom(nodes_, 1);
  makeRoom(packed_, packed.size());
  const std::uint64_t offset = packed_.size();
  packed_.insert(packed_.end(), packed.begin(), packed.end());
  const auto number = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({.parent = indexOf(cursor_), .redo = 0, .result = result, .offset = offset});
  nodes_[indexOf(cursor_)].redo = number;
  cursor_ = NodeId{number};
  return cursor_;
}

std::span<const std::uint8_t> History::packed(NodeId node) const {
  const std::size_t index = indexOf(node);
  RESTROKE_CHECK_LT(std::size_t{0}, index);
  RESTROKE_CHECK_LT(index, nodes_.size());
  const std::size_t end = index + 1 < nodes_.size() ? nodes_[index + 1].offset : packed_.size();
  return std::span(packed_).subspan(nodes_[index].offset, end - nodes_[index].offset);
}

Command History::command(NodeId node) const {
  std::span<const std::uint8_t> in = packed(node);
  const std::uint8_t head = in.front();
  in = in.subspan(1);
  if ((head & kFixedFlag) != 0) {
    FixedCommand fixed;
    fixed.mode = (head & kSecondFlag) != 0 ? Mode::Carve : Mode::Add;
    fixed.stamps.resize(takeCount(in));
    for (implicit::Sphere& stamp : fixed.stamps) stamp = takeSphere(in);
    const std::size_t count = takeCount(in);
    if (count > 0) {
      const auto first = shapes_.begin() + static_cast<std::ptrdiff_t>(takeCount(in));
      fixed.shapes.assign(first, first + static_cast<std::ptrdiff_t>(count));
    }
    return fixed;
  }
  StrokeCommand drawn;
  drawn.method = static_cast<retarget::Method>(head >> kMethodShift);
  drawn.stroke.camera = cameras_[takeCount(in)];
  drawn.brush = brushes_[takeCount(in)];
  if ((head & kSecondFlag) != 0) {
    StrokeOutcome outcome;
    outcome.misses = takeCount(in);
    outcome.pieces = takeCount(in);
    outcome.stamps.resize(takeCount(in));
    for (Stamp& stamp : outcome.stamps) stamp = takeStamp(in, drawn.brush);
    drawn.outcome = std::move(outcome);
  }
  drawn.stroke.points = retarget::decodePoints(in);
  return drawn;
}

NodeId History::parent(NodeId node) const {
  return NodeId{nodes_[indexOf(node)].parent};
}

NodeId History::redoTarget(NodeId node) const {
  const std::uint32_t redo = nodes_[indexOf(node)].redo;
  return redo == 0 ? node : NodeId{redo};
}

NodeResult History::result(NodeId node) const {
  return nodes_[indexOf(node)].result;
}

void History::setResult(NodeId node, NodeResult result) {
  nodes_[indexOf(node)].result = result;
}

void History::moveCursor(NodeId node) {
  RESTROKE_CHECK_LT(indexOf(node), nodes_.size());
  if (node != parent(cursor_)) {
    // Stops at the cursor: above it, the marks already lead here.
    for (std::uint32_t at = indexOf(node); at != 0 && at != indexOf(cursor_); at = nodes_[at].parent)
      nodes_[nodes_[at].parent].redo = at;
  }
  cursor_ = node;
}

std::vector<NodeId> History::pathTo(NodeId node) const {
  std::vector<NodeId> path;
  for (; node != kRootNode; node = parent(node)) path.push_back(node);
  std::reverse(path.begin(), path.end());
  return path;
}

std::size_t History::bytes() const {
  std::size_t tips = 0;  // brushes may share one
  for (std::size_t i = 0; i < brushes_.size(); ++i) {
    const implicit::Volume* tip = brushes_[i].tip.get();
    const auto same = [tip](const Brush& brush) { return brush.tip.get() == tip; };
    if (tip && std::none_of(brushes_.begin(), brushes_.begin() + static_cast<std::ptrdiff_t>(i), same))
      tips += sizeof(*tip) + implicit::bytesOf(tip->parameters());
  }
  return nodes_.capacity() * sizeof(Node) + cameras_.capacity() * sizeof(Camera) +
         brushes_.capacity() * sizeof(Brush) + tips + packed_.capacity() +
         shapes_.capacity() * sizeof(implicit::Shape);
}

}  // namespace restroke::sculpt
