#include <ed/motion.h>
#include <ed/random.h>
#include <ed/time_of_contact.h>

#include <common/finder/contact_scenes.h>
#include <common/finder/ensemble.h>
#include <common/finder/reference.h>

#include <geom/distance.h>
#include <geom/ellipsoid.h>
#include <geom/pose.h>

#include <Eigen/Core>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace {

using contact_scenes::at;
using contact_scenes::bracketing;
using contact_scenes::distance_at;
using contact_scenes::expect_separated_until;
using contact_scenes::expect_touching;
using contact_scenes::sphere;
using ed::ContactResult;
using ed::ContactStatus;
using ed::Motion;
using ed::time_of_contact;
using Eigen::Vector3d;
using geom::Ellipsoid;

constexpr double kEndless = std::numeric_limits<double>::infinity();

/// The suite runs with every finder; see the list of options at its end.
class BothFinders : public testing::TestWithParam<ed::ContactOptions> {
 protected:
  ContactResult contact(const Ellipsoid& a, const Motion& motion_a, const Ellipsoid& b, const Motion& motion_b,
                        double t_max) const {
    return time_of_contact(a, motion_a, b, motion_b, t_max, GetParam());
  }
};

std::string name_of(const testing::TestParamInfo<ed::ContactOptions>& info) {
  const char* const kNames[] = {"certified", "dual", "dual_one_dimensional", "newton8", "newton5"};
  return kNames[info.index];
}

INSTANTIATE_TEST_SUITE_P(TimeOfContact, BothFinders,
                         testing::Values(ed::ContactOptions{}, bracketing(ed::DistanceMethod::dual),
                                         bracketing(ed::DistanceMethod::dual, ed::ContactRoot::one_dimensional),
                                         bracketing(ed::DistanceMethod::newton8),
                                         bracketing(ed::DistanceMethod::newton5)),
                         name_of);

// ---- Known answers -------------------------------------------------------------------------------------------------

TEST_P(BothFinders, HeadOnSpheresMeetWhenTheGapIsUsedUp) {
  const ContactResult r = contact(sphere(1), at({0, 0, 0}, {0.5, 0, 0}), sphere(2), at({10, 0, 0}, {-3, 0, 0}), 5);
  ASSERT_EQ(r.status, ContactStatus::hit);
  EXPECT_NEAR(r.time, 2, 1e-15);
  EXPECT_LE((r.normal - Vector3d::UnitX()).norm(), 1e-15);
  EXPECT_LE((r.point - Vector3d(2, 0, 0)).norm(), 1e-14);
}

TEST_P(BothFinders, SpheresMeetWhereTheQuadraticEquationSays) {
  ed::Random random(51);
  int hits = 0;
  int misses = 0;
  for (int k = 0; k < 20'000; ++k) {
    const Ellipsoid a = sphere(finder_test::log_uniform(random, 0.1, 3));
    const Ellipsoid b = sphere(finder_test::log_uniform(random, 0.1, 3));
    Motion m_a = at(random.normal3(), random.normal3());
    Motion m_b = at(random.normal3(), random.normal3());
    // Spheres may turn as they like.
    m_a.angular_velocity = 3 * random.normal3();
    m_b.angular_velocity = 3 * random.normal3();
    const double reach = a.bounding_radius() + b.bounding_radius();
    m_b.pose = geom::Pose::translation(m_a.pose.position() +
                                       reach * finder_test::log_uniform(random, 1.001, 10) * random.direction());
    // Half of them aimed, the others as they come.
    if (k % 2 == 0) m_b.velocity = m_a.velocity + 0.3 * random.normal3() + m_a.pose.position() - m_b.pose.position();
    using Real = long double;
    const Eigen::Matrix<Real, 3, 1> p = (m_b.pose.position().cast<Real>() - m_a.pose.position().cast<Real>());
    const Eigen::Matrix<Real, 3, 1> v = (m_b.velocity.cast<Real>() - m_a.velocity.cast<Real>());
    const Real half_b = p.dot(v);
    const Real c = p.squaredNorm() - static_cast<Real>(reach) * static_cast<Real>(reach);
    const Real discriminant = half_b * half_b - v.squaredNorm() * c;
    const ContactResult r = contact(a, m_a, b, m_b, kEndless);
    // Closer to tangential than rounding can tell.
    if (std::abs(static_cast<double>(discriminant)) < 1e-12 * static_cast<double>(half_b * half_b)) continue;
    if (half_b >= 0 || discriminant < 0) {
      ++misses;
      expect_separated_until(r, kEndless);
      continue;
    }
    ++hits;
    ASSERT_EQ(r.status, ContactStatus::hit);
    const Real root = std::sqrt(discriminant);
    const Real exact = c / (root - half_b);
    // One rounding error of the distance between the centres, over the normal velocity at the contact.
    const double tolerance = 1e-14 * (10 * reach) * reach / static_cast<double>(root);
    EXPECT_NEAR(r.time, static_cast<double>(exact), tolerance + 1e-15 * r.time);
    const Vector3d r_at = (p + exact * v).cast<double>();
    EXPECT_LE((r.normal - r_at / reach).norm(), 1e-12 + tolerance * static_cast<double>(v.norm()) / reach);
  }
  EXPECT_GT(hits, 5000);
  EXPECT_GT(misses, 5000);
}

