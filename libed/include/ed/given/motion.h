#pragma once

/// @file
/// Motions given as functions of time: those of machines and of bodies on other bodies.

#include <ed/export.h>
#include <ed/motion.h>

#include <geom/pose.h>

#include <Eigen/Core>

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace ed {

/// Bounds of a motion over an interval of time, >= 0. Infinite: not known.
///
/// The pose must be continuous, and its derivatives bounded wherever they exist. Bounds of accelerations promise, too,
/// that velocities have no jumps; a motion with jumps has infinite ones over intervals that contain a jump.
struct MotionBounds {
  double speed = std::numeric_limits<double>::infinity();          ///< speed of the body's origin, length per time
  double angular_speed = std::numeric_limits<double>::infinity();  ///< radian per time
  double acceleration = std::numeric_limits<double>::infinity();   ///< acceleration of the body's origin
  double angular_acceleration = std::numeric_limits<double>::infinity();  ///< radian per time^2
};

/// Numbers that a motion is computed from, and whose rounding its poses have: a length and a time, >= 0. Those of the
/// poses, and of the times that are asked about, count anyway.
struct MotionScales {
  double length = 0;
  double time = 0;
};

/// Rotation about an axis and translation along it, both uniform. World frame.
struct Screw {
  geom::Pose pose;                                  ///< pose at `time`
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< point of the axis
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< direction of the axis; any length but 0
  double angular_speed = 0;                         ///< radian per time, about the axis
  double speed = 0;                                 ///< length per time, along the axis
  double time = 0;
};

/// Motion of a rigid body as a function of time, with bounds of its speeds: the door for motions that are no free
/// flight. Copies share the functions.
class ED_EXPORT GivenMotion {
 public:
  using PoseFunction = std::function<geom::Pose(double t)>;
  using BoundsFunction = std::function<MotionBounds(double from, double to)>;

  /// Constructs a motion from any functions of time. `bounds` is asked about intervals within those that a search is
  /// about; tighter ones over shorter intervals make searches faster. Both must give the same answers for the same
  /// arguments; exceptions are passed on. Throws std::invalid_argument if a function is empty or a
  /// scale negative or not finite.
  GivenMotion(PoseFunction pose, BoundsFunction bounds, const MotionScales& scales = {});

  /// Returns the motion of a body at rest.
  static GivenMotion resting(const geom::Pose& X_WB);

  /// Returns the free flight of a body, which may be asked about any time. Throws as propagate.
  static GivenMotion flight(const Motion& motion);

  /// Returns a uniform rotation and translation. Throws std::invalid_argument if a number is not finite or the axis 0.
  static GivenMotion screw(const Screw& screw);

  /// Returns a motion through way points that starts and ends at rest, in both poses for all time before and after.
  ///
  /// Positions are cubic in time, with the velocity (p_{k+1} - p_{k-1}) / (t_{k+1} - t_{k-1}) at way point k; so are
  /// quaternions, scaled to length 1. Velocities have no jumps. Throws std::invalid_argument unless there are at least
  /// two times, ascending, over a finite duration, and as many as poses, and no rotation between two of them is larger
  /// than 120 degrees, or less where neighbouring intervals differ much.
  static GivenMotion spline(std::vector<double> times, const std::vector<geom::Pose>& X_WB);

  /// Returns this motion, given in the frame of a body P, seen from the world: X_WB(t) = X_WP(t) X_PB(t), of a joint on
  /// a moving link for instance.
  GivenMotion on(const GivenMotion& parent) const;

  /// Returns the pose at a time.
  geom::Pose pose(double t) const { return pose_(t); }

  /// Returns bounds over [from, to]. Throws std::invalid_argument unless from <= to, and if the function returns one
  /// that is negative or NaN.
  MotionBounds bounds(double from, double to) const;

  const MotionScales& scales() const { return scales_; }  ///< numbers that the motion is computed from

 private:
  PoseFunction pose_;
  BoundsFunction bounds_;
  MotionScales scales_;
};

/// Samples a motion at equal steps of [from, to], at least 2 of them, and returns the first bound that it breaks, in
/// words; empty if none. Finding none is no proof, but a broken bound makes searches step over contacts without notice.
/// Throws std::invalid_argument unless from <= to and to - from are finite.
ED_EXPORT std::string check_given_motion(const GivenMotion& motion, double from, double to, int samples = 1000);

}  // namespace ed
