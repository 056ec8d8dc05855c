/// Roots and inverses from the processor's estimates: as exact as batch/vectors-inl.h says.

#include "unit/geom/batch/batch_roots.h"

#include "common/geom_random.h"

#include <geom/batch.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace geom {
namespace {

/// Returns the error in units of the last place of a double.
double ulps(double found, long double exact) {
  const double near = static_cast<double>(exact);
  const double unit = std::nextafter(near, 2 * near) - near;
  return static_cast<double>(std::abs(static_cast<long double>(found) - exact)) / unit;
}

TEST(BatchRoots, AreAsExactAsTheirCommentsSay) {
  if (!is_available(InstructionSet::avx512)) GTEST_SKIP() << "this processor has no AVX-512";
  geom_test::Random random(1);
  double worst_root = 0;
  double worst_inverse_root = 0;
  double worst_near_inverse = 0;
  for (int round = 0; round < 100000; ++round) {
    using Numbers = std::array<double, geom_test::kRootsAtOnce>;
    Numbers x, root, inverse_root, near_inverse;
    for (double& number : x) number = random.log_uniform(1e-30, 1e30);
    geom_test::roots_by_estimate(x.data(), root.data(), inverse_root.data(), near_inverse.data());
    for (std::size_t k = 0; k < x.size(); ++k) {
      const long double exact = std::sqrt(static_cast<long double>(x[k]));
      worst_root = std::max(worst_root, ulps(root[k], exact));
      worst_inverse_root = std::max(worst_inverse_root, ulps(inverse_root[k], 1 / exact));
      worst_near_inverse = std::max(worst_near_inverse, std::abs(near_inverse[k] * x[k] - 1));
    }
  }
  EXPECT_LE(worst_root, 1.4);
  EXPECT_LE(worst_inverse_root, 1.4);
  EXPECT_LE(worst_near_inverse, std::ldexp(1.0, -40));
}

}  // namespace
}  // namespace geom
