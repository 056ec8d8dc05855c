// Overlaps in special positions: common centres and axes, right angles, and all of these but for rounding. The best
// normals are then many, or form a circle.

#include "common/geom/random.h"
#include "common/geom/shapes.h"

#include <geom/geom.h>
#include <geom/kernel/meridian_search.h>

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>

namespace geom {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::Random;

/// A position of B in A's frame, with rounding errors or small deviations.
struct Special {
  Matrix3d R;
  Vector3d t;
};

/// Right angles about the axes, turns about z, and a shift along an axis, across it or anywhere, by anything down to
/// rounding.
Special right_angles(Random& random) {
  const auto quarters = [&] { return 0.5 * std::numbers::pi * std::floor(4 * random.uniform()); };
  Matrix3d R =
      (AngleAxisd(quarters(), Vector3d::UnitX()) * AngleAxisd(quarters(), Vector3d::UnitZ())).toRotationMatrix();
  if (random.uniform() < 0.5) R = R.array().round().matrix();
  if (random.uniform() < 0.25)
    R = AngleAxisd(random.uniform(0, 2 * std::numbers::pi), Vector3d::UnitZ()).toRotationMatrix();
  const double by = 0.3 * random.log_uniform(1e-16, 1);
  const Vector3d directions[4] = {Vector3d::Zero(), Vector3d::UnitZ(), Vector3d::UnitX(), random.direction()};
  return {R, by * directions[std::min(3, static_cast<int>(4 * random.uniform()))]};
}

/// Axes that are parallel but for rounding, on each other or beside each other.
Special common_axes(Random& random) {
  const double tilt = random.uniform() < 0.5 ? 0 : random.log_uniform(1e-16, 1e-11);
  const Matrix3d R =
      (AngleAxisd(tilt, random.direction()) * AngleAxisd(random.uniform(0, 2 * std::numbers::pi), Vector3d::UnitZ()))
          .toRotationMatrix();
  const Vector3d across(random.uniform() < 0.5 ? 0 : 0.1 * random.log_uniform(1e-16, 1), 0, 0);
  return {R, across + random.uniform(-0.3, 0.3) * Vector3d::UnitZ()};
}

/// Answers, and how wide their bounds are, in units of the size.
struct Tally {
  int overlaps = 0;
  double widest = 0;
};

template <class A, class B, class Place>
void expect_answers(const A& a, const B& b, const Place& place, int draws, std::uint64_t seed, Tally& tally) {
  constexpr int kNormals = 200;
  Random random(seed);
  for (int k = 0; k < draws; ++k) {
    const Special special = place(random);
    const Pose X_WA = k % 2 == 0 ? Pose() : random.pose(1);
    const Pose X_WB(Matrix3d(X_WA.rotation() * special.R), Vector3d(X_WA.position() + X_WA.rotation() * special.t));
    const DistanceResult found = distance(a, X_WA, b, X_WB);
    ASSERT_NE(found.status, DistanceStatus::not_converged) << k;
    if (found.distance > 0) continue;  // thin ones, shifted by more than they are thick
    const double size = special.t.norm() + a.bounding_radius() + b.bounding_radius();
    ++tally.overlaps;
    tally.widest = std::max(tally.widest, found.error_bound / size);
    const auto gap = [&](const Vector3d& n) {
      return n.dot(X_WB.position() - X_WA.position()) - a.support(X_WA.rotation().transpose() * n).height -
             b.support(-(X_WB.rotation().transpose() * n)).height;
    };
    EXPECT_NEAR(gap(found.normal), found.distance, 1e-14 * size) << k;
    EXPECT_LE((found.point_b - found.point_a - found.distance * found.normal).norm(), 1e-14 * size) << k;
    for (int j = 0; j < kNormals; ++j) {
      const Vector3d n = j % 2 == 0 ? random.direction()
                                    : (found.normal + random.log_uniform(1e-8, 1) * random.direction()).normalized();
      ASSERT_LE(gap(n), found.distance + found.error_bound + 1e-14 * size) << k;
    }
  }
}

template <class Place, class... Shapes>
Tally expect_answers_of_all(const Place& place, int draws, const Shapes&... shapes) {
  Tally tally;
  std::uint64_t seed = 1;
  const auto all = std::tie(shapes...);
  const auto with_all = [&](const auto& a) {
    std::apply([&](const auto&... b) { (expect_answers(a, b, place, draws, ++seed, tally), ...); }, all);
  };
  (with_all(shapes), ...);
  return tally;
}

TEST(SpecialPositions, AreAnsweredAtRightAngles) {
  const auto tetrahedron = ConvexPolyhedron::in_principal_frame(solid_vertices("tetrahedron"));
  const Tally tally = expect_answers_of_all(right_angles, 40, Capsule(1, 0.5), Cylinder(1, 0.8), Cylinder(0.05, 1),
                                            Cone(2, 1), Box({1, 0.7, 0.4}), Box({0.5, 0.5, 0.5}), tetrahedron,
                                            Rounded<Cylinder>(Cylinder(0.7, 0.5), 0.1), Ellipsoid({1, 1, 3}));
  EXPECT_GE(tally.overlaps, 9 * 9 * 39);
  EXPECT_LE(tally.widest, kDepthGap);
}

TEST(SpecialPositions, AreAnsweredOnCommonAxes) {
  const Tally tally =
      expect_answers_of_all(common_axes, 40, Capsule(1, 0.5), Cylinder(1, 0.8), Cylinder(0.7, 0.5), Cone(2, 1),
                            Cone(3, 1), Rounded<Cone>(Cone(2, 1), 0.1), Ellipsoid({1, 1, 3}), Ellipsoid({1, 1, 0.3}));
  EXPECT_EQ(tally.overlaps, 8 * 8 * 40);
  EXPECT_LE(tally.widest, kDepthGap);
}

// The shorter way out is along the axis or across it.
TEST(SpecialPositions, HaveTheDepthOfCoaxialCylinders) {
  Random random(3);
  for (int k = 0; k < 200; ++k) {
    const double h_a = random.log_uniform(0.1, 10), r_a = random.log_uniform(0.1, 10);
    const double h_b = random.log_uniform(0.1, 10), r_b = random.log_uniform(0.1, 10);
    const Pose X_WA = random.pose(1);
    const double shift = random.uniform(-1, 1) * (h_a + h_b);
    const Pose X_WB = X_WA * Pose::translation({0, 0, shift});
    const DistanceResult found = distance(Cylinder(h_a, r_a), X_WA, Cylinder(h_b, r_b), X_WB);
    const double size = std::abs(shift) + std::hypot(h_a, r_a) + std::hypot(h_b, r_b);
    EXPECT_NEAR(-found.distance, std::min(h_a + h_b - std::abs(shift), r_a + r_b), 1e-14 * size);
    EXPECT_LE(found.error_bound, kDepthGap * size);
  }
}

// Round sides that touch all around: points that were off n in azimuth hardly moved to each other.
TEST(SpecialPositions, AreAnsweredForCylindersInCones) {
  Random random(7);
  for (int k = 0; k < 1000; ++k) {
    const Cylinder a(random.log_uniform(0.05, 3), random.log_uniform(0.05, 3));
    const Cone b(random.log_uniform(0.05, 3), random.log_uniform(0.05, 3));
    const Pose X_WA = random.pose(1);
    const Matrix3d R = (AngleAxisd(random.log_uniform(1e-16, 1e-9), random.direction()) *
                        AngleAxisd(random.uniform(0, 2 * std::numbers::pi), Vector3d::UnitZ()))
                           .toRotationMatrix();
    const Pose X_WB(Matrix3d(X_WA.rotation() * R),
                    Vector3d(X_WA.position() + X_WA.rotation() * Vector3d(0, 0, random.uniform(-0.5, 0.5))));
    ASSERT_NE(distance(a, X_WA, b, X_WB).status, DistanceStatus::not_converged) << k;
  }
}

// A ball is of revolution about every axis, whichever its own is said to be.
TEST(SpecialPositions, HaveBallsOnTheAxis) {
  Random random(8);
  for (int k = 0; k < 20; ++k) {
    const Pose X_WA = random.pose(1);
    const Pose X_WB(random.pose(0).rotation(), X_WA.to_world({0, 0, random.uniform(0, 0.1)}));
    const DistanceResult found = distance(Cylinder(1, 0.8), X_WA, Ellipsoid({0.5, 0.5, 0.5}), X_WB);
    ASSERT_EQ(found.status, DistanceStatus::overlapping);
    EXPECT_NEAR(found.distance, -1.3, kDepthGap * 2);
    EXPECT_LT(found.iterations, kFewDepthSamples);
  }
}

// Nearly parallel axes: the slack of a small tilt is in the bound.
TEST(SpecialPositions, BoundTheDepthOfNearlyCommonAxes) {
  const Cylinder a(1, 0.8);
  const Capsule b(1, 0.5);
  Random random(4);
  for (const double tilt : {1e-10, 1e-9, 1e-8, 1e-7}) {
    const Pose X_WA = random.pose(1);
    const Pose X_WB(Matrix3d(X_WA.rotation() * AngleAxisd(tilt, Vector3d::UnitX()).toRotationMatrix()),
                    Vector3d(X_WA.position() + X_WA.rotation() * Vector3d(0, 0, 0.1)));
    const DistanceResult found = distance(a, X_WA, b, X_WB);
    ASSERT_EQ(found.status, DistanceStatus::overlapping) << tilt;
    EXPECT_NEAR(found.distance, -1.3, found.error_bound + 1.5 * tilt);
    EXPECT_LE(found.error_bound, std::max(kDepthGap, kRingDepthGap) * 3);
  }
}

/// Deep overlaps in any positions: the points are on both surfaces, not only their gap is that of the normal.
template <class A, class B>
void expect_points_on_surfaces(const A& a, const B& b) {
  constexpr double kOnSurface = 2e-6;
  Random random(6);
  for (int k = 0; k < 40; ++k) {
    const Pose X_WA = random.pose(1);
    const double depth = random.uniform() * 0.5 * (a.inscribed_radius() + b.inscribed_radius());
    const Pose X_WB(random.pose(0).rotation(), Vector3d(X_WA.position() + depth * random.direction()));
    const DistanceResult found = distance(a, X_WA, b, X_WB);
    ASSERT_EQ(found.status, DistanceStatus::overlapping) << k;
    const double size = a.bounding_radius() + b.bounding_radius();
    EXPECT_LE(found.residual, 1e-6 * size) << k;
    EXPECT_LE((closest_point(a, X_WA, found.point_a).point - found.point_a).norm(), kOnSurface * size) << k;
    EXPECT_LE((closest_point(b, X_WB, found.point_b).point - found.point_b).norm(), kOnSurface * size) << k;
  }
}

TEST(DeepOverlaps, HavePointsThatBelongToTheNormal) {
  const auto octahedron = ConvexPolyhedron::in_principal_frame(solid_vertices("octahedron"));
  const auto with_all = [&](const auto& smooth) {
    expect_points_on_surfaces(smooth, Box({1, 0.7, 0.4}));
    expect_points_on_surfaces(smooth, Cylinder(1, 0.8));
    expect_points_on_surfaces(octahedron, smooth);
    expect_points_on_surfaces(smooth, Capsule(1, 0.5));
  };
  with_all(Ellipsoid({1, 0.8, 0.6}));
  with_all(Superellipsoid({1, 0.8, 0.6}, 0.5, 0.5));
}

// Polytopes of which nothing but the support function is known: whether they overlap is what the distance says, and the
// points are no corners of the faces that touch.
TEST(DeepOverlaps, SayWhetherBoxesThatNearlyTouchDo) {
  const geom_test::PlainPolytope<Box> a{Box({1, 0.7, 0.4})};
  Random random(9);
  for (int k = 0; k < 200; ++k) {
    const double gap = (random.coin() ? 1 : -1) * random.log_uniform(1e-14, 1e-8);
    const Pose X_WA = random.pose(1);
    const Matrix3d R = AngleAxisd(random.uniform(0, 2 * std::numbers::pi), Vector3d::UnitX()).toRotationMatrix();
    const Pose X_WB(Matrix3d(X_WA.rotation() * R), X_WA.to_world({2 + gap, 0.3 * random.uniform(), 0}));
    const DistanceResult found = distance(a, X_WA, a, X_WB);
    ASSERT_NE(found.status, DistanceStatus::not_converged) << k;
    EXPECT_EQ(found.status == DistanceStatus::separated, found.distance >= 0) << k;
    EXPECT_NEAR(found.distance, gap, found.error_bound + 4e-15) << k;
    EXPECT_LE(found.residual, 1e-6) << k;
  }
}

/// g of two bodies, as the searches sample it.
struct SampleOfTwo {
  const Cone& a;
  const Cylinder& b;
  Vector3d r;

