#pragma once
// Shapes in words: as a log's JSON has them, and as the command line names them (format in sculpt/README.md).

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "implicit/shape.h"
#include "sculpt/json_reader.h"

namespace restroke::sculpt {

/// What to do with a mesh that is not the boundary of a solid.
enum class Repair : std::uint8_t {
  None,    ///< refuse it, and say what is wrong
  Winding  ///< take the points whose generalised winding number is at least 1/2
};

/// Takes one line for people: what was wrong with a mesh and what was made of it.
using RepairNote = std::function<void(std::string_view)>;

/// A mesh from a file, for the parameter of a volume that is a mesh. Repair::None takes it as it is. With
/// Repair::Winding a mesh with faults becomes one without (points::repairByWinding at its own resolution), is
/// marked as repaired, and `note` is called where there is one; a mesh without faults stays as it is. Same
/// file, same bits. Throws InputError that names the file.
[[nodiscard]] std::shared_ptr<const implicit::MeshSource> readMeshSource(const std::filesystem::path& file,
                                                                         Repair repair,
                                                                         const RepairNote& note = {});

/// {"torus":{"radius":1,"tube":0.3,"position":[0,0,0],"rotation":[0,0,0,1],"scale":1}}: the kind, its
/// parameters and its pose. Parts of the pose that change nothing are left out; a sphere is
/// {"sphere":{"center":...,"radius":...}}. Files of meshes are named as seen from `folder`.
[[nodiscard]] std::string formatShape(const implicit::Shape& shape, const std::filesystem::path& folder);
/// The same without a pose: a brush's tip.
[[nodiscard]] std::string formatVolume(const implicit::Volume& volume, const std::filesystem::path& folder);

/// Throw InputError "FILE:LINE: PATH ...". Files of meshes are looked for from `folder`.
[[nodiscard]] implicit::Shape shapeOf(const JsonField& field, const std::filesystem::path& folder);
[[nodiscard]] std::shared_ptr<const implicit::Volume> volumeOf(const JsonField& field,
                                                               const std::filesystem::path& folder);

/// "sphere" (radius 1 about the origin), "sphere:x,y,z,r", a kind with its numbers
/// ("torus:radius=1,tube=0.3"; points are "points=x,y,z,x,y,z,..."), or the name of a mesh file. Throws
/// InputError that begins with `option`.
[[nodiscard]] implicit::Shape shapeNamed(std::string_view text, Repair repair, std::string_view option,
                                         const RepairNote& note = {});
/// The same without the sphere, for a brush's tip: null for "ball".
[[nodiscard]] std::shared_ptr<const implicit::Volume> tipNamed(std::string_view text, Repair repair,
                                                               std::string_view option,
                                                               const RepairNote& note = {});

/// One line for each kind: name, parameters, meaning. For the command line's help.
[[nodiscard]] std::string describeKinds();

}  // namespace restroke::sculpt
