#pragma once

/// @file
/// Shapes made of other shapes: at a pose in the body's frame, or of any type.

#include <geom/export.h>
#include <geom/half_space.h>
#include <geom/kernel/core.h>
#include <geom/obb.h>
#include <geom/pose.h>
#include <geom/queries.h>
#include <geom/rounded.h>
#include <geom/shape.h>

#include <Eigen/Core>

#include <algorithm>
#include <concepts>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>

namespace geom {

/// Shape at a pose in its body's frame, as the `<origin>` of a link in URDF. The body's origin need not be inside.
/// Queries are those of the shape inside at the product of both poses, with its methods and accuracy.
template <SupportShape Inner>
class Placed {
 public:
  /// Constructs the body from a shape I and its pose in the body's frame B.
  Placed(Inner inner, const Pose& X_BI) : inner_(std::move(inner)), X_BI_(X_BI) {}

  const Inner& inner() const { return inner_; }  ///< shape that is placed
  const Pose& pose() const { return X_BI_; }     ///< pose of that shape in the body's frame, X_BI

  /// Returns the support height along n and the support point, body frame; n as of SupportShape.
  Support support(const Eigen::Vector3d& n) const {
    const Support s = inner_.support(X_BI_.rotation().transpose() * n);
    return {s.height + n.dot(X_BI_.position()), X_BI_.to_world(s.point)};
  }
  /// Returns the Hessian of the support height, body frame.
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const {
    const Eigen::Matrix3d& R = X_BI_.rotation();
    return R * Eigen::Matrix3d(inner_.support_hessian(R.transpose() * n)) * R.transpose();
  }

  /// Returns whether a point of the body's frame is in the body or on its surface.
  bool contains(const Eigen::Vector3d& x) const requires PointSet<Inner> { return inner_.contains(X_BI_.to_body(x)); }

  /// Returns a radius about the body's origin that contains the shape: that of the shape and its distance.
  double bounding_radius() const { return inner_.bounding_radius() + X_BI_.position().norm(); }
  /// Returns a radius about the body's origin that the shape contains, 0 if the origin may be outside.
  double inscribed_radius() const { return std::max(0.0, inner_.inscribed_radius() - X_BI_.position().norm()); }
  /// Returns that of the shape inside.
  double min_curvature_radius() const { return kernel::min_curvature_radius_or_zero(inner_); }

  /// Returns the volume.
  double volume() const requires requires(const Inner& s) { s.volume(); }
  { return inner_.volume(); }
  /// Returns the centre of mass, body frame.
  Eigen::Vector3d centre_of_mass() const { return X_BI_.to_world(inner_centre()); }
  /// Returns the inertia tensor about the body's origin at uniform density.
  Eigen::Matrix3d inertia_tensor(double mass) const requires requires(const Inner& s) { s.inertia(1.0); }
  {
    const Eigen::Matrix3d& R = X_BI_.rotation();
    const Eigen::Vector3d t = R.transpose() * X_BI_.position();
    const Eigen::Vector3d c = inner_centre();
    // Integral of |x + t|^2 1 - (x + t) (x + t)^T over the shape, in its own axes.
    const Eigen::Matrix3d products = t * t.transpose() + c * t.transpose() + t * c.transpose();
    const Eigen::Matrix3d moved =
        inner_inertia(mass) + mass * (products.trace() * Eigen::Matrix3d::Identity() - products);
    return R * moved * R.transpose();
  }

 private:
  Eigen::Vector3d inner_centre() const {
    if constexpr (requires { inner_.centre_of_mass(); }) return inner_.centre_of_mass();
    return Eigen::Vector3d::Zero();
  }
  Eigen::Matrix3d inner_inertia(double mass) const {
    if constexpr (requires { inner_.inertia_tensor(mass); }) return inner_.inertia_tensor(mass);
    return Eigen::Matrix3d(inner_.inertia(mass).asDiagonal());
  }

