/// Volume and moments of polytopes, cylinders and cones that a ball is swept over.

#include "common/geom/core_pairs.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <cmath>
#include <numbers>
#include <vector>

namespace geom {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::Random;

std::vector<Vector3d> box_corners(const Vector3d& half, const Vector3d& centre = Vector3d::Zero()) {
  std::vector<Vector3d> all;
  for (unsigned k = 0; k < 8; ++k) {
    const Vector3d sign((k & 1U) != 0 ? 1 : -1, (k & 2U) != 0 ? 1 : -1, (k & 4U) != 0 ? 1 : -1);
    all.emplace_back(centre + half.cwiseProduct(sign));
  }
  return all;
}

/// Distance of a point from a core, as a surface f(x) = distance^2 - radius^2 for the quadrature of mass.h.
struct SweptSurface {
  kernel::CoreView core;

  double value(const Vector3d& x) const {
    const double d = distance_at(x).distance;
    return d * std::abs(d) - core.radius * core.radius;
  }
  Vector3d gradient(const Vector3d& x) const {
    const DistanceResult r = distance_at(x);
    return -2 * std::abs(r.distance) * r.normal;
  }
  Matrix3d hessian(const Vector3d& /*x*/) const { return Matrix3d::Zero(); }

 private:
  DistanceResult distance_at(const Vector3d& x) const {
    kernel::CoreView bare = core;
    bare.radius = 0;
    return kernel::core_distance({}, Pose::translation(x), bare, Pose(), {});
  }
};

TEST(SweptMass, OfSpheresAndCapsulesIsTheirs) {
  const Sphere sphere(0.7);
  const kernel::SweptMass ball = kernel::swept_mass(sphere.core());
  EXPECT_NEAR(ball.volume, sphere.volume(), 1e-15);
  EXPECT_LE((ball.inertia(2).diagonal() - sphere.inertia(2)).norm(), 1e-15);
  const Capsule capsule(2, 0.5);
  const kernel::SweptMass rod = kernel::swept_mass(capsule.core());
  EXPECT_NEAR(rod.volume, capsule.volume(), 1e-14);
  EXPECT_LE((rod.inertia(2).diagonal() - capsule.inertia(2)).norm(), 1e-14);
}

TEST(SweptMass, OfCylindersAndConesIsTheirs) {
  const Cylinder cylinder(2, 0.5);
  const kernel::SweptMass rod = kernel::swept_mass(cylinder.core());
  EXPECT_NEAR(rod.volume, cylinder.volume(), 1e-14);
  EXPECT_LE((rod.inertia(2).diagonal() - cylinder.inertia(2)).norm(), 1e-14);
  for (const double base : {-0.5, -1.3}) {
    const Cone cone(2, 0.7, base);
    const kernel::SweptMass mass = kernel::swept_mass(cone.core());
    EXPECT_NEAR(mass.volume, cone.volume(), 1e-14);
    EXPECT_LE((mass.centre() - cone.centre_of_mass()).norm(), 1e-14);
    EXPECT_LE((mass.inertia(2).diagonal() - cone.inertia(2)).norm(), 1e-14);
  }
}

/// Steiner's formula of the volume: surface and mean width of the cylinder, of the cone in all of its angles.
TEST(SweptMass, OfRoundedCylindersAndConesIsSteiners) {
  const double pi = std::numbers::pi;
  const double l = 2, r = 0.5;
  for (const double ball : {1e-3, 0.3, 4.0}) {
    const double tube = Rounded<Cylinder>(Cylinder(l, r), ball).volume();
    const double balls = 4.0 / 3 * pi * ball * ball * ball;
    const double surface = 2 * pi * r * (2 * l + r);
    const double mean_curvature = 2 * pi * l + pi * pi * r;
    EXPECT_NEAR(tube, 2 * pi * r * r * l + surface * ball + mean_curvature * ball * ball + balls, 1e-13 * tube);
    const double height = 3;
    const double slant = std::hypot(height, r);
    const double cone = Rounded<Cone>(Cone(height, r), ball).volume();
    const double tip = std::asin(r / slant);  // between the axis and the side
    const double of_rim = pi * r * (0.5 * pi + tip);
    const double of_side = pi * slant * std::cos(tip);
    const double of_cone = pi * r * (slant + r);
    EXPECT_NEAR(cone, pi / 3 * r * r * height + of_cone * ball + (of_rim + of_side) * ball * ball + balls,
                1e-13 * cone);
  }
}

/// Moments by quadrature of the distance, and the frame of the centre of mass.
TEST(SweptMass, OfRoundedConesHasAFrameOfItsCentre) {
  for (const double height : {0.4, 3.0}) {
    const Cone cone = Cone::in_principal_frame(height, 0.8, 0.3);
    const Rounded<Cone> body(cone, 0.3);
    EXPECT_TRUE(body.is_in_principal_frame());
    EXPECT_FALSE(Rounded<Cone>(Cone(height, 0.8), 0.3).is_in_principal_frame());
    EXPECT_LE(body.centre_of_mass().norm(), 1e-15);
    const MassProperties mass = mass_properties(SweptSurface{body.core()}, body.bounding_radius(), 1e-4);
    EXPECT_NEAR(body.volume(), mass.volume, 2e-4 * mass.volume);
    EXPECT_LE((body.inertia_tensor(mass.volume) - mass.inertia).norm(), 2e-4 * mass.inertia.norm());
    EXPECT_LE(mass.first_moment.norm(), 2e-4 * mass.volume);
  }
}

/// Two closed forms: that of boxes, and the sum over faces, edges and vertices.
TEST(SweptMass, OfBoxesIsThatOfTheirHulls) {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    const Vector3d half(random.log_uniform(0.1, 10), random.log_uniform(0.1, 10), random.log_uniform(0.1, 10));
    const double radius = i % 5 == 0 ? 0 : random.log_uniform(1e-3, 10);
    const Rounded<Box> box(Box(half), radius);
    const Rounded<ConvexPolyhedron> hull(ConvexPolyhedron(box_corners(half)), radius);
    EXPECT_NEAR(box.volume(), hull.volume(), 1e-14 * box.volume());
    EXPECT_LE((box.inertia_tensor(1) - hull.inertia_tensor(1)).norm(), 1e-14 * box.inertia_tensor(1).norm());
    EXPECT_LE(hull.centre_of_mass().norm(), 1e-14 * hull.bounding_radius());
    EXPECT_TRUE(box.is_in_principal_frame());
  }
}

