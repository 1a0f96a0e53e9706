// Two-level scenes as in I. Wald, C. Benthin, P. Slusallek, Distributed interactive ray tracing of dynamic
// scenes, 2003: a tree for each group of discs, and a small one over the groups. Embree's own dynamic scenes
// keep trees a geometry for triangles only, so each group is a scene, put in place by an instance.

#include "retarget/methods/disc_scene.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>
#include <vector>

#include "implicit/errors.h"
#include "implicit/parallel.h"
#include "retarget/methods/embree_api.h"

namespace restroke::retarget {
namespace {

using implicit::PrimitiveId;
using implicit::PrimitiveList;
using implicit::SampledShape;

constexpr std::uint32_t kPatchSamples = static_cast<std::uint32_t>(implicit::kPatch);

[[noreturn]] void fail(const char* step, RTCError error) {
  throw InputError(
      fmt::format("method embree: {} failed (Embree error {}); the methods exact and depth-cpu do without",
                  step, static_cast<int>(error)));
}

/// One device for the process: making one starts Embree's machinery, and scenes of one device share it.
RTCDevice sharedDevice() {
  static const RTCDevice device = rtcNewDevice(nullptr);
  if (device == nullptr) fail("starting Embree", rtcGetDeviceError(nullptr));
  return device;
}

// Embree keeps errors by thread: asked for in the thread that may have met one.
void check(const char* step) {
  if (const RTCError error = rtcGetDeviceError(sharedDevice()); error != RTC_ERROR_NONE) fail(step, error);
}

struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct ReleaseGeometry {
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using SceneHandle = std::unique_ptr<RTCSceneTy, ReleaseScene>;
using GeometryHandle = std::unique_ptr<RTCGeometryTy, ReleaseGeometry>;

SceneHandle newScene() {
  SceneHandle scene(rtcNewScene(sharedDevice()));
  if (!scene) fail("making a scene", rtcGetDeviceError(sharedDevice()));
  // In robust mode rays do not slip between neighbouring boxes of the tree.
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  return scene;
}

GeometryHandle newGeometry(RTCGeometryType type) {
  GeometryHandle geometry(rtcNewGeometry(sharedDevice(), type));
  if (!geometry) fail("making a geometry", rtcGetDeviceError(sharedDevice()));
  return geometry;
}

float* newBuffer(RTCGeometry geometry, RTCBufferType type, std::size_t floats, std::size_t count) {
  const RTCFormat format = floats == 4 ? RTC_FORMAT_FLOAT4 : RTC_FORMAT_FLOAT3;
  void* memory = rtcSetNewGeometryBuffer(geometry, type, 0, format, floats * sizeof(float), count);
  if (memory == nullptr) fail("taking memory for the discs", rtcGetDeviceError(sharedDevice()));
  return static_cast<float*>(memory);
}

/// Embree's copy of the discs' shape has these beside it, to tell faces apart and to know how far to look.
struct Disc {
  Vec3 normal;
  float radius;
};

/// Rejects discs that face away: the far side of a solid.
void keepFrontFaces(const RTCFilterFunctionNArguments* arguments) {
  const auto& discs = *static_cast<const std::vector<Disc>*>(arguments->geometryUserPtr);
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] == 0) continue;
    const Vec3 normal = discs[RTCHitN_primID(arguments->hit, arguments->N, i)].normal;
    const Vec3 direction{RTCRayN_dir_x(arguments->ray, arguments->N, i),
                         RTCRayN_dir_y(arguments->ray, arguments->N, i),
                         RTCRayN_dir_z(arguments->ray, arguments->N, i)};
    if (!(dot(normal, direction) < 0)) arguments->valid[i] = 0;
  }
}

using CellKey = std::array<std::int32_t, 3>;

/// Patches of one primitive, one after the other, that belong to one group.
struct Piece {
  std::uint32_t group, first, count;
  bool operator<(const Piece& other) const {
    return std::pair(group, first) < std::pair(other.group, other.first);
  }
};

/// How the primitive in one slot of the list was at the last update.
struct Held {
  std::uint64_t seen = 0;  ///< number of the last update that found it
  implicit::Sphere ball;
  bool positive = true;
  std::shared_ptr<const implicit::PosedVolume> volume;  ///< held, so that no other gets its address
  std::vector<std::uint16_t> masks;                     ///< empty: there is none in this slot
  std::vector<Piece> pieces;                            ///< in order
};

