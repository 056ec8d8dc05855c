// The kernels of sums of products of phases: all have the bits of the portable one, which has the sums.

#include "vectors/products.h"

#include <ed/random.h>

#include <geom/batch.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <utility>
#include <vector>

namespace {

using ed::internal::PhaseRows;
using ed::internal::ProductKernel;
using ed::internal::ProductSums;

constexpr int kPhasesOfTest = 44;

struct PhasesOfTest {
  std::array<std::vector<double>, 3> re, im;

  explicit PhasesOfTest(ed::Random& random) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < kPhasesOfTest; ++i) {
        const double angle = 10 * random.normal();
        re[axis].push_back(std::cos(angle));
        im[axis].push_back(std::sin(angle));
      }
    }
  }

  PhaseRows rows(const std::array<double, 3>& sign) const {
    PhaseRows result{};
    for (int axis = 0; axis < 3; ++axis) {
      result.re[axis] = re[axis].data();
      result.im[axis] = im[axis].data();
      result.sign[axis] = sign[axis];
    }
    return result;
  }
};

TEST(Products, OfThePortableKernelAreThoseOfComplexNumbers) {
  ed::Random random(3);
  const PhasesOfTest phases(random);
  const std::array<double, 3> sign = {1, -1, -1};
  std::array<std::complex<double>, 2> wanted = {};
  for (int i = 0; i < kPhasesOfTest; ++i) {
    std::complex<double> product = 1;
    for (int axis = 0; axis < 3; ++axis) product *= std::complex(phases.re[axis][i], sign[axis] * phases.im[axis][i]);
    wanted[i % 2] += product;
  }
  ProductSums sums{};
  ed::internal::product_kernel_portable()(phases.rows(sign), kPhasesOfTest, sums);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(sums.re[k], wanted[k].real(), 1e-13);
    EXPECT_NEAR(sums.im[k], wanted[k].imag(), 1e-13);
  }
}

#if defined(__x86_64__)
TEST(Products, HaveTheSameBitsWithEveryInstructionSet) {
  ed::Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const PhasesOfTest phases(random);
    const PhaseRows rows = phases.rows({1, trial % 2 == 0 ? 1.0 : -1.0, trial % 3 == 0 ? 1.0 : -1.0});
    for (const int bodies : {0, 4, 8, kPhasesOfTest}) {
      ProductSums wanted{{0.5, -1}, {2, 3}};
      ProductSums sums = wanted;
      ed::internal::product_kernel_portable()(rows, bodies, wanted);
      for (const auto& [set, kernel] :
           {std::pair{geom::InstructionSet::avx2, ed::internal::product_kernel_avx2()},
            std::pair{geom::InstructionSet::avx512, ed::internal::product_kernel_avx512()}}) {
        if (!geom::is_available(set)) continue;
        ProductSums found{{0.5, -1}, {2, 3}};
        kernel(rows, bodies, found);
        for (int k = 0; k < 2; ++k) {
          EXPECT_EQ(found.re[k], wanted.re[k]) << geom::to_string(set);
          EXPECT_EQ(found.im[k], wanted.im[k]) << geom::to_string(set);
        }
      }
      ed::internal::find_product_kernel()(rows, bodies, sums);
      for (int k = 0; k < 2; ++k) {
        EXPECT_EQ(sums.re[k], wanted.re[k]);
        EXPECT_EQ(sums.im[k], wanted.im[k]);
      }
    }
  }
}
#endif

}  // namespace
