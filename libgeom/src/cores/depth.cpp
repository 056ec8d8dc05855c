#include "cores/depth.h"

#include "cores/contact.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace geom::kernel {
namespace {

using Eigen::Vector3d;

/// The search over the faces of the Minkowski difference.
///
/// Any unit n gives a lower bound of the distance, so that further candidates do no harm, and each one that counts is
/// evaluated by the support functions. Pairs of edges whose product is shorter than kParallel are left out: their face
/// is as thin as that, and its neighbours are candidates too.
class GapSearch {
 public:
  GapSearch(const PlacedCore& a, const PlacedCore& b) : a_(a), b_(b) {
    best_.gap = -std::numeric_limits<double>::infinity();
  }

  WidestGap run() {
    faces(a_, 1);
    faces(b_, -1);
    if (a_.hull() == nullptr && b_.hull() == nullptr) {
      for (std::size_t i = 0; i < a_.generators(); ++i) {
        for (std::size_t j = 0; j < b_.generators(); ++j) both_sides(a_.generator(i), b_.generator(j));
      }
    } else if (a_.hull() != nullptr && b_.hull() != nullptr) {
      hull_edges();
    } else if (a_.hull() != nullptr) {
      generator_edges(a_, 1, b_);
    } else {
      generator_edges(b_, -1, a_);
    }
    return best_;
  }

 private:
  static constexpr double kParallel = 1e-14;

  void consider(const Vector3d& n) {
    ++best_.evaluations;
    const double gap = n.dot(difference_vertex(a_, b_, n).p);
    if (gap > best_.gap) {
      best_.gap = gap;
      best_.n = n;
    }
  }

  /// Considers the face normals of one core; `sign` = -1 for B's, which point to A.
  void faces(const PlacedCore& of, double sign) {
    if (of.hull() != nullptr) {
      for (const Vector3d& n : of.hull()->normals) consider(sign * of.turned(n));
    } else if (of.generators() == 3) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Vector3d n = of.generator(k).normalized();
        consider(n);
        consider(-n);
      }
    }
  }

  /// Returns the unit vector across two edges, or zero if they are parallel.
  static Vector3d across(const Vector3d& u, const Vector3d& v) {
    Vector3d c = u.cross(v);
    const double scale2 = u.squaredNorm() * v.squaredNorm();
    if (c.squaredNorm() < 1e-6 * scale2) c = accurate_cross(u, v);
    const double c2 = c.squaredNorm();
    return c2 > kParallel * kParallel * scale2 ? Vector3d(c / std::sqrt(c2)) : Vector3d(Vector3d::Zero());
  }

  void both_sides(const Vector3d& u, const Vector3d& v) {
    const Vector3d n = across(u, v);
    if (n.isZero(0)) return;
    consider(n);
    consider(-n);
  }

  /// Considers pairs of a hull's edges and generators, whose normals lie on a great circle: pairs count where that
  /// crosses the arc between the normals of the edge's faces.
  void generator_edges(const PlacedCore& hull, double sign, const PlacedCore& other) {
    for (const HullEdge& edge : hull.hull()->edges) {
      const Vector3d left = hull.turned(hull.hull()->normals[static_cast<std::size_t>(edge.left)]);
      const Vector3d right = hull.turned(hull.hull()->normals[static_cast<std::size_t>(edge.right)]);
      const Vector3d along = hull.point(edge.to) - hull.point(edge.from);
      for (std::size_t k = 0; k < other.generators(); ++k) {
        const Vector3d g = other.generator(k);
        if (left.dot(g) * right.dot(g) > kSlack * g.squaredNorm()) continue;
        const Vector3d n = across(along, g);
        if (!n.isZero(0)) consider(n.dot(left + right) > 0 ? Vector3d(sign * n) : Vector3d(-sign * n));
      }
    }
  }

  /// Considers pairs of edges of two hulls whose arcs of normals, B's turned round, cross (Gregorius, "The separating
  /// axis test between convex polyhedra", GDC 2013): an arc's plane has the edge as normal.
  void hull_edges() {
    const Hull& hull_a = *a_.hull();
    const Hull& hull_b = *b_.hull();
    for (const HullEdge& edge_a : hull_a.edges) {
      const Vector3d p = a_.point(edge_a.from);
      const Vector3d u = a_.point(edge_a.to) - p;
      const Vector3d left_a = a_.turned(hull_a.normals[static_cast<std::size_t>(edge_a.left)]);
      const Vector3d right_a = a_.turned(hull_a.normals[static_cast<std::size_t>(edge_a.right)]);
      const double u2 = u.squaredNorm();
      for (const HullEdge& edge_b : hull_b.edges) {
        const Vector3d left_b = -b_.turned(hull_b.normals[static_cast<std::size_t>(edge_b.left)]);
        const Vector3d right_b = -b_.turned(hull_b.normals[static_cast<std::size_t>(edge_b.right)]);
        if (left_b.dot(u) * right_b.dot(u) > kSlack * u2) continue;
        const Vector3d q = b_.point(edge_b.from);
        const Vector3d v = b_.point(edge_b.to) - q;
        if (left_a.dot(v) * right_a.dot(v) > kSlack * v.squaredNorm()) continue;
        // Both great circles cross twice; an arc lies within a quarter turn of its middle.
        Vector3d n = across(u, v);
        if (n.dot(left_a + right_a) < 0) n = -n;
        if (n.dot(left_b + right_b) > -kSlack && n.dot(q - p) > best_.gap && !n.isZero(0)) consider(n);
      }
    }
  }

  static constexpr double kSlack = 1e-12;  // rounding of products that decide which arcs cross

  const PlacedCore& a_;
  const PlacedCore& b_;
  WidestGap best_;
};

}  // namespace

WidestGap widest_gap(const PlacedCore& a, const PlacedCore& b) {
  return GapSearch(a, b).run();
}

}  // namespace geom::kernel