  Inner inner_;
  Pose X_BI_;
};

/// Forwards to the function of the shapes inside, at their poses in the world.
/// @{
template <SupportShape I, SupportShape J>
DistanceResult distance(const Placed<I>& a, const Pose& X_WA, const Placed<J>& b, const Pose& X_WB,
                        const DistanceOptions& options = {}) {
  return distance(a.inner(), X_WA * a.pose(), b.inner(), X_WB * b.pose(), options);
}
template <SupportShape I, SupportShape B>
DistanceResult distance(const Placed<I>& a, const Pose& X_WA, const B& b, const Pose& X_WB,
                        const DistanceOptions& options = {}) {
  return distance(a.inner(), X_WA * a.pose(), b, X_WB, options);
}
template <SupportShape A, SupportShape J>
DistanceResult distance(const A& a, const Pose& X_WA, const Placed<J>& b, const Pose& X_WB,
                        const DistanceOptions& options = {}) {
  return distance(a, X_WA, b.inner(), X_WB * b.pose(), options);
}

template <SupportShape I, SupportShape J>
Answer overlap(const Placed<I>& a, const Pose& X_WA, const Placed<J>& b, const Pose& X_WB,
               const Eigen::Vector3d& start = Eigen::Vector3d::Zero()) {
  return overlap(a.inner(), X_WA * a.pose(), b.inner(), X_WB * b.pose(), start);
}
template <SupportShape I, SupportShape B>
Answer overlap(const Placed<I>& a, const Pose& X_WA, const B& b, const Pose& X_WB,
               const Eigen::Vector3d& start = Eigen::Vector3d::Zero()) {
  return overlap(a.inner(), X_WA * a.pose(), b, X_WB, start);
}
template <SupportShape A, SupportShape J>
Answer overlap(const A& a, const Pose& X_WA, const Placed<J>& b, const Pose& X_WB,
               const Eigen::Vector3d& start = Eigen::Vector3d::Zero()) {
  return overlap(a, X_WA, b.inner(), X_WB * b.pose(), start);
}

template <SupportShape I, SupportShape J>
double distance_lower_bound(const Placed<I>& a, const Pose& X_WA, const Placed<J>& b, const Pose& X_WB,
                            const Eigen::Vector3d& n) {
  return distance_lower_bound(a.inner(), X_WA * a.pose(), b.inner(), X_WB * b.pose(), n);
}
template <SupportShape I, SupportShape B>
double distance_lower_bound(const Placed<I>& a, const Pose& X_WA, const B& b, const Pose& X_WB,
                            const Eigen::Vector3d& n) {
  return distance_lower_bound(a.inner(), X_WA * a.pose(), b, X_WB, n);
}
template <SupportShape A, SupportShape J>
double distance_lower_bound(const A& a, const Pose& X_WA, const Placed<J>& b, const Pose& X_WB,
                            const Eigen::Vector3d& n) {
  return distance_lower_bound(a, X_WA, b.inner(), X_WB * b.pose(), n);
}

template <SupportShape I>
ClosestPoint closest_point(const Placed<I>& shape, const Pose& X_WB, const Eigen::Vector3d& p_W) {
  return closest_point(shape.inner(), X_WB * shape.pose(), p_W);
}
template <SupportShape I>
bool contains(const Placed<I>& shape, const Pose& X_WB, const Eigen::Vector3d& p_W) {
  return contains(shape.inner(), X_WB * shape.pose(), p_W);
}
template <SupportShape I>
RayHit ray_cast(const Placed<I>& shape, const Pose& X_WB, const Eigen::Vector3d& origin,
                const Eigen::Vector3d& direction) {
  return ray_cast(shape.inner(), X_WB * shape.pose(), origin, direction);
}
template <SupportShape I>
RayHit ray_exit(const Placed<I>& shape, const Pose& X_WB, const Eigen::Vector3d& origin,
                const Eigen::Vector3d& direction) {
  return ray_exit(shape.inner(), X_WB * shape.pose(), origin, direction);
}
template <SupportShape I>
OrientedBox oriented_box(const Placed<I>& shape, const Pose& X_WB) {
  return oriented_box(shape.inner(), X_WB * shape.pose());
}
/// @}

/// Any SupportShape behind one type, so that programs with many kinds of bodies, a user's own among them, compile one
/// case of each query, and libgeom has it. Copies share the shape.
///
/// Queries are those of the shape inside, with its methods and accuracy: ellipsoids, superellipsoids and CoreShapes are
/// recognised, also inside Rounded, Placed and geom::Shape.
class GEOM_EXPORT AnyConvex {
 public:
  /// Constructs the body from any shape.
  template <SupportShape T>
  requires(!std::same_as<std::decay_t<T>, AnyConvex>) AnyConvex(T shape)  // NOLINT: a shape is one of any kind
      : AnyConvex(part_of(Pose(), 0, std::move(shape))) {}
  /// Constructs the body from a shape chosen at run time.
  template <class... Shapes>
  AnyConvex(const std::variant<Shapes...>& shape)  // NOLINT: a shape is one of any kind
      : AnyConvex(std::visit([](const auto& s) { return part_of(Pose(), 0, s); }, shape)) {}

  /// Returns the support height along n and the support point, body frame; n as of SupportShape.
  Support support(const Eigen::Vector3d& n) const;
  /// Returns the Hessian of the support height, body frame.
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const;
  double bounding_radius() const;       ///< radius about the body's origin that contains the shape
  double inscribed_radius() const;      ///< radius about the body's origin that the shape contains; 0: maybe none
  double min_curvature_radius() const;  ///< lower bound of the radii of curvature; 0 if the shape does not tell

