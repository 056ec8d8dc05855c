/// Input at the limits of libgeom and beyond: what is refused, by which message; what is declined; and that all the
/// rest is answered right, in any unit of length and at any distance.

#include "common/geom/expect.h"
#include "common/geom/manufactured.h"
#include "common/message_of.h"
#include "common/special_values.h"

#include <geom/geom.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace geom {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::answers;
using geom_test::Random;
using test_common::message_of;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kBadLengths[] = {0.0, -0.0, -1.0, kNaN, kInfinity, -kInfinity, 1e-51, 1e51};

/// The contract of distance.h, relative to the size of the pair.
template <class A, class B>
constexpr double kTolerance = 1e-12;
template <>
constexpr double kTolerance<Ellipsoid, Ellipsoid> = 1e-13;

/// Calls f(a, b) with pairs of the shapes that differ in the path they take, semi-axes of about `unit`.
template <class F>
void for_each_pair(double unit, const F& f) {
  const Ellipsoid spheroid(unit * Vector3d(1, 1, 3));
  const Ellipsoid ellipsoid(unit * Vector3d(1, 2, 3));
  const Superellipsoid brick(unit * Vector3d(1, 2, 3), 0.4, 0.5);
  const Superellipsoid spindle(unit * Vector3d(1, 2, 3), 1.4, 0.3);
  f(spheroid, spheroid);
  f(spheroid, ellipsoid);
  f(brick, spindle);
  f(ellipsoid, spindle);
  f(brick, spheroid);
}

// ---------------------------------------------------------------------------------------------------------------------
// Refused at the boundary

TEST(BadInput, SemiAxesOfSuperellipsoidsAreRefusedByName) {
  for (const double bad : kBadLengths) {
    for (int axis = 0; axis < 3; ++axis) {
      Vector3d semi_axes(1, 1, 1);
      semi_axes[axis] = bad;
      ASSERT_THAT(
          message_of([&] { return Superellipsoid(semi_axes, 1, 1); }),
          AllOf(HasSubstr(std::string("semi-axis ") + "xyz"[axis] + " is "), HasSubstr("accepted: 1e-50 to 1e+50")))
          << bad << " as axis " << axis;
    }
  }
  EXPECT_EQ(message_of([] { return Superellipsoid({1, 1e4, 1}, 1, 1); }), "no std::invalid_argument");
  EXPECT_THAT(message_of([] {
                return Superellipsoid({1, 1.5e4, 1}, 1, 1);
              }),
              AllOf(HasSubstr("ratio"), HasSubstr("15000"), HasSubstr("1 to 10000")));
}

TEST(BadInput, ExponentsAreRefusedByNameWithTheRange) {
  for (const double bad : {0.0, -0.0, -1.0, kNaN, kInfinity, -kInfinity, std::nextafter(0.2, 0.0), 1e-300,
                           std::nextafter(1.6, 2.0), 2.0, 1e300}) {
    const auto message_names = [](const char* which) {
      return AllOf(HasSubstr(std::string("exponent ") + which + " is "), HasSubstr("accepted: 0.2 to 1.6"));
    };
    ASSERT_THAT(message_of([&] { return Superellipsoid({1, 1, 1}, bad, 1); }), message_names("e1")) << bad;
    ASSERT_THAT(message_of([&] { return Superellipsoid({1, 1, 1}, 1, bad); }), message_names("e2")) << bad;
  }
  for (const double e : {0.2, 1.6}) {
    EXPECT_EQ(message_of([&] { return Superellipsoid({1, 1, 1}, e, e); }), "no std::invalid_argument") << e;
  }
}

TEST(BadInput, PositionsBeyondTheLimitAreRefusedWithIt) {
  const double beyond = std::nextafter(kMaxCoordinate, kInfinity);
  for (const double bad : {beyond, -beyond, 1e155, -1e300, 1.7e308, kNaN, kInfinity}) {
    for (int axis = 0; axis < 3; ++axis) {
      Vector3d position(1, 2, 3);
      position[axis] = bad;
      const auto wanted = AllOf(HasSubstr("position is "), HasSubstr("none beyond +-1e100"));
      ASSERT_THAT(message_of([&] { return Pose(Matrix3d::Identity(), position); }), wanted) << bad;
      ASSERT_THAT(message_of([&] { return Pose::translation(position); }), wanted) << bad;
      ASSERT_THAT(message_of([&] { return Pose::from_quaternion(1, 0, 0, 0, position); }), wanted) << bad;
    }
  }
  EXPECT_EQ(message_of([] {
              return Pose::translation({kMaxCoordinate, -kMaxCoordinate, 5e-324});
            }),
            "no std::invalid_argument");
}

