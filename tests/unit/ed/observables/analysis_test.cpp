// Estimates, slopes, crossings and the stretched-exponential fit, on data whose answers are known.

#include <ed/analysis.h>
#include <ed/random.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

namespace {

/// Arithmetic on a handful of numbers of order 1.
constexpr double kSumRounding = 1e-13;

std::vector<double> values_at(const std::vector<double>& x, const std::function<double(double)>& f) {
  std::vector<double> y;
  for (const double v : x) y.push_back(f(v));
  return y;
}

std::vector<double> grid(double begin, double step, int number) {
  std::vector<double> x;
  for (int k = 0; k < number; ++k) x.push_back(begin + step * k);
  return x;
}

TEST(MeanOfBlocks, IsTheMeanWithItsStandardError) {
  // Mean 3; squared deviations 4 + 1 + 0 + 1 + 4 = 10; error sqrt(10 / (5 * 4)).
  const ed::Estimate estimate = ed::mean_of_blocks(std::vector<double>{1, 2, 3, 4, 5});
  EXPECT_NEAR(estimate.value, 3, kSumRounding);
  EXPECT_NEAR(estimate.error, std::sqrt(0.5), kSumRounding);
}

TEST(MeanOfBlocks, HasNoErrorForOneValueAndNothingForNone) {
  const ed::Estimate one = ed::mean_of_blocks(std::vector<double>{7});
  EXPECT_EQ(one.value, 7);
  EXPECT_TRUE(std::isnan(one.error));
  const ed::Estimate none = ed::mean_of_blocks({});
  EXPECT_TRUE(std::isnan(none.value));
  EXPECT_TRUE(std::isnan(none.error));
}

TEST(MeanOfBlocks, ErrorDoesNotCancelForLargeMeans) {
  const ed::Estimate estimate = ed::mean_of_blocks(std::vector<double>{1e9 + 1, 1e9 - 1, 1e9 + 1, 1e9 - 1});
  EXPECT_NEAR(estimate.error, std::sqrt(4.0 / 12), kSumRounding);
}

TEST(MeanOfBlocks, ErrorIsThatOfTheMeanOfNormalDeviates) {
  ed::Random random(1);
  std::vector<double> values;
  for (int k = 0; k < 10000; ++k) values.push_back(5 + 2 * random.normal());
  const ed::Estimate estimate = ed::mean_of_blocks(values);
  // 2 / sqrt(10000), itself known to 1 / sqrt(20000): five of those.
  EXPECT_NEAR(estimate.error, 0.02, 0.02 * 5 * 0.0071);
  EXPECT_NEAR(estimate.value, 5, 4 * 0.02);
}

TEST(Slope, OfAnExactLineIsExact) {
  const std::vector<double> x = {0.1, 0.4, 0.9, 2.5, 7.0};
  const auto fitted = ed::slope(x, values_at(x, [](double v) { return 3 - 1.75 * v; }));
  ASSERT_TRUE(fitted);
  EXPECT_NEAR(*fitted, -1.75, kSumRounding);
}

TEST(Slope, IsTheLeastSquaresOne) {
  // By hand: mean x 1, mean y 2; sum (x - 1)(y - 2) = 1 + 0 + 2 = 3, sum (x - 1)^2 = 2.
  const auto fitted = ed::slope(std::vector<double>{0, 1, 2}, std::vector<double>{1, 1, 4});
  ASSERT_TRUE(fitted);
  EXPECT_NEAR(*fitted, 1.5, kSumRounding);
}

TEST(Slope, NeedsTwoDifferentAbscissae) {
  EXPECT_FALSE(ed::slope({}, {}));
  EXPECT_FALSE(ed::slope(std::vector<double>{1}, std::vector<double>{2}));
  EXPECT_FALSE(ed::slope(std::vector<double>{3, 3, 3}, std::vector<double>{1, 2, 4}));
}

TEST(FirstCrossing, OfAStraightLineIsExact) {
  const std::vector<double> x = grid(0, 1, 6);
  const auto t = ed::first_crossing(x, values_at(x, [](double v) { return 1 - 0.3 * v; }), 0.25);
  ASSERT_TRUE(t);
  EXPECT_NEAR(*t, 2.5, kSumRounding);
}

TEST(FirstCrossing, OfAParabolaIsExactWhereverItCrosses) {
  const std::vector<double> x = {0, 0.5, 0.7, 1.3, 2, 2.2, 3};
  const auto y = values_at(x, [](double v) { return 10 - v * v; });
  for (const double crossing : {0.1, 0.6, 1.0, 1.9, 2.1, 2.9}) {
    const auto t = ed::first_crossing(x, y, 10 - crossing * crossing);
    ASSERT_TRUE(t) << crossing;
    EXPECT_NEAR(*t, crossing, 1e-12) << crossing;
  }
}

TEST(FirstCrossing, OfAnExponentialIsGoodToThirdOrder) {
  const std::vector<double> x = grid(0, 0.1, 40);
  const auto t = ed::first_crossing(x, values_at(x, [](double v) { return std::exp(-v); }), 1 / std::exp(1.0));
  ASSERT_TRUE(t);
  // Interpolation error: |f'''| / 6 times three distances of at most 0.2 x 0.1 x 0.1, over the slope; both derivatives
  // are 1/e there.
  EXPECT_NEAR(*t, 1, 4e-4);
}

TEST(FirstCrossing, OfAnInertialDecayIsGoodToAThousandth) {
  // C2 of bodies that turn nearly freely, compressed (exponents from 1.2 to 2), at the program's 20 lags a decade,
  // wherever these fall. A parabola is off by up to 3e-4 (see above, with neighbours 0.12 apart), a straight line by up
  // to 2e-3.
  for (const double exponent : {1.2, 1.5, 2.0}) {
    for (int shift = 0; shift < 40; ++shift) {
      std::vector<double> x;
      for (int k = 0; k <= 60; ++k) x.push_back(16 * std::pow(10.0, (k - 60 + shift / 40.0) / 20));
      const auto y = values_at(x, [&](double t) { return std::exp(-std::pow(t / 0.3677, exponent)); });
      const auto t = ed::first_crossing(x, y, 1 / std::exp(1.0));
      ASSERT_TRUE(t);
      EXPECT_NEAR(*t / 0.3677, 1, 5e-4) << exponent << " " << shift;
    }
  }
}

TEST(FirstCrossing, IsTheFirstOfSeveralAndFalls) {
  // Rises through 0.5 first, then falls through it twice.
  const std::vector<double> x = grid(0, 1, 8);
  const std::vector<double> y = {0, 1, 2, 1, 0, 1, 2, 0};
  const auto t = ed::first_crossing(x, y, 0.5);
  ASSERT_TRUE(t);
  EXPECT_GT(*t, 3);
  EXPECT_LT(*t, 4);
}

TEST(FirstCrossing, StaysBetweenItsPointsWhateverTheNoise) {
  ed::Random random(2);
  for (int round = 0; round < 2000; ++round) {
    const std::vector<double> x = grid(0, 0.5 + random.uniform(), 12);
    std::vector<double> y;
    for (std::size_t k = 0; k < x.size(); ++k) y.push_back(1 - 0.1 * static_cast<double>(k) + 0.3 * random.normal());
    const double level = 0.4;
    const auto t = ed::first_crossing(x, y, level);
    std::optional<std::size_t> first;
    for (std::size_t k = 1; k < x.size() && !first; ++k) {
      if (y[k - 1] > level && y[k] <= level) first = k;
    }
    ASSERT_EQ(t.has_value(), first.has_value());
    if (!first) continue;
    ASSERT_GE(*t, x[*first - 1]);
    ASSERT_LE(*t, x[*first]);
  }
}

TEST(FirstCrossing, IsNothingIfThereIsNone) {
  const std::vector<double> x = grid(0, 1, 5);
  EXPECT_FALSE(ed::first_crossing(x, std::vector<double>{5, 4, 3, 2, 1}, 0.5));
  EXPECT_FALSE(ed::first_crossing(x, std::vector<double>{1, 2, 3, 4, 5}, 2.5));
  EXPECT_FALSE(ed::first_crossing(x, std::vector<double>{1, 1, 1, 1, 1}, 2));
  EXPECT_FALSE(ed::first_crossing({}, {}, 0.5));
  EXPECT_FALSE(ed::first_crossing(std::vector<double>{0, 1}, std::vector<double>{1, 0}, 0.5));
}

TEST(StretchedExponential, RecoversExactParameters) {
  for (const double beta : {0.5, 0.86, 1.0, 1.4}) {
    for (const double tau : {0.01, 1.0, 300.0}) {
      const std::vector<double> t = grid(0.05 * tau, 0.05 * tau, 60);
      const auto fit = ed::fit_stretched_exponential(
          t, values_at(t, [&](double s) { return 0.9 * std::exp(-std::pow(s / tau, beta)); }));
      ASSERT_TRUE(fit) << "tau " << tau << ", beta " << beta;
      // The solver stops at a relative change of 1e-10.
      EXPECT_NEAR(fit->amplitude, 0.9, 1e-7);
      EXPECT_NEAR(fit->tau / tau, 1, 1e-7);
      EXPECT_NEAR(fit->beta, beta, 1e-7);
    }
  }
}

TEST(StretchedExponential, RecoversParametersThroughNoise) {
  constexpr double kNoise = 0.005;
  constexpr int kFits = 200;
  const std::vector<double> t = grid(0.1, 0.1, 50);
  ed::Random random(3);
  std::vector<double> tau;
  std::vector<double> beta;
  for (int k = 0; k < kFits; ++k) {
    const auto fit = ed::fit_stretched_exponential(
        t, values_at(t, [&](double s) { return std::exp(-std::pow(s / 1.2, 0.9)) + kNoise * random.normal(); }));
    ASSERT_TRUE(fit);
    tau.push_back(fit->tau);
    beta.push_back(fit->beta);
    // A single fit, its parameters' standard deviation estimated from all of them below: about 0.02.
    EXPECT_NEAR(fit->tau, 1.2, 0.1);
    EXPECT_NEAR(fit->beta, 0.9, 0.1);
  }
  const ed::Estimate mean_tau = ed::mean_of_blocks(tau);
  const ed::Estimate mean_beta = ed::mean_of_blocks(beta);
  // Unbiased to first order in the noise: four standard errors.
  EXPECT_NEAR(mean_tau.value, 1.2, 4 * mean_tau.error);
  EXPECT_NEAR(mean_beta.value, 0.9, 4 * mean_beta.error);
  EXPECT_LT(mean_tau.error, 0.003);
  EXPECT_LT(mean_beta.error, 0.003);
}

TEST(StretchedExponential, TakesValuesBelowZero) {
  const std::vector<double> t = grid(0.1, 0.1, 60);
  ed::Random random(4);
  const auto fit =
      ed::fit_stretched_exponential(t, values_at(t, [&](double s) { return std::exp(-s) + 0.01 * random.normal(); }));
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->tau, 1, 0.1);
}

