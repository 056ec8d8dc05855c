#pragma once

/// Reference distances of ellipsoids in long double, sharing no code with the library.

#include <geom/geom.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <limits>

namespace geom_test {

static_assert(std::numeric_limits<long double>::digits >= 64, "the reference needs more digits than a double has");

using LongVector = Eigen::Matrix<long double, 3, 1>;
using LongMatrix = Eigen::Matrix<long double, 3, 3>;

struct LongDistance {
  long double distance;
  LongVector normal;
  bool converged;  ///< whether the last Newton step was rounding: distance is then accurate to about 1e-18 * size
};

/// Support of an ellipsoid in the world frame, about its centre.
class LongEllipsoid {
 public:
  LongEllipsoid(const geom::Ellipsoid& shape, const geom::Pose& X)
      : R_(X.rotation().cast<long double>()), a_(shape.semi_axes().cast<long double>()) {}

  long double height(const LongVector& n) const { return a_.cwiseProduct(R_.transpose() * n).norm(); }
  LongVector point(const LongVector& n) const {
    const LongVector n_body = R_.transpose() * n;
    return R_ * LongVector(a_.cwiseAbs2().cwiseProduct(n_body) / height(n));
  }
  /// Returns (hess h) v = (Q v - (s.v) s) / h.
  LongVector curve(const LongVector& n, const LongVector& v) const {
    const LongVector s = point(n);
    const LongVector Qv = R_ * LongVector(a_.cwiseAbs2().cwiseProduct(R_.transpose() * v));
    return (Qv - s.dot(v) * s) / height(n);
  }

 private:
  LongMatrix R_;
  LongVector a_;
};

/// Finds a stationary point of g(n) = n.p_AB - hA(n) - hB(-n) near `start` by Newton's method.
///
/// It is the distance if g > 0 there, or if -g is at most the sum of both smallest radii of curvature. There are no
/// safeguards: `start` must be close, and `converged` reports whether it was.
inline LongDistance long_distance(const geom::Ellipsoid& a, const geom::Pose& X_WA, const geom::Ellipsoid& b,
                                  const geom::Pose& X_WB, const Eigen::Vector3d& start) {
  const LongEllipsoid A(a, X_WA);
  const LongEllipsoid B(b, X_WB);
  const LongVector p_AB = X_WB.position().cast<long double>() - X_WA.position().cast<long double>();
  LongVector n = start.cast<long double>().normalized();
  bool converged = false;
  for (int iteration = 0; iteration < 12 && !converged; ++iteration) {
    const long double g = n.dot(p_AB) - A.height(n) - B.height(-n);
    const LongVector y = p_AB - A.point(n) + B.point(-n);
    const LongVector e = n.unitOrthogonal();
    const LongVector f = n.cross(e);
    const LongVector He = A.curve(n, e) + B.curve(-n, e);
    const LongVector Hf = A.curve(n, f) + B.curve(-n, f);
    const long double m_ee = e.dot(He) + g;
    const long double m_ff = f.dot(Hf) + g;
    const long double m_ef = e.dot(Hf);
    const long double det = m_ee * m_ff - m_ef * m_ef;
    const long double d_e = (m_ff * e.dot(y) - m_ef * f.dot(y)) / det;
    const long double d_f = (m_ee * f.dot(y) - m_ef * e.dot(y)) / det;
    n = (n + d_e * e + d_f * f).normalized();
    // The error after this step is its square times about the aspect ratio, and the error of g is that squared.
    converged = std::hypot(d_e, d_f) < 1e-8L;
  }
  return {n.dot(p_AB) - A.height(n) - B.height(-n), n, converged};
}

}  // namespace geom_test
