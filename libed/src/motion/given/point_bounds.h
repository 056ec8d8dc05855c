#pragma once

/// Bounds of a moving body's points, and comparison of its poses with the bounds of its motion.

#include <ed/given/motion.h>

#include <geom/pose.h>

#include <string>

namespace ed::internal {

/// Returns a b, 0 if one of them is 0.
inline double bound_product(double a, double b) {
  return a == 0 || b == 0 ? 0 : a * b;
}

/// Bounds of the speed and the acceleration of a body's points.
struct PointBounds {
  double speed = 0, acceleration = 0;

  PointBounds() = default;
  /// `radius`: largest distance of a point from the body's origin.
  PointBounds(const MotionBounds& b, double radius)
      : speed(b.speed + bound_product(b.angular_speed, radius)),
        acceleration(b.acceleration +
                     bound_product(b.angular_acceleration + b.angular_speed * b.angular_speed, radius)) {}
};

/// Returns in words how a body moves further between two times than its speeds allow; empty if it does not. `scales`:
/// numbers whose rounding counts, beside those of poses and times.
std::string broken_speed(const MotionBounds& bounds, double from, const geom::Pose& X, double to, const geom::Pose& Y,
                         const MotionScales& scales);

/// Returns in words how the pose in the middle between two times is further from the mean of those at both than
/// accelerations allow; empty if it is not.
std::string broken_acceleration(const MotionBounds& bounds, double from, const geom::Pose& X, const geom::Pose& middle,
                                double to, const geom::Pose& Y, const MotionScales& scales);

}  // namespace ed::internal
