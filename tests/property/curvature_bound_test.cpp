// The bound on which the finder's certificate rests: K(tau) >= h'' over the whole of [0, tau], for the support function
// h of a turning body at a fixed direction. HARDBODY_FULL=1 draws ten times as many states.

#include <common/finder/ensemble.h>
#include <common/finder/gap.h>
#include <common/finder/scale.h>

#include <contact/uniaxial_gap.h>

#include <ed/random.h>
#include <geom/kernel/uniaxial.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <numbers>
#include <ostream>
#include <string>

namespace {

using ed::internal::SupportCurvature;
using Eigen::Vector3d;
using geom::kernel::Spheroid;
using namespace finder_test;

using Real = long double;

/// A turning body and a direction n, reduced to what h(t) depends on: x(t) = n.u(t) = C + p cos(Omega t) + q sin(Omega
/// t).
struct Turning {
  double a;
  double b;
  double rate;    ///< Omega
  double centre;  ///< C
  double p;
  double q;

  Spheroid shape() const { return {a, b}; }

  template <bool kSpin>
  SupportCurvature<kSpin> curvature() const {
    return {centre + p, rate * q, rate, centre};
  }

  double x(double t) const { return centre + p * std::cos(rate * t) + q * std::sin(rate * t); }

  /// h'' by the chain rule, h^2 = b^2 (1 - x^2) + a^2 x^2: an order of operations other than libed's.
  double second_derivative(double t) const {
    const double c = (a - b) * (a + b);
    const double xt = x(t);
    const double speed = rate * (q * std::cos(rate * t) - p * std::sin(rate * t));
    const double pull = rate * rate * (centre - xt);
    const double h = std::sqrt(b * b * (1 - xt) * (1 + xt) + a * a * xt * xt);
    return c * (speed * speed + xt * pull) / h - c * c * xt * xt * speed * speed / (h * h * h);
  }

  /// No h'' of this body is larger; what rounding errors are measured by.
  double scale() const { return std::abs((a - b) * (a + b)) / std::min(a, b) * rate * rate; }