struct Group {
  CellKey cell{};
  std::vector<std::uint32_t> slots;  ///< of the primitives that have pieces here
  std::vector<Disc> discs;           ///< Embree's filter refers to it
  SceneHandle scene;
  GeometryHandle instance;  ///< under the group's number; null while there are no discs
  bool changed = false;
};

bool anyVisible(std::span<const std::uint16_t> masks, const Piece& piece) {
  const auto own = masks.subspan(piece.first, piece.count);
  return std::any_of(own.begin(), own.end(), [](std::uint16_t bits) { return bits != 0; });
}

/// What a group reads while it is built.
struct Source {
  const points::SurfelModel& model;
  const std::vector<Held>& held;
};

// Calls f(id, piece) for the group's pieces, in list order.
template <class F>
void forPieces(const Group& group, std::uint32_t number, const Source& source, const F& f) {
  for (const std::uint32_t slot : group.slots) {
    const std::vector<Piece>& pieces = source.held[slot].pieces;
    auto piece = std::lower_bound(pieces.begin(), pieces.end(), Piece{number, 0, 0});
    for (; piece != pieces.end() && piece->group == number; ++piece) f(slot, *piece);
  }
}

std::size_t countDiscs(const Group& group, std::uint32_t number, const Source& source) {
  std::size_t count = 0;
  forPieces(group, number, source, [&](std::uint32_t slot, const Piece& piece) {
    for (std::uint32_t p = piece.first; p < piece.first + piece.count; ++p)
      count += static_cast<unsigned>(std::popcount(source.held[slot].masks[p]));
  });
  return count;
}

// Where the next disc goes.
struct Buffers {
  float *vertex, *normal;
  void add(const implicit::PlacedSample& sample, const Disc& disc) {
    for (const float value : {sample.position.x, sample.position.y, sample.position.z, disc.radius})
      *vertex++ = value;
    for (const float value : {disc.normal.x, disc.normal.y, disc.normal.z}) *normal++ = value;
  }
};

void fill(Group& group, std::uint32_t number, const Source& source, Buffers buffers) {
  forPieces(group, number, source, [&](std::uint32_t slot, const Piece& piece) {
    const Held& held = source.held[slot];
    if (!anyVisible(held.masks, piece)) return;
    const SampledShape shape = source.model.sampledShape(PrimitiveId{slot});
    const float radius = source.model.discRadiusOf(PrimitiveId{slot});
    for (std::uint32_t p = piece.first; p < piece.first + piece.count; ++p)
      for (std::uint32_t bits = held.masks[p]; bits != 0; bits &= bits - 1) {
        const implicit::PlacedSample sample = implicit::placedSample(
            shape, p * kPatchSamples + static_cast<std::uint32_t>(std::countr_zero(bits)));
        group.discs.push_back({shape.positive ? sample.normal : -sample.normal, radius});
        buffers.add(sample, group.discs.back());
      }
  });
}

// The group's own scene, from nothing. Touches no other group: groups are built side by side.
void build(Group& group, std::uint32_t number, const Source& source) {
  const auto labels = source.model.list().labels();
  std::sort(group.slots.begin(), group.slots.end(),
            [&](std::uint32_t a, std::uint32_t b) { return labels[a] < labels[b]; });
  group.discs.clear();
  group.scene.reset();
  const std::size_t count = countDiscs(group, number, source);
  if (count == 0) return;
  const GeometryHandle geometry = newGeometry(RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
  float* vertex = newBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 4, count);
  float* normal = newBuffer(geometry.get(), RTC_BUFFER_TYPE_NORMAL, 3, count);
  group.discs.reserve(count);
  fill(group, number, source, {vertex, normal});
  rtcSetGeometryUserData(geometry.get(), &group.discs);
  rtcSetGeometryIntersectFilterFunction(geometry.get(), keepFrontFaces);
  rtcCommitGeometry(geometry.get());
  group.scene = newScene();
  rtcAttachGeometry(group.scene.get(), geometry.get());
  // Alone, so that a thread that waits in here does not begin with another group.
  tbb::this_task_arena::isolate([&] { rtcCommitScene(group.scene.get()); });
  check("building a group of discs");
}

}  // namespace

class DiscScene::Groups {
 public:
  explicit Groups(DiscSceneOptions options) : options_(options) { forget(); }

  void update(const points::SurfelModel& model, implicit::Prefix prefix, const Execution& execution) {
    chooseCell(model.list().boundingSphere(prefix).radius);
    ++update_;
    compareAll(model, model.visibleSamples(prefix, execution));
    rebuild({model, held_}, execution);
  }

