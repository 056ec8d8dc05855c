#include "shapes/format.h"

#include <geom/ellipsoid.h>
#include <geom/kernel/refuse.h>
#include <geom/superellipsoid.h>
#include <geom/tolerances.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace geom {
namespace {

using Eigen::Vector3d;

[[noreturn]] void refuse(const std::string& what, double value, double least, double most) {
  kernel::refuse("Superellipsoid: " + what + " is " + kernel::shown(value) + "; accepted: " + kernel::shown(least) +
                 " to " + kernel::shown(most));
}

void check(const Vector3d& axes, double e1, double e2) {
  for (int k = 0; k < 3; ++k) {
    if (!(axes[k] >= kMinSemiAxis && axes[k] <= kMaxSemiAxis)) {
      refuse(std::string("semi-axis ") + "xyz"[k], axes[k], kMinSemiAxis, kMaxSemiAxis);
    }
  }
  const double ratio = axes.maxCoeff() / axes.minCoeff();
  if (!(ratio <= kMaxAspectRatio)) refuse("ratio of the largest to the smallest semi-axis", ratio, 1, kMaxAspectRatio);
  if (!(e1 >= kMinExponent && e1 <= kMaxExponent)) refuse("exponent e1", e1, kMinExponent, kMaxExponent);
  if (!(e2 >= kMinExponent && e2 <= kMaxExponent)) refuse("exponent e2", e2, kMinExponent, kMaxExponent);
}

kernel::NestedNorm checked_norm(const Vector3d& axes, double e1, double e2) {
  check(axes, e1, e2);
  return {2 / e1, 2 / e2};
}

/// Returns (u^s + v^s)^(1/s); s = infinity: the maximum.
double plane_norm(double u, double v, double s) {
  const double larger = std::max(u, v);
  if (!std::isfinite(s)) return larger;
  return larger * std::pow(1 + std::pow(std::min(u, v) / larger, s), 1 / s);
}

/// Returns the largest sqrt(sum of k_i x_i^2) over N(x) <= 1, N nested with exponents p1, p2. The sum is linear in
/// x_i^2. For p >= 2, N^2 is a norm of the x_i^2 with half the exponents, whose dual gives the maximum; for p < 2 it is
/// not convex, and the maximum is at a corner.
double largest(const Vector3d& k, double p1, double p2) {
  const auto dual = [](double p) { return p > 2 ? p / (p - 2) : std::numeric_limits<double>::infinity(); };
  return std::sqrt(plane_norm(plane_norm(k.x(), k.y(), dual(p2)), k.z(), dual(p1)));
}

/// Returns a lower bound of all radii of curvature of a superellipsoid whose exponents are at most 1; `R`: its bounding
/// radius, `section`: that of its section across z.
///
/// The radii at the normal n are the values of v.H v, H = hess h(n), for unit v across n. The support function is h(n)
/// = M(u), u = (a n_x, b n_y, c n_z), with M the nested norm of exponents q1 = 2 / (2 - e1), q2 = 2 / (2 - e2), both
/// within (1, 2].
///
/// Since H n = 0, v may be replaced by w = v + t n, which is no shorter, with t chosen so that grad h.w = 0. Then
/// h w.H w = w.hess(h^2 / 2) w. Let W = (a w_x, b w_y, c w_z), m the norm of (u_x, u_y), and primes derivatives along
/// w. For norms of powers
///
///     m m'' = (q2 - 1) (S - m'^2),   S = m^(2 - q2) (|u_x|^(q2 - 2) W_x^2 + |u_y|^(q2 - 2) W_y^2),
///     w.hess(M^2 / 2) w = (2 - q1) M'^2 + (q1 - 1) M^(2 - q1) (m^(q1 - 2) m'^2 + |u_z|^(q1 - 2) W_z^2)
///                         + M^(2 - q1) m^(q1 - 2) m m'',
///
/// S >= m'^2 by Cauchy and Schwarz, and M' = grad h.w = 0. With k = min(q1, q2) - 1 therefore
///
///     v.H v >= M^(1 - q1) (k m^(q1 - 2) S + (q1 - 1) |u_z|^(q1 - 2) W_z^2).                                       (1)
///
/// Here |u_x| <= a, |u_y| <= b, |u_z| <= c, M <= R, |u_x| and |u_y| <= m <= `section`. The coefficient of w_z^2 is at
/// least `along`; that of w_x^2, k M^(1 - q1) m^(q1 - q2) |u_x|^(q2 - 2) a^2, is at least k a (a / R)^(q1 - 1) if q1 >=
/// q2 (by m >= |u_x|), else as much times (a / section)^(q2 - q1); that of w_y^2 likewise: `across`, a now the smaller
/// of a and b. Since |w| >= 1, the smallest of the three bounds v.H v.
///
/// A second bound uses that n and v are normal to each other. With k in place of q1 - 1, the sum (1) is w.D w with D n
/// along grad h, hence D-normal to w: w.D w is at least 1 / (the largest v.D^-1 v of unit v across n). By the steps
/// above, D^-1 has elements of at most |n_i|^(2 - Q) / d_i, Q = max(q1, q2), d_i >= d = min(k / (q1 - 1) along,
/// across). The function x^(1 - Q / 2) is concave, and sum n_i^2 v_i^2 <= 1/2: with m = n x v it is at most sum (n_i^2
/// + v_i^2)^2 / 4 = sum (1 - m_i^2)^2 / 4 = (1 + sum m_i^4) / 4. By Jensen's inequality, v.D^-1 v <= (1/2)^(1 - Q / 2)
/// / d.
double curvature_bound(const Vector3d& axes, double R, double section, double e1, double e2) {
  const double q1 = 2 / (2 - e1);
  const double q2 = 2 / (2 - e2);
  const double k = std::min(q1, q2) - 1;
  const double a = std::min(axes.x(), axes.y());
  const double along = (q1 - 1) * axes.z() * std::pow(axes.z() / R, q1 - 1);
  const double across = k * a * std::pow(a / R, q1 - 1) * std::pow(a / section, std::max(0.0, q2 - q1));
  const double sharper = std::pow(2, 1 - 0.5 * std::max(q1, q2)) * std::min(k / (q1 - 1) * along, across);
  return std::max(std::min(along, across), sharper);
}

}  // namespace

