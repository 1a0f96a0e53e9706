// restroke export: the shape for other programs, as a mesh or as points with normals; mesh files become
// others, and so do tri-dexels.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "implicit/errors.h"
#include "points/dexel/dexel_contour.h"
#include "points/dexel/dexel_surfels.h"
#include "points/dexel/tridexel_file.h"
#include "points/files/mesh_files.h"
#include "points/files/point_files.h"
#include "points/isosurface/isosurface.h"
#include "sculpt/cli/commands.h"
#include "sculpt/cli/replaying.h"
#include "sculpt/cli/sources.h"
#include "sculpt/cli/words.h"

namespace restroke::cli {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::array<std::string_view, 6> kEndings{".stl", ".ply", ".xyz", ".obj", ".amf", ".3mf"};

points::LengthUnit unitNamed(std::string_view name) {
  if (name == "mm") return points::LengthUnit::Millimetre;
  if (name == "cm") return points::LengthUnit::Centimetre;
  if (name == "m") return points::LengthUnit::Metre;
  throw InputError(fmt::format("--unit: \"{}\" was given, but must be mm, cm or m", name));
}

// All that can be refused before a file is read.
void validate(const ExportOptions& o) {
  const std::string extension = extensionOf(o.out);
  if (std::find(kEndings.begin(), kEndings.end(), extension) == kEndings.end())
    throw InputError(fmt::format("{}: ends in \"{}\", but must end in .stl, .ply, .xyz, .obj, .amf or .3mf",
                                 o.out, extension));
  if (o.ascii && extension != ".stl" && extension != ".ply")
    throw InputError(
        fmt::format("--ascii: {} comes in one form only, but the file must end in .stl or .ply", extension));
  if (o.resolution && o.cell)
    throw InputError("--resolution and --cell say the same thing, but at most one of them must be given");
  if ((o.resolution || o.cell) && extension == ".xyz")
    throw InputError(fmt::format("{}: .xyz holds points, but --resolution and --cell are of meshes", o.out));
  if (o.resolution && (*o.resolution < 1 || *o.resolution > points::kMaxResolution))
    throw InputError(fmt::format("--resolution: {} was given, but must be 1 to {}", *o.resolution,
                                 points::kMaxResolution));
  if (o.cell && (!std::isfinite(*o.cell) || !(*o.cell > 0)))
    throw InputError(fmt::format("--cell: {} was given, but must be finite and more than 0", *o.cell));
  if (!std::isfinite(o.scale) || !(o.scale > 0))
    throw InputError(fmt::format("--scale: {} was given, but must be finite and more than 0", o.scale));
  if (o.unit) (void)unitNamed(*o.unit);
}

void refuseWithMesh(const ExportOptions& o) {
  if (extensionOf(o.out) == ".xyz")
    throw InputError(
        fmt::format("{}: is a mesh, but .xyz holds points with normals, which are made of logs", o.source));
  const char* option = o.resolution ? "--resolution" : o.cell ? "--cell" : o.density ? "--density" : nullptr;
  if (option != nullptr)
    throw InputError(
        fmt::format("{}: is a mesh, whose triangles are kept, but {} is of logs", o.source, option));
}

// A tri-dexel's mesh has the cells of its lines.
void refuseWithTriDexel(const ExportOptions& o) {
  const char* option = o.resolution ? "--resolution" : o.cell ? "--cell" : o.density ? "--density" : nullptr;
  if (option != nullptr)
    throw InputError(fmt::format("{}: is a tri-dexel, whose lines are where they are, but {} is of logs",
                                 o.source, option));
}

// Does every edge have one triangle on each of its sides? O(n log n) whatever the mesh, which faultsOf is
// not.
bool isClosed(const TriangleMesh& mesh) {
  using Edge = std::array<std::uint32_t, 2>;
  std::vector<Edge> edges, reversed;
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      edges.push_back({t[i], t[(i + 1) % 3]});
      reversed.push_back({t[(i + 1) % 3], t[i]});
    }
  std::sort(edges.begin(), edges.end());
  std::sort(reversed.begin(), reversed.end());
  return std::adjacent_find(edges.begin(), edges.end()) == edges.end() && edges == reversed;
}

double areaOf(const TriangleMesh& mesh) {
  double twice = 0;
  for (const auto& t : mesh.triangles) {
    const DVec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
    twice += length(cross(b - a, c - a));
  }
  return twice / 2;
}

// What is made, and what it is to be called.
struct Job {
  const ExportOptions& options;
  std::string unit;
  Output& output;
  Clock::time_point start;

  [[nodiscard]] double seconds() const { return std::chrono::duration<double>(Clock::now() - start).count(); }
};

