// The kernel of displacements: one body's bits in every lane, with every instruction set.

#include "vectors/displacements.h"
#include "base/sincos.h"

#include <ed/random.h>

#include <geom/batch.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <cmath>
#include <utility>
#include <vector>

namespace {

using ed::internal::DisplacementKernel;
using ed::internal::kDisplacementsAtATime;
using Eigen::Vector3d;

/// Positions in two frames, some displaced by millions of lengths, some by a millionth of one.
struct DisplacementsOfTest {
  std::vector<Vector3d> from, to;
  std::vector<double> wave_numbers = {2.86, 0.1, 7.5};

  explicit DisplacementsOfTest(ed::Random& random) {
    for (int i = 0; i < kDisplacementsAtATime; ++i) {
      from.push_back(10 * random.normal() * random.direction());
      to.push_back(from.back() + std::pow(10.0, 5 * random.normal() / 3) * random.direction());
    }
  }
};

struct FoundOfTest {
  std::vector<double> squares = std::vector<double>(kDisplacementsAtATime);
  std::vector<double> scattering = std::vector<double>(3 * kDisplacementsAtATime);

  FoundOfTest(DisplacementKernel& kernel, const DisplacementsOfTest& moved) {
    kernel(moved.from[0].data(), moved.to[0].data(), moved.wave_numbers.data(), 3, squares.data(), scattering.data());
  }
};

TEST(Displacements, OfThePortableKernelAreThoseOfEachBody) {
  ed::Random random(3);
  const DisplacementsOfTest moved(random);
  const FoundOfTest found(*ed::internal::displacement_kernel_portable(), moved);
  for (int i = 0; i < kDisplacementsAtATime; ++i) {
    const double square = (moved.to[i] - moved.from[i]).squaredNorm();
    EXPECT_EQ(found.squares[i], square);
    for (int k = 0; k < 3; ++k) {
      const double angle = moved.wave_numbers[k] * std::sqrt(square);
      EXPECT_EQ(found.scattering[k * kDisplacementsAtATime + i], ed::internal::sincos(angle).sin / angle);
    }
  }
}

#if defined(__x86_64__)
TEST(Displacements, HaveTheSameBitsWithEveryInstructionSet) {
  ed::Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const DisplacementsOfTest moved(random);
    const FoundOfTest wanted(*ed::internal::displacement_kernel_portable(), moved);
    for (const auto& [set, kernel] :
         {std::pair{geom::InstructionSet::avx2, ed::internal::displacement_kernel_avx2()},
          std::pair{geom::InstructionSet::avx512, ed::internal::displacement_kernel_avx512()}}) {
      if (!geom::is_available(set)) continue;
      const FoundOfTest found(*kernel, moved);
      EXPECT_EQ(found.squares, wanted.squares) << geom::to_string(set);
      EXPECT_EQ(found.scattering, wanted.scattering) << geom::to_string(set);
    }
    const FoundOfTest chosen(*ed::internal::find_displacement_kernel(), moved);
    EXPECT_EQ(chosen.squares, wanted.squares);
    EXPECT_EQ(chosen.scattering, wanted.scattering);
  }
}
#endif

}  // namespace