Superellipsoid::Superellipsoid(const Vector3d& semi_axes, double e1, double e2)
    : semi_axes_(semi_axes),
      e1_(e1),
      e2_(e2),
      norm_(checked_norm(semi_axes, e1, e2)),
      dual_(2 / (2 - e1), 2 / (2 - e2)) {
  if (is_ellipsoid()) {
    bounding_radius_ = semi_axes.maxCoeff();
    inscribed_radius_ = semi_axes.minCoeff();
    min_curvature_radius_ = inscribed_radius_ * (inscribed_radius_ / bounding_radius_);
    return;
  }
  // Scaled, so that squares neither underflow nor overflow. |n|^2 is largest, for given h(n), where h is smallest for
  // unit n.
  const double size = semi_axes.maxCoeff();
  const Vector3d squares = (semi_axes / size).cwiseAbs2();
  bounding_radius_ = size * largest(squares, 2 / e1, 2 / e2);
  inscribed_radius_ = size / largest(squares.cwiseInverse(), 2 / (2 - e1), 2 / (2 - e2));
  const double section = size * largest({squares.x(), squares.y(), 0}, 2 / e1, 2 / e2);
  min_curvature_radius_ = has_vertices() ? 0 : curvature_bound(semi_axes, bounding_radius_, section, e1, e2);
}

double Superellipsoid::norm(const Vector3d& x) const {
  return norm_(x.cwiseQuotient(semi_axes_).cwiseAbs()).norm;
}

