// Capsules beside smooth bodies: distances that are known because support points of both are placed a gap apart along
// a normal.

#include "common/geom/random.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <cmath>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::Random;

/// A capsule at the origin and a smooth body `gap` from it.
template <class Smooth>
void expect_known_distances(const Smooth& smooth, double least_gap, Random& random) {
  constexpr int kPairs = 400;
  int iterated = 0;
  for (int i = 0; i < kPairs; ++i) {
    const Capsule rod(random.log_uniform(0.1, 5), random.log_uniform(0.2, 2));
    const Pose X_WA(random.pose(0).rotation(), Vector3d::Zero());
    const Pose turned(random.pose(0).rotation(), Vector3d::Zero());
    // A third touches the cylinder: any point along it is the closest one.
    Vector3d n = random.direction();
    double along = 0;
    const Vector3d axis = X_WA.rotation().col(2);
    if (i % 3 == 0) {
      n = (n - n.dot(axis) * axis).normalized();
      along = random.uniform(-1, 1) * rod.half_length();
    } else {
      along = std::copysign(rod.half_length(), n.dot(axis));
    }
    const Vector3d on_rod = along * axis + rod.radius() * n;
    const Vector3d on_smooth = turned.rotation() * smooth.support(turned.rotation().transpose() * -n).point;
    const double gap = i % 4 == 0 ? -random.uniform(0, least_gap) : random.log_uniform(1e-8, 5);
    const Pose X_WB(turned.rotation(), on_rod + gap * n - on_smooth);
    const double size = X_WB.position().norm() + rod.bounding_radius() + smooth.bounding_radius();
    const DistanceResult r = distance(rod, X_WA, smooth, X_WB);
    const DistanceResult back = distance(smooth, X_WB, rod, X_WA);
    ASSERT_NEAR(r.distance, gap, 2e-12 * size) << "pair " << i;
    ASSERT_NEAR(back.distance, gap, 2e-12 * size) << "pair " << i;
    ASSERT_LE(std::abs(r.distance - gap), r.error_bound + 1e-14 * size) << "pair " << i;
    ASSERT_NEAR((back.normal + r.normal).norm(), 0, 1e-6) << "pair " << i;
    const DistanceResult by_ball = kernel::capsule_distance(rod.half_length(), rod.radius(), X_WA, smooth, X_WB, {});
    iterated += by_ball.status != DistanceStatus::not_converged ? 1 : 0;
  }
  // The ball on the axis answers nearly all, or this tests the general method.
  EXPECT_GT(iterated, kPairs * 95 / 100);
}

TEST(CapsuleDistance, FromEllipsoidsIsKnown) {
  Random random(61);
  expect_known_distances(Ellipsoid({1, 1, 2}), 0.05, random);
  expect_known_distances(Ellipsoid({0.7, 1, 1.6}), 0.05, random);
}

TEST(CapsuleDistance, FromSuperellipsoidsIsKnown) {
  Random random(62);
  expect_known_distances(Superellipsoid({1, 1, 1}, 0.5, 0.5), 0.05, random);
  expect_known_distances(Superellipsoid({1, 1.5, 2}, 0.8, 0.7), 0.05, random);
}

}  // namespace
}  // namespace geom
