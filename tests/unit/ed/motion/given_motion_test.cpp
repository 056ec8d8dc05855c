/// Motions given as functions of time: poses by closed forms, and bounds that hold.

#include <common/geom/random.h>
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
#include <vector>

namespace given_motion_test {
namespace {

using ed::GivenMotion;
using ed::MotionBounds;
using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom::Pose;
using geom_test::Random;
using test_common::message_of;

constexpr double kPi = std::numbers::pi;

void expect_near(const Pose& X, const Pose& Y, double tolerance) {
  EXPECT_LE((X.position() - Y.position()).norm(), tolerance);
  EXPECT_LE((X.rotation() - Y.rotation()).norm(), tolerance);
}

GivenMotion scaled_bounds(const GivenMotion& motion, double MotionBounds::*member, double factor) {
  return {[motion](double t) { return motion.pose(t); },
          [motion, member, factor](double from, double to) {
            MotionBounds bounds = motion.bounds(from, to);
            bounds.*member *= factor;
            return bounds;
          }};
}

TEST(GivenMotion, OfScrewsAreRotationsAndTranslations) {
  ed::Screw screw;
  screw.pose = Pose::translation({2, 0, 1});
  screw.axis = {0, 0, 5};
  screw.point = {1, 0, 7};
  screw.angular_speed = kPi / 2;
  screw.speed = 3;
  screw.time = 1;
  const GivenMotion motion = GivenMotion::screw(screw);
  expect_near(motion.pose(1), screw.pose, 1e-15);
  expect_near(motion.pose(2), Pose(AngleAxisd(kPi / 2, Vector3d::UnitZ()).toRotationMatrix(), {1, 1, 4}), 1e-15);
  const MotionBounds bounds = motion.bounds(0, 9);
  EXPECT_NEAR(bounds.speed, std::hypot(kPi / 2, 3), 1e-11);
  EXPECT_NEAR(bounds.acceleration, kPi * kPi / 4, 1e-11);
  EXPECT_NEAR(bounds.angular_speed, kPi / 2, 1e-11);
  EXPECT_EQ(bounds.angular_acceleration, 0);
}

TEST(GivenMotion, OfSplinesPassWayPointsWithoutJumps) {
  Random random(1);
  std::vector<double> times{0, 1, 1.5, 3};
  std::vector<Pose> poses{random.pose(1)};
  for (int k = 1; k < 4; ++k) {
    poses.emplace_back(AngleAxisd(1, random.direction()).toRotationMatrix() * poses.back().rotation(),
                       Vector3d(poses.back().position() + random.direction()));
  }
  const GivenMotion motion = GivenMotion::spline(times, poses);
  for (std::size_t k = 0; k < 4; ++k) expect_near(motion.pose(times[k]), poses[k], 4e-15);
  expect_near(motion.pose(-5), poses.front(), 0);
  expect_near(motion.pose(99), poses.back(), 0);
  EXPECT_EQ(motion.bounds(-3, -1).speed, 0);
  const double h = 1e-6;
  for (const double t : times) {
    const Vector3d before = (motion.pose(t).position() - motion.pose(t - h).position()) / h;
    const Vector3d after = (motion.pose(t + h).position() - motion.pose(t).position()) / h;
    EXPECT_LE((before - after).norm(), 1e-4) << t;
    const Matrix3d turned =
        motion.pose(t + h).rotation() - 2 * motion.pose(t).rotation() + motion.pose(t - h).rotation();
    EXPECT_LE(turned.norm() / h, 1e-4) << t;
  }
}

TEST(GivenMotion, BoundsHoldAndAreNotLoose) {
  Random random(2);
  for (int i = 0; i < 20; ++i) {
    ed::Screw screw;
    screw.pose = random.pose(2);
    screw.point = random.direction();
    screw.axis = random.direction();
    screw.angular_speed = random.uniform(-3, 3);
    screw.speed = random.uniform(-1, 1);
    ed::Motion flight;
    flight.pose = random.pose(2);
    flight.velocity = random.direction();
    flight.angular_velocity = 2 * random.direction();
    flight.inertia = random.coin() ? Vector3d(1, 1, 0.4) : Vector3d(1, 0.8, 0.5);
    std::vector<double> times;
    std::vector<Pose> poses;
    for (int k = 0; k < 5; ++k) {
      times.push_back(k);
      poses.emplace_back(AngleAxisd(0.4 * k, Vector3d(1, 2, 3).normalized()).toRotationMatrix(), random.direction());
    }
    const GivenMotion spinning = GivenMotion::screw(screw), flying = GivenMotion::flight(flight);
    const GivenMotion winding = GivenMotion::spline(times, poses);
    for (const GivenMotion& motion : {spinning, flying, winding, winding.on(spinning), flying.on(winding)}) {
      EXPECT_EQ(check_given_motion(motion, 0, 4), "") << i;
      // Speeds that are ten times smaller are broken.
      EXPECT_NE(check_given_motion(scaled_bounds(motion, &MotionBounds::speed, 0.1), 0, 4), "") << i;
      EXPECT_NE(check_given_motion(scaled_bounds(motion, &MotionBounds::angular_speed, 0.1), 0, 4), "") << i;
    }
    EXPECT_NE(check_given_motion(scaled_bounds(winding, &MotionBounds::acceleration, 0.1), 0, 4), "") << i;
    EXPECT_NE(check_given_motion(scaled_bounds(spinning, &MotionBounds::acceleration, 0.1), 0, 4), "") << i;
  }
}

TEST(GivenMotion, OnAnotherBodyIsTheProductOfPoses) {
  ed::Screw arm;
  arm.angular_speed = 1;
  ed::Screw hand;
  hand.pose = Pose::translation({2, 0, 0});
  hand.point = {1, 0, 0};
  hand.angular_speed = -1;
  const GivenMotion motion = GivenMotion::screw(hand).on(GivenMotion::screw(arm));
  // The hand turns against the arm: its orientation stays, and its end is the sum of two arms.
  expect_near(motion.pose(kPi / 2), Pose::translation({1, 1, 0}), 1e-15);
}

TEST(GivenMotion, NamesTheBrokenBound) {
  const GivenMotion motion(
      [](double t) {
        return Pose::translation({t * t, 0, 0});
      },
      [](double, double) {
        return MotionBounds{1, 0, 2, 0};
      });
  EXPECT_EQ(check_given_motion(motion, 0, 0.5), "");
  EXPECT_NE(check_given_motion(motion, 0, 1).find("it moves by"), std::string::npos);
  EXPECT_NE(check_given_motion(scaled_bounds(motion, &MotionBounds::acceleration, 0.5), 0, 0.5).find("acceleration"),
            std::string::npos);
}

TEST(GivenMotion, RefusesBadInput) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message_of([] { return GivenMotion({}, {}); }),
            "GivenMotion: a function is empty; accepted: a pose and bounds");
  ed::Screw no_axis, no_speed;
  no_axis.axis.setZero();
  no_speed.speed = nan;
  EXPECT_NE(message_of([&] { return GivenMotion::screw(no_axis); }).find("direction 0"), std::string::npos);
  EXPECT_NE(message_of([&] { return GivenMotion::screw(no_speed); }).find("not finite"), std::string::npos);
  const Pose X, Y = Pose::translation({1, 0, 0}),
                turned(AngleAxisd(3, Vector3d::UnitX()).toRotationMatrix(), {0, 0, 0});
  EXPECT_NE(message_of([&] { return GivenMotion::spline({0}, {X}); }).find("1 times and 1 poses"), std::string::npos);
  EXPECT_NE(message_of([&] { return GivenMotion::spline({0, 0}, {X, Y}); }).find("time 1 is 0"), std::string::npos);
  EXPECT_EQ(message_of([&] {
              return GivenMotion::spline({-1.7e308, 1.7e308}, {X, Y});
            }),
            "GivenMotion::spline: times are from -1.7e+308 to 1.7e+308; accepted: a finite duration");
  EXPECT_EQ(message_of([&] { return check_given_motion(GivenMotion::resting(X), -1.7e308, 1.7e308); }),
            "GivenMotion: the motion is checked from time -1.7e+308 to 1.7e+308; accepted: a finite duration");
  EXPECT_NE(message_of([&] { return GivenMotion::spline({0, 1}, {X, turned}); }).find("too large"), std::string::npos);
  EXPECT_NE(message_of([&] { return check_given_motion(GivenMotion::resting(X), 1, 0); }).find("times in order"),
            std::string::npos);
  EXPECT_NE(message_of([&] { return GivenMotion::resting(X).bounds(1, 0); }).find("times in order"), std::string::npos);
  EXPECT_EQ(message_of([&] {
              return GivenMotion([](double) { return Pose(); }, [](double, double) { return MotionBounds{}; }, {-1, 0});
            }),
            "GivenMotion: a scale is -1; accepted: finite numbers of 0 or more");
  const GivenMotion negative([](double) { return Pose(); }, [](double, double) { return MotionBounds{-1, 0, 0, 0}; });
  EXPECT_EQ(message_of([&] { return negative.bounds(0, 1); }),
            "GivenMotion::bounds: a bound from time 0 to 1 is -1; accepted: 0 or more");
}

}  // namespace
}  // namespace given_motion_test
