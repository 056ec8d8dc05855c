// Superellipsoid: support function and norm form against each other and against finite differences, mass properties
// against reference values, radii against sampling, refusals.

#include "common/ed/reference.h"
#include "common/geom/random.h"
#include "common/message_of.h"
#include "common/special_values.h"

#include <geom/geom.h>

#include <Eigen/Eigenvalues>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <vector>

namespace geom {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::Random;
using test_common::message_of;
using testing::HasSubstr;

static_assert(SupportShape<Superellipsoid>);
static_assert(ImplicitSurface<Superellipsoid>);

/// Every pair of exponents, with and without a fast path.
std::vector<Superellipsoid> shapes() {
  std::vector<Superellipsoid> all;
  for (const double e1 : {0.2, 4.0 / 9, 0.5, 0.7, 1.0, 1.2, 10.0 / 7, 1.6}) {
    for (const double e2 : {0.2, 0.4, 0.5, 4.0 / 7, 2.0 / 3, 0.8, 1.0, 4.0 / 3, 1.5, 14.0 / 9, 1.6}) {
      all.emplace_back(Vector3d(1, 1.7, 0.6), e1, e2);
    }
  }
  return all;
}

TEST(Superellipsoid, SupportPointIsOnTheSurfaceWithThatNormal) {
  Random random(1);
  for (const Superellipsoid& shape : shapes()) {
    for (int k = 0; k < 200; ++k) {
      const Vector3d n = random.direction();
      const Support s = shape.support(n);
      ASSERT_NEAR(s.point.dot(n), s.height, 8 * kEpsilon * shape.bounding_radius());
      // Value and gradient lose digits where a coordinate is near zero and its exponent is high: 2/e = 10.
      ASSERT_NEAR(shape.value(s.point), 0, 1e-13);
      // The body is on one side of the plane through s with normal n.
      const Vector3d other = shape.support(random.direction()).point;
      ASSERT_LE(other.dot(n), s.height * (1 + 8 * kEpsilon));
    }
  }
}

/// The gradient of f at the support point of n is along n.
TEST(Superellipsoid, NormFormAndSupportFunctionBelongTogether) {
  Random random(2);
  for (const Superellipsoid& shape : shapes()) {
    for (int k = 0; k < 200; ++k) {
      const Vector3d n = random.direction();
      const Vector3d gradient = shape.gradient(shape.support(n).point);
      // s(n) has the exponent e of n, so that an error of n is one of s to the power 1/e: up to (1e-16)^(1/5) where n
      // is near a plane. Away from the planes it is rounding.
      if (n.cwiseAbs().minCoeff() < 0.1) continue;
      ASSERT_LT(gradient.normalized().cross(n).norm(), 1e-12) << shape.e1() << ' ' << shape.e2();
    }
  }
}

template <class F>
Matrix3d difference_jacobian(const F& f, const Vector3d& x, double step) {
  Matrix3d jacobian;
  for (int i = 0; i < 3; ++i) {
    const Vector3d d = step * Vector3d::Unit(i);
    jacobian.col(i) = (f(x + d) - f(x - d)) / (2 * step);
  }
  return jacobian;
}

TEST(Superellipsoid, DerivativesAgreeWithDifferences) {
  Random random(3);
  for (const Superellipsoid& shape : shapes()) {
    for (int k = 0; k < 30; ++k) {
      const Vector3d n = random.direction();
      if (n.cwiseAbs().minCoeff() < 0.1) continue;  // derivatives of high order grow without bound near the planes
      const auto point = [&](const Vector3d& m) { return shape.support(m).point; };
      const Matrix3d H = shape.support_hessian(n);
      const Matrix3d difference = difference_jacobian(point, n, 1e-5);
      ASSERT_LT((H - difference).norm(), 1e-5 * (1 + H.norm())) << shape.e1() << ' ' << shape.e2();
      // 1-homogeneous: the Hessian vanishes along n.
      ASSERT_LT((H * n).norm(), 20 * kEpsilon * H.norm());
      const Vector3d x = random.uniform(0.3, 1.5) * n;
      const auto gradient = [&](const Vector3d& y) { return shape.gradient(y); };
      const Matrix3d F = shape.hessian(x);
      ASSERT_LT((F - difference_jacobian(gradient, x, 1e-6)).norm(), 1e-4 * (1 + F.norm()))
          << shape.e1() << ' ' << shape.e2();
      const auto value = [&](double t) { return shape.value(x + t * n); };
      ASSERT_NEAR(shape.gradient(x).dot(n), (value(1e-6) - value(-1e-6)) / 2e-6, 1e-6 * (1 + shape.gradient(x).norm()));
    }
  }
}

TEST(Superellipsoid, WithExponentsOneIsTheEllipsoid) {
  Random random(4);
  for (const Vector3d& axes : {Vector3d(1, 1.7, 0.6), Vector3d(1, 1, 3), Vector3d(2, 2, 2), Vector3d(1, 1e4, 7)}) {
    const Ellipsoid ellipsoid(axes);
    const Superellipsoid same(axes, 1, 1);
    for (int k = 0; k < 3000; ++k) {
      const Vector3d n = k == 0 ? Vector3d(Vector3d::UnitY()) : random.direction();
      const Support a = ellipsoid.support(n);
      const Support b = same.support(n);
      ASSERT_EQ(a.height, b.height);
      ASSERT_EQ(a.point, b.point);
      ASSERT_EQ(ellipsoid.value(n), same.value(n));
      ASSERT_EQ(ellipsoid.gradient(n), same.gradient(n));
      ASSERT_EQ(ellipsoid.support_hessian(n), same.support_hessian(n));
      ASSERT_EQ(ellipsoid.hessian(n), same.hessian(n));
      ASSERT_DOUBLE_EQ(same.norm(n), n.cwiseQuotient(axes).norm());
    }
    EXPECT_EQ(same.hessian(Vector3d::Zero()), ellipsoid.hessian(Vector3d::Zero()));
    EXPECT_EQ(same.volume(), ellipsoid.volume());
    EXPECT_EQ(same.inertia(1), ellipsoid.inertia(1));
    EXPECT_EQ(same.bounding_radius(), ellipsoid.bounding_radius());
    EXPECT_EQ(same.inscribed_radius(), ellipsoid.inscribed_radius());
    EXPECT_EQ(same.min_curvature_radius(), ellipsoid.min_curvature_radius());
  }
  const Superellipsoid same({1, 1.7, 0.6}, 1, 1);
  EXPECT_EQ(same.bounding_radius(), 1.7);
  EXPECT_EQ(same.inscribed_radius(), 0.6);
}

TEST(Superellipsoid, IsFiniteInTheCoordinatePlanes) {
  for (const Superellipsoid& shape : shapes()) {
    for (const Vector3d& n : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, -1), Vector3d(1, 1, 0),
                              Vector3d(0, 1, -1), Vector3d(1, 1, 1), Vector3d(1, 1e-300, 0)}) {
      const Support s = shape.support(n);
      ASSERT_TRUE(std::isfinite(s.height) && s.point.allFinite());
      ASSERT_TRUE(shape.support_hessian(n).allFinite());
      ASSERT_TRUE(shape.gradient(n).allFinite() && shape.hessian(n).allFinite());
      ASSERT_NEAR(shape.value(s.point), 0, 1e-13);
    }
    // Tips are where they must be.
    EXPECT_EQ(shape.support(Vector3d::UnitX()).height, 1);
    EXPECT_EQ(shape.support(-Vector3d::UnitZ()).point, Vector3d(0, 0, -0.6));
  }
}

