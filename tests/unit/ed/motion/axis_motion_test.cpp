// What snapshots hold of a body of revolution: the state that a collision would find, to the last bit.

#include <motion/axis_motion.h>

#include <ed/random.h>

#include <gtest/gtest.h>

namespace {

using ed::internal::AxisMotion;
using ed::internal::BodyFrame;
using ed::internal::UniaxialInertia;
using Eigen::Vector3d;

void expect_the_bits_of_advance(const UniaxialInertia& inertia, bool turns) {
  ed::Random random(5);
  for (int k = 0; k < 2000; ++k) {
    const Vector3d u = random.direction();
    AxisMotion motion{};
    BodyFrame frame;
    frame.x_axis = u.unitOrthogonal();
    frame.spin = inertia.spins ? random.uniform() - 0.5 : 0;
    motion.velocity = random.direction();
    const Vector3d omega = turns ? Vector3d(3 * random.direction().cross(u)) : Vector3d::Zero();
    ed::internal::set_rotation(inertia, u, omega, motion, frame);
    ed::internal::advance(inertia, 0.1, motion, frame);  // rounding and integrals that are not zero
    const double t = k % 100 == 0 ? motion.time : 0.1 + 5 * random.uniform();
    const ed::internal::SampledRotation sampled = ed::internal::sampled(inertia, t, motion, frame);
    ed::internal::advance(inertia, t, motion, frame);
    ASSERT_EQ(sampled.axis, motion.axis());
    ASSERT_EQ(sampled.omega, ed::internal::omega_across(motion));
    ASSERT_EQ(sampled.phi_lab, frame.phi_lab);
    ASSERT_EQ(sampled.phi_body, frame.phi_body);
  }
}

TEST(AxisMotion, IsSampledWithTheBitsOfTheStateWithoutSpin) {
  expect_the_bits_of_advance({1, 0.7, 0.4, false}, true);
}

TEST(AxisMotion, IsSampledWithTheBitsOfTheStateWithSpin) {
  expect_the_bits_of_advance({1, 0.7, 0.4, true}, true);
}

TEST(AxisMotion, IsSampledWithTheBitsOfTheStateAtRest) {
  expect_the_bits_of_advance({1, 0.7, 0.4, false}, false);
}

}  // namespace