TEST(BadInput, RotationsThatOverflowAreRefused) {
  const auto wanted = HasSubstr("not orthonormal");
  for (const double bad : {1e160, -1e200, 1e308}) {
    EXPECT_THAT(message_of([&] { return Pose(bad * Matrix3d::Identity(), Vector3d::Zero()); }), wanted) << bad;
    Matrix3d R = Matrix3d::Identity();
    R(0, 2) = bad;
    EXPECT_THAT(message_of([&] { return Pose(R, Vector3d::Zero()); }), wanted) << bad;
    EXPECT_THAT(message_of([&] { return Pose::from_quaternion(bad, bad, 0, 0); }), HasSubstr("not of length 1")) << bad;
  }
  EXPECT_THAT(message_of([] { return Pose(1e-200 * Matrix3d::Identity(), Vector3d::Zero()); }), wanted);
}

// ---------------------------------------------------------------------------------------------------------------------
// Declined by the queries, which do not throw

TEST(BadInput, PointsThatAreNotFiniteOrTooFarAreDeclined) {
  const auto ask = [](const auto& shape) {
    for (const double bad : {kNaN, kInfinity, -kInfinity, 1.01e100, -1e155, 1e200, 1.7e308}) {
      for (const Vector3d& p : {Vector3d(bad, 0, 0), Vector3d(0, bad, 1), Vector3d(1, bad, -bad)}) {
        const ClosestPoint closest = closest_point(shape, Pose(), p);
        ASSERT_EQ(closest.status, DistanceStatus::not_converged) << p.transpose();
        ASSERT_TRUE(std::isnan(closest.distance) && geom_test::all_nan(closest.point)) << p.transpose();
        ASSERT_FALSE(contains(shape, Pose(), p)) << p.transpose();
        const RayHit hit = ray_cast(shape, Pose(), p, -p);
        ASSERT_EQ(hit.status, RayStatus::not_converged) << p.transpose();
        ASSERT_TRUE(std::isnan(hit.t) && geom_test::all_nan(hit.normal)) << p.transpose();
      }
    }
    for (const double bad : {kNaN, kInfinity, -kInfinity}) {
      EXPECT_EQ(ray_cast(shape, Pose(), {9, 0, 0}, {-1, bad, 0}).status, RayStatus::not_converged) << bad;
    }
    EXPECT_EQ(ray_cast(shape, Pose(), {9, 0, 0}, {0, 0, 0}).status, RayStatus::not_converged);
  };
  ask(Ellipsoid({1, 1, 3}));
  ask(Superellipsoid({1, 2, 3}, 0.5, 0.7));
  ask(Shape(Superellipsoid({1, 2, 3}, 1.5, 0.7)));
}

TEST(BadInput, DirectionsMayHaveAnyLength) {
  const Ellipsoid needle({1, 1, 3});
  const Superellipsoid brick({1, 2, 3}, 0.5, 0.7);
  const Pose X_WB = Pose::translation({2.5, 1, 0});
  const Vector3d n(1, 0.25, -0.5);
  const auto ask = [&](const auto& a, const auto& b) {
    const double apart = distance_lower_bound(a, Pose(), b, Pose::translation({9, 2, 0}), n);
    const double deep = distance_lower_bound(a, Pose(), b, X_WB, n);
    const RayHit hit = ray_cast(a, Pose(), {9, 0.3, -0.2}, -Vector3d::UnitX());
    ASSERT_GT(apart, 1);
    ASSERT_LT(deep, -0.1);
    ASSERT_EQ(hit.status, RayStatus::hit);
    for (const double length : {1e-320, 1e-300, 1e-200, 1e-150, 1e-5, 1e5, 1e150, 1e200, 1e307}) {
      // Subnormal numbers have few digits; 1e-320 has eleven bits.
      const double tolerance = length < 1e-310 ? 1e-2 : 1e-14;
      EXPECT_NEAR(distance_lower_bound(a, Pose(), b, Pose::translation({9, 2, 0}), length * n), apart, 9 * tolerance);
      EXPECT_NEAR(distance_lower_bound(a, Pose(), b, X_WB, length * n), deep, 9 * tolerance);
      EXPECT_EQ(overlap(a, Pose(), b, X_WB, length * n), overlap(a, Pose(), b, X_WB)) << length;
      const RayHit same = ray_cast(a, Pose(), {9, 0.3, -0.2}, -length * Vector3d::UnitX());
      if (hit.t / length > std::numeric_limits<double>::max()) {
        EXPECT_EQ(same.status, RayStatus::not_converged) << length;
        continue;
      }
      ASSERT_EQ(same.status, RayStatus::hit) << length;
      EXPECT_NEAR(same.t * length, hit.t, 9 * tolerance) << length;
      EXPECT_LE((same.point - hit.point).norm(), 1e-13) << length;
    }
    for (const Vector3d& none : {Vector3d(0, 0, 0), Vector3d(kNaN, 0, 1), Vector3d(kInfinity, 1, 0)}) {
      EXPECT_TRUE(std::isnan(distance_lower_bound(a, Pose(), b, X_WB, none)));
      EXPECT_EQ(overlap(a, Pose(), b, X_WB, none), overlap(a, Pose(), b, X_WB));
    }
  };
  ask(needle, needle);
  ask(brick, needle);
  ask(brick, brick);
}

