#pragma once
// Table 2 of "Stroke history management for digital sculpting" (Takeuchi, Watanabe, Kakimoto, Mikami, Kondo;
// section 4), and the arithmetic behind it (SPEC S12).

#include <array>
#include <cstddef>
#include <span>

namespace restroke::experiments {

/// One line of the table: bytes of all history after the step.
struct PaperStep {
  std::size_t stamps;  ///< primitives that the step's stroke added (decoded from both columns, which agree)
  std::size_t strokeBytes;    ///< "Stroke-based method(bytes)"
  std::size_t snapshotBytes;  ///< "Snapshot-based method(bytes)"
};
inline constexpr std::array<PaperStep, 8> kPaperTable2 = {{{454, 5'752, 21'792},
                                                           {1, 6'068, 43'632},
                                                           {1, 6'384, 65'520},
                                                           {1, 6'700, 87'456},
                                                           {1, 7'016, 109'440},
                                                           {1, 7'332, 131'472},
                                                           {96, 8'788, 158'112},
                                                           {1, 9'104, 184'800}}};

/// A stroke of n stamps: 304 + 12 n bytes.
[[nodiscard]] constexpr std::size_t paperStrokeBytes(std::size_t stamps) {
  return 304 + 12 * stamps;
}
/// One snapshot: 48 bytes for each primitive so far; the foundation is not counted.
[[nodiscard]] constexpr std::size_t paperSnapshotBytes(std::size_t primitives) {
  return 48 * primitives;
}

/// True when the strokes have the table's numbers of stamps, in its order.
[[nodiscard]] bool isPaperTable2(std::span<const std::size_t> stampsPerStroke);

}  // namespace restroke::experiments