TEST(SweptMass, OfASharpBoxIsTheBoxs) {
  const Box box({1, 2, 3});
  const Rounded<Box> sharp(box, 0);
  EXPECT_NEAR(sharp.volume(), box.volume(), 1e-13);
  EXPECT_LE((sharp.inertia(1) - box.inertia(1)).norm(), 1e-14);
}

/// The moments of a body about another point follow from those about its centre.
TEST(SweptMass, MovesWithTheBody) {
  const Vector3d half(1, 0.7, 0.5);
  const Vector3d by(0.3, -0.2, 0.1);
  const kernel::SweptMass here = kernel::swept_mass(Rounded<Box>(Box(half), 0.4).core());
  const Rounded<ConvexPolyhedron> moved(ConvexPolyhedron(box_corners(half, by)), 0.4);
  const kernel::SweptMass there = kernel::swept_mass(moved.core());
  EXPECT_NEAR(there.volume, here.volume, 1e-13);
  EXPECT_LE((there.centre() - by).norm(), 1e-14);
  const Matrix3d shifted = here.second_moment + here.volume * by * by.transpose();
  EXPECT_LE((there.second_moment - shifted).norm(), 1e-13);
  EXPECT_FALSE(moved.is_in_principal_frame());
}

TEST(SweptMass, OfAnyHullAgreesWithQuadrature) {
  Random random(2);
  for (const int points : {6, 8}) {
    const Rounded<ConvexPolyhedron> body(geom_test::random_polyhedron(points, random), 0.5);
    const kernel::SweptMass mass = kernel::swept_mass(body.core());
    const MassProperties wanted = mass_properties(SweptSurface{body.core()}, body.bounding_radius(), 1e-4);
    EXPECT_NEAR(mass.volume, wanted.volume, 1e-4 * wanted.volume);
    EXPECT_LE((mass.first_moment - wanted.first_moment).norm(), 1e-4 * wanted.volume);
    EXPECT_LE((mass.inertia(mass.volume) - wanted.inertia).norm(), 2e-4 * wanted.inertia.norm());
  }
}

TEST(SweptMass, PrincipalFramesAreThoseOfTheRoundedBody) {
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    std::vector<Vector3d> points;
    for (int k = 0; k < 9; ++k) points.emplace_back(random.uniform(0.7, 1) * random.direction() + Vector3d(5, 0, 0));
    Pose X_BP;
    const ConvexPolyhedron sharp = ConvexPolyhedron::in_principal_frame(points);
    const ConvexPolyhedron inner = ConvexPolyhedron::in_principal_frame(points, &X_BP, 0.4);
    EXPECT_TRUE(sharp.is_in_principal_frame());
    EXPECT_FALSE(inner.is_in_principal_frame());
    EXPECT_FALSE(Rounded<ConvexPolyhedron>(sharp, 0.4).is_in_principal_frame());
    EXPECT_TRUE(Rounded<ConvexPolyhedron>(inner, 0.4).is_in_principal_frame());
    EXPECT_LE((X_BP.to_world(inner.vertex(0)) - points[0]).norm(), 1e-13);
  }
}

/// A hull that is made of another one's vertices is the same to the last bit, so that saved shapes are restored.
TEST(SweptMass, HullsOfHullsAreTheSame) {
  Random random(4);
  for (int i = 0; i < 20; ++i) {
    std::vector<Vector3d> points = box_corners({1, 1, 1});  // faces with many edges, and points inside and on them
    for (int k = 0; k < 10; ++k) points.emplace_back(random.uniform(0.5, 1.5) * random.direction());
    points.emplace_back(1, 0.25, 0.5);
    const ConvexPolyhedron hull(points);
    std::vector<Vector3d> vertices;
    for (int k = 0; k < hull.vertex_count(); ++k) vertices.push_back(hull.vertex(k));
    const ConvexPolyhedron again(vertices);
    ASSERT_EQ(again.vertex_count(), hull.vertex_count());
    for (int k = 0; k < hull.vertex_count(); ++k) ASSERT_EQ(again.vertex(k), hull.vertex(k));
    ASSERT_EQ(again.faces(), hull.faces());
    const kernel::Hull& a = *hull.core().hull;
    const kernel::Hull& b = *again.core().hull;
    ASSERT_EQ(a.normals, b.normals);
    ASSERT_EQ(a.offsets, b.offsets);
    ASSERT_EQ(again.volume(), hull.volume());
  }
}

}  // namespace
}  // namespace geom