  kernel::Tangent operator()(const Vector3d& n) const {
    const Support s_a = a.support(n);
    const Support s_b = b.support(-n);
    return {n, r + s_b.point - s_a.point, n.dot(r) - s_a.height - s_b.height};
  }
};

// Of all normals none is better than the best of the meridian, which a scan of it confirms.
TEST(MeridianSearch, FindsTheLargestGapOfParallelAxes) {
  Random random(5);
  for (int k = 0; k < 100; ++k) {
    const Cone a(random.log_uniform(0.2, 5), random.log_uniform(0.2, 5));
    const Cylinder b(random.log_uniform(0.2, 5), random.log_uniform(0.2, 5));
    const SampleOfTwo sample{a, b, random.log_uniform(1e-3, 1) * random.direction()};
    const double size = sample.r.norm() + a.bounding_radius() + b.bounding_radius();
    const kernel::MeridianSearch search(sample, Vector3d::UnitZ(), sample.r, 0, 1e-10 * size, 10000);
    EXPECT_LE(search.upper() - search.best().g, 1.01e-10 * size);
    double scanned = -size;
    const Vector3d e = Vector3d(sample.r.x(), sample.r.y(), 0).normalized();
    for (int j = 0; j <= 2000; ++j) {
      const double angle = std::numbers::pi * j / 2000;
      scanned = std::max(scanned, sample(std::cos(angle) * Vector3d::UnitZ() + std::sin(angle) * e).g);
    }
    EXPECT_GE(search.best().g, scanned - 1e-10 * size);
    EXPECT_LE(search.best().g, scanned + 2e-3 * size);
    for (int j = 0; j < 500; ++j) EXPECT_LE(sample(random.direction()).g, search.upper() + 1e-15 * size);
  }
}

}  // namespace
}  // namespace geom
