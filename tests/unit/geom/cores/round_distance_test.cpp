/// distance() of cylinders and cones where decisions are ties or nearly so: coaxial and parallel bodies, rims on rims,
/// sides on faces, turned by angles down to rounding; and overlaps.

#include "common/geom/core_pairs.h"
#include "common/geom/expect.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <variant>

namespace geom {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::lower_bound;
using geom_test::Random;
using geom_test::repetitions;

using RoundPartner = std::variant<Cylinder, Cone, Capsule, Box, ConvexPolyhedron>;

RoundPartner random_partner(std::size_t kind, Random& random) {
  const auto length = [&] { return random.log_uniform(0.1, 10); };
  switch (kind) {
    case 0:
      return Cylinder(length(), length());
    case 1:
      return Cone(length(), length());
    case 2:
      return Capsule(length(), random.log_uniform(1e-2, 1));
    case 3:
      return Box({length(), length(), length()});
    default:
      return geom_test::random_polyhedron(random.coin() ? 8 : 30, random);
  }
}

double distance_at(const RoundPartner& a, const RoundPartner& b, const Vector3d& p, const Matrix3d& R) {
  return std::visit([&](const auto& s, const auto& t) { return distance(s, Pose(), t, Pose(R, p)).distance; }, a, b);
}

TEST(RoundDistance, OfAlignedBodiesIsThatOfTheirFacesAndSides) {
  const Matrix3d I = Matrix3d::Identity();
  const Matrix3d lying = Eigen::AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitX()).toRotationMatrix();
  const Matrix3d upside_down = Vector3d(1, -1, -1).asDiagonal();
  const RoundPartner rod = Cylinder(2, 0.5), disc = Cylinder(0.25, 2), cone = Cone(4, 3), box = Box({1, 2, 3});
  EXPECT_EQ(distance_at(rod, rod, {0, 0, 5}, I), 1);                       // coaxial
  EXPECT_EQ(distance_at(rod, disc, {0, 0, 3.25}, I), 1);                   // coaxial, of two radii
  EXPECT_EQ(distance_at(rod, rod, {0.75, 0, 5}, I), 1);                    // faces overlap in part
  EXPECT_NEAR(distance_at(rod, rod, {4, 0, 7}, I), std::sqrt(18), 1e-14);  // rims
  EXPECT_EQ(distance_at(rod, rod, {3, 0, 1}, I), 2);                       // side by side
  EXPECT_EQ(distance_at(rod, rod, {3, 0, 4}, I), 2);                       // side by side, a rim each
  EXPECT_NEAR(distance_at(rod, rod, {0.25, 1, 3.5}, lying), 1, 1e-15);     // a side on a face
  EXPECT_NEAR(distance_at(rod, rod, {3, 1, 1}, lying), 2, 1e-15);          // sides crossing
  EXPECT_EQ(distance_at(cone, cone, {0, 0, 5}, I), 1);                     // a base above an apex
  EXPECT_EQ(distance_at(cone, cone, {1, 0, 7}, upside_down), distance_at(cone, cone, {-1, 0, 7}, upside_down));
  EXPECT_EQ(distance_at(cone, cone, {0, 0, -3}, upside_down), 1);               // base on base
  EXPECT_EQ(distance_at(box, cone, {0.5, -1, 6}, I), 2);                        // a base on a face
  EXPECT_EQ(distance_at(box, rod, {3, 1, 1}, I), 1.5);                          // a side along a face
  EXPECT_NEAR(distance_at(box, rod, {3, 4, 0}, I), std::sqrt(8) - 0.5, 1e-14);  // a side along an edge
}

