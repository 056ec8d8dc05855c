/// contact_patch: known polygons, and the definition of the patch by rays that share nothing with it.

#include "common/geom/patch_checks.h"
#include "common/geom/random.h"
#include "common/message_of.h"

#include <geom/contact_patch.h>
#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

namespace geom {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::check_form;
using geom_test::identities;
using geom_test::Random;
using geom_test::repetitions;
using geom_test::turned;
using test_common::message_of;

constexpr double kPi = std::numbers::pi;
const Vector3d kUp = Vector3d::UnitZ();

/// Returns the gap over a point of the plane through the world's origin across n; infinite outside of a shadow.
template <class A, class B>
double gap_by_rays(const A& a, const Pose& X_WA, const B& b, const Pose& X_WB, const Vector3d& n, const Vector3d& u) {
  constexpr double kFar = 100;
  const RayHit down = ray_cast(a, X_WA, Vector3d(u + kFar * n), Vector3d(-n));
  const RayHit up = ray_cast(b, X_WB, Vector3d(u - kFar * n), n);
  if (down.status != RayStatus::hit || up.status != RayStatus::hit) return std::numeric_limits<double>::infinity();
  return n.dot(up.point - down.point);
}

/// Returns how far a point is outside of a polygon along the normals of its sides; negative inside.
double outside_by(const ContactPatch& patch, const Vector3d& u) {
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < patch.points.size(); ++k) {
    const Vector3d p = patch.points[k].point_a, q = patch.points[(k + 1) % patch.points.size()].point_a;
    const Vector3d across = (q - p).cross(patch.normal).normalized();
    most = std::max(most, across.dot(u - p));
  }
  return most;
}

TEST(ContactPatch, OfBoxesThatLieOnEachOther) {
  const Box box({1, 1, 1});
  const ContactPatch patch = contact_patch(box, Pose(), box, Pose::translation({0.5, 0.3, 2}), PatchOptions{});
  check_form(patch);
  ASSERT_EQ(patch.kind, PatchKind::polygon);
  EXPECT_EQ(patch.points.size(), 4U);
  EXPECT_NEAR(patch.area, 1.5 * 1.7, 1e-13);
  EXPECT_LE((patch.centre - Vector3d(0.25, 0.15, 1)).norm(), 1e-13);
  for (const PatchPoint& point : patch.points) EXPECT_NEAR(point.depth, 0, 1e-14);
  // Turned by an eighth, and deep in each other: an octagon.
  DistanceResult at = distance(box, Pose(), box, turned({0, 0, 1.9}, kPi / 4, kUp));
  const ContactPatch octagon = contact_patch(box, Pose(), box, turned({0, 0, 1.9}, kPi / 4, kUp), at, {});
  check_form(octagon);
  EXPECT_EQ(octagon.points.size(), 8U);
  EXPECT_NEAR(octagon.area, 8 * (std::sqrt(2.0) - 1), 1e-13);
  for (const PatchPoint& point : octagon.points) EXPECT_NEAR(point.depth, 0.1, 1e-14);
  // Fewer points, the same area.
  const ContactPatch few = contact_patch(box, Pose(), box, turned({0, 0, 1.9}, kPi / 4, kUp), at, {.max_points = 4});
  EXPECT_EQ(few.points.size(), 4U);
  EXPECT_EQ(few.area, octagon.area);
}

