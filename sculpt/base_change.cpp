#include "sculpt/base_change.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

#include "implicit/errors.h"
#include "implicit/primitive_list.h"
#include "implicit/volume_kinds.h"

namespace restroke::sculpt {

namespace {

using Matrix = std::array<double, 9>;  // rows first

DVec3 column(const Matrix& m, std::size_t k) {
  return {m[k], m[3 + k], m[6 + k]};
}

Matrix withColumns(DVec3 a, DVec3 b, DVec3 c) {
  return {a.x, b.x, c.x, a.y, b.y, c.y, a.z, b.z, c.z};
}

// float32 matrices of rotations are orthogonal to about 1e-7.
constexpr double kSame = 1e-5;

/// A turn, and a factor for all lengths.
struct Turned {
  std::array<double, 4> rotation{0, 0, 0, 1};  // x, y, z, w
  double scale = 1;
};

// Shepperd, "Quaternion from rotation matrix", 1978: divides by the largest of the four components.
std::array<double, 4> quaternionOf(const Matrix& m) {
  const double trace = m[0] + m[4] + m[8];
  std::array<double, 4> q;
  if (trace > 0) {
    const double s = 2 * std::sqrt(1 + trace);
    q = {(m[7] - m[5]) / s, (m[2] - m[6]) / s, (m[3] - m[1]) / s, s / 4};
  } else {
    const std::size_t i = m[0] >= m[4] && m[0] >= m[8] ? 0 : m[4] >= m[8] ? 1 : 2;
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    const double s = 2 * std::sqrt(1 + m[4 * i] - m[4 * j] - m[4 * k]);
    q[i] = s / 4;
    q[j] = (m[3 * j + i] + m[3 * i + j]) / s;
    q[k] = (m[3 * k + i] + m[3 * i + k]) / s;
    q[3] = (m[3 * k + j] - m[3 * j + k]) / s;
  }
  return q;
}

std::optional<Turned> similarityOf(const Matrix& m) {
  const DVec3 a = column(m, 0), b = column(m, 1), c = column(m, 2);
  const double square = (dot(a, a) + dot(b, b) + dot(c, c)) / 3;
  const double limit = kSame * square;
  for (const double off :
       {dot(a, b), dot(b, c), dot(c, a), dot(a, a) - square, dot(b, b) - square, dot(c, c) - square})
    if (!(std::fabs(off) <= limit)) return std::nullopt;
  Turned turned;
  turned.scale = std::sqrt(square);
  Matrix unit = m;
  for (double& x : unit) x /= turned.scale;
  turned.rotation = quaternionOf(unit);
  return turned;
}

std::array<double, 4> product(const std::array<double, 4>& a, const std::array<double, 4>& b) {
  const DVec3 v(a[0], a[1], a[2]), u(b[0], b[1], b[2]);
  const DVec3 xyz = a[3] * u + b[3] * v + cross(v, u);
  return {xyz.x, xyz.y, xyz.z, a[3] * b[3] - dot(v, u)};
}

// What the pose's rotation and scale make of vectors.
Matrix matrixOfPose(const implicit::Pose& pose) {
  double q[4], norm = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    q[i] = static_cast<double>(pose.rotation[i]);
    norm += q[i] * q[i];
  }
  const double s = 2 / norm, scale = static_cast<double>(pose.scale);
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  Matrix m{1 - s * (y * y + z * z), s * (x * y - z * w),     s * (x * z + y * w),
           s * (x * y + z * w),     1 - s * (x * x + z * z), s * (y * z - x * w),
           s * (x * z - y * w),     s * (y * z + x * w),     1 - s * (x * x + y * y)};
  for (double& e : m) e *= scale;
  return m;
}

implicit::Pose poseOf(DVec3 position, const std::array<double, 4>& rotation, double scale) {
  implicit::Pose pose{.position = Point(position), .scale = static_cast<float>(scale)};
  for (std::size_t i = 0; i < 4; ++i) pose.rotation[i] = static_cast<float>(rotation[i]);
  return pose;
}

/// Orthogonal columns whose lengths are the semi-axes of the unit ball's image: one-sided Jacobi (Hestenes,
/// "Inversion of matrices by biorthogonalization and related results", 1958), which turns the columns against
/// each other in pairs.
Matrix withOrthogonalColumns(Matrix m) {
  for (int sweep = 0; sweep < 60; ++sweep) {
    bool turned = false;
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = i + 1; j < 3; ++j) {
        const DVec3 a = column(m, i), b = column(m, j);
        const double off = dot(a, b), aa = dot(a, a), bb = dot(b, b);
        if (std::fabs(off) <= 1e-15 * std::sqrt(aa * bb)) continue;
        turned = true;
        const double zeta = (bb - aa) / (2 * off);
        const double t = (zeta >= 0 ? 1 : -1) / (std::fabs(zeta) + std::sqrt(1 + zeta * zeta));
        const double c = 1 / std::sqrt(1 + t * t), s = c * t;
        for (std::size_t row = 0; row < 3; ++row) {
          double &x = m[3 * row + i], &y = m[3 * row + j];
          const double old = x;
          x = c * old - s * y;
          y = s * old + c * y;
        }
      }
    if (!turned) break;
  }
  return m;
}

