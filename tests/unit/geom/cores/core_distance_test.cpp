/// distance() of spheres, capsules, boxes, polyhedra, cylinders, cones and rounded ones: known answers, apart and
/// overlapping.

#include "common/geom/core_pairs.h"
#include "common/geom/expect.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <cmath>
#include <variant>
#include <vector>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::answers;
using geom_test::distance_tolerance;
using geom_test::extent_of;
using geom_test::lower_bound;
using geom_test::manufacture_features;
using geom_test::ManufacturedPair;
using geom_test::Random;
using geom_test::random_polyhedron;
using geom_test::repetitions;

static_assert(CoreShape<Sphere> && CoreShape<Capsule> && CoreShape<Box> && CoreShape<ConvexPolyhedron>);
static_assert(CoreShape<Rounded<Box>> && !CoreShape<Rounded<Ellipsoid>> && SupportShape<Rounded<Ellipsoid>>);
static_assert(ImplicitSurface<Sphere> && ImplicitSurface<Capsule> && PointSet<Box> && PointSet<ConvexPolyhedron>);

static_assert(CoreShape<Cylinder> && CoreShape<Rounded<Cone>> && PointSet<Cylinder> && PointSet<Cone>);

using AnyCore = std::variant<Sphere, Capsule, Box, ConvexPolyhedron, Rounded<Box>, Rounded<ConvexPolyhedron>, Cylinder,
                             Cone, Rounded<Cylinder>, Rounded<Cone>>;
constexpr std::size_t kCoreKinds = std::variant_size_v<AnyCore>;
constexpr std::size_t kPolytopes = 6;  // of these kinds, the first

AnyCore random_core(std::size_t kind, Random& random) {
  const auto length = [&] { return random.log_uniform(0.1, 3); };
  switch (kind) {
    case 0:
      return Sphere(length());
    case 1:
      return Capsule(length(), random.log_uniform(1e-3, 1));
    case 2:
      return Box({length(), length(), length()});
    case 3:
      return random_polyhedron(random.coin() ? 8 : 30, random);
    case 4:
      return Rounded<Box>(Box({length(), length(), length()}), random.log_uniform(1e-3, 1));
    case 5:
      return Rounded<ConvexPolyhedron>(random_polyhedron(8, random), random.log_uniform(1e-3, 1));
    case 6:
      return Cylinder(length(), length());
    case 7:
      return Cone(length(), length());
    case 8:
      return Rounded<Cylinder>(Cylinder(length(), length()), random.log_uniform(1e-3, 1));
    default:
      return Rounded<Cone>(Cone(length(), length()), random.log_uniform(1e-3, 1));
  }
}

/// Checks the certificate of an answer: no normal and no points of the bodies contradict it.
template <class A, class B>
testing::AssertionResult certified(const A& a, const Pose& X_WA, const B& b, const Pose& X_WB, const DistanceResult& r,
                                   double size) {
  const double g = lower_bound(a, X_WA, b, X_WB, r.normal);
  if (!(std::abs(g - r.distance) <= 4e-15 * size)) {
    return testing::AssertionFailure() << "g(normal) " << g << ", distance " << r.distance;
  }
  if (!(r.error_bound >= 0 && r.error_bound <= 1e-13 * size)) {
    return testing::AssertionFailure() << "error bound " << r.error_bound << ", size " << size;
  }
  const ClosestPoint of_a = closest_point(a, X_WA, r.point_a);
  const ClosestPoint of_b = closest_point(b, X_WB, r.point_b);
  if (!(std::abs(of_a.distance) <= 1e-13 * size && std::abs(of_b.distance) <= 1e-13 * size)) {
    return testing::AssertionFailure() << "points off their surfaces by " << of_a.distance << ", " << of_b.distance;
  }
  return testing::AssertionSuccess();
}

