/// Long and flat bodies, aspect ratios to 1e4, beside bodies up to 1e6 times smaller: how far distance() gets with
/// them. A table of docs/accuracy.md. HARDBODY_FULL=1: 12,000 pairs a row instead of 600.

#include "common/full_form.h"
#include "common/geom/manufactured.h"
#include "common/geom/random.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>
#include <vector>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::Random;

/// Results of the pairs of one row.
struct ExtremeRow {
  long pairs = 0;
  long wrong = 0;  ///< pairs off by more than both the contract and the error bound, or of the wrong sign
  long declined = 0;
  long certified = 0;  ///< pairs off by more than the contract, by no more than the error bound
  double largest = 0;  ///< error of the distance, over the size of the pair
};

constexpr double kRatios[] = {1, 1e2, 1e4, 1e6};           // of the bodies' largest semi-axes
constexpr double kGaps[] = {1, 1e-3, 1e-6, -1e-6, -1e-3};  // of the smaller body's radius; below 0 of `deepest`
constexpr double kUnits[] = {1e-12, 1, 1e12};              // of the larger body's

template <class A, class B>
void measure(const A& a, const B& b, double gap, double tolerance, Random& random, ExtremeRow& row) {
  const auto pair = geom_test::manufacture(a, b, gap, random);
  double wanted = geom_test::lower_bound(a, pair.X_WA, b, pair.X_WB, pair.normal);
  const DistanceResult r = distance(a, pair.X_WA, b, pair.X_WB);
  ++row.pairs;
  if (r.status != DistanceStatus::separated && r.status != DistanceStatus::overlapping) {
    ++row.declined;
    return;
  }
  // Bodies pushed into each other may have a shorter way out than back, past a sharp edge, or be apart.
  if (wanted < 0 && r.distance > wanted) wanted = geom_test::lower_bound(a, pair.X_WA, b, pair.X_WB, r.normal);
  const double error = std::abs(r.distance - wanted) / pair.size;
  row.largest = std::max(row.largest, error);
  const double allowed = std::max(tolerance, r.error_bound / pair.size + 1e-15);
  // Whether they overlap is certain where the distance is larger than that.
  const bool sign = (r.distance >= 0) == (wanted >= 0) || std::abs(wanted) <= allowed * pair.size;
  if (!sign || (r.distance >= 0) != (r.status == DistanceStatus::separated) || !(error <= allowed)) {
    ++row.wrong;
  } else if (error > tolerance) {
    ++row.certified;
  }
}

/// Semi-axes of a body of that aspect ratio: long, flat or neither, its axes in any order, the longest 1.
Vector3d random_axes(double aspect_ratio, Random& random) {
  Vector3d axes(1, 1, 1 / aspect_ratio);
  const int kind = static_cast<int>(3 * random.uniform());
  if (kind == 0) axes.y() = 1 / aspect_ratio;
  if (kind == 1) axes.y() = random.log_uniform(1 / aspect_ratio, 1);
  for (int k = 2; k > 0; --k) std::swap(axes[k], axes[static_cast<int>((k + 1) * random.uniform())]);
  return axes;
}

/// `deepest`: of overlaps, over the smaller body's smallest semi-axis.
template <class MakeA, class MakeB>
ExtremeRow run(const char* name, double aspect_ratio, double tolerance, double deepest, const MakeA& make_a,
               const MakeB& make_b) {
  const int pairs = full_form() ? 200 : geom_test::repetitions(10);  // a cell
  ExtremeRow row;
  Random random(1);
  for (const double unit : kUnits) {
    for (const double ratio : kRatios) {
      for (const double gap : kGaps) {
        for (int k = 0; k < pairs; ++k) {
          const auto a = make_a(Vector3d(unit * random_axes(aspect_ratio, random)), random);
          const auto b = make_b(Vector3d(unit / ratio * random_axes(aspect_ratio, random)), random);
          const double length =
              gap > 0 ? b.bounding_radius() : deepest * std::min(a.semi_axes().minCoeff(), b.semi_axes().minCoeff());
          if (random.coin()) {
            measure(a, b, gap * length, tolerance, random, row);
          } else {
            measure(b, a, gap * length, tolerance, random, row);
          }
        }
      }
    }
  }
  std::printf("| %s | %g | %ld | %ld | %ld | %ld | %.1e |\n", name, aspect_ratio, row.pairs, row.wrong, row.declined,
              row.certified, row.largest);
  (void)std::fflush(stdout);
  return row;
}