implicit::Shape ellipsoidOf(const Matrix& image, DVec3 position) {
  const Matrix m = withOrthogonalColumns(image);
  const DVec3 a = column(m, 0), b = column(m, 1);
  DVec3 c = column(m, 2);
  const double lengths[3] = {length(a), length(b), length(c)};
  // The third axis may point either way; a rotation needs it right-handed.
  if (dot(cross(a, b), c) < 0) c = -c;
  const auto axes = implicit::volumeKindNamed("ellipsoid")
                        .make({{{static_cast<float>(lengths[0])},
                                {static_cast<float>(lengths[1])},
                                {static_cast<float>(lengths[2])}}});
  const Matrix rotation = withColumns(a / lengths[0], b / lengths[1], c / lengths[2]);
  return std::make_shared<const implicit::PosedVolume>(axes, poseOf(position, quaternionOf(rotation), 1));
}

implicit::Shape meshImage(const implicit::PosedVolume& base, const Affine& map) {
  const auto& source = base.volume().parameters().mesh;
  auto image = std::make_shared<implicit::MeshSource>();
  image->mesh = source->mesh;
  for (Point& v : image->mesh.vertices) v = Point(map.point(base.toModel(DVec3(v))));
  implicit::VolumeParameters parameters = base.volume().parameters();
  parameters.mesh = image;
  return std::make_shared<const implicit::PosedVolume>(base.volume().kind().make(parameters),
                                                       implicit::Pose{});
}

implicit::Shape image(const implicit::Shape& shape, const Affine& map, const std::string& where) {
  const std::optional<Turned> turned = similarityOf(map.matrix);
  if (shape.isSphere()) {
    const implicit::Sphere& ball = shape.ball();
    const auto radius = static_cast<double>(ball.radius);
    const DVec3 center = map.point(DVec3(ball.center));
    if (turned) return implicit::Shape(Point(center), static_cast<float>(radius * turned->scale));
    Matrix m = map.matrix;
    for (double& x : m) x *= radius;
    return ellipsoidOf(m, center);
  }
  const implicit::PosedVolume& volume = *shape.volume();
  const implicit::Pose& pose = volume.pose();
  if (turned) {
    std::array<double, 4> rotation;
    for (std::size_t i = 0; i < 4; ++i) rotation[i] = static_cast<double>(pose.rotation[i]);
    return std::make_shared<const implicit::PosedVolume>(
        volume.sharedVolume(), poseOf(map.point(DVec3(pose.position)), product(turned->rotation, rotation),
                                      turned->scale * static_cast<double>(pose.scale)));
  }
  const std::string_view kind = volume.volume().kind().name;
  if (kind == "ellipsoid") {
    Affine axes;
    axes.matrix = matrixOfPose(pose);
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t row = 0; row < 3; ++row)
        axes.matrix[3 * row + k] *= static_cast<double>(volume.volume().parameters().values[k][0]);
    return ellipsoidOf(composed(map, axes).matrix, map.point(DVec3(pose.position)));
  }
  if (volume.volume().parameters().mesh) return meshImage(volume, map);
  throw InputError(fmt::format(
      "{}: the map is no similarity, but a {} can only be turned, scaled evenly and moved (a sphere, an "
      "ellipsoid and a mesh can be sheared and scaled unevenly)",
      where, kind));
}

