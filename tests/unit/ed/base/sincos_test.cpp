#include <base/sincos.h>

#include <common/finder/ensemble.h>

#include <ed/random.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace {

using ed::internal::sincos;
using ed::internal::SinCos;

constexpr double kRange = 1048576.0;

/// The header promises two units in the last place of 1, 2^-52 each; one is what it keeps.
constexpr double kBound = 0x1p-52;

/// The larger of both errors against the C library's long double functions, which are right to 1e-19.
double error(double x) {
  const SinCos sc = sincos(x);
  const auto exact = static_cast<long double>(x);
  return static_cast<double>(std::max(std::abs(static_cast<long double>(sc.sin) - std::sin(exact)),
                                      std::abs(static_cast<long double>(sc.cos) - std::cos(exact))));
}

TEST(SinCosFunction, IsRightOverTheWholeRange) {
  ed::Random random(1);
  double worst = 0;
  for (int k = 0; k < 300'000; ++k) {
    const double x = finder_test::log_uniform(random, 1e-12, kRange);
    worst = std::max({worst, error(x), error(-x)});
  }
  EXPECT_LE(worst, kBound);
}

TEST(SinCosFunction, IsRightNextToMultiplesOfAnEighthTurn) {
  // There the reduced argument cancels to nearly nothing, or the quadrant changes.
  ed::Random random(2);
  const long double eighth = 0.78539816339744830961566084581988L;
  const double most = kRange / static_cast<double>(eighth) - 1;
  double worst = 0;
  for (int k = 0; k < 100'000; ++k) {
    const double multiple = std::floor(finder_test::log_uniform(random, 1, most));
    double x = static_cast<double>(static_cast<long double>(multiple) * eighth);
    for (int step = 0; step < 3; ++step) x = std::nextafter(x, kRange);
    for (int step = 0; step < 7; ++step) {
      worst = std::max({worst, error(x), error(-x)});
      x = std::nextafter(x, 0);
    }
    const double aside = x + finder_test::log_uniform(random, 1e-15, 1e-3);
    worst = std::max({worst, error(aside), error(-aside)});
  }
  EXPECT_LE(worst, kBound);
}

TEST(SinCosFunction, KeepsSymmetryToTheLastBit) {
  ed::Random random(3);
  for (int k = 0; k < 10'000; ++k) {
    const double x = finder_test::log_uniform(random, 1e-12, kRange);
    const SinCos forward = sincos(x);
    const SinCos backward = sincos(-x);
    EXPECT_EQ(forward.sin, -backward.sin);
    EXPECT_EQ(forward.cos, backward.cos);
  }
}

TEST(SinCosFunction, IsExactAtZeroAndKeepsRelativeAccuracyNextToIt) {
  EXPECT_EQ(sincos(0.0).sin, 0.0);
  EXPECT_EQ(sincos(0.0).cos, 1.0);
  ed::Random random(4);
  for (int k = 0; k < 10'000; ++k) {
    const double x = finder_test::log_uniform(random, 1e-300, 0.7);
    const long double relative = static_cast<long double>(sincos(x).sin) / std::sin(static_cast<long double>(x)) - 1;
    EXPECT_LE(std::abs(static_cast<double>(relative)), 2 * 0x1p-52) << x;
  }
}

TEST(SinCosFunction, IsTheLibrarysBeyondItsRange) {
  for (const double x : {std::nextafter(kRange, 2 * kRange), 1e7, -1e15, 1e300}) {
    EXPECT_EQ(sincos(x).sin, std::sin(x));
    EXPECT_EQ(sincos(x).cos, std::cos(x));
  }
  EXPECT_LE(error(kRange), kBound);
  EXPECT_TRUE(std::isnan(sincos(std::numeric_limits<double>::quiet_NaN()).sin));
}

}  // namespace