TEST(ContactPatch, OfEdgesAndCorners) {
  const Box floor({5, 5, 1}), box({1, 1, 1});
  // An edge on a face.
  const Pose on_edge = turned({0.3, 0.1, 1 + std::sqrt(2.0)}, kPi / 4, Vector3d::UnitY());
  const ContactPatch edge = contact_patch(floor, Pose(), box, on_edge, {.within = 1e-15});
  check_form(edge);
  ASSERT_EQ(edge.kind, PatchKind::segment);
  EXPECT_NEAR((edge.points[1].point_a - edge.points[0].point_a).norm(), 2, 1e-12);
  const ContactPatch strip = contact_patch(floor, Pose(), box, on_edge, {.within = 0.01});
  check_form(strip);
  EXPECT_NEAR(strip.area, 2 * 0.02, 1e-12);
  // A corner on a face: the triangle in which the planes of three faces at equal slopes reach the height.
  const Matrix3d R = Eigen::Quaterniond::FromTwoVectors(Vector3d(-1, -1, -1), -kUp).toRotationMatrix();
  const Pose on_corner(R, {0.3, 0.1, 1 + std::sqrt(3.0)});
  const ContactPatch corner = contact_patch(floor, Pose(), box, on_corner, {.within = 1e-15});
  check_form(corner);
  ASSERT_EQ(corner.kind, PatchKind::point);
  EXPECT_LE((corner.points[0].point_a - Vector3d(0.3, 0.1, 1)).norm(), 1e-7);
  const ContactPatch triangle = contact_patch(floor, Pose(), box, on_corner, {.within = 0.01});
  check_form(triangle);
  EXPECT_EQ(triangle.points.size(), 3U);
  EXPECT_NEAR(triangle.area, 1.5 * std::sqrt(3.0) * 1e-4, 1e-12);
  // Two edges across each other.
  const Pose across = turned({0, 0, 2 * std::sqrt(2.0)}, kPi / 2, kUp) * turned({0, 0, 0}, kPi / 4, Vector3d::UnitY());
  const Pose along = turned({0, 0, 0}, kPi / 4, Vector3d::UnitY());
  const ContactPatch crossing = contact_patch(box, along, box, across, {.within = 1e-14});
  check_form(crossing);
  EXPECT_EQ(crossing.kind, PatchKind::point);
}

/// A box that rocks by a millionth of a radian stays on its whole face, and corners keep their names.
TEST(ContactPatch, OfRestingBoxesDoesNotJump) {
  const HalfSpace floor;
  const Box box({1, 1, 0.5});
  const auto patch_at = [&](double tilt, const Vector3d& axis) {
    return contact_patch(floor, Pose(), box, turned({0, 0, 0.5}, tilt, axis), {.within = 1e-5});
  };
  const ContactPatch flat = patch_at(0, Vector3d::UnitX());
  EXPECT_NEAR(flat.area, 4, 1e-13);
  for (const double tilt : {-1e-6, -1e-9, -1e-13, 1e-16, 1e-13, 1e-9, 1e-6}) {
    for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(1, 1, 0), Vector3d(0.3, 1, 0)}) {
      const ContactPatch tilted = patch_at(tilt, axis);
      check_form(tilted);
      EXPECT_NEAR(tilted.area, 4, 1e-5) << tilt;
      EXPECT_EQ(identities(tilted), identities(flat)) << tilt << " about " << axis.transpose();
    }
  }
}

/// The definition, for random bodies that overlap or are nearly touching: a point is in the polygon if and only if the
/// gap over it, by rays, is small enough.
TEST(ContactPatch, OfPolyhedraAreThoseOfRays) {
  Random random(1);
  int polygons = 0;
  const int pairs = repetitions(300);
  for (int i = 0; i < pairs; ++i) {
    std::vector<Vector3d> points(static_cast<std::size_t>(8 + i % 40));
    for (Vector3d& point : points) point = random.direction().cwiseProduct(Vector3d(1, 0.8, 0.5));
    const ConvexPolyhedron hull = ConvexPolyhedron::in_principal_frame(points);
    const Box box({0.5, 0.7, 0.9});
    const Pose X_WA = random.pose(0.1), X_WB = random.pose(1.3);
    const DistanceResult at = distance(hull, X_WA, box, X_WB);
    const double within = std::max(at.distance, 0.0) + random.uniform(0, 0.3);
    const ContactPatch patch = contact_patch(hull, X_WA, box, X_WB, at, {.within = within, .max_points = 1000});
    check_form(patch);
    if (patch.kind != PatchKind::polygon) continue;
    ++polygons;
    for (int k = 0; k < 40; ++k) {
      const std::size_t c = static_cast<std::size_t>(random.uniform() * static_cast<double>(patch.points.size()));
      const Vector3d u = patch.centre + random.uniform(0, 1.4) * (patch.points[c].point_a - patch.centre) +
                         0.1 * random.uniform(-1, 1) * random.direction();
      const double outside = outside_by(patch, u);
      if (std::abs(outside) < 1e-9) continue;
      const double gap = gap_by_rays(hull, X_WA, box, X_WB, patch.normal, u);
      EXPECT_EQ(gap <= within, outside < 0) << i << " gap " << gap - within << " outside " << outside;
    }
  }
  EXPECT_GE(polygons, pairs * 9 / 10);
}