/// Bodies nearly parallel or across each other, side by side or on top of each other: both bounds certify the answer.
TEST(RoundDistance, OfNearlyAlignedBodiesIsCertified) {
  Random random(1);
  long pairs = 0;
  long wide = 0;
  for (int i = 0; i < repetitions(10000); ++i) {
    const RoundPartner a = random_partner(static_cast<std::size_t>(i % 2), random);
    const RoundPartner b = random_partner(static_cast<std::size_t>(i / 2 % 5), random);
    const Pose X_WA = random.pose(1.0);
    const double angle = random.log_uniform(1e-17, 1e-1);
    const double quarters = std::floor(3 * random.uniform());
    const Matrix3d aligned =
        X_WA.rotation() * Eigen::AngleAxisd(0.5 * quarters * std::numbers::pi, Vector3d::UnitX()).toRotationMatrix();
    const Matrix3d R = Eigen::AngleAxisd(angle, random.direction()) * aligned;
    const Vector3d axis = X_WA.rotation().col(2);
    const double side = std::floor(3 * random.uniform());
    const Vector3d way = side == 0   ? Vector3d(random.coin() ? axis : -axis)
                         : side == 1 ? Vector3d(axis.cross(random.direction()).normalized())
                                     : random.direction();
    std::visit(
        [&](const auto& s, const auto& t) {
          const double radii = s.bounding_radius() + t.bounding_radius();
          const Vector3d aside =
              random.coin() ? Vector3d(Vector3d::Zero())
                            : Vector3d(random.uniform(0, 1.2) * radii * way.cross(random.direction()).normalized());
          const double gap = random.log_uniform(1e-10, 10);
          const double touching =
              s.support(X_WA.rotation().transpose() * way).height + t.support(R.transpose() * -way).height;
          const Pose X_WB(R, X_WA.position() + (touching + gap) * way + aside);
          const DistanceResult r = distance(s, X_WA, t, X_WB);
          const double size = (X_WB.position() - X_WA.position()).norm() + radii;
          ASSERT_EQ(r.status, DistanceStatus::separated) << i << " angle " << angle;
          ASSERT_GE(r.distance, gap - 1e-14 * size) << i << " angle " << angle;
          ASSERT_NEAR(lower_bound(s, X_WA, t, X_WB, r.normal), r.distance, 4e-15 * size) << i << " angle " << angle;
          ASSERT_LE(r.error_bound, kBoundGap * size) << i << " angle " << angle;
          ASSERT_NEAR(closest_point(s, X_WA, r.point_a).distance, 0, 1e-11 * size) << i << " angle " << angle;
          ASSERT_NEAR(closest_point(t, X_WB, r.point_b).distance, 0, 1e-11 * size) << i << " angle " << angle;
          ++pairs;
          wide += r.error_bound > 1e-13 * size ? 1 : 0;
        },
        a, b);
    if (HasFatalFailure()) return;
  }
  std::printf("%ld of %ld error bounds are above 1e-13 of the size\n", wide, pairs);
  EXPECT_LE(wide * 1000, pairs);
}

/// Expects no normal with a gap that the error bound excludes, and points that are those of the translation.
TEST(RoundDistance, OfOverlapsIsBounded) {
  Random random(2);
  int answers = 0;
  for (int i = 0; i < repetitions(300); ++i) {
    const RoundPartner a = random_partner(static_cast<std::size_t>(i % 2), random);
    const RoundPartner b = random_partner(static_cast<std::size_t>(i / 2 % 5), random);
    std::visit(
        [&](const auto& s, const auto& t) {
          const Pose X_WA = random.pose(1.0);
          const double reach = s.inscribed_radius() + t.inscribed_radius();
          const Pose X_WB = random.pose(Vector3d(X_WA.position() + random.uniform(0, 1) * reach * random.direction()));
          const DistanceResult r = distance(s, X_WA, t, X_WB);
          if (r.status == DistanceStatus::not_converged) return;
          ++answers;
          const double size = reach + s.bounding_radius() + t.bounding_radius();
          ASSERT_EQ(r.status, DistanceStatus::overlapping) << i;
          ASSERT_LE(r.error_bound, kWidestDepthGap * size) << i;
          ASSERT_NEAR(lower_bound(s, X_WA, t, X_WB, r.normal), r.distance, 1e-14 * size) << i;
          for (int k = 0; k < 200; ++k) {
            const double gap = lower_bound(s, X_WA, t, X_WB, random.direction());
            ASSERT_LE(gap, r.distance + r.error_bound + 1e-14 * size) << i;
          }
          ASSERT_NEAR(closest_point(s, X_WA, r.point_a).distance, 0, r.residual + 1e-13 * size) << i;
          ASSERT_NEAR(closest_point(t, X_WB, r.point_b).distance, 0, r.residual + 1e-13 * size) << i;
        },
        a, b);
    if (HasFatalFailure()) return;
  }
  EXPECT_GE(answers * 50, repetitions(300) * 49);  // others are declined
}

