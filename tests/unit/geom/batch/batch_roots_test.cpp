/// Roots and inverses of the batch kernels, for each instruction set that the processor has: as exact as
/// batch/vectors-inl.h says.

#include "unit/geom/batch/batch_roots.h"

#include "common/geom/random.h"

#include <geom/batch.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace geom {
namespace {

/// Returns the error in units of the last place of a double.
double ulps(double found, long double exact) {
  const double near = static_cast<double>(exact);
  const double unit = std::nextafter(near, 2 * near) - near;
  return static_cast<double>(std::abs(static_cast<long double>(found) - exact)) / unit;
}

/// Functions of one instruction set, with their largest errors: in units of the last place, and relative for the last.
struct RootsOf {
  InstructionSet set;
  void (*roots)(const double* x, double* root, double* inverse_root, double* near_inverse);
  double root, inverse_root, near_inverse;
};

/// Processors' own roots and quotients are rounded correctly, and five of them make an inverse root; those from
/// estimates have 1.4 units in the last place and 40 bits.
const std::array<RootsOf, 3> kRoots = {{
    {InstructionSet::portable, geom_test::roots_portable, 0.501, 5, std::ldexp(1.0, -52)},
    {InstructionSet::avx2, geom_test::roots_avx2, 0.501, 5, std::ldexp(1.0, -52)},
    {InstructionSet::avx512, geom_test::roots_avx512, 1.4, 1.4, std::ldexp(1.0, -40)},
}};

void expect_exact(const RootsOf& of) {
  geom_test::Random random(1);
  double worst_root = 0;
  double worst_inverse_root = 0;
  double worst_near_inverse = 0;
  for (int round = 0; round < 100000; ++round) {
    using Numbers = std::array<double, geom_test::kRootsAtOnce>;
    Numbers x, root, inverse_root, near_inverse;
    for (double& number : x) number = random.log_uniform(1e-30, 1e30);
    of.roots(x.data(), root.data(), inverse_root.data(), near_inverse.data());
    for (std::size_t k = 0; k < x.size(); ++k) {
      const long double exact = std::sqrt(static_cast<long double>(x[k]));
      worst_root = std::max(worst_root, ulps(root[k], exact));
      worst_inverse_root = std::max(worst_inverse_root, ulps(inverse_root[k], 1 / exact));
      worst_near_inverse = std::max(worst_near_inverse, std::abs(near_inverse[k] * x[k] - 1));
    }
  }
  EXPECT_LE(worst_root, of.root);
  EXPECT_LE(worst_inverse_root, of.inverse_root);
  EXPECT_LE(worst_near_inverse, of.near_inverse);
}

TEST(BatchRoots, AreAsExactAsTheirCommentsSay) {
  ASSERT_TRUE(is_available(InstructionSet::portable));
  for (const RootsOf& of : kRoots) {
    SCOPED_TRACE(to_string(of.set));
    if (is_available(of.set)) expect_exact(of);
  }
}

}  // namespace
}  // namespace geom
