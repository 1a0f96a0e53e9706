#pragma once
// Many lines of a Dexels changed one after the other: quick ways for what most of them need. Internal to
// points/dexel.

#include <cstddef>
#include <cstdint>
#include <limits>

#include "points/dexel/dexels.h"
#include "points/dexel/simd/span_kernels.h"

namespace restroke::points {

/// A stretch of a line to be filled or cleared.
struct Stretch {
  float enter, exit;
  bool fills;
  OperationId id;
};

/// What Dexels::change does, with normals that are made only where an end gets one, and kernels that tell
/// which lines of a row an operation changes. Copies change the same dexels.
class LineChanges {
 public:
  static constexpr std::size_t kLanes = SpanKernels::kLanes;
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();

  explicit LineChanges(Dexels& dexels)
      : dexels_(dexels), hulls_(dexels.hulls()), notes_(dexels.keepsHistory()) {}

  [[nodiscard]] Dexels& dexels() const { return dexels_; }
  [[nodiscard]] const Dexels::Hulls& hulls() const { return hulls_; }
  [[nodiscard]] const SpanKernels& kernels() const { return kernels_; }

  /// Bits of the lines `line` to `line + count - 1` that may change when the spans of a tool are filled or
  /// cleared; enter >= exit: the tool misses the line. At most kLanes.
  [[nodiscard]] std::uint64_t changed(bool fills, std::size_t line, const float* toolEnter,
                                      const float* toolExit, std::size_t count) const {
    const SpanLanes lanes{hulls_.enter + line, hulls_.exit + line, hulls_.more + line, toolEnter, toolExit};
    return fills ? kernels_.changedByUnion(lanes, count) : kernels_.changedBySubtraction(lanes, count);
  }

  /// Fills or clears a stretch, and notes it where histories are kept; `normalAt(exit)` makes the normal that
  /// the solid gets at its beginning or end, when it is needed.
  template <class F>
  void apply(std::size_t line, const Stretch& s, const F& normalAt) {
    if (!dexels_.hasMore(line)) {
      const float enter = hulls_.enter[line], exit = hulls_.exit[line];
      if (s.fills ? fillOne(line, s, normalAt) : clearOne(line, s, normalAt)) {
        // Whatever changes moves an end.
        if (notes_ && (enter != hulls_.enter[line] || exit != hulls_.exit[line]))
          dexels_.noteChange(line, s.id);
        return;
      }
    }
    dexels_.change(line, {s.enter, s.exit, normalAt(false), normalAt(true)}, s.fills, s.id);
  }

 private:
  // A span is shortened or goes, or is made longer, without the way through a list of ends. False: nothing
  // was done.
  template <class F>
  bool clearOne(std::size_t line, const Stretch& span, const F& normalAt) {
    float &enter = hulls_.enter[line], &exit = hulls_.exit[line];
    if (!(span.enter < exit && span.exit > enter)) return true;
    if (span.enter <= enter) {
      if (span.exit >= exit) {
        enter = kInfinity;
        exit = -kInfinity;
        return true;
      }
      if (hulls_.enterInner) {
        if (exit - span.exit < span.exit - enter) hulls_.enterInner[line] = hulls_.exitInner[line];
        hulls_.enterOuter[line] = span.id;
      }
      enter = span.exit;
      hulls_.enterNormal[line] = normalAt(true) | kPackedFlag;
      return true;
    }
    if (span.exit < exit) return false;  // it splits
    if (hulls_.enterInner) {
      if (!(exit - span.enter < span.enter - enter)) hulls_.exitInner[line] = hulls_.enterInner[line];
      hulls_.exitOuter[line] = span.id;
    }
    exit = span.enter;
    hulls_.exitNormal[line] = normalAt(false) | kPackedFlag;
    return true;
  }

  template <class F>
  bool fillOne(std::size_t line, const Stretch& span, const F& normalAt) {
    float &enter = hulls_.enter[line], &exit = hulls_.exit[line];
    if (dexels_.isEmpty(line) || span.enter > exit || span.exit < enter) return false;
    if (span.enter < enter) {
      enter = span.enter;
      hulls_.enterNormal[line] = normalAt(false) | kPackedFlag;
      if (hulls_.enterInner) hulls_.enterInner[line] = span.id;
    }
    if (span.exit > exit) {
      exit = span.exit;
      hulls_.exitNormal[line] = normalAt(true) | kPackedFlag;
      if (hulls_.enterInner) hulls_.exitInner[line] = span.id;
    }
    return true;
  }

  Dexels& dexels_;
  Dexels::Hulls hulls_;
  bool notes_;
  const SpanKernels& kernels_ = spanKernels();
};

}  // namespace restroke::points
