/// Support functions, moments and refusals of spheres, capsules, boxes, cylinders, cones and rounded shapes.

#include "common/geom/random.h"
#include "common/message_of.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace geom {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::Random;
using geom_test::repetitions;
using test_common::message_of;

/// Checks that support points are points of the body, that none of them is further along another normal, and that radii
/// enclose them.
template <class Shape>
void check_support(const Shape& shape) {
  Random random(1);
  std::vector<Vector3d> points;
  const double rounding = 1e-14 * shape.bounding_radius();
  for (int i = 0; i < 200; ++i) {
    const Vector3d n = random.log_uniform(0.01, 100) * random.direction();
    const Support s = shape.support(n);
    ASSERT_NEAR(s.height, n.dot(s.point), n.norm() * rounding);
    points.push_back(s.point);
    ASSERT_LE(s.point.norm(), shape.bounding_radius() + rounding);
    ASSERT_GE(s.height / n.norm(), shape.inscribed_radius() - rounding);
    const Matrix3d H = shape.support_hessian(n);
    ASSERT_LE((H * n).norm(), 1e-12 * shape.bounding_radius());  // h is 1-homogeneous
  }
  for (int i = 0; i < 200; ++i) {
    const Vector3d n = random.direction();
    const double height = shape.support(n).height;
    for (const Vector3d& x : points) ASSERT_LE(n.dot(x), height + rounding);
  }
}

TEST(CoreShapes, HaveSupportFunctions) {
  check_support(Sphere(0.7));
  check_support(Capsule(2, 0.5));
  check_support(Capsule(0, 0.5));
  check_support(Box({1, 2, 3}));
  check_support(Rounded<Box>(Box({1, 2, 3}), 0.3));
  check_support(Rounded<Capsule>(Capsule(2, 0.5), 0.3));
  check_support(Rounded<Ellipsoid>(Ellipsoid({1, 2, 3}), 0.3));
  check_support(Cylinder(2, 0.5));
  check_support(Cone(2, 0.5));
  check_support(Cone(0.5, 2, -0.2));
  check_support(Rounded<Cylinder>(Cylinder(0.5, 2), 0.3));
  check_support(Rounded<Cone>(Cone(2, 1), 0.3));
}

/// The middle of a face supports it along the axis, so that coaxial bodies have closest points there.
TEST(CoreShapes, HaveSupportsAlongTheirAxes) {
  EXPECT_EQ(Cylinder(2, 0.5).support(Vector3d(0, 0, 3)).height, 6);
  EXPECT_EQ(Cylinder(2, 0.5).support(Vector3d(0, 0, 3)).point, Vector3d(0, 0, 2));
  EXPECT_EQ(Cylinder(2, 0.5).support(Vector3d(0, 2, 0)).height, 1);
  EXPECT_EQ(Cone(2, 0.5).support(Vector3d(0, 0, 1)).point, Vector3d(0, 0, 1.5));
  EXPECT_EQ(Cone(2, 0.5).support(Vector3d(0, 0, -1)).point, Vector3d(0, 0, -0.5));
  EXPECT_EQ(Cone(2, 0.5).support(Vector3d(-1, 0, 0)).point, Vector3d(-0.5, 0, -0.5));
  EXPECT_TRUE(Cylinder(2, 0.5).support_hessian(Vector3d(0, 0, 1)).isZero(0));
}

/// Hessians are the derivatives of support points.
TEST(CoreShapes, HaveHessiansOfTheirRims) {
  Random random(3);
  const auto check = [&](const auto& shape) {
    for (int i = 0; i < 100; ++i) {
      const Vector3d n = random.direction();
      if (std::abs(n.z()) < 0.1 || std::abs(n.z()) > 0.9) continue;
      const Matrix3d H = shape.support_hessian(n);
      for (int k = 0; k < 3; ++k) {
        const Vector3d e = 1e-6 * Vector3d::Unit(k);
        const Vector3d change = (shape.support(n + e).point - shape.support(n - e).point) / 2e-6;
        EXPECT_LE((H.col(k) - change).norm(), 1e-6);
      }
    }
  };
  check(Cylinder(2, 0.5));
  check(Cone(0.05, 1));  // an apex above which there are few of these normals
  check(kernel::CoreBody(Rounded<Cylinder>(Cylinder(1, 2), 0.3)));
}