  /// Interface that hides the shape's type.
  struct Concept {
    virtual ~Concept() = default;
    virtual Support support(const Eigen::Vector3d& n) const = 0;                  ///< support of the shape
    virtual Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const = 0;  ///< Hessian of the support function
    virtual double bounding_radius() const = 0;                                   ///< bounding radius
    virtual double inscribed_radius() const = 0;                                  ///< inscribed radius
    virtual double min_curvature_radius() const = 0;                              ///< 0 if the shape does not tell
    virtual bool contains(const Eigen::Vector3d& x) const = 0;  ///< false also if the shape cannot tell
    virtual std::optional<kernel::CoreView> core() const = 0;   ///< nullopt: none
    virtual const Ellipsoid* ellipsoid() const = 0;             ///< null: another kind
    virtual const Superellipsoid* superellipsoid() const = 0;   ///< null: another kind
  };
  /// Shape at a pose in the body's frame, less the ball that is swept over it.
  struct Part {
    std::shared_ptr<const Concept> shape;
    Pose X_BI;
    double skin = 0;
  };
  const Part& part() const { return part_; }  ///< shape inside, which the queries take

 private:
  template <class T>
  struct Model final : Concept {
    explicit Model(T s) : shape(std::move(s)) {}
    Support support(const Eigen::Vector3d& n) const override { return shape.support(n); }
    Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const override { return shape.support_hessian(n); }
    double bounding_radius() const override { return shape.bounding_radius(); }
    double inscribed_radius() const override { return shape.inscribed_radius(); }
    double min_curvature_radius() const override { return kernel::min_curvature_radius_or_zero(shape); }
    bool contains(const Eigen::Vector3d& x) const override { return kernel::holds_point(shape, x); }
    std::optional<kernel::CoreView> core() const override {
      if constexpr (CoreShape<T>) return shape.core();
      return std::nullopt;
    }
    const Ellipsoid* ellipsoid() const override {
      if constexpr (std::same_as<T, Ellipsoid>) return &shape;
      return nullptr;
    }
    const Superellipsoid* superellipsoid() const override {
      if constexpr (std::same_as<T, Superellipsoid>) return &shape;
      return nullptr;
    }
    T shape;
  };

  explicit AnyConvex(Part part) : part_(std::move(part)) {}

  /// Returns the part of a shape at X_BI with a ball swept over it; takes poses and balls off it.
  template <class T>
  static Part part_of(const Pose& X_BI, double skin, T shape) {
    return {std::make_shared<const Model<T>>(std::move(shape)), X_BI, skin};
  }
  template <class Inner>
  static Part part_of(const Pose& X_BI, double skin, Placed<Inner> shape) {
    return part_of(X_BI * shape.pose(), skin, shape.inner());
  }
  template <class Inner>
  static Part part_of(const Pose& X_BI, double skin, Rounded<Inner> shape) {
    return part_of(X_BI, skin + shape.radius(), shape.inner());
  }
  static Part part_of(const Pose& X_BI, double skin, const AnyConvex& shape) {
    Part part = shape.part();
    part.X_BI = X_BI * part.X_BI;
    part.skin += skin;
    return part;
  }

  Part part_;
};

/// Runs the query of the shapes inside, compiled into the library.
/// @{
GEOM_EXPORT DistanceResult distance(const AnyConvex& a, const Pose& X_WA, const AnyConvex& b, const Pose& X_WB,
                                    const DistanceOptions& options = {});
GEOM_EXPORT Answer overlap(const AnyConvex& a, const Pose& X_WA, const AnyConvex& b, const Pose& X_WB,
                           const Eigen::Vector3d& start = Eigen::Vector3d::Zero());
GEOM_EXPORT double distance_lower_bound(const AnyConvex& a, const Pose& X_WA, const AnyConvex& b, const Pose& X_WB,
                                        const Eigen::Vector3d& n);
GEOM_EXPORT ClosestPoint closest_point(const AnyConvex& shape, const Pose& X_WB, const Eigen::Vector3d& p_W);
/// Overload; a user's shape that cannot tell is asked for the closest point.
GEOM_EXPORT bool contains(const AnyConvex& shape, const Pose& X_WB, const Eigen::Vector3d& p_W);
GEOM_EXPORT RayHit ray_cast(const AnyConvex& shape, const Pose& X_WB, const Eigen::Vector3d& origin,
                            const Eigen::Vector3d& direction);
/// @}

}  // namespace geom
