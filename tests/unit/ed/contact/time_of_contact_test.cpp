#include <ed/motion.h>
#include <ed/random.h>
#include <ed/time_of_contact.h>

#include <common/finder_ensemble.h>
#include <common/finder_reference.h>

#include <geom/distance.h>
#include <geom/ellipsoid.h>
#include <geom/pose.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

namespace {

using ed::ContactResult;
using ed::ContactStatus;
using ed::Motion;
using ed::time_of_contact;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom::Ellipsoid;

constexpr double kEndless = std::numeric_limits<double>::infinity();

Ellipsoid sphere(double radius) {
  return Ellipsoid(Vector3d::Constant(radius));
}

Motion at(const Vector3d& position, const Vector3d& velocity) {
  Motion m;
  m.pose = geom::Pose::translation(position);
  m.velocity = velocity;
  return m;
}

/// d at time t, by libgeom.
double distance_at(const Ellipsoid& a, const Motion& motion_a, const Ellipsoid& b, const Motion& motion_b, double t) {
  return geom::distance(a, ed::propagate(motion_a, t).pose, b, ed::propagate(motion_b, t).pose).distance;
}

/// A hit is where the bodies touch, its point on both surfaces, its normal that of the distance.
void expect_touching(const ContactResult& hit, const Ellipsoid& a, const Motion& motion_a, const Ellipsoid& b,
                     const Motion& motion_b) {
  ASSERT_EQ(hit.status, ContactStatus::hit);
  const double size = a.bounding_radius() + b.bounding_radius();
  const Motion now_a = ed::propagate(motion_a, hit.time);
  const Motion now_b = ed::propagate(motion_b, hit.time);
  const geom::DistanceResult d = geom::distance(a, now_a.pose, b, now_b.pose);
  EXPECT_NEAR(d.distance, 0, 1e-13 * size);
  EXPECT_LE((d.normal - hit.normal).norm(), 1e-7);
  EXPECT_NEAR(hit.normal.norm(), 1, 1e-14);
  EXPECT_LE((d.point_a - hit.point).norm(), 1e-7 * size);
  // The surface's level function near it is 2 / (smallest semi-axis) times the distance from it at most.
  EXPECT_NEAR(a.value(now_a.pose.to_body(hit.point)), 0, 1e-12 * size / a.inscribed_radius());
  EXPECT_NEAR(b.value(now_b.pose.to_body(hit.point)), 0, 1e-12 * size / b.inscribed_radius());
  const Vector3d v_a = now_a.velocity + now_a.angular_velocity.cross(hit.point - now_a.pose.position());
  const Vector3d v_b = now_b.velocity + now_b.angular_velocity.cross(hit.point - now_b.pose.position());
  EXPECT_LT((v_b - v_a).dot(hit.normal), 0) << "the bodies must approach";
}

void expect_separated_until(const ContactResult& result, double t_max) {
  EXPECT_EQ(result.status, ContactStatus::separated);
  EXPECT_EQ(result.time, t_max);
  EXPECT_TRUE(result.point.hasNaN());
  EXPECT_TRUE(result.normal.hasNaN());
}

/// The suite runs with every finder; see the list of options at its end.
class BothFinders : public testing::TestWithParam<ed::ContactOptions> {
 protected:
  ContactResult contact(const Ellipsoid& a, const Motion& motion_a, const Ellipsoid& b, const Motion& motion_b,
                        double t_max) const {
    return time_of_contact(a, motion_a, b, motion_b, t_max, GetParam());
  }
};

ed::ContactOptions bracketing(ed::DistanceMethod distance, ed::ContactRoot root = ed::ContactRoot::newton) {
  ed::ContactOptions options;
  options.finder = ed::Finder::bracketing;
  options.distance = distance;
  options.root = root;
  return options;
}

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

// ---- Symmetries ----------------------------------------------------------------------------------------------------

struct Scene {
  Motion a;
  Motion b;
};

/// Two bodies of revolution about z near each other, moving towards each other more or less.
Scene draw(ed::Random& random, const Vector3d& inertia_a, const Vector3d& inertia_b) {
  Scene s;
  s.a = at({0, 0, 0}, random.normal3());
  s.b = at({0, 0, 0}, random.normal3());
  s.a.pose = geom::Pose(random.rotation(), random.normal3());
  s.b.pose = geom::Pose(random.rotation(), s.a.pose.position() + 6 * random.direction());
  s.b.velocity += 0.5 * (s.a.pose.position() - s.b.pose.position());
  s.a.angular_velocity = 2 * random.normal3();
  s.b.angular_velocity = 2 * random.normal3();
  s.a.inertia = inertia_a;
  s.b.inertia = inertia_b;
  return s;
}

/// Times agree within the rounding error of a distance over the normal velocity at the hit.
double time_rounding(const Ellipsoid& a, const Motion& m_a, const Ellipsoid& b, const Motion& m_b,
                     const ContactResult& hit) {
  const Motion now_a = ed::propagate(m_a, hit.time);
  const Motion now_b = ed::propagate(m_b, hit.time);
  const Vector3d v = now_b.velocity + now_b.angular_velocity.cross(hit.point - now_b.pose.position()) - now_a.velocity -
                     now_a.angular_velocity.cross(hit.point - now_a.pose.position());
  const double size = a.bounding_radius() + b.bounding_radius();
  return 4e-15 * size * (1 + v.norm()) / std::abs(v.dot(hit.normal)) + 1e-15 * hit.time;
}

TEST(TimeOfContact, SwappingTheBodiesTurnsTheNormalRound) {
  ed::Random random(53);
  const Ellipsoid rod({0.6, 0.6, 3});
  const Ellipsoid disc({2, 2, 0.5});
  int hits = 0;
  for (int k = 0; k < 500; ++k) {
    const Scene s = draw(random, {1, 1, 0.4}, {1, 1, 1.7});
    const ContactResult r = time_of_contact(rod, s.a, disc, s.b, 20);
    const ContactResult q = time_of_contact(disc, s.b, rod, s.a, 20);
    ASSERT_EQ(r.status, q.status);
    if (r.status != ContactStatus::hit) continue;
    ++hits;
    expect_touching(r, rod, s.a, disc, s.b);
    EXPECT_NEAR(r.time, q.time, time_rounding(rod, s.a, disc, s.b, r));
    EXPECT_LE((r.normal + q.normal).norm(), 1e-7);
    EXPECT_LE((r.point - q.point).norm(), 1e-6);
  }
  EXPECT_GT(hits, 100);
}

TEST(TimeOfContact, AxisOfRevolutionMayBeAnyBodyAxis) {
  ed::Random random(54);
  const Ellipsoid along_z({1, 1, 3});
  int hits = 0;
  for (int k = 0; k < 300; ++k) {
    const Scene s = draw(random, {1, 1, 0.4}, {1, 1, 0.4});
    const ContactResult r = time_of_contact(along_z, s.a, along_z, s.b, 20);
    // Old body axis j becomes axis (j + shift) mod 3, for A only.
    for (int shift = 1; shift <= 2; ++shift) {
      Matrix3d P = Matrix3d::Zero();
      for (int j = 0; j < 3; ++j) P(j, (j + shift) % 3) = 1;
      Motion a = s.a;
      a.pose = geom::Pose(s.a.pose.rotation() * P, s.a.pose.position());
      a.inertia = P.transpose() * s.a.inertia;
      const Ellipsoid renamed(P.transpose() * along_z.semi_axes());
      const ContactResult q = time_of_contact(renamed, a, along_z, s.b, 20);
      ASSERT_EQ(r.status, q.status);
      if (r.status != ContactStatus::hit) continue;
      ++hits;
      EXPECT_NEAR(r.time, q.time, time_rounding(along_z, s.a, along_z, s.b, r));
      EXPECT_LE((r.normal - q.normal).norm(), 1e-7);
    }
  }
  EXPECT_GT(hits, 100);
}

TEST(TimeOfContact, SphereMayHaveItsAxisOfInertiaAnywhere) {
  // A sphere with moments (0.3, 1, 1) is symmetric about x: its contacts do not depend on that.
  ed::Random random(55);
  const Ellipsoid needle({1, 1, 3});
  int hits = 0;
  for (int k = 0; k < 100; ++k) {
    Scene s = draw(random, {1, 1, 1}, {1, 1, 0.4});
    const ContactResult r = time_of_contact(sphere(1), s.a, needle, s.b, 20);
    s.a.inertia = {0.3, 1, 1};
    const ContactResult q = time_of_contact(sphere(1), s.a, needle, s.b, 20);
    ASSERT_EQ(r.status, q.status);
    if (r.status != ContactStatus::hit) continue;
    ++hits;
    EXPECT_NEAR(r.time, q.time, time_rounding(sphere(1), s.a, needle, s.b, r));
  }
  EXPECT_GT(hits, 20);
}

TEST(TimeOfContact, WholeSceneMayBeMovedTurnedAndBoosted) {
  ed::Random random(56);
  const Ellipsoid rod({0.6, 0.6, 3});
  const Ellipsoid disc({2, 2, 0.5});
  int hits = 0;
  for (int k = 0; k < 300; ++k) {
    const Scene s = draw(random, {1, 1, 0.4}, {1, 1, 1.7});
    const Matrix3d Q = random.rotation();
    const Vector3d shift = random.normal3();
    const Vector3d boost = random.normal3();
    Scene moved = s;
    for (Motion* m : {&moved.a, &moved.b}) {
      m->pose = geom::Pose(Q * m->pose.rotation(), Q * m->pose.position() + shift);
      m->velocity = Q * m->velocity + boost;
      m->angular_velocity = Q * m->angular_velocity;
    }
    const ContactResult r = time_of_contact(rod, s.a, disc, s.b, 20);
    const ContactResult q = time_of_contact(rod, moved.a, disc, moved.b, 20);
    ASSERT_EQ(r.status, q.status);
    if (r.status != ContactStatus::hit) continue;
    ++hits;
    EXPECT_NEAR(r.time, q.time, 4 * time_rounding(rod, s.a, disc, s.b, r));
    EXPECT_LE((Q * r.normal - q.normal).norm(), 1e-7);
  }
  EXPECT_GT(hits, 100);
}

// ---- Against brute force -------------------------------------------------------------------------------------------

finder_test::BodyState state_of(const Motion& m) {
  finder_test::BodyState s;
  s.position = m.pose.position();
  s.rotation = m.pose.rotation();
  s.velocity = m.velocity;
  s.spin = m.angular_velocity.dot(s.axis());
  s.across = m.angular_velocity - s.spin * s.axis();
  return s;
}

void compare_with_brute_force(const Ellipsoid& a, const Vector3d& inertia_a, const Ellipsoid& b,
                              const Vector3d& inertia_b, std::uint64_t seed) {
  ed::Random random(seed);
  int hits = 0;
  constexpr int kScenes = 150;
  for (int k = 0; k < kScenes; ++k) {
    const Scene s = draw(random, inertia_a, inertia_b);
    const finder_test::FreeMotion m_a(state_of(s.a), {inertia_a.x(), inertia_a.z()});
    const finder_test::FreeMotion m_b(state_of(s.b), {inertia_b.x(), inertia_b.z()});
    finder_test::BruteForce brute(a, m_a, b, m_b, 1e-7);
    const finder_test::BruteContact truth = brute.first_contact(20);
    const ContactResult r = time_of_contact(a, s.a, b, s.b, 20);
    ASSERT_EQ(r.status, truth.found ? ContactStatus::hit : ContactStatus::separated);
    if (!truth.found) continue;
    ++hits;
    EXPECT_NEAR(r.time, truth.time, 2 * time_rounding(a, s.a, b, s.b, r));
    expect_touching(r, a, s.a, b, s.b);
  }
  EXPECT_GT(hits, kScenes / 5);
  EXPECT_LT(hits, kScenes);
}

TEST(TimeOfContact, UnlikeBodiesMeetWhenBruteForceSaysSo) {
  compare_with_brute_force(sphere(1.2), {1, 1, 1}, Ellipsoid({2.5, 2.5, 0.4}), {1, 1, 1.8}, 61);
  compare_with_brute_force(Ellipsoid({0.5, 0.5, 3}), {1, 1, 0.1}, Ellipsoid({2.5, 2.5, 0.4}), {1, 1, 1.8}, 62);
  compare_with_brute_force(Ellipsoid({0.5, 0.5, 3}), {1, 1, 0.1}, sphere(0.3), {1, 1, 1}, 63);
}

// ---- Refusals ------------------------------------------------------------------------------------------------------

struct Query {
  Ellipsoid a{Vector3d(1, 1, 3)};
  Ellipsoid b{Vector3d(1, 1, 3)};
  Motion m_a;
  Motion m_b = at({8, 0, 0}, {-1, 0, 0});
  double t_max = 10;
};

std::string refusal(const std::function<void(Query&)>& spoil) {
  Query q;
  spoil(q);
  try {
    (void)time_of_contact(q.a, q.m_a, q.b, q.m_b, q.t_max);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(TimeOfContact, RefusesBadInputAndNamesIt) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto has = [](const std::string& message, const std::string& word) {
    return message.find(word) != std::string::npos;
  };
  EXPECT_EQ(refusal([](Query&) {}), "accepted");
  EXPECT_PRED2(has, refusal([&](Query& q) { q.t_max = nan; }), "t_max");
  EXPECT_PRED2(has, refusal([](Query& q) { q.t_max = -1; }), "t_max is -1");
  EXPECT_PRED2(has, refusal([](Query& q) { q.m_b.time = 11; }), "t_max is 10");
  EXPECT_PRED2(has, refusal([&](Query& q) { q.m_a.velocity.x() = nan; }), "velocity");
  EXPECT_PRED2(has, refusal([](Query& q) { q.m_b.angular_velocity.z() = kEndless; }), "angular velocity");
  EXPECT_PRED2(has, refusal([&](Query& q) { q.m_b.time = nan; }), "time");
  EXPECT_PRED2(has, refusal([](Query& q) { q.m_a.inertia = {1, 1, 3}; }), "inertia is [1, 1, 3]");
  EXPECT_PRED2(has, refusal([](Query& q) { q.m_a.inertia = {1, 1, -1}; }), "inertia is [1, 1, -1]");
}

std::string refusal_of(const ed::ContactOptions& options) {
  const Query q;
  try {
    (void)time_of_contact(q.a, q.m_a, q.b, q.m_b, q.t_max, options);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(TimeOfContact, RefusesBadOptions) {
  EXPECT_EQ(refusal_of(bracketing(ed::DistanceMethod::newton5)), "accepted");
  for (const double eps_d : {0.0, -1e-6, 1.0, kEndless, std::numeric_limits<double>::quiet_NaN()}) {
    ed::ContactOptions options = bracketing(ed::DistanceMethod::dual);
    options.eps_d = eps_d;
    const std::string message = refusal_of(options);
    EXPECT_NE(message.find("eps_d is "), std::string::npos) << message;
    EXPECT_NE(message.find("accepted: above 0 and below the smallest semi-axis, 1"), std::string::npos) << message;
  }
  ed::ContactOptions certified;
  certified.distance = ed::DistanceMethod::newton8;
  EXPECT_NE(refusal_of(certified).find("accepted: \"dual\""), std::string::npos);
}

TEST(TimeOfContact, RescuesAreCountedAndTheContactIsTheSame) {
  // A seed in the middle of each body: Newton's method does not come back from there.
  const Query q;
  const ContactResult wanted = time_of_contact(q.a, q.m_a, q.b, q.m_b, q.t_max);
  ed::ContactOptions options = bracketing(ed::DistanceMethod::newton5);
  EXPECT_EQ(time_of_contact(q.a, q.m_a, q.b, q.m_b, q.t_max, options).rescues, 0);
  options.seed = [](const geom::Shape&, const geom::Pose& X_WA, const geom::Shape&, const geom::Pose& X_WB) {
    return geom::WitnessPair{X_WA.position(), X_WB.position(), geom::SeedStatus::usable};
  };
  const ContactResult r = time_of_contact(q.a, q.m_a, q.b, q.m_b, q.t_max, options);
  ASSERT_EQ(r.status, ContactStatus::hit);
  EXPECT_NEAR(r.time, wanted.time, 1e-14);
  EXPECT_GT(r.rescues, 0);
}

TEST(TimeOfContact, StatusHasAName) {
  EXPECT_STREQ(to_string(ContactStatus::hit), "hit");
  EXPECT_STREQ(to_string(ContactStatus::separated), "separated");
  EXPECT_STREQ(to_string(ContactStatus::overlapping), "overlapping");
  EXPECT_STREQ(to_string(ContactStatus::failed), "failed");
}

}  // namespace