TEST_P(BothFinders, ParallelNeedlesMeetTipToTip) {
  const Ellipsoid needle({1, 1, 3});
  const ContactResult r = contact(needle, at({0, 0, 0}, {0, 0, 1}), needle, at({0, 0, 9}, {0, 0, -1}), 10);
  ASSERT_EQ(r.status, ContactStatus::hit);
  EXPECT_NEAR(r.time, 1.5, 1e-14);
  EXPECT_LE((r.point - Vector3d(0, 0, 4.5)).norm(), 1e-14);
  EXPECT_LE((r.normal - Vector3d::UnitZ()).norm(), 1e-14);
}

TEST_P(BothFinders, NeedleTurningInPlaceSweepsIntoASphere) {
  // In the plane of turning the sphere of radius 1 sits where only the tip of the needle passes: the ellipse
  // (x / 3)^2 + y^2 = 1 comes no nearer to the axis than its support height, so that the first touch is off the tip and
  // has no simple closed form; a bisection on the distance, which falls all the way, gives it.
  const Ellipsoid needle({1, 1, 3});
  const Ellipsoid ball = sphere(1);
  Motion turning;
  turning.angular_velocity = {0, 0.5, 0};  // its axis runs from z towards x
  turning.inertia = {2, 2, 0.4};
  const Motion resting = at({3.2, 0, 0}, {0, 0, 0});
  const ContactResult r = contact(needle, turning, ball, resting, 100);
  expect_touching(r, needle, turning, ball, resting);
  double apart = 0;
  double inside = std::numbers::pi;  // a quarter turn
  while (inside - apart > 1e-15 * inside) {
    const double middle = 0.5 * (apart + inside);
    if (middle <= apart || middle >= inside) break;
    (distance_at(needle, turning, ball, resting, middle) < 0 ? inside : apart) = middle;
  }
  EXPECT_NEAR(r.time, apart, 1e-13);
  // A sphere beyond the tip's reach is never hit, however long.
  expect_separated_until(contact(needle, turning, ball, at({4.001, 0, 0}, {0, 0, 0}), kEndless), kEndless);
}

TEST_P(BothFinders, DiscsThatSlideFaceToFaceNeverMeet) {
  const Ellipsoid disc({3, 3, 0.3});
  expect_separated_until(contact(disc, at({0, 0, 0}, {1, 0, 0}), disc, at({-20, 0, 0.6 + 1e-9}, {3, 1, 0}), kEndless),
                         kEndless);
}

// ---- Bodies that never meet, touch already, or overlap -------------------------------------------------------------

