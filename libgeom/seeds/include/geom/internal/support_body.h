#pragma once

/// A body of any SupportShape, without its type: what the adapters, compiled once, take.

#include <geom/pose.h>
#include <geom/shape.h>

#include <Eigen/Core>

namespace geom::internal {

/// Refers to the shape and the pose, which must outlive it.
class SupportBody {
 public:
  template <SupportShape Shape>
  SupportBody(const Shape& shape, const Pose& X_WB)
      : shape_(&shape),
        support_point_(&support_point<Shape>),
        X_WB_(&X_WB),
        inscribed_radius_(shape.inscribed_radius()) {}

  /// The support point along n (body frame, any length but 0), in the body frame.
  Eigen::Vector3d support_B(const Eigen::Vector3d& n) const { return support_point_(shape_, n); }
  /// The same in world axes, from the body's centre.
  Eigen::Vector3d support_W(const Eigen::Vector3d& n) const {
    return X_WB_->rotation() * support_point_(shape_, X_WB_->rotation().transpose() * n);
  }
  const Pose& pose() const { return *X_WB_; }
  double inscribed_radius() const { return inscribed_radius_; }

 private:
  template <class Shape>
  static Eigen::Vector3d support_point(const void* shape, const Eigen::Vector3d& n) {
    return Support(static_cast<const Shape*>(shape)->support(n)).point;
  }

  const void* shape_;
  Eigen::Vector3d (*support_point_)(const void*, const Eigen::Vector3d&);
  const Pose* X_WB_;
  double inscribed_radius_;
};

}  // namespace geom::internal
