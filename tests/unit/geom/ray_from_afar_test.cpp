/// ray_cast from far away: as exact at the body as from near by.

#include "common/geom/random.h"
#include "common/geom/shapes.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::Random;
using Real = long double;
using Exact = Eigen::Matrix<Real, 3, 1>;

/// Facts about a body that are known without asking it.
struct Given {
  Vector3d semi_axes;
  double e1;
  double e2;
};

/// (u^p + v^p)^(1/p), p = 2/e.
Real planar(Real u, Real v, double e) {
  const Real p = 2 / static_cast<Real>(e);
  const Real larger = std::max(std::abs(u), std::abs(v));
  if (!(larger > 0)) return 0;
  return larger * std::pow(std::pow(std::abs(u) / larger, p) + std::pow(std::abs(v) / larger, p), 1 / p);
}

/// Returns how far a point of the body's frame is from the surface, measured towards the centre: never less than the
/// distance.
Real off_the_surface(const Given& body, const Exact& x) {
  const Exact y = x.cwiseQuotient(body.semi_axes.cast<Real>());
  return std::abs(planar(planar(y.x(), y.y(), body.e2), y.z(), body.e1) - 1) * x.norm();
}

double ulp(double x) {
  return std::nextafter(std::abs(x), HUGE_VAL) - std::abs(x);
}

/// Largest coordinate of the vector from a ray to a point.
Real off_the_ray(const Vector3d& origin, const Vector3d& direction, const Vector3d& point) {
  const Exact u = direction.cast<Real>().normalized();
  const Exact way = point.cast<Real>() - origin.cast<Real>();
  return (way - u * u.dot(way)).cwiseAbs().maxCoeff();
}

/// Rays from `afar`, aimed at points within 1.1 bounding radii of the centre. Returns how many hit.
template <class Shape>
int cast_at(const Shape& shape, const Given& body, double afar, Random& random) {
  const double R = body.semi_axes.maxCoeff() * (body.e1 < 1 ? std::sqrt(3.0) : 1);
  int hits = 0;
  for (int k = 0; k < geom_test::repetitions(200); ++k) {
    const Pose X = random.pose(k % 2 == 0 ? 0.0 : R);
    const Vector3d aim = X.position() + 1.1 * random.uniform() * R * random.direction();
    const Vector3d origin = aim + afar * random.direction();
    const Vector3d direction = random.log_uniform(1e-6, 1e6) * (aim - origin).normalized();
    const RayHit hit = ray_cast(shape, X, origin, direction);
    EXPECT_NE(hit.status, RayStatus::not_converged);
    EXPECT_NE(hit.status, RayStatus::inside);
    if (hit.status != RayStatus::hit) continue;
    ++hits;
    const Exact x = X.rotation().cast<Real>().transpose() * (hit.point.cast<Real>() - X.position().cast<Real>());
    EXPECT_LE(static_cast<double>(off_the_surface(body, x)), 1e-13 * R) << afar;
    EXPECT_LE(static_cast<double>(off_the_ray(origin, direction, hit.point)), 4 * ulp(origin.cwiseAbs().maxCoeff()))
        << afar;
    EXPECT_NEAR(hit.t * direction.norm(), (hit.point - origin).norm(), 1e-15 * afar + 1e-14 * R);
    EXPECT_LE(hit.normal.dot(direction), 1e-6 * direction.norm());
  }
  return hits;
}

template <class Shape>
void expect_exact_from_afar(const Shape& shape, const Given& body) {
  for (const double afar : {30.0, 1e3, 1e7, 1e12, 1e20, 1e60}) {
    Random random(21);
    const int hits = cast_at(shape, body, afar, random);
    // From afar an aim has few digits left: from 1e20 on hardly any hits what it is aimed at.
    if (afar <= 1e12) {
      EXPECT_GE(hits, geom_test::repetitions(200) / 4) << afar;
    }
    if (testing::Test::HasFailure()) return;
  }
}