TEST(ContactPatch, OfCylinders) {
  const HalfSpace floor;
  const Cylinder cylinder(0.5, 1);
  const ContactPatch standing =
      contact_patch(floor, Pose(), cylinder, Pose::translation({3, 2, 0.5}), {.within = 1e-3});
  check_form(standing);
  ASSERT_EQ(standing.kind, PatchKind::polygon);
  EXPECT_GE(standing.area, kPi * (1 - 1e-9));
  EXPECT_LE(standing.area, kPi * 1.02);
  EXPECT_LE(standing.error, 0.01 * 2.1);
  EXPECT_LE((standing.centre - Vector3d(3, 2, 0)).norm(), 0.02);
  // Touching exactly: the gap is rounding everywhere.
  const ContactPatch touching = contact_patch(floor, Pose(), cylinder, Pose::translation({3, 2, 0.5}), PatchOptions{});
  ASSERT_EQ(touching.kind, PatchKind::polygon);
  EXPECT_NEAR(touching.area, standing.area, 0.02);
  EXPECT_LE(touching.error, 0.01 * 2.1);
  const Pose lying = turned({0, 0, 1}, kPi / 2, Vector3d::UnitX());
  const ContactPatch line = contact_patch(floor, Pose(), cylinder, lying, {.within = 1e-15});
  check_form(line);
  ASSERT_EQ(line.kind, PatchKind::segment);
  EXPECT_NEAR((line.points[1].point_a - line.points[0].point_a).norm(), 1, 0.02);
  for (const PatchPoint& point : line.points) EXPECT_NEAR(point.depth, 0, 1e-12);
  // Of a capsule, and of one in the form of a user's shape.
  const Capsule capsule(0.5, 1);
  const ContactPatch along = contact_patch(floor, Pose(), capsule, lying, {.within = 1e-12});
  ASSERT_EQ(along.kind, PatchKind::segment);
  EXPECT_NEAR((along.points[1].point_a - along.points[0].point_a).norm(), 1, 0.02);
  EXPECT_EQ(contact_patch(floor, Pose(), AnyConvex(capsule), lying, {.within = 1e-12}).kind, PatchKind::segment);
}

TEST(ContactPatch, OfSpheres) {
  const Sphere sphere(1);
  const ContactPatch touching = contact_patch(sphere, Pose(), sphere, Pose::translation({0, 0, 2}), PatchOptions{});
  check_form(touching);
  ASSERT_EQ(touching.kind, PatchKind::point);
  EXPECT_LE((touching.points[0].point_a - kUp).norm(), 1e-6);
  EXPECT_NEAR(touching.points[0].depth, 0, 1e-12);
  // The disc in which two unit spheres, their least gap 0.1, are not further apart than 0.3.
  const ContactPatch disc = contact_patch(sphere, Pose(), sphere, Pose::translation({0, 0, 2.1}), {.within = 0.3});
  const double height = 0.1;  // 2 (1 - sqrt(1 - rho^2)) = 0.2
  const double rho2 = 1 - (1 - height) * (1 - height);
  EXPECT_GE(disc.area, kPi * rho2 * (1 - 1e-9));
  EXPECT_LE(disc.area, kPi * rho2 * 1.02);
  EXPECT_EQ(contact_patch(sphere, Pose(), sphere, Pose::translation({0, 0, 2.1}), {.within = 0.09}).kind,
            PatchKind::empty);
}

/// Superellipsoids with nearly flat faces: all the patch, to the tolerance, by rays; and no jump when they are tilted.
TEST(ContactPatch, OfSuperellipsoidBoxes) {
  Random random(2);
  const Superellipsoid body({1, 0.8, 0.6}, 0.2, 0.2);
  for (int i = 0; i < repetitions(20); ++i) {
    const Pose X_WB = turned({random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), 1.19}, random.uniform(-3, 3), kUp);
    const DistanceResult at = distance(body, Pose(), body, X_WB);
    const double within = std::max(0.0, at.distance) + random.uniform(0.005, 0.05);
    const ContactPatch patch = contact_patch(body, Pose(), body, X_WB, at, {.within = within, .max_points = 100});
    check_form(patch);
    ASSERT_EQ(patch.kind, PatchKind::polygon);
    for (int k = 0; k < 60; ++k) {
      const std::size_t c = static_cast<std::size_t>(random.uniform() * static_cast<double>(patch.points.size()));
      const Vector3d u = patch.centre + random.uniform(0, 1.3) * (patch.points[c].point_a - patch.centre);
      const double outside = outside_by(patch, u);
      const double gap = gap_by_rays(body, Pose(), body, X_WB, patch.normal, u);
      if (gap < within - 1e-9) {
        EXPECT_LE(outside, 1e-9) << i;
      }
      // Corners are not further outside than the error, nor is any point of a side.
      if (gap > within + 1e-9) {
        EXPECT_GE(outside, -patch.error - 1e-9) << i;
      }
    }
  }
}

