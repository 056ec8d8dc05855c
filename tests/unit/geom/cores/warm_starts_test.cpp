/// Warm starts of shapes with kinks that are known by their support functions only: calls of support functions and
/// Hessians, of which a warm start took twice as many as a cold one when Newton's method failed from both.

#include "common/geom/random.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <cstdio>

namespace geom {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::Random;
using geom_test::repetitions;

/// User's shape that counts the calls of its functions.
template <class Shape>
struct Counted {
  Shape shape;
  long* calls;

  Support support(const Vector3d& n) const {
    ++*calls;
    return shape.support(n);
  }
  Matrix3d support_hessian(const Vector3d& n) const {
    ++*calls;
    return shape.support_hessian(n);
  }
  double bounding_radius() const { return shape.bounding_radius(); }
  double inscribed_radius() const { return shape.inscribed_radius(); }
  double min_curvature_radius() const { return shape.min_curvature_radius(); }
};

/// Expects that warm starts, from the answer turned by an angle, take at most `share` of the calls of cold ones, for
/// pairs apart by 1e-3 to 1. A few pairs take more: the closest points are found on another way.
template <class A, class B>
void expect_warm_faster(const char* name, const A& shape_a, const B& shape_b, double share, double slower_share) {
  long calls = 0;
  const Counted<A> a{shape_a, &calls};
  const Counted<B> b{shape_b, &calls};
  Random random(1);
  long slower = 0;
  long pairs = 0;
  double cold = 0;
  double warm = 0;
  for (int i = 0; i < repetitions(1000); ++i) {
    const Pose X_WA = random.pose(1.0), turned = random.pose(0.0);
    const Vector3d way = random.direction();
    const double touching =
        a.support(X_WA.rotation().transpose() * way).height + b.support(turned.rotation().transpose() * -way).height;
    const Pose X_WB(turned.rotation(), X_WA.position() + (touching + random.log_uniform(1e-3, 1)) * way);
    calls = 0;
    const DistanceResult first = distance(a, X_WA, b, X_WB);
    const long cold_calls = calls;
    ASSERT_EQ(first.status, DistanceStatus::separated) << name << " " << i;
    for (const double angle : {0.0, 1e-4, 1e-2}) {
      const Vector3d start = Eigen::AngleAxisd(angle, random.direction()) * first.normal;
      calls = 0;
      const DistanceResult again = distance(a, X_WA, b, X_WB, {.start = start});
      ASSERT_EQ(again.status, DistanceStatus::separated) << name << " " << i;
      ASSERT_NEAR(again.distance, first.distance, 1e-14 * 10 + first.error_bound + again.error_bound) << name;
      ++pairs;
      slower += calls > cold_calls ? 1 : 0;
      cold += static_cast<double>(cold_calls);
      warm += static_cast<double>(calls);
    }
  }
  std::printf("%s: %.0f calls cold, %.0f warm; %ld of %ld slower\n", name, cold / static_cast<double>(pairs),
              warm / static_cast<double>(pairs), slower, pairs);
  EXPECT_LE(warm, share * cold) << name;
  EXPECT_LE(static_cast<double>(slower), slower_share * static_cast<double>(pairs)) << name;
}

TEST(WarmStarts, OfKinksAreFasterThanColdOnes) {
  const Capsule capsule(1.3, 0.4);
  const Box box({1, 0.7, 0.4});
  const Cylinder cylinder(1, 0.4);
  const Cone cone(1.5, 0.5);
  expect_warm_faster("capsules", capsule, capsule, 0.5, 0.01);
  expect_warm_faster("boxes", box, box, 0.5, 0.04);
  expect_warm_faster("cylinders", cylinder, cylinder, 0.8, 0.12);
  expect_warm_faster("cones", cone, cone, 0.8, 0.12);
  expect_warm_faster("capsule and box", capsule, box, 0.5, 0.01);
}

}  // namespace
}  // namespace geom
