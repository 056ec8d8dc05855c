/// distance() of shapes that are not the library's: the template path, with and without a curvature bound.

#include "common/geom/expect.h"
#include "common/geom/implicit.h"
#include "common/geom/manufactured.h"
#include "common/geom/shapes.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <algorithm>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::answers;
using geom_test::declined;
using geom_test::distance_tolerance;
using geom_test::extent_of;
using geom_test::ManufacturedPair;
using geom_test::normal_tolerance;
using geom_test::PlainBall;
using geom_test::PowerBody;
using geom_test::Random;
using geom_test::repetitions;
using geom_test::SweptEllipsoid;
using geom_test::WrappedEllipsoid;

static_assert(SupportShape<PlainBall>);
static_assert(SupportShape<WrappedEllipsoid>);
static_assert(SupportShape<SweptEllipsoid>);
static_assert(!ImplicitSurface<PlainBall>);

static_assert(ImplicitSurface<PowerBody>);
static_assert(!SupportShape<PowerBody>);

struct NoHessian {
  Support support(const Vector3d& n) const { return {n.norm(), n.normalized()}; }
  double bounding_radius() const { return 1; }
  double inscribed_radius() const { return 1; }
};
static_assert(!SupportShape<NoHessian>);

struct HalfSpaceOfTheConcept {
  double value(const Vector3d& x) const { return x.z(); }
  Vector3d gradient(const Vector3d&) const { return Vector3d::UnitZ(); }
  Eigen::Matrix3d hessian(const Vector3d&) const { return Eigen::Matrix3d::Zero(); }
};
static_assert(ImplicitSurface<HalfSpaceOfTheConcept>);

TEST(UserShape, BallsWithoutACurvatureBoundHaveTheirDistance) {
  const PlainBall a{1};
  const PlainBall b{0.5};
  Random random(1);
  for (const double gap : {100.0, 1.0, 1e-3, 1e-9, -1e-9, -1e-3, -1.0, -1.49}) {
    const ManufacturedPair pair = geom_test::manufacture(a, b, gap, random);
    const DistanceResult r = distance(a, pair.X_WA, b, pair.X_WB);
    ASSERT_TRUE(answers(r, gap, 1e-15 * extent_of(pair), extent_of(pair))) << gap;
    ASSERT_LE((r.normal - pair.normal).norm(), 1e-14 * extent_of(pair)) << gap;
    ASSERT_LE(r.error_bound, 2e-7 * extent_of(pair)) << gap;
  }
}

/// Checks balls without a curvature bound: nothing tells that every direction is as good, and the error bound says how
/// far the proof got.
TEST(UserShape, ConcentricBallsHaveADepthAndAWideBound) {
  const DistanceResult r = distance(PlainBall{1}, Pose(), PlainBall{1}, Pose());
  EXPECT_EQ(r.status, DistanceStatus::overlapping);
  EXPECT_NEAR(r.distance, -2, 1e-15);
  EXPECT_LE(r.error_bound, 2e-3);
  EXPECT_GT(r.error_bound, 1e-6);
}

TEST(UserShape, AnUnknownEllipsoidIsAnsweredLikeOurs) {
  Random random(2);
  for (int i = 0; i < repetitions(1000); ++i) {
    const Ellipsoid a = i % 2 ? random.spheroid(random.log_uniform(0.1, 10)) : random.biaxial(10);
    const Ellipsoid b = i % 3 ? random.spheroid(random.log_uniform(0.1, 10)) : random.biaxial(10);
    const double rho = a.min_curvature_radius() + b.min_curvature_radius();
    const double gap = random.coin() ? random.log_uniform(1e-9, 10) : -rho * random.uniform(0.01, 0.9);
    const ManufacturedPair pair = geom_test::manufacture(a, b, gap, random);
    const DistanceResult ours = distance(a, pair.X_WA, b, pair.X_WB);
    const DistanceResult theirs = distance(WrappedEllipsoid{a}, pair.X_WA, WrappedEllipsoid{b}, pair.X_WB);
    const DistanceResult mixed = distance(a, pair.X_WA, WrappedEllipsoid{b}, pair.X_WB);
    ASSERT_TRUE(answers(theirs, gap, distance_tolerance(pair.size), extent_of(pair))) << "pair " << i;
    ASSERT_TRUE(answers(mixed, gap, distance_tolerance(pair.size), extent_of(pair))) << "pair " << i;
    ASSERT_EQ(theirs.status, ours.status) << "pair " << i;
    const double tolerance = 2 * normal_tolerance(a, b, gap, pair.size);
    ASSERT_LE((theirs.normal - ours.normal).norm(), tolerance) << "pair " << i;
    ASSERT_LE((mixed.normal - ours.normal).norm(), tolerance) << "pair " << i;
  }
}