TEST(Superellipsoid, VolumeAndInertiaAgreeWithTheReference) {
  const ed_test::ReferenceTable table("superellipsoid_mass_barr.csv");
  int rows = 0;
  double worst = 0;
  for (std::size_t row = 0; row < table.size(); ++row) {
    const double e1 = table.value(row, "e1");
    const double e2 = table.value(row, "e2");
    if (std::min(e1, e2) < kMinExponent || std::max(e1, e2) > kMaxExponent) continue;
    ++rows;
    const Superellipsoid shape({table.value(row, "a"), table.value(row, "b"), table.value(row, "c")}, e1, e2);
    const double V = table.value(row, "V");
    worst = std::max(worst, std::abs(shape.volume() / V - 1));
    const Vector3d I = shape.inertia(V);
    const Vector3d wanted(table.value(row, "Ixx"), table.value(row, "Iyy"), table.value(row, "Izz"));
    worst = std::max(worst, (I - wanted).cwiseQuotient(wanted).cwiseAbs().maxCoeff());
  }
  std::printf("%d rows, largest relative difference %.1e\n", rows, worst);
  EXPECT_GT(rows, 200);
  EXPECT_LE(worst, 1e-12);
}

TEST(Superellipsoid, RadiiAreTight) {
  Random random(5);
  for (const Superellipsoid& shape : shapes()) {
    double furthest = 0;
    double nearest = std::numeric_limits<double>::infinity();
    const auto look = [&](const Vector3d& n) {
      const double r = shape.support(n).point.norm();
      const double h = shape.support(n).height / n.norm();
      ASSERT_LE(r, shape.bounding_radius() * (1 + 4 * kEpsilon));
      ASSERT_GE(h, shape.inscribed_radius() * (1 - 4 * kEpsilon));
      furthest = std::max(furthest, r);
      nearest = std::min(nearest, h);
    };
    for (int k = 0; k < 20000; ++k) look(random.direction());
    for (int k = 0; k < 3; ++k) look(Vector3d::Unit(k));
    // The furthest point of a box-like body is the support point of its own direction: a few rounds lead there.
    Vector3d x(1, 1.7, 0.6);
    for (int k = 0; k < 200; ++k) x = shape.support(x).point;
    look(x);
    EXPECT_NEAR(furthest, shape.bounding_radius(), 1e-3 * shape.bounding_radius()) << shape.e1() << ' ' << shape.e2();
    EXPECT_NEAR(nearest, shape.inscribed_radius(), 2e-3 * shape.inscribed_radius()) << shape.e1() << ' ' << shape.e2();
  }
}

