#include "motion/checks.h"
#include "motion/given/point_bounds.h"

#include <ed/given/motion.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace ed {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom::Pose;

/// Relative rounding of bounds that are computed.
constexpr double kUp = 1 + 1e-12;

[[noreturn]] void refuse_motion(const std::string& message) {
  throw std::invalid_argument("GivenMotion" + message);
}

void check_interval(const char* function, double from, double to) {
  if (std::isfinite(from) && std::isfinite(to) && from <= to) return;
  std::ostringstream message;
  message << function << ": from time " << from << " to " << to << "; accepted: finite times in order";
  refuse_motion(message.str());
}

/// Returns bounds of the angular speed and acceleration of a free body.
MotionBounds turning_bounds(const Motion& motion) {
  const Matrix3d& R = motion.pose.rotation();
  const Vector3d omega = R.transpose() * motion.angular_velocity;
  const Vector3d momentum = motion.inertia.cwiseProduct(omega);
  const double L = momentum.norm(), least = motion.inertia.minCoeff(), most = motion.inertia.maxCoeff();
  MotionBounds bounds;
  bounds.angular_speed = omega.norm();
  bounds.angular_acceleration = 0;
  if (least == most || L == 0) return bounds;
  const int axis = internal::symmetry_axis_of_inertia(motion.inertia);
  if (axis < 0) {
    // omega = I^-1 L, and I omega' = L x omega, in the body's frame.
    bounds.angular_speed = L / least;
    bounds.angular_acceleration = L / least * (L / least);
    return bounds;
  }
  // The angular velocity keeps its length and turns about the angular momentum.
  const Vector3d across = omega - omega.dot(momentum) / (L * L) * momentum;
  bounds.angular_acceleration = across.norm() * L / motion.inertia[(axis + 1) % 3];
  return bounds;
}

}  // namespace

GivenMotion::GivenMotion(PoseFunction pose, BoundsFunction bounds, const MotionScales& scales)
    : pose_(std::move(pose)), bounds_(std::move(bounds)), scales_(scales) {
  if (!pose_ || !bounds_) refuse_motion(": a function is empty; accepted: a pose and bounds");
  for (const double scale : {scales.length, scales.time}) {
    if (std::isfinite(scale) && scale >= 0) continue;
    std::ostringstream message;
    message << ": a scale is " << scale << "; accepted: finite numbers of 0 or more";
    refuse_motion(message.str());
  }
}

MotionBounds GivenMotion::bounds(double from, double to) const {
  check_interval("::bounds", from, to);
  const MotionBounds found = bounds_(from, to);
  for (const double bound : {found.speed, found.angular_speed, found.acceleration, found.angular_acceleration}) {
    if (bound >= 0) continue;
    std::ostringstream message;
    message << "::bounds: a bound from time " << from << " to " << to << " is " << bound << "; accepted: 0 or more";
    refuse_motion(message.str());
  }
  return found;
}

GivenMotion GivenMotion::resting(const Pose& X_WB) {
  return {[X_WB](double) { return X_WB; }, [](double, double) { return MotionBounds{0, 0, 0, 0}; }};
}

GivenMotion GivenMotion::flight(const Motion& motion) {
  internal::check_motion(motion);
  MotionBounds bounds = turning_bounds(motion);
  bounds.speed = motion.velocity.norm() * kUp;
  bounds.acceleration = 0;
  bounds.angular_speed *= kUp;
  bounds.angular_acceleration *= kUp;
  return {[motion](double t) { return propagate(motion, t).pose; },
          [bounds](double, double) { return bounds; },
          {motion.pose.position().norm(), std::abs(motion.time)}};
}

GivenMotion GivenMotion::screw(const Screw& screw) {
  const double length = screw.axis.stableNorm();
  if (!screw.point.allFinite() || !screw.axis.allFinite() || !(length > 0)) {
    refuse_motion("::screw: the axis has a point or direction that is not finite, or direction 0");
  }
  if (!std::isfinite(screw.angular_speed) || !std::isfinite(screw.speed) || !std::isfinite(screw.time)) {
    refuse_motion("::screw: a speed or the time is not finite; accepted: finite numbers");
  }
  const Vector3d axis = screw.axis / length;
  const Vector3d arm = screw.pose.position() - screw.point;
  const double radius = arm.cross(axis).norm();
  const double turn = std::abs(screw.angular_speed);
  const MotionBounds bounds{std::hypot(radius * turn, screw.speed) * kUp, turn * kUp, radius * turn * turn * kUp, 0};
  const auto pose = [screw, axis, arm](double t) {
    const double duration = t - screw.time;
    const Matrix3d R = Eigen::AngleAxisd(screw.angular_speed * duration, axis).toRotationMatrix();
    return Pose(R * screw.pose.rotation(), screw.point + R * arm + screw.speed * duration * axis);
  };
  return {pose,
          [bounds](double, double) { return bounds; },
          {screw.point.norm() + screw.pose.position().norm(), std::abs(screw.time)}};
}

GivenMotion GivenMotion::on(const GivenMotion& parent) const {
  const auto pose = [parent, child = *this](double t) { return parent.pose(t) * child.pose(t); };
  const auto bounds = [parent, child = *this](double from, double to) {
    const MotionBounds p = parent.bounds(from, to), c = child.bounds(from, to);
    // Distance of the body from the parent's origin.
    const double reach = child.pose(from).position().norm() + internal::bound_product(c.speed, to - from);
    MotionBounds both;
    both.speed = (p.speed + internal::bound_product(p.angular_speed, reach) + c.speed) * kUp;
    both.acceleration =
        (p.acceleration + internal::bound_product(p.angular_acceleration + p.angular_speed * p.angular_speed, reach) +
         2 * internal::bound_product(p.angular_speed, c.speed) + c.acceleration) *
        kUp;
    both.angular_speed = (p.angular_speed + c.angular_speed) * kUp;
    both.angular_acceleration =
        (p.angular_acceleration + internal::bound_product(p.angular_speed, c.angular_speed) + c.angular_acceleration) *
        kUp;
    return both;
  };
  // The positions that are added may cancel.
  return {pose, bounds, {parent.scales_.length + scales_.length, std::max(parent.scales_.time, scales_.time)}};
}

std::string check_given_motion(const GivenMotion& motion, double from, double to, int samples) {
  check_interval(": the motion is checked", from, to);
  if (!std::isfinite(to - from)) {
    std::ostringstream message;
    message << ": the motion is checked from time " << from << " to " << to << "; accepted: a finite duration";
    refuse_motion(message.str());
  }
  const int steps = std::max(samples, 2);
  const MotionScales& scales = motion.scales();
  Pose last = motion.pose(from);
  double begin = from;
  for (int k = 0; k < steps; ++k) {
    const double end = k + 1 < steps ? from + (to - from) * (k + 1) / steps : to;
    const Pose middle = motion.pose(0.5 * (begin + end)), next = motion.pose(end);
    const MotionBounds bounds = motion.bounds(begin, end);
    std::string fault = internal::broken_speed(bounds, begin, last, end, next, scales);
    if (fault.empty()) fault = internal::broken_acceleration(bounds, begin, last, middle, end, next, scales);
    if (!fault.empty()) return fault;
    last = next;
    begin = end;
  }
  return "";
}

}  // namespace ed
