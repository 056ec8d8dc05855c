/// Shapes that are chosen at run time: every function of any_shape.h and queries.h gives what the shapes inside give.

#include "common/geom/core_pairs.h"
#include "common/message_of.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <array>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::Random;
using geom_test::repetitions;
using test_common::message_of;

/// Returns a shape of each kind.
std::vector<Shape> one_of_each_kind(Random& random) {
  const ConvexPolyhedron hull = geom_test::random_polyhedron(12, random);
  const Box box({1, 2, 0.5});
  return {Ellipsoid({1, 2, 3}),
          Superellipsoid({1, 2, 3}, 0.5, 0.7),
          Sphere(0.7),
          Capsule(2, 0.5),
          box,
          hull,
          Rounded<Box>(box, 0.3),
          Rounded<ConvexPolyhedron>(hull, 0.3),
          Cylinder(2, 0.5),
          Cone(2, 0.8),
          Rounded<Cylinder>(Cylinder(1, 0.5), 0.3),
          Rounded<Cone>(Cone(2, 0.8), 0.3)};
}

/// Two answers of `distance` for one pair, from functions that may take its bodies in another order.
void expect_same(const DistanceResult& a, const DistanceResult& b, double size) {
  ASSERT_EQ(a.status, b.status);
  ASSERT_NEAR(a.distance, b.distance, 1e-12 * size + a.error_bound + b.error_bound);
  ASSERT_LE((a.point_a + a.distance * a.normal - a.point_b).norm(), 1e-14 * size);
}

/// Sphere of the same extents as the shape's bounding sphere.
double reach(const Shape& shape) {
  return bounding_radius(shape);
}

/// Returns whether the shape is a cylinder or cone. The depth of its overlaps is declined now and then.
bool has_rims(const Shape& shape) {
  return shape.index() >= 8;
}

TEST(AnyShape, ListsEveryKindOnce) {
  Random random(1);
  EXPECT_EQ(one_of_each_kind(random).size(), std::variant_size_v<Shape>);
}

TEST(AnyShape, DistancesAreThoseOfTheShapesInside) {
  Random random(2);
  const std::vector<Shape> shapes = one_of_each_kind(random);
  int pairs = 0, declined = 0;
  for (const Shape& a : shapes) {
    for (const Shape& b : shapes) {
      for (int i = 0; i < repetitions(30); ++i) {
        ++pairs;
        const Pose X_WA = random.pose(2.0);
        const Pose X_WB = random.pose(i % 3 == 0 ? 1.0 : 5.0);
        const DistanceResult r = distance(a, X_WA, b, X_WB);
        if (r.status == DistanceStatus::not_converged) {
          EXPECT_TRUE(has_rims(a) || has_rims(b)) << description(a) << ", " << description(b);
          ++declined;
          continue;
        }
        const auto direct = [&](const auto& s, const auto& t) { return distance(s, X_WA, t, X_WB); };
        const DistanceResult d = std::visit(direct, a, b);
        const double size = reach(a) + reach(b) + (X_WB.position() - X_WA.position()).norm();
        expect_same(r, d, size);
        const double lower = distance_lower_bound(a, X_WA, b, X_WB, r.normal);
        ASSERT_LE(lower, r.distance + r.error_bound + 1e-14 * size);
        ASSERT_GE(lower, r.distance - 1e-10 * size);
        const Answer answer = overlap(a, X_WA, b, X_WB);
        ASSERT_EQ(answer, r.distance > 0 ? Answer::no : Answer::yes) << description(a) << ", " << description(b);
        DistanceResult reversed = distance(b, X_WB, a, X_WA);
        ASSERT_NEAR(reversed.distance, r.distance, 1e-12 * size + r.error_bound + reversed.error_bound);
      }
    }
  }
  EXPECT_LE(declined * 1000, pairs);
}

