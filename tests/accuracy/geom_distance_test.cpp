/// Accuracy of distance() against long double, cold, in classes of aspect ratio: the table that the header's contract
/// rests on. Every class is asserted, and the table is printed. HARDBODY_FULL=1: 10,000,000 pairs instead of 1,000,000.

#include "common/full_form.h"
#include "common/geom/long_double.h"
#include "common/geom/manufactured.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::LongDistance;
using geom_test::ManufacturedPair;
using geom_test::Random;

const int kExtremePairs = geom_test::repetitions(100'000);

// The contract of distance.h.
constexpr double kDistanceTolerance = 1e-13;       // relative to |p_AB| + both bounding radii
constexpr double kNormalTolerance = 1e-7;          // radian
constexpr double kTypicalNormalTolerance = 1e-12;  // radian; the median of each class, and 99 % of all pairs

int random_pairs() {
  return full_form() ? 10'000'000 : geom_test::repetitions(1'000'000);
}

/// One row of a table.
struct Row {
  std::string name;
  int pairs = 0;
  int failures = 0;      ///< declined, or with the wrong status
  int unsettled = 0;     ///< the reference did not converge
  double max_error = 0;  ///< error of the distance, over the size of the pair
  double sum_error = 0;
  std::vector<float> normal_errors;
  long iterations = 0;
  int max_iterations = 0;

  void add(const Row& row) {
    pairs += row.pairs;
    failures += row.failures;
    unsettled += row.unsettled;
    max_error = std::max(max_error, row.max_error);
    sum_error += row.sum_error;
    normal_errors.insert(normal_errors.end(), row.normal_errors.begin(), row.normal_errors.end());
    iterations += row.iterations;
    max_iterations = std::max(max_iterations, row.max_iterations);
  }

  /// The error of a normal that a share of them does not exceed.
  double normal_quantile(double share) const {
    if (normal_errors.empty()) return 0;
    std::vector<float> errors = normal_errors;
    const auto k = static_cast<std::ptrdiff_t>(share * static_cast<double>(errors.size() - 1));
    std::nth_element(errors.begin(), errors.begin() + k, errors.end());
    return static_cast<double>(errors[static_cast<std::size_t>(k)]);
  }
};

void measure(const Ellipsoid& a, const Ellipsoid& b, double gap, Random& random, Row& row) {
  const ManufacturedPair pair = geom_test::manufacture(a, b, gap, random);
  const DistanceResult r = distance(a, pair.X_WA, b, pair.X_WB);
  const LongDistance reference = geom_test::long_distance(a, pair.X_WA, b, pair.X_WB, pair.normal);
  ++row.pairs;
  row.unsettled += !reference.converged;
  row.iterations += r.iterations;
  row.max_iterations = std::max(row.max_iterations, r.iterations);
  const auto wanted = gap > 0 ? DistanceStatus::separated : DistanceStatus::overlapping;
  if (r.status != wanted) {
    ++row.failures;
    return;
  }
  const double error = std::abs(static_cast<double>(static_cast<long double>(r.distance) - reference.distance));
  row.max_error = std::max(row.max_error, error / pair.size);
  row.sum_error += error / pair.size;
  row.normal_errors.push_back(static_cast<float>((r.normal.cast<long double>() - reference.normal).norm()));
}

/// Gaps log-uniform in [1e-10, 10]; a quarter of the pairs overlap, half of these by log-uniform depths in [1e-10,
/// 1e-2], half of them by up to 0.9 of the certified depth, which is 2e-2 or more. Deeper, up to all of it, the maximum
/// of g becomes flat and the normal as uncertain as rounding over what is left of its curvature.
double random_gap(const Ellipsoid& a, const Ellipsoid& b, Random& random) {
  const double kind = random.uniform();
  if (kind < 0.75) return random.log_uniform(1e-10, 10);
  const double certified = a.min_curvature_radius() + b.min_curvature_radius();
  if (kind < 0.875) return -std::min(random.log_uniform(1e-10, 1e-2), 0.9 * certified);
  // Not shallower than rounding, where the status may be either.
  return -certified * random.uniform(1e-6, 0.9);
}

void print(const std::string& title, const std::vector<Row>& rows) {
  std::printf("\n%s\n%-16s %9s %9s %11s %11s %11s %11s %11s %10s %6s\n", title.c_str(), "class", "pairs", "failures",
              "max err", "mean err", "normal 50%", "normal 99%", "max normal", "iterations", "max");
  for (const Row& row : rows) {
    std::printf("%-16s %9d %9d %11.2e %11.2e %11.2e %11.2e %11.2e %10.2f %6d\n", row.name.c_str(), row.pairs,
                row.failures, row.max_error, row.sum_error / row.pairs, row.normal_quantile(0.5),
                row.normal_quantile(0.99), row.normal_quantile(1), static_cast<double>(row.iterations) / row.pairs,
                row.max_iterations);
  }
  std::printf("err: |distance - reference| / size of the pair; normal: radian; iterations: evaluations of the pair\n");
}

void expect_contract(const std::vector<Row>& rows) {
  for (const Row& row : rows) {
    EXPECT_GT(row.pairs, 0) << row.name;
    EXPECT_EQ(row.unsettled, 0) << row.name;
    EXPECT_EQ(row.failures, 0) << row.name;
    EXPECT_LE(row.max_error, kDistanceTolerance) << row.name;
    EXPECT_LE(row.normal_quantile(1), kNormalTolerance) << row.name;
    EXPECT_LE(row.normal_quantile(0.5), kTypicalNormalTolerance) << row.name;
  }
}

Row total(const std::vector<Row>& rows) {
  Row sum;
  sum.name = "all";
  for (const Row& row : rows) sum.add(row);
  return sum;
}

TEST(Accuracy, OfRandomPairsIsThatOfTheContract) {
  const int pairs = random_pairs();
  // Classes of A's aspect ratio; B's is the same in half of the pairs, else drawn from all of them.
  const std::vector<double> edges{0.1, 0.2, 0.5, 0.8, 1.25, 2, 5, 10};
  std::vector<Row> rows(edges.size() - 1);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    char name[32];
    std::snprintf(name, sizeof name, "X0 %g..%g", edges[k], edges[k + 1]);
    rows[k].name = name;
  }
  Random random(1);
  for (int i = 0; i < pairs / 2; ++i) {
    const double X0 = random.log_uniform(edges.front(), edges.back());
    const Ellipsoid a = random.spheroid(X0);
    const Ellipsoid b = random.spheroid(random.coin() ? X0 : random.log_uniform(edges.front(), edges.back()));
    const auto above = std::upper_bound(edges.begin() + 1, edges.end() - 1, X0);
    const double gap = random_gap(a, b, random);
    measure(a, b, gap, random, rows[static_cast<std::size_t>(above - edges.begin() - 1)]);
  }
  for (const double ratio : {1.1, 2.0, 10.0}) {
    Row row;
    char name[32];
    std::snprintf(name, sizeof name, "biaxial, <= %g", ratio);
    row.name = name;
    for (int i = 0; i < pairs / 8; ++i) {
      const Ellipsoid a = random.biaxial(ratio);
      const Ellipsoid b = random.biaxial(ratio);
      measure(a, b, random_gap(a, b, random), random, row);
    }
    rows.push_back(std::move(row));
  }
  Row mixed;
  mixed.name = "X0 and biaxial";
  for (int i = 0; i < pairs / 8; ++i) {
    const Ellipsoid a = random.spheroid(random.log_uniform(edges.front(), edges.back()));
    const Ellipsoid b = random.biaxial(10);
    random.coin() ? measure(a, b, random_gap(a, b, random), random, mixed)
                  : measure(b, a, random_gap(a, b, random), random, mixed);
  }
  rows.push_back(std::move(mixed));
  rows.push_back(total(rows));
  EXPECT_EQ(rows.back().pairs, pairs / 2 + 4 * (pairs / 8));
  print("Ellipsoids, cold start", rows);
  expect_contract(rows);
  EXPECT_LE(rows.back().normal_quantile(0.99), kTypicalNormalTolerance);
}

TEST(Accuracy, OfExtremeShapesIsThatOfTheContract) {
  // Up to 1e6 between the two bodies' extents. Gaps from 1e-6: rounding of 1e-13 * 4000 must not decide the status.
  std::vector<Row> rows(2);
  rows[0].name = "uniaxial";
  rows[1].name = "biaxial";
  Random random(3);
  for (int i = 0; i < kExtremePairs / 2; ++i) {
    const Ellipsoid u_a = random.spheroid(random.log_uniform(1e-3, 1e3));
    const Ellipsoid u_b = random.spheroid(random.log_uniform(1e-3, 1e3));
    measure(u_a, u_b, random.log_uniform(1e-6, 10), random, rows[0]);
    const Ellipsoid b_a = random.biaxial(1e3);
    const Ellipsoid b_b = random.biaxial(1e3);
    measure(b_a, b_b, random.log_uniform(1e-6, 10), random, rows[1]);
  }
  print("Aspect ratios to 1000, apart, cold start", rows);
  expect_contract(rows);
}

}  // namespace
}  // namespace geom
