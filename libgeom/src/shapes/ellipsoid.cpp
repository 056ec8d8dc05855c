#include "shapes/format.h"

#include <geom/ellipsoid.h>
#include <geom/kernel/refuse.h>
#include <geom/tolerances.h>

#include <cmath>
#include <numbers>
#include <string>

namespace geom {
namespace {

int find_symmetry_axis(const Eigen::Vector3d& a) {
  if (a.x() == a.y()) return 2;
  if (a.y() == a.z()) return 0;
  if (a.x() == a.z()) return 1;
  return -1;
}

}  // namespace

Ellipsoid::Ellipsoid(const Eigen::Vector3d& semi_axes)
    : semi_axes_(semi_axes),
      bounding_radius_(semi_axes.maxCoeff()),
      inscribed_radius_(semi_axes.minCoeff()),
      min_curvature_radius_(inscribed_radius_ * (inscribed_radius_ / bounding_radius_)),
      symmetry_axis_(find_symmetry_axis(semi_axes)) {
  for (int k = 0; k < 3; ++k) {
    const double a = semi_axes[k];
    if (!(a >= kMinSemiAxis && a <= kMaxSemiAxis)) {
      kernel::refuse(std::string("Ellipsoid: semi-axis ") + "xyz"[k] + " is " + kernel::shown(a) +
                     "; accepted: " + kernel::shown(kMinSemiAxis) + " to " + kernel::shown(kMaxSemiAxis));
    }
  }
  const double ratio = bounding_radius() / inscribed_radius();
  if (!(ratio <= kMaxAspectRatio)) {
    kernel::refuse("Ellipsoid: ratio of the largest to the smallest semi-axis is " + kernel::shown(ratio) +
                   "; accepted: at most " + kernel::shown(kMaxAspectRatio));
  }
}

double Ellipsoid::value(const Eigen::Vector3d& x) const {
  return x.cwiseQuotient(semi_axes_).squaredNorm() - 1;
}

Eigen::Vector3d Ellipsoid::gradient(const Eigen::Vector3d& x) const {
  return 2 * x.cwiseQuotient(semi_axes_.cwiseAbs2());
}

Eigen::Matrix3d Ellipsoid::hessian(const Eigen::Vector3d& /*x*/) const {
  return (2 * semi_axes_.cwiseAbs2().cwiseInverse()).asDiagonal();
}

Support Ellipsoid::support(const Eigen::Vector3d& n) const {
  const double h = semi_axes_.cwiseProduct(n).norm();
  return {h, semi_axes_.cwiseAbs2().cwiseProduct(n) / h};
}

Eigen::Matrix3d Ellipsoid::support_hessian(const Eigen::Vector3d& n) const {
  const Support s = support(n);
  Eigen::Matrix3d H = -s.point * s.point.transpose();
  H.diagonal() += semi_axes_.cwiseAbs2();
  return H / s.height;
}

double Ellipsoid::volume() const {
  return 4.0 / 3.0 * std::numbers::pi * semi_axes_.prod();
}

Eigen::Vector3d Ellipsoid::inertia(double mass) const {
  const Eigen::Vector3d a2 = semi_axes_.cwiseAbs2();
  return mass / 5 * (Eigen::Vector3d::Constant(a2.sum()) - a2);
}

std::string Ellipsoid::description() const {
  return "ellipsoid " + kernel::of_semi_axes(semi_axes_);
}

}  // namespace geom
