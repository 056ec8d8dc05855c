#include "common/geom/random.h"
#include "common/message_of.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <algorithm>
#include <limits>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::Random;
using geom_test::repetitions;
using test_common::message_of;

TEST(HalfSpace, DistanceIsTheHeightOfTheLowestPoint) {
  const HalfSpace floor;
  const Box box({1, 2, 3});
  const DistanceResult r = distance(floor, Pose(), box, Pose::translation({5, 6, 7}));
  EXPECT_EQ(r.distance, 4);
  EXPECT_EQ(r.normal, Vector3d::UnitZ());
  EXPECT_EQ(r.point_b.z(), 4);
  EXPECT_EQ(r.point_a.z(), 0);
  EXPECT_EQ(r.status, DistanceStatus::separated);
  const DistanceResult deep = distance(box, Pose::translation({5, 6, -7}), floor, Pose());
  EXPECT_EQ(deep.distance, -10);
  EXPECT_EQ(deep.normal, -Vector3d::UnitZ());
  EXPECT_EQ(deep.status, DistanceStatus::overlapping);
  EXPECT_EQ(overlap(floor, Pose(), box, Pose::translation({0, 0, 3})), Answer::yes);
  EXPECT_EQ(overlap(box, Pose::translation({0, 0, 3.001}), floor, Pose()), Answer::no);
}

/// Agrees with the distance of a box so large that its face is the plane.
TEST(HalfSpace, IsTheFaceOfALargeBox) {
  Random random(1);
  for (int i = 0; i < repetitions(1000); ++i) {
    const Box block({100, 100, 100});
    const HalfSpace space(random.log_uniform(0.1, 10) * Vector3d::UnitZ(), 100);
    const Pose X_WA = random.pose(1.0);
    const Vector3d local(random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(90, 110));
    const Pose X_WB = random.pose(X_WA.to_world(local));
    const Capsule capsule(2, 0.5);
    const DistanceResult r = distance(space, X_WA, capsule, X_WB);
    ASSERT_NEAR(r.distance, distance(block, X_WA, capsule, X_WB).distance, 1e-12) << i;
    ASSERT_LE((r.point_b - r.point_a - r.distance * r.normal).norm(), 1e-13) << i;
    ASSERT_NEAR(closest_point(space, X_WA, r.point_a).distance, 0, 1e-12) << i;
    const RayHit hit = ray_cast(space, X_WA, X_WB.position(), Vector3d(-X_WA.rotation().col(2)));
    ASSERT_EQ(hit.status, local.z() > 100 ? RayStatus::hit : RayStatus::inside) << i;
    ASSERT_NEAR(hit.t, std::max(0.0, local.z() - 100), 1e-12) << i;
    ASSERT_EQ(contains(space, X_WA, X_WB.position()), local.z() <= 100) << i;
  }
  EXPECT_EQ(ray_cast(HalfSpace(), Pose(), {0, 0, 1}, {1, 0, 0}).status, RayStatus::missed);
  EXPECT_EQ(ray_cast(HalfSpace(), Pose(), {0, 0, 1}, {1, 0, 0.1}).status, RayStatus::missed);
}

TEST(HalfSpace, RefusesBadNumbers) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_NE(message_of([] { return HalfSpace(Vector3d::Zero()); }).find("accepted: finite, not zero"),
            std::string::npos);
  EXPECT_EQ(message_of([&] { return HalfSpace(Vector3d::UnitX(), infinity); }),
            "HalfSpace: offset is inf; accepted: magnitudes up to 1e+100");
}

}  // namespace
}  // namespace geom
