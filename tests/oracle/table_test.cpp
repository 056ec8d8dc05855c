/// The table data/accuracy/libraries.csv: the rows of tests/accuracy/geom_table_test.cpp by other libraries, the first
/// pairs of each. tools/accuracy writes it. HARDBODY_FULL=1: 1,000 pairs a row instead of 50, of CGAL a tenth.

#include "common/full_form.h"
#include "common/geom/accuracy_rows.h"
#include "common/geom/manufactured.h"
#include "common/geom/random.h"

#include <geom/geom.h>
#include <geom/seeds.h>
#if HARDBODY_WITH_CGAL
#include <geom/cgal.h>
#endif

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <type_traits>
#include <vector>

namespace geom {
namespace {

using geom_test::ManufacturedPair;
using geom_test::Random;

/// Errors of one library, over the size of the pairs.
struct Errors {
  std::vector<double> values;
  int declined = 0;

  void add(const WitnessPair& points, double wanted, double size) {
    if (points.status != SeedStatus::usable) {
      ++declined;
      return;
    }
    values.push_back(std::abs((points.point_b - points.point_a).norm() - wanted) / size);
  }
  /// Prints them; at the median they are at most `most`, about what is known of the library (docs/accuracy.md).
  void report(double most) {
    EXPECT_LE(declined, static_cast<int>(values.size()) / 10);
    if (values.empty()) {
      std::printf(" - | - | %d |", declined);
      return;
    }
    std::sort(values.begin(), values.end());
    const double median = values[values.size() / 2];
    std::printf(" %.1e | %.1e | %d |", median, values.back(), declined);
    EXPECT_LE(median, most);
  }
};

template <class MakeA, class MakeB>
void row(const char* name, double gap, double tolerance, const MakeA& make_a, const MakeB& make_b) {
  const int pairs = full_form() ? 1000 : 50;
  Random random(1);
  Errors ours, fcl, ccd;
#if HARDBODY_WITH_CGAL
  Errors cgal;
#endif
  for (int k = 0; k < pairs; ++k) {
    const auto a = make_a(random);
    const auto b = make_b(random);
    const ManufacturedPair pair = geom_test::manufacture(a, b, gap, random);
    const double wanted = geom_test::lower_bound(a, pair.X_WA, b, pair.X_WB, pair.normal);
    const DistanceResult r = distance(a, pair.X_WA, b, pair.X_WB);
    ASSERT_EQ(r.status, DistanceStatus::separated);
    ours.values.push_back(std::abs(r.distance - wanted) / pair.size);
    const Shape any_a = a;
    const Shape any_b = b;
    fcl.add(fcl_seed(any_a, pair.X_WA, any_b, pair.X_WB), wanted, pair.size);
    ccd.add(ccd_seed(any_a, pair.X_WA, any_b, pair.X_WB), wanted, pair.size);
#if HARDBODY_WITH_CGAL
    if (k % 10 == 0) cgal.add(cgal_seed(any_a, pair.X_WA, any_b, pair.X_WB), wanted, pair.size);
#endif
  }
  const double ours_largest = *std::max_element(ours.values.begin(), ours.values.end());
  std::printf("| %s | %g | %.1e |", name, gap, ours_largest);
  EXPECT_LE(ours_largest, tolerance) << name << ", gap " << gap;
  constexpr bool kPolytopes =
      !std::is_same_v<decltype(make_a(random)), Ellipsoid> || !std::is_same_v<decltype(make_b(random)), Ellipsoid>;
  SCOPED_TRACE(testing::Message() << name << ", gap " << gap);
  fcl.report(kPolytopes ? 5e-3 : 1e-4);
  ccd.report(1e-3);
#if HARDBODY_WITH_CGAL
  cgal.report(2e-2);
#else
  std::printf(" - | - | - |");
#endif
  std::printf("\n");
}

TEST(AccuracyTable, OfOtherLibraries) {
  std::printf("| pair | gap | ours, largest | FCL, median | largest | declined |");
  std::printf(" libccd, median | largest | declined | CGAL, median | largest | declined |\n");
  std::printf("|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  geom_test::for_each_pair_of_shapes([](const char* name, double tolerance, const auto& make_a, const auto& make_b) {
    for (const double gap : geom_test::kGapsApart) row(name, gap, tolerance, make_a, make_b);
  });
}

}  // namespace
}  // namespace geom
