// The kernel of rotations: one body's bits in every lane, with every instruction set.

#include "bodies/rotations.h"
#include "motion/axis_motion.h"

#include <ed/random.h>

#include <geom/batch.h>

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace {

using ed::internal::kRotationsAtATime;
using ed::internal::RotationKernel;
using ed::internal::RotationRows;
using Eigen::Vector3d;

/// Bodies after some flight, at rest, slow and fast ones, and what their rotations are.
struct RotationsOfTest {
  RotationRows rows{};
  std::vector<ed::internal::SampledRotation> wanted;

  RotationsOfTest(ed::Random& random, bool spins) {
    const ed::internal::UniaxialInertia inertia{1, 0.7, 0.4, spins};
    for (int lane = 0; lane < kRotationsAtATime; ++lane) {
      const Vector3d u = random.direction();
      ed::internal::AxisMotion motion{};
      ed::internal::BodyFrame frame;
      frame.x_axis = u.unitOrthogonal();
      const double rate = lane == 0 ? 0 : std::pow(10.0, random.normal());
      // One body is at rest in all respects, and one hardly turns about its axis, seen from the momentum.
      frame.spin = !spins || lane == 0 ? 0 : lane == 1 ? 1e-9 : random.normal();
      ed::internal::set_rotation(inertia, u, rate * random.direction().cross(u), motion, frame);
      ed::internal::advance(inertia, 0.1, motion, frame);  // rounding and integrals that are not zero
      const double t = 0.1 + 5 * random.uniform();
      wanted.push_back(ed::internal::sampled(inertia, t, motion, frame));
      rows.dt[lane] = t - motion.time;
      rows.rate[lane] = motion.rate;
      rows.perpendicular[lane] = inertia.perpendicular;
      rows.axial[lane] = inertia.axial;
      rows.spin[lane] = frame.spin;
      for (int k = 0; k < 3; ++k) {
        rows.e0[k][lane] = motion.e0[k];
        rows.e1[k][lane] = motion.e1[k];
        rows.e2[k][lane] = motion.e2[k];
        rows.momentum_dir[k][lane] = frame.momentum_dir[k];
        rows.x_axis[k][lane] = frame.x_axis[k];
        rows.phi_lab[k][lane] = frame.phi_lab[k];
      }
      for (int k = 0; k < 2; ++k) rows.phi_body[k][lane] = frame.phi_body[k];
    }
  }
};

void expect_the_bits_of_each_body(RotationKernel& kernel, const RotationsOfTest& bodies, bool spins) {
  RotationRows found = bodies.rows;
  kernel(found, spins);
  for (int lane = 0; lane < kRotationsAtATime; ++lane) {
    const ed::internal::SampledRotation& wanted = bodies.wanted[static_cast<std::size_t>(lane)];
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(found.axis[k][lane], wanted.axis[k]);
      EXPECT_EQ(found.omega[k][lane], wanted.omega[k]);
      EXPECT_EQ(found.phi_lab[k][lane], wanted.phi_lab[k]);
    }
    for (int k = 0; k < 2; ++k) EXPECT_EQ(found.phi_body[k][lane], wanted.phi_body[k]);
  }
}

class Rotations : public testing::TestWithParam<bool> {};

TEST_P(Rotations, HaveTheBitsOfEachBodyWithEveryInstructionSet) {
  const bool spins = GetParam();
  ed::Random random(6);
  for (int trial = 0; trial < 100; ++trial) {
    const RotationsOfTest bodies(random, spins);
    expect_the_bits_of_each_body(*ed::internal::rotation_kernel_portable(), bodies, spins);
#if defined(__x86_64__)
    for (const auto& [set, kernel] :
         {std::pair{geom::InstructionSet::avx2, ed::internal::rotation_kernel_avx2()},
          std::pair{geom::InstructionSet::avx512, ed::internal::rotation_kernel_avx512()}}) {
      if (!geom::is_available(set)) continue;
      SCOPED_TRACE(geom::to_string(set));
      expect_the_bits_of_each_body(*kernel, bodies, spins);
    }
#endif
    expect_the_bits_of_each_body(*ed::internal::find_rotation_kernel(), bodies, spins);
  }
}

INSTANTIATE_TEST_SUITE_P(Spin, Rotations, testing::Bool());

}  // namespace