TEST(CoreDistance, OfFeaturesApartIsKnown) {
  Random random(40);
  const int pairs = repetitions(300);
  for (std::size_t kind_a = 0; kind_a < kCoreKinds; ++kind_a) {
    for (std::size_t kind_b = 0; kind_b < kCoreKinds; ++kind_b) {
      for (int i = 0; i < pairs; ++i) {
        const AnyCore a = random_core(kind_a, random), b = random_core(kind_b, random);
        const double gap = random.log_uniform(1e-10, 10);
        std::visit(
            [&](const auto& s, const auto& t) {
              const ManufacturedPair pair = manufacture_features(s, i % 3, t, i / 3 % 3, gap, random);
              const DistanceResult r = distance(s, pair.X_WA, t, pair.X_WB);
              ASSERT_TRUE(answers(r, gap, distance_tolerance(pair.size), extent_of(pair)))
                  << kind_a << " " << kind_b << " pair " << i << " gap " << gap;
              ASSERT_TRUE(certified(s, pair.X_WA, t, pair.X_WB, r, extent_of(pair)))
                  << kind_a << " " << kind_b << " pair " << i << " gap " << gap;
            },
            a, b);
        if (HasFatalFailure()) return;
      }
    }
  }
}

/// Balls are swept over both bodies: overlaps as deep as their radii are known by construction.
TEST(CoreDistance, OfRoundedBodiesIsKnownDownToTheirRadii) {
  Random random(41);
  const int pairs = repetitions(300);
  for (const std::size_t kind_a : {0, 1, 4, 5, 8, 9}) {
    for (const std::size_t kind_b : {0, 1, 4, 5, 8, 9}) {
      for (int i = 0; i < pairs; ++i) {
        const AnyCore a = random_core(kind_a, random), b = random_core(kind_b, random);
        std::visit(
            [&](const auto& s, const auto& t) {
              const double gap = -(s.min_curvature_radius() + t.min_curvature_radius()) * random.uniform(0, 1);
              const ManufacturedPair pair = manufacture_features(s, i % 3, t, i / 3 % 3, gap, random);
              const DistanceResult r = distance(s, pair.X_WA, t, pair.X_WB);
              ASSERT_TRUE(answers(r, gap, distance_tolerance(pair.size), extent_of(pair)))
                  << kind_a << " " << kind_b << " pair " << i << " gap " << gap;
              ASSERT_TRUE(certified(s, pair.X_WA, t, pair.X_WB, r, extent_of(pair)))
                  << kind_a << " " << kind_b << " pair " << i << " gap " << gap;
            },
            a, b);
        if (HasFatalFailure()) return;
      }
    }
  }
}

std::vector<Vector3d> world_vertices(const kernel::CoreView& core, const Pose& X) {
  std::vector<Vector3d> all;
  if (core.kind == kernel::CoreKind::hull) {
    for (Eigen::Index k = 0; k < core.hull->vertices.rows(); ++k) {
      all.push_back(X.to_world(core.hull->vertices.row(k).transpose()));
    }
    return all;
  }
  for (int corner = 0; corner < 8; ++corner) {
    all.push_back(X.to_world({(corner & 1 ? 1 : -1) * core.half.x(), (corner & 2 ? 1 : -1) * core.half.y(),
                              (corner & 4 ? 1 : -1) * core.half.z()}));
  }
  return all;
}