TEST(AnyShape, QueriesOfOneBodyAreThoseOfTheShapeInside) {
  Random random(3);
  for (const Shape& shape : one_of_each_kind(random)) {
    for (int i = 0; i < repetitions(100); ++i) {
      const Pose X = random.pose(2.0);
      const Vector3d p = X.position() + random.uniform(0, 3) * random.direction();
      const Vector3d n = random.direction();
      std::visit(
          [&](const auto& s) {
            ASSERT_EQ(support(shape, n).height, s.support(n).height);
            ASSERT_EQ(bounding_radius(shape), s.bounding_radius());
            ASSERT_EQ(inscribed_radius(shape), s.inscribed_radius());
            ASSERT_EQ(volume(shape), s.volume());
            ASSERT_EQ(inertia(shape, 2), s.inertia(2));
            ASSERT_EQ(description(shape), s.description());
            ASSERT_EQ(contains(shape, X, p), contains(s, X, p));
            ASSERT_NEAR(closest_point(shape, X, p).distance, closest_point(s, X, p).distance, 1e-9);
            ASSERT_EQ(oriented_box(shape, X).half_extents, oriented_box(s, X).half_extents);
            const RayHit hit = ray_cast(shape, X, p, n);
            const RayHit same = ray_cast(s, X, p, n);
            ASSERT_EQ(hit.status, same.status);
            if (hit.status == RayStatus::hit) {
              ASSERT_NEAR(hit.t, same.t, 1e-9);
            }
            ASSERT_EQ(ray_exit(shape, X, p, n).status, ray_exit(s, X, p, n).status);
          },
          shape);
    }
  }
}

/// Mixed kinds in one batch; each pair has the bits of `distance`.
TEST(AnyShape, BatchesTakeAllKinds) {
  Random random(4);
  const std::vector<Shape> shapes = one_of_each_kind(random);
  std::vector<Shape> a, b;
  std::vector<Pose> X_WA, X_WB;
  for (const Shape& s : shapes) {
    for (const Shape& t : shapes) {
      a.push_back(s);
      b.push_back(t);
      X_WA.push_back(random.pose(2.0));
      X_WB.push_back(random.pose(4.0));
    }
  }
  std::vector<DistanceResult> results(a.size());
  const BatchSummary summary = distance_batch(a, X_WA, b, X_WB, results);
  EXPECT_GE(summary.redone, a.size() - 1);
  for (std::size_t k = 0; k < a.size(); ++k) {
    const DistanceResult r = distance(a[k], X_WA[k], b[k], X_WB[k]);
    ASSERT_EQ(results[k].status, r.status);
    ASSERT_NEAR(results[k].distance, r.distance, 1e-13 * 20);
  }
}

TEST(AnyShape, PaperEquationsRefuseWhatHasNone) {
  Random random(5);
  const Shape ball = Ellipsoid({1, 1, 1});
  const Pose X_WB = Pose::translation({9, 0, 0});
  for (const Shape& shape : one_of_each_kind(random)) {
    const WitnessPair seed = dual_seed(shape, Pose(), ball, X_WB);
    ASSERT_EQ(seed.status, SeedStatus::usable);
    const auto solve = [&] { return newton_distance(shape, Pose(), ball, X_WB, NewtonSystem::eight, seed); };
    if (has_equations(shape)) {
      EXPECT_NEAR(solve().distance, distance(shape, Pose(), ball, X_WB).distance, 1e-12);
      EXPECT_EQ(centre_seed(shape, Pose(), ball, X_WB).status, SeedStatus::usable);
    } else {
      EXPECT_EQ(message_of([&] { return solve(); }),
                "newton_distance: the paper's equations need surfaces with second derivatives, and the shape is a " +
                    description(shape) + "; accepted: ellipsoids, superellipsoids and spheres");
      EXPECT_NE(message_of([&] { return centre_seed(ball, Pose(), shape, X_WB); }), "");
    }
  }
}

TEST(AnyShape, HasMassProperties) {
  Random random(6);
  for (const Shape& shape : one_of_each_kind(random)) {
    const MassProperties mass = mass_properties(shape);
    EXPECT_NEAR(mass.volume, volume(shape), 1e-13 * mass.volume);
    EXPECT_LE((mass.inertia.diagonal() - inertia(shape, mass.volume)).norm(), 1e-12 * mass.inertia.norm());
  }
  const MassProperties off = mass_properties(
      Shape(ConvexPolyhedron(std::vector<Vector3d>{{-1, -1, -1}, {3, -1, -1}, {-1, 3, -1}, {-1, -1, 3}})));
  EXPECT_NEAR(off.volume, 64.0 / 6, 1e-13);
  EXPECT_NEAR(off.first_moment.norm(), 0, 1e-14);  // centroid of the corners: the origin
}

}  // namespace
}  // namespace geom