  /// Back to the beginning.
  void forget() {
    held_.clear();
    byCell_.clear();
    top_.reset();  // before the scenes that its instances refer to
    groups_.clear();
    free_.clear();
    changed_.clear();
    cell_ = 0;
    discs_ = 0;
    top_ = newScene();
    rtcCommitScene(top_.get());  // it may be asked before it has anything
  }

  [[nodiscard]] std::optional<Hit> nearest(const Ray& ray, float from) const {
    RTCRayHit query{};
    query.ray.org_x = static_cast<float>(ray.origin.x);
    query.ray.org_y = static_cast<float>(ray.origin.y);
    query.ray.org_z = static_cast<float>(ray.origin.z);
    query.ray.dir_x = static_cast<float>(ray.direction.x);
    query.ray.dir_y = static_cast<float>(ray.direction.y);
    query.ray.dir_z = static_cast<float>(ray.direction.z);
    query.ray.tnear = from;
    query.ray.tfar = static_cast<float>(ray.tMax);
    query.ray.mask = ~0u;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    intersectOne(top_.get(), query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return Hit{query.ray.tfar, groups_[query.hit.instID[0]]->discs[query.hit.primID].radius};
  }

  [[nodiscard]] std::size_t discCount() const { return discs_; }
  [[nodiscard]] std::size_t groupCount() const { return byCell_.size(); }
  [[nodiscard]] std::size_t rebuiltGroups() const { return rebuilt_; }

 private:
  void chooseCell(float radius) {
    const double wanted = options_.cell * static_cast<double>(radius);
    if (cell_ > 0 && wanted >= cell_ / 2 && wanted <= cell_ * 2) return;
    forget();
    cell_ = wanted > 0 ? wanted : 1;
  }

  void compareAll(const points::SurfelModel& model, const points::VisibleSamples& visible) {
    const PrimitiveList& list = model.list();
    if (held_.size() < list.slotCount()) held_.resize(list.slotCount());
    for (std::size_t i = 0; i < visible.of.size(); ++i) {
      const std::uint32_t slot = PrimitiveList::slotOf(list.idAt(i));
      held_[slot].seen = update_;
      if (isTheSame(held_[slot], list, slot) && held_[slot].masks.size() == visible.of[i].size()) {
        compare(held_[slot], visible.of[i]);
      } else {
        drop(slot);
        take(model, slot, visible.of[i]);
      }
    }
    for (std::uint32_t slot = 0; slot < held_.size(); ++slot)
      if (held_[slot].seen != update_) drop(slot);
  }

  static bool isTheSame(const Held& held, const PrimitiveList& list, std::uint32_t slot) {
    return held.ball == list.balls()[slot] && held.positive == list.isPositive(slot) &&
           held.volume.get() == list.volumeIn(slot);
  }

  void compare(Held& held, std::span<const std::uint16_t> masks) {
    if (std::memcmp(held.masks.data(), masks.data(), masks.size_bytes()) == 0) return;
    for (const Piece& piece : held.pieces)
      if (std::memcmp(&held.masks[piece.first], &masks[piece.first], piece.count * sizeof(masks[0])) != 0)
        mark(piece.group);
    std::copy(masks.begin(), masks.end(), held.masks.begin());
  }

  void drop(std::uint32_t slot) {
    Held& held = held_[slot];
    for (std::size_t i = 0; i < held.pieces.size(); ++i) {
      const Piece& piece = held.pieces[i];
      if (anyVisible(held.masks, piece)) mark(piece.group);
      if (i > 0 && held.pieces[i - 1].group == piece.group) continue;
      std::erase(groups_[piece.group]->slots, slot);
      if (groups_[piece.group]->slots.empty()) mark(piece.group);  // to be given up
    }
    const std::uint64_t seen = held.seen;
    held = {};
    held.seen = seen;
  }

  void take(const points::SurfelModel& model, std::uint32_t slot, std::span<const std::uint16_t> masks) {
    Held& held = held_[slot];
    const PrimitiveList& list = model.list();
    held.ball = list.balls()[slot];
    held.positive = list.isPositive(slot);
    held.volume = list[PrimitiveId{slot}].shape.sharedVolume();
    held.masks.assign(masks.begin(), masks.end());
    cut(held, model.sampledShape(PrimitiveId{slot}));
    for (std::size_t i = 0; i < held.pieces.size(); ++i) {
      const Piece& piece = held.pieces[i];
      if (i == 0 || held.pieces[i - 1].group != piece.group) groups_[piece.group]->slots.push_back(slot);
      if (anyVisible(masks, piece)) mark(piece.group);
    }
  }

  // By a primitive's own place and size alone, so that a scene built from nothing has the same groups.
  void cut(Held& held, const SampledShape& shape) {
    const auto patches = static_cast<std::uint32_t>(held.masks.size());
    if (static_cast<double>(held.ball.radius) <= cell_ / 2) {
      held.pieces.push_back({groupAt(held.ball.center), 0, patches});
      return;
    }
    for (std::uint32_t p = 0; p < patches; ++p) {
      const std::uint32_t group = groupAt(implicit::placedSample(shape, p * kPatchSamples).position);
      if (!held.pieces.empty() && held.pieces.back().group == group)
        ++held.pieces.back().count;
      else
        held.pieces.push_back({group, p, 1});
    }
    std::sort(held.pieces.begin(), held.pieces.end());
    held.pieces.shrink_to_fit();
  }

  std::uint32_t groupAt(Point place) {
    const auto along = [&](float x) {
      return static_cast<std::int32_t>(std::clamp(std::floor(static_cast<double>(x) / cell_), -2e9, 2e9));
    };
    const CellKey cell{along(place.x), along(place.y), along(place.z)};
    const auto [found, isNew] = byCell_.try_emplace(cell, 0);
    if (!isNew) return found->second;
    if (free_.empty()) {
      found->second = static_cast<std::uint32_t>(groups_.size());
      groups_.push_back(std::make_unique<Group>());
    } else {
      found->second = free_.back();
      free_.pop_back();
    }
    groups_[found->second]->cell = cell;
    return found->second;
  }

  void mark(std::uint32_t group) {
    if (!std::exchange(groups_[group]->changed, true)) changed_.push_back(group);
  }

  void rebuild(const Source& source, const Execution& execution) {
    for (const std::uint32_t number : changed_) discs_ -= groups_[number]->discs.size();
    inArena(execution, [&] {
      tbb::parallel_for(std::size_t{0}, changed_.size(),
                        [&](std::size_t i) { build(*groups_[changed_[i]], changed_[i], source); });
    });
    rebuilt_ = changed_.size();
    for (const std::uint32_t number : changed_) place(number);
    if (changed_.empty()) return;
    changed_.clear();
    inArena(execution, [&] {
      rtcCommitScene(top_.get());
      check("building the scene of all groups");
    });
  }

  // Puts a group's new scene where its former one was.
  void place(std::uint32_t number) {
    Group& group = *groups_[number];
    group.changed = false;
    discs_ += group.discs.size();
    if (!group.scene) {
      if (group.instance) rtcDetachGeometry(top_.get(), number);
      group.instance.reset();
      if (!group.slots.empty()) return;
      byCell_.erase(group.cell);
      free_.push_back(number);
      return;
    }
    const bool isNew = !group.instance;
    if (isNew) group.instance = newGeometry(RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(group.instance.get(), group.scene.get());
    rtcCommitGeometry(group.instance.get());
    if (isNew) rtcAttachGeometryByID(top_.get(), group.instance.get(), number);
    check("placing a group of discs");
  }

  DiscSceneOptions options_;
  double cell_ = 0;  // model units; 0: not chosen yet
  std::uint64_t update_ = 0;
  std::vector<Held> held_;  // by slot
  std::map<CellKey, std::uint32_t> byCell_;
  std::vector<std::unique_ptr<Group>> groups_;  // by number, at rest for Embree
  std::vector<std::uint32_t> free_, changed_;
  std::size_t discs_ = 0, rebuilt_ = 0;
  SceneHandle top_;
};

DiscScene::DiscScene(DiscSceneOptions options) : groups_(std::make_unique<Groups>(options)) {}
DiscScene::~DiscScene() = default;

void DiscScene::update(const points::SurfelModel& model, implicit::Prefix prefix,
                       const Execution& execution) {
  try {
    groups_->update(model, prefix, execution);
  } catch (...) {
    groups_->forget();
    throw;
  }
}

std::optional<DiscScene::Hit> DiscScene::nearest(const Ray& ray, float from) const {
  return groups_->nearest(ray, from);
}

std::size_t DiscScene::discCount() const {
  return groups_->discCount();
}
std::size_t DiscScene::groupCount() const {
  return groups_->groupCount();
}
std::size_t DiscScene::rebuiltGroups() const {
  return groups_->rebuiltGroups();
}

}  // namespace restroke::retarget
