#pragma once

/// Free rotation by integration, the reference for the closed forms: Taylor series of order 26 in long double.

#include <Eigen/Core>

#include <array>
#include <cmath>

namespace finder_test {

class IntegratedTop {
 public:
  using Real = long double;
  using Vector = Eigen::Matrix<Real, 3, 1>;
  using Matrix = Eigen::Matrix<Real, 3, 3>;

  IntegratedTop(const Eigen::Vector3d& inertia, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& omega_world)
      : inertia_(inertia.cast<Real>()), rotation_(rotation.cast<Real>()) {
    omega_ = rotation_.transpose() * omega_world.cast<Real>();
    // |omega| never exceeds this: 2 E = sum I omega^2.
    fastest_ = std::sqrt(omega_.dot(inertia_.cwiseProduct(omega_)) / inertia_.minCoeff());
  }

  /// Advances by t. The series of a top converges within about 1.5 / |omega|; a sixth of that is a step.
  void advance(double t) {
    const auto whole = static_cast<Real>(t);
    const auto steps = static_cast<int>(std::ceil(4 * fastest_ * std::abs(whole)));
    for (int k = 0; k < steps; ++k) step(whole / static_cast<Real>(steps));
  }

  const Matrix& rotation() const { return rotation_; }  ///< body to world
  Vector omega() const { return rotation_ * omega_; }   ///< angular velocity, world frame
  const Vector& turned_world() const { return turned_world_; }
  const Vector& turned_body() const { return turned_body_; }

 private:
  static constexpr int kOrder = 26;

  static Vector cross(const Vector& a, const Vector& b) {
    return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
  }

  void step(Real h) {
    std::array<Vector, kOrder + 1> w;                 // omega, body frame
    std::array<std::array<Vector, 3>, kOrder + 1> r;  // rows of R: r' = r x omega
    w[0] = omega_;
    for (int row = 0; row < 3; ++row) r[0][row] = rotation_.row(row).transpose();
    for (int n = 0; n < kOrder; ++n) {
      Vector torque = Vector::Zero();
      std::array<Vector, 3> turn{Vector::Zero(), Vector::Zero(), Vector::Zero()};
      for (int k = 0; k <= n; ++k) {
        torque += cross(inertia_.cwiseProduct(w[k]), w[n - k]);
        for (int row = 0; row < 3; ++row) turn[row] += cross(r[k][row], w[n - k]);
      }
      w[n + 1] = torque.cwiseQuotient(inertia_) / static_cast<Real>(n + 1);
      for (int row = 0; row < 3; ++row) r[n + 1][row] = turn[row] / static_cast<Real>(n + 1);
    }
    Real power = h;
    for (int n = 0; n < kOrder; ++n, power *= h) {
      turned_body_ += power / static_cast<Real>(n + 1) * w[n];
      for (int row = 0; row < 3; ++row) {
        Real rate = 0;
        for (int k = 0; k <= n; ++k) rate += r[k][row].dot(w[n - k]);
        turned_world_[row] += power / static_cast<Real>(n + 1) * rate;
      }
    }
    omega_ = w[kOrder];
    std::array<Vector, 3> rows = r[kOrder];
    for (int n = kOrder - 1; n >= 0; --n) {
      omega_ = w[n] + h * omega_;
      for (int row = 0; row < 3; ++row) rows[row] = r[n][row] + h * rows[row];
    }
    for (int row = 0; row < 3; ++row) rotation_.row(row) = rows[row].transpose();
  }

  Vector inertia_;
  Matrix rotation_;
  Vector omega_;  // body frame
  Vector turned_world_ = Vector::Zero();
  Vector turned_body_ = Vector::Zero();
  Real fastest_;
};

}  // namespace finder_test
