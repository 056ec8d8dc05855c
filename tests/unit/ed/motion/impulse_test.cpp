#include <ed/impulse.h>
#include <ed/random.h>

#include <common/finder/ensemble.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <gtest/gtest.h>

#include <cmath>

namespace {

using ed::collide;
using ed::ContactBody;
using ed::normal_velocity;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Any mass, any three moments, any arm: nothing ties the contact point to a surface or to the normal.
ContactBody draw(ed::Random& random) {
  ContactBody body;
  body.inverse_mass = finder_test::log_uniform(random, 0.1, 10);
  const Matrix3d R = random.rotation();
  const Vector3d inverse(finder_test::log_uniform(random, 0.1, 10), finder_test::log_uniform(random, 0.1, 10),
                         finder_test::log_uniform(random, 0.1, 10));
  body.inverse_inertia = R * inverse.asDiagonal() * R.transpose();
  body.arm = random.normal3();
  body.velocity = random.normal3();
  body.angular_velocity = random.normal3();
  return body;
}

double energy(const ContactBody& b) {
  return 0.5 * b.velocity.squaredNorm() / b.inverse_mass +
         0.5 * b.angular_velocity.dot(b.inverse_inertia.inverse() * b.angular_velocity);
}

Vector3d momentum(const ContactBody& b) {
  return b.velocity / b.inverse_mass;
}

/// Returns the angular momentum about the contact point, where the centre is at -arm.
Vector3d angular_momentum(const ContactBody& b) {
  return Vector3d(-b.arm).cross(momentum(b)) + b.inverse_inertia.inverse() * b.angular_velocity;
}

void expect_unchanged(const ContactBody& before, const ContactBody& after) {
  EXPECT_EQ(before.velocity, after.velocity);
  EXPECT_EQ(before.angular_velocity, after.angular_velocity);
}

TEST(Collide, ConservesWhatItMustForEveryNormal) {
  ed::Random random(31);
  int collisions = 0;
  for (int k = 0; k < 20'000; ++k) {
    ContactBody a = draw(random);
    ContactBody b = draw(random);
    const Vector3d n = random.direction();
    const double v_n = normal_velocity(a, b, n);
    const ContactBody a0 = a;
    const ContactBody b0 = b;
    const double J = collide(a, b, n);
    if (v_n >= 0) {
      EXPECT_EQ(J, 0);
      expect_unchanged(a0, a);
      expect_unchanged(b0, b);
      continue;
    }
    ++collisions;
    EXPECT_GT(J, 0);
    // Rounding only: some tens of operations, on numbers as large as the largest energy and momentum in play (the
    // inverse of the inertia, condition 100, is this test's).
    const double E = energy(a0) + energy(b0);
    EXPECT_NEAR(energy(a) + energy(b), E, 1e-13 * (E + J * J));
    const double P = momentum(a0).norm() + momentum(b0).norm() + J;
    EXPECT_LE((momentum(a) + momentum(b) - momentum(a0) - momentum(b0)).norm(), 1e-14 * P);
    const double L = angular_momentum(a0).norm() + angular_momentum(b0).norm() + J * (a.arm.norm() + b.arm.norm());
    EXPECT_LE((angular_momentum(a) + angular_momentum(b) - angular_momentum(a0) - angular_momentum(b0)).norm(),
              1e-12 * L);
    EXPECT_NEAR(normal_velocity(a, b, n), -v_n, 1e-13 * (1 + std::abs(v_n) + J * 100));
    // The momentum that B gains is along the normal: no friction.
    EXPECT_LE((momentum(b) - momentum(b0) - J * n).norm(), 1e-14 * P);
  }
  EXPECT_GT(collisions, 8000);
}

TEST(Collide, HeadOnEqualBodiesExchangeVelocities) {
  ContactBody a;
  ContactBody b;
  a.arm = {1, 0, 0};
  b.arm = {-1, 0, 0};
  a.velocity = {2, 0.5, 0};
  b.velocity = {-1, 0, 0.25};
  EXPECT_EQ(collide(a, b, Vector3d::UnitX()), 3);
  EXPECT_EQ(a.velocity, Vector3d(-1, 0.5, 0));
  EXPECT_EQ(b.velocity, Vector3d(2, 0, 0.25));
  EXPECT_EQ(a.angular_velocity, Vector3d(0, 0, 0));
}

TEST(Collide, OffCentreHitOnABarSetsItTurning) {
  // A ball of mass 1 at speed 1 hits a bar of mass 1 and inertia 1/3 at distance 1 from its centre:
  // J = 2 / (1 + 1 + 3).
  ContactBody ball;
  ball.velocity = {0, 1, 0};
  ball.arm = {0, 1, 0};
  ContactBody bar;
  bar.inverse_inertia = 3 * Matrix3d::Identity();
  bar.arm = {1, 0, 0};
  EXPECT_NEAR(collide(ball, bar, Vector3d::UnitY()), 0.4, 1e-15);
  EXPECT_NEAR(ball.velocity.y(), 0.6, 1e-15);
  EXPECT_NEAR(bar.velocity.y(), 0.4, 1e-15);
  EXPECT_NEAR(bar.angular_velocity.z(), 1.2, 1e-15);
}

TEST(Collide, ABodyOfInfiniteMassIsAWall) {
  ContactBody wall;
  wall.inverse_mass = 0;
  wall.inverse_inertia.setZero();
  ContactBody ball;
  ball.velocity = {-3, 1, 0};
  EXPECT_EQ(collide(wall, ball, Vector3d::UnitX()), 6);
  EXPECT_EQ(ball.velocity, Vector3d(3, 1, 0));
  EXPECT_EQ(wall.velocity, Vector3d(0, 0, 0));
}

TEST(Collide, BodiesThatPartOrRestAreLeftAlone) {
  for (const double v : {0.0, 1e-300, 2.0}) {
    ContactBody a;
    ContactBody b;
    b.velocity = {v, 1, 0};
    const ContactBody b0 = b;
    EXPECT_EQ(collide(a, b, Vector3d::UnitX()), 0);
    expect_unchanged(b0, b);
    EXPECT_EQ(a.velocity, Vector3d(0, 0, 0));
  }
}

}  // namespace