/// Expects of superellipsoids, beyond an aspect ratio of 10 too, that none is wrong and none is declined. No more than
/// 1 % have a last resort's answer, of kWidestGap, instead of the contract's (docs/accuracy.md: 33 of 12,000 at most);
/// up to an aspect ratio of 10 none has.
void expect_certified(const ExtremeRow& row, const char* name, double aspect_ratio) {
  EXPECT_EQ(row.wrong + row.declined, 0) << name << ' ' << aspect_ratio;
  EXPECT_LE(row.certified, aspect_ratio <= 10 ? 0 : row.pairs / 100) << name << ' ' << aspect_ratio;
  EXPECT_LE(row.largest, aspect_ratio <= 10 ? 1e-12 : kWidestGap) << name << ' ' << aspect_ratio;
}

TEST(ExtremeShapes, AreWithinTheContractCertifiedOrDeclined) {
  std::printf("| pair | aspect ratio | pairs | wrong | declined | certified | largest error |\n");
  std::printf("|---|---|---|---|---|---|---|\n");
  const auto ellipsoid = [](const Vector3d& axes, Random&) { return Ellipsoid(axes); };
  const auto uniform = [](double least, double most) {
    return [=](const Vector3d& axes, Random& random) {
      const double e1 = random.uniform(least, most);
      return Superellipsoid(axes, e1, random.uniform(least, most));
    };
  };
  for (const double aspect_ratio : {1.0, 10.0, 1e2, 1e3, 1e4}) {
    const ExtremeRow row = run("ellipsoids", aspect_ratio, 1e-13, 1 / aspect_ratio, ellipsoid, ellipsoid);
    EXPECT_EQ(row.wrong + row.declined + row.certified, 0) << aspect_ratio;
    EXPECT_LE(row.largest, 1e-13) << aspect_ratio;
  }
  const auto superellipsoids = [&](const char* name, double least, double most) {
    for (const double aspect_ratio : {1.0, 10.0, 1e2, 1e3, 1e4}) {
      expect_certified(run(name, aspect_ratio, 1e-12, 1, uniform(least, most), uniform(least, most)), name,
                       aspect_ratio);
    }
  };
  superellipsoids("superellipsoids, e = 0.2 to 1", 0.2, 1);
  superellipsoids("superellipsoids, e = 1 to 1.6", 1, 1.6);
  for (const double aspect_ratio : {1.0, 10.0, 1e2, 1e3, 1e4}) {
    const char* name = "ellipsoid and superellipsoid, e = 0.2 to 1.6";
    expect_certified(run(name, aspect_ratio, 1e-12, 1, ellipsoid, uniform(0.2, 1.6)), name, aspect_ratio);
  }
}

/// The highest of many g: of directions spread evenly in the coordinates in which either body is as long as wide, the
/// best of which is climbed from.
template <class Body>
double deepest_gap(const Body& a, const Body& b, const Pose& X_WA, const Pose& X_WB, Random& random) {
  Vector3d best = Vector3d::UnitX();
  double highest = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < 20000; ++k) {
    const Pose& X = k % 2 == 0 ? X_WA : X_WB;
    const Vector3d& axes = k % 2 == 0 ? a.semi_axes() : b.semi_axes();
    const Vector3d n = (X.rotation() * random.direction().cwiseQuotient(axes)).normalized();
    const double g = geom_test::lower_bound(a, X_WA, b, X_WB, n);
    if (!(g > highest)) continue;
    highest = g;
    best = n;
  }
  const DistanceResult local = distance(a, X_WA, b, X_WB, {.start = best, .penetration = Penetration::local});
  return std::max(highest, geom_test::lower_bound(a, X_WA, b, X_WB, local.normal));
}

struct DeepRow {
  int pairs = 0;
  int declined = 0;
  double error = 0;  ///< largest, by which an answer is deeper than the best of many directions, over the size
  std::vector<double> bounds;  ///< error bounds over the depth
  std::vector<double> milliseconds;
};