/// Curvature bounds are used for certificates: that of a capsule is the ball's.
TEST(CoreShapes, HaveRadii) {
  EXPECT_EQ(Sphere(2).bounding_radius(), 2);
  EXPECT_EQ(Sphere(2).inscribed_radius(), 2);
  EXPECT_EQ(Capsule(2, 0.5).bounding_radius(), 2.5);
  EXPECT_EQ(Capsule(2, 0.5).min_curvature_radius(), 0.5);
  EXPECT_EQ(Box({1, 2, 2}).bounding_radius(), 3);
  EXPECT_EQ(Box({1, 2, 2}).inscribed_radius(), 1);
  EXPECT_EQ(Rounded<Box>(Box({1, 2, 2}), 0.5).bounding_radius(), 3.5);
  EXPECT_EQ(Rounded<Box>(Box({1, 2, 2}), 0.5).min_curvature_radius(), 0.5);
  EXPECT_EQ(Cylinder(1.5, 2).bounding_radius(), 2.5);
  EXPECT_EQ(Cylinder(1.5, 2).inscribed_radius(), 1.5);
  EXPECT_EQ(Cylinder(1.5, 2).min_curvature_radius(), 0);
  EXPECT_EQ(Cone(4, 3).bounding_radius(), std::sqrt(10));
  EXPECT_EQ(Cone(4, 0.5).bounding_radius(), 3);
  EXPECT_EQ(Cone(4, 3).inscribed_radius(), 1);
  EXPECT_NEAR(Cone(4, 0.5, -3).inscribed_radius(), 0.5 / std::sqrt(16.25), 1e-16);
  EXPECT_EQ(Rounded<Cone>(Cone(4, 3), 0.5).inscribed_radius(), 1.5);
  EXPECT_EQ(Cylinder(2, 3).scaled(2).radius(), 6);
  EXPECT_EQ(Cone(2, 3, -0.7).scaled(2).base(), -1.4);
  EXPECT_EQ(Sphere(2).scaled(2).radius(), 4);
  EXPECT_EQ(Capsule(2, 0.5).scaled(2).half_length(), 4);
  EXPECT_EQ(Box({1, 2, 2}).scaled(2).half_extents(), Vector3d(2, 4, 4));
}

TEST(CoreShapes, HaveDescriptions) {
  EXPECT_EQ(Sphere(2).description(), "sphere of radius 2");
  EXPECT_EQ(Capsule(2, 0.5).description(), "capsule of half-length 2 and radius 0.5");
  EXPECT_EQ(Box({1, 2, 2.5}).description(), "box of half extents 1 x 2 x 2.5");
  EXPECT_EQ(Cylinder(2, 0.5).description(), "cylinder of half-length 2 and radius 0.5");
  EXPECT_EQ(Rounded<Cone>(Cone(2, 0.5), 0.1).description(), "cone of height 2 and radius 0.5, rounded by 0.1");
}

TEST(CoreShapes, HaveMomentsOfInertia) {
  const double pi = std::numbers::pi;
  EXPECT_NEAR(Sphere(2).volume(), 32 * pi / 3, 1e-13);
  EXPECT_EQ(Sphere(2).inertia(5), Vector3d::Constant(8));
  EXPECT_EQ(Box({1, 2, 3}).volume(), 48);
  EXPECT_EQ(Box({1, 2, 3}).inertia(3), Vector3d(13, 10, 5));
  EXPECT_NEAR(Cylinder(2, 3).volume(), 36 * pi, 1e-13);
  EXPECT_EQ(Cylinder(2, 3).inertia(12), Vector3d(43, 43, 54));
  EXPECT_NEAR(Cone(2, 3).volume(), 6 * pi, 1e-13);
  EXPECT_LE((Cone(2, 3).inertia(80) - Vector3d(120, 120, 216)).norm(), 1e-13);
  EXPECT_LE((Cone(2, 3, -1).inertia(80) - Vector3d(140, 140, 216)).norm(), 1e-13);  // Steiner: 80 / 4 more
  EXPECT_TRUE(Cone(2, 3).is_in_principal_frame());
  EXPECT_FALSE(Cone(2, 3, -1).is_in_principal_frame());
  EXPECT_EQ(Cone(2, 3, -1).centre_of_mass(), Vector3d(0, 0, -0.5));
  // Of a capsule by quadrature of its equation.
  for (const double half_length : {0.0, 0.3, 2.0}) {
    const Capsule capsule(half_length, 0.5);
    const MassProperties mass = mass_properties(capsule, capsule.bounding_radius(), 1e-4);
    EXPECT_NEAR(capsule.volume(), mass.volume, 1e-4 * mass.volume);
    EXPECT_LE((capsule.inertia(mass.volume) - mass.inertia.diagonal()).norm(), 1e-4 * mass.inertia.norm());
  }
  EXPECT_LE((Capsule(0, 2).inertia(5) - Sphere(2).inertia(5)).norm(), 1e-14);
}

