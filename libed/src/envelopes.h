#pragma once

/// Envelopes: the regions, fixed in space, in which bodies stay while their neighbour lists are valid.
///
/// Two bodies are neighbours while their envelopes meet; a body that leaves its envelope gets a new one and a new list.
/// Three kinds, one list code: the dilated body, the paper's oriented box, and the cell of the paper's plain algorithm.

#include "axis_motion.h"

#include <Eigen/Core>

namespace ed::internal {

class Envelopes {
 public:
  virtual ~Envelopes() = default;

  /// What the lists' cost is tuned by (length); 0 for envelopes that have no such parameter.
  virtual double thickness() const = 0;

  /// Bodies whose positions when their envelopes were made are further apart than this are no neighbours.
  virtual double reach() const = 0;

  /// By what the box may shrink in all before the lists must be made anew; 1: it must not.
  virtual double least_scale() const { return 1; }

  /// A new envelope for body i at its present state; `x_axis` is the direction of body x, across the axis.
  virtual void place(int i, const Eigen::Vector3d& position, const Eigen::Vector3d& axis,
                     const Eigen::Vector3d& x_axis) = 0;

  /// The box, and all that is in it, has been scaled.
  virtual void scale(double factor) = 0;

  /// A lower bound of the time when body i leaves its envelope; its position and axis are those at `now`.
  virtual double exit_time(int i, const AxisMotion& motion, const Eigen::Vector3d& position,
                           const Eigen::Vector3d& axis, double now, double box) const = 0;

  /// A time short enough that looking at the envelope again after it would be a waste: better make a new one.
  virtual double worthwhile(const AxisMotion& motion) const = 0;

  /// Whether the envelopes of i and k, the bodies r apart when they were made (nearest image), may meet; false: they do
  /// not, proved. Sets a normal from i to k to start a contact search from.
  virtual bool may_meet(int i, int k, const Eigen::Vector3d& r, Eigen::Vector3d& normal) const = 0;
};

}  // namespace ed::internal
