/// time_of_contact's budget: bodies that slide in touch, or turn a million times, are answered after few evaluations,
/// and never wrongly.

#include <contact/swept_hull.h>
#include <motion/checks.h>

#include <common/finder/ensemble.h>
#include <common/message_of.h>

#include <ed/motion.h>
#include <ed/random.h>
#include <ed/time_of_contact.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace contact_budget {
namespace {

using ed::BodyShape;
using ed::ContactResult;
using ed::ContactStatus;
using ed::Motion;
using Eigen::Vector3d;
using geom::Ellipsoid;
using geom::Superellipsoid;

constexpr double kForever = std::numeric_limits<double>::infinity();

Motion moving(const Vector3d& position, const Vector3d& velocity, const Vector3d& omega = Vector3d::Zero(),
              const Vector3d& inertia = Vector3d::Ones()) {
  Motion m;
  m.pose = geom::Pose::translation(position);
  m.velocity = velocity;
  m.angular_velocity = omega;
  m.inertia = inertia;
  return m;
}

double distance_at(const BodyShape& a, const Motion& m_a, const BodyShape& b, const Motion& m_b, double t) {
  return ed::distance(a, ed::propagate(m_a, t).pose, b, ed::propagate(m_b, t).pose).distance;
}

const BodyShape kCube = Superellipsoid({1, 1, 1}, 0.25, 0.25);
const BodyShape kSphere = Ellipsoid({1, 1, 1});
const BodyShape kNeedle = Ellipsoid({1, 1, 3});
const BodyShape kTriaxial = Ellipsoid({1, 2, 3});
const BodyShape kTips = Superellipsoid({1, 1, 1}, 1.6, 1.6);

/// Bodies that touch and slide or turn in touch for all times: no contact, by few evaluations.
TEST(ContactBudget, BodiesThatSlideInExactTouchNeverMeet) {
  struct Pair {
    const char* name;
    const BodyShape& a;
    Motion m_a;
    const BodyShape& b;
    Motion m_b;
  };
  const Vector3d o = Vector3d::Zero();
  const Vector3d beside(2, 0, 0);
  const std::vector<Pair> pairs = {
      {"cubes, face to face", kCube, moving(o, o), kCube, moving(beside, {0, 1, 0})},
      {"cubes, faces displaced", kCube, moving(o, o), kCube, moving({2, 0.3, 0.2}, {0, 0.2, 0.1})},
      {"cubes at rest", kCube, moving(o, o), kCube, moving(beside, o)},
      {"cubes at rest, both moving", kCube, moving(o, {1, 2, 3}), kCube, moving(beside, {1, 2, 3})},
      {"cubes turning in touch", kCube, moving(o, o, {1, 0, 0}), kCube, moving(beside, o, {-1, 0, 0})},
      {"cube on sphere", kCube, moving(o, o), kSphere, moving(beside, {0, 1, 0})},
      {"spheres", kSphere, moving(o, o), kSphere, moving(beside, {0, 1, 0})},
      {"spheres turning", kSphere, moving(o, o, {1, 2, 3}), kSphere, moving(beside, o, {0, 1, 1})},
      {"spheres turning fast", kSphere, moving(o, o, {1e6, 2e6, 0}), kSphere, moving(beside, {0, 0, 1}, {0, 0, -1e6})},
      {"needles side by side", kNeedle, moving(o, o), kNeedle, moving(beside, {0, 0, 1})},
      {"needles rolling", kNeedle, moving(o, o, {0, 0, 1e6}), kNeedle, moving(beside, o, {0, 0, 1e6})},
      {"triaxial", kTriaxial, moving(o, o), kTriaxial, moving(beside, {0, 0, 1})},
      {"tip on tip", kTips, moving(o, o), kTips, moving(beside, {0, 1, 0})},
  };
  for (const Pair& pair : pairs) {
    for (const double t_max : {10.0, 1e4, kForever}) {
      const ContactResult r = ed::time_of_contact(pair.a, pair.m_a, pair.b, pair.m_b, t_max);
      EXPECT_EQ(r.status, ContactStatus::separated) << pair.name << ' ' << t_max;
      EXPECT_EQ(r.time, t_max) << pair.name;
      EXPECT_LE(r.evaluations, 100) << pair.name << ' ' << t_max;
    }
  }
}

/// Bodies turn within each other's bounding spheres, at a distance that what they sweep shows.
TEST(ContactBudget, BodiesThatTurnFastBesideEachOtherNeverMeet) {
  for (const double w : {1e3, 1e6}) {
    for (const double t_max : {10.0, 1e3, kForever}) {
      const auto expect_apart = [&](const BodyShape& shape, double apart, const Vector3d& omega_a,
                                    const Vector3d& omega_b, const Vector3d& inertia) {
        const ContactResult r =
            ed::time_of_contact(shape, moving(Vector3d::Zero(), Vector3d::Zero(), omega_a, inertia), shape,
                                moving({apart, 0, 0}, Vector3d::Zero(), omega_b, inertia), t_max);
        EXPECT_EQ(r.status, ContactStatus::separated) << ed::describe(shape) << ' ' << w << ' ' << t_max;
        EXPECT_EQ(r.time, t_max);
        EXPECT_LE(r.evaluations, 100) << ed::describe(shape);
      };
      expect_apart(kNeedle, 4.5, {w, 0, 0}, {w, 0, 0}, {1, 1, 0.2});
      expect_apart(kNeedle, 4.5, {w, 0, 0}, {0, w, 0}, {1, 1, 0.2});
      expect_apart(kTriaxial, 5.5, {0, 0, w}, {0, 0, w}, {3, 2.5, 1});  // a hit was found after a quarter turn
      expect_apart(kCube, 2.01, {w, 0, 0}, {-w, 0, 0}, {1, 1, 1});
      expect_apart(kCube, 2.7, {0, 0, w}, {0, 0, -w}, {1, 1, 1});
      expect_apart(kTips, 2.01, {0, 0, w}, {w, 0, 0}, {1, 1, 1});
    }
  }
}

/// Discs of radius 3 across their way, swept by needles: they meet a few turns after these do.
TEST(ContactBudget, BodiesThatTurnFastMeetSoonAfterWhatTheySweep) {
  for (const double w : {1e2, 1e4, 1e6}) {
    const Motion a = moving(Vector3d::Zero(), Vector3d::Zero(), {w, 0, 0}, {1, 1, 0.2});
    const Motion b = moving({5, 0, 0}, {-1, 0, 0}, {0, w, 0}, {1, 1, 0.2});
    const ContactResult r = ed::time_of_contact(kNeedle, a, kNeedle, b, 10);
    ASSERT_EQ(r.status, ContactStatus::hit) << w;
    EXPECT_GE(r.time, 1);
    EXPECT_LE(r.time, 1 + 10 / w);
    EXPECT_LE(r.evaluations, 200) << w;
    // The surfaces move by w times the rounding of the time.
    EXPECT_NEAR(distance_at(kNeedle, a, kNeedle, b, r.time), 0, 1e-14 * w);
  }
}

/// Cubes were found to touch half a size apart, when their bounding spheres met.
TEST(ContactBudget, CubesThatTurnFastAndApproachTouchWhereAHitIsFound) {
  for (const double w : {1e3, 1e6}) {
    const Motion a = moving(Vector3d::Zero(), Vector3d::Zero(), {0, 0, w});
    const Motion b = moving({3.4, 0, 0}, {-0.01, 0, 0}, {0, w, w});
    const ContactResult r = ed::time_of_contact(kCube, a, kCube, b, 1e3);
    EXPECT_LE(r.evaluations, 2100);
    EXPECT_GE(r.time, 50);  // what they sweep is apart until 3.4 - 0.01 t = 1.297 + 1.511
    if (r.status == ContactStatus::hit) {
      EXPECT_NEAR(distance_at(kCube, a, kCube, b, r.time), 0, 1e-12 * w);
    } else {
      EXPECT_EQ(r.status, ContactStatus::budget_exhausted);
      EXPECT_GT(distance_at(kCube, a, kCube, b, r.time), 0);
    }
  }
}

TEST(ContactBudget, EndsTheSearchWithALowerBound) {
  // Wheels that mesh: their hulls overlap, they do not.
  const Motion a = moving(Vector3d::Zero(), Vector3d::Zero(), {0, 0, 1e3});
  Motion b = moving({2.55, 0, 0}, Vector3d::Zero(), {0, 0, 1e3 * (1 + 1e-9)});
  b.pose = geom::Pose::normalized_quaternion(std::cos(0.4), 0, 0, std::sin(0.4), b.pose.position());
  const BodyShape wheel = Superellipsoid({1, 1, 0.3}, 0.25, 0.25);
  double earlier = 0;
  for (const int budget : {1, 10, 100, 1000}) {
    ed::ContactOptions options;
    options.max_evaluations = budget;
    const ContactResult r = ed::time_of_contact(wheel, a, wheel, b, kForever, options);
    ASSERT_EQ(r.status, ContactStatus::budget_exhausted) << budget;
    EXPECT_STREQ(to_string(r.status), "budget_exhausted");
    EXPECT_GT(r.time, earlier);
    EXPECT_LE(r.evaluations, budget);
    EXPECT_TRUE(r.point.hasNaN());
    EXPECT_GT(distance_at(wheel, a, wheel, b, r.time), 0);
    earlier = r.time;
  }
}

/// Bounds over a horizon of 10,000 radian gave steps of 1e-3 radian: the budget ended at 0.003.
TEST(ContactBudget, GoesFarWhateverTheHorizon) {
  const Motion a = moving(Vector3d::Zero(), Vector3d::Zero(), {0, 0, 1e3});
  Motion b = moving({2.55, 0, 0}, Vector3d::Zero(), {0, 0, 1e3 * (1 + 1e-9)});
  b.pose = geom::Pose::normalized_quaternion(std::cos(0.4), 0, 0, std::sin(0.4), b.pose.position());
  const BodyShape wheel = Superellipsoid({1, 1, 0.3}, 0.25, 0.25);
  for (const double t_max : {1.0, 10.0, 1e3, kForever}) {
    const ContactResult r = ed::time_of_contact(wheel, a, wheel, b, t_max);
    ASSERT_EQ(r.status, ContactStatus::budget_exhausted) << t_max;
    EXPECT_GT(r.time, 0.03) << t_max;
    EXPECT_GT(distance_at(wheel, a, wheel, b, r.time), 0);
  }
}

TEST(ContactBudget, ASearchThatGoesOnFromTheBoundFindsTheContact) {
  const Motion a = moving(Vector3d::Zero(), Vector3d::Zero(), {0, 0.5, 0.1}, {2, 2, 0.4});
  const Motion b = moving({5.5, 0.3, 0}, {-0.05, 0, 0}, {0.3, 1, 0}, {2, 2, 0.4});
  const ContactResult whole = ed::time_of_contact(kNeedle, a, kNeedle, b, 100);
  ASSERT_EQ(whole.status, ContactStatus::hit);
  ed::ContactOptions options;
  options.max_evaluations = 1;
  double t = 0;
  int calls = 0;
  for (; calls < 1000; ++calls) {
    const ContactResult r =
        ed::time_of_contact(kNeedle, ed::propagate(a, t), kNeedle, ed::propagate(b, t), 100, options);
    ASSERT_LE(r.time, whole.time * (1 + 1e-13));
    t = r.time;
    if (r.status != ContactStatus::budget_exhausted) {
      ASSERT_EQ(r.status, ContactStatus::hit);
      break;
    }
  }
  EXPECT_GT(calls, 1);
  EXPECT_NEAR(t, whole.time, 1e-13 * whole.time);
}

TEST(ContactBudget, RefusesNone) {
  ed::ContactOptions options;
  options.max_evaluations = 0;
  EXPECT_THAT(test_common::message_of([&] {
                return ed::time_of_contact(kSphere, Motion(), kSphere, moving({3, 0, 0}, {0, 0, 0}), 1, options);
              }),
              testing::HasSubstr("max_evaluations is 0; accepted: 1 or more"));
}

// ---- What bodies sweep
// -----------------------------------------------------------------------------------------------

Vector3d random_omega(ed::Random& random, int kind) {
  const double rate = finder_test::log_uniform(random, 0.1, 100);
  if (kind == 0) return Vector3d::Zero();
  return rate * (kind == 1 ? Vector3d(Vector3d::Unit(static_cast<int>(3 * random.uniform()))) : random.direction());
}

/// The height is never below that of the body at any time; where the axis stays in place it is hardly ever above all.
TEST(SweptHull, HoldsTheBodyAtAllTimes) {
  ed::Random random(61);
  const std::vector<BodyShape> shapes = {kCube, kTips, kTriaxial, Superellipsoid({1, 0.5, 2}, 0.6, 1.2)};
  for (int k = 0; k < 60; ++k) {
    const BodyShape& shape = shapes[static_cast<std::size_t>(k) % shapes.size()];
    const Vector3d inertia = k % 2 == 0 ? Vector3d(1, 1, 1) : Vector3d(1, 1.2, 0.7);
    const geom::Pose pose = geom::Pose::normalized_quaternion(random.normal(), random.normal(), random.normal(), 1);
    const Vector3d omega = pose.rotation() * random_omega(random, k % 3);
    const ed::internal::RigidMotion motion{Vector3d::Zero(), Vector3d::Zero(),
                                           ed::internal::FreeTop(inertia, pose.rotation(), omega), 0.3};
    const ed::internal::SweptHull hull(shape, motion, inertia);
    const bool steady = k % 3 == 0 || k % 2 == 0;  // about the axis of the middle moment bodies turn over
    for (int direction = 0; direction < 20; ++direction) {
      const Vector3d n = direction == 0 ? Vector3d(omega.stableNormalized()) : random.direction();
      if (n.isZero(0)) continue;
      double highest = 0;
      for (int i = 0; i < 400; ++i) {
        const Eigen::Matrix3d R = motion.top.rotation((omega.isZero(0) ? 1 : 300 / omega.norm()) * random.uniform());
        highest = std::max(highest, ed::support(shape, R.transpose() * n).height);
      }
      ASSERT_GE(hull.height(n), highest * (1 - 1e-14)) << k;
      if (steady) {
        ASSERT_LE(hull.height(n), highest + 0.02 * ed::bounding_radius(shape)) << k;
      }
    }
  }
}

TEST(SweptHull, OfEllipsoidsOfRevolutionIsExact) {
  ed::Random random(62);
  for (int k = 0; k < 100; ++k) {
    const geom::kernel::Spheroid shape(finder_test::log_uniform(random, 0.2, 5), 1);
    Motion m = moving(Vector3d::Zero(), Vector3d::Zero(), random_omega(random, k % 3), {1, 1, 0.4});
    m.pose = geom::Pose::normalized_quaternion(random.normal(), random.normal(), random.normal(), 1);
    const ed::internal::AxisMotion axis = ed::internal::top_motion(m, 2).axis;
    const ed::internal::SweptHull hull(shape, axis);
    for (int direction = 0; direction < 20; ++direction) {
      const Vector3d n = random.direction();
      double highest = 0;
      for (int i = 0; i < 2000; ++i) {
        const double x = n.dot(axis.axis_at(i * (axis.rate > 0 ? 2 * 3.15 / 2000 / axis.rate : 0.0)));
        highest = std::max(highest, std::sqrt(shape.b2 + shape.c * x * x));
      }
      ASSERT_GE(hull.height(n), highest * (1 - 1e-14));
      ASSERT_LE(hull.height(n), highest * (1 + 1e-4));
    }
  }
}

/// Bodies do not overlap at sampled times before the answer, hulls or not.
TEST(SweptHull, NoContactIsSkipped) {
  ed::Random random(63);
  const std::vector<BodyShape> shapes = {kNeedle, kCube, kTriaxial, Ellipsoid({1, 1, 0.3})};
  int hits = 0;
  int exhausted = 0;
  for (int k = 0; k < 400; ++k) {
    const BodyShape& a = shapes[static_cast<std::size_t>(k) % shapes.size()];
    const BodyShape& b = shapes[static_cast<std::size_t>(k / 4) % shapes.size()];
    const double reach = ed::bounding_radius(a) + ed::bounding_radius(b);
    const Vector3d inertia = k % 3 == 0 ? Vector3d(1, 1, 1) : Vector3d(1, 1, 0.4);
    const Vector3d way = random.direction();
    const double w = finder_test::log_uniform(random, 10, 300);
    const Motion m_a = moving(Vector3d::Zero(), Vector3d::Zero(), w * Vector3d::Unit(k % 3), inertia);
    const Motion m_b =
        moving(1.05 * reach * way, -0.3 * way + 0.05 * random.normal3(), w * random.direction(), inertia);
    const ContactResult r = ed::time_of_contact(a, m_a, b, m_b, 20);
    hits += r.status == ContactStatus::hit;
    exhausted += r.status == ContactStatus::budget_exhausted;
    ASSERT_NE(r.status, ContactStatus::overlapping);
    // Without overlaps on the way, at 300 times.
    for (int i = 0; i < 300; ++i) {
      const double t = std::min(r.time, 20.0) * (1 - random.uniform() * random.uniform());
      ASSERT_GT(distance_at(a, m_a, b, m_b, t), -1e-10 * reach) << k << ' ' << t << ' ' << r.time;
    }
    if (r.status == ContactStatus::hit) {
      ASSERT_NEAR(distance_at(a, m_a, b, m_b, r.time), 0, 1e-10 * reach) << k;
    }
  }
  EXPECT_GT(hits, 150);
  EXPECT_LT(exhausted, 250);
}

}  // namespace
}  // namespace contact_budget
