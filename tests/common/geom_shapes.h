#pragma once

/// Shapes that a user might bring along: they take the template path of `distance`.

#include <geom/geom.h>

#include <Eigen/Core>

namespace geom_test {

/// The least that `distance` asks for: no `min_curvature_radius`, so that no overlap is certified.
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

/// An ellipsoid of which `distance` does not know that it is one.
struct WrappedEllipsoid {
  geom::Ellipsoid ellipsoid;

  geom::Support support(const Eigen::Vector3d& n) const { return ellipsoid.support(n); }
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const { return ellipsoid.support_hessian(n); }
  double bounding_radius() const { return ellipsoid.bounding_radius(); }
  double inscribed_radius() const { return ellipsoid.inscribed_radius(); }
  double min_curvature_radius() const { return ellipsoid.min_curvature_radius(); }
};

/// All points within `skin` of an ellipsoid: distances to it are those to the ellipsoid less `skin`.
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

}  // namespace geom_test