// Of the isosurface the mesh was taken from what the report needs; none when the mesh came from a file.
void finishMesh(const Job& job, const TriangleMesh& mesh, const points::Isosurface* made) {
  const ExportOptions& o = job.options;
  points::writeMesh(o.out, mesh,
                    {.encoding = o.ascii ? points::MeshEncoding::Ascii : points::MeshEncoding::Binary,
                     .unit = unitNamed(job.unit),
                     .scale = o.scale});
  if (mesh.triangles.empty())
    Output::note(fmt::format("{}: the mesh has no triangles{}", o.source,
                             made != nullptr ? "; the shape is empty, or smaller than a cell" : ""));
  const bool closed = isClosed(mesh);
  const double area = areaOf(mesh) * o.scale * o.scale;
  const double volume = volumeOf(mesh) * o.scale * o.scale * o.scale;
  nlohmann::ordered_json json{
      {"out", o.out}, {"vertices", mesh.vertices.size()}, {"triangles", mesh.triangles.size()}};
  std::string text = fmt::format("{}: {} vertices, {} triangles", o.out, grouped(mesh.vertices.size()),
                                 grouped(mesh.triangles.size()));
  if (made != nullptr) {
    json["cell"] = made->cell;
    json["resolution"] = made->resolution;
    text += fmt::format("; cells of {:.4g} ({:.4g} along the longest side)", made->cell, made->resolution);
  }
  json["closed"] = closed;
  text += fmt::format("; area {:.6g} {}^2, ", area, job.unit);
  if (closed) {
    json["volume"] = volume;
    text += fmt::format("volume {:.6g} {}^3", volume, job.unit);
  } else {
    text += "not closed";
  }
  json["area"] = area;
  if (made != nullptr) {
    json["self_intersections"] = made->selfIntersections;
    if (made->selfIntersections != 0)
      text +=
          fmt::format("; {} pairs of triangles meet where they should not", grouped(made->selfIntersections));
  }
  const double seconds = job.seconds();
  json["seconds"] = seconds;
  job.output.say(fmt::format("{}; {:.3f} s\n", text, seconds));
  job.output.finish(json);
}

void finishPoints(const Job& job, std::vector<points::Surfel> surfels) {
  const ExportOptions& o = job.options;
  if (o.scale != 1)
    for (points::Surfel& surfel : surfels) {
      surfel.position = Point(DVec3(surfel.position) * o.scale);
      surfel.radius = static_cast<float>(static_cast<double>(surfel.radius) * o.scale);
    }
  if (extensionOf(o.out) == ".xyz")
    points::writeXyz(o.out, surfels);
  else
    points::writePly(o.out, surfels,
                     {.format = o.ascii ? points::PlyFormat::Ascii : points::PlyFormat::BinaryLittleEndian,
                      .comments = {"Restroke surfels, unit " + job.unit}});
  const double seconds = job.seconds();
  job.output.say(
      fmt::format("{}: {} points with normals; {:.3f} s\n", o.out, grouped(surfels.size()), seconds));
  job.output.finish({{"out", o.out}, {"surfels", surfels.size()}, {"seconds", seconds}});
}

}  // namespace

int runExport(const ExportOptions& options) {
  const auto start = Clock::now();
  validate(options);
  const SourceKind kind = sourceKindOf(options.source);
  if (kind == SourceKind::TriDexel) {
    refuseWithTriDexel(options);
    const points::TriDexelDocument document = points::readTriDexel(options.source);
    const Execution execution = executionOf(options.common);
    Output output(options.common);
    const Job job{options, options.unit.value_or("mm"), output, start};
    if (extensionOf(options.out) == ".xyz") {
      finishPoints(job, points::surfelsOf(document.model, {.ends = points::DexelEnds::All}, execution));
    } else {
      const points::Isosurface made = points::isosurfaceOf(document.model, execution);
      finishMesh(job, made.mesh, &made);
    }
    return 0;
  }
  if (kind == SourceKind::Mesh) {
    refuseWithMesh(options);
    const TriangleMesh mesh = points::readMesh(options.source);
    Output output(options.common);
    finishMesh({options, options.unit.value_or("mm"), output, start}, mesh, nullptr);
    return 0;
  }
  const Execution execution = executionOf(options.common);
  sculpt::StrokeLog log = readLogNoting(options.source);
  overrideDensity(log, options.density);
  Output output(options.common);
  const sculpt::Document document = replayNoting(log, {.file = options.source}, execution);
  const Job job{options, options.unit.value_or(log.header.unit), output, start};
  const std::string extension = extensionOf(options.out);
  if (extension == ".xyz" || (extension == ".ply" && !options.resolution && !options.cell)) {
    finishPoints(job, document.model().surfels(execution));
    return 0;
  }
  const points::Isosurface made =
      points::isosurfaceOf(points::ListSource(document.model().list()),
                           {.resolution = options.resolution, .cell = options.cell}, execution);
  finishMesh(job, made.mesh, &made);
  return 0;
}

}  // namespace restroke::cli
