#pragma once

/// Common parts of the adapters: bodies of any SupportShape without their type, for code that is compiled once, and the
/// final check of a seed.

#include <geom/ellipsoid.h>
#include <geom/newton.h>
#include <geom/pose.h>
#include <geom/shape.h>

#include <Eigen/Core>

#include <type_traits>

namespace geom::kernel {

/// Type-erased reference to a shape and its pose, which must outlive it.
class SupportBody {
 public:
  template <SupportShape Shape>
  SupportBody(const Shape& shape, const Pose& X_WB)
      : shape_(&shape),
        support_point_(&support_point<Shape>),
        X_WB_(&X_WB),
        inscribed_radius_(shape.inscribed_radius()),
        bounding_radius_(shape.bounding_radius()) {
    if constexpr (std::is_same_v<Shape, Ellipsoid>) ellipsoid_ = &shape;
  }

  /// Returns the support point along n (body frame, any length except 0), in the body frame.
  Eigen::Vector3d support_B(const Eigen::Vector3d& n) const { return support_point_(shape_, n); }
  /// Returns the support point along n (world frame), in world axes from the body's centre.
  Eigen::Vector3d support_W(const Eigen::Vector3d& n) const {
    return X_WB_->rotation() * support_point_(shape_, X_WB_->rotation().transpose() * n);
  }
  const Pose& pose() const { return *X_WB_; }
  double inscribed_radius() const { return inscribed_radius_; }
  double bounding_radius() const { return bounding_radius_; }
  /// Returns the shape if it is an Ellipsoid, else nullptr.
  const Ellipsoid* ellipsoid() const { return ellipsoid_; }

 private:
  template <class Shape>
  static Eigen::Vector3d support_point(const void* shape, const Eigen::Vector3d& n) {
    return Support(static_cast<const Shape*>(shape)->support(n)).point;
  }

  const void* shape_;
  Eigen::Vector3d (*support_point_)(const void*, const Eigen::Vector3d&);
  const Pose* X_WB_;
  double inscribed_radius_;
  double bounding_radius_;
  const Ellipsoid* ellipsoid_ = nullptr;
};

/// Overload for a shape without an equation: returns whether the point is finite.
template <class Shape>
bool is_seed_point(const Shape& /*shape*/, const Pose& /*X_WB*/, const Eigen::Vector3d& p_W) {
  return p_W.allFinite();
}

/// Returns the seed, or a declined one if check_seed would not accept a point of a usable seed.
template <class ShapeA, class ShapeB>
WitnessPair checked(const ShapeA& a, const Pose& X_WA, const ShapeB& b, const Pose& X_WB, const WitnessPair& seed) {
  const bool good = is_seed_point(a, X_WA, seed.point_a) && is_seed_point(b, X_WB, seed.point_b);
  return seed.status == SeedStatus::usable && !good ? WitnessPair{} : seed;
}

}  // namespace geom::kernel