TEST(BadInput, ARayFromTheCentreStartsInsideWithANormal) {
  const auto ask = [](const auto& shape) {
    const RayHit hit = ray_cast(shape, Pose(), {0, 0, 0}, {0, 0, 2});
    EXPECT_EQ(hit.status, RayStatus::inside);
    EXPECT_EQ(hit.t, 0);
    EXPECT_NEAR(hit.normal.norm(), 1, 1e-15);
  };
  ask(Ellipsoid({1, 1, 3}));
  ask(Superellipsoid({1, 2, 3}, 0.5, 0.7));
}

// ---------------------------------------------------------------------------------------------------------------------
// Answered

/// The distance, and what the other queries say, of a pair made to have that distance.
template <class A, class B>
void expect_right(const A& a, const B& b, double gap, Random& random) {
  const auto pair = geom_test::manufacture(a, b, gap, random);
  const double tolerance = kTolerance<A, B> * pair.size;
  const double extent = pair.X_WA.position().norm() + 2 * pair.size;
  const DistanceResult r = distance(a, pair.X_WA, b, pair.X_WB);
  ASSERT_TRUE(answers(r, gap, tolerance, extent));
  ASSERT_GE(r.error_bound, 0);
  ASSERT_LE(r.error_bound, kWidestGap * pair.size);
  if (std::abs(gap) > tolerance) {
    ASSERT_EQ(overlap(a, pair.X_WA, b, pair.X_WB), gap > 0 ? Answer::no : Answer::yes);
  }
  if (gap < 0) return;
  // From A's closest point it is as far to B, and a ray along the normal gets there.
  const ClosestPoint closest = closest_point(b, pair.X_WB, r.point_a);
  ASSERT_NEAR(closest.distance, gap, tolerance);
  // g(n) <= gap cos(angle between n and the true normal), so that an error of g allows for that angle.
  ASSERT_LE((closest.normal + r.normal).norm(), 2 * std::sqrt(2 * tolerance / gap));
  const RayHit hit = ray_cast(b, pair.X_WB, r.point_a, r.normal);
  ASSERT_EQ(hit.status, RayStatus::hit);
  // Where a surface bends within a share of the size, a ray that is off by rounding meets it that much farther on.
  ASSERT_NEAR(hit.t, gap, 1e-10 * pair.size);
  ASSERT_FALSE(contains(b, pair.X_WB, r.point_a));
  ASSERT_TRUE(contains(b, pair.X_WB, hit.point - 1e-3 * b.inscribed_radius() * hit.normal));
}

TEST(ExtremeInput, TinyAndHugeBodiesHaveTheirDistance) {
  Random random(1);
  for (const double unit : {1e-49, 1e-40, 1e-25, 1e-12, 1e-6, 1e6, 1e12, 1e25, 1e40, 3e49}) {
    for_each_pair(unit / 3, [&](const auto& a, const auto& b) {
      for (int k = 0; k < geom_test::repetitions(40); ++k) {
        expect_right(a, b, unit * random.log_uniform(1e-8, 10), random);
        if (testing::Test::HasFatalFailure()) FAIL() << "unit " << unit << ", pair " << k;
      }
    });
  }
}