TEST(StretchedExponential, TakesTheTimeZero) {
  const std::vector<double> t = grid(0, 0.1, 60);
  const auto fit =
      ed::fit_stretched_exponential(t, values_at(t, [](double s) { return 0.9 * std::exp(-std::pow(s / 0.7, 0.8)); }));
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->amplitude, 0.9, 1e-7);
  EXPECT_NEAR(fit->tau, 0.7, 1e-7);
  EXPECT_NEAR(fit->beta, 0.8, 1e-7);
}

TEST(StretchedExponential, IsNothingForTooFewPoints) {
  EXPECT_FALSE(ed::fit_stretched_exponential({}, {}));
  EXPECT_FALSE(ed::fit_stretched_exponential(std::vector<double>{1, 2, 3}, std::vector<double>{0.9, 0.5, 0.2}));
}

TEST(StretchedExponential, IsNothingForDataThatDoNotDecay) {
  const std::vector<double> t = grid(0.1, 0.1, 20);
  for (const auto& f : std::vector<std::function<double(double)>>{
           [](double s) { return s; }, [](double s) { return 1 + s * s; }, [](double) { return 0.0; },
           [](double) { return std::numeric_limits<double>::quiet_NaN(); }}) {
    const auto fit = ed::fit_stretched_exponential(t, values_at(t, f));
    EXPECT_FALSE(fit) << "A = " << fit->amplitude << ", tau = " << fit->tau << ", beta = " << fit->beta;
  }
}

TEST(StretchedExponential, NeverReturnsWhatIsNotFinite) {
  ed::Random random(5);
  int fits = 0;
  for (int round = 0; round < 300; ++round) {
    const std::vector<double> t = grid(0.1, 0.2, 4 + round % 10);
    const auto fit = ed::fit_stretched_exponential(t, values_at(t, [&](double) { return random.normal(); }));
    if (!fit) continue;
    ++fits;
    EXPECT_TRUE(std::isfinite(fit->amplitude));
    EXPECT_TRUE(std::isfinite(fit->tau) && fit->tau > 0) << fit->tau;
    EXPECT_TRUE(fit->beta > 0.1 && fit->beta < 3) << fit->beta;
  }
  EXPECT_GT(fits, 0);
}

}  // namespace
