// The one file that includes CGAL: its kernels and the package Intersections_3, whose headers are LGPL. P.
// Guigue and O. Devillers, Fast and robust triangle-triangle overlap test using orientation predicates, 2003,
// is the method behind do_intersect.

#include "implicit/geometry/exact_predicates.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Intersections_3/Segment_3_Triangle_3.h>
#include <CGAL/Intersections_3/Triangle_3_Triangle_3.h>

namespace restroke {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// Without rounding: every float is a double.
Kernel::Point_3 exact(Point p) {
  return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
}
Kernel::Point_3 exact(DVec3 p) {
  return {p.x, p.y, p.z};
}
Kernel::Triangle_3 exact(const Triangle& t) {
  return {exact(t[0]), exact(t[1]), exact(t[2])};
}

/// Side of p with respect to the line from a to b, all seen along -x (y to the right, z up): +1 left, -1
/// right. Where p is on the line, the side of p + (e, e^2) for an e > 0 as small as need be; 0 only when a
/// and b are seen in the same place.
int perturbedSideOfLine(Point a, Point b, DVec3 p) {
  const auto seen = [](DVec3 q) { return Kernel::Point_2(q.y, q.z); };
  if (const auto side = CGAL::orientation(seen(DVec3(a)), seen(DVec3(b)), seen(p)); side != CGAL::COLLINEAR)
    return static_cast<int>(side);
  if (a.z != b.z) return a.z > b.z ? 1 : -1;
  return a.y == b.y ? 0 : a.y < b.y ? 1 : -1;
}

}  // namespace

int sideOfPlane(const Triangle& triangle, DVec3 p) {
  return static_cast<int>(
      CGAL::orientation(exact(triangle[0]), exact(triangle[1]), exact(triangle[2]), exact(p)));
}

int sideOfLine(DVec2 a, DVec2 b, DVec2 p) {
  const auto exactly = [](DVec2 q) { return Kernel::Point_2(q.x, q.y); };
  return static_cast<int>(CGAL::orientation(exactly(a), exactly(b), exactly(p)));
}

int crossingOf(const Triangle& t, DVec3 p) {
  // The triangle seen along -x runs counter-clockwise (+1) when its normal points towards +x.
  const int seen = perturbedSideOfLine(t[0], t[1], p);
  if (seen == 0 || perturbedSideOfLine(t[1], t[2], p) != seen || perturbedSideOfLine(t[2], t[0], p) != seen)
    return 0;
  // The ray goes towards +x, so that p must be behind the one, before the other.
  return sideOfPlane(t, p) == -seen ? seen : 0;
}

bool isOn(const Triangle& t, DVec3 p) {
  return sideOfPlane(t, p) == 0 && !areCollinear(t) && exact(t).has_on(exact(p));
}

bool areCollinear(const Triangle& triangle) {
  return CGAL::collinear(exact(triangle[0]), exact(triangle[1]), exact(triangle[2]));
}

bool meet(const Triangle& triangle, const Segment& segment) {
  return CGAL::do_intersect(exact(triangle), Kernel::Segment_3(exact(segment[0]), exact(segment[1])));
}

bool meet(const Triangle& a, const Triangle& b) {
  return CGAL::do_intersect(exact(a), exact(b));
}

bool foldOnto(const Segment& edge, Point a, Point b) {
  const auto p = exact(edge[0]), q = exact(edge[1]), r = exact(a), s = exact(b);
  return CGAL::orientation(p, q, r, s) == CGAL::COPLANAR &&
         CGAL::coplanar_orientation(p, q, r, s) == CGAL::POSITIVE;
}

}  // namespace restroke