TEST(ExtremeInput, TinyBodiesBesideHugeOnesHaveTheirDistance) {
  Random random(2);
  for (const double unit : {1e-12, 1.0, 1e12}) {
    for (const double ratio : {1e2, 1e4, 1e6}) {
      const Ellipsoid large(unit * Vector3d(1, 2, 3));
      const Superellipsoid large_brick(unit * Vector3d(1, 2, 3), 0.4, 1.2);
      for_each_pair(unit / ratio, [&](const auto& small, const auto& other) {
        for (int k = 0; k < geom_test::repetitions(20); ++k) {
          const double gap = unit / ratio * random.log_uniform(1e-2, 100);
          const bool swap = random.coin();
          swap ? expect_right(small, large, gap, random) : expect_right(large, small, gap, random);
          swap ? expect_right(large_brick, other, gap, random) : expect_right(other, large_brick, gap, random);
          if (testing::Test::HasFatalFailure()) FAIL() << "unit " << unit << ", ratio " << ratio << ", pair " << k;
        }
      });
    }
  }
}

TEST(ExtremeInput, OverlapsOfTinyAndHugeBodiesHaveTheirDepth) {
  Random random(3);
  for (const double unit : {1e-49, 1e-12, 1e12, 3e49}) {
    for_each_pair(unit / 3, [&](const auto& a, const auto& b) {
      for (int k = 0; k < geom_test::repetitions(20); ++k) {
        const double gap = -unit * random.log_uniform(1e-8, 1e-5);
        const auto pair = geom_test::manufacture(a, b, gap, random);
        const DistanceResult r = distance(a, pair.X_WA, b, pair.X_WB);
        // Pushed back along the normal the bodies part: none of the translations that do so is longer than needed.
        ASSERT_TRUE(answers(r, gap, 1e-12 * pair.size, pair.X_WA.position().norm() + 2 * pair.size))
            << "unit " << unit << ", pair " << k;
        ASSERT_LE(r.error_bound, kWidestDepthGap * pair.size);
        ASSERT_EQ(overlap(a, pair.X_WA, b, pair.X_WB), Answer::yes);
      }
    });
  }
}

TEST(ExtremeInput, ClosestPointsOfTinyBodiesAreExactInside) {
  // The depth of the centre is the smallest semi-axis, whatever the unit.
  for (const double unit : {1e-50, 1e-45, 1e-30, 1e-12, 1e12, 1e49}) {
    const Pose X = Pose::translation(unit * Vector3d(1, -2, 3));
    const auto depth = [&](const auto& shape) { return closest_point(shape, X, X.position()).distance; };
    EXPECT_NEAR(depth(Ellipsoid(unit * Vector3d(1, 2, 3))), -unit, 1e-14 * unit) << unit;
    EXPECT_NEAR(depth(Superellipsoid(unit * Vector3d(1, 2, 3), 0.5, 0.5)), -unit, 1e-14 * unit) << unit;
    EXPECT_NEAR(depth(Superellipsoid(unit * Vector3d(1, 2, 3), 0.2, 0.9)), -unit, 1e-14 * unit) << unit;
  }
}

TEST(ExtremeInput, BodiesAnyDistanceApartHaveTheirDistance) {
  const Vector3d across = Vector3d(1, 0.3, -0.2).normalized();
  for (const double unit : {1e-50, 1e-12, 1.0, 1e12, 1e49}) {
    for_each_pair(unit, [&](const auto& a, const auto& b) {
      for (const double far : {1e2 * unit, 1e60, 1e80, kMaxCoordinate}) {
        if (far < 100 * unit) continue;
        for (const Vector3d& direction : {across, Vector3d(-Vector3d::UnitX()), Vector3d(1, 1, -1)}) {
          const Vector3d p = far * direction;
          const Pose X_WA = Pose::translation(-p);
          const Pose X_WB = Pose::translation(p);
          const double centres = 2 * p.norm();
          const DistanceResult r = distance(a, X_WA, b, X_WB);
          // The tangent planes across the line of centres and the bounding spheres enclose the distance.
          const double least = distance_lower_bound(a, X_WA, b, X_WB, p);
          ASSERT_TRUE(answers(r, 0.5 * (least + centres), 0.5 * (centres - least) + 1e-14 * centres, centres))
              << unit << ' ' << far;
          ASSERT_EQ(r.status, DistanceStatus::separated);
          ASSERT_EQ(overlap(a, X_WA, b, X_WB), Answer::no);
          ASSERT_NEAR(closest_point(a, X_WA, p).distance, centres, a.bounding_radius() + 1e-14 * centres);
          const RayHit hit = ray_cast(a, X_WA, p, -p);
          // A ray cannot be aimed at what is smaller than the rounding of its way; it hits, misses or is declined.
          if (unit > 1e-14 * far) {
            ASSERT_EQ(hit.status, RayStatus::hit);
            ASSERT_NEAR(hit.t, 2, 0.05);
          } else {
            ASSERT_NE(hit.status, RayStatus::inside);
          }
        }
      }
    });
  }
}

