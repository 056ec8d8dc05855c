/// Ellipsoid: derivatives against finite differences, analytic identities, refusals.

#include "common/geom/random.h"
#include "common/message_of.h"
#include "common/special_values.h"

#include <geom/geom.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <numbers>
#include <optional>
#include <string>

namespace geom {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::Random;
using test_common::message_of;
using testing::HasSubstr;

static_assert(SupportShape<Ellipsoid>);
static_assert(ImplicitSurface<Ellipsoid>);
static_assert(!SupportShape<Pose>);
static_assert(!ImplicitSurface<Vector3d>);

// Central differences with this step err by step^2 f'''/6, and by a few epsilon / step = 2e-11 of rounding. Third
// derivatives of the support point reach 2e3 (the disc below, at |n| = 0.5): 3e-8.
constexpr double kStep = 1e-5;
constexpr double kDifferenceTolerance = 1e-7;

const Ellipsoid kShapes[] = {Ellipsoid({1, 1, 1}), Ellipsoid({1, 1, 3}), Ellipsoid({0.3, 1, 1}),
                             Ellipsoid({2, 0.5, 1.1})};

template <class F>
Vector3d difference_gradient(const F& f, const Vector3d& x) {
  Vector3d gradient;
  for (int i = 0; i < 3; ++i) {
    const Vector3d step = kStep * Vector3d::Unit(i);
    gradient[i] = (f(x + step) - f(x - step)) / (2 * kStep);
  }
  return gradient;
}

template <class F>
Matrix3d difference_jacobian(const F& f, const Vector3d& x) {
  Matrix3d jacobian;
  for (int i = 0; i < 3; ++i) {
    const Vector3d step = kStep * Vector3d::Unit(i);
    jacobian.col(i) = (f(x + step) - f(x - step)) / (2 * kStep);
  }
  return jacobian;
}

/// Returns the message of making an ellipsoid.
std::string refusal_of(const Vector3d& semi_axes) {
  return message_of([&] { return Ellipsoid(semi_axes); });
}

TEST(Ellipsoid, ValueIsZeroOnTheSurfaceNegativeInsideAndPositiveOutside) {
  const Ellipsoid shape({1, 2, 3});
  EXPECT_DOUBLE_EQ(shape.value({0, 0, 0}), -1);
  EXPECT_DOUBLE_EQ(shape.value({1, 0, 0}), 0);
  EXPECT_DOUBLE_EQ(shape.value({0, -2, 0}), 0);
  EXPECT_DOUBLE_EQ(shape.value({0, 0, 3}), 0);
  EXPECT_DOUBLE_EQ(shape.value({1, 2, 3}), 2);
}

TEST(Ellipsoid, GradientAndHessianMatchFiniteDifferences) {
  Random random(1);
  for (const Ellipsoid& shape : kShapes) {
    for (int i = 0; i < 50; ++i) {
      const Vector3d x = random.uniform(0.1, 2) * random.direction();
      const auto value = [&](const Vector3d& p) { return shape.value(p); };
      const auto gradient = [&](const Vector3d& p) { return shape.gradient(p); };
      ASSERT_LE((shape.gradient(x) - difference_gradient(value, x)).norm(), kDifferenceTolerance);
      ASSERT_LE((shape.hessian(x) - difference_jacobian(gradient, x)).norm(), kDifferenceTolerance);
    }
  }
}

TEST(Ellipsoid, SupportPointAndSupportHessianAreTheDerivativesOfTheHeight) {
  Random random(2);
  for (const Ellipsoid& shape : kShapes) {
    for (int i = 0; i < 50; ++i) {
      const Vector3d n = random.uniform(0.5, 2) * random.direction();
      const auto height = [&](const Vector3d& m) { return shape.support(m).height; };
      const auto point = [&](const Vector3d& m) { return shape.support(m).point; };
      ASSERT_LE((shape.support(n).point - difference_gradient(height, n)).norm(), kDifferenceTolerance);
      ASSERT_LE((shape.support_hessian(n) - difference_jacobian(point, n)).norm(), kDifferenceTolerance);
    }
  }
}

TEST(Ellipsoid, SupportIsHomogeneous) {
  Random random(3);
  for (const Ellipsoid& shape : kShapes) {
    for (int i = 0; i < 50; ++i) {
      const Vector3d n = random.direction();
      const double t = random.log_uniform(1e-6, 1e6);
      const Support s = shape.support(n);
      const Support s_t = shape.support(t * n);
      // A few roundings of numbers of order 1; semi-axes are at most 3.
      ASSERT_NEAR(s_t.height / t, s.height, 1e-14);
      ASSERT_LE((s_t.point - s.point).norm(), 1e-14);
      ASSERT_LE((t * shape.support_hessian(t * n) - shape.support_hessian(n)).norm(), 1e-13);
      ASSERT_NEAR(n.dot(s.point), s.height, 1e-14);             // Euler's identity of degree 1
      ASSERT_LE((shape.support_hessian(n) * n).norm(), 1e-13);  // and of degree 0
      ASSERT_EQ(shape.support_hessian(n), shape.support_hessian(n).transpose());
    }
  }
}

TEST(Ellipsoid, SupportPointIsOnTheSurfaceAndItsOutwardNormalIsTheDirection) {
  Random random(4);
  for (const Ellipsoid& shape : kShapes) {
    for (int i = 0; i < 50; ++i) {
      const Vector3d n = random.direction();
      const Vector3d s = shape.support(n).point;
      // A few roundings times the ratio of the semi-axes, 4 at most.
      ASSERT_NEAR(shape.value(s), 0, 1e-14);
      ASSERT_LE((shape.gradient(s).normalized() - n).norm(), 1e-14);
    }
  }
}

TEST(Ellipsoid, NoPointOfTheSurfaceIsBeyondTheSupportHeight) {
  Random random(5);
  for (const Ellipsoid& shape : kShapes) {
    const Vector3d n = random.direction();
    const double height = shape.support(n).height;
    for (int i = 0; i < 200; ++i) {
      const Vector3d x = shape.semi_axes().cwiseProduct(random.direction());
      ASSERT_LE(n.dot(x), height + 1e-14);  // rounding of a point about 3 long
    }
  }
}

TEST(Ellipsoid, SupportHessianOfASphereIsItsRadiusAcrossTheDirection) {
  const Ellipsoid sphere({2.5, 2.5, 2.5});
  const Vector3d n = Vector3d(1, -2, 0.5).normalized();
  const Matrix3d across = Matrix3d::Identity() - n * n.transpose();
  EXPECT_LE((sphere.support_hessian(n) - 2.5 * across).norm(), 1e-14);  // rounding of entries about 2.5
}

TEST(Ellipsoid, SupportHessianHasThePrincipalRadiiAtThePoles) {
  const Ellipsoid shape({1, 2, 3});
  // At the pole of semi-axis c the principal radii of curvature are a^2/c and b^2/c.
  const Matrix3d at_z = Vector3d(1.0 / 3, 4.0 / 3, 0).asDiagonal();
  const Matrix3d at_x = Vector3d(0, 4, 9).asDiagonal();
  EXPECT_LE((shape.support_hessian({0, 0, 1}) - at_z).norm(), 1e-14);
  EXPECT_LE((shape.support_hessian({-1, 0, 0}) - at_x).norm(), 1e-14);
}

TEST(Ellipsoid, RadiiBoundTheSurfaceAndItsCurvature) {
  Random random(6);
  for (const Ellipsoid& shape : kShapes) {
    for (int i = 0; i < 200; ++i) {
      const Vector3d n = random.direction();
      const double radius = shape.semi_axes().cwiseProduct(n).norm();
      ASSERT_LE(radius, shape.bounding_radius() * (1 + 1e-15));
      ASSERT_GE(radius, shape.inscribed_radius() * (1 - 1e-15));
      const Vector3d across = n.unitOrthogonal();
      // The Hessian is a difference of numbers up to amax^2 / amin <= 9, which lose some epsilons of that.
      ASSERT_GE(across.dot(shape.support_hessian(n) * across), shape.min_curvature_radius() - 1e-14);
    }
  }
  const Ellipsoid shape({1, 2, 4});
  EXPECT_DOUBLE_EQ(shape.bounding_radius(), 4);
  EXPECT_DOUBLE_EQ(shape.inscribed_radius(), 1);
  EXPECT_DOUBLE_EQ(shape.min_curvature_radius(), 0.25);  // reached at the tip of the longest axis
  EXPECT_NEAR(shape.support_hessian({0, 0, 1})(0, 0), 0.25, 1e-15);
}

TEST(Ellipsoid, VolumeAndInertiaAreThoseOfAUniformBody) {
  const Ellipsoid shape({1, 2, 3});
  EXPECT_DOUBLE_EQ(shape.volume(), 8 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(shape.inertia(5).x(), 13);
  EXPECT_DOUBLE_EQ(shape.inertia(5).y(), 10);
  EXPECT_DOUBLE_EQ(shape.inertia(5).z(), 5);
  const Ellipsoid sphere({2, 2, 2});
  EXPECT_DOUBLE_EQ(sphere.inertia(1).x(), 0.4 * 4);
}

TEST(Ellipsoid, InertiaMatchesAMonteCarloAverage) {
  const Ellipsoid shape({0.7, 1.2, 2});
  Random random(7);
  constexpr int kPoints = 200'000;
  Vector3d sum = Vector3d::Zero();
  for (int i = 0; i < kPoints; ++i) {
    // Uniform in the unit ball: a direction times the cube root of a uniform number.
    const Vector3d x = shape.semi_axes().cwiseProduct(std::cbrt(random.uniform()) * random.direction());
    sum += Vector3d::Constant(x.squaredNorm()) - x.cwiseAbs2();
  }
  // The standard deviation of a single point is below the mean: 5 standard errors are 5 / sqrt(200000) = 1.1 %.
  const Vector3d ratio = (sum / kPoints).cwiseQuotient(shape.inertia(1));
  EXPECT_LE((ratio - Vector3d::Ones()).cwiseAbs().maxCoeff(), 0.011);
}

TEST(Ellipsoid, SymmetryAxisIsTheOneThatDiffersFromTwoEqualOnes) {
  EXPECT_EQ(Ellipsoid({1, 1, 3}).symmetry_axis(), std::optional<int>(2));
  EXPECT_EQ(Ellipsoid({3, 1, 1}).symmetry_axis(), std::optional<int>(0));
  EXPECT_EQ(Ellipsoid({1, 0.2, 1}).symmetry_axis(), std::optional<int>(1));
  EXPECT_EQ(Ellipsoid({2, 2, 2}).symmetry_axis(), std::optional<int>(2));
  EXPECT_EQ(Ellipsoid({1, 2, 3}).symmetry_axis(), std::nullopt);
  EXPECT_EQ(Ellipsoid({1, std::nextafter(1, 2), 3}).symmetry_axis(), std::nullopt);
}

TEST(Ellipsoid, RefusesSemiAxesThatAreNotPositiveAndFinite) {
  for (const double bad : {0.0, -0.0, -1.0, kNaN, kInfinity, -kInfinity, 1e-51, 1e51}) {
    for (int axis = 0; axis < 3; ++axis) {
      Vector3d semi_axes(1, 1, 1);
      semi_axes[axis] = bad;
      const std::string message = refusal_of(semi_axes);
      ASSERT_THAT(message, HasSubstr("semi-axis")) << bad << " as axis " << axis;
      ASSERT_THAT(message, HasSubstr("accepted: 1e-50 to 1e+50")) << bad << " as axis " << axis;
    }
  }
  EXPECT_THAT(refusal_of({1, -2.5, 1}), HasSubstr("-2.5"));
  EXPECT_THAT(refusal_of({1, 1, kNaN}), HasSubstr("nan"));
}

TEST(Ellipsoid, RefusesAspectRatiosBeyondTheTestedRange) {
  EXPECT_EQ(refusal_of({1, 1e4, 1}), "no std::invalid_argument");
  EXPECT_EQ(refusal_of({1e-50, 1e-50, 1e-47}), "no std::invalid_argument");
  const std::string message = refusal_of({1, 1, 1.5e4});
  EXPECT_THAT(message, HasSubstr("ratio"));
  EXPECT_THAT(message, HasSubstr("15000"));
  EXPECT_THAT(message, HasSubstr("accepted: at most 10000"));
}

}  // namespace
}  // namespace geom
