#pragma once

/// Shapes as a user might define them: they take the template path of `distance`.

#include <geom/geom.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace geom_test {

/// Minimal shape for `distance`: no `min_curvature_radius`, so that no overlap is certified.
struct PlainBall {
  double radius;

  geom::Support support(const Eigen::Vector3d& n) const { return {radius * n.norm(), radius * n.normalized()}; }
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const {
    const Eigen::Vector3d unit = n.normalized();
    return radius / n.norm() * (Eigen::Matrix3d::Identity() - unit * unit.transpose());
  }
  double bounding_radius() const { return radius; }
  double inscribed_radius() const { return radius; }
};

/// Polytope that tells its support function and radii only: support points jump from vertex to vertex.
template <class Polytope>
struct PlainPolytope {
  Polytope polytope;

  geom::Support support(const Eigen::Vector3d& n) const { return polytope.support(n); }
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& /*n*/) const { return Eigen::Matrix3d::Zero(); }
  double bounding_radius() const { return polytope.bounding_radius(); }
  double inscribed_radius() const { return polytope.inscribed_radius(); }
};

/// Ellipsoid that `distance` cannot recognise as one.
struct WrappedEllipsoid {
  geom::Ellipsoid ellipsoid;

  geom::Support support(const Eigen::Vector3d& n) const { return ellipsoid.support(n); }
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const { return ellipsoid.support_hessian(n); }
  double bounding_radius() const { return ellipsoid.bounding_radius(); }
  double inscribed_radius() const { return ellipsoid.inscribed_radius(); }
  double min_curvature_radius() const { return ellipsoid.min_curvature_radius(); }
};

/// Set of all points within `skin` of an ellipsoid: distances to it are those to the ellipsoid minus `skin`.
struct SweptEllipsoid {
  geom::Ellipsoid core;
  double skin;

  geom::Support support(const Eigen::Vector3d& n) const {
    const geom::Support s = core.support(n);
    return {s.height + skin * n.norm(), s.point + skin * n.normalized()};
  }
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const {
    return core.support_hessian(n) + PlainBall{skin}.support_hessian(n);
  }
  double bounding_radius() const { return core.bounding_radius() + skin; }
  double inscribed_radius() const { return core.inscribed_radius() + skin; }
  double min_curvature_radius() const { return core.min_curvature_radius() + skin; }
};

/// Set of all points within `radius` of the segment from -half_length to half_length along z: a cylinder with round
/// ends, whose support function has a kink where n is across z.
struct Spherocylinder {
  double half_length;
  double radius;

  geom::Support support(const Eigen::Vector3d& n) const {
    const Eigen::Vector3d end(0, 0, std::copysign(half_length, n.z()));
    return {half_length * std::abs(n.z()) + radius * n.norm(), end + radius * n.normalized()};
  }
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const { return PlainBall{radius}.support_hessian(n); }
  double bounding_radius() const { return half_length + radius; }
  double inscribed_radius() const { return radius; }
  double min_curvature_radius() const { return radius; }
};

/// Convex hull of two balls: not centrally symmetric. large - small <= 2 half_length.
struct Pear {
  double half_length;  ///< distance of their centres from the origin, the large one's at +z
  double large;
  double small;

  geom::Support support(const Eigen::Vector3d& n) const {
    const double up = half_length * n.z() + large * n.norm();
    const double down = -half_length * n.z() + small * n.norm();
    const double sign = up >= down ? 1 : -1;
    return {std::max(up, down),
            Eigen::Vector3d(0, 0, sign * half_length) + (sign > 0 ? large : small) * n.normalized()};
  }
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const {
    const double up = 2 * half_length * n.z() + (large - small) * n.norm();
    return PlainBall{up >= 0 ? large : small}.support_hessian(n);
  }
  double bounding_radius() const { return half_length + large; }
  /// Returns the radius in the direction in which both balls reach equally far.
  double inscribed_radius() const { return 0.5 * (large + small); }
  double min_curvature_radius() const { return small; }
};

/// Body |x/a|^n + |y/b|^m + |z/c|^p <= 1, all powers > 1: its support function has no closed form, but follows from one
/// unknown, mu with grad f(s) = n / mu.
class Superquadric {
 public:
  Superquadric(const Eigen::Vector3d& semi_axes, const Eigen::Vector3d& powers) : a_(semi_axes), p_(powers) {}

  double value(const Eigen::Vector3d& x) const {
    return x.cwiseQuotient(a_).cwiseAbs().array().pow(p_.array()).sum() - 1;
  }
  Eigen::Vector3d gradient(const Eigen::Vector3d& x) const {
    const Eigen::Array3d w = x.cwiseQuotient(a_).cwiseAbs();
    return p_.array() / a_.array() * w.pow(p_.array() - 1) * x.array().sign();
  }
  Eigen::Matrix3d hessian(const Eigen::Vector3d& x) const { return curvatures(x).asDiagonal(); }

  geom::Support support(const Eigen::Vector3d& n) const {
    const Eigen::Vector3d s = at(multiplier(n), n);
    return {n.dot(s), s};
  }
  /// Returns the Hessian, from grad f(s) = n / mu and f(s) = 0: H = mu^-1 (F^-1 - F^-1 g g^T F^-1 / (g^T F^-1 g)) with
  /// F = hess f(s), g = grad f(s), and lengths in n.
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const {
    const double mu = multiplier(n);
    const Eigen::Vector3d s = at(mu, n);
    const Eigen::Vector3d inverse = curvatures(s).cwiseMax(1e-30).cwiseInverse();
    const Eigen::Vector3d k = inverse.cwiseProduct(gradient(s));
    const Eigen::Matrix3d H = inverse.asDiagonal();
    return (H - k * k.transpose() / k.dot(gradient(s))) / mu;
  }
  double bounding_radius() const { return a_.norm(); }
  double inscribed_radius() const { return 1 / a_.cwiseInverse().norm(); }  // that of the inscribed octahedron

 private:
  Eigen::Vector3d curvatures(const Eigen::Vector3d& x) const {
    const Eigen::Array3d w = x.cwiseQuotient(a_).cwiseAbs();
    return p_.array() * (p_.array() - 1) / a_.array().square() * w.pow(p_.array() - 2);
  }
  /// Returns the point where grad f = n / mu.
  Eigen::Vector3d at(double mu, const Eigen::Vector3d& n) const {
    const Eigen::Array3d w = (a_.array() * n.array().abs() / (mu * p_.array())).pow(1 / (p_.array() - 1));
    return a_.array() * w * n.array().sign();
  }
  /// Returns mu by bisection on its logarithm: f(at(mu)) falls as mu grows.
  double multiplier(const Eigen::Vector3d& n) const {
    double low = -60;
    double high = 60;
    for (int k = 0; k < 100; ++k) {
      const double middle = 0.5 * (low + high);
      (value(at(std::exp(middle), n)) > 0 ? low : high) = middle;
    }
    return std::exp(0.5 * (low + high));
  }

  Eigen::Vector3d a_;
  Eigen::Vector3d p_;
};

}  // namespace geom_test