TEST(ContactPatch, OfTiltedSuperellipsoidsDoesNotJump) {
  const Superellipsoid cube({1, 1, 1}, 0.2, 0.2);
  const HalfSpace floor;
  const auto patch_at = [&](double tilt) {
    return contact_patch(floor, Pose(), cube, turned({0, 0, 1}, tilt, Vector3d(0.2, 1, 0)), {.within = 1e-3});
  };
  const ContactPatch flat = patch_at(0);
  ASSERT_EQ(flat.kind, PatchKind::polygon);
  EXPECT_GT(flat.area, 1);
  for (const double tilt : {-1e-6, 1e-6}) {
    // The witness point moves across the face: |x|^10 has no curvature in the middle.
    const ContactPatch tilted = patch_at(tilt);
    EXPECT_NEAR(tilted.area, flat.area, 0.03 * flat.area);
    EXPECT_LE((tilted.centre - flat.centre).norm(), 0.03);
  }
}

TEST(ContactPatch, OfPlacedAndErasedShapes) {
  const Box box({1, 2, 0.5});
  const Pose X_WB = turned({0.2, 0.1, 1.5}, 0.3, kUp);
  const ContactPatch plain = contact_patch(Box({2, 2, 1}), Pose(), box, X_WB, PatchOptions{});
  const Pose X_BI = turned({0.4, -0.2, 0.3}, 0.7, {1, 2, 3});
  const Placed<Box> placed(box, X_BI);
  const ContactPatch other =
      contact_patch(Shape(Box({2, 2, 1})), Pose(), placed, X_WB * X_BI.inverse(), PatchOptions{});
  EXPECT_NEAR(other.area, plain.area, 1e-12);
  EXPECT_EQ(other.points.size(), plain.points.size());
  const ContactPatch erased =
      contact_patch(AnyConvex(Box({2, 2, 1})), Pose(), AnyConvex(placed), X_WB * X_BI.inverse(), PatchOptions{});
  EXPECT_NEAR(erased.area, plain.area, 1e-12);
  EXPECT_LE(erased.error, 1e-12);
  // A and B exchanged.
  const ContactPatch back = contact_patch(box, X_WB, Box({2, 2, 1}), Pose(), PatchOptions{});
  EXPECT_NEAR(back.area, plain.area, 1e-12);
  EXPECT_LE((back.normal + plain.normal).norm(), 1e-15);
}

TEST(ContactPatch, OfManyCornersHasAnIdentityForEach) {
  // More corners than sectors, all around, and at both ends of a thin patch.
  const HalfSpace floor;
  const ContactPatch disc = contact_patch(floor, Pose(), Sphere(1), Pose::translation({0, 0, 1}),
                                          {.within = 0.1, .tolerance = 1e-4, .max_points = 1000});
  check_form(disc);
  EXPECT_GT(disc.points.size(), 128U);
  EXPECT_NEAR(disc.area, kPi * (1 - 0.81), 1e-3);
  const ContactPatch thin = contact_patch(floor, Pose(), Ellipsoid({1, 0.01, 1}), Pose::translation({0, 0, 1}),
                                          {.within = 0.01, .tolerance = 1e-4, .max_points = 100});
  check_form(thin);
}

TEST(ContactPatch, SmallerThanTheDistanceOfCorners) {
  // A corner of a box, on three edges, lies in a floor by less than the distance at which corners count as one.
  const HalfSpace floor;
  const Matrix3d R = Eigen::Quaterniond::FromTwoVectors(Vector3d(1, 1, 1), -kUp).toRotationMatrix();
  for (const double depth : {1e-7, 1e-5}) {
    const ContactPatch patch = contact_patch(floor, Pose(), Box({1, 1, 1}), {R, {0, 0, std::sqrt(3.0) - depth}}, {});
    check_form(patch);
    ASSERT_EQ(patch.kind, PatchKind::polygon) << depth;
    EXPECT_EQ(patch.points.size(), 3U) << depth;
    // The section of a cube across its diagonal at depth d: an equilateral triangle of edge sqrt(6) d.
    EXPECT_NEAR(patch.area, std::sqrt(3.0) / 4 * 6 * depth * depth, 1e-7 * depth);
  }
}