TEST(RayFromAfar, HitsEllipsoidsOnTheirSurfaceAndOnTheRay) {
  for (const Vector3d& axes : {Vector3d(1, 1, 1), Vector3d(1, 1, 3), Vector3d(0.3, 1, 2), Vector3d(3, 3, 0.3)}) {
    expect_exact_from_afar(Ellipsoid(axes), {axes, 1, 1});
    expect_exact_from_afar(Shape(Ellipsoid(axes)), {axes, 1, 1});
  }
}

TEST(RayFromAfar, HitsSuperellipsoidsAndUsersShapesOnTheirSurfaceAndOnTheRay) {
  const Vector3d axes(1.2, 0.8, 1.5);
  for (const double e : {0.2, 0.5, 1.3, 1.6}) expect_exact_from_afar(Superellipsoid(axes, e, e), {axes, e, e});
  expect_exact_from_afar(Superellipsoid(axes, 0.4, 1.5), {axes, 0.4, 1.5});
  expect_exact_from_afar(geom_test::WrappedEllipsoid{Ellipsoid(axes)}, {axes, 1, 1});
}

/// The vector along the axes from 1e7 to the tips is exact, so that everything is known.
TEST(RayFromAfar, AlongAxesMeetsTheTips) {
  const auto check = [](const auto& shape) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-1.0, 1.0}) {
        const Vector3d e = side * Vector3d::Unit(axis);
        const RayHit hit = ray_cast(shape, Pose(), 1e7 * e, -3 * e);
        ASSERT_EQ(hit.status, RayStatus::hit);
        const double tip = shape.support(e).height;
        ASSERT_NEAR(hit.point.dot(e), tip, 1e-13 * tip);
        ASSERT_NEAR(hit.t, (1e7 - tip) / 3, ulp(1e7));
      }
    }
  };
  check(Ellipsoid({1, 2, 3}));
  check(Superellipsoid({1, 2, 3}, 0.3, 0.5));
  check(Superellipsoid({1, 2, 3}, 1.5, 1.2));
}

/// A ray that passes at a ten-billionth of the size is no hit, and one as deep inside is one, from 1e7 as from near by.
TEST(RayFromAfar, TellsHitsFromMissesAsFromNearBy) {
  const auto check = [](const auto& shape) {
    const double height = shape.support(Vector3d::UnitZ()).height;
    for (const double afar : {20.0, 1e7}) {
      const auto cast = [&](double z) { return ray_cast(shape, Pose(), {-afar, 0, z}, {2, 0, 0}).status; };
      ASSERT_EQ(cast(height + 1e-10), RayStatus::missed) << afar;
      ASSERT_EQ(cast(height - 1e-10), RayStatus::hit) << afar;
    }
  };
  check(Ellipsoid({1, 2, 3}));
  check(Superellipsoid({1, 2, 3}, 0.4, 0.4));
  check(geom_test::WrappedEllipsoid{Ellipsoid({1, 1, 2})});
}

/// Lengths and origins at the ends of what is accepted.
TEST(RayFromAfar, TakesDirectionsOfAnyLengthAndOriginsOfAnyCoordinates) {
  for (const double size : {1e-49, 1.0, 1e49}) {
    const Ellipsoid shape(Vector3d(1, 1, 0.5) * size);
    for (const double afar : {1e60, 1e99}) {
      for (const double length : {1e-150, 1.0, 1e200}) {
        const RayHit hit = ray_cast(shape, Pose(), {0, 0, -afar}, {0, 0, length});
        ASSERT_EQ(hit.status, RayStatus::hit) << size << ' ' << afar << ' ' << length;
        ASSERT_NEAR(hit.point.z(), -0.5 * size, 1e-14 * size);
        ASSERT_NEAR(hit.t / ((afar - 0.5 * size) / length), 1, 1e-14);
        ASSERT_EQ(ray_cast(shape, Pose(), {2 * size, 0, -afar}, {0, 0, length}).status, RayStatus::missed);
      }
    }
  }
  // t is beyond any double.
  EXPECT_EQ(ray_cast(Ellipsoid({1, 1, 1}), Pose(), {0, 0, -1e90}, {0, 0, 1e-300}).status, RayStatus::not_converged);
}

}  // namespace
}  // namespace geom
