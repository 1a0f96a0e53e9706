#include "experiments/retarget/fine_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "implicit/errors.h"
#include "implicit/volume.h"

namespace restroke::experiments {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
using Edge = std::pair<std::uint32_t, std::uint32_t>;

Edge edgeOf(std::uint32_t a, std::uint32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

DVec3 middle(const TriangleMesh& mesh, Edge e) {
  return 0.5 * (DVec3(mesh.vertices[e.first]) + DVec3(mesh.vertices[e.second]));
}

double lengthOf(const TriangleMesh& mesh, Edge e) {
  return length(DVec3(mesh.vertices[e.first]) - DVec3(mesh.vertices[e.second]));
}

std::vector<Edge> edgesOf(const TriangleMesh& mesh) {
  std::vector<Edge> edges;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.push_back(edgeOf(t[k], t[(k + 1) % 3]));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

/// Cuts every triangle at those of its edges that have a vertex in their middle: the two triangles of an edge
/// agree, so the mesh stays closed.
std::vector<Triangle> cut(const std::vector<Triangle>& triangles,
                          const std::map<Edge, std::uint32_t>& middles) {
  std::vector<Triangle> out;
  for (Triangle t : triangles) {
    const auto vertexIn = [&](std::size_t k) {
      const auto it = middles.find(edgeOf(t[k], t[(k + 1) % 3]));
      return it == middles.end() ? -1 : static_cast<std::int64_t>(it->second);
    };
    // Turned so that the first edge is cut, and with two cuts the third is not.
    for (int turn = 0; turn < 3 && !(vertexIn(0) >= 0 && (vertexIn(2) < 0 || vertexIn(1) >= 0)); ++turn)
      t = {t[1], t[2], t[0]};
    const auto at = [&](std::size_t k) { return static_cast<std::uint32_t>(vertexIn(k)); };
    if (vertexIn(0) < 0) {
      out.push_back(t);
    } else if (vertexIn(1) < 0) {
      out.insert(out.end(), {Triangle{t[0], at(0), t[2]}, {at(0), t[1], t[2]}});
    } else if (vertexIn(2) < 0) {
      out.insert(out.end(), {Triangle{at(0), t[1], at(1)}, {t[0], at(0), at(1)}, {t[0], at(1), t[2]}});
    } else {
      out.insert(
          out.end(),
          {Triangle{t[0], at(0), at(2)}, {at(0), t[1], at(1)}, {at(2), at(1), t[2]}, {at(0), at(1), at(2)}});
    }
  }
  return out;
}

void refine(SurfaceMesh& surface, const FineMeshOptions& options) {
  TriangleMesh& mesh = surface.mesh;
  for (;;) {
    std::vector<std::pair<double, Edge>> longEdges;
    for (const Edge& e : edgesOf(mesh))
      if (const double l = lengthOf(mesh, e); l > options.edge) longEdges.emplace_back(-l, e);
    // Each cut edge makes two triangles more.
    const std::size_t room = options.mostTriangles > mesh.triangles.size()
                                 ? (options.mostTriangles - mesh.triangles.size()) / 2
                                 : 0;
    std::sort(longEdges.begin(), longEdges.end());
    if (longEdges.size() > room) longEdges.resize(room);
    if (longEdges.empty()) return;
    std::map<Edge, std::uint32_t> middles;
    for (const auto& [minusLength, e] : longEdges) {
      middles[e] = static_cast<std::uint32_t>(mesh.vertices.size());
      mesh.vertices.push_back(Point(surface.toSurface(middle(mesh, e))));
    }
    mesh.triangles = cut(mesh.triangles, middles);
  }
}

/// The surface of a cube around the shape's centre as a grid, projected from the centre. A cube's corners
/// stand where boxes and superellipsoids have theirs.
SurfaceMesh starMesh(const implicit::Shape& shape, double edge) {
  const DVec3 center(shape.ball().center);
  const Box box = implicit::boundsOf(shape);
  const DVec3 half = 0.5 * (DVec3(box.max) - DVec3(box.min));
  SurfaceMesh surface;
  surface.toSurface = [shape, center](DVec3 p) {
    std::vector<RayInterval> inside;
    implicit::intersect(shape, {.origin = center, .direction = p - center}, inside);
    for (const RayInterval& i : inside)
      if (i.enter <= 0 && i.exit > 0) return center + i.exit * (p - center);
    throw InternalError("fineMeshOf: the shape is not star-shaped about its centre");
  };
  const double side = 2 * std::max({half.x, half.y, half.z});
  const int n = std::clamp(static_cast<int>(std::ceil(side / edge)), 2, 64);
  std::map<std::array<int, 3>, std::uint32_t> numbers;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [it, isNew] =
        numbers.try_emplace(at, static_cast<std::uint32_t>(surface.mesh.vertices.size()));
    if (isNew) {
      const DVec3 cube(2.0 * at[0] / n - 1, 2.0 * at[1] / n - 1, 2.0 * at[2] / n - 1);
      surface.mesh.vertices.push_back(Point(surface.toSurface(center + half * cube)));
    }
    return it->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int end : {0, n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int a, int b) {
            std::array<int, 3> at{};
            at[axis] = end;
            at[(axis + 1) % 3] = i + a;
            at[(axis + 2) % 3] = j + b;
            return vertex(at);
          };
          const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (end == n)
            surface.mesh.triangles.insert(surface.mesh.triangles.end(), {Triangle{a, b, c}, {a, c, d}});
          else
            surface.mesh.triangles.insert(surface.mesh.triangles.end(), {Triangle{a, c, b}, {a, d, c}});
        }
  return surface;
}

}  // namespace

SurfaceMesh fineMeshOf(const implicit::Shape& shape, const FineMeshOptions& options) {
  const implicit::PosedVolume* volume = shape.volume();
  if (volume == nullptr || !volume->volume().parameters().mesh) {
    SurfaceMesh surface = starMesh(shape, 1.5 * options.edge);
    refine(surface, options);
    return surface;
  }
  SurfaceMesh surface{volume->volume().parameters().mesh->mesh, [](DVec3 p) { return p; }};
  if (!(volume->pose() == implicit::Pose{}))
    for (Point& v : surface.mesh.vertices) v = Point(volume->toModel(DVec3(v)));
  refine(surface, options);
  return surface;
}

MappedMesh mapped(const SurfaceMesh& surface, const SpaceMap& map) {
  MappedMesh image{surface.mesh, 0};
  for (Point& v : image.mesh.vertices) v = Point(map.point(DVec3(v)));
  for (const Edge& e : edgesOf(surface.mesh))
    image.chordError =
        std::max(image.chordError,
                 length(map.point(surface.toSurface(middle(surface.mesh, e))) - middle(image.mesh, e)));
  image.chordError *= 4.0 / 3.0;
  return image;
}

implicit::Shape shapeOf(TriangleMesh mesh) {
  const implicit::VolumeKind& kind = implicit::volumeKindNamed("mesh");
  auto source = std::make_shared<implicit::MeshSource>();
  source->mesh = std::move(mesh);
  return std::make_shared<const implicit::PosedVolume>(kind.make({{{}}, std::move(source)}),
                                                       implicit::Pose{});
}

}  // namespace restroke::experiments