TEST(UserShape, SweepingABallAlongLessensTheDistanceByItsRadius) {
  Random random(3);
  for (int i = 0; i < repetitions(1000); ++i) {
    const SweptEllipsoid a{random.biaxial(5), random.log_uniform(0.01, 1)};
    const SweptEllipsoid b{random.spheroid(random.log_uniform(0.2, 5)), random.log_uniform(0.01, 1)};
    // Down to the certified depth, to which the skins add.
    const double rho = a.min_curvature_radius() + b.min_curvature_radius();
    const double gap = random.coin() ? random.log_uniform(1e-9, 10) : -rho * random.uniform(0.01, 0.9);
    const ManufacturedPair pair = geom_test::manufacture(a, b, gap, random);
    const DistanceResult swept = distance(a, pair.X_WA, b, pair.X_WB);
    ASSERT_TRUE(answers(swept, gap, distance_tolerance(pair.size), extent_of(pair))) << "pair " << i;
    const double core_gap = gap + a.skin + b.skin;
    if (core_gap < 0) continue;
    const DistanceResult core = distance(a.core, pair.X_WA, b.core, pair.X_WB);
    ASSERT_TRUE(answers(core, core_gap, distance_tolerance(pair.size), extent_of(pair))) << "pair " << i;
    ASSERT_LE((core.normal - swept.normal).norm(), 2 * normal_tolerance(a.core, b.core, 0, pair.size));
  }
}

TEST(UserShape, AStartAndALimitOnIterationsMeanTheSame) {
  Random random(4);
  for (int i = 0; i < 500; ++i) {
    const WrappedEllipsoid a{random.biaxial(10)};
    const WrappedEllipsoid b{random.biaxial(10)};
    const ManufacturedPair pair = geom_test::manufacture(a, b, random.log_uniform(1e-6, 10), random);
    const DistanceResult exact = distance(a, pair.X_WA, b, pair.X_WB, {.start = 3 * pair.normal, .max_iterations = 1});
    ASSERT_TRUE(answers(exact, pair.distance, distance_tolerance(pair.size), extent_of(pair))) << "pair " << i;
    ASSERT_EQ(exact.iterations, 1) << "pair " << i;
    // One evaluation from elsewhere is not enough: the search over all normals takes over.
    const DistanceResult r = distance(a, pair.X_WA, b, pair.X_WB, {.start = -pair.normal, .max_iterations = 1});
    ASSERT_TRUE(answers(r, pair.distance, distance_tolerance(pair.size), extent_of(pair))) << "pair " << i;
    ASSERT_GT(r.iterations, 2) << "pair " << i;
  }
}