/// The depth of two polytopes is the distance of the origin from the nearest face of the hull of all differences of
/// vertices, and that of rounded ones is larger by the radii.
TEST(CoreDistance, OfOverlappingPolytopesIsTheNearestFaceOfTheirDifference) {
  Random random(42);
  const int pairs = repetitions(40);
  int deep = 0;
  for (std::size_t kind_a = 0; kind_a < kPolytopes; ++kind_a) {
    for (std::size_t kind_b = 2; kind_b < kPolytopes; ++kind_b) {
      for (int i = 0; i < pairs; ++i) {
        const AnyCore a = random_core(kind_a, random), b = random_core(kind_b, random);
        std::visit(
            [&](const auto& s, const auto& t) {
              const kernel::CoreView core_a = s.core(), core_b = t.core();
              const Pose X_WA = random.pose(1.0);
              const Pose X_WB = random.pose(
                  Vector3d(X_WA.position() + random.uniform(0, 0.6) * core_b.bounding_radius * random.direction()));
              std::vector<Vector3d> difference;
              for (const Vector3d& p : world_vertices(core_a, X_WA)) {
                for (const Vector3d& q : world_vertices(core_b, X_WB)) difference.push_back(q - p);
              }
              double depth = 0;
              try {
                depth = ConvexPolyhedron(difference).inscribed_radius() + core_a.radius + core_b.radius;
              } catch (const std::invalid_argument&) {
                return;  // the cores are apart
              }
              ++deep;
              const DistanceResult r = distance(s, X_WA, t, X_WB);
              const double size =
                  (X_WB.position() - X_WA.position()).norm() + s.bounding_radius() + t.bounding_radius();
              ASSERT_TRUE(answers(r, -depth, distance_tolerance(size), 4 * size))
                  << kind_a << " " << kind_b << " pair " << i << " depth " << depth;
              ASSERT_TRUE(certified(s, X_WA, t, X_WB, r, 4 * size))
                  << kind_a << " " << kind_b << " pair " << i << " depth " << depth;
            },
            a, b);
        if (HasFatalFailure()) return;
      }
    }
  }
  EXPECT_GT(deep, pairs * 10);
}

/// Concentric and exactly aligned bodies, for which every decision is a tie.
TEST(CoreDistance, OfAlignedBodiesIsTheirFacesGap) {
  const Box box({1, 2, 3});
  EXPECT_EQ(distance(box, Pose(), box, Pose()).distance, -2);
  EXPECT_EQ(distance(box, Pose(), box, Pose::translation({2, 0, 0})).distance, 0);
  EXPECT_EQ(distance(box, Pose(), box, Pose::translation({2, 4, 6})).distance, 0);
  EXPECT_EQ(distance(box, Pose(), box, Pose::translation({3, 0.5, 5})).distance, 1);
  EXPECT_EQ(distance(box, Pose(), box, Pose::translation({3, 0.5, 8})).distance, std::sqrt(5));
  const Capsule capsule(2, 0.5);
  EXPECT_EQ(distance(capsule, Pose(), capsule, Pose()).distance, -1);
  EXPECT_EQ(distance(capsule, Pose(), capsule, Pose::translation({0, 0, 1})).distance, -1);
  EXPECT_EQ(distance(capsule, Pose(), capsule, Pose::translation({0, 0, 5})).distance, 0);
  EXPECT_EQ(distance(capsule, Pose(), capsule, Pose::translation({0, 2, 1})).distance, 1);
  EXPECT_EQ(distance(Sphere(1), Pose(), Sphere(2), Pose()).distance, -3);
  EXPECT_EQ(distance(Sphere(1), Pose(), box, Pose()).distance, -2);
  EXPECT_EQ(distance(box, Pose(), capsule, Pose()).distance, -1.5);
  const Rounded<Box> rounded(box, 0.25);
  EXPECT_EQ(distance(rounded, Pose(), rounded, Pose::translation({3, 0, 0})).distance, 0.5);
}

TEST(CoreDistance, OfCrossingCapsulesIsMinusBothRadii) {
  Random random(43);
  for (int i = 0; i < repetitions(2000); ++i) {
    const Capsule a(random.log_uniform(0.1, 10), random.log_uniform(0.01, 1));
    const Capsule b(random.log_uniform(0.1, 10), random.log_uniform(0.01, 1));
    const Pose X_WA = random.pose(1.0);
    const Pose turned = random.pose(1.0);
    const double s = random.uniform(-1, 1) * a.half_length(), t = random.uniform(-1, 1) * b.half_length();
    const Pose X_WB(turned.rotation(), X_WA.position() + s * X_WA.rotation().col(2) - t * turned.rotation().col(2));
    const DistanceResult r = distance(a, X_WA, b, X_WB);
    const double size = (X_WB.position() - X_WA.position()).norm() + a.bounding_radius() + b.bounding_radius();
    ASSERT_TRUE(answers(r, -a.radius() - b.radius(), distance_tolerance(size), 2 * size)) << i;
    ASSERT_TRUE(certified(a, X_WA, b, X_WB, r, 2 * size)) << i;
  }
}