TEST_P(BothFinders, BodiesThatPartAreSeparatedForEver) {
  const Ellipsoid needle({1, 1, 4});
  Motion b = at({5, 0, 0}, {1, 0, 0});
  b.angular_velocity = {0, 1, 0};
  expect_separated_until(contact(needle, at({0, 0, 0}, {-1, 0, 0}), needle, b, kEndless), kEndless);
}

TEST_P(BothFinders, BodiesAtRestAreSeparatedForEver) {
  const Ellipsoid needle({1, 1, 4});
  expect_separated_until(contact(needle, Motion(), needle, at({2.1, 0, 0}, {0, 0, 0}), kEndless), kEndless);
  // Within each other's bounding spheres and spinning about their own axes only.
  Motion spinning;
  spinning.angular_velocity = {0, 0, 7};
  spinning.inertia = {1, 1, 0.3};
  expect_separated_until(contact(needle, spinning, needle, at({2.1, 0, 0}, {0, 0, 0}), kEndless), kEndless);
}

TEST_P(BothFinders, SearchEndsAtTMax) {
  const Motion a = at({0, 0, 0}, {1, 0, 0});
  const Motion b = at({4, 0, 0}, {0, 0, 0});
  expect_separated_until(contact(sphere(1), a, sphere(1), b, 1.999), 1.999);
  EXPECT_EQ(contact(sphere(1), a, sphere(1), b, 2.001).status, ContactStatus::hit);
  expect_separated_until(contact(sphere(1), a, sphere(1), b, 0), 0);  // nothing to search
}

TEST_P(BothFinders, NeverAnswersForMoreThanItWasAsked) {
  // t_max next to the contact, where the last Newton step may land on either side of it.
  ed::Random random(52);
  const Ellipsoid a({1, 1, 3});
  const Ellipsoid b({1.5, 1.5, 0.5});
  int hits = 0;
  int separated = 0;
  for (int k = 0; k < 300; ++k) {
    Motion m_a = at({0, 0, 0}, random.normal3());
    Motion m_b = at({0, 0, 0}, random.normal3());
    m_a.pose = geom::Pose(random.rotation(), {0, 0, 0});
    m_b.pose = geom::Pose(random.rotation(), 5 * random.direction());
    m_a.angular_velocity = random.normal3();
    m_b.angular_velocity = random.normal3();
    m_b.velocity -= m_b.pose.position();
    const ContactResult r = contact(a, m_a, b, m_b, kEndless);
    if (r.status != ContactStatus::hit) continue;
    for (int step = -20; step <= 20; ++step) {
      const double t_max = r.time * (1 + step * 0x1p-52);
      const ContactResult until = contact(a, m_a, b, m_b, t_max);
      if (until.status == ContactStatus::hit) {
        ++hits;
        EXPECT_LE(until.time, t_max);
        EXPECT_NEAR(until.time, r.time, 1e-13 * r.time);
      } else {
        ++separated;
        expect_separated_until(until, t_max);
      }
    }
  }
  EXPECT_GT(hits, 100);
  EXPECT_GT(separated, 100);
}

TEST_P(BothFinders, TouchingBodiesThatApproachHitAtOnce) {
  const ContactResult spheres = contact(sphere(1), at({0, 0, 0}, {1, 0, 0}), sphere(1), at({2, 0, 0}, {0, 0, 0}), 1);
  ASSERT_EQ(spheres.status, ContactStatus::hit);
  EXPECT_EQ(spheres.time, 0);
  const Ellipsoid needle({1, 1, 3});
  const ContactResult needles = contact(needle, at({0, 0, 0}, {0, 0, 0}), needle, at({0, 0, 6}, {0, 0, -1e-3}), 1);
  ASSERT_EQ(needles.status, ContactStatus::hit);
  EXPECT_EQ(needles.time, 0);
}

