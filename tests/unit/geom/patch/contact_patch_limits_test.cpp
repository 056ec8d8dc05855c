/// contact_patch at the limits: of sizes, numbers of corners, tilts and symmetry.

#include "common/geom/patch_checks.h"
#include "common/geom/random.h"

#include <geom/contact_patch.h>
#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::check_form;
using geom_test::identities;
using geom_test::Random;
using geom_test::repetitions;
using geom_test::turned;

/// Sand on a floor: what is small beside the other body is no point.
TEST(ContactPatch, OfSmallBodiesOnLargeOnes) {
  const double r = 1e-4;
  const PatchOptions options{.within = 1e-6};
  for (const double floor : {1.0, 100.0, 1e4}) {
    const Pose X = Pose::translation({0, 0, floor + r});
    const auto area = [&](const auto& shape) {
      const ContactPatch patch = contact_patch(shape, X, Box({floor, floor, floor}), Pose(), options);
      check_form(patch);
      return patch.area / (r * r);
    };
    EXPECT_NEAR(area(Box({r, r, r})), 4, 1e-6);
    EXPECT_NEAR(area(Cylinder(r, r)), std::numbers::pi, 0.05);
    EXPECT_NEAR(area(Superellipsoid({r, r, r}, 0.2, 0.2)), 2.48, 0.05);
  }
}

/// A prism of more sides than a patch of usual bodies has.
TEST(ContactPatch, OfManySides) {
  constexpr int kSides = 2500;
  Random random(3);
  std::vector<Vector3d> points;
  for (int k = 0; k < kSides; ++k) {
    const double angle = 2 * std::numbers::pi * k / kSides;
    // Not in one plane: hulls of thousands of points in a plane take long.
    for (const double z : {-1.0, 1.0}) {
      points.emplace_back(std::cos(angle), std::sin(angle), z * (1 - 1e-6 * random.uniform(0, 1)));
    }
  }
  const ContactPatch patch = contact_patch(ConvexPolyhedron(points), Pose::translation({0, 0, 1}), HalfSpace(), Pose(),
                                           {.within = 1e-3, .max_points = 100000});
  EXPECT_NEAR(patch.area, 0.5 * kSides * std::sin(2 * std::numbers::pi / kSides), 1e-10);
  EXPECT_LE(patch.error, 1e-12);
  for (const PatchPoint& point : patch.points) EXPECT_LE(point.point_a.head<2>().norm(), 1 + 1e-12);
  const std::vector<std::uint64_t> ids = identities(patch);
  EXPECT_EQ(std::adjacent_find(ids.begin(), ids.end()), ids.end());
}

/// Tilted round bodies on a floor, however little `within` is beyond the distance: never empty, and corners are as near
/// to the outline as the tolerance says.
TEST(ContactPatch, OfTiltedRoundBodiesKeepsTheTolerance) {
  Random random(2);
  const Box floor({10, 10, 10});
  int polygons = 0, outside = 0;
  for (int i = 0; i < repetitions(600); ++i) {
    const double tilt = random.log_uniform(1e-5, 0.1);
    const Vector3d axis(random.uniform(-1, 1), random.uniform(-1, 1), 0);
    const Pose X = turned({0, 0, 11.2}, tilt, axis);
    const Shape body = i % 2 == 0 ? Shape(Cylinder(1, 1)) : Shape(Cone(1, 1));
    const DistanceResult at = distance(body, X, Shape(floor), Pose());
    const PatchOptions options{.within = at.distance + random.log_uniform(1e-6, 0.1), .max_points = 1000};
    const ContactPatch patch = contact_patch(body, X, floor, Pose(), at, options);
    check_form(patch);
    ASSERT_NE(patch.kind, PatchKind::empty) << i;
    if (patch.kind != PatchKind::polygon) continue;
    double diameter = 0;
    for (const PatchPoint& p : patch.points) {
      for (const PatchPoint& q : patch.points) diameter = std::max(diameter, (p.point_b - q.point_b).norm());
    }
    ++polygons;
    if (patch.error > 1.05 * options.tolerance * diameter) ++outside;
  }
  EXPECT_GT(polygons, repetitions(600) / 2);
  // A corner over which rays find nothing is returned further inwards, which makes the diameter less.
  EXPECT_LE(outside, 1);
}

/// Two faces are equally steep: neither is the flattest one.
TEST(ContactPatch, OfACubeOnItsEdgeKeepsItsIdentities) {
  const auto ids = [](double more) {
    const Pose X = turned({0, 0, std::sqrt(0.5)}, std::numbers::pi / 4 + more, Vector3d::UnitY());
    return identities(contact_patch(Box({0.5, 0.5, 0.5}), X, HalfSpace(), Pose(), {.within = 0.01}));
  };
  EXPECT_EQ(ids(1e-9), ids(-1e-9));
  EXPECT_EQ(ids(1e-9).size(), 4U);
}

/// Sides of both boxes are in the same place: which of them bounds the patch depends on the tilt.
TEST(ContactPatch, OfEqualBoxesKeepsItsIdentities) {
  const Box box({0.5, 0.5, 0.5});
  const auto patch_at = [&](double tilt, const Vector3d& axis, const Vector3d& shift) {
    return contact_patch(box, Pose(), box, turned(Vector3d(0, 0, 0.9995) + shift, tilt, axis), {.within = 1e-3});
  };
  const ContactPatch flat = patch_at(0, Vector3d::UnitX(), Vector3d::Zero());
  ASSERT_EQ(flat.points.size(), 4U);
  Random random(4);
  for (int k = 0; k < repetitions(200); ++k) {
    const Vector3d shift = 1e-7 * Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), 0);
    const double tilt = (k % 2 == 0 ? 1 : -1) * random.log_uniform(1e-16, 4e-7);
    const ContactPatch patch = patch_at(tilt, k % 3 == 0 ? Vector3d(Vector3d::UnitZ()) : random.direction(), shift);
    check_form(patch);
    EXPECT_EQ(identities(patch), identities(flat)) << k;
    EXPECT_NEAR(patch.area, 1, 3e-6);
  }
  for (const double tilt : {-1e-6, 1e-6}) {
    for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(1, 0.3, 0), Vector3d(0, 0, 1)}) {
      EXPECT_EQ(identities(patch_at(tilt, axis, Vector3d::Zero())), identities(flat)) << tilt << " " << axis;
    }
  }
}

}  // namespace
}  // namespace geom
