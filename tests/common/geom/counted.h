#pragma once

/// Shapes given by support function alone, with kinks, and a body that counts the calls of its support function.

#include "common/geom/random.h"
#include "common/geom/shapes.h"

#include <geom/geom.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>

namespace geom_test {

/// Box: support points jump from corner to corner.
struct PlainBox {
  Eigen::Vector3d half;

  geom::Support support(const Eigen::Vector3d& n) const {
    const Eigen::Vector3d corner(std::copysign(half.x(), n.x()), std::copysign(half.y(), n.y()),
                                 std::copysign(half.z(), n.z()));
    return {n.dot(corner), corner};
  }
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& /*n*/) const { return Eigen::Matrix3d::Zero(); }
  double bounding_radius() const { return half.norm(); }
  double inscribed_radius() const { return half.minCoeff(); }
};

/// Hull of two discs across z, of any radii >= 0: a cylinder, or a cone with the origin at mid-height.
struct PlainFrustum {
  double half_length;
  double low, high;  ///< radii of the discs at -half_length and half_length

  geom::Support support(const Eigen::Vector3d& n) const {
    const double across = std::hypot(n.x(), n.y());
    const double up = half_length * n.z() + high * across;
    const double down = -half_length * n.z() + low * across;
    const double radius = up >= down ? high : low;
    const double outwards = across > 0 ? radius / across : 0;
    return {std::max(up, down), {outwards * n.x(), outwards * n.y(), up >= down ? half_length : -half_length}};
  }
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const {
    const double across = std::hypot(n.x(), n.y());
    const double radius = half_length * n.z() + high * across >= low * across - half_length * n.z() ? high : low;
    if (!(across > 0)) return Eigen::Matrix3d::Zero();
    const Eigen::Vector3d along_rim = Eigen::Vector3d(-n.y(), n.x(), 0) / across;
    return radius / across * (along_rim * along_rim.transpose());
  }
  double bounding_radius() const { return std::hypot(half_length, std::max(low, high)); }
  double inscribed_radius() const {
    const double slant = std::hypot(2 * half_length, low - high);
    return std::min(half_length, half_length * (low + high) / slant);
  }
};

/// Set of all points within `skin` of a body.
template <class Shape>
struct PlainRounded {
  Shape inner;
  double skin;

  geom::Support support(const Eigen::Vector3d& n) const {
    const geom::Support s = inner.support(n);
    return {s.height + skin * n.norm(), s.point + skin * n.normalized()};
  }
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const {
    return inner.support_hessian(n) + PlainBall{skin}.support_hessian(n);
  }
  double bounding_radius() const { return inner.bounding_radius() + skin; }
  double inscribed_radius() const { return inner.inscribed_radius() + skin; }
  double min_curvature_radius() const { return skin; }
};

/// User's shape of any type, which counts the calls of its support function.
class CountedBody {
 public:
  template <geom::SupportShape Shape>
  explicit CountedBody(const Shape& shape)
      : support_([shape](const Eigen::Vector3d& n) { return shape.support(n); }),
        hessian_([shape](const Eigen::Vector3d& n) { return Eigen::Matrix3d(shape.support_hessian(n)); }),
        bounding_radius_(shape.bounding_radius()),
        inscribed_radius_(shape.inscribed_radius()),
        min_curvature_radius_(geom::kernel::min_curvature_radius_or_zero(shape)) {}

  geom::Support support(const Eigen::Vector3d& n) const {
    ++*calls_;
    return support_(n);
  }
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const { return hessian_(n); }
  double bounding_radius() const { return bounding_radius_; }
  double inscribed_radius() const { return inscribed_radius_; }
  double min_curvature_radius() const { return min_curvature_radius_; }

  /// Returns the number of calls since the last one of this function, those of copies included.
  long take_calls() const { return std::exchange(*calls_, 0); }

 private:
  std::function<geom::Support(const Eigen::Vector3d&)> support_;
  std::function<Eigen::Matrix3d(const Eigen::Vector3d&)> hessian_;
  double bounding_radius_;
  double inscribed_radius_;
  double min_curvature_radius_;
  std::shared_ptr<long> calls_ = std::make_shared<long>(0);
};

/// Poses of a pair of bodies.
struct PairOfPoses {
  geom::Pose X_WA, X_WB;
};

/// Returns poses of bodies that are `gap` apart, in random orientations, or in the same one: bodies apart are moved
/// along the normal of their distance.
template <geom::SupportShape ShapeA, geom::SupportShape ShapeB>
PairOfPoses poses_apart(const ShapeA& a, const ShapeB& b, double gap, bool parallel, Random& random) {
  const double radii = a.bounding_radius() + b.bounding_radius();
  while (true) {
    const geom::Pose X_WA = random.pose(0.0);
    const geom::Pose X_turned = random.pose(0.0);
    const Eigen::Matrix3d R = parallel ? X_WA.rotation() : X_turned.rotation();
    const Eigen::Vector3d p_WB = 1.01 * radii * random.direction();
    const geom::DistanceResult d = geom::distance(a, X_WA, b, geom::Pose(R, p_WB));
    if (d.distance > 0) return {X_WA, geom::Pose(R, p_WB + (gap - d.distance) * d.normal)};
  }
}

}  // namespace geom_test