TEST_P(BothFinders, TouchingBodiesThatPartDoNotHit) {
  expect_separated_until(contact(sphere(1), at({0, 0, 0}, {0, 0, 0}), sphere(1), at({2, 0, 0}, {1e-6, 1, 0}), kEndless),
                         kEndless);
  // A needle's tip swings away from the ball it touches, and comes back after half a turn.
  const Ellipsoid needle({1, 1, 3});
  Motion turning;
  turning.angular_velocity = {0, 1, 0};
  const Motion resting = at({0, 0, 4}, {0, 0, 0});
  const ContactResult r = contact(needle, turning, sphere(1), resting, 3);
  expect_separated_until(r, 3);
}

TEST_P(BothFinders, SpinningBodiesThatTouchAndRestDoNotHit) {
  Motion a;
  a.angular_velocity = {0, 0, 5};
  a.inertia = {1, 1, 0.5};
  const Ellipsoid needle({1, 1, 3});
  expect_separated_until(contact(needle, a, needle, at({2, 0, 0}, {0, 0, 0}), kEndless), kEndless);
}

TEST_P(BothFinders, OverlappingBodiesAreSaidToOverlapAtTheStart) {
  const Ellipsoid needle({1, 1, 3});
  for (const double depth : {1e-6, 0.1, 1.0, 2.0}) {
    const ContactResult r =
        contact(needle, Motion(), needle, at({2 - depth, 0, 0}, {1, 0, 0}), 10);  // parting makes no difference
    EXPECT_EQ(r.status, ContactStatus::overlapping) << depth;
    EXPECT_EQ(r.time, 0);
    EXPECT_TRUE(r.point.hasNaN());
  }
}

TEST_P(BothFinders, TimesAreAbsoluteAndMayDiffer) {
  // B's state is given later than A's: the search begins there, however early A's is.
  Motion a = at({0, 0, 0}, {1, 0, 0});
  Motion b = at({7, 0, 0}, {-1, 0, 0});
  a.time = 10;
  b.time = 12;
  const ContactResult r = contact(sphere(1), a, sphere(1), b, 20);
  ASSERT_EQ(r.status, ContactStatus::hit);
  EXPECT_NEAR(r.time, 13.5, 1e-14);
  EXPECT_NEAR(r.point.x(), 4.5, 1e-14);
}

TEST(TimeOfContact, ClocksThatShowALongTimeDoNotMakeOverlaps) {
  // At a time of 1e9 the clock resolves 1e-7 only. Bodies that meet at speed 1 are then 1e-7 apart or in each other at
  // the time that is reported; that is a hit all the same.
  for (const double start : {1e6, 1e9, -1e9}) {
    Motion a = at({0, 0, 0}, {0.7, 0.1, 0});
    Motion b = at({4.3, 0.2, 0}, {-0.3, 0, 0.1});
    a.time = start;
    b.time = start;
    const ContactResult r = time_of_contact(sphere(1), a, sphere(1), b, kEndless);
    EXPECT_EQ(r.status, ContactStatus::hit) << start << ": " << to_string(r.status);
    Motion a0 = a;
    Motion b0 = b;
    a0.time = 0;
    b0.time = 0;
    const ContactResult r0 = time_of_contact(sphere(1), a0, sphere(1), b0, kEndless);
    EXPECT_NEAR(r.time - start, r0.time, 4e-16 * std::abs(start));
  }
}

TEST(TimeOfContact, BodiesThatComeFromFarAwayHit) {
  // After a way of 1e9 sizes the position is known to 1e-7 only.
  for (const double far : {1e3, 1e6, 1e9}) {
    Motion b = at({far, 0.3, 0.4}, {-1, 1e-12, 0});
    b.angular_velocity = {0.1, 0.2, 0.3};
    b.inertia = {1, 1, 0.3};
    const ContactResult r = time_of_contact(sphere(1), Motion(), Ellipsoid({1, 1, 3}), b, kEndless);
    EXPECT_EQ(r.status, ContactStatus::hit) << far << ": " << to_string(r.status);
    EXPECT_NEAR(r.time, far, 5);
  }
}

}  // namespace
