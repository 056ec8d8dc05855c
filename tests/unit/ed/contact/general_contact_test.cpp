// time_of_contact for superellipsoids and ellipsoids without an axis of revolution: contacts that are known beforehand.

#include "common/geom/random.h"

#include <ed/system.h>
#include <ed/time_of_contact.h>
#include <ed/tolerances.h>

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <string>

namespace ed {
namespace {

using Eigen::Vector3d;
using geom::Ellipsoid;
using geom::Pose;
using Shape = ed::BodyShape;
using geom::Superellipsoid;

Motion moving(const Vector3d& position, const Vector3d& velocity, const Vector3d& omega = Vector3d::Zero()) {
  Motion motion;
  motion.pose = Pose::translation(position);
  motion.velocity = velocity;
  motion.angular_velocity = omega;
  return motion;
}

Motion random_motion(geom_test::Random& random, const Vector3d& centre, const Vector3d& velocity,
                     const Vector3d& inertia) {
  Motion motion;
  motion.pose = Pose(random.pose(0).rotation(), centre);
  motion.velocity = velocity;
  motion.angular_velocity = random.uniform(0, 3) * random.direction();
  motion.inertia = inertia;
  return motion;
}

TEST(GeneralContact, BoxesMeetFaceToFace) {
  const Superellipsoid box({1, 2, 3}, 0.4, 0.3);
  // Exactly parallel faces, centred or not: any point of the faces is as close as another.
  for (const Vector3d& shift : {Vector3d(0, 0, 0), Vector3d(0, 0.3, -0.4)}) {
    const ContactResult r =
        time_of_contact(box, moving({0, 0, 0}, {1, 0, 0}), box, moving(Vector3d(5, 0, 0) + shift, {-0.5, 0, 0}), 10);
    ASSERT_EQ(r.status, ContactStatus::hit);
    const double wanted = geom::distance(box, Pose(), box, Pose::translation(Vector3d(5, 0, 0) + shift)).distance / 1.5;
    EXPECT_NEAR(r.time, wanted, 1e-3) << "faces bulge a little";
    const geom::DistanceResult at = geom::distance(box, Pose::translation({r.time, 0, 0}), box,
                                                   Pose::translation(Vector3d(5 - 0.5 * r.time, 0, 0) + shift));
    EXPECT_NEAR(at.distance, 0, 1e-13);
  }
}

TEST(GeneralContact, BiaxialEllipsoidsMeetHeadOn) {
  const Ellipsoid brick({1, 2, 3});
  const ContactResult r =
      time_of_contact(brick, moving({0, 0, 0}, {0, 0, 1}), brick, moving({0, 0, 10}, {0, 0, -1}), 10);
  ASSERT_EQ(r.status, ContactStatus::hit);
  EXPECT_NEAR(r.time, 2, 1e-14);
  EXPECT_LT((r.point - Vector3d(0, 0, 5)).norm(), 1e-7);
  EXPECT_LT((r.normal - Vector3d::UnitZ()).norm(), 1e-7);
}

/// Predicts the same bodies by both pair gaps.
TEST(GeneralContact, ExponentOneIsTheEllipsoid) {
  geom_test::Random random(1);
  int hits = 0;
  for (int k = 0; k < 1000; ++k) {
    const Vector3d axes(1, 1, k % 2 == 0 ? 3 : 0.3);
    const Ellipsoid ellipsoid(axes);
    const Superellipsoid same(axes, 1, 1);
    const Vector3d inertia = ellipsoid.inertia(1);
    const Motion a = random_motion(random, {0, 0, 0}, {0, 0, 0}, inertia);
    const Vector3d centre = random.uniform(6.1, 8) * random.direction();
    const Motion b = random_motion(random, centre, -centre / 6 + 0.3 * random.direction(), inertia);
    const ContactResult wanted = time_of_contact(ellipsoid, a, ellipsoid, b, 10);
    const ContactResult got = time_of_contact(Shape(same), a, Shape(ellipsoid), b, 10);
    ASSERT_EQ(got.status, wanted.status) << k;
    if (wanted.status != ContactStatus::hit) continue;
    ++hits;
    ASSERT_NEAR(got.time, wanted.time, 1e-9) << k;
    ASSERT_LT((got.point - wanted.point).norm(), 1e-6) << k;
  }
  EXPECT_GT(hits, 300);
}

TEST(GeneralContact, SwappingUnlikeBodiesTurnsTheNormalRound) {
  geom_test::Random random(2);
  for (int k = 0; k < 300; ++k) {
    const Shape a = Superellipsoid({1, 1, 2}, 0.5, 0.7);
    const Shape b = Ellipsoid({1, 1, 0.4});
    const Motion m_a = random_motion(random, {0, 0, 0}, {0, 0, 0}, ed::uniform_species(a).inertia);
    const Vector3d centre = 5 * random.direction();
    const Motion m_b = random_motion(random, centre, -centre / 4, ed::uniform_species(b).inertia);
    const ContactResult there = time_of_contact(a, m_a, b, m_b, 10);
    const ContactResult back = time_of_contact(b, m_b, a, m_a, 10);
    ASSERT_EQ(there.status, ContactStatus::hit);
    ASSERT_EQ(back.status, ContactStatus::hit);
    ASSERT_NEAR(there.time, back.time, 1e-11);
    ASSERT_LT((there.normal + back.normal).norm(), 1e-5);
  }
}

TEST(GeneralContact, BodiesThatComeFromFarAwayHit) {
  const Superellipsoid brick({1, 1, 2}, 0.5, 0.5);
  Motion a = moving({0, 0, 0}, {0, 0, 0}, {0.3, 0.1, 0});
  a.inertia = brick.inertia(1);
  Motion b = moving({1e6, 0.5, 0}, {-1, 0, 0}, {0, 0.2, 0.1});
  b.inertia = brick.inertia(1);
  const ContactResult r = time_of_contact(brick, a, brick, b, 2e6);
  ASSERT_EQ(r.status, ContactStatus::hit);
  EXPECT_LT(r.evaluations, 200);
  const Motion at_a = propagate(a, r.time);
  const Motion at_b = propagate(b, r.time);
  EXPECT_NEAR(geom::distance(brick, at_a.pose, brick, at_b.pose).distance, 0, 1e-8);
}

TEST(GeneralContact, OverlapsAreSaid) {
  const Superellipsoid box({1, 2, 3}, 0.5, 0.5);
  const ContactResult r = time_of_contact(box, moving({0, 0, 0}, {0, 0, 0}), box, moving({1.9, 0, 0}, {1, 0, 0}), 10);
  EXPECT_EQ(r.status, ContactStatus::overlapping);
  EXPECT_EQ(r.time, 0);
}

std::string refusal(const Shape& a, const Shape& b, const ContactOptions& options = {}) {
  try {
    (void)time_of_contact(a, moving({0, 0, 0}, {0, 0, 0}), b, moving({9, 0, 0}, {0, 0, 0}), 1, options);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(GeneralContact, RefusesWhatItCannotDoAndNamesIt) {
  const Superellipsoid brick({1, 1, 2}, 0.5, 0.5);
  const Superellipsoid flat({1, 1, 2}, 0.2, 0.5);
  EXPECT_EQ(refusal(brick, brick), "accepted");
  EXPECT_NE(refusal(brick, flat).find("exponent is 0.2; accepted of bodies in motion: 0.25 to 1.6"), std::string::npos);
}

}  // namespace
}  // namespace ed
