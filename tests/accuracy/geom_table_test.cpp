/// The table of docs/accuracy.md: errors of distance() by pair of shapes and gap. tools/accuracy writes it.
///
/// Known answers: B is put so that the support points of a random normal are the witness points. The reference is g at
/// that normal, so that the rounding of B's position does not count. HARDBODY_FULL=1: 100,000 pairs a row instead of
/// 1,000.

#include "common/geom_manufactured.h"
#include "common/geom_random.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::Random;

/// What is asserted: the contract of distance.h, of the size of the pair.
constexpr double kEllipsoids = 1e-13;
constexpr double kSuperellipsoids = 1e-12;

Vector3d random_axes(Random& random) {
  return {random.uniform(0.4, 1), random.uniform(0.4, 1), 1};
}

template <class MakeA, class MakeB>
void row(const char* name, double gap, double tolerance, const MakeA& make_a, const MakeB& make_b) {
  const long pairs = std::getenv("HARDBODY_FULL") != nullptr ? 100000 : 1000;
  Random random(1);
  std::vector<double> errors;
  long failures = 0;
  long iterations = 0;
  double bound = 0;
  for (long k = 0; k < pairs; ++k) {
    const auto a = make_a(random);
    const auto b = make_b(random);
    const auto pair = geom_test::manufacture(a, b, gap, random);
    double wanted = geom_test::lower_bound(a, pair.X_WA, b, pair.X_WB, pair.normal);
    const DistanceResult r = distance(a, pair.X_WA, b, pair.X_WB);
    // Bodies pushed into each other may have a shorter way out than back, past a sharp edge.
    if (wanted < 0 && r.distance > wanted) wanted = geom_test::lower_bound(a, pair.X_WA, b, pair.X_WB, r.normal);
    iterations += r.iterations;
    const bool answered = r.status == (wanted > 0 ? DistanceStatus::separated : DistanceStatus::overlapping);
    const double error = std::abs(r.distance - wanted) / pair.size;
    if (!answered || !(error <= tolerance)) ++failures;
    if (!answered) continue;
    errors.push_back(error);
    bound = std::max(bound, r.error_bound / pair.size);
  }
  std::sort(errors.begin(), errors.end());
  std::printf("| %s | %g | %ld | %ld | %.1e | %.1e | %.1e | %.1f |\n", name, gap, pairs, failures,
              errors[errors.size() / 2], errors.back(), bound,
              static_cast<double>(iterations) / static_cast<double>(pairs));
  EXPECT_EQ(failures, 0) << name << ", gap " << gap;
  EXPECT_LE(bound, gap > 0 ? kBoundGap : kDepthGap) << name << ", gap " << gap;
}

template <class MakeA, class MakeB>
void rows(const char* name, double tolerance, const MakeA& make_a, const MakeB& make_b) {
  for (const double gap : {1.0, 1e-3, 1e-6, 1e-9, -1e-6, -1e-4}) row(name, gap, tolerance, make_a, make_b);
}

TEST(AccuracyTable, IsWithinTheContract) {
  std::printf("| pair | gap | pairs | failures | median error | largest error | largest error bound | evaluations |\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  const auto spheroid = [](double X0) { return [X0](Random&) { return Ellipsoid({1, 1, X0}); }; };
  rows("spheres", kEllipsoids, spheroid(1), spheroid(1));
  rows("spheroids, X0 = 0.1", kEllipsoids, spheroid(0.1), spheroid(0.1));
  rows("spheroids, X0 = 3", kEllipsoids, spheroid(3), spheroid(3));
  rows("spheroids, X0 = 10", kEllipsoids, spheroid(10), spheroid(10));
  rows("spheroids, X0 = 0.1 and 10", kEllipsoids, spheroid(0.1), spheroid(10));
  const auto biaxial = [](Random& random) { return random.biaxial(10); };
  rows("ellipsoids, ratios to 10", kEllipsoids, biaxial, biaxial);
  for (const double e : {0.2, 0.3, 0.5, 0.7, 1.3, 1.6}) {
    const auto body = [e](Random& random) { return Superellipsoid(random_axes(random), e, e); };
    char name[64];
    (void)std::snprintf(name, sizeof name, "superellipsoids, e = %g", e);
    rows(name, kSuperellipsoids, body, body);
  }
  const auto any = [](Random& random) {
    return Superellipsoid(random_axes(random), random.uniform(0.2, 1.6), random.uniform(0.2, 1.6));
  };
  rows("superellipsoids, e1, e2 = 0.2 to 1.6", kSuperellipsoids, any, any);
  rows("ellipsoid and superellipsoid", kSuperellipsoids, biaxial, any);
}

}  // namespace
}  // namespace geom
