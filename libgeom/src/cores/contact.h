#pragma once

/// Closest points of two cores, and what `distance` makes of them.

#include <geom/distance.h>
#include <geom/kernel/core.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace geom::kernel {

/// Closest points of two cores, in the world's directions, relative to A's centre. Two bounds enclose the distance:
/// `lower`, the gap between the tangent planes across n, and the distance of the points.
struct CoreContact {
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  Eigen::Vector3d n = Eigen::Vector3d::UnitX();  ///< unit normal from A to B
  double lower = -std::numeric_limits<double>::infinity();
  int evaluations = 1;
  /// Bound of how much larger the gap of overlapping bodies across another normal is; 0: the depth is exact.
  double depth_error = 0;
};

/// Returns how much larger the distance of the points is than the lower bound; of overlapping bodies, how far the
/// points are from being apart along the normal by it.
inline double bound_of(const CoreContact& c) {
  const Eigen::Vector3d gap = c.b - c.a;
  return c.lower > 0 ? std::max(0.0, gap.norm() - c.lower) : (gap - c.lower * c.n).norm();
}

/// Returns how far the points of a contact are from being apart along the normal by the gap: more than the bounds tell
/// where the bodies are far from each other.
inline double mismatch_of(const CoreContact& c) {
  return (c.b - c.a - c.lower * c.n).norm();
}

/// Returns the contact with A and B exchanged, for r = p_AB of the first order.
inline CoreContact exchanged(const CoreContact& c, const Eigen::Vector3d& r) {
  return {c.b + r, c.a + r, -c.n, c.lower, c.evaluations, c.depth_error};
}

/// Returns the vectors' product with an error of few ulps of each coordinate, also if they are nearly parallel: each
/// difference of products by Kahan's method.
inline Eigen::Vector3d accurate_cross(const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
  const auto difference = [](double a, double b, double c, double d) {
    const double cd = c * d;
    const double error = std::fma(-c, d, cd);
    return std::fma(a, b, -cd) + error;
  };
  return {difference(u.y(), v.z(), u.z(), v.y()), difference(u.z(), v.x(), u.x(), v.z()),
          difference(u.x(), v.y(), u.y(), v.x())};
}

/// Returns a rotation or vector without the components that are nothing beside the largest one. No distance changes by
/// them, but products that they alone make nonzero may underflow and have no direction.
template <class Matrix>
Matrix without_dust(const Matrix& of) {
  constexpr double kDust = 1e-100;
  return (of.array().abs() < kDust * of.cwiseAbs().maxCoeff()).select(0, of);
}

/// Returns a unit vector across a unit vector.
inline Eigen::Vector3d any_across(const Eigen::Vector3d& u) {
  return u.unitOrthogonal();
}

/// Returns the closest points of two points and segments, in closed form. The axes are unit vectors; half-length 0: a
/// point. r = p_AB.
CoreContact segment_contact(const Eigen::Vector3d& axis_a, double half_a, const Eigen::Vector3d& axis_b, double half_b,
                            const Eigen::Vector3d& r);

/// Returns the closest points of a box, as A, and a point at r from its centre.
CoreContact box_point_contact(const Eigen::Matrix3d& axes, const Eigen::Vector3d& half, const Eigen::Vector3d& r);

/// Returns the closest points of any two polytopes that are not both points or segments.
CoreContact polytope_contact(const CoreView& a, const Eigen::Matrix3d& R_WA, const CoreView& b,
                             const Eigen::Matrix3d& R_WB, const Eigen::Vector3d& r, const Eigen::Vector3d& start);

/// Returns the closest points of a frustum, as A, and a point at r from its origin, in closed form.
CoreContact frustum_point_contact(const CoreView& frustum, const Eigen::Matrix3d& R, const Eigen::Vector3d& r);

/// Returns the closest points of two cores of which at least one is a frustum, and none is a point.
CoreContact round_contact(const CoreView& a, const Eigen::Matrix3d& R_WA, const CoreView& b,
                          const Eigen::Matrix3d& R_WB, const Eigen::Vector3d& r, const Eigen::Vector3d& start);

}  // namespace geom::kernel