// |x/a|^n + |y/b|^m + |z/c|^p <= 1 has no closed support function: Newton's method on the equation is the way.
TEST(UserShape, ABodyGivenByItsEquationAloneHasItsDistance) {
  Random random(5);
  int answered = 0;
  const int pairs = repetitions(2000);
  for (int i = 0; i < pairs; ++i) {
    const auto exponent = [&] { return random.uniform(2, 4); };
    const auto semi_axis = [&] { return random.log_uniform(1, 3); };
    const PowerBody a{{semi_axis(), semi_axis(), semi_axis()}, {exponent(), exponent(), exponent()}};
    const PowerBody b{{semi_axis(), semi_axis(), semi_axis()}, {exponent(), exponent(), exponent()}};
    const auto [pair, point_a, point_b] = geom_test::manufacture_surfaces(a, b, random.log_uniform(1e-6, 10), random);
    // From near the answer it is found; from the line of centres it is found or nothing is.
    const double error = 1e-3 * pair.size;
    const WitnessPair near{point_a + error * random.direction(), point_b + error * random.direction(),
                           SeedStatus::usable};
    for (const NewtonSystem system : {NewtonSystem::eight, NewtonSystem::five}) {
      const DistanceResult r = newton_distance(a, pair.X_WA, b, pair.X_WB, system, near);
      ASSERT_TRUE(answers(r, pair.distance, distance_tolerance(pair.size), extent_of(pair))) << "pair " << i;
      const WitnessPair centres = centre_seed(a, pair.X_WA, b, pair.X_WB);
      const DistanceResult crude = newton_distance(a, pair.X_WA, b, pair.X_WB, system, centres);
      if (crude.status == DistanceStatus::separated) {
        ASSERT_TRUE(answers(crude, pair.distance, distance_tolerance(pair.size), extent_of(pair))) << "pair " << i;
        ++answered;
      } else {
        ASSERT_TRUE(declined(crude)) << "pair " << i;
      }
    }
  }
  EXPECT_GE(answered, 0.95 * 2 * pairs);
}

// Nothing bounds the curvature of such a body: no depth is certified.
TEST(UserShape, OverlapsOfABodyGivenByItsEquationAreDeclined) {
  Random random(6);
  for (int i = 0; i < 200; ++i) {
    const PowerBody a{{1, 1.5, 2}, {2, 3, 4}};
    const auto [pair, point_a, point_b] = geom_test::manufacture_surfaces(a, a, -0.01, random);
    const WitnessPair seed{point_a, point_b, SeedStatus::usable};
    ASSERT_TRUE(declined(newton_distance(a, pair.X_WA, a, pair.X_WB, NewtonSystem::eight, seed))) << "pair " << i;
  }
}

/// Distance of two segments from their ends (Ericson, Real-Time Collision Detection (2005), sec. 5.1.9), by brute force
/// over the four end-to-segment distances and the interior solution.
double segment_distance(const Vector3d& p0, const Vector3d& p1, const Vector3d& q0, const Vector3d& q1) {
  const auto to_segment = [](const Vector3d& x, const Vector3d& s0, const Vector3d& s1) {
    const Vector3d d = s1 - s0;
    return (x - s0 - std::clamp((x - s0).dot(d) / d.squaredNorm(), 0.0, 1.0) * d).norm();
  };
  double least =
      std::min({to_segment(p0, q0, q1), to_segment(p1, q0, q1), to_segment(q0, p0, p1), to_segment(q1, p0, p1)});
  const Vector3d u = p1 - p0;
  const Vector3d v = q1 - q0;
  const Vector3d n = u.cross(v);
  if (n.norm() < 1e-12) return least;
  const Vector3d w = q0 - p0;
  const double s = w.cross(v).dot(n) / n.squaredNorm();
  const double t = w.cross(u).dot(n) / n.squaredNorm();
  if (s >= 0 && s <= 1 && t >= 0 && t <= 1) least = std::min(least, std::abs(w.dot(n)) / n.norm());
  return least;
}

