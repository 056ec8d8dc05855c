/// Pooling of replicas: known probabilities, and how often the pooled error contains the true mean.

#include <ed/random.h>
#include <ed/replicas.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <set>
#include <stdexcept>
#include <vector>

namespace {

using ed::Estimate;
using ed::Pooled;

std::vector<Estimate> estimates(const std::vector<double>& values, double error) {
  std::vector<Estimate> list;
  for (const double value : values) list.push_back({value, error});
  return list;
}

TEST(Replicas, SeedsAreThoseOfTheDocumentation) {
  EXPECT_EQ(ed::replica_seed(7, 0), 7);
  EXPECT_EQ(ed::replica_seed(1, 1), 6753131800803418);
  EXPECT_EQ(ed::replica_seed(1, 2), 3354221761027669);
  std::set<std::int64_t> seeds;
  for (std::int64_t seed = 0; seed < 100; ++seed) {
    for (int replica = 0; replica < 100; ++replica) {
      const std::int64_t made = ed::replica_seed(seed, replica);
      EXPECT_GE(made, 0);
      EXPECT_LT(made, ed::kReplicaSeedEnd);
      seeds.insert(made);
    }
  }
  EXPECT_EQ(seeds.size(), 10'000u);
}

TEST(Replicas, TailOfFisherIsExact) {
  // With two degrees of freedom the tail is a power.
  for (const double x : {0.0, 0.1, 1.0, 5.0, 200.0}) {
    for (const double d : {1.0, 7.0, 300.0}) {
      const double exact = std::pow(1 + 2 * x / d, -d / 2);
      EXPECT_NEAR(ed::fisher_tail(x, 2, d), exact, 1e-12 * exact) << x << ' ' << d;
    }
  }
  // With one and one it is that of Cauchy's distribution.
  EXPECT_NEAR(ed::fisher_tail(3, 1, 1), 1 - 2 / M_PI * std::atan(std::sqrt(3.0)), 1e-14);
  // Many in the denominator: that of chi-square, here with four: (1 + c / 2) exp(-c / 2), c = 4 x.
  EXPECT_NEAR(ed::fisher_tail(2, 4, 1e6), 5 * std::exp(-4.0), 1e-6);  // the difference is of the order of 1 / 1e6
}

TEST(Replicas, StudentFactorContainsOneSigma) {
  EXPECT_NEAR(ed::student_factor(2), std::tan(M_PI / 2 * std::erf(std::sqrt(0.5))), 1e-12);
  // Two degrees of freedom: t = p sqrt(2 / (1 - p^2)).
  const double p = std::erf(std::sqrt(0.5));
  EXPECT_NEAR(ed::student_factor(3), p * std::sqrt(2 / (1 - p * p)), 1e-12);
  EXPECT_NEAR(ed::student_factor(100'000), 1, 1e-5);
  EXPECT_THROW((void)ed::student_factor(1), std::invalid_argument);
}

TEST(Replicas, OneIsItself) {
  const Pooled one = ed::pool(std::vector<Estimate>{{3, 0.25}});
  EXPECT_EQ(one.mean.value, 3);
  EXPECT_EQ(one.mean.error, 0.25);
  EXPECT_EQ(one.degrees_of_freedom, 0);
  EXPECT_TRUE(std::isnan(one.chi_square));
  EXPECT_EQ(ed::pool({}).number, 0u);
  EXPECT_TRUE(std::isnan(ed::pool({}).mean.value));
}

TEST(Replicas, ErrorIsTheLargerOne) {
  // A scatter that is much smaller than the errors of the runs says nothing: few values scatter little by chance.
  const Pooled calm = ed::pool(estimates({1, 1.01, 0.99, 1}, 0.2));
  EXPECT_NEAR(calm.mean.error, 0.1, 1e-15);
  EXPECT_NEAR(calm.chi_square, 2 * 0.01 * 0.01 / 0.04, 1e-12);
  EXPECT_GT(calm.probability, 0.99);
  const Pooled wild = ed::pool(estimates({1, 1.4, 0.6, 1}, 0.02));
  EXPECT_NEAR(wild.between, std::sqrt(2 * 0.16 / (4 * 3)), 1e-15);
  EXPECT_NEAR(wild.mean.error, ed::student_factor(4) * wild.between, 1e-15);
  EXPECT_EQ(wild.degrees_of_freedom, 3);
  EXPECT_NEAR(wild.chi_square, 0.32 / (0.02 * 0.02), 1e-9);
  EXPECT_LT(wild.probability, 1e-12);
}

TEST(Replicas, LongerRunsCountMore) {
  const std::vector<Estimate> runs = {{1, 0.1}, {2, 0.05}};
  const Pooled both = ed::pool(runs, std::array{1.0, 4.0});
  EXPECT_NEAR(both.mean.value, 1.8, 1e-15);
  EXPECT_NEAR(both.within, std::hypot(0.2 * 0.1, 0.8 * 0.05), 1e-15);
}

TEST(Replicas, WithoutErrorsOnlyTheScatterIsKnown) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Pooled some = ed::pool(std::vector<Estimate>{{1, nan}, {2, 0.1}, {3, 0.1}});
  EXPECT_EQ(some.mean.value, 2);
  EXPECT_NEAR(some.mean.error, ed::student_factor(3) / std::sqrt(3.0), 1e-15);
  EXPECT_TRUE(std::isnan(some.probability));
  const Pooled exact = ed::pool(estimates({3, 3, 3}, 0));
  EXPECT_EQ(exact.mean.error, 0);
  EXPECT_TRUE(std::isnan(exact.chi_square));
}

TEST(Replicas, OutlierIsNamedIfTheOthersAgree) {
  const Pooled one = ed::pool(estimates({1, 1.1, 0.9, 2, 1}, 0.1));
  ASSERT_TRUE(one.outlier);
  EXPECT_EQ(one.outlier->replica, 3u);
  EXPECT_NEAR(one.outlier->errors, 1 / (0.1 * std::sqrt(1.25)), 1e-9);
  // Two groups: none is the outlier. Of two replicas neither is.
  const Pooled two = ed::pool(estimates({1, 2, 1, 2}, 0.1));
  EXPECT_LT(two.probability, ed::kDisagreement);
  EXPECT_FALSE(two.outlier);
  EXPECT_FALSE(ed::pool(estimates({1, 2}, 0.01)).outlier);
  EXPECT_FALSE(ed::pool(estimates({1, 1.1, 0.9}, 0.1)).outlier);
}

TEST(Replicas, BadInputIsNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Estimate> runs = estimates({1, 2}, 0.1);
  EXPECT_THROW((void)ed::pool(estimates({1, nan}, 0.1)), std::invalid_argument);
  EXPECT_THROW((void)ed::pool(runs, std::array{1.0}), std::invalid_argument);
  EXPECT_THROW((void)ed::pool(runs, std::array{1.0, 0.0}), std::invalid_argument);
}

// ---- How often the error contains the true mean

/// Standard error of a run as it is known: from the scatter of its blocks.
double measured_error(ed::Random& random) {
  double squares = 0;
  for (int k = 1; k < ed::kBlocksOfRun; ++k) {
    const double x = random.normal();
    squares += x * x;
  }
  return std::sqrt(squares / (ed::kBlocksOfRun - 1));
}

/// Rules that were candidates, see docs/decisions/049.
constexpr std::array kRules = {"within", "t between", "larger", "larger, t", "by chi-square"};
constexpr std::size_t kChosen = 3;

/// Number of times that errors contained the mean, and their sum, for each rule.
struct Record {
  std::array<int, kRules.size()> hits{};
  std::array<double, kRules.size()> sums{};
};

void judge(const Pooled& p, double t, Record& record) {
  const double larger = std::fmax(p.within, p.between);
  const double pooled = std::hypot(p.within, p.between) / std::sqrt(2.0);
  const std::array errors = {p.within, t * p.between, larger, p.mean.error,
                             p.probability > 0.05 ? pooled : t * p.between};
  for (std::size_t rule = 0; rule < kRules.size(); ++rule) {
    record.hits[rule] += std::abs(p.mean.value) <= errors[rule] ? 1 : 0;
    record.sums[rule] += errors[rule];
  }
}

/// Runs scatter by `ratio` times the errors that they state: 1 if these are right, more if motion is slower than runs.
TEST(Replicas, ErrorContainsTheMeanAsOftenAsOneSigma) {
  constexpr int kTrials = 4000;
  constexpr double kOneSigma = 0.6827;
  const double slack = 4 * std::sqrt(kOneSigma * (1 - kOneSigma) / kTrials);  // four sigma of the count
  ed::Random random(11);
  std::printf("replicas, scatter/error: how often the error contains the mean, and mean error / true error\n");
  for (const std::size_t number : {2u, 4u, 8u, 16u}) {
    const double t = ed::student_factor(number);
    for (const double ratio : {1.0, 1.5, 3.0}) {
      Record record;
      std::vector<Estimate> runs(number);
      for (int trial = 0; trial < kTrials; ++trial) {
        for (Estimate& run : runs) run = {ratio * random.normal(), measured_error(random)};
        judge(ed::pool(runs), t, record);
      }
      const double truth = ratio / std::sqrt(static_cast<double>(number));
      std::printf("%2zu %3.1f:", number, ratio);
      for (std::size_t rule = 0; rule < kRules.size(); ++rule) {
        std::printf("  %s %.2f, %.2f", kRules[rule], double(record.hits[rule]) / kTrials,
                    record.sums[rule] / kTrials / truth);
      }
      std::printf("\n");
      EXPECT_GT(double(record.hits[kChosen]) / kTrials, kOneSigma - slack) << number << ' ' << ratio;
    }
  }
}

}  // namespace
