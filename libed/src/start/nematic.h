#pragma once

/// Orientations with a given order parameter.

#include <ed/random.h>
#include <ed/system.h>

#include <Eigen/Core>

#include <functional>
#include <string>
#include <vector>

namespace ed::internal {

/// Maier and Saupe's distribution about z: density of u proportional to exp(m u_z^2), with m >= 0 such that the order
/// parameter <P2(u_z)> has a given value.
class NematicOrientations {
 public:
  /// Constructs the distribution with this order parameter. Throws std::invalid_argument unless 0 <= order < 1.
  explicit NematicOrientations(double order);

  /// Draws a rotation that takes body axis 0, 1 or 2 to a direction from the distribution and is uniform about it.
  /// Functions of libm affect no result except through comparisons.
  Eigen::Matrix3d draw(int axis, Random& random) const;

 private:
  double m_;  ///< exponent, with a relative error of 1e-12
};

/// Rotates bodies about their centres, without overlap at any step, until the mean of P2(u_z), u their ordered axes, is
/// `order`, or above by less than the rotation of one body changes it. The moves are Metropolis rotations in which the
/// mean never falls below `order`, and the director never leaves z by more than the error of a sample. They sample
/// uniformly all orientations without overlap and with this order; if the bodies do not restrict each other, that is
/// Maier and Saupe's distribution for large numbers.
///
/// `axes`: the ordered axis of each species. Throws std::invalid_argument if rotations do not reach the order, naming
/// nematic_order and, if there are any, `other_numbers` of bodies that have more room. `poll`: see LatticeOptions.
void turn_to_order(System& system, const std::vector<int>& axes, double order, Random& random,
                   const std::function<std::string()>& other_numbers, const std::function<void()>& poll);

/// Returns the body axis that has the order: that of revolution, or body z.
int ordered_axis(const Species& species);

/// Returns the rotation that takes body axis `axis` to world z and the two that follow it cyclically to x and y.
Eigen::Matrix3d aligned(int axis);

}  // namespace ed::internal
