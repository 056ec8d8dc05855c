#pragma once

#include <geom/export.h>

#include <Eigen/Core>

namespace geom {

class Pose;

namespace internal {

/// A pose without the checks, for loops: the rotation must be orthonormal to rounding, the numbers finite.
Pose unchecked_pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& position);

}  // namespace internal

/// Position and orientation of a body B in a world W: p_W = rotation * p_B + position.
///
/// A Pose is valid by construction, so that no query needs to check it again: the constructors throw
/// std::invalid_argument when a number is not finite, a coordinate of the position is beyond +-kMaxCoordinate (1e100),
/// or the rotation is further than kPoseTolerance (1e-6) from a proper orthonormal matrix; a rotation within that
/// tolerance is replaced by the nearest orthonormal one.
class GEOM_EXPORT Pose {
 public:
  /// The identity.
  Pose() = default;

  /// `rotation`: columns are the body's axes in world coordinates.
  Pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& position);

  /// Position alone, not turned.
  static Pose translation(const Eigen::Vector3d& position);

  /// From a quaternion (w, x, y, z), body to world; its norm must be 1 within kPoseTolerance.
  static Pose from_quaternion(double w, double x, double y, double z,
                              const Eigen::Vector3d& position = Eigen::Vector3d::Zero());

  const Eigen::Matrix3d& rotation() const { return rotation_; }  ///< columns: the body's axes in the world
  const Eigen::Vector3d& position() const { return position_; }  ///< of the body's origin

  /// Coordinates of a body point in the world.
  Eigen::Vector3d to_world(const Eigen::Vector3d& p_B) const { return rotation_ * p_B + position_; }
  /// Coordinates of a world point in the body.
  Eigen::Vector3d to_body(const Eigen::Vector3d& p_W) const { return rotation_.transpose() * (p_W - position_); }

 private:
  friend Pose internal::unchecked_pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& position);

  Eigen::Matrix3d rotation_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();
};

inline Pose internal::unchecked_pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& position) {
  Pose pose;
  pose.rotation_ = rotation;
  pose.position_ = position;
  return pose;
}

}  // namespace geom
