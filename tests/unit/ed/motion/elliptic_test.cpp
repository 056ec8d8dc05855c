// The functions that the motion of asymmetric tops is made of, against the C library's and Boost's.

#include <base/exponential.h>
#include <base/sincos.h>
#include <motion/elliptic.h>

#include <common/finder/ensemble.h>

#include <ed/random.h>

#include <gtest/gtest.h>
#include <boost/math/constants/constants.hpp>
#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>

#include <algorithm>
#include <cmath>

namespace {

using finder_test::log_uniform;

TEST(Exponential, IsRightToTheLastPlace) {
  ed::Random random(76);
  double worst = 0;
  for (int k = 0; k < 300'000; ++k) {
    const double x = (k % 2 == 0 ? 1400 : 2) * (random.uniform() - 0.5);
    const long double exact = std::exp(static_cast<long double>(x));
    worst = std::max(worst,
                     static_cast<double>(std::abs(static_cast<long double>(ed::internal::exponential(x)) / exact - 1)));
  }
  EXPECT_LE(worst, 0x1p-52);
}

TEST(AngleOf, InvertsSincos) {
  for (int k = -1000; k <= 1000; ++k) {
    const double angle = 3.14159 * k / 1000;
    EXPECT_NEAR(ed::internal::angle_of(ed::internal::sincos(angle)), angle, 1e-15);
  }
}

TEST(Landen, IsBoostsEllipticIntegrals) {
  using Real = long double;
  using boost::math::ellint_1;
  ed::Random random(77);
  const Real pi = boost::math::constants::pi<Real>();
  for (int trial = 0; trial < 1000; ++trial) {
    const double k2 = log_uniform(random, 1e-3, 0.5);  // Boost loses digits of K' below
    const double kc = std::sqrt(1 - k2);
    const ed::internal::Landen landen(k2, kc);
    const Real k = std::sqrt(static_cast<Real>(k2));
    const Real complement = std::sqrt(1 - static_cast<Real>(k2));
    const Real K = ellint_1(k);
    const Real K_prime = ellint_1(complement);
    const auto relative = [](double value, Real exact) {
      return static_cast<double>(std::abs(static_cast<Real>(value) / exact - 1));
    };
    EXPECT_LE(relative(landen.mean(), pi / (2 * K)), 4e-16);
    EXPECT_LE(relative(ed::internal::agm(1, kc), pi / (2 * K)), 4e-16);
    EXPECT_LE(relative(landen.nome(), std::exp(-pi * K_prime / K)), 1e-15);
    const double phi = 6 * (random.uniform() - 0.5);
    const ed::internal::SinCos x = landen.argument({std::sin(phi), std::cos(phi)});
    const Real argument = pi * ellint_1(k, static_cast<Real>(phi)) / (2 * K);
    EXPECT_NEAR(x.sin, static_cast<double>(std::sin(argument)), 1e-15);
    EXPECT_NEAR(x.cos, static_cast<double>(std::cos(argument)), 1e-15);
    // w <= K'/2.
    const double w = random.uniform() * static_cast<double>(0.5L * K_prime);
    Real cn = 0;
    Real dn = 0;
    const Real sn = boost::math::jacobi_elliptic(complement, static_cast<Real>(w), &cn, &dn);
    EXPECT_LE(relative(landen.decay(static_cast<double>(sn), static_cast<double>(cn)),
                       std::exp(-pi * static_cast<Real>(w) / K)),
              1e-14);
  }
}

}  // namespace
