#pragma once

/// Averages over single frames of a run: order and temperatures.

#include "base/archive.h"
#include "observables/lag_sums.h"

#include <ed/system.h>

#include <Eigen/Core>

#include <vector>

namespace ed::internal {

/// Degrees of freedom of some of the bodies, of a system with momentum zero.
struct Freedoms {
  double translational = 0;
  double rotational = 0;
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();  ///< degrees of freedom of the rotation about body x, y, z

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.translational, self.rotational, self.axis);
  }
};

Freedoms freedoms_of(const System& system, BodyRange range);

/// Averages over some of the bodies, summed over frames.
struct FrameSums {
  double S = 0;
  Eigen::Matrix3d order = Eigen::Matrix3d::Zero();  ///< Q
  double translational_kT = 0;
  double rotational_kT = 0;
  Eigen::Vector3d axis_kT = Eigen::Vector3d::Zero();
  double v2 = 0;  ///< <v^2>
  double w2 = 0;  ///< <w^2>, spin excluded

  FrameSums& operator+=(const FrameSums& other);

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.S, self.order, self.translational_kT, self.rotational_kT, self.axis_kT, self.v2, self.w2);
  }
};

/// Returns all sums but the temperatures.
FrameSums order_and_speeds(const Snapshot& snapshot, BodyRange range);

/// Returns the bodies of a range as a system.
System part_of(const System& system, BodyRange range);

/// Returns the temperatures alone, from the energies of the bodies; NaN where there are no degrees of freedom.
FrameSums temperatures(const KineticState& kinetic, const Freedoms& freedoms);

/// Returns 3 sum m v v^T / sum m v^2: the tensor of the ideal gas' share of the pressure, of trace 3.
Eigen::Matrix3d kinetic_tensor(const System& system);

/// Returns Q = 3/2 <u u^T> - 1/2.
Eigen::Matrix3d order_tensor(const std::vector<Eigen::Vector3d>& axes, std::size_t begin, std::size_t end);
/// Returns Q of the bodies of several ranges together.
Eigen::Matrix3d order_tensor(const std::vector<Eigen::Vector3d>& axes, const std::vector<BodyRange>& ranges);
double largest_eigenvalue(const Eigen::Matrix3d& Q);
/// Returns the eigenvector of the largest eigenvalue, with the sign that makes its largest component positive.
Eigen::Vector3d director_of(const Eigen::Matrix3d& Q);
/// Returns the director of a frame, that of all bodies.
Eigen::Vector3d director_of(const Snapshot& snapshot);

}  // namespace ed::internal
