// Free tops against the textbook's solution with Boost's elliptic functions.

#include <motion/free_top.h>

#include <common/finder/ensemble.h>
#include <common/finder/free_tops.h>
#include <common/finder/top_reference.h>

#include <ed/random.h>

#include <boost/math/constants/constants.hpp>
#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/ellint_3.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace {

using ed::internal::FreeTop;
using ed::internal::TopState;
using Eigen::Vector3d;
using finder_test::log_uniform;
using free_tops::condition;
using free_tops::rate_scale;
using free_tops::Start;
using free_tops::with_rotation;

/// Direction of the body axis axis(), and the angular velocity in body axes, by the textbook's solution of Euler's
/// equations (Landau and Lifshitz, Mechanics, section 37) with Boost's elliptic functions.
class TextbookTop {
 public:
  using Real = long double;
  using Vector = Eigen::Matrix<Real, 3, 1>;

  explicit TextbookTop(const Start& start) : I_(start.inertia.cast<Real>()), R_(start.rotation.cast<Real>()) {
    std::sort(axis_.begin(), axis_.end(), [this](int a, int b) { return I_[a] < I_[b]; });
    const Vector w = R_.transpose() * start.omega.cast<Real>();
    const Real energy2 = I_.dot(w.cwiseProduct(w));
    L_ = R_ * I_.cwiseProduct(w);
    const Real L2 = L_.squaredNorm();
    // About the axis of the largest moment, or of the smallest: then the order is reversed.
    if (L2 < energy2 * I_[axis_[1]]) std::swap(axis_[0], axis_[2]);
    const auto [i, j, k] = axis_;
    const Real even = (j - i + 3) % 3 == 1 ? 1 : -1;
    a1_ = std::sqrt((energy2 * I_[k] - L2) / (I_[i] * (I_[k] - I_[i])));
    a2_ = std::sqrt((energy2 * I_[k] - L2) / (I_[j] * (I_[k] - I_[j])));
    a3_ = std::copysign(std::sqrt((L2 - energy2 * I_[i]) / (I_[k] * (I_[k] - I_[i]))), w[k]);
    // Of reversed orders (I_k < I_j < I_i) numerator and denominator are negative both.
    rate_ = std::copysign(std::sqrt((I_[k] - I_[j]) * (L2 - energy2 * I_[i]) / (I_[i] * I_[j] * I_[k])), even * w[k]);
    if (I_[k] < I_[i]) rate_ = -rate_;
    k_ = std::sqrt((I_[j] - I_[i]) * (energy2 * I_[k] - L2) / ((I_[k] - I_[j]) * (L2 - energy2 * I_[i])));
    start_ = boost::math::ellint_1(k_, std::atan2(w[j] / a2_, w[i] / a1_));
  }

  int axis() const { return axis_[2]; }

  Vector omega(Real t) const {
    Real cn = 0, dn = 0;
    const Real sn = boost::math::jacobi_elliptic(k_, reduced(t).u, &cn, &dn);
    Vector w;
    w[axis_[0]] = a1_ * cn;
    w[axis_[1]] = a2_ * sn;
    w[axis_[2]] = a3_ * dn;
    return w;
  }

  /// The direction of axis() in the world: it turns about the angular momentum.
  Vector direction(Real t) const {
    const Vector z = L_.normalized();
    const Vector e = R_.col(axis());
    const Vector x = (e - e.dot(z) * z).normalized();
    const auto [i, j, k] = axis_;
    const Real n = -I_[k] * (I_[j] - I_[i]) / (I_[i] * (I_[k] - I_[j]));
    const Real turned =
        L_.norm() *
        (t / I_[k] + (I_[k] - I_[i]) / (I_[i] * I_[k] * rate_) *
                         (boost::math::ellint_3(k_, n, amplitude(t)) - boost::math::ellint_3(k_, n, amplitude(0))));
    const Real c = I_[k] * omega(t)[k] / L_.norm();
    return c * z + std::sqrt(1 - c * c) * (std::cos(turned) * x + std::sin(turned) * z.cross(x));
  }

 private:
  struct Argument {
    Real u;
    Real periods;
  };
  Argument reduced(Real t) const {
    const Real period = 4 * boost::math::ellint_1(k_);
    const Real u = start_ + rate_ * t;
    const Real periods = std::round(u / period);
    return {u - periods * period, periods};
  }
  Real amplitude(Real t) const {
    const auto [u, periods] = reduced(t);
    Real cn = 0, dn = 0;
    const Real sn = boost::math::jacobi_elliptic(k_, u, &cn, &dn);
    return std::atan2(sn, cn) + 2 * boost::math::constants::pi<Real>() * periods;
  }

  Vector I_;
  Eigen::Matrix<Real, 3, 3> R_;
  Vector L_;
  std::array<int, 3> axis_{0, 1, 2};
  Real a1_, a2_, a3_, rate_, k_, start_;
};

TEST(AsymmetricTop, IsTheTextbooksWithBoostsEllipticFunctions) {
  ed::Random random(72);
  std::array<int, 2> sides{};
  for (int n = 0; n < 1000; ++n) {
    // Bodies whose moments differ, by the second moments of their mass.
    const Vector3d m(1, 1 + log_uniform(random, 0.05, 3), 0.2 + 0.7 * random.uniform());
    const int shift = static_cast<int>(3 * random.uniform());
    const Vector3d moved(m[shift], m[(shift + 1) % 3], m[(shift + 2) % 3]);
    const Start start = with_rotation(random, Vector3d::Constant(moved.sum()) - moved);
    const TextbookTop wanted(start);
    const FreeTop top = start.top();
    sides[start.inertia[wanted.axis()] == start.inertia.maxCoeff() ? 1 : 0] += 1;
    for (const double t : {1.0, 100.0}) {
      const auto exact_t = static_cast<TextbookTop::Real>(t);
      const TopState now = top.at(t);
      const double rate = rate_scale(start);
      // FreeTop promises half of the first term. Boost's functions lose digits of a long double at some moduli, which
      // IntegratedTop, above, does not.
      const double tolerance = 4e-15 * condition(start) * (1 + rate * t) + 2e-14;
      const Vector3d w = now.R.transpose() * now.omega;
      const Vector3d omega_error = w - wanted.omega(exact_t).cast<double>();
      EXPECT_LE(omega_error.norm(), tolerance * rate) << n << ", t = " << t;
      const Vector3d axis_error = now.R.col(wanted.axis()) - wanted.direction(exact_t).cast<double>();
      EXPECT_LE(axis_error.norm(), tolerance) << n << ", t = " << t;
    }
  }
  EXPECT_GT(std::min(sides[0], sides[1]), 300);
}

}  // namespace