/// Returns a pose of B. Its centre is closer to A's than the bodies are thick, so that they overlap whatever their
/// orientations. The orientation is any or, `parallel`, A's but for an angle of about the thickness over the length.
Pose deep_pose(const Pose& X_WA, double aspect_ratio, bool parallel, Random& random) {
  const Vector3d shift = random.uniform(0, 1) / aspect_ratio * random.direction();
  if (!parallel) return Pose(random.pose(0.0).rotation(), shift);
  const Eigen::AngleAxisd turn(random.uniform(0, 1) / aspect_ratio, random.direction());
  return Pose(turn.toRotationMatrix() * X_WA.rotation(), shift);
}

template <class Make>
void expect_deep(const char* name, double aspect_ratio, bool parallel, double largest_error, const Make& make) {
  const int pairs = full_form() ? 200 : geom_test::repetitions(10);
  DeepRow row;
  Random random(3);
  for (int k = 0; k < pairs; ++k) {
    const auto a = make(aspect_ratio, random);
    const auto b = make(aspect_ratio, random);
    const Pose X_WA = random.pose(0.0);
    const Pose X_WB = deep_pose(X_WA, aspect_ratio, parallel, random);
    const auto before = std::chrono::steady_clock::now();
    const DistanceResult r = distance(a, X_WA, b, X_WB);
    const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - before;
    row.milliseconds.push_back(taken.count());
    ++row.pairs;
    if (r.status != DistanceStatus::overlapping) {
      ++row.declined;
      continue;
    }
    const double size = X_WB.position().norm() + a.bounding_radius() + b.bounding_radius();
    const double best = deepest_gap(a, b, X_WA, X_WB, random);
    row.error = std::max(row.error, (best - r.distance) / size);
    row.bounds.push_back(-r.error_bound / r.distance);
    EXPECT_LE(best, r.distance + r.error_bound + 1e-15 * size) << name << ' ' << aspect_ratio;
    EXPECT_LE(r.error_bound, kWidestDepthGap * size) << name << ' ' << aspect_ratio;
  }
  std::sort(row.bounds.begin(), row.bounds.end());
  std::sort(row.milliseconds.begin(), row.milliseconds.end());
  const auto median = [](const std::vector<double>& v) { return v.empty() ? std::nan("") : v[v.size() / 2]; };
  std::printf("| %s | %g | %d | %d | %.1e | %.1e | %.1e | %.2f | %.2f |\n", name, aspect_ratio, row.pairs, row.declined,
              row.error, median(row.bounds), row.bounds.empty() ? std::nan("") : row.bounds.back(),
              median(row.milliseconds), row.milliseconds.back());
  (void)std::fflush(stdout);
  // Parallel needles 10,000 times as long as thick can have a way out that is shorter by 1 % of the thickness.
  EXPECT_LE(row.error, aspect_ratio <= 1e3 ? 1e-13 : largest_error) << name << ' ' << aspect_ratio;
  EXPECT_EQ(row.declined, 0) << name << ' ' << aspect_ratio;
}

/// Finds the shortest way out, to an aspect ratio of 1000. How much of that is proved depends on the length: error
/// bounds are relative to it, not to the thickness.
TEST(ExtremeShapes, DeepInEachOther) {
  std::printf(
      "| pair | aspect ratio | pairs | declined | largest error | bound / depth, median | largest | ms, median |"
      " largest |\n");
  const auto needle = [](double ratio, Random&) { return Ellipsoid({1 / ratio, 1 / ratio, 1}); };
  const auto disc = [](double ratio, Random&) { return Ellipsoid({1, 1, 1 / ratio}); };
  const auto any = [](double least, double most) {
    return [=](double ratio, Random& random) {
      const Vector3d axes = random.coin() ? Vector3d(1 / ratio, 1 / ratio, 1) : Vector3d(1, 1, 1 / ratio);
      const double e1 = random.uniform(least, most);
      return Superellipsoid(axes, e1, random.uniform(least, most));
    };
  };
  const auto rows = [](const char* name, bool parallel, double largest_error, const auto& make) {
    for (const double ratio : {1.0, 10.0, 100.0, 1e3, 1e4}) expect_deep(name, ratio, parallel, largest_error, make);
  };
  rows("needles, ellipsoids", false, 1e-12, needle);
  rows("the same, nearly parallel", true, 1e-12, needle);
  rows("discs, ellipsoids", false, 1e-12, disc);
  rows("the same, nearly parallel", true, 1e-12, disc);
  rows("superellipsoids, long or flat", false, 1e-12, any(0.3, 1.5));
  rows("the same, nearly parallel", true, 1e-12, any(0.3, 1.5));
}

}  // namespace
}  // namespace geom