double Superellipsoid::value(const Vector3d& x) const {
  // The same bits as an Ellipsoid, here and below: the general norm rounds 5 ulps away.
  if (is_ellipsoid()) return x.cwiseQuotient(semi_axes_).squaredNorm() - 1;
  const double N = norm(x);
  return N * N - 1;
}

Vector3d Superellipsoid::gradient(const Vector3d& x) const {
  if (is_ellipsoid()) return 2 * x.cwiseQuotient(semi_axes_.cwiseAbs2());
  const auto at = norm_(x.cwiseQuotient(semi_axes_).cwiseAbs());
  return 2 * at.norm * at.gradient.cwiseProduct(x.cwiseSign()).cwiseQuotient(semi_axes_);
}

Eigen::Matrix3d Superellipsoid::hessian(const Vector3d& x) const {
  if (is_ellipsoid()) return Ellipsoid(semi_axes_).hessian(x);
  const Vector3d w = x.cwiseQuotient(semi_axes_).cwiseAbs();
  const auto at = norm_(w);
  // A component that is zero has either sign.
  const Vector3d scale = (x.array() < 0).select(-semi_axes_.cwiseInverse(), semi_axes_.cwiseInverse());
  const Eigen::Matrix3d H = 2 * (at.gradient * at.gradient.transpose() + at.norm * norm_.hessian(w));
  return scale.asDiagonal() * H * scale.asDiagonal();
}

Support Superellipsoid::support(const Vector3d& n) const {
  if (is_ellipsoid()) {
    const double h = semi_axes_.cwiseProduct(n).norm();
    return {h, semi_axes_.cwiseAbs2().cwiseProduct(n) / h};
  }
  const auto at = dual_(semi_axes_.cwiseProduct(n).cwiseAbs());
  return {at.norm, at.gradient.cwiseProduct(semi_axes_).cwiseProduct(n.cwiseSign())};
}

Eigen::Matrix3d Superellipsoid::support_hessian(const Vector3d& n) const {
  if (is_ellipsoid()) return Ellipsoid(semi_axes_).support_hessian(n);
  const Vector3d scale = (n.array() < 0).select(-semi_axes_, semi_axes_);
  return scale.asDiagonal() * dual_.hessian(semi_axes_.cwiseProduct(n).cwiseAbs()) * scale.asDiagonal();
}

double Superellipsoid::volume() const {
  if (is_ellipsoid()) return Ellipsoid(semi_axes_).volume();
  return 2 * semi_axes_.prod() * e1_ * e2_ * std::beta(0.5 * e1_ + 1, e1_) * std::beta(0.5 * e2_, 0.5 * e2_);
}

Vector3d Superellipsoid::inertia(double mass) const {
  if (is_ellipsoid()) return Ellipsoid(semi_axes_).inertia(mass);
  // Integrals of x^2, y^2, z^2 over the body.
  const Vector3d a2 = semi_axes_.cwiseAbs2();
  const double along = std::beta(0.5 * e2_, 0.5 * e2_) * std::beta(1.5 * e1_, e1_ + 1);
  // For one exponent all axes are treated alike, to the last bit: a superball is a spherical top.
  const double across = e1_ == e2_ ? along : 0.5 * std::beta(1.5 * e2_, 0.5 * e2_) * std::beta(0.5 * e1_, 2 * e1_ + 1);
  const Vector3d second = semi_axes_.prod() * e1_ * e2_ * Vector3d(across * a2.x(), across * a2.y(), along * a2.z());
  return mass / volume() * (Vector3d::Constant(second.sum()) - second);
}

std::optional<int> Superellipsoid::symmetry_axis() const {
  if (is_ellipsoid()) return Ellipsoid(semi_axes_).symmetry_axis();
  if (e2_ == 1 && semi_axes_.x() == semi_axes_.y()) return 2;
  return std::nullopt;
}

std::string Superellipsoid::description() const {
  std::ostringstream text;
  text << "superellipsoid " << kernel::of_semi_axes(semi_axes_) << ", exponents " << e1_ << ", " << e2_;
  return text.str();
}

}  // namespace geom