/// The equations of the implicit forms have the gradients that they state.
TEST(CoreShapes, HaveDerivativesOfTheirEquations) {
  Random random(2);
  const auto check = [&](const auto& shape) {
    for (int i = 0; i < 100; ++i) {
      const Vector3d x = random.uniform(0.5, 3) * random.direction();
      const Vector3d gradient = shape.gradient(x);
      const double step = 1e-6;
      for (int k = 0; k < 3; ++k) {
        const Vector3d e = step * Vector3d::Unit(k);
        EXPECT_NEAR(gradient[k], (shape.value(x + e) - shape.value(x - e)) / (2 * step), 1e-6);
        EXPECT_LE((shape.hessian(x).col(k) - (shape.gradient(x + e) - shape.gradient(x - e)) / (2 * step)).norm(),
                  1e-5);
      }
    }
  };
  check(Sphere(0.8));
  check(Capsule(0.7, 0.8));
}

TEST(CoreShapes, RefuseBadNumbersWithOneMessage) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message_of([] { return Sphere(0); }), "Sphere: radius is 0; accepted: 1e-50 to 1e+50");
  EXPECT_EQ(message_of([&] { return Sphere(nan); }), "Sphere: radius is nan; accepted: 1e-50 to 1e+50");
  EXPECT_EQ(message_of([] { return Capsule(1, -1); }), "Capsule: radius is -1; accepted: 1e-50 to 1e+50");
  EXPECT_EQ(message_of([] { return Capsule(-1, 1); }), "Capsule: half-length is -1; accepted: 0 to 1e+50");
  EXPECT_EQ(message_of([&] { return Capsule(nan, 1); }), "Capsule: half-length is nan; accepted: 0 to 1e+50");
  EXPECT_EQ(message_of([] { return Capsule(20000, 1); }),
            "Capsule: ratio of half-length + radius to the radius is 20001; accepted: at most 10000");
  EXPECT_EQ(message_of([] { return Cylinder(0, 1); }), "Cylinder: half-length is 0; accepted: 1e-50 to 1e+50");
  EXPECT_EQ(message_of([&] { return Cylinder(1, nan); }), "Cylinder: radius is nan; accepted: 1e-50 to 1e+50");
  EXPECT_EQ(message_of([] { return Cylinder(20000, 1); }),
            "Cylinder: ratio of half-length to radius is 20000; accepted: at most 10000");
  EXPECT_EQ(message_of([] { return Cylinder(1, 20000); }),
            "Cylinder: ratio of radius to half-length is 20000; accepted: at most 10000");
  EXPECT_EQ(message_of([] { return Cone(-1, 1); }), "Cone: height is -1; accepted: 1e-50 to 1e+50");
  EXPECT_EQ(message_of([] { return Cone(1, 0); }), "Cone: radius is 0; accepted: 1e-50 to 1e+50");
  EXPECT_EQ(message_of([&] { return Cone(1, 1, nan); }),
            "Cone: base is nan; accepted: more than -1, less than 0, so that the origin is inside");
  EXPECT_EQ(message_of([] { return Cone(1, 1, 0); }),
            "Cone: base is 0; accepted: more than -1, less than 0, so that the origin is inside");
  EXPECT_EQ(message_of([] { return Cone(1, 1, -1e-5); }).substr(0, 42), "Cone: ratio of bounding to inscribed radiu");
  EXPECT_EQ(message_of([] { return Rounded<Cone>(Cone(1, 1), -1); }), "Rounded: radius is -1; accepted: 0 to 1e+50");
  EXPECT_EQ(message_of([] { return Box({1, 0, 1}); }), "Box: half extent y is 0; accepted: 1e-50 to 1e+50");
  EXPECT_EQ(message_of([] {
              return Box({1, 1, 20000});
            }),
            "Box: ratio of the largest to the smallest half extent is 20000; accepted: at most 10000");
  EXPECT_EQ(message_of([] {
              return Rounded<Box>(Box({1, 1, 1}), -0.1);
            }),
            "Rounded: radius is -0.1; accepted: 0 to 1e+50");
  EXPECT_EQ(message_of([&] {
              return Rounded<Box>(Box({1, 1, 1}), nan);
            }),
            "Rounded: radius is nan; accepted: 0 to 1e+50");
}

}  // namespace
}  // namespace geom