/// A user's shape beside the library's, in either place, apart and overlapping by little.
template <class Theirs, class Ours>
void expect_known_answers(const Theirs& theirs, const Ours& ours, Random& random) {
  const double sign = random.coin() ? 1 : -1e-4;
  const double gap = sign * random.log_uniform(1e-6, 1);
  const bool first = random.coin();
  const auto ask = [&](const auto& a, const auto& b) {
    const ManufacturedPair pair = geom_test::manufacture(a, b, gap, random);
    const DistanceResult r = distance(a, pair.X_WA, b, pair.X_WB);
    // kBoundGap where faces or edges meet; an overlap may have a shorter way out, past a sharp edge.
    const double tolerance = kBoundGap * extent_of(pair);
    const bool shorter = gap < 0 && r.distance > gap;
    const double wanted = shorter ? geom_test::lower_bound(a, pair.X_WA, b, pair.X_WB, r.normal) : gap;
    ASSERT_TRUE(answers(r, wanted, tolerance, extent_of(pair))) << "gap " << gap;
    ASSERT_LE(r.error_bound, (gap > 0 ? kWidestGap : 1e-6) * extent_of(pair));
    if (std::abs(gap) > tolerance) {
      ASSERT_EQ(overlap(a, pair.X_WA, b, pair.X_WB), gap > 0 ? Answer::no : Answer::yes);
    }
  };
  first ? ask(theirs, ours) : ask(ours, theirs);
}

TEST(UserShape, BesideTheLibrarysShapesHaveTheirDistance) {
  Random random(9);
  const geom_test::Spherocylinder rod{1.3, 0.4};
  const geom_test::Pear pear{0.7, 1, 0.5};
  for (int k = 0; k < repetitions(300); ++k) {
    const Vector3d axes(random.uniform(0.5, 2), random.uniform(0.5, 2), 1);
    for (const double e : {0.3, 0.7, 1.0, 1.4}) {
      SCOPED_TRACE(testing::Message() << "pair " << k << ", e = " << e);
      expect_known_answers(rod, Superellipsoid(axes, e, random.uniform(0.3, 1.4)), random);
      expect_known_answers(pear, Superellipsoid(axes, random.uniform(0.3, 1.4), e), random);
      if (testing::Test::HasFatalFailure()) return;
    }
    expect_known_answers(rod, Ellipsoid(axes), random);
    expect_known_answers(pear, random.spheroid(3), random);
    if (testing::Test::HasFatalFailure()) return;
  }
}

TEST(UserShape, SpherocylindersHaveTheDistanceOfTheirSegmentsLessTheRadii) {
  Random random(6);
  int beside = 0;
  for (int i = 0; i < 500; ++i) {
    const geom_test::Spherocylinder a{random.log_uniform(0.1, 5), random.log_uniform(0.1, 1)};
    const geom_test::Spherocylinder b{random.log_uniform(0.1, 5), random.log_uniform(0.1, 1)};
    const Pose X_WA = random.pose(1.0);
    const bool parallel = i % 5 == 0;
    const Vector3d r = random.uniform(0, 1.5) * (a.bounding_radius() + b.bounding_radius()) * random.direction();
    const Pose X_WB(parallel ? X_WA.rotation() : random.pose(0).rotation(), X_WA.position() + r);
    const Vector3d u = a.half_length * X_WA.rotation().col(2);
    const Vector3d v = b.half_length * X_WB.rotation().col(2);
    const double axes = segment_distance(-u, u, r - v, r + v);
    const double wanted = axes - a.radius - b.radius;
    // Where the axes meet, nearly, other ways out are shorter.
    if (axes < 1e-3) continue;
    const DistanceResult d = distance(a, X_WA, b, X_WB);
    ASSERT_EQ(d.status, wanted > 0 ? DistanceStatus::separated : DistanceStatus::overlapping) << i;
    const double size = a.bounding_radius() + b.bounding_radius() + r.norm();
    ASSERT_NEAR(d.distance, wanted, 2 * kWidestGap * size) << i;
    ASSERT_LE(std::abs(d.distance - wanted), d.error_bound + 1e-14 * size) << i;
    beside += std::abs(d.normal.dot(u)) < 1e-6 * u.norm();
  }
  EXPECT_GT(beside, 100) << "contacts of the cylinders' sides, where the support function has its kink";
}

geom_test::Superquadric any_superquadric(Random& random) {
  const Vector3d axes(1, random.uniform(0.5, 2), random.uniform(0.5, 2));
  return geom_test::Superquadric(axes, {random.uniform(1.3, 6), random.uniform(1.3, 6), random.uniform(1.3, 6)});
}