/// Returns the smallest radius of curvature among many normals, also near the planes of symmetry.
double sampled_curvature_radius(const Superellipsoid& shape, Random& random) {
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 4000; ++k) {
    Vector3d n = random.direction();
    if (k % 2 == 0) {
      for (int i = 0; i < 3; ++i) n[i] *= random.log_uniform(1e-3, 1);
      n.normalize();
    }
    const Vector3d e = n.unitOrthogonal();
    Eigen::Matrix<double, 3, 2> across;
    across << e, n.cross(e);
    const Eigen::Matrix2d H = across.transpose() * shape.support_hessian(n) * across;
    least = std::min(least, Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(H, Eigen::EigenvaluesOnly).eigenvalues()[0]);
  }
  return least;
}

TEST(Superellipsoid, CurvatureRadiusIsALowerBoundOfUse) {
  Random random(6);
  for (const double e1 : {0.2, 0.35, 0.5, 0.8, 1.0}) {
    for (const double e2 : {0.2, 0.4, 0.5, 0.9, 1.0}) {
      for (const Vector3d& axes : {Vector3d(1, 1, 1), Vector3d(1, 2, 3), Vector3d(1, 1, 3), Vector3d(3, 3, 1),
                                   Vector3d(1, 0.3, 2), Vector3d(2, 1, 0.1)}) {
        const Superellipsoid shape(axes, e1, e2);
        const double sampled = sampled_curvature_radius(shape, random);
        ASSERT_LE(shape.min_curvature_radius(), sampled * (1 + 1e-9)) << shape.description();
        const bool superball = e1 == e2 && axes == Vector3d(1, 1, 1);
        EXPECT_GE(shape.min_curvature_radius(), (superball ? 0.95 : 0.14) * sampled) << shape.description();
      }
    }
  }
  EXPECT_EQ(Superellipsoid({1, 2, 3}, 0.5, 1.2).min_curvature_radius(), 0);
  EXPECT_EQ(Superellipsoid({1, 2, 3}, 1.2, 0.5).min_curvature_radius(), 0);
}

TEST(Superellipsoid, RefusesBadInputByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(message_of([] { Superellipsoid({1, 0, 1}, 1, 1); }), HasSubstr("semi-axis y is 0"));
  EXPECT_THAT(message_of([] { Superellipsoid({1, -1, 1}, 1, 1); }), HasSubstr("semi-axis y is -1"));
  EXPECT_THAT(message_of([&] { Superellipsoid({1, nan, 1}, 1, 1); }), HasSubstr("semi-axis y is nan"));
  EXPECT_THAT(message_of([] { Superellipsoid({1, 1e5, 1}, 1, 1); }), HasSubstr("ratio"));
  EXPECT_THAT(message_of([] { Superellipsoid({1, 1, 1}, 0.1, 1); }), HasSubstr("e1 is 0.1; accepted: 0.2 to 1.6"));
  EXPECT_THAT(message_of([] { Superellipsoid({1, 1, 1}, 1, 2); }), HasSubstr("e2 is 2; accepted: 0.2 to 1.6"));
  EXPECT_THAT(message_of([&] { Superellipsoid({1, 1, 1}, 1, nan); }), HasSubstr("e2 is nan"));
}

}  // namespace
}  // namespace geom
