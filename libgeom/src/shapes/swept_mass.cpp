#include "shapes/hull.h"
#include "shapes/swept_frustum.h"

#include <geom/kernel/core.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace geom::kernel {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using std::numbers::pi;

/// Returns a b^T + b a^T.
Matrix3d symmetric_product(const Vector3d& a, const Vector3d& b) {
  const Matrix3d ab = a * b.transpose();
  return ab + ab.transpose();
}

void add(SweptMass& sum, double volume, const Vector3d& first, const Matrix3d& second) {
  sum.volume += volume;
  sum.first_moment += first;
  sum.second_moment += second;
}

SweptMass ball(double r) {
  const double volume = 4.0 / 3.0 * pi * r * r * r;
  return {volume, Vector3d::Zero(), volume * r * r / 5 * Matrix3d::Identity()};
}

/// Returns the moments of a capsule: its cylinder, and two halves of a ball.
SweptMass swept_segment(double l, double r) {
  SweptMass m = ball(r);
  const double tube = pi * r * r * 2 * l;
  const double shift = l * l * m.volume + l * pi * r * r * r * r;  // of the halves: l^2 V + 2 l int |z|
  const Vector3d of_tube(r * r / 4, r * r / 4, l * l / 3);
  m.second_moment.diagonal() += tube * of_tube;
  m.second_moment(2, 2) += shift;
  m.volume += tube;
  return m;
}

/// Returns the integral of x^2 over the rounded box with half extents a along x, b and c across.
double box_moment(double a, double b, double c, double r) {
  const double disc = pi * r * r;
  const double outer = a + r;
  double sum = 8 * b * c * outer * outer * outer / 3;  // box with the slabs on its ends
  sum += 8 * a * a * a * (b + c) * r / 3;              // slabs on its sides
  sum += disc * 2 * a * a * a / 3;                     // edges along x
  const double half_discs = disc * a * a + a * 8 * r * r * r / 3 + disc * r * r / 4;
  sum += 2 * (b + c) * half_discs;                             // edges across x: int (a + |x|)^2 over a disc
  sum += disc * r * (4 * a * a / 3 + a * r + 4 * r * r / 15);  // corners: that over a ball
  return sum;
}

SweptMass swept_box(const Vector3d& half, double r) {
  const auto [a, b, c] = std::array{half.x(), half.y(), half.z()};
  SweptMass m;
  m.volume = 8 * (a * b * c + r * (a * b + b * c + c * a)) + pi * r * r * (2 * (a + b + c) + 4.0 / 3.0 * r);
  m.second_moment.diagonal() << box_moment(a, b, c, r), box_moment(b, c, a, r), box_moment(c, a, b, r);
  return m;
}

/// Sum of a polyhedron and the parts that a ball swept over it adds: prisms on the faces, sectors of cylinders along
/// the edges, sectors of balls at the vertices.
class SweptHull {
 public:
  SweptHull(const Hull& hull, double r) : hull_(hull), r_(r) {
    const HullMoments m = moments(hull);
    mass_ = {m.volume, m.volume * m.centre, m.volume * m.second_moment};
  }

  SweptMass sum() {
    if (r_ == 0) return mass_;
    const auto vertices = static_cast<std::size_t>(hull_.vertices.rows());
    angles_.assign(vertices, 0);
    arcs_.assign(vertices, Vector3d::Zero());
    products_.assign(vertices, Matrix3d::Zero());
    for (std::size_t f = 0; f < hull_.faces.size(); ++f) add_face(hull_.faces[f], hull_.normals[f]);
    for (const HullEdge& edge : hull_.edges) add_edge(edge);
    for (std::size_t k = 0; k < vertices; ++k) add_vertex(k);
    return mass_;
  }

 private:
  Vector3d vertex(int k) const { return hull_.vertices.row(k).transpose(); }