/// Faces that meet a rim at gaps down to rounding: bounds alone would leave the point
/// where they touch an error of the square root of rounding.
TEST(RoundDistance, PointsOnRimsAreKnownToRounding) {
  Random random(4);
  double worst = 0;
  for (int i = 0; i < repetitions(2000); ++i) {
    const Cylinder base(random.uniform(0.2, 1), random.uniform(0.5, 1));
    const RoundPartner top = random_partner(static_cast<std::size_t>(i % 2), random);
    std::visit(
        [&](const auto& s) {
          if constexpr (requires {
                          s.radius();
                          s.volume();
                        }) {
            // The point of `top` that is furthest down is above the face of `base`.
            const double tilt = random.uniform(0.1, 1.4);
            const Matrix3d R = Eigen::AngleAxisd(random.uniform(0, 6), Vector3d::UnitZ()).toRotationMatrix() *
                               Eigen::AngleAxisd(tilt, Vector3d::UnitX()).toRotationMatrix();
            const Vector3d down = -Vector3d::UnitZ();
            const Vector3d lowest = R * s.support(R.transpose() * down).point;
            const double gap = random.coin() ? random.uniform(-1e-15, 1e-15) : random.log_uniform(1e-15, 1e-9);
            const Vector3d above(0.3 * base.radius(), 0, base.half_length() + gap);
            const Vector3d start = Vector3d::UnitZ() + random.log_uniform(1e-16, 1e-2) * random.direction();
            const Pose X_WA = random.pose(1.0);
            const Pose X_WB(X_WA.rotation() * R, X_WA.position() + X_WA.rotation() * (above - lowest));
            const DistanceResult r = distance(base, X_WA, s, X_WB, {.start = X_WA.rotation() * start});
            ASSERT_NE(r.status, DistanceStatus::not_converged) << i;
            const double size = lowest.norm() + base.bounding_radius() + s.bounding_radius();
            worst = std::max(worst, (X_WA.to_body(r.point_b) - above).norm() / size);
          }
        },
        top);
    if (HasFatalFailure()) return;
  }
  std::printf("points are off by %.1e of the size at most\n", worst);
  EXPECT_LE(worst, 1e-12);
}

/// Bodies that touch at one of the aligned or drawn contacts, moved into each other along its normal: the overlap is
/// proved, however shallow, and no other normal has a gap that the bound excludes.
TEST(RoundDistance, OfShallowOverlapsIsProved) {
  Random random(3);
  long pairs = 0, unproved = 0, shallow = 0;
  for (int i = 0; i < repetitions(3000); ++i) {
    const RoundPartner a = random_partner(static_cast<std::size_t>(i % 2), random);
    const RoundPartner b = random_partner(static_cast<std::size_t>(i / 2 % 5), random);
    std::visit(
        [&](const auto& s, const auto& t) {
          const Pose X_WA = random.pose(1.0);
          const double radii = s.bounding_radius() + t.bounding_radius();
          const Pose far = random.pose(Vector3d(X_WA.position() + 1.5 * radii * random.direction()));
          const DistanceResult apart = distance(s, X_WA, t, far);
          ASSERT_EQ(apart.status, DistanceStatus::separated) << i;
          const double depth = radii * random.log_uniform(1e-11, 1e-7);
          const Pose X_WB(far.rotation(), far.position() - (apart.distance + depth) * apart.normal);
          const DistanceResult r = distance(s, X_WA, t, X_WB);
          const double size = (X_WB.position() - X_WA.position()).norm() + radii;
          if (r.status == DistanceStatus::separated) return;  // sharp features have gaps along other normals
          ASSERT_EQ(r.status, DistanceStatus::overlapping) << i;
          ASSERT_GE(r.distance, -depth - 1e-14 * size) << i;
          ASSERT_LE(r.error_bound, 1e-9 * size) << i;
          ++pairs;
          shallow += depth < 1e-9 * size ? 1 : 0;
          unproved += r.distance + r.error_bound < -1e-4 * depth ? 0 : 1;
          for (int k = 0; k < 100; ++k) {
            const double gap = lower_bound(s, X_WA, t, X_WB, random.direction());
            ASSERT_LE(gap, r.distance + r.error_bound + 1e-14 * size) << i;
          }
        },
        a, b);
    if (HasFatalFailure()) return;
  }
  std::printf("%ld of %ld overlaps, %ld of them shallower than 1e-9, are not proved\n", unproved, pairs, shallow);
  EXPECT_LE(unproved * 20, pairs);
  EXPECT_GE(shallow * 4, pairs);
  EXPECT_GE(pairs * 20, repetitions(3000) * 19);
}

}  // namespace
}  // namespace geom