/// Capsules that are turned from being parallel by angles down to rounding.
TEST(CoreDistance, OfNearlyParallelCapsulesIsCertified) {
  Random random(44);
  for (int i = 0; i < repetitions(20000); ++i) {
    const double half_length = random.log_uniform(0.1, 10);
    const Capsule a(half_length, half_length * random.log_uniform(3e-4, 1));
    const Capsule b(half_length * (random.coin() ? 1.0 : random.log_uniform(0.1, 2)), a.radius());
    const Pose X_WA = random.pose(1.0);
    const double angle = random.log_uniform(1e-17, 1e-1);
    const Eigen::Matrix3d R = Eigen::AngleAxisd(angle, random.direction()) * X_WA.rotation();
    const Vector3d across = R.col(2).cross(random.direction()).normalized();
    const double apart = (a.radius() + b.radius()) * random.log_uniform(0.5, 10);
    const Pose X_WB(R, X_WA.position() + apart * across + random.uniform(-2, 2) * half_length * R.col(2));
    const DistanceResult r = distance(a, X_WA, b, X_WB);
    const double size = (X_WB.position() - X_WA.position()).norm() + a.bounding_radius() + b.bounding_radius();
    ASSERT_TRUE(certified(a, X_WA, b, X_WB, r, 2 * size)) << i << " angle " << angle;
  }
}

TEST(CoreDistance, IsTheSameFromBothSidesAndFromAnyStart) {
  Random random(45);
  for (int i = 0; i < repetitions(3000); ++i) {
    const AnyCore a = random_core(static_cast<std::size_t>(i) % kCoreKinds, random);
    const AnyCore b = random_core(static_cast<std::size_t>(i) / kCoreKinds % kCoreKinds, random);
    std::visit(
        [&](const auto& s, const auto& t) {
          const ManufacturedPair pair = manufacture_features(s, 0, t, 0, random.log_uniform(1e-6, 1), random);
          const DistanceResult r = distance(s, pair.X_WA, t, pair.X_WB);
          const DistanceResult back = distance(t, pair.X_WB, s, pair.X_WA);
          const DistanceResult warm = distance(s, pair.X_WA, t, pair.X_WB, {.start = random.direction()});
          const DistanceResult known = distance(s, pair.X_WA, t, pair.X_WB, {.start = r.normal});
          const double rounding = 1e-14 * extent_of(pair);
          EXPECT_NEAR(back.distance, r.distance, rounding);
          EXPECT_NEAR(warm.distance, r.distance, rounding);
          EXPECT_NEAR(known.distance, r.distance, rounding);
          EXPECT_LE(known.iterations, std::max(2, r.iterations));  // a warm start is never slower
        },
        a, b);
  }
}

/// Mixed with smooth bodies: the general path, whose contract is wider.
TEST(CoreDistance, OfRoundedSmoothBodiesAndSpheresIsKnown) {
  Random random(46);
  for (int i = 0; i < repetitions(1000); ++i) {
    const double gap = random.log_uniform(1e-8, 10);
    const Ellipsoid e = random.biaxial(5);
    const Superellipsoid q({1, 2, 1.5}, random.uniform(0.3, 1), random.uniform(0.3, 1));
    const Sphere ball(random.log_uniform(0.1, 3));
    const auto check = [&](const auto& s, const auto& t, double tolerance) {
      const ManufacturedPair pair = geom_test::manufacture(s, t, gap, random);
      ASSERT_TRUE(answers(distance(s, pair.X_WA, t, pair.X_WB), gap, tolerance * pair.size, extent_of(pair))) << i;
    };
    check(ball, e, 1e-13);
    check(q, ball, 1e-12);
    check(Rounded<Ellipsoid>(e, 0.3), ball, 1e-13);
    check(Rounded<Ellipsoid>(e, 0.3), Rounded<Superellipsoid>(q, 0.1), 1e-12);
    check(q, Rounded<Ellipsoid>(e, 0.3), 1e-12);
  }
}

}  // namespace
}  // namespace geom