// The numbers between blanks; nothing when one of them is not a finite number.
std::optional<std::vector<double>> numbersIn(std::string_view text) {
  std::vector<double> numbers;
  for (;;) {
    const std::size_t begin = text.find_first_not_of(' ');
    if (begin == std::string_view::npos) return numbers;
    text.remove_prefix(begin);
    const std::string_view word = text.substr(0, text.find(' '));
    double value = 0;
    const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || rest != word.data() + word.size() || !std::isfinite(value))
      return std::nullopt;
    numbers.push_back(value);
    text.remove_prefix(word.size());
  }
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(' ');
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

// Rodrigues' formula.
Affine rotation(DVec3 axis, double degrees) {
  constexpr double kDegree = 3.141592653589793 / 180;
  const DVec3 k = normalized(axis);
  const double c = std::cos(degrees * kDegree), s = std::sin(degrees * kDegree);
  const auto turned = [&](DVec3 p) { return p * c + cross(k, p) * s + k * (dot(k, p) * (1 - c)); };
  return {.matrix = withColumns(turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1}))};
}

Affine partNamed(std::string_view part, const std::string& where) {
  const std::size_t space = part.find(' ');
  const std::string_view verb = part.substr(0, space);
  const auto numbers = numbersIn(space == std::string_view::npos ? std::string_view() : part.substr(space));
  const std::size_t count = numbers ? numbers->size() : 0;
  const auto vec = [&] { return DVec3((*numbers)[0], (*numbers)[1], (*numbers)[2]); };
  if (verb == "translate" && count == 3) return {.offset = vec()};
  if (verb == "rotate" && count == 4) {
    if (!(dot(vec(), vec()) > 0))
      throw InputError(fmt::format(
          "{}: \"{}\" turns about an axis of length 0, but the axis must have a direction", where, part));
    return rotation(vec(), (*numbers)[3]);
  }
  if (verb == "scale" && (count == 1 || count == 3)) {
    const DVec3 s = count == 3 ? vec() : DVec3((*numbers)[0]);
    if (!(s.x > 0 && s.y > 0 && s.z > 0))
      throw InputError(
          fmt::format("{}: \"{}\" scales by a factor that is not more than 0, but must", where, part));
    return {.matrix = {s.x, 0, 0, 0, s.y, 0, 0, 0, s.z}};
  }
  throw InputError(fmt::format(
      "{}: \"{}\" is not understood, but parts must be translate x y z, rotate ax ay az degrees or scale s, "
      "with ; between them",
      where, part));
}

}  // namespace

Affine affineOf(const std::array<float, 12>& matrix) {
  Affine affine;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t k = 0; k < 3; ++k) affine.matrix[3 * row + k] = static_cast<double>(matrix[4 * row + k]);
  affine.offset = {static_cast<double>(matrix[3]), static_cast<double>(matrix[7]),
                   static_cast<double>(matrix[11])};
  return affine;
}

std::array<float, 12> matrixOf(const Affine& affine) {
  std::array<float, 12> matrix;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t k = 0; k < 3; ++k) matrix[4 * row + k] = static_cast<float>(affine.matrix[3 * row + k]);
  matrix[3] = static_cast<float>(affine.offset.x);
  matrix[7] = static_cast<float>(affine.offset.y);
  matrix[11] = static_cast<float>(affine.offset.z);
  return matrix;
}

implicit::Shape mappedShape(const implicit::Shape& shape, const Affine& map, const std::string& where) {
  // Written so that NaN fails.
  if (!(map.determinant() > 0))
    throw InputError(fmt::format(
        "{}: the map's determinant is {}, but must be more than 0 (no mirroring, nothing made flat)", where,
        map.determinant()));
  try {
    const implicit::Shape mapped = image(shape, map, where);
    implicit::validate({mapped, implicit::Sign::Positive});
    return mapped;
  } catch (const InputError& error) {
    const std::string_view sentence = error.what();
    throw InputError(sentence.starts_with(where) ? std::string(sentence)
                                                 : fmt::format("{}: {}", where, sentence));
  }
}

Affine affineNamed(std::string_view text, const std::string& where) {
  Affine map;
  while (!text.empty()) {
    const std::size_t end = text.find(';');
    const std::string_view part = trimmed(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (part.empty() && text.empty()) break;
    map = composed(partNamed(part, where), map);
  }
  return map;
}

}  // namespace restroke::sculpt
