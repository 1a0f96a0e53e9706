#pragma once
// Questions about meshes, answered without rounding; coordinates are taken as they are, float32 or double.
// The arithmetic is CGAL's filtered kernel (LGPL): doubles where they are sure, exact numbers where not.

#include <array>
#include <glm/vec2.hpp>

#include "implicit/geometry/vec.h"

namespace restroke {

/// Corners of a triangle, or ends of a segment, in model units.
using Triangle = std::array<Point, 3>;
using Segment = std::array<Point, 2>;
/// A point of a plane.
using DVec2 = glm::dvec2;

/// Side of `p` with respect to the plane of a triangle: +1 where the normal (b - a) x (c - a) points to, -1
/// behind it, 0 in the plane, and 0 everywhere when the triangle is degenerate. All coordinates must be
/// finite. Exact.
[[nodiscard]] int sideOfPlane(const Triangle& triangle, DVec3 p);

/// Side of `p` with respect to the line from `a` to `b` in the plane: +1 left, -1 right, 0 on it, and 0
/// everywhere when a and b are equal. All coordinates must be finite. Exact.
[[nodiscard]] int sideOfLine(DVec2 a, DVec2 b, DVec2 p);

/// How the ray from `p` towards +x passes through a triangle: +1 from behind to before it, -1 the other way,
/// 0 when it does not. A ray through an edge or a vertex is decided as if `p` were moved by a distance
/// smaller than any number in y, and by one smaller still in z, so that it passes through exactly one of the
/// triangles that share the edge: the sum over a closed mesh is its winding number at `p`, wherever p is off
/// the surface. A triangle that contains `p`, and a degenerate one, give 0. Exact.
[[nodiscard]] int crossingOf(const Triangle& triangle, DVec3 p);

/// Is the point in the triangle, its edges and corners included? Degenerate triangles have no points. Exact.
[[nodiscard]] bool isOn(const Triangle& triangle, DVec3 p);

/// Are three points on one line (two of them equal included)? Exact.
[[nodiscard]] bool areCollinear(const Triangle& triangle);

/// Do a triangle and a segment have a point in common, boundaries included? Neither may be degenerate. Exact.
[[nodiscard]] bool meet(const Triangle& triangle, const Segment& segment);

/// Do two triangles have a point in common, boundaries included? Neither may be degenerate. Exact.
[[nodiscard]] bool meet(const Triangle& a, const Triangle& b);

/// Do the triangles (edge, a) and (edge, b) lie in one plane, on the same side of their common edge? Neither
/// may be degenerate. Exact.
[[nodiscard]] bool foldOnto(const Segment& edge, Point a, Point b);

}  // namespace restroke
