#include "motion/free_top.h"

#include "motion/checks.h"

#include <cmath>

namespace ed::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Returns the means of the cosine and the sine over [0, x]: sin(x) / x and (1 - cos(x)) / x.
SinCos mean_turn(double x) {
  if (x == 0) return {0, 1};
  const SinCos half = turn(0.5 * x);
  const double sinc = 2 * half.sin / x;
  return {sinc * half.sin, sinc * half.cos};
}

/// Returns v rotated about the unit vector l.
[[gnu::always_inline]] inline Vector3d rotated(const Vector3d& v, const Vector3d& l, const SinCos& sc) {
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

RotatingAxis RotatingAxis::of(const Vector3d& v, const Vector3d& l) {
  const Vector3d along = inner(l, v) * l;
  return {along, v - along, l.cross(v)};
}

UniformTurn::UniformTurn(const Matrix3d& rotation, const Vector3d& omega) : omega_(omega), rate_(length(omega)) {
  const TopAxes start = polished(rotation.col(0), rotation.col(1), 1);
  const Vector3d direction = rate_ > 0 ? Vector3d(omega / rate_) : Vector3d::UnitZ();
  x_ = RotatingAxis::of(start.first, direction);
  y_ = RotatingAxis::of(start.second, direction);
}

Matrix3d UniformTurn::rotation(double tau) const {
  const SinCos sc = tau == 0 ? SinCos{0, 1} : turn(rate_ * tau);
  return matrix(polished(x_.at(sc), y_.at(sc), 1), {0, 1, 2});
}

TopBounds UniformTurn::bounds() const {
  return {kBoundMargin * rate_, 0, 0};
}

TurnedAngles UniformTurn::turned(double tau) const {
  const Vector3d x = x_.at({0, 1});
  const Vector3d y = y_.at({0, 1});
  return {tau * omega_, tau * Vector3d(inner(x, omega_), inner(y, omega_), inner(x.cross(y), omega_))};
}

// ---- Symmetric top -------------------------------------------------------------------------------------------------

SymmetricTop::SymmetricTop(int axis, const Vector3d& inertia, const Matrix3d& rotation, const Vector3d& omega)
    : axes_{axis, (axis + 1) % 3, (axis + 2) % 3}, start_(polished(rotation.col(axes_[0]), rotation.col(axes_[1]), 1)) {
  const double perpendicular = inertia[axes_[1]];
  spin_ = inner(omega, start_.first);
  across_ = {inner(omega, start_.second), inner(omega, start_.third)};
  // L / I_perp.
  const Vector3d precession =
      across_.x() * start_.second + across_.y() * start_.third + (inertia[axis] / perpendicular * spin_) * start_.first;
  precession_ = length(precession);
  l_ = precession / precession_;
  own_ = spin_ * ((perpendicular - inertia[axis]) / perpendicular);
}

/// Rotates first about u, then about l.
[[gnu::always_inline]] inline TopAxes SymmetricTop::axes_at(double tau) const {
  const SinCos about_u = turn(own_ * tau);
  const SinCos about_l = turn(precession_ * tau);
  const Vector3d x = about_u.cos * start_.second + about_u.sin * start_.third;
  return polished(rotated(start_.first, l_, about_l), rotated(x, l_, about_l), 1);
}

Matrix3d SymmetricTop::rotation(double tau) const {
  return matrix(axes_at(tau), axes_);
}

TopState SymmetricTop::at(double tau) const {
  const TopAxes now = axes_at(tau);
  return {matrix(now, axes_), precession_ * l_ + own_ * now.first, (precession_ * own_) * l_.cross(now.first)};
}

TopBounds SymmetricTop::bounds() const {
  // omega - (omega.l) l = k (u - (u.l) l) rotates about l at Omega: its length is constant. 1e-15: rounding of u.
  const double alpha = kBoundMargin * precession_ * std::abs(own_) * (length(l_.cross(start_.first)) + 1e-15);
  return {kBoundMargin * length(precession_ * l_ + own_ * start_.first), alpha, kBoundMargin * precession_ * alpha};
}

TurnedAngles SymmetricTop::turned(double tau) const {
  // omega = Omega l + k u,  u = e0 + cos(Omega tau) (u(0) - e0) + sin(Omega tau) l x u(0),  e0 = (l.u) l.
  const SinCos about_l = mean_turn(precession_ * tau);
  const Vector3d e0 = inner(l_, start_.first) * l_;
  const Vector3d u = e0 + about_l.cos * (start_.first - e0) + about_l.sin * l_.cross(start_.first);
  TurnedAngles turned{tau * (precession_ * l_ + own_ * u), {}};
  // Across the axis, omega rotates at -k in the body's frame.
  const SinCos about_u = mean_turn(own_ * tau);
  turned.body[axes_[0]] = tau * spin_;
  turned.body[axes_[1]] = tau * (about_u.cos * across_.x() + about_u.sin * across_.y());
  turned.body[axes_[2]] = tau * (about_u.cos * across_.y() - about_u.sin * across_.x());
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

TurnedAngles FreeTop::turned(double tau) const {
  return std::visit([tau](const auto& top) { return top.turned(tau); }, top_);
}

}  // namespace ed::internal
