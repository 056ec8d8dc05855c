/// Contact patches of round bodies on their side: segments, whose ends are in the patch.

#include "common/geom/patch_checks.h"

#include <geom/contact_patch.h>
#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <cmath>
#include <numbers>
#include <vector>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::check_form;
using geom_test::turned;

/// Gap along the normal, and depth of the body in the ground.
struct LyingCase {
  double within, depth;
};
const std::vector<LyingCase> kLyingCases{{1e-5, 0},    {1e-5, 1e-6}, {0, 1e-6}, {1e-6, 1e-7},
                                         {2e-5, 5e-6}, {1e-8, 0},    {1e-12, 0}};

/// Checks the patch of a body whose surface within `half_length` of the origin along y is a part of a cylinder of
/// radius 0.5 that touches the ground if it is not moved.
template <class A, class B>
void check_lying(const A& ground, const B& body, const Pose& X, const LyingCase& c, double half_length,
                 bool is_round = false) {
  const Pose sunk = Pose::translation({0, 0, -c.depth}) * X;
  const ContactPatch patch = contact_patch(ground, Pose(), body, sunk, {.within = c.within});
  check_form(patch);
  if (patch.kind == PatchKind::polygon) return;
  ASSERT_EQ(patch.kind, PatchKind::segment) << c.within << " " << c.depth;
  const double lift = 0.5 - c.within - c.depth;
  // The search for the least gap, which is quadratic, ends at the root of rounding.
  const double half_width = std::sqrt(0.25 - lift * lift) + 1e-7;
  EXPECT_LE(std::abs(patch.centre.x()), half_width) << c.within << " " << c.depth;
  EXPECT_LE(std::abs(patch.centre.y()), 0.02 * half_length);
  // Beyond a flat end is no surface. A ball goes on: at a distance from where it begins by the root of 2 * 0.5 times
  // the height it is lower by that, and ends are further out by the error.
  const double beyond = std::sqrt(c.within + c.depth) + patch.error;
  const double lowered = is_round ? 1.01 * beyond * beyond : c.within + c.depth;
  for (const PatchPoint& point : patch.points) {
    EXPECT_LE(std::abs(point.point_a.x()), half_width) << c.within << " " << c.depth;
    EXPECT_LE(std::abs(point.point_a.y()), half_length + (is_round ? beyond : 1e-12));
    EXPECT_GE(std::abs(point.point_a.y()), 0.96 * half_length);
    EXPECT_LE(point.depth, c.depth + 1e-12);
    EXPECT_GE(point.depth, c.depth - lowered - 1e-12) << c.within << " " << c.depth;
  }
}

TEST(ContactPatchThin, OfLyingCylinders) {
  const Pose lying = turned({0, 0, 0.5}, std::numbers::pi / 2, Vector3d::UnitX());
  for (const LyingCase& c : kLyingCases) {
    check_lying(HalfSpace(), Cylinder(0.5, 0.5), lying, c, 0.5);
    check_lying(HalfSpace(), Cylinder(0.5, 1), lying, c, 1);
    check_lying(Box({2, 2, 1}), Cylinder(0.5, 0.5), Pose::translation({0, 0, 1}) * lying, c, 0.5);
    // Ends of the box, not of the cylinder.
    check_lying(Box({2, 0.3, 1}), Cylinder(0.5, 0.5), Pose::translation({0, 0, 1}) * lying, c, 0.3);
  }
}

TEST(ContactPatchThin, OfLyingCapsules) {
  const Pose lying = turned({0, 0, 0.5}, std::numbers::pi / 2, Vector3d::UnitX());
  for (const LyingCase& c : kLyingCases) {
    check_lying(HalfSpace(), Capsule(0.5, 0.5), lying, c, 0.5, true);
    check_lying(Box({2, 2, 1}), Capsule(0.5, 0.5), Pose::translation({0, 0, 1}) * lying, c, 0.5, true);
  }
}

/// A cone touches the plane along a line from its apex to its base.
TEST(ContactPatchThin, OfConesOnTheirSide) {
  // Height 2, base radius 1, the apex in the origin after the turn, the side down.
  const double half_angle = std::atan2(1, 2), side = std::sqrt(5.0);
  const Pose X =
      turned({0, 0, 0}, std::numbers::pi / 2 + half_angle, Vector3d::UnitX()) * Pose::translation({0, 0, -1.5});
  for (const double within : {1e-5, 1e-6, 1e-9}) {
    const ContactPatch patch = contact_patch(HalfSpace(), Pose(), Cone(2, 1), X, {.within = within});
    check_form(patch);
    if (patch.kind == PatchKind::polygon) continue;
    ASSERT_EQ(patch.kind, PatchKind::segment) << within;
    for (const PatchPoint& point : patch.points) {
      // At the base, where the surface is curved least: about a circle of radius side / 2 across the line.
      EXPECT_LE(std::abs(point.point_b.x()), 1.001 * std::sqrt(2 * within * side / 2) + 1e-6) << within;
    }
    EXPECT_LE(std::abs(patch.centre.x()), std::sqrt(within * side / 2)) << within;
    EXPECT_NEAR(patch.centre.z(), 0, 0.5 * within + 1e-12) << within;
    EXPECT_NEAR((patch.points[0].point_b - patch.points[1].point_b).norm(), side, 0.04 * side) << within;
  }
}

}  // namespace
}  // namespace geom