/// The answer for bodies further apart than `within` has a normal, and nothing else.
TEST(ContactPatch, OfBodiesFarApartIsEmpty) {
  const auto check = [](const ContactPatch& patch, const DistanceResult& at) {
    EXPECT_EQ(patch.kind, PatchKind::empty);
    EXPECT_LE((patch.normal - at.normal).norm(), 1e-15);
    EXPECT_EQ(patch.area, 0);
    EXPECT_EQ(patch.error, 0);
    EXPECT_EQ(patch.centre, Vector3d(Vector3d::Zero()));
    EXPECT_TRUE(patch.points.empty());
  };
  const Pose X = turned({1, 0.5, 3}, 0.3, {1, 2, 3});
  for (const Shape& a : {Shape(Box({1, 1, 1})), Shape(Ellipsoid({1, 0.8, 0.5})), Shape(Cylinder(1, 1))}) {
    for (const Shape& b : {Shape(Box({1, 1, 0.6})), Shape(Superellipsoid({1, 1, 0.6}, 0.3, 0.3))}) {
      const DistanceResult at = distance(a, Pose(), b, X);
      ASSERT_GT(at.distance, 0);
      for (const double share : {0.0, 0.5, 0.999}) {
        check(contact_patch(a, Pose(), b, X, at, {.within = share * at.distance}), at);
      }
      EXPECT_NE(contact_patch(a, Pose(), b, X, at, {.within = 1.001 * at.distance}).kind, PatchKind::empty);
    }
  }
  // Along another normal, the one body may be on the wrong side of the other: the distance says nothing.
  DistanceResult at = distance(Box({1, 1, 1}), Pose(), Box({1, 1, 1}), Pose::translation({0, 0.5, 3}));
  at.normal = -at.normal;
  EXPECT_EQ(contact_patch(Box({1, 1, 1}), Pose(), Box({1, 1, 1}), Pose::translation({0, 0.5, 3}), at, {}).kind,
            PatchKind::polygon);
}

TEST(ContactPatch, RefusesBadOptions) {
  const Box box({1, 1, 1});
  const Pose X_WB = Pose::translation({0, 0, 2.5});
  DistanceResult at = distance(box, Pose(), box, X_WB);
  const auto message = [&](const PatchOptions& options) {
    return message_of([&] { static_cast<void>(contact_patch(box, Pose(), box, X_WB, at, options)); });
  };
  EXPECT_EQ(message({.within = -1}), "contact_patch: within is -1; accepted: a length, 0 to 1e100");
  EXPECT_EQ(message({.within = 1e200}), "contact_patch: within is 1e+200; accepted: a length, 0 to 1e100");
  EXPECT_NE(message({.within = std::nan("")}).find("within is nan"), std::string::npos);
  EXPECT_EQ(message({.tolerance = 0}), "contact_patch: tolerance is 0; accepted: 1e-4 to 0.5");
  EXPECT_EQ(message({.max_points = 2}), "contact_patch: max_points is 2; accepted: 3 or more");
  EXPECT_EQ(contact_patch(box, Pose(), box, X_WB, at, {.within = 0.4}).kind, PatchKind::empty);
  at.normal *= 2;
  EXPECT_EQ(message({}), "contact_patch: the normal has length 2; accepted: 1");
  at.status = DistanceStatus::not_converged;
  EXPECT_EQ(contact_patch(box, Pose(), box, X_WB, at, PatchOptions{}).kind, PatchKind::empty);
  DistanceResult along;
  along.status = DistanceStatus::separated;
  along.normal = Vector3d::UnitX();
  along.point_a = along.point_b = Vector3d::Zero();
  EXPECT_NE(message_of([&] {
              static_cast<void>(contact_patch(HalfSpace(), Pose(), box, X_WB, along, PatchOptions{}));
            }).find("points into a half-space or along its plane"),
            std::string::npos);
}

}  // namespace
}  // namespace geom