TEST(UserShape, SuperquadricsOfThreePowersHaveTheirDistance) {
  Random random(7);
  for (int i = 0; i < 300; ++i) {
    const auto a = any_superquadric(random);
    const auto b = any_superquadric(random);
    const double gap = random.log_uniform(1e-6, 1);
    const auto pair = geom_test::manufacture(a, b, gap, random);
    const DistanceResult d = distance(a, pair.X_WA, b, pair.X_WB);
    ASSERT_EQ(d.status, DistanceStatus::separated) << i;
    ASSERT_NEAR(d.distance, gap, distance_tolerance(pair.size)) << i;
    ASSERT_LE(d.error_bound, kBoundGap * pair.size) << i;
  }
}

/// The push is a way out, across which the answer may be no deeper; a shorter one is one only if it parts the bodies.
TEST(UserShape, OverlappingSuperquadricsHaveTheirDepth) {
  Random random(8);
  double widest = 0;
  for (int i = 0; i < 150; ++i) {
    const auto a = any_superquadric(random);
    const auto b = any_superquadric(random);
    const double depth = random.log_uniform(1e-8, 0.3);
    const auto pair = geom_test::manufacture(a, b, -depth, random);
    const DistanceResult d = distance(a, pair.X_WA, b, pair.X_WB);
    ASSERT_EQ(d.status, DistanceStatus::overlapping) << i;
    ASSERT_GE(d.distance, -depth - distance_tolerance(pair.size)) << i;
    ASSERT_LE(-depth, d.distance + d.error_bound + 1e-15 * pair.size) << i;
    ASSERT_NEAR(geom_test::lower_bound(a, pair.X_WA, b, pair.X_WB, d.normal), d.distance, 1e-15 * extent_of(pair)) << i;
    widest = std::max(widest, d.error_bound / pair.size);
  }
  EXPECT_LE(widest, kDepthGap);
}

/// Ellipsoids on the faces, edges and corners of boxes: the support points of a box jump there, and Newton's step may
/// lead to one far away.
TEST(UserShape, OnFacesAndCornersHasACertifiedDistance) {
  Random random(31);
  for (int k = 0; k < repetitions(5000); ++k) {
    const Box box({random.uniform(0.3, 1), random.uniform(0.3, 1), random.uniform(0.3, 1)});
    const WrappedEllipsoid body{Ellipsoid({random.uniform(0.4, 1), random.uniform(0.4, 1), random.uniform(0.4, 1)})};
    Eigen::Matrix3d R = random.coin() ? random.pose(0).rotation()
                                      : Eigen::AngleAxisd(random.uniform(0, 6), Vector3d::UnitZ()).toRotationMatrix();
    if (random.coin()) {
      R = Eigen::AngleAxisd(random.log_uniform(1e-8, 0.3), random.direction()).toRotationMatrix() * R;
    }
    const double gap = (random.coin() ? 1 : -1) * random.log_uniform(1e-12, 1e-3);
    const double share = random.coin() ? 1 : random.uniform();  // from the middle of the face to a corner
    const Vector3d half = box.half_extents();
    const Vector3d lowest = R * body.support(-R.transpose().col(2)).point;
    const Pose X_WA = random.pose(1);
    const Pose X_WB = X_WA * Pose(R, Vector3d(share * half.x(), share * half.y(), half.z() + gap) - lowest);
    const double size = (X_WB.position() - X_WA.position()).norm() + box.bounding_radius() + body.bounding_radius();
    for (const Penetration penetration : {Penetration::global, Penetration::local}) {
      const DistanceResult r = distance(box, X_WA, body, X_WB, {.penetration = penetration});
      ASSERT_NE(r.status, DistanceStatus::not_converged) << k;
      ASSERT_LE(r.error_bound, (r.distance > 0 ? kWidestGap : kWidestDepthGap) * size) << k << ", gap " << gap;
      ASSERT_NEAR(r.distance, gap, 1e-12 * size + r.error_bound) << k;
    }
  }
}

}  // namespace
}  // namespace geom
