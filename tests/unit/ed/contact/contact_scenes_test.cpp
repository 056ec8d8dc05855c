// Times of contact of moved, turned and swapped scenes, and against brute force.

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
#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace {

using contact_scenes::at;
using contact_scenes::expect_touching;
using contact_scenes::sphere;
using ed::ContactResult;
using ed::ContactStatus;
using ed::Motion;
using ed::time_of_contact;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom::Ellipsoid;

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

}  // namespace