  Real support(Real t) const {
    const auto real = [](double value) { return static_cast<Real>(value); };
    const Real angle = real(rate) * t;
    const Real xt = real(centre) + real(p) * std::cos(angle) + real(q) * std::sin(angle);
    const Real a2 = real(a) * real(a);
    const Real b2 = real(b) * real(b);
    return std::sqrt(b2 * (1 - xt) * (1 + xt) + a2 * xt * xt);
  }
};

/// A random body and motion; a third of the states are close to one in which the bound is delicate: x or its rate
/// nearly zero, n nearly in the plane of turning or nearly along L.
Turning draw(ed::Random& random, bool rod, bool spin) {
  Turning s;
  const double ratio = log_uniform(random, 1.001, 10);
  s.b = log_uniform(random, 0.1, 10);
  s.a = rod ? ratio * s.b : s.b / ratio;
  s.rate = log_uniform(random, 1e-3, 1e3);
  // n and u in a frame with L along z; u at phase 0.
  const auto cosine = [&random] {
    const double kind = random.uniform();
    const double small = log_uniform(random, 1e-9, 1e-1);
    if (kind < 0.15) return small;
    if (kind < 0.30) return 1 - small;
    return 2 * random.uniform() - 1;
  };
  const double cos_n = cosine();
  const double cos_u = spin ? cosine() : 0;
  double phase = 2 * std::numbers::pi * random.uniform();
  if (random.uniform() < 0.3) {
    phase = 0.5 * std::numbers::pi * std::floor(4 * random.uniform());  // a turning point, or the fastest one
    if (random.uniform() < 0.7) phase += (2 * random.uniform() - 1) * log_uniform(random, 1e-12, 1e-2);
  }
  const double amplitude = std::sqrt((1 - cos_n * cos_n) * (1 - cos_u * cos_u));
  s.centre = cos_n * cos_u;
  s.p = amplitude * std::cos(phase);
  s.q = amplitude * std::sin(phase);
  return s;
}

/// The largest h'' on a grid over [0, tau], ends included.
double largest(const Turning& s, double tau) {
  constexpr int kPoints = 48;
  double most = s.second_derivative(0);
  for (int k = 1; k <= kPoints; ++k) most = std::max(most, s.second_derivative(tau * k / kPoints));
  return most;
}

/// Largest bound over Turning::scale(). With each factor taken at its own worst end a rod's is at most
/// b^2 r^2 / h^3 + C^2 / (4 h) <= 1.25 / b.
constexpr double kFactorsApart = 1.25 * (1 + 1e-12);

struct Count {
  int violations = 0;
  int tight = 0;  ///< bounds that exceed the largest h'' by less than a tenth of the scale
};

template <bool kSpin>
Count sample(bool rod, std::uint64_t seed, int draws) {
  // x and its rate carry a few rounding errors each, which h'' multiplies by up to (max / min semi-axis)^2 = 100.
  constexpr double kRounding = 1e-12;
  ed::Random random(seed);
  Count count;
  for (int k = 0; k < draws; ++k) {
    const Turning s = draw(random, rod, kSpin);
    const double tau = log_uniform(random, 1e-4, 10) / s.rate;
    const double bound = s.curvature<kSpin>().bound(s.shape(), tau);
    const double most = largest(s, tau);
    if (!(bound >= most - kRounding * s.scale())) {
      if (++count.violations <= 5) {
        std::printf("a %.17g b %.17g rate %.17g C %.17g p %.17g q %.17g tau %.17g: bound %.17g, h'' %.17g\n", s.a, s.b,
                    s.rate, s.centre, s.p, s.q, tau, bound, most);
      }
    }
    if (bound - most < 0.1 * s.scale()) ++count.tight;
  }
  return count;
}

struct Case {
  const char* name;
  bool rod;
  bool spin;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

class CurvatureBound : public testing::TestWithParam<Case> {};

TEST_P(CurvatureBound, IsNowhereExceeded) {
  const int draws = scaled(1'000'000, 10'000'000) / 4;
  const Case& c = GetParam();
  const std::uint64_t seed = 10 + 2 * c.rod + c.spin;
  const Count count = c.spin ? sample<true>(c.rod, seed, draws) : sample<false>(c.rod, seed, draws);
  std::printf("%-18s %8d states, %d violations, %d within a tenth of the scale\n", c.name, draws, count.violations,
              count.tight);
  EXPECT_EQ(count.violations, 0);
  // A bound that is far off everywhere would pass too: half of them must be close.
  EXPECT_GT(2 * count.tight, draws);
}

TEST_P(CurvatureBound, IsTheSecondDerivativeAtOnce) {
  const Case& c = GetParam();
  ed::Random random(20 + 2 * c.rod + c.spin);
  for (int k = 0; k < 2000; ++k) {
    const Turning s = draw(random, c.rod, c.spin);
    // Fourth-order central differences in long double: the truncation, step^4 / 90 times the sixth derivative (up to
    // 1e6 of the scale at an aspect ratio of 10), and the rounding, 1e-19 h / step^2 (h up to 1000 scales at one
    // of 1.001), both stay below 1e-8 of the scale.
    const Real step = 3e-4L / static_cast<Real>(s.rate);
    const Real near = s.support(step) + s.support(-step);
    const Real far = s.support(2 * step) + s.support(-2 * step);
    const auto differences = static_cast<double>((16 * near - far - 30 * s.support(0)) / (12 * step * step));
    const double at_once = c.spin ? s.curvature<true>().bound(s.shape(), 0) : s.curvature<false>().bound(s.shape(), 0);
    EXPECT_NEAR(at_once, differences, 1e-8 * s.scale());
    EXPECT_NEAR(at_once, s.second_derivative(0), 1e-12 * s.scale());
  }
}

TEST_P(CurvatureBound, HoldsForeverFromAnyState) {
  const Case& c = GetParam();
  ed::Random random(30 + 2 * c.rod + c.spin);
  for (int k = 0; k < 2000; ++k) {
    const Turning s = draw(random, c.rod, c.spin);
    const double forever = std::numeric_limits<double>::infinity();
    const double bound =
        c.spin ? s.curvature<true>().bound(s.shape(), forever) : s.curvature<false>().bound(s.shape(), forever);
    EXPECT_GE(bound, largest(s, 2 * std::numbers::pi / s.rate) - 1e-12 * s.scale());
    EXPECT_LE(bound, kFactorsApart * s.scale());
    EXPECT_LE(largest(s, 2 * std::numbers::pi / s.rate), s.shape().turning_limit * s.rate * s.rate * (1 + 1e-12));
  }
}

INSTANTIATE_TEST_SUITE_P(All, CurvatureBound,
                         testing::Values(Case{"disc, no spin", false, false}, Case{"disc, spin", false, true},
                                         Case{"rod, no spin", true, false}, Case{"rod, spin", true, true}),
                         [](const auto& test) {
                           return std::string(test.param.rod ? "Rod" : "Disc") +
                                  (test.param.spin ? "Spinning" : "WithoutSpin");
                         });

/// Two bodies that are not alike, as certified_contact sees them.
template <bool kSpin>
struct UnlikePair {
  Spheroid A{2.0, 0.7};
  Spheroid B{0.4, 1.3};
  ed::internal::AxisMotion a;
  ed::internal::AxisMotion b;

