#include "derivatives/stationary.h"

#include <geom/derivatives.h>
#include <geom/kernel/dual_newton.h>
#include <geom/tolerances.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace geom {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const char* to_string(DerivativeStatus status) {
  switch (status) {
    case DerivativeStatus::twice:
      return "twice";
    case DerivativeStatus::once:
      return "once";
    case DerivativeStatus::by_position:
      return "by_position";
    case DerivativeStatus::none:
      return "none";
    case DerivativeStatus::no_distance:
      return "no_distance";
  }
  return "?";
}

namespace kernel {
namespace {

/// Rows across the normal and columns of x.
using Rows = Eigen::Matrix<double, 2, 12>;

constexpr int kTurnA = 3, kMoveB = 6, kTurnB = 9;  // columns of x where a block begins

Matrix3d cross_matrix(const Vector3d& v) {
  return (Matrix3d() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
}

double size_of(const ContactBody& a, const ContactBody& b) {
  return a.bounding_radius + b.bounding_radius;
}

bool answered(const DistanceResult& at) {
  return at.status == DistanceStatus::separated || at.status == DistanceStatus::overlapping;
}

/// Returns the support of a body along a unit vector, above its centre; a half-space has one along its normal only.
double height(const ContactBody& body, const Vector3d& n) {
  const Vector3d n_S = body.X_WS.rotation().transpose() * n;
  const double offset = n.dot(body.X_WS.position() - body.centre);
  if (body.plane != nullptr) {
    const bool along = (n_S - body.plane->normal()).norm() <= kPoseTolerance;
    return along ? body.plane->offset() + offset : std::numeric_limits<double>::infinity();
  }
  const double inner =
      body.core ? swept_support(*body.core, n_S).height : static_cast<double>(body.support(body.shape, n_S).height);
  return inner + body.skin + offset;
}

/// Returns whether an answer may be one for these bodies: along its normal they are as far apart as it says, and so are
/// its points.
bool is_of_pair(const ContactBody& a, const ContactBody& b, const DistanceResult& at) {
  constexpr double kLoose = 1e-6;  // of the size, and of coordinates: answers of lower accuracy do no harm
  const Vector3d& n = at.normal;
  if (!answered(at) || !(std::abs(n.norm() - 1) <= kPoseTolerance)) return false;
  const double reach = std::max(at.point_a.cwiseAbs().maxCoeff(), at.point_b.cwiseAbs().maxCoeff());
  const double loose = kLoose * size_of(a, b) + 1e-14 * reach;
  const double bound = std::isfinite(at.error_bound) ? 2 * at.error_bound : 0;
  const double between = n.dot(b.centre - a.centre) - height(a, n) - height(b, -n);
  return (at.point_b - at.point_a - at.distance * n).norm() <= loose + bound &&
         std::abs(between - at.distance) <= loose + bound;
}

void set_gradient(DistanceDerivatives& out, const Vector3d& n, const Vector3d& s_a, const Vector3d& s_b) {
  out.gradient << -n, n.cross(s_a), n, s_b.cross(n);
}

/// Second derivatives of the distance at its optimum, and how normal and points move.
///
/// With w the turn of the normal in the plane across it, u = theta x n the turns of the bodies there, and y the
/// relative motion of the points that are fixed in the bodies, the distance is to second order the stationary value of
///
///     w'y - (w - u_A)'H_A (w - u_A) / 2 - (w - u_B)'H_B (w - u_B) / 2 - d w'w / 2 + q(theta_A, theta_B)
///
/// subject to g'(w - u) = 0 for each direction g in which a body's point is free. The form q is of the points fixed in
/// the bodies alone. The unknown is v = w - u of the body with more free directions, or else with more curvature
/// radius, the first body: its large Hessian then multiplies v only, which is small, so that flat bodies lose no
/// digits. Evaluating this form at the solution makes its error second order in that of v.
class SecondDerivatives {
 public:
  explicit SecondDerivatives(const StationaryPair& pair) : p_(pair), T_(pair.tangent()) {}

  void write(DistanceDerivatives& out) {
    set_motions();
    set_turn();
    set_slides();
    const Vector3d& n = p_.n;
    const Rows rest_a = w_ - u_a_;
    const Rows rest_b = w_ - u_b_;
    const Rows half = y_ - 0.5 * p_.distance * w_;
    PoseHessian H = w_.transpose() * half + half.transpose() * w_;
    H -= rest_a.transpose() * p_.H_a * rest_a + rest_b.transpose() * p_.H_b * rest_b;
    H.block<3, 3>(kTurnA, kTurnA) -= of_fixed_point(n, p_.a.x);
    H.block<3, 3>(kTurnB, kTurnB) += of_fixed_point(n, p_.b.x);
    out.hessian = 0.5 * (H + H.transpose());
    out.normal = T_ * w_;
    out.point_a = point_jacobian(0, p_.a.x, slide_a_);
    out.point_b = point_jacobian(kMoveB, p_.b.x, slide_b_);
  }

 private:
  /// Returns the second derivative of n.exp(theta) s.
  static Matrix3d of_fixed_point(const Vector3d& n, const Vector3d& s) {
    return 0.5 * (s * n.transpose() + n * s.transpose()) - s.dot(n) * Matrix3d::Identity();
  }

  void set_motions() {
    const Eigen::Matrix<double, 2, 3> Tt = T_.transpose();
    const Eigen::Matrix<double, 2, 3> turn = -Tt * cross_matrix(p_.n);
    y_ << -Tt, Tt * cross_matrix(p_.a.x), Tt, -Tt * cross_matrix(p_.b.x);
    u_a_.setZero();
    u_b_.setZero();
    u_a_.middleCols<3>(kTurnA) = turn;
    u_b_.middleCols<3>(kTurnB) = turn;
  }

  void set_turn() {
    const bool first_is_a = p_.first_is_a();
    const Rows& u = first_is_a ? u_a_ : u_b_;
    const Rows delta = (first_is_a ? u_b_ : u_a_) - u;
    const Eigen::Matrix2d& H_other = first_is_a ? p_.H_b : p_.H_a;
    Eigen::Matrix<double, 2, 12> slides = Rows::Zero();
    const std::size_t other = first_is_a ? 1 : 0;
    for (std::size_t k = 0; k < p_.count; ++k) {
      if (p_.owner[k] == other)
        slides.row(static_cast<Eigen::Index>(k)) = p_.G.col(static_cast<Eigen::Index>(k)).transpose() * delta;
    }
    w_ = u + p_.turn<12>(y_ + H_other * delta - p_.distance * u, slides);
  }

  /// Sets how the points move across the normal, seen from their bodies: by turns of the normal, and along free
  /// directions so that the points stay opposite to each other.
  void set_slides() {
    slide_a_ = p_.H_a * (w_ - u_a_);
    slide_b_ = -p_.H_b * (w_ - u_b_);
    const Rows apart = y_ - p_.distance * w_;
    if (p_.count == 2 && p_.owner[0] != p_.owner[1]) {
      const Rows t = p_.G.inverse() * (apart + slide_b_ - slide_a_);
      slide_a_ += p_.G.col(0) * t.row(0);
      slide_b_ -= p_.G.col(1) * t.row(1);
    } else if (p_.first_is_a()) {
      slide_a_ = apart + slide_b_;
    } else {
      slide_b_ = slide_a_ - apart;
    }
  }

  PoseJacobian point_jacobian(int column, const Vector3d& s, const Rows& slide) const {
    PoseJacobian J = T_ * slide;
    J.middleCols<3>(column) += Matrix3d::Identity();
    J.middleCols<3>(column + 3) -= cross_matrix(s);
    return J;
  }

  const StationaryPair& p_;
  Eigen::Matrix<double, 3, 2> T_;
  Rows y_, u_a_, u_b_, w_, slide_a_, slide_b_;
};

/// Returns what is left where second derivatives do not exist, or are not certain to.
DistanceDerivatives without_features(const ContactBody& a, const ContactBody& b, const DistanceResult& at,
                                     const ContactPoints& points, bool single) {
  DistanceDerivatives out;
  out.status = DerivativeStatus::none;
  const double size = size_of(a, b);
  const bool apart = at.distance > -(a.curvature_radius + b.curvature_radius) + kLeastStiffness * size;
  if (!apart && !single) return out;
  set_gradient(out, at.normal, points.a, points.b);
  out.status = DerivativeStatus::once;
  if (apart && points_are_single(a, b, at.normal, points, size)) return out;
  out.status = DerivativeStatus::by_position;
  out.gradient.segment<3>(kTurnA).setConstant(std::numeric_limits<double>::quiet_NaN());
  out.gradient.segment<3>(kTurnB).setConstant(std::numeric_limits<double>::quiet_NaN());
  return out;
}

}  // namespace

namespace {

/// Returns the Hessian of a body at a normal that is turned by `by`.
Matrix3d hessian_beside(const ContactBody& body, const LocalContact& at, const Vector3d& n, const Vector3d& by) {
  if (body.core || body.plane != nullptr) return at.H;
  const Matrix3d& R = body.X_WS.rotation();
  const Vector3d beside = R.transpose() * (n + by), here = R.transpose() * n;
  return at.H + R * (body.hessian(body.shape, beside) - body.hessian(body.shape, here)) * R.transpose();
}

/// Returns whether second derivatives are nearly those at normals beside this one. Others are infinite: on a flat face
/// of a superellipsoid the Hessian of the support function is that of a point nearby.
bool are_settled(const ContactBody& a, const ContactBody& b, const StationaryPair& pair,
                 const DistanceDerivatives& out) {
  constexpr double kTurn = 1e-9;
  constexpr double kMostChange = 1e-3;
  const Eigen::Matrix<double, 3, 2> T = pair.tangent();
  const auto nearly = [](const auto& moved, const auto& here) {
    return (moved - here).norm() <= kMostChange * here.norm();
  };
  for (const Vector3d& way : {pair.e, pair.f}) {
    const Matrix3d H_a = hessian_beside(a, pair.a, pair.n, kTurn * way);
    const Matrix3d H_b = hessian_beside(b, pair.b, -pair.n, kTurn * way);
    if (nearly(H_a, pair.a.H) && nearly(H_b, pair.b.H)) continue;
    StationaryPair beside = pair;
    beside.H_a = T.transpose() * H_a * T;
    beside.H_b = T.transpose() * H_b * T;
    beside.W = beside.H_a + beside.H_b + pair.distance * Eigen::Matrix2d::Identity();
    DistanceDerivatives moved;
    SecondDerivatives(beside).write(moved);
    if (!nearly(moved.hessian, out.hessian) || !nearly(moved.point_a, out.point_a) ||
        !nearly(moved.point_b, out.point_b)) {
      return false;
    }
  }
  return true;
}

}  // namespace

RivalTrial rival_trial(const ContactBody& a, const ContactBody& b, const DistanceResult& at) {
  const double size = size_of(a, b);
  RivalTrial trial;
  const bool deep = at.distance <= -(a.curvature_radius + b.curvature_radius) + kLeastStiffness * size;
  if (!answered(at) || !deep || !std::isfinite(at.error_bound)) return trial;
  // Of the size: both depths of a search, each certain to 1e-9 of it, have to be small beside the trial (confirms).
  constexpr double kLeastTrial = 5e-6;
  constexpr double kTrialErrors = 1e4;
  trial.needed = true;
  trial.length = std::max(kLeastTrial * size, kTrialErrors * at.error_bound);
  trial.by = -trial.length * at.normal;
  // Moved bodies are at coordinates that are rounded.
  const double reach = a.centre.cwiseAbs().maxCoeff() + b.centre.cwiseAbs().maxCoeff() + size;
  trial.rounding = 8 * std::numeric_limits<double>::epsilon() * reach;
  return trial;
}

bool confirms(const RivalTrial& trial, const DistanceResult& at, const DistanceResult& moved) {
  // A normal as good, at an angle phi to this one, would lose the length times cos(phi) only: more is left by
  // length phi^2 / 2. Errors below that of 0.03 radian are small enough to tell.
  constexpr double kMostErrors = 5e-4;
  const double errors = at.error_bound + moved.error_bound + trial.rounding;
  const double more = moved.distance - (at.distance - trial.length);
  return answered(moved) && errors <= kMostErrors * trial.length && more <= errors;
}

DistanceDerivatives contact_derivatives(const ContactBody& a, const ContactBody& b, const DistanceResult& at,
                                        bool single) {
  DistanceDerivatives out;
  if (!is_of_pair(a, b, at)) return out;
  const ContactPoints points{at.point_a - a.centre, at.point_b - b.centre};
  const std::optional<StationaryPair> pair = stationary_pair(a, b, at, points);
  if (!pair) return without_features(a, b, at, points, single);
  out.stiffness = pair->stiffness;
  if (!single || !(pair->stiffness > kLeastStiffness * size_of(a, b))) {
    out.status = DerivativeStatus::none;
    return out;
  }
  set_gradient(out, pair->n, pair->a.x, pair->b.x);
  SecondDerivatives(*pair).write(out);
  out.status = DerivativeStatus::twice;
  if (out.hessian.allFinite() && pair->curved && are_settled(a, b, *pair, out)) return out;
  out.status = DerivativeStatus::once;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  out.hessian.setConstant(nan);
  out.normal.setConstant(nan);
  out.point_a.setConstant(nan);
  out.point_b.setConstant(nan);
  return out;
}

}  // namespace kernel
}  // namespace geom
