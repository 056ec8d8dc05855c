#include "free_top.h"

#include "motion_checks.h"

#include <cmath>

namespace ed::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Means of the cosine and the sine over [0, x]: sin(x) / x and (1 - cos(x)) / x.
SinCos mean_turn(double x) {
  if (x == 0) return {0, 1};
  const SinCos half = turn(0.5 * x);
  const double sinc = 2 * half.sin / x;
  return {sinc * half.sin, sinc * half.cos};
}

/// v turned about the unit vector l.
Vector3d rotated(const Vector3d& v, const Vector3d& l, const SinCos& sc) {
  return sc.cos * v + sc.sin * l.cross(v) + ((1 - sc.cos) * inner(l, v)) * l;
}

std::variant<UniformTurn, SymmetricTop, AsymmetricTop> make_top(const Vector3d& inertia, const Matrix3d& rotation,
                                                                const Vector3d& omega) {
  const int axis = symmetry_axis_of_inertia(inertia);
  if (axis < 0) {
    if (const auto top = AsymmetricTop::make(inertia, rotation, omega)) return *top;
    return UniformTurn(rotation, omega);
  }
  if (inertia[axis] == inertia[(axis + 1) % 3] || omega.isZero(0)) return UniformTurn(rotation, omega);
  return SymmetricTop(axis, inertia, rotation, omega);
}

}  // namespace

// ---- Constant angular velocity -------------------------------------------------------------------------------------

UniformTurn::UniformTurn(const Matrix3d& rotation, const Vector3d& omega)
    : start_(frame(2, rotation.col(2), rotation.col(0))),
      omega_(omega),
      direction_(omega.isZero(0) ? Vector3d::UnitZ() : Vector3d(omega / length(omega))),
      rate_(length(omega)) {}

Matrix3d UniformTurn::rotation(double tau) const {
  const SinCos sc = turn(rate_ * tau);
  return frame(2, rotated(start_.col(2), direction_, sc), rotated(start_.col(0), direction_, sc));
}

TopState UniformTurn::at(double tau) const {
  return {rotation(tau), omega_, Vector3d::Zero()};
}

TopBounds UniformTurn::bounds() const {
  return {kBoundMargin * rate_, 0, 0};
}

Vector3d UniformTurn::turned_world(double tau) const {
  return tau * omega_;
}

Vector3d UniformTurn::turned_body(double tau) const {
  return tau * transposed_product(start_, omega_);
}

// ---- Symmetric top -------------------------------------------------------------------------------------------------

SymmetricTop::SymmetricTop(int axis, const Vector3d& inertia, const Matrix3d& rotation, const Vector3d& omega)
    : axis_(axis) {
  const Matrix3d R = frame(axis, rotation.col(axis), rotation.col((axis + 1) % 3));
  u_ = R.col(axis);
  x_ = R.col((axis + 1) % 3);
  y_ = R.col((axis + 2) % 3);
  const double perpendicular = inertia[(axis + 1) % 3];
  spin_ = inner(omega, u_);
  across_ = {inner(omega, x_), inner(omega, y_)};
  // L / I_perp.
  const Vector3d turning = across_.x() * x_ + across_.y() * y_ + (inertia[axis] / perpendicular * spin_) * u_;
  precession_ = length(turning);
  l_ = turning / precession_;
  own_ = spin_ * ((perpendicular - inertia[axis]) / perpendicular);
}

Matrix3d SymmetricTop::rotation(double tau) const {
  const SinCos about_u = turn(own_ * tau);
  const SinCos about_l = turn(precession_ * tau);
  return frame(axis_, rotated(u_, l_, about_l), rotated(about_u.cos * x_ + about_u.sin * y_, l_, about_l));
}

TopState SymmetricTop::at(double tau) const {
  TopState state;
  state.R = rotation(tau);
  const Vector3d now = state.R.col(axis_);
  state.omega = precession_ * l_ + own_ * now;
  state.alpha = (precession_ * own_) * l_.cross(now);
  return state;
}

TopBounds SymmetricTop::bounds() const {
  // omega - (omega.l) l = k (u - (u.l) l) turns about l at Omega: the same lengths at all times. 1e-15: rounding of u.
  const double alpha = kBoundMargin * precession_ * std::abs(own_) * (length(l_.cross(u_)) + 1e-15);
  return {kBoundMargin * length(precession_ * l_ + own_ * u_), alpha, kBoundMargin * precession_ * alpha};
}

Vector3d SymmetricTop::turned_world(double tau) const {
  // omega = Omega l + k u,  u = e0 + cos(Omega tau) (u(0) - e0) + sin(Omega tau) l x u(0),  e0 = (l.u) l.
  const SinCos mean = mean_turn(precession_ * tau);
  const Vector3d e0 = inner(l_, u_) * l_;
  return tau * (precession_ * l_ + own_ * (e0 + mean.cos * (u_ - e0) + mean.sin * l_.cross(u_)));
}

Vector3d SymmetricTop::turned_body(double tau) const {
  // Across the axis, omega turns at -k in the body's frame.
  const SinCos mean = mean_turn(own_ * tau);
  Vector3d turned;
  turned[axis_] = tau * spin_;
  turned[(axis_ + 1) % 3] = tau * (mean.cos * across_.x() + mean.sin * across_.y());
  turned[(axis_ + 2) % 3] = tau * (mean.cos * across_.y() - mean.sin * across_.x());
  return turned;
}

// ---- Any top -------------------------------------------------------------------------------------------------------

FreeTop::FreeTop() : top_(UniformTurn(Matrix3d::Identity(), Vector3d::Zero())) {}

FreeTop::FreeTop(const Vector3d& inertia, const Matrix3d& rotation, const Vector3d& omega)
    : top_(make_top(inertia, rotation, omega)),
      bounds_(std::visit([](const auto& top) { return top.bounds(); }, top_)) {}

TopState FreeTop::at(double tau) const {
  return std::visit([tau](const auto& top) { return top.at(tau); }, top_);
}

Matrix3d FreeTop::rotation(double tau) const {
  return std::visit([tau](const auto& top) { return top.rotation(tau); }, top_);
}

Vector3d FreeTop::turned_world(double tau) const {
  return std::visit([tau](const auto& top) { return top.turned_world(tau); }, top_);
}

Vector3d FreeTop::turned_body(double tau) const {
  return std::visit([tau](const auto& top) { return top.turned_body(tau); }, top_);
}

}  // namespace ed::internal
