#include "motion/axis_motion.h"
#include "motion/checks.h"
#include "motion/free_top.h"

#include <ed/motion.h>
#include <ed/tolerances.h>

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

namespace ed {
namespace internal {
namespace {

void require_finite(double value, const char* what) {
  if (std::isfinite(value)) return;
  std::ostringstream message;
  message << what << " is " << value << "; accepted: a finite number";
  throw std::invalid_argument(message.str());
}

void require_finite(const Eigen::Vector3d& v, const char* what) {
  if (v.allFinite()) return;
  std::ostringstream message;
  message << what << " is (" << v.transpose() << "); accepted: finite numbers";
  throw std::invalid_argument(message.str());
}

void check_speed(const Eigen::Vector3d& v, const char* what) {
  require_finite(v, what);
  const double speed = v.stableNorm();
  if (speed != 0 && !(speed >= kMinSpeed && speed <= kMaxSpeed)) refuse_speed(v, what);
}

}  // namespace

void refuse_speed(const Eigen::Vector3d& velocity, const std::string& what) {
  std::ostringstream message;
  message << what << " is [" << velocity.x() << ", " << velocity.y() << ", " << velocity.z()
          << "]; accepted: 0, or a length from " << kMinSpeed << " to " << kMaxSpeed;
  throw std::invalid_argument(message.str());
}

void check_inertia(const Eigen::Vector3d& inertia) {
  const double largest = inertia.maxCoeff();
  const double others = inertia.sum() - largest;
  if (inertia.allFinite() && inertia.minCoeff() > 0 && largest <= others * (1 + 1e-12)) return;
  std::ostringstream message;
  message << "inertia is [" << inertia.x() << ", " << inertia.y() << ", " << inertia.z()
          << "]; accepted: three positive moments of which none exceeds the sum of the other two";
  throw std::invalid_argument(message.str());
}

void check_motion(const Motion& motion) {
  check_speed(motion.velocity, "velocity");
  check_speed(motion.angular_velocity, "angular velocity");
  check_inertia(motion.inertia);
  require_finite(motion.time, "time");
}

int symmetry_axis_of_inertia(const Eigen::Vector3d& I) {
  if (I.x() == I.y()) return 2;
  if (I.y() == I.z()) return 0;
  if (I.x() == I.z()) return 1;
  return -1;
}

TopMotion top_motion(const Motion& motion, int axis) {
  const int next = (axis + 1) % 3;
  TopMotion top;
  top.inertia.perpendicular = motion.inertia[next];
  top.inertia.axial = motion.inertia[axis];
  const Eigen::Matrix3d& R = motion.pose.rotation();
  const Eigen::Vector3d u = R.col(axis);
  top.frame.spin = motion.angular_velocity.dot(u);
  top.inertia.spins = top.frame.spin != 0;
  top.frame.x_axis = R.col(next);
  top.axis.position = motion.pose.position();
  top.axis.velocity = motion.velocity;
  top.axis.time = motion.time;
  set_rotation(top.inertia, u, motion.angular_velocity - top.frame.spin * u, top.axis, top.frame);
  return top;
}

}  // namespace internal

Motion propagate(const Motion& motion, double t) {
  internal::check_motion(motion);
  internal::require_finite(t, "propagate: t");
  const double tau = t - motion.time;
  const internal::FreeTop top(motion.inertia, motion.pose.rotation(), motion.angular_velocity);
  const internal::TopState there = top.at(tau);
  Motion result = motion;
  result.pose = geom::Pose(there.R, motion.pose.position() + tau * motion.velocity);
  result.angular_velocity = there.omega;
  result.time = t;
  return result;
}

}  // namespace ed
