/// Depths of contact patches at their corners: of boxes tilted a little, whose side walls bound the patch.

#include "common/geom/patch_checks.h"
#include "common/geom/random.h"

#include <geom/contact_patch.h>
#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::check_form;
using geom_test::Random;
using geom_test::repetitions;
using geom_test::turned;

struct DepthRange {
  double least = std::numeric_limits<double>::infinity(), most = -least;
};

/// Returns the range of the depths at corners.
DepthRange depth_range(const ContactPatch& patch) {
  DepthRange range;
  for (const PatchPoint& point : patch.points) {
    range.least = std::min(range.least, point.depth);
    range.most = std::max(range.most, point.depth);
  }
  return range;
}

/// Checks a patch on the faces of two boxes, a small tilt between them. On the faces the depth is linear with the slope
/// tan(tilt); that is the greatest difference of two corners, the deepest of which has the depth -distance, divided by
/// the diameter of the faces. Corners are moved by 1e-6 of the extent at most, up a wall of the slope 1 / tilt: this
/// reaches the faces, or a height above `-within` of 1e-6 / tilt. With the term of the tilt the bound holds for any
/// tilt as long as within + depth is at most 2e-3 of the size.
template <class A>
void check_tilted(const A& ground, const Box& box, const Vector3d& position, double tilt, const Vector3d& axis) {
  const double diameter = 2 * box.half_extents().head<2>().norm();
  const Pose X = turned(position, tilt, axis);
  const DistanceResult at = distance(ground, Pose(), box, X);
  const ContactPatch patch = contact_patch(ground, Pose(), box, X, at, {.within = 1e-3});
  check_form(patch);
  ASSERT_EQ(patch.kind, PatchKind::polygon);
  // Walls wider than the corners that count as one have corners of their own.
  if (tilt <= 3e-4) {
    EXPECT_EQ(patch.points.size(), 4U) << tilt << " about " << axis.transpose();
  }
  EXPECT_GT(depth_range(patch).least, -at.distance - std::tan(tilt) * diameter - 1e-12)
      << tilt << " about " << axis.transpose();
  for (const PatchPoint& point : patch.points) {
    EXPECT_LE(point.depth, -at.distance + 1e-12);
    // Both points are on the bodies.
    EXPECT_LE(closest_point(box, X, point.point_b).distance, 1e-12);
    EXPECT_LE(closest_point(ground, Pose(), point.point_a).distance, 1e-12);
  }
}

TEST(ContactPatchDepth, OfTiltedBoxesIsThatOfTheFaces) {
  Random random(1);
  const Box box({0.5, 0.5, 0.5});
  std::vector<Vector3d> axes{{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {1, 1, 0}, {1, 0.4, 0}, {0.001, -1, 0}};
  for (int k = 0; k < repetitions(20); ++k) axes.emplace_back(random.uniform(-1, 1), random.uniform(-1, 1), 0);
  for (const double tilt : {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-5, 1e-4, 3e-4, 1e-3}) {
    for (const Vector3d& axis : axes) {
      check_tilted(HalfSpace(), box, {0, 0, 0.499}, tilt, axis);
      check_tilted(Box({5, 5, 1}), box, {0, 0, 1.499}, tilt, axis);
      check_tilted(box, box, {0.1, 0.07, 0.999}, tilt, axis);
      check_tilted(box, box, {0, 0, 0.999}, tilt, axis);
    }
  }
}

/// The case above with both numbers known: all corners are a thousandth deep.
TEST(ContactPatchDepth, OfABoxTiltedByAMillionth) {
  const Pose X = turned({0, 0, 0.499}, 1e-6, Vector3d::UnitX());
  const ContactPatch patch = contact_patch(HalfSpace(), Pose(), Box({0.5, 0.5, 0.5}), X, {.within = 1e-3});
  ASSERT_EQ(patch.points.size(), 4U);
  for (const PatchPoint& point : patch.points) {
    EXPECT_NEAR(point.depth, 1e-3, 0.51e-6);
    EXPECT_NEAR(std::abs(point.point_b.x()), 0.5, 1e-12);
    EXPECT_NEAR(std::abs(point.point_b.y()), 0.5, 0.51e-6);
  }
}

/// Corners do not jump where a wall becomes steep enough to be passed. Depths change by a hundredth of within + depth,
/// and where the slope of 10 is reached by that of a wall along 1.5e-6.
TEST(ContactPatchDepth, IsContinuous) {
  const Box box({0.5, 0.5, 0.5});
  std::optional<DepthRange> before;
  for (double tilt = 0.2; tilt > 1e-8; tilt *= 0.99) {
    const Pose X = turned({0, 0, 0.5 * (std::cos(tilt) + std::sin(tilt)) - 1e-3}, tilt, Vector3d::UnitX());
    const DepthRange now = depth_range(contact_patch(HalfSpace(), Pose(), box, X, {.within = 1e-3}));
    if (before) {
      EXPECT_NEAR(now.least, before->least, 3e-5) << tilt;
      EXPECT_NEAR(now.most, before->most, 3e-5) << tilt;
    }
    before = now;
  }
}

}  // namespace
}  // namespace geom
