#pragma once

/// Results of all kinds of free tops; see free_top.h.

#include "base/archive.h"
#include "base/sincos.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace ed::internal {

/// State of the rotation at an instant.
struct TopState {
  Eigen::Matrix3d R;      ///< body to world, orthonormal to 1e-15
  Eigen::Vector3d omega;  ///< angular velocity, world frame
  Eigen::Vector3d alpha;  ///< d omega / dt, world frame
};

/// Integrals of omega over [0, tau], from which rotational displacements are computed.
struct TurnedAngles {
  Eigen::Vector3d world = Eigen::Vector3d::Zero();  ///< integral in the world frame
  Eigen::Vector3d body = Eigen::Vector3d::Zero();   ///< integral of the components along the body's axes
};

template <class Archive, Is<TurnedAngles> T>
void fields(Archive& archive, T& angles) {
  archive(angles.world, angles.body);
  expect(archive, angles.world.allFinite() && angles.body.allFinite(), "an angle is not finite");
}

/// Upper bounds over all times.
struct TopBounds {
  double omega = 0;  ///< bound of |omega|
  double alpha = 0;  ///< bound of |d omega/dt|
  double jerk = 0;   ///< bound of |d2 omega/dt2|, world frame
};

template <class Archive, Is<TopBounds> T>
void fields(Archive& archive, T& bounds) {
  archive(bounds.omega, bounds.alpha, bounds.jerk);
}

/// Factor that makes the bounds, which are exact maxima, cover the rounding errors of states, some units in the last
/// place.
inline constexpr double kBoundMargin = 1 + 1e-14;

/// Returns sine and cosine of any angle, reduced to the range of sincos first. remainder is exact on every processor,
/// and the rounding of 2 pi adds 4e-17 of the angle, below its own rounding.
inline SinCos turn(double angle) {
  constexpr double kTwoPi = 6.283185307179586477;
  if (std::abs(angle) > 1e6) [[unlikely]]
    angle = std::remainder(angle, kTwoPi);
  return sincos(angle);
}

// Eigen's own products and sums depend on the instruction set: in their order, and in fusing multiplications with
// additions. The following functions do not.

inline double inner(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
}

inline Eigen::Vector3d product(const Eigen::Matrix3d& m, const Eigen::Vector3d& v) {
  return v.x() * m.col(0) + v.y() * m.col(1) + v.z() * m.col(2);
}

inline Eigen::Vector3d transposed_product(const Eigen::Matrix3d& m, const Eigen::Vector3d& v) {
  return {inner(m.col(0), v), inner(m.col(1), v), inner(m.col(2), v)};
}

/// Returns |v|, also for very large or small v.
inline double length(const Eigen::Vector3d& v) {
  const double largest = v.cwiseAbs().maxCoeff();
  return largest > 0 ? largest * std::sqrt(inner(v / largest, v / largest)) : 0;
}

// Inlined, so that these small structs stay in registers: stored in halves and loaded as vectors, they would cause
// stalls.

/// Three body axes in the world frame (or in another one).
struct TopAxes {
  Eigen::Vector3d first, second, third;
};

template <class Archive, Is<TopAxes> T>
void fields(Archive& archive, T& axes) {
  archive(axes.first, axes.second, axes.third);
}

/// Returns whether these are 0, 1 and 2 in some order.
inline bool are_axes(const std::array<int, 3>& numbers) {
  std::array<int, 3> sorted = numbers;
  std::sort(sorted.begin(), sorted.end());
  return sorted == std::array<int, 3>{0, 1, 2};
}

/// Returns u and x, which are unit and orthogonal to 1e-8, orthonormalised to rounding (Gram and Schmidt; one step of
/// Newton's method for the lengths), and u x x, or its opposite if orientation is -1.
[[gnu::always_inline]] inline TopAxes polished(Eigen::Vector3d u, Eigen::Vector3d x, double orientation) {
  u += (0.5 * (1 - inner(u, u))) * u;
  x -= inner(u, x) * u;
  x += (0.5 * (1 - inner(x, x))) * x;
  return {u, x, orientation * u.cross(x)};
}

/// Returns the rotation matrix that has these axes as its columns number numbers[0], numbers[1], numbers[2].
[[gnu::always_inline]] inline Eigen::Matrix3d matrix(const TopAxes& axes, const std::array<int, 3>& numbers) {
  Eigen::Matrix3d R;
  R.col(numbers[0]) = axes.first;
  R.col(numbers[1]) = axes.second;
  R.col(numbers[2]) = axes.third;
  return R;
}

}  // namespace ed::internal
