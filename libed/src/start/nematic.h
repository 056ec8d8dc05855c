#pragma once

/// Orientations with a given order parameter.

#include <ed/random.h>
#include <ed/system.h>

#include <Eigen/Core>

#include <functional>
#include <string>
#include <vector>

namespace ed::internal {

/// Maier and Saupe's distribution about z: density of u proportional to exp(m u_z^2), m >= 0 such that the order
/// parameter <P2(u_z)> is the one given.
class NematicOrientations {
 public:
  /// Throws std::invalid_argument unless 0 <= order < 1.
  explicit NematicOrientations(double order);

  /// A rotation that takes body axis 0, 1 or 2 to a direction drawn from the distribution and is uniform about it. No
  /// result of libm enters but by the outcome of comparisons.
  Eigen::Matrix3d draw(int axis, Random& random) const;

 private:
  double m_;  ///< to 1e-12 of it
};

/// Turns bodies where they stand, from no overlap to no overlap, until the mean of P2(u_z), u their ordered axes, is
/// `order` or by the turn of one body more: Metropolis rotations in which it never falls below, nor
/// the director leaves z by more than the error of a sample. What they sample is
/// uniform over all orientations without overlap and of that order; without the bodies in each other's way, Maier and
/// Saupe's distribution for large numbers. `axes`: the ordered axis of each species. Throws std::invalid_argument,
/// naming nematic_order and `other_numbers` of bodies, if any, that have more room, where rotations do not lead that
/// far.
void turn_to_order(System& system, const std::vector<int>& axes, double order, Random& random,
                   const std::function<std::string()>& other_numbers);

/// The body axis that has the order: that of revolution, or body z.
int ordered_axis(const Species& species);

/// The rotation that takes body axis `axis` to world z and the two that follow it cyclically to x and y.
Eigen::Matrix3d aligned(int axis);

}  // namespace ed::internal
