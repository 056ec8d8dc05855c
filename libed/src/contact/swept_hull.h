#pragma once

/// Convex hulls of all that bodies sweep by turning about their centres, whatever the time: while two of them, moving
/// with the centres, are apart, the bodies are. A pair that turns a million times before it touches is moved on to
/// where its hulls meet at once, and the contact search, which follows each turn, does the rest.

#include "motion/axis_motion.h"
#include "motion/rigid_motion.h"

#include <ed/shape.h>

#include <geom/kernel/uniaxial.h>

#include <Eigen/Core>

#include <array>
#include <variant>

namespace ed::internal {

/// Number of directions at which the support function of a body that turns about a fixed axis is tabulated.
inline constexpr int kSweptNodes = 33;

/// Support function of the set that a body sweeps about its centre, or an upper bound of it; positions count from the
/// centre.
class SweptHull {
 public:
  /// Ellipsoid of revolution: exact.
  SweptHull(const geom::kernel::Spheroid& shape, const AxisMotion& motion);

  /// Any shape; `motion` at its own clock's 0. A body that does not turn: exact. One that turns about an axis fixed in
  /// the body and in space: between the exact one and 1 + 3e-3 times that, exact along the axis. One with two equal
  /// moments of inertia: what it sweeps about its own axis, and that about the angular momentum. Otherwise the bounding
  /// sphere.
  SweptHull(const BodyShape& shape, const RigidMotion& motion, const Eigen::Vector3d& inertia);

  /// h(n) >= max over all times of the body's support function, n a unit vector.
  double height(const Eigen::Vector3d& n) const;

 private:
  struct Spheroid {
    double b2, c;  ///< h^2 = b2 + c x^2, x = n.u
    Eigen::Vector3d e0, e1, e2;
    double height(const Eigen::Vector3d& n) const;
  };
  struct Resting {
    const BodyShape* shape;
    Eigen::Matrix3d rotation;
    double height(const Eigen::Vector3d& n) const;
  };
  struct AboutAnAxis {
    Eigen::Vector3d axis;
    std::array<double, kSweptNodes> heights;  ///< values at equal angles from the axis, 0 to pi
    double height(const Eigen::Vector3d& n) const;
    double height_at(double angle) const;
    /// Largest height at the angles from `least` to `most`, or an upper bound.
    double highest(double least, double most) const;
    /// Hull of what this one sweeps by turning about `other`.
    AboutAnAxis turned_about(const Eigen::Vector3d& other) const;
  };
  struct Ball {
    double radius;
    double height(const Eigen::Vector3d& /*n*/) const { return radius; }
  };

  /// Hull of what a body with that rotation sweeps by turning about an axis fixed in it (unit, world frame).
  static AboutAnAxis about_an_axis(const BodyShape& shape, const Eigen::Matrix3d& rotation,
                                   const Eigen::Vector3d& axis);

  std::variant<Ball, Spheroid, Resting, AboutAnAxis> hull_;
};

/// Two hulls that move with their centres.
struct SweptPair {
  SweptHull a, b;
  Eigen::Vector3d r;  ///< vector from A's centre to B's at time 0
  Eigen::Vector3d v;  ///< velocity of B relative to A
  double size;        ///< sum of the bounding radii

  /// Time, at least `t`, before which the hulls certainly do not meet, with `n`, from A to B, as first guess of the
  /// normal. Infinite if they never do. `hidden`: what rounding may hide of a gap at t, a length.
  ///
  /// `touching`: the bodies touch and do not approach, and may sink into each other by 4 kTouching * size (the
  /// search itself allows 2).
  double clear_until(double t, const Eigen::Vector3d& n, double hidden, bool touching) const;

 private:
  double gap(const Eigen::Vector3d& n, double t) const;
  Eigen::Vector3d best_normal(const Eigen::Vector3d& guess, double t) const;
};

}  // namespace ed::internal
