#pragma once

#include "motion/axis_motion.h"

#include <ed/motion.h>

#include <string>

namespace ed::internal {

/// Throws std::invalid_argument unless the moments are positive, finite and satisfy the triangle inequality.
void check_inertia(const Eigen::Vector3d& inertia);

/// Throws std::invalid_argument for a Motion with numbers that are not finite, a speed out of range or an impossible
/// inertia.
void check_motion(const Motion& motion);

/// Throws std::invalid_argument: `what` is a velocity of a length out of range.
[[noreturn]] void refuse_speed(const Eigen::Vector3d& velocity, const std::string& what);

/// Returns the body axis about which the other two moments are equal (2 if all three are), or -1.
int symmetry_axis_of_inertia(const Eigen::Vector3d& inertia);

/// Motion in terms of its symmetry axis; the body frame's x is the next body axis in cyclic order.
struct TopMotion {
  UniaxialInertia inertia;
  AxisMotion axis;
  BodyFrame frame;
};
TopMotion top_motion(const Motion& motion, int axis);

}  // namespace ed::internal
