/// The table data/accuracy/pairs.csv: errors of distance() by pair of shapes and gap. tools/accuracy writes it.
///
/// Known answers: B is put so that the support points of a random normal are the witness points. The reference is g at
/// that normal, so that the rounding of B's position does not count. HARDBODY_FULL=1: 100,000 pairs a row instead of
/// 1,000.

#include "common/full_form.h"
#include "common/geom/accuracy_rows.h"
#include "common/geom/manufactured.h"
#include "common/geom/random.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace geom {
namespace {

using geom_test::Random;

template <class MakeA, class MakeB>
void row(const char* name, double gap, double tolerance, const MakeA& make_a, const MakeB& make_b) {
  const long pairs = full_form() ? 100000 : 1000;
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

TEST(AccuracyTable, IsWithinTheContract) {
  std::printf("| pair | gap | pairs | failures | median error | largest error | largest error bound | evaluations |\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  geom_test::for_each_pair_of_shapes([](const char* name, double tolerance, const auto& make_a, const auto& make_b) {
    for (const double gap : geom_test::kGapsApart) row(name, gap, tolerance, make_a, make_b);
    for (const double gap : geom_test::kOverlaps) row(name, gap, tolerance, make_a, make_b);
  });
}

}  // namespace
}  // namespace geom
