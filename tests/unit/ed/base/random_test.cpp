#include <ed/random.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>

namespace {

using ed::Random;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kDraws = 1'000'000;

/// A mean over kDraws of a variable with this variance is within four standard errors (one failure in 16,000 seeds; the
/// seeds are fixed).
double four_errors(double variance) {
  return 4 * std::sqrt(variance / kDraws);
}

TEST(Random, BitsAreThoseOfThePublishedGenerator) {
  // xoshiro256** after splitmix64, worked out from the published algorithms with exact integers.
  Random zero(0);
  for (const std::uint64_t expected :
       {0x99ec5f36cb75f2b4u, 0xbf6e1f784956452au, 0x1a5f849d4933e6e0u, 0x6aa594f1262d2d2cu}) {
    EXPECT_EQ(zero.bits(), expected);
  }
  Random other(12345);
  for (const std::uint64_t expected :
       {0xbe6a36374160d49bu, 0x214aaa0637a688c6u, 0xf69d16de9954d388u, 0xc60048c4e96e033u}) {
    EXPECT_EQ(other.bits(), expected);
  }
}

TEST(Random, NumbersOfASeedNeverChange) {
  // A change here changes every trajectory of every stored seed.
  Random uniform(1);
  EXPECT_EQ(uniform.uniform(), static_cast<double>(0xb3f2af6d0fc710c5u >> 11) * 0x1p-53);
  Random normal(1);
  for (const double expected :
       {0x1.e368961549833p-4, -0x1.c042690cbca9fp-2, -0x1.0278716814ddbp+1, -0x1.c1642f891d58cp-3}) {
    EXPECT_EQ(normal.normal(), expected);
  }
  Random three(1);
  EXPECT_EQ(three.normal3(), Vector3d(0x1.e368961549833p-4, -0x1.c042690cbca9fp-2, -0x1.0278716814ddbp+1));
}

TEST(Random, UniformFillsTheUnitInterval) {
  Random random(2);
  double mean = 0;
  double square = 0;
  std::array<int, 16> bins{};
  for (int k = 0; k < kDraws; ++k) {
    const double x = random.uniform();
    ASSERT_GE(x, 0);
    ASSERT_LT(x, 1);
    mean += x / kDraws;
    square += x * x / kDraws;
    ++bins[static_cast<std::size_t>(16 * x)];
  }
  EXPECT_NEAR(mean, 1.0 / 2, four_errors(1.0 / 12));
  EXPECT_NEAR(square, 1.0 / 3, four_errors(1.0 / 5 - 1.0 / 9));
  for (const int count : bins) EXPECT_NEAR(static_cast<double>(count) / kDraws, 1.0 / 16, four_errors(15.0 / 256));
}

TEST(Random, NormalHasTheMomentsAndTheTailsOfAGaussian) {
  Random random(3);
  std::array<double, 5> moment{};
  int within_one = 0;
  int beyond_three = 0;
  for (int k = 0; k < kDraws; ++k) {
    const double x = random.normal();
    double power = 1;
    for (double& m : moment) {
      m += power / kDraws;
      power *= x;
    }
    within_one += std::abs(x) < 1 ? 1 : 0;
    beyond_three += std::abs(x) > 3 ? 1 : 0;
  }
  EXPECT_NEAR(moment[1], 0, four_errors(1));
  EXPECT_NEAR(moment[2], 1, four_errors(2));   // <x^4> - 1
  EXPECT_NEAR(moment[3], 0, four_errors(15));  // <x^6>
  EXPECT_NEAR(moment[4], 3, four_errors(96));  // <x^8> - 9
  EXPECT_NEAR(static_cast<double>(within_one) / kDraws, 0.6826894921, four_errors(0.6827 * 0.3173));
  EXPECT_NEAR(static_cast<double>(beyond_three) / kDraws, 0.0026997961, four_errors(0.0027));
}

TEST(Random, NormalsThatFollowEachOtherAreUncorrelated) {
  Random random(4);
  double first = 0;
  double squares = 0;
  double last = random.normal();
  for (int k = 0; k < kDraws; ++k) {
    const double x = random.normal();
    first += x * last / kDraws;
    squares += (x * x - 1) * (last * last - 1) / kDraws;
    last = x;
  }
  EXPECT_NEAR(first, 0, four_errors(1));
  EXPECT_NEAR(squares, 0, four_errors(4));
}

/// The moments of a uniform direction: <v> = 0, <v v^T> = 1/3, <v_i^4> = 1/5.
struct DirectionMoments {
  Vector3d mean = Vector3d::Zero();
  Matrix3d square = Matrix3d::Zero();
  Vector3d fourth = Vector3d::Zero();

  void add(const Vector3d& v) {
    EXPECT_NEAR(v.norm(), 1, 1e-15);
    mean += v / kDraws;
    square += v * v.transpose() / kDraws;
    fourth += v.cwiseAbs2().cwiseAbs2() / kDraws;
  }
  void expect_isotropic() const {
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(mean[i], 0, four_errors(1.0 / 3));
      EXPECT_NEAR(fourth[i], 1.0 / 5, four_errors(1.0 / 9 - 1.0 / 25));
      for (int j = 0; j < 3; ++j) {
        EXPECT_NEAR(square(i, j), i == j ? 1.0 / 3 : 0, four_errors(i == j ? 4.0 / 45 : 1.0 / 15));
      }
    }
  }
};

TEST(Random, DirectionIsIsotropic) {
  Random random(5);
  DirectionMoments moments;
  for (int k = 0; k < kDraws; ++k) moments.add(random.direction());
  moments.expect_isotropic();
}

TEST(Random, RotationIsUniformOverAllOrientations) {
  Random random(6);
  std::array<DirectionMoments, 3> columns;
  double trace = 0;
  double trace2 = 0;
  for (int k = 0; k < kDraws; ++k) {
    const Matrix3d R = random.rotation();
    // Made orthogonal from two directions that are at least 0.01 from parallel: a few rounding errors over that.
    ASSERT_LE((R.transpose() * R - Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-13);
    ASSERT_NEAR(R.determinant(), 1, 1e-13);
    for (int i = 0; i < 3; ++i) columns[static_cast<std::size_t>(i)].add(R.col(i));
    trace += R.trace() / kDraws;
    trace2 += R.trace() * R.trace() / kDraws;
  }
  for (const DirectionMoments& moments : columns) moments.expect_isotropic();
  // Characters of the rotation group: <tr> = 0, <tr^2> = 1, <tr^4> = 3.
  EXPECT_NEAR(trace, 0, four_errors(1));
  EXPECT_NEAR(trace2, 1, four_errors(2));
}

}  // namespace
