#pragma once

/// Ellipsoids of revolution in motion, for the tests of envelopes.

#include <common/finder/ensemble.h>

#include <ed/random.h>

#include <geom/kernel/uniaxial.h>

#include <motion/axis_motion.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace moving_spheroids {

using ed::internal::AxisMotion;
using ed::internal::BodyFrame;
using ed::internal::UniaxialInertia;
using Eigen::Vector3d;
using finder_test::log_uniform;

struct Shape {
  double a;  // along the axis
  double b;
  geom::kernel::Spheroid spheroid() const { return {a, b}; }
  double difference() const { return std::abs(a - b); }
  double bounding_radius() const { return std::max(a, b); }
  double support(const Vector3d& u, const Vector3d& n) const {
    const double x = u.dot(n);
    return std::sqrt(b * b * (n - x * u).squaredNorm() + a * a * x * x);
  }
};

inline AxisMotion random_motion(ed::Random& random, const UniaxialInertia& inertia) {
  AxisMotion motion;
  BodyFrame frame;
  motion.time = 0;
  motion.position = random.normal3();
  motion.velocity = log_uniform(random, 1e-3, 3) * random.direction();
  const Vector3d u = random.direction();
  frame.x_axis = u.unitOrthogonal();
  frame.spin = inertia.spins ? random.normal() : 0;
  Vector3d omega = log_uniform(random, 1e-2, 10) * random.direction();
  omega -= omega.dot(u) * u;
  set_rotation(inertia, u, omega, motion, frame);
  return motion;
}

/// A body at the origin whose axis x turns towards y at `rate`.
inline AxisMotion simple_motion(const Vector3d& velocity, double rate) {
  AxisMotion motion;
  motion.time = 0;
  motion.position.setZero();
  motion.velocity = velocity;
  motion.e0.setZero();
  motion.e1 = Vector3d::UnitX();
  motion.e2 = Vector3d::UnitY();
  motion.rate = rate;
  return motion;
}

inline Vector3d axis_at(const AxisMotion& motion, double t) {
  const double angle = motion.rate * (t - motion.time);
  return motion.e0 + std::cos(angle) * motion.e1 + std::sin(angle) * motion.e2;
}

/// Two bodies whose surfaces are `gap` apart, apart along a random direction: chosen normal, support points, offset.
struct PlacedPair {
  Vector3d r;  // from i to k
  Vector3d u_i;
  Vector3d u_k;
};

inline PlacedPair place_pair(const Shape& shape, double gap, ed::Random& random) {
  const Vector3d n = random.direction();
  PlacedPair pair{Vector3d::Zero(), random.direction(), random.direction()};
  const auto support_point = [&](const Vector3d& u, const Vector3d& m) {
    const double x = u.dot(m);
    return Vector3d((shape.b * shape.b * (m - x * u) + shape.a * shape.a * x * u) / shape.support(u, m));
  };
  pair.r = support_point(pair.u_i, n) + gap * n - support_point(pair.u_k, -n);
  return pair;
}

}  // namespace moving_spheroids