  explicit UnlikePair(ed::Random& random) : a(motion(random)), b(motion(random)) {}

  static ed::internal::AxisMotion motion(ed::Random& random) {
    BodyState s;
    s.rotation = random.rotation();
    s.position = random.normal3();
    s.velocity = random.normal3();
    const Vector3d w = random.normal3();
    s.across = w - w.dot(s.axis()) * s.axis();
    if (kSpin) s.spin = 3 * random.normal();
    return axis_motion(s, {1.0, 1.6}, kSpin);
  }

  ed::internal::UniaxialGap<kSpin> pair_gap() const { return {A, a, B, b, b.position - a.position, 0, 3.3}; }
};

template <bool kSpin>
void expect_certificate_of_pair() {
  ed::Random random(40 + kSpin);
  for (int k = 0; k < 1000; ++k) {
    const UnlikePair<kSpin> pair(random);
    const auto pair_gap = pair.pair_gap();
    const Vector3d n = random.direction();
    const double t0 = random.uniform();
    const auto state = pair_gap.at(t0);
    const auto e = pair_gap.evaluate(state, n);
    const auto gap = [&](double t) { return pair_gap.evaluate(pair_gap.at(t), n).g; };
    // Truncation step^2 / 6 g''' and rounding 1e-15 / step are both below 1e-9 for rates of order ten.
    const double step = 2e-6;
    EXPECT_NEAR(pair_gap.rate(state, e, n), (gap(t0 + step) - gap(t0 - step)) / (2 * step), 1e-8);
    // The parabola g + g' tau - K tau^2 / 2 stays below g all over [0, tau].
    const double tau = log_uniform(random, 1e-3, 3);
    const double K = pair_gap.certificate(state, e, n).curvature(tau);
    EXPECT_LE(K, kFactorsApart * pair_gap.curvature_limit());
    const double rate = pair_gap.rate(state, e, n);
    for (int i = 1; i <= 40; ++i) {
      const double s = tau * i / 40;
      EXPECT_GE(gap(t0 + s), e.g + s * (rate - 0.5 * K * s) - 1e-13);
      EXPECT_GE(gap(t0 + s), e.g + s * (rate - 0.5 * pair_gap.curvature_limit() * s) - 1e-13);
    }
  }
}

TEST(PairCertificate, ParabolaStaysBelowTheGapWithoutSpin) {
  expect_certificate_of_pair<false>();
}

TEST(PairCertificate, ParabolaStaysBelowTheGapWithSpin) {
  expect_certificate_of_pair<true>();
}

}  // namespace
