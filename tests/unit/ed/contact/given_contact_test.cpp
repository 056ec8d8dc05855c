/// Time of contact of given motions: known answers, what is no contact, budgets, bad input.

#include <common/message_of.h>

#include <ed/ed.h>

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace given_contact_test {
namespace {

using ed::BodyShape;
using ed::ContactResult;
using ed::ContactStatus;
using ed::GivenMotion;
using ed::MotionBounds;
using Eigen::Vector3d;
using geom::Pose;
using test_common::message_of;

const BodyShape kBall = geom::Sphere(1);

/// Motion along x, x(t), with bounds of speed and acceleration.
template <class Place>
GivenMotion along_x(const Place& x, double speed, double acceleration) {
  return {[x](double t) {
            return Pose::translation({x(t), 0, 0});
          },
          [speed, acceleration](double, double) {
            return MotionBounds{speed, 0, acceleration, 0};
          }};
}

GivenMotion at(double x) {
  return GivenMotion::resting(Pose::translation({x, 0, 0}));
}

TEST(GivenContact, OfAnArmIsThatOfTheCircle) {
  // A ball on an arm of length 3 about the origin, and a wall at y = 2: touched when 3 sin(t) + 1 = 2.
  ed::Screw arm;
  arm.pose = Pose::translation({3, 0, 0});
  arm.angular_speed = 1;
  const BodyShape wall = geom::Box({5, 0.5, 5});
  const GivenMotion still = GivenMotion::resting(Pose::translation({0, 2.5, 0}));
  const ContactResult found = time_of_contact(kBall, GivenMotion::screw(arm), wall, still, 0, 3);
  ASSERT_EQ(found.status, ContactStatus::hit);
  EXPECT_NEAR(found.time, std::asin(1.0 / 3), 2e-13);
  EXPECT_LE((found.normal - Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_NEAR(found.point.y(), 2, 2e-13);
  EXPECT_LE(found.evaluations, 20);
}

TEST(GivenContact, WithoutAccelerationsIsSlowerAndTheSame) {
  const double infinite = std::numeric_limits<double>::infinity();
  const auto x = [](double t) { return 4 - 2.5 * std::sin(t); };
  const ContactResult quick = time_of_contact(kBall, at(0), kBall, along_x(x, 2.5, 2.5), 0, 2);
  const ContactResult slow = time_of_contact(kBall, at(0), kBall, along_x(x, 2.5, infinite), 0, 2);
  ASSERT_EQ(quick.status, ContactStatus::hit);
  ASSERT_EQ(slow.status, ContactStatus::hit);
  EXPECT_NEAR(quick.time, std::asin(0.8), 4e-13);
  EXPECT_NEAR(slow.time, std::asin(0.8), 4e-13);
  EXPECT_LT(quick.evaluations, slow.evaluations);
}

TEST(GivenContact, OfBodiesThatMoveApartIsNone) {
  const auto apart = [](double t) { return 2 + 0.1 * t; };
  EXPECT_EQ(time_of_contact(kBall, at(0), kBall, along_x(apart, 0.1, 0), 0, 5).status, ContactStatus::separated);
  // Thrown up from the floor, and back: touched again at t = 2.
  const auto thrown = [](double t) { return 2 + t * (2 - t); };
  const ContactResult back = time_of_contact(kBall, at(0), kBall, along_x(thrown, 8, 2), 0, 5);
  ASSERT_EQ(back.status, ContactStatus::hit);
  EXPECT_NEAR(back.time, 2, 1e-12);
  // Without accelerations, those that part about as fast as their bound allows are known to; slow ones are not.
  const double infinite = std::numeric_limits<double>::infinity();
  const auto part = [](double t) { return 2 + t; };
  for (const double bound : {1.0, 1.1}) {
    const ContactResult fast = time_of_contact(kBall, at(0), kBall, along_x(part, bound, infinite), 0, 5);
    EXPECT_EQ(fast.status, ContactStatus::separated) << bound;
  }
  for (const double bound : {4.0, 10.0}) {
    const ContactResult slow = time_of_contact(kBall, at(0), kBall, along_x(part, bound, infinite), 0, 5);
    EXPECT_EQ(slow.status, ContactStatus::hit) << bound;
    EXPECT_EQ(slow.time, 0) << bound;
  }
  // Towards each other from touch.
  const auto towards = [](double t) { return 2 - 0.1 * t; };
  EXPECT_EQ(time_of_contact(kBall, at(0), kBall, along_x(towards, 0.1, 0), 0, 5).time, 0);
}

TEST(GivenContact, OfOverlapsAndOfTheEnd) {
  EXPECT_EQ(time_of_contact(kBall, at(0), kBall, at(1.9), 0, 5).status, ContactStatus::overlapping);
  EXPECT_EQ(time_of_contact(kBall, at(0), kBall, at(3), -1, 1e300).status, ContactStatus::separated);
  EXPECT_EQ(time_of_contact(kBall, at(0), kBall, at(3), 5, 5).status, ContactStatus::separated);
  const auto x = [](double t) { return 5 - t; };
  EXPECT_EQ(time_of_contact(kBall, at(0), kBall, along_x(x, 1, 0), 0, 2.999).time, 2.999);
  EXPECT_EQ(time_of_contact(kBall, at(0), kBall, along_x(x, 1, 0), 0, 3.001).status, ContactStatus::hit);
  EXPECT_EQ(time_of_contact(kBall, at(0), kBall, along_x(x, 1, 0), 0, 3).status, ContactStatus::hit);
}

TEST(GivenContact, GoesOnFromAHitAtLateTimes) {
  // The time of a hit is rounded to 1e-10 here, and so is the distance at it.
  for (int k = 0; k < 20; ++k) {
    ed::Motion towards;
    towards.pose = Pose::translation({5.3 + 0.01 * k, 0, 0});
    towards.velocity = {-1, 0, 0};
    towards.time = 1e6;
    const ContactResult hit = time_of_contact(kBall, at(0), kBall, GivenMotion::flight(towards), 1e6, 1e6 + 10);
    ASSERT_EQ(hit.status, ContactStatus::hit) << k;
    EXPECT_NEAR(hit.time, 1e6 + 3.3 + 0.01 * k, 1e-9) << k;
    ed::Motion back = propagate(towards, hit.time);
    back.velocity = {1, 0, 0};
    const ContactResult after =
        time_of_contact(kBall, at(0), kBall, GivenMotion::flight(back), hit.time, hit.time + 10);
    EXPECT_EQ(after.status, ContactStatus::separated) << k;
  }
}

TEST(GivenContact, AcceptsMotionsOfLargeNumbers) {
  // An arc of large radius, and a clock that begins long ago: roundings are no broken bounds.
  ed::Screw arc;
  arc.pose = Pose::translation({3, 0, 0});
  arc.point = {7e5, 7e5, 0};
  arc.angular_speed = 1e-6;
  const ContactResult far = time_of_contact(kBall, GivenMotion::screw(arc), kBall, at(0), 0, 100);
  EXPECT_NE(far.status, ContactStatus::budget_exhausted);
  ed::Screw late;
  late.pose = Pose::translation({-1e9 - 5, 0, 0});
  late.axis = Vector3d::UnitX();
  late.speed = 1;
  late.time = -1e9;
  const ContactResult hit = time_of_contact(kBall, GivenMotion::screw(late), kBall, at(0), 0, 100);
  ASSERT_EQ(hit.status, ContactStatus::hit);
  EXPECT_NEAR(hit.time, 3, 1e-6);
}

TEST(GivenContact, OfBudgets) {
  // Balls that pass each other at 1e-9, slowly.
  ed::Screw around;
  around.pose = Pose::translation({2 + 1e-9, 0, 0});
  around.angular_speed = 1;
  const GivenMotion motion = GivenMotion::screw(around);
  const ContactResult found = time_of_contact(kBall, at(0), kBall, motion, 0, 1, {.max_evaluations = 100});
  EXPECT_EQ(found.status, ContactStatus::budget_exhausted);
  EXPECT_GT(found.time, 0);
  EXPECT_LT(found.time, 1);
  EXPECT_LE(found.evaluations, 102);
  const ContactResult all = time_of_contact(kBall, at(0), kBall, motion, found.time, 1, {.max_evaluations = 1000000});
  EXPECT_EQ(all.status, ContactStatus::separated);
}

TEST(GivenContact, RefusesBrokenBoundsAndBadOptions) {
  const auto x = [](double t) { return 5 - t; };
  const std::string broken =
      message_of([&] { return time_of_contact(kBall, at(0), kBall, along_x(x, 0.1, 0), 0, 50); });
  EXPECT_NE(broken.find("the motion of B breaks its bounds: it moves by"), std::string::npos) << broken;
  // Bounds that leave nothing to search are compared with the end.
  const std::string slow = message_of([&] { return time_of_contact(kBall, at(0), kBall, along_x(x, 0.1, 0), 0, 10); });
  EXPECT_NE(slow.find("the motion of B breaks its bounds: it moves by"), std::string::npos) << slow;
  EXPECT_EQ(time_of_contact(kBall, at(0), kBall, along_x(x, 1, 0), 0, 2).status, ContactStatus::separated);
  // Too fast only where the search does not look.
  const auto jumps = [](double t) { return t > 0.5 && t < 0.6 ? 0.0 : 5.0; };
  EXPECT_EQ(time_of_contact(kBall, at(0), kBall, along_x(jumps, 1, 0), 0, 3).status, ContactStatus::separated);
  const GivenMotion unbounded(
      [](double) {
        return Pose::translation({5, 0, 0});
      },
      [](double, double) { return MotionBounds{}; });
  EXPECT_NE(message_of([&] {
              return time_of_contact(kBall, at(0), kBall, unbounded, 0, 1);
            }).find("time_of_contact: bounds of speed and angular speed from time 0 to "),
            std::string::npos);
  const auto with = [&](double from, double to, const ed::GivenContactOptions& options) {
    return message_of([&] { return time_of_contact(kBall, at(0), kBall, at(3), from, to, options); });
  };
  EXPECT_NE(with(0, 1, {.max_evaluations = 0}).find("max_evaluations is 0"), std::string::npos);
  EXPECT_NE(with(0, 1, {.tolerance = 0}).find("tolerance is 0"), std::string::npos);
  EXPECT_NE(with(1, 0, {}).find("t_min is 1 and t_max 0"), std::string::npos);
  EXPECT_NE(with(-1.7e308, 1.7e308, {}).find("accepted: a finite duration"), std::string::npos);
  EXPECT_NE(with(0, std::numeric_limits<double>::infinity(), {}).find("t_max inf"), std::string::npos);
}

}  // namespace
}  // namespace given_contact_test
