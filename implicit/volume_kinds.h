#pragma once
// The kinds of volume there are, and what describes one of each: the one list that the log, the command line,
// the conformance suite and the gallery read (SPEC S13).

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "implicit/geometry/triangle_mesh.h"

namespace restroke::implicit {

class Volume;

/// One parameter of a kind.
struct ParameterInfo {
  /// What its values are.
  enum class Form : std::uint8_t {
    Number,         ///< one number
    ProfilePoints,  ///< pairs (distance from the axis, height)
    Points,         ///< triples x, y, z
    Mesh            ///< a closed triangle mesh
  };
  std::string_view name;     ///< as in the log, for instance "radius"
  std::string_view meaning;  ///< with unit and range
  Form form = Form::Number;
  bool optional = false;  ///< a number that may be left out: 0 then
};

/// A mesh, and where it came from.
struct MeshSource {
  TriangleMesh mesh;
  std::string file = {};   ///< where it was read; empty: from no file
  std::uint64_t hash = 0;  ///< of the file's bytes, 0 without a file
  bool repaired = false;   ///< the file is no boundary of a solid; this is what its winding number made of it
};

/// Values for the parameters of a kind, in their order. Lengths are in the units of the volume's own frame.
struct VolumeParameters {
  std::vector<std::vector<float>> values;       ///< a number has one; points follow each other
  std::shared_ptr<const MeshSource> mesh = {};  ///< of the parameter that is a mesh
  bool operator==(const VolumeParameters& other) const;
};

/// Bytes that the parameters hold beyond their own size, the mesh (which may be shared) included.
[[nodiscard]] std::size_t bytesOf(const VolumeParameters& parameters);

/// A kind of volume.
struct VolumeKind {
  std::string_view name;     ///< as in the log and on the command line, for instance "torus"
  std::string_view summary;  ///< one line; the frame: which axis, where the origin is
  std::vector<ParameterInfo> parameters;
  /// Throws InputError ("a torus has ...; ...") when a value is not finite or not in its range.
  std::shared_ptr<const Volume> (*make)(const VolumeParameters& parameters);
  /// Ordinary and extreme ones (thin, long, sharp): what the conformance suite tries. The first, of a size
  /// about 1, is shown in the gallery.
  std::vector<VolumeParameters> (*examples)();
};

/// All kinds, in a fixed order.
[[nodiscard]] std::span<const VolumeKind* const> volumeKinds();

/// The kind of that name. Throws InputError that lists the names there are.
[[nodiscard]] const VolumeKind& volumeKindNamed(std::string_view name);

/// For kinds' `make`: the k-th parameter, a number. Throws InputError unless it is finite and follows the
/// rule.
enum class NumberRule : std::uint8_t { NotNegative, Positive };
[[nodiscard]] double numberOf(const VolumeKind& kind, const VolumeParameters& parameters, std::size_t k,
                              NumberRule rule);

}  // namespace restroke::implicit