  void add_face(const std::vector<int>& outline, const Vector3d& n) {
    const Vector3d a = vertex(outline[0]);
    for (std::size_t i = 1; i + 1 < outline.size(); ++i) {
      const Vector3d b = vertex(outline[i]);
      const Vector3d c = vertex(outline[i + 1]);
      const double area = 0.5 * n.dot((b - a).cross(c - a));
      const Vector3d sum = a + b + c;
      const Matrix3d squares = sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose();
      const Vector3d middle = sum / 3;
      add(mass_, area * r_, area * r_ * (middle + 0.5 * r_ * n),
          area * r_ * (squares / 12 + 0.5 * r_ * symmetric_product(middle, n) + r_ * r_ / 3 * n * n.transpose()));
    }
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Vector3d p = vertex(outline[i]);
      const Vector3d u = vertex(outline[(i + 1) % outline.size()]) - p;
      const Vector3d v = vertex(outline[(i + outline.size() - 1) % outline.size()]) - p;
      angles_[static_cast<std::size_t>(outline[i])] += std::atan2(u.cross(v).norm(), u.dot(v));
    }
  }

  /// Adds the sector between the normals of the edge's faces. Their arc is part of the outline of the vertices' normal
  /// cones, too.
  void add_edge(const HullEdge& edge) {
    const Vector3d p = vertex(edge.from);
    const Vector3d q = vertex(edge.to);
    const double length = (q - p).norm();
    const Vector3d e = (q - p) / length;
    const Vector3d& m = hull_.normals[static_cast<std::size_t>(edge.left)];
    const Vector3d& n = hull_.normals[static_cast<std::size_t>(edge.right)];
    const double angle = std::atan2(m.cross(n).norm(), m.dot(n));
    const Vector3d middle = (m + n).normalized();
    const Vector3d across = e.cross(middle);
    const Vector3d arc = 2 * std::sin(0.5 * angle) * middle;  // integral of the unit vectors of the arc
    const Matrix3d squares = 0.5 * (angle + std::sin(angle)) * middle * middle.transpose() +
                             0.5 * (angle - std::sin(angle)) * across * across.transpose();
    const double area = 0.5 * angle * r_ * r_;
    const Vector3d first = r_ * r_ * r_ / 3 * arc;
    const Vector3d centre = 0.5 * (p + q);
    const Matrix3d of_edge = (p * p.transpose() + q * q.transpose() + 0.5 * symmetric_product(p, q)) / 3;
    add(mass_, area * length, length * (area * centre + first),
        length * (area * of_edge + symmetric_product(centre, first) + r_ * r_ * r_ * r_ / 4 * squares));
    add_arc(edge.from, angle, arc, e);
    add_arc(edge.to, angle, arc, -e);
  }

  void add_arc(int k, double angle, const Vector3d& arc, const Vector3d& outward) {
    arcs_[static_cast<std::size_t>(k)] -= 0.5 * angle * outward;
    products_[static_cast<std::size_t>(k)] += symmetric_product(outward, arc);
  }

  /// Adds the sector of the vertex's normal cone, a polygon P on the unit sphere.
  ///
  /// Its solid angle is 2 pi less the angles of the faces (Descartes). The integral of u over P is minus half the sum
  /// of the arcs' angles times their outward conormals. u.A u with trace A = 0 is a spherical harmonic of degree 2,
  /// minus a sixth of its own Laplacian: its integral is that of minus a third of nu.A u over the arcs, nu constant
  /// along each.
  void add_vertex(std::size_t k) {
    const Vector3d p = vertex(static_cast<int>(k));
    const double solid = 2 * pi - angles_[k];
    const double volume = r_ * r_ * r_ / 3 * solid;
    const Vector3d first = r_ * r_ * r_ * r_ / 4 * arcs_[k];
    const Matrix3d second = r_ * r_ * r_ * r_ * r_ / 5 * (solid / 3 * Matrix3d::Identity() - products_[k] / 6);
    add(mass_, volume, volume * p + first, volume * p * p.transpose() + symmetric_product(p, first) + second);
  }

  const Hull& hull_;
  double r_;
  SweptMass mass_;
  std::vector<double> angles_;      // sum of the angles of the faces at each vertex
  std::vector<Vector3d> arcs_;      // integral of u over each normal cone
  std::vector<Matrix3d> products_;  // sum of nu U^T + U nu^T, U the integral of u over an arc
};

}  // namespace

SweptMass swept_mass(const CoreView& core) {
  switch (core.kind) {
    case CoreKind::point:
      break;
    case CoreKind::segment:
      return swept_segment(core.half.z(), core.radius);
    case CoreKind::box:
      return swept_box(core.half, core.radius);
    case CoreKind::hull:
      return SweptHull(*core.hull, core.radius).sum();
    case CoreKind::frustum:
      return swept_frustum(core);
  }
  return ball(core.radius);
}

bool SweptMass::is_principal(double length) const {
  constexpr double kOff = 1e-9;
  const Matrix3d second = second_moment / volume;
  const double products = std::max({std::abs(second(0, 1)), std::abs(second(0, 2)), std::abs(second(1, 2))});
  return centre().norm() <= kOff * length && products <= kOff * length * length;
}

}  // namespace geom::kernel
