// A user's shape with its own distance, here spherocylinders by their segments: the same contacts and collisions as
// from the support function alone, and libgeom's answer for pairs that the user's method does not know.

#include <common/ed/same_collisions.h>
#include <common/ed/states.h>
#include <common/geom/shapes.h>

#include <ed/ed.h>

#include <geom/geom.h>

#include <Eigen/Core>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

namespace ed {
namespace {

using Eigen::Vector3d;
using geom::DistanceResult;
using geom::Pose;

constexpr double kHalfLength = 1.0;
constexpr double kRadius = 0.5;

using Points = std::pair<Vector3d, Vector3d>;

/// Closest points of the segments p +- L u and q +- M w.
Points closest(const Vector3d& p, const Vector3d& u, double L, const Vector3d& q, const Vector3d& w, double M) {
  const Vector3d r = q - p;
  const double b = u.dot(w);
  const auto on_a = [&](double t) { return std::clamp(r.dot(u) + b * t, -L, L); };
  const auto on_b = [&](double s) { return std::clamp(b * s - r.dot(w), -M, M); };
  std::array<std::pair<double, double>, 5> candidates = {
      {{-L, on_b(-L)}, {L, on_b(L)}, {on_a(-M), -M}, {on_a(M), M}, {0, on_b(0)}}};
  const double D = 1 - b * b;
  if (D > 1e-14) {
    const double s = std::clamp((r.dot(u) - b * r.dot(w)) / D, -L, L);
    candidates[4] = {on_a(on_b(s)), on_b(s)};
  }
  const auto points = [&](const auto& st) { return Points(p + st.first * u, q + st.second * w); };
  const auto length = [&](const auto& st) { return (points(st).second - points(st).first).norm(); };
  return points(*std::min_element(candidates.begin(), candidates.end(),
                                  [&](const auto& x, const auto& y) { return length(x) < length(y); }));
}

/// Distance of two bodies that are all points within a radius of a segment.
DistanceResult of_segments(const Points& axes, double radius_a, double radius_b) {
  DistanceResult result;
  const Vector3d between = axes.second - axes.first;
  result.normal = between.normalized();
  result.distance = between.norm() - radius_a - radius_b;
  result.point_a = axes.first + radius_a * result.normal;
  result.point_b = axes.second - radius_b * result.normal;
  result.status = result.distance > 0 ? geom::DistanceStatus::separated : geom::DistanceStatus::overlapping;
  result.error_bound = 0;
  return result;
}

/// Distance of a rod from a rod or from a sphere; counts its calls.
PairDistance rod_distance(std::shared_ptr<int> calls) {
  return [calls = std::move(calls)](const Pose& X_WA, const BodyShape& other, const Pose& X_WB,
                                    const geom::DistanceOptions& /*options*/) -> std::optional<DistanceResult> {
    ++*calls;
    const bool rod = std::holds_alternative<CustomShape>(other);
    if (!rod && !is_sphere(other)) return std::nullopt;
    const double half_length = rod ? kHalfLength : 0;
    return of_segments(closest(X_WA.position(), X_WA.rotation().col(2), kHalfLength, X_WB.position(),
                               X_WB.rotation().col(2), half_length),
                       kRadius, rod ? kRadius : inscribed_radius(other));
  };
}

CustomShape rod(PairDistance own = {}) {
  const double volume = std::numbers::pi * kRadius * kRadius * (2 * kHalfLength + 4 * kRadius / 3);
  return {geom_test::Spherocylinder{kHalfLength, kRadius}, {"rod", volume, 2, true, std::move(own)}};
}

Species rods(PairDistance own = {}) {
  return {rod(std::move(own)), 1, {0.7, 0.7, 0.12}, true};
}

void expect_equal(const DistanceResult& a, const DistanceResult& b, double tolerance) {
  ASSERT_EQ(a.status, b.status);
  EXPECT_NEAR(a.distance, b.distance, tolerance);
  EXPECT_LE((a.normal - b.normal).norm(), 1e-7);
  EXPECT_LE((a.point_b - a.point_a - a.distance * a.normal).norm(), 1e-14);
}

TEST(PairDistance, AnswersForTheUsersShapeInEitherPlace) {
  const auto calls = std::make_shared<int>(0);
  const BodyShape own = rod(rod_distance(calls));
  const BodyShape plain = rod();
  const BodyShape ball = geom::Ellipsoid(Vector3d::Constant(0.8));
  ed::Random random(1);
  for (int k = 0; k < 100; ++k) {
    const Pose X_WA(random.rotation(), random.normal3());
    const Pose X_WB(random.rotation(), X_WA.position() + (3.2 + 1.8 * random.uniform()) * random.direction());
    *calls = 0;
    expect_equal(distance(own, X_WA, ball, X_WB), distance(plain, X_WA, ball, X_WB), 1e-13);
    expect_equal(distance(ball, X_WA, own, X_WB), distance(ball, X_WA, plain, X_WB), 1e-13);
    EXPECT_EQ(*calls, 2);
  }
}

TEST(PairDistance, OfUnknownPairsIsLibgeoms) {
  const auto calls = std::make_shared<int>(0);
  const BodyShape own = rod(rod_distance(calls));
  const BodyShape needle = geom::Ellipsoid({0.5, 0.5, 2});
  const Pose X_WB = Pose::translation({3, 1, 0.5});
  const DistanceResult asked = distance(own, Pose(), needle, X_WB);
  EXPECT_EQ(*calls, 1);
  const DistanceResult plain = distance(rod(), Pose(), needle, X_WB);
  EXPECT_EQ(asked.distance, plain.distance);
  EXPECT_EQ(asked.point_a, plain.point_a);
}

TEST(PairDistance, GivesTheSameContacts) {
  const auto calls = std::make_shared<int>(0);
  const BodyShape own = rod(rod_distance(calls));
  ed::Random random(2);
  int hits = 0;
  for (int k = 0; k < 50; ++k) {
    Motion a;
    a.pose = Pose(random.rotation(), Vector3d::Zero());
    a.angular_velocity = random.normal3();
    a.inertia = rods().inertia;
    Motion b = a;
    b.pose = Pose(random.rotation(), 3.5 * random.direction());
    b.velocity = -0.5 * b.pose.position() + 0.3 * random.direction();
    const ContactResult by_own = time_of_contact(own, a, own, b, 4);
    const ContactResult plain = time_of_contact(rod(), a, rod(), b, 4);
    ASSERT_EQ(by_own.status, plain.status) << k;
    if (plain.status != ContactStatus::hit) continue;
    ++hits;
    EXPECT_NEAR(by_own.time, plain.time, 1e-11) << k;
    EXPECT_LE((by_own.normal - plain.normal).norm(), 1e-6) << k;
  }
  EXPECT_GT(hits, 10);
  EXPECT_GT(*calls, 100);
}

TEST(PairDistance, GivesTheSameCollisionsInARun) {
  StartOptions options;
  options.number = 40;
  options.packing_fraction = 0.2;
  System system = random_start(rods(), options);
  const auto plain = ed_test::first_collisions(system, {}, 200);
  const auto calls = std::make_shared<int>(0);
  system.species[0] = rods(rod_distance(calls));
  ed_test::expect_same(plain, ed_test::first_collisions(system, {}, 200), "rods by their own distance");
  EXPECT_GT(*calls, 1000);
}

}  // namespace
}  // namespace ed
