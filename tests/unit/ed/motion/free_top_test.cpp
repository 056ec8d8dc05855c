#include <motion/free_top.h>

#include <common/finder_ensemble.h>
#include <common/top_reference.h>

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
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <ostream>
#include <string>
#include <utility>

namespace {

using ed::internal::FreeTop;
using ed::internal::TopState;
using ed::internal::TurnedAngles;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using finder_test::IntegratedTop;
using finder_test::log_uniform;

struct Start {
  Vector3d inertia = Vector3d::Ones();
  Matrix3d rotation = Matrix3d::Identity();
  Vector3d omega = Vector3d::Zero();

  FreeTop top() const { return FreeTop(inertia, rotation, omega); }
};

double rate_scale(const Start& s) {
  return s.omega.norm();
}

/// Random::rotation keeps some 1e-14; the tests below tell 1e-15.
Matrix3d orthonormal(const Matrix3d& m) {
  Matrix3d R;
  R.col(2) = m.col(2).normalized();
  R.col(0) = (m.col(0) - R.col(2).dot(m.col(0)) * R.col(2)).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

Start with_rotation(ed::Random& random, const Vector3d& inertia) {
  Start s;
  s.inertia = inertia;
  s.rotation = orthonormal(random.rotation());
  // Thermal: every axis carries the same energy on average.
  s.omega = s.rotation * random.normal3().cwiseQuotient(s.inertia.cwiseSqrt());
  return s;
}

Start draw_spherical(ed::Random& random) {
  return with_rotation(random, Vector3d::Constant(log_uniform(random, 0.1, 10)));
}

/// Draws tops from needles to discs, about any body axis.
Start draw_symmetric(ed::Random& random) {
  const double perpendicular = log_uniform(random, 0.1, 10);
  Vector3d inertia = Vector3d::Constant(perpendicular);
  const int axis = static_cast<int>(3 * random.uniform());
  inertia[axis] = perpendicular * (random.uniform() < 0.5 ? 2 - log_uniform(random, 1e-12, 1.9)  //
                                                          : log_uniform(random, 1e-3, 2));
  return with_rotation(random, inertia);
}

/// Three different moments of a body: from needles and discs to near spheres, some pairs nearly equal.
Start draw_asymmetric(ed::Random& random) {
  const double a = random.uniform() < 0.3 ? log_uniform(random, 1e-15, 1e-3) : random.uniform();
  const double b = random.uniform() < 0.3 ? log_uniform(random, 1e-15, 1e-3) : random.uniform();
  const double c = random.uniform() < 0.3 ? log_uniform(random, 1e-4, 1e-2) : random.uniform();
  // Second moments of mass along the axes, in all orders; two near zero: a needle; one: a disc.
  Vector3d second(1, c, 0);
  second.z() = random.uniform() < 0.5 ? c * (1 + a) : 1 + a;
  second.x() += random.uniform() < 0.2 ? b * 1e-3 : b;
  const int shift = static_cast<int>(3 * random.uniform());
  const int other = random.uniform() < 0.5 ? 1 : 2;
  const Vector3d m(second[shift], second[(shift + other) % 3], second[(shift + 2 * other) % 3]);
  return with_rotation(random, log_uniform(random, 0.01, 100) * Vector3d(m.y() + m.z(), m.z() + m.x(), m.x() + m.y()));
}

/// Returns how much rounding of omega is magnified in k'^2: 1 for symmetric tops, large for asymmetric ones near the
/// separatrix.
double condition(const Start& s) {
  std::array<int, 3> i{0, 1, 2};
  std::sort(i.begin(), i.end(), [&](int a, int b) { return s.inertia[a] < s.inertia[b]; });
  const Vector3d w = s.rotation.transpose() * s.omega;
  const Vector3d& I = s.inertia;
  const double low = I[i[0]] * (I[i[1]] - I[i[0]]) * w[i[0]] * w[i[0]];
  const double high = I[i[2]] * (I[i[2]] - I[i[1]]) * w[i[2]] * w[i[2]];
  return low > 0 && high > 0 ? (low + high) / std::max(std::abs(high - low), 1e-16 * (low + high)) : 1;
}

using Draw = Start (*)(ed::Random&);

struct Kind {
  std::string name;
  Draw draw;
};

void PrintTo(const Kind& kind, std::ostream* out) {
  *out << kind.name;
}

class FreeTops : public testing::TestWithParam<Kind> {
 protected:
  Start draw() { return GetParam().draw(random_); }
  ed::Random random_{71};
};

INSTANTIATE_TEST_SUITE_P(Kinds, FreeTops,
                         testing::Values(Kind{"Spherical", draw_spherical}, Kind{"Symmetric", draw_symmetric},
                                         Kind{"Asymmetric", draw_asymmetric}),
                         [](const auto& kind) { return kind.param.name; });

double difference(const Matrix3d& a, const IntegratedTop::Matrix& b) {
  return static_cast<double>((a.cast<long double>() - b).cwiseAbs().maxCoeff());
}

double difference(const Vector3d& a, const IntegratedTop::Vector& b) {
  return static_cast<double>((a.cast<long double>() - b).norm());
}

TEST_P(FreeTops, AreTheIntegratedEquationsOfMotion) {
  for (int k = 0; k < 300; ++k) {
    const Start start = draw();
    const double rate = rate_scale(start);
    const double t = (k % 10 == 0 ? 100 : 5) * random_.normal() / rate;
    IntegratedTop wanted(start.inertia, start.rotation, start.omega);
    wanted.advance(t);
    const FreeTop top = start.top();
    const TopState end = top.at(t);
    const double tolerance = 2e-15 * condition(start) * (1 + rate * std::abs(t));
    EXPECT_LE(difference(end.R, wanted.rotation()), tolerance);
    EXPECT_LE(difference(end.omega, wanted.omega()), tolerance * rate);
    const TurnedAngles turned = top.turned(t);
    EXPECT_LE(difference(turned.world, wanted.turned_world()), tolerance * (1 + rate * std::abs(t)));
    EXPECT_LE(difference(turned.body, wanted.turned_body()), tolerance * (1 + rate * std::abs(t)));
    EXPECT_EQ(top.rotation(t), end.R);
  }
}

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

TEST_P(FreeTops, StartWhereTheyAreToldTo) {
  for (int k = 0; k < 10'000; ++k) {
    const Start start = draw();
    const TopState now = start.top().at(0);
    EXPECT_LE((now.R - start.rotation).cwiseAbs().maxCoeff(), 2e-15);
    EXPECT_LE((now.omega - start.omega).norm(), 2e-15 * start.omega.norm());
    EXPECT_EQ(start.top().turned(0).world, Vector3d(0, 0, 0));
    EXPECT_EQ(start.top().turned(0).body, Vector3d(0, 0, 0));
  }
}

TEST_P(FreeTops, HaveOrthonormalMatrices) {
  for (int k = 0; k < 10'000; ++k) {
    const Start start = draw();
    const Matrix3d R = start.top().rotation(10 * random_.normal() / rate_scale(start));
    EXPECT_LE((R.transpose() * R - Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_GT(R.determinant(), 0.999);
  }
}

TEST_P(FreeTops, KeepAngularMomentumAndEnergy) {
  const auto momentum = [](const Start& s, const Matrix3d& R, const Vector3d& omega) {
    return Vector3d(R * s.inertia.cwiseProduct(R.transpose() * omega));
  };
  for (int k = 0; k < 3000; ++k) {
    const Start start = draw();
    const FreeTop top = start.top();
    const Vector3d L = momentum(start, start.rotation, start.omega);
    const double energy = start.omega.dot(L);
    for (const double t : {0.3, 7.0, -50.0}) {
      const TopState now = top.at(t / rate_scale(start));
      const Vector3d L_now = momentum(start, now.R, now.omega);
      // A needle's L is little beside what rounding of its fast spin makes of it.
      EXPECT_LE((L_now - L).norm(), 1e-14 * start.inertia.maxCoeff() * start.omega.norm());
      EXPECT_NEAR(now.omega.dot(L_now), energy, 1e-14 * L.norm() * start.omega.norm());
    }
  }
}

TEST_P(FreeTops, GoOnWhereTheyWereStoppedAndComeBack) {
  for (int k = 0; k < 3000; ++k) {
    const Start start = draw();
    const double rate = rate_scale(start);
    const double t1 = 3 * random_.normal() / rate;
    const double t2 = 3 * random_.normal() / rate;
    const FreeTop top = start.top();
    const TopState half = top.at(t1);
    const TopState end = top.at(t1 + t2);
    const FreeTop rest = Start{start.inertia, half.R, half.omega}.top();
    const FreeTop back = Start{start.inertia, end.R, -end.omega}.top();
    const double tolerance = 3e-15 * condition(start) * (1 + rate * (std::abs(t1) + std::abs(t2)));
    EXPECT_LE((rest.rotation(t2) - end.R).cwiseAbs().maxCoeff(), tolerance);
    EXPECT_LE((rest.at(t2).omega - end.omega).norm(), tolerance * rate);
    EXPECT_LE((back.rotation(t1 + t2) - start.rotation).cwiseAbs().maxCoeff(), tolerance);
    EXPECT_LE((back.at(t1 + t2).omega + start.omega).norm(), tolerance * rate);
    // Integrals add up; the body's axes have not been renamed, the world's have not been turned.
    EXPECT_LE((top.turned(t1).world + rest.turned(t2).world - top.turned(t1 + t2).world).norm(), 5 * tolerance);
    EXPECT_LE((top.turned(t1).body + rest.turned(t2).body - top.turned(t1 + t2).body).norm(), 5 * tolerance);
  }
}

/// Central differences with step h: errors of h^2 (rate^3 or rate^4) / 6, and 1e-16 rate / h of rounding.
TEST_P(FreeTops, HaveTheRatesThatTheyName) {
  for (int k = 0; k < 1000; ++k) {
    const Start start = draw();
    const FreeTop top = start.top();
    const double rate = top.max_omega();
    const double t = 5 * random_.normal() / rate;
    const double h = 1e-4 / rate;
    const TopState before = top.at(t - h);
    const TopState now = top.at(t);
    const TopState after = top.at(t + h);
    EXPECT_LE(((after.omega - before.omega) / (2 * h) - now.alpha).norm(), 1e-7 * rate * rate);
    const Matrix3d turning = (after.R - before.R) / (2 * h);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LE((turning.col(axis) - now.omega.cross(now.R.col(axis))).norm(), 1e-7 * rate);
    }
  }
}

/// d2 omega / dt2 in the world frame from Euler's equations: R (alpha' + omega x alpha), body frame inside.
Vector3d jerk(const Start& start, const TopState& now) {
  const Vector3d& I = start.inertia;
  const Vector3d w = now.R.transpose() * now.omega;
  const Vector3d a = now.R.transpose() * now.alpha;
  Vector3d rate;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    rate[i] = (I[j] - I[k]) / I[i] * (a[j] * w[k] + w[j] * a[k]);
  }
  return now.R * (rate + w.cross(a));
}

/// Samples all phases of the motion: times from a fraction of a turn to many periods of the slowest top, whose moments
/// agree to 1e-15. No digit is left of the phase then, but omega is one that the top takes.
TEST_P(FreeTops, KeepTheirBoundsAndNearlyReachThem) {
  for (int k = 0; k < 100'000; ++k) {
    const Start start = draw();
    const FreeTop top = start.top();
    const double rate = top.max_omega();
    // Every hundredth top is sampled densely.
    const int samples = k % 100 == 0 ? 1000 : 5;
    double omega = 0;
    double alpha = 0;
    double highest_jerk = 0;
    for (int sample = 0; sample < samples; ++sample) {
      const TopState now = top.at(log_uniform(random_, 0.1, 1e18) / rate);
      omega = std::max(omega, now.omega.norm());
      alpha = std::max(alpha, now.alpha.norm());
      highest_jerk = std::max(highest_jerk, jerk(start, now).norm());
    }
    ASSERT_LE(omega, top.max_omega());
    ASSERT_LE(alpha, top.max_alpha());
    // jerk() subtracts rounded numbers.
    const double rounding = 5e-15 * rate * rate * rate;
    ASSERT_LE(highest_jerk, top.max_jerk() + rounding);
    if (samples < 1000) continue;
    EXPECT_GE(omega, 0.99 * top.max_omega());
    EXPECT_GE(alpha, 0.99 * top.max_alpha());
    EXPECT_GE(highest_jerk + rounding, 0.99 * top.max_jerk());
  }
}

TEST_P(FreeTops, StayRightOnVeryLongFlights) {
  // Angles of 1e9 radian keep seven digits; the matrix stays a rotation.
  const Start start = draw();
  const FreeTop top = start.top();
  const double t = 1e9 / rate_scale(start);
  const TopState there = top.at(t);
  EXPECT_LE((there.R.transpose() * there.R - Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-15);
  const FreeTop rest = Start{start.inertia, there.R, there.omega}.top();
  EXPECT_LE((rest.rotation(-t) - start.rotation).cwiseAbs().maxCoeff(), 1e-5);
}

/// The states' bits, so that they depend neither on the processor nor on the compiler nor on its options.
TEST_P(FreeTops, HaveTheSameBitsInEveryBuild) {
  const std::map<std::string, std::uint64_t> golden{
      {"Spherical", 0xbb8dd5aa637af2e3}, {"Symmetric", 0xfbeeaecdd039b371}, {"Asymmetric", 0x019533f37f3dcb31}};
  std::uint64_t hash = 14695981039346656037U;
  const auto add = [&](const auto& numbers) {
    for (const double x : numbers.reshaped()) {
      hash ^= std::bit_cast<std::uint64_t>(x + 0.0);  // one zero
      hash *= 1099511628211U;
    }
  };
  for (int k = 0; k < 1000; ++k) {
    // Simple numbers: the functions that draw states use the C library.
    const double shape = GetParam().name == "Spherical" ? 0 : random_.uniform();
    const double other = GetParam().name == "Asymmetric" ? random_.uniform() : shape;
    const FreeTop top(Vector3d(1, 1 + shape, 1 + other), Matrix3d::Identity(),
                      {random_.uniform() - 0.5, random_.uniform() - 0.5, random_.uniform() - 0.5});
    const double t = 200 * (random_.uniform() - 0.5);
    const TopState now = top.at(t);
    add(now.R);
    add(now.omega);
    add(now.alpha);
    add(top.turned(0.1 * t).world);
    add(top.turned(0.1 * t).body);
    add(Vector3d(top.max_omega(), top.max_alpha(), top.max_jerk()));
  }
  EXPECT_EQ(hash, golden.at(GetParam().name)) << std::hex << hash;
}

TEST(FreeTop, AtRestStaysAtRest) {
  for (const Vector3d& inertia : {Vector3d(1, 1, 1), Vector3d(1, 1, 0.2), Vector3d(1, 0.7, 0.5)}) {
    Start start;
    start.inertia = inertia;
    start.rotation = Eigen::AngleAxisd(1, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    const FreeTop top = start.top();
    const TopState there = top.at(1e300);
    EXPECT_LE((there.R - start.rotation).cwiseAbs().maxCoeff(), 3e-16);
    EXPECT_EQ(there.omega, Vector3d(0, 0, 0));
    EXPECT_EQ(there.alpha, Vector3d(0, 0, 0));
    EXPECT_EQ(top.max_omega(), 0);
    EXPECT_EQ(top.max_alpha(), 0);
    EXPECT_EQ(top.max_jerk(), 0);
    EXPECT_EQ(top.turned(5).world, Vector3d(0, 0, 0));
    EXPECT_EQ(top.turned(5).body, Vector3d(0, 0, 0));
  }
  EXPECT_EQ(FreeTop().rotation(3), Matrix3d::Identity());
}

TEST(FreeTop, KeepsTurningAboutAPrincipalAxisEvenTheUnstableOne) {
  for (int axis = 0; axis < 3; ++axis) {
    Start start;
    start.inertia = {1, 2, 2.5};
    start.omega = 3 * Vector3d::Unit(axis);
    const FreeTop top = start.top();
    for (const double t : {0.4, -12.0, 1e5}) {
      const Matrix3d expected = Eigen::AngleAxisd(3 * t, Vector3d::Unit(axis)).toRotationMatrix();
      const TopState there = top.at(t);
      EXPECT_LE((there.R - expected).cwiseAbs().maxCoeff(), 1e-15 * (1 + std::abs(t)));
      EXPECT_EQ(there.omega, start.omega);
      EXPECT_EQ(there.alpha, Vector3d(0, 0, 0));
      EXPECT_LE((top.turned(t).body - t * start.omega).norm(), 1e-15 * std::abs(t));
    }
    EXPECT_NEAR(top.max_omega(), 3, 1e-13);
    EXPECT_EQ(top.max_alpha(), 0);
  }
}

/// Expects an answer that is as good as omega is known, where the motion itself magnifies small changes: beyond
/// rounding the error is no more than four times what a change of one component of omega in its last place does, by
/// integration.
void expect_as_good_as_omega(const Start& start, double t) {
  using Real = IntegratedTop::Real;
  const auto integrated = [&](const Vector3d& omega) {
    IntegratedTop top(start.inertia, start.rotation, omega);
    top.advance(t);
    return top.rotation();
  };
  const IntegratedTop::Matrix wanted = integrated(start.omega);
  Real change = 0;
  for (int i = 0; i < 3; ++i) {
    Vector3d omega = start.omega;
    omega[i] *= 1 + 0x1p-52;
    change = std::max(change, (integrated(omega) - wanted).cwiseAbs().maxCoeff());
  }
  const double tolerance = 2e-15 * (1 + start.omega.norm() * std::abs(t)) + 4 * static_cast<double>(change);
  EXPECT_LE(difference(start.top().rotation(t), wanted), tolerance) << "omega " << start.omega.transpose();
}

// Body axes along the world's: the components that matter are exact.
TEST(FreeTop, NearTheUnstableAxisIsAsGoodAsOmegaIsKnown) {
  ed::Random random(72);
  for (int k = 0; k < 12; ++k) {
    Start start;
    start.inertia = {0.5, 1, 1.2};
    const double distance = log_uniform(random, k % 3 == 0 ? 1e-130 : 1e-20, 1e-2);
    start.omega = distance * random.normal3();
    start.omega.y() = k % 2 == 0 ? -1 : 1;
    // The distance grows as exp(0.408 t); integration is right until about the second flip.
    const double escape = -std::log(distance) / 0.408;
    expect_as_good_as_omega(start, 0.7 * escape);
    expect_as_good_as_omega(start, (k % 4 < 2 ? 1 : -1) * (escape + 10));
  }
}

TEST(FreeTop, NearTheSeparatrixIsAsGoodAsOmegaIsKnown) {
  ed::Random random(73);
  for (int k = 0; k < 20; ++k) {
    Start start;
    const double low = log_uniform(random, 0.1, 1);
    const double middle = low * (1 + random.uniform());
    const double high = middle + low * random.uniform();
    start.inertia = {low, middle, high};
    start.omega = random.normal3();
    start.omega.z() = std::sqrt(low * (middle - low) / (high * (high - middle))) * start.omega.x() *
                      (1 + (k % 2 == 0 ? 1 : -1) * log_uniform(random, 1e-17, 1e-2));
    for (const double t : {1.0, -10.0, 50.0}) expect_as_good_as_omega(start, t / start.omega.norm());
  }
}

TEST(FreeTop, OnTheSeparatrixTendsToTheMiddleAxis) {
  // 2 E I2 = L^2 exactly: 1 * (2 - 1) * 3 = 3 * (3 - 2) * 1.
  Start start;
  start.inertia = {1, 2, 3};
  start.omega = {std::sqrt(3.0), 0, 1};
  const double rate = start.omega.norm();
  for (const double t : {5.0, 10.0, -10.0}) {
    IntegratedTop wanted(start.inertia, start.rotation, start.omega);
    wanted.advance(t);
    const TopState there = start.top().at(t);
    // The square root of 3 is rounded: by 1e-16, which grows as exp(0.8 t) to 1e-13 at most.
    EXPECT_LE(difference(there.R, wanted.rotation()), 1e-12);
    EXPECT_LE((there.R.col(1) * rate).cross(there.omega).norm(), 20 * rate * std::exp(-0.8 * std::abs(t)));
  }
}

TEST(FreeTop, StaysNearAStableAxis) {
  ed::Random random(74);
  for (int k = 0; k < 100; ++k) {
    Start start;
    start.inertia = {0.5, 1, 1.2};
    const int axis = k % 2 == 0 ? 0 : 2;
    const double distance = log_uniform(random, 1e-160, 1e-3);
    start.omega = distance * random.normal3();
    start.omega[axis] = 1;
    const TopState there = start.top().at(30 * random.normal());
    const Vector3d w = there.R.transpose() * there.omega;
    for (int i = 0; i < 3; ++i) {
      if (i == axis) continue;
      EXPECT_LE(std::abs(w[i]), 20 * distance + 1e-15);
    }
    IntegratedTop wanted(start.inertia, start.rotation, start.omega);
    wanted.advance(20);
    EXPECT_LE(difference(start.top().rotation(20), wanted.rotation()), 2e-14);
  }
}

/// Compares two moments that agree with moments that nearly do: nothing jumps where the formulas change.
TEST(FreeTop, KindsAgreeWhereTheyMeet) {
  ed::Random random(75);
  for (int k = 0; k < 1000; ++k) {
    const Vector3d inertia(1, 1, 0.2 + 1.7 * random.uniform());
    const Start exact = with_rotation(random, k % 2 == 0 ? inertia : Vector3d(1, 1, 1));
    const double t = 5 * random.normal();
    for (const double difference : {1e-15, 1e-12, 1e-9}) {
      Start near = exact;
      near.inertia[k % 3] += difference;
      near.inertia[(k + 1) % 3] -= difference;
      const double tolerance =
          5e-15 * (1 + 5 * exact.omega.norm()) + 100 * difference * (1 + exact.omega.norm() * std::abs(t));
      EXPECT_LE((near.top().rotation(t) - exact.top().rotation(t)).cwiseAbs().maxCoeff(), tolerance);
      EXPECT_LE((near.top().turned(t).world - exact.top().turned(t).world).norm(), 10 * tolerance);
      EXPECT_LE((near.top().turned(t).body - exact.top().turned(t).body).norm(), 10 * tolerance);
    }
  }
}

}  // namespace
