#include "implicit/volume_kinds.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "implicit/errors.h"
#include "implicit/shapes/kinds.h"

namespace restroke::implicit {

std::span<const VolumeKind* const> volumeKinds() {
  // The one place where a new kind is listed. Their order is that of the gallery.
  static const std::array all = {&roundConeKind(),
                                 &ellipsoidKind(),
                                 &boxKind(),
                                 &cylinderKind(),
                                 &coneFrustumKind(),
                                 &torusKind(),
                                 &superellipsoidKind(),
                                 &convexPolyhedronKind(),
                                 &revolutionKind(),
                                 &meshKind()};
  return all;
}

const VolumeKind& volumeKindNamed(std::string_view name) {
  std::string known;
  for (const VolumeKind* kind : volumeKinds()) {
    if (kind->name == name) return *kind;
    known += fmt::format("{}{}", known.empty() ? "" : ", ", kind->name);
  }
  throw InputError(fmt::format("there is no kind of volume \"{}\"; there are sphere, {}", name, known));
}

bool VolumeParameters::operator==(const VolumeParameters& other) const {
  return values == other.values &&
         (mesh == other.mesh || (mesh && other.mesh && mesh->mesh == other.mesh->mesh));
}

std::size_t bytesOf(const VolumeParameters& parameters) {
  std::size_t bytes = parameters.values.capacity() * sizeof(std::vector<float>);
  for (const auto& v : parameters.values) bytes += v.capacity() * sizeof(float);
  if (parameters.mesh)
    bytes += sizeof(MeshSource) + parameters.mesh->mesh.vertices.capacity() * sizeof(Point) +
             parameters.mesh->mesh.triangles.capacity() * sizeof(std::array<std::uint32_t, 3>);
  return bytes;
}

double numberOf(const VolumeKind& kind, const VolumeParameters& parameters, std::size_t k, NumberRule rule) {
  RESTROKE_CHECK_LE(k + 1, parameters.values.size());
  RESTROKE_CHECK_EQ(parameters.values[k].size(), std::size_t{1});
  const float value = parameters.values[k][0];
  const std::string_view name = kind.parameters[k].name;
  if (!std::isfinite(value))
    throw InputError(fmt::format("the {} of a {} is {}; it must be finite", name, kind.name, value));
  if (rule == NumberRule::Positive && !(value > 0))
    throw InputError(fmt::format("the {} of a {} is {}; it must be greater than 0", name, kind.name, value));
  if (rule == NumberRule::NotNegative && !(value >= 0))
    throw InputError(fmt::format("the {} of a {} is {}; it must be at least 0", name, kind.name, value));
  return static_cast<double>(value);
}

}  // namespace restroke::implicit