TEST(ExtremeInput, BatchesAnswerBodiesAtTheLimits) {
  const Ellipsoid tiny(1e-50 * Vector3d(1, 1, 1e4));
  const Ellipsoid huge(1e50 * Vector3d(1, 1e-4, 0.5));
  const Ellipsoid usual({1, 2, 3});
  const Ellipsoid shapes[] = {tiny, huge, usual};
  for (const double far : {3e50, 1e75, kMaxCoordinate}) {
    for (const Ellipsoid& a : shapes) {
      const Ellipsoid b[] = {tiny, huge, usual, tiny, huge, usual, tiny, huge};
      const Pose X_WA = Pose::translation({-far, far, 0});
      const Pose X_WB = Pose::translation({far, far, -far});
      DistanceResult results[8];
      (void)distance_batch({&a, 1}, {&X_WA, 1}, b, {&X_WB, 1}, results);
      for (std::size_t k = 0; k < 8; ++k) {
        const DistanceResult r = distance(a, X_WA, b[k], X_WB);
        ASSERT_EQ(r.status, DistanceStatus::separated) << far << ' ' << k;
        ASSERT_EQ(results[k].status, r.status) << far << ' ' << k;
        ASSERT_NEAR(results[k].distance, r.distance, 1e-13 * far) << far << ' ' << k;
      }
    }
  }
}

TEST(ExtremeInput, ComponentsThatUnderflowChangeNothing) {
  // Squares and products of the smallest components of poses vanish, but not always the components.
  const std::vector<Vector3d> corners = {{1, 0, 0}, {-1, 0, 0}, {0, 2, 0}, {0, -2, 0}, {0, 0, 3}, {0, 0, -3}};
  const std::vector<Shape> shapes = {Ellipsoid({1, 2, 3}),
                                     Ellipsoid({1, 1, 3}),
                                     Superellipsoid({1, 2, 3}, 0.4, 0.5),
                                     Sphere(1),
                                     Capsule(1, 0.5),
                                     Box({1, 2, 3}),
                                     ConvexPolyhedron(corners),
                                     Cylinder(1, 3),
                                     Cone(2, 1)};
  Matrix3d R_WB;
  R_WB << 0, -1, 0, 0, 0, 1, -1, 0, 0;
  const auto at = [](double dust) {
    Matrix3d R_WA;
    R_WA << dust, -dust, -1, -1, 0, -dust, -0.0, 1, -dust;
    return Pose(R_WA, {0, -dust, dust});
  };
  for (const Shape& a : shapes) {
    for (const Shape& b : shapes) {
      for (const double dust : {3e-318, 3e-309, 1e-300, 1e-160}) {
        // Nearly on a common axis.
        const DistanceResult found = distance(a, Pose(), b, Pose::translation({dust, -2 * dust, 9}));
        ASSERT_EQ(found.status, DistanceStatus::separated);
        EXPECT_NEAR(found.distance, distance(a, Pose(), b, Pose::translation({0, 0, 9})).distance, 1e-12);
        EXPECT_NEAR((found.point_b - found.point_a - found.distance * found.normal).norm(), 0, 1e-12);
      }
      for (const double way : {2.875, 9.0}) {
        const Pose X_WB(R_WB, {0, -way, 0});
        const DistanceResult wanted = distance(a, at(0), b, X_WB);
        ASSERT_TRUE(wanted.status == DistanceStatus::separated || wanted.status == DistanceStatus::overlapping);
        for (const double dust : {3e-309, 1e-300, 1e-200, 1e-160}) {
          const DistanceResult found = distance(a, at(dust), b, X_WB);
          EXPECT_EQ(found.status, wanted.status) << dust << ' ' << a.index() << ' ' << b.index();
          const double error = found.error_bound + wanted.error_bound + 1e-12;
          EXPECT_NEAR(found.distance, wanted.distance, error) << dust << ' ' << a.index() << ' ' << b.index();
          EXPECT_NEAR(found.normal.norm(), 1, 1e-12);
        }
      }
    }
  }
}

}  // namespace
}  // namespace geom
