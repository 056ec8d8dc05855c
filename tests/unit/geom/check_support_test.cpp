/// Faults of support functions that check_support finds, and shapes that have none.

#include "common/geom/core_pairs.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

namespace geom {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::Random;

/// Ellipsoid of which parts can be replaced by wrong ones.
struct Faulty {
  Ellipsoid body{{1, 2, 3}};
  std::function<Support(const Vector3d&, Support)> change = [](const Vector3d&, const Support& s) { return s; };
  std::function<Matrix3d(const Vector3d&, Matrix3d)> change_hessian = [](const Vector3d&, const Matrix3d& H) {
    return H;
  };
  double outer = 3, inner = 1, curvature = 0;

  Support support(const Vector3d& n) const { return change(n, body.support(n)); }
  Matrix3d support_hessian(const Vector3d& n) const { return change_hessian(n, body.support_hessian(n)); }
  double bounding_radius() const { return outer; }
  double inscribed_radius() const { return inner; }
  double min_curvature_radius() const { return curvature; }
};

void expect_fault(const Faulty& shape, const std::string& words) {
  EXPECT_NE(check_support(shape).find(words), std::string::npos) << check_support(shape) << " | " << words;
}

TEST(CheckSupport, FindsNoneInTheLibrarysShapes) {
  Random random(1);
  EXPECT_EQ(check_support(Ellipsoid({1, 2, 3})), "");
  EXPECT_EQ(check_support(Superellipsoid({1, 2, 3}, 0.5, 0.7)), "");
  EXPECT_EQ(check_support(Superellipsoid({1, 2, 3}, 1.4, 1)), "");
  EXPECT_EQ(check_support(Sphere(2)), "");
  EXPECT_EQ(check_support(Capsule(2, 0.5)), "");
  EXPECT_EQ(check_support(Box({1, 2, 3})), "");
  EXPECT_EQ(check_support(Rounded<Box>(Box({1, 2, 3}), 0.3)), "");
  EXPECT_EQ(check_support(Rounded<Ellipsoid>(Ellipsoid({1, 2, 3}), 0.3)), "");
  for (int i = 0; i < 10; ++i) EXPECT_EQ(check_support(geom_test::random_polyhedron(4 + 2 * i, random)), "");
  EXPECT_EQ(check_support(Ellipsoid({1e-20, 2e-20, 3e-20})), "");
}

TEST(CheckSupport, FindsWrongRadii) {
  expect_fault({.outer = 2.9}, "beyond bounding_radius(), 2.9");
  expect_fault({.outer = std::numeric_limits<double>::quiet_NaN()}, "bounding_radius() is nan");
  expect_fault({.inner = 1.1}, "below inscribed_radius(), 1.1");
  expect_fault({.inner = 0}, "inscribed_radius() is 0");
  expect_fault({.curvature = 2}, "min_curvature_radius() is 2");
  expect_fault({.curvature = 0.9}, "below min_curvature_radius(), 0.9");
}

TEST(CheckSupport, FindsWrongHeightsAndPoints) {
  const auto height = [](const Vector3d& n, Support s) { return Support{s.height + 0.01 * n.norm(), s.point}; };
  expect_fault({.change = height}, "is at n.s = ");
  const auto longer = [](const Vector3d& n, Support s) { return Support{s.height / n.norm(), s.point}; };
  expect_fault({.change = longer}, "grows as the length of n");
  const auto nan = [](const Vector3d&, Support s) { return Support{s.height, s.point * NAN}; };
  expect_fault({.change = nan}, "is not finite");
  // A dent: points moved inwards along n.
  const auto dent = [](const Vector3d& n, Support s) {
    const double depth = n.z() > 0.99 * n.norm() ? 0.5 : 0;
    return Support{s.height - depth * n.norm(), s.point - depth * n.normalized()};
  };
  expect_fault({.change = dent}, "not convex");
  const auto mirrored = [](const Vector3d&, Support s) {
    return Support{s.height, s.point.cwiseProduct(Vector3d(1, 1, -1))};
  };
  expect_fault({.change = mirrored}, "is at n.s = ");
}

TEST(CheckSupport, FindsWrongHessians) {
  expect_fault({.change_hessian = [](const Vector3d&, Matrix3d H) { return Matrix3d(0.9 * H); }},
               "but the support point moves by");
  expect_fault({.change_hessian = [](const Vector3d&, Matrix3d) { return Matrix3d(Matrix3d::Identity()); }},
               "times n is");
  expect_fault({.change_hessian = [](const Vector3d&, Matrix3d H) { return Matrix3d(NAN * H); }}, "is not finite");
  expect_fault({.change_hessian =
                    [](const Vector3d&, Matrix3d H) {
                      H(0, 1) += 0.1;
                      return H;
                    }},
               "is not symmetric");
}

}  // namespace
}  // namespace geom
