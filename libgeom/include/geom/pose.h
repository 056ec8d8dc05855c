#pragma once

#include <geom/export.h>

#include <Eigen/Core>

#include <array>

namespace geom {

class Pose;

namespace kernel {

/// Constructs a Pose without checks, for inner loops: the rotation must be orthonormal to rounding, the numbers finite.
Pose unchecked_pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& position);

/// Returns a pose with its position moved by a vector, without checks.
Pose moved(const Pose& X_WB, const Eigen::Vector3d& by);

/// Returns the unit quaternion (w, x, y, z) of an orthonormal matrix, w >= 0, as an array. Its alignment depends on no
/// compiler flag, unlike that of Eigen's quaternions (docs/decisions/017).
GEOM_EXPORT std::array<double, 4> quaternion_of(const Eigen::Matrix3d& rotation);

}  // namespace kernel

/// Position and orientation of a body B in a world W: p_W = rotation * p_B + position.
///
/// A Pose is valid by construction, so that no query needs to check it again. Each function that makes one throws
/// std::invalid_argument when a number is not finite, a coordinate of the position is beyond +-kMaxCoordinate (1e100),
/// or the orientation is further from a rotation than the function's tolerance. An orientation within the tolerance is
/// replaced by the nearest rotation, so that `rotation()` is always orthonormal to rounding: no entry of R^T R - 1 is
/// above 2e-15.
///
/// Functions that take or return Eigen's Quaternion and Transform are for programs that include <Eigen/Geometry>.
class GEOM_EXPORT Pose {
 public:
  /// Constructs the identity.
  Pose() = default;

  /// Constructs a pose from a rotation and a position. Columns of `rotation` are the body's axes in world coordinates,
  /// orthonormal within kPoseTolerance (1e-6, the largest entry of R^T R - 1), no reflection.
  Pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& position);

  /// Returns a pose with this position and the identity as rotation.
  static Pose translation(const Eigen::Vector3d& position);

  /// Returns a pose with the orientation of a quaternion (w, x, y, z), body to world; its norm must be 1 within
  /// kPoseTolerance.
  static Pose from_quaternion(double w, double x, double y, double z,
                              const Eigen::Vector3d& position = Eigen::Vector3d::Zero());
  /// Overload for Eigen's quaternions, which store w last.
  template <int Options>
  static Pose from_quaternion(const Eigen::Quaternion<double, Options>& q,
                              const Eigen::Vector3d& position = Eigen::Vector3d::Zero()) {
    return from_quaternion(q.w(), q.x(), q.y(), q.z(), position);
  }

  /// Returns a pose with the orientation q / |q|, body to world. The quaternion q = (w, x, y, z) may have any length
  /// except 0, even one that under- or overflows; its components must be finite. Entries of the rotation are accurate
  /// to 1e-15.
  static Pose normalized_quaternion(double w, double x, double y, double z,
                                    const Eigen::Vector3d& position = Eigen::Vector3d::Zero());
  /// Overload for Eigen's quaternions, in either precision.
  template <class Scalar, int Options>
  static Pose normalized_quaternion(const Eigen::Quaternion<Scalar, Options>& q,
                                    const Eigen::Vector3d& position = Eigen::Vector3d::Zero()) {
    return normalized_quaternion(static_cast<double>(q.w()), static_cast<double>(q.x()), static_cast<double>(q.y()),
                                 static_cast<double>(q.z()), position);
  }

  /// Returns a pose with the rotation nearest to a matrix (in the Frobenius norm: its polar factor), found to 2e-15 an
  /// entry. Meant for products of many transforms, or of some in single precision, that have drifted: the matrix must
  /// be orthonormal within kNearestRotationTolerance (1e-2, the largest entry of M^T M - 1), no reflection. Sheared or
  /// scaled matrices beyond that are refused.
  static Pose nearest_rotation(const Eigen::Matrix3d& matrix, const Eigen::Vector3d& position);
  /// Overload for the linear part and the translation of a transform, in either precision, not projective.
  template <class Scalar, int Mode, int Options>
  static Pose nearest_rotation(const Eigen::Transform<Scalar, 3, Mode, Options>& X_WB) {
    static_assert(Mode != int{Eigen::Projective}, "Pose::nearest_rotation takes Isometry, Affine and AffineCompact");
    return nearest_rotation(Eigen::Matrix3d(X_WB.linear().template cast<double>()),
                            Eigen::Vector3d(X_WB.translation().template cast<double>()));
  }

  /// Returns Pose(X_WB.linear(), X_WB.translation()), X_WB mapping body coordinates to the world; with the same bits if
  /// the linear part is orthonormal to 1e-15.
  template <int Options>
  static Pose from_isometry(const Eigen::Transform<double, 3, Eigen::Isometry, Options>& X_WB) {
    return {Eigen::Matrix3d(X_WB.linear()), Eigen::Vector3d(X_WB.translation())};
  }

  const Eigen::Matrix3d& rotation() const { return rotation_; }  ///< columns: the body's axes in the world
  const Eigen::Vector3d& position() const { return position_; }  ///< position of the body's origin in the world

  /// Returns the orientation as a unit quaternion, body to world, w >= 0, each component accurate to 1e-15. The
  /// position is not part of it.
  template <int Options = Eigen::AutoAlign>
  Eigen::Quaternion<double, Options> quaternion() const {
    const std::array<double, 4> q = kernel::quaternion_of(rotation_);
    return {q[0], q[1], q[2], q[3]};
  }

  /// Returns Eigen's transform of the same map, with the same bits.
  template <int Options = Eigen::AutoAlign>
  Eigen::Transform<double, 3, Eigen::Isometry, Options> isometry() const {
    Eigen::Transform<double, 3, Eigen::Isometry, Options> X_WB;
    X_WB.setIdentity();
    X_WB.linear() = rotation_;
    X_WB.translation() = position_;
    return X_WB;
  }

  /// Composes X_WB * X_BC = X_WC, so that (X_WB * X_BC).to_world(p) = X_WB.to_world(X_BC.to_world(p)). Entries of the
  /// rotation are accurate to 2e-15 and stay orthonormal to rounding in chains of any length. Coordinates of the
  /// position are accurate to 2e-15 of the sum of both positions' lengths. Throws std::invalid_argument if the position
  /// is beyond kMaxCoordinate.
  Pose operator*(const Pose& X_BC) const;

  /// Returns the pose of the world seen from the body, X_BW: inverse().to_world(p) = to_body(p). The rotation is
  /// exactly the transpose; coordinates of the position are accurate to 1e-15 of its length. Throws
  /// std::invalid_argument if the position is beyond kMaxCoordinate.
  Pose inverse() const;

  /// Transforms a point from body to world coordinates.
  Eigen::Vector3d to_world(const Eigen::Vector3d& p_B) const { return rotation_ * p_B + position_; }
  /// Transforms a point from world to body coordinates.
  Eigen::Vector3d to_body(const Eigen::Vector3d& p_W) const { return rotation_.transpose() * (p_W - position_); }

 private:
  friend Pose kernel::unchecked_pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& position);

  Eigen::Matrix3d rotation_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();
};

inline Pose kernel::unchecked_pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& position) {
  Pose pose;
  pose.rotation_ = rotation;
  pose.position_ = position;
  return pose;
}

inline Pose kernel::moved(const Pose& X_WB, const Eigen::Vector3d& by) {
  return unchecked_pose(X_WB.rotation(), X_WB.position() + by);
}

}  // namespace geom
