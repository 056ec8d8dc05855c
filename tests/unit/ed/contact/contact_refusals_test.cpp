// Input that time_of_contact refuses, rescues and names.

#include <ed/motion.h>
#include <ed/time_of_contact.h>
#include <ed/tolerances.h>

#include <common/finder/contact_scenes.h>

#include <geom/distance.h>
#include <geom/ellipsoid.h>
#include <geom/pose.h>

#include <Eigen/Core>

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

namespace {

using contact_scenes::at;
using contact_scenes::bracketing;
using ed::ContactResult;
using ed::ContactStatus;
using ed::Motion;
using ed::time_of_contact;
using Eigen::Vector3d;
using geom::Ellipsoid;

constexpr double kEndless = std::numeric_limits<double>::infinity();

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

TEST(TimeOfContact, RefusesSpeedsWhoseSquaresOverflowOrUnderflow) {
  for (const double speed : {1e155, 1.1 * ed::kMaxSpeed, 0.9 * ed::kMinSpeed, 1e-200, 5e-324}) {
    const std::string velocity = refusal([&](Query& q) { q.m_b.velocity = {-speed, 0, 0}; });
    EXPECT_EQ(velocity.find("velocity is ["), 0U) << velocity;
    EXPECT_NE(velocity.find("; accepted: 0, or a length from 1e-50 to 1e+50"), std::string::npos) << velocity;
    const std::string turns = refusal([&](Query& q) { q.m_a.angular_velocity = {0, speed, 0}; });
    EXPECT_EQ(turns.find("angular velocity is [0, "), 0U) << turns;
  }
  const std::string far = refusal([](Query& q) {
    q.m_a.velocity = {1e50, 0, 0};
    q.m_b.time = 1e60;
    q.t_max = kEndless;
  });
  EXPECT_EQ(far.find("time_of_contact: the position at time 1e+60"), 0U) << far;
}

TEST(TimeOfContact, IsRightAtEverySpeedThatIsAccepted) {
  for (const double speed : {ed::kMaxSpeed, 1e20, 1.0, 1e-20, ed::kMinSpeed}) {
    for (const double way : {3.0, 1e6}) {
      Query q;
      q.m_b = at({way + 2, 0, 0}, {-speed, 0, 0});
      const ContactResult hit = time_of_contact(q.a, q.m_a, q.b, q.m_b, kEndless);
      EXPECT_EQ(hit.status, ContactStatus::hit) << speed;
      EXPECT_NEAR(hit.time * speed / way, 1, 1e-14) << speed;
      const double early = 0.5 * way / speed;
      EXPECT_EQ(time_of_contact(q.a, q.m_a, q.b, q.m_b, early).status, ContactStatus::separated) << speed;
    }
  }
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
