/// Derivatives of the distance: against differences of it for all kinds of pairs, in known cases, and where there are
/// none.

#include "common/full_form.h"
#include "common/geom/core_pairs.h"
#include "common/geom/differences.h"
#include "common/geom/random.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace geom {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::Answers;
using geom_test::Random;
using Vector12 = Eigen::Matrix<double, 12, 1>;

Shape drawn(const std::string& kind, Random& random) {
  const auto length = [&] { return random.log_uniform(0.5, 2); };
  const auto lengths = [&] { return Vector3d(length(), length(), length()); };
  if (kind == "sphere") return Sphere(length());
  if (kind == "ellipsoid") return Ellipsoid(lengths());
  if (kind == "superellipsoid") return Superellipsoid(lengths(), random.uniform(0.5, 1.2), random.uniform(0.5, 1.2));
  if (kind == "capsule") return Capsule(length(), length());
  if (kind == "box") return Box(lengths());
  if (kind == "polyhedron") return geom_test::random_polyhedron(12, random);
  if (kind == "cylinder") return Cylinder(length(), length());
  if (kind == "cone") return Cone(2 * length(), length());
  if (kind == "rounded box") return Rounded<Box>(Box(lengths()), random.uniform(0.1, 0.5));
  if (kind == "rounded polyhedron") {
    return Rounded<ConvexPolyhedron>(geom_test::random_polyhedron(12, random), random.uniform(0.1, 0.5));
  }
  if (kind == "rounded cylinder") return Rounded<Cylinder>(Cylinder(length(), length()), random.uniform(0.1, 0.5));
  return Rounded<Cone>(Cone(2 * length(), length()), random.uniform(0.1, 0.5));
}

struct Tally {
  int pairs = 0, twice = 0, compared = 0;
  double first = 0, second = 0, others = 0, identities = 0;
};

/// Compares the derivatives of a pair with differences along some motions.
template <class A, class B>
void compare(const A& a, const Pose& X_WA, const B& b, const Pose& X_WB, Random& random, Tally& tally) {
  DistanceResult at;
  const DistanceDerivatives d = distance_derivatives(a, X_WA, b, X_WB, {}, &at);
  ++tally.pairs;
  if (!d.twice()) return;
  ++tally.twice;
  ASSERT_TRUE(d.gradient.allFinite() && d.hessian.allFinite() && d.normal.allFinite());
  const double scale = std::max(1.0, d.hessian.norm());
  // The gradient by B's position is the normal; the points differ by distance times normal.
  const Vector3d n = d.gradient.segment<3>(6);
  const double of_normal = (d.hessian.middleRows<3>(6) - d.normal).norm();
  const double of_points = (d.point_b - d.point_a - n * d.gradient.transpose() - at.distance * d.normal).norm();
  tally.identities = std::max(tally.identities, std::max(of_normal, of_points) / scale);
  for (int direction = 0; direction < 3; ++direction) {
    Vector12 v;
    for (double& entry : v) entry = random.uniform(-1, 1);
    v.normalize();
    const auto along = [&](double t) {
      const Vector12 x = t * v;
      return geom_test::answers_of(distance(a, geom_test::displaced(X_WA, x.segment<3>(0), x.segment<3>(3)), b,
                                            geom_test::displaced(X_WB, x.segment<3>(6), x.segment<3>(9)),
                                            {.start = at.normal}));
    };
    const geom_test::Differences by = geom_test::differences(along);
    // Near a change of features, where curvature radii are small, and where distances are right to 1e-12 only, no step
    // serves.
    if (!(by.second.error <= 2e-8 * scale) || !(by.first.error <= 1e-10)) continue;
    ++tally.compared;
    tally.first = std::max(tally.first, std::abs(d.gradient.dot(v) - by.first.value[0]));
    tally.second = std::max(tally.second, std::abs(v.dot(d.hessian * v) - by.second.value[0]) / scale);
    if (!(by.others.error <= 2e-8 * scale)) continue;
    Eigen::Matrix<double, 9, 1> others;
    others << d.normal * v, d.point_a * v, d.point_b * v;
    tally.others = std::max(tally.others, (others - by.others.value).norm() / scale);
  }
}

void expect_good(const Tally& tally, double share) {
  EXPECT_GE(tally.twice, share * tally.pairs);
  EXPECT_GE(2 * tally.compared, 3 * tally.twice);  // of 3 directions
  EXPECT_LE(tally.first, 1e-9);
  EXPECT_LE(tally.second, 1e-7);
  EXPECT_LE(tally.identities, 1e-9);
  // Normals of answers of ellipsoids and superellipsoids are accurate to the root of rounding only.
  EXPECT_LE(tally.others, 1e-3);
}

void print(const std::string& name, const Tally& tally) {
  std::printf(
      "%-40s %6d pairs, %6d twice, %6d compared: gradient %.1e, Hessian %.1e, normal and points %.1e, identities "
      "%.1e\n",
      name.c_str(), tally.pairs, tally.twice, tally.compared, tally.first, tally.second, tally.others,
      tally.identities);
}

const std::vector<std::string> kKinds = {"sphere",      "ellipsoid",          "superellipsoid",   "capsule",
                                         "box",         "polyhedron",         "cylinder",         "cone",
                                         "rounded box", "rounded polyhedron", "rounded cylinder", "rounded cone"};

int draws() {
  return full_form() ? 10000 : geom_test::repetitions(300);
}

/// Kinds of bodies, beside bodies of every kind.
class Kinds : public testing::TestWithParam<std::string> {};

TEST_P(Kinds, HaveTheDifferencesApart) {
  Random random(1 + static_cast<std::uint64_t>(std::find(kKinds.begin(), kKinds.end(), GetParam()) - kKinds.begin()));
  Tally tally;
  for (int i = 0; i < draws(); ++i) {
    const Shape a = drawn(GetParam(), random);
    const Shape b = drawn(kKinds[static_cast<std::size_t>(i) % kKinds.size()], random);
    const Pose X_WA = random.pose(1.0);
    const double reach = bounding_radius(a) + bounding_radius(b);
    const Pose X_WB = random.pose(X_WA.position() + random.uniform(1, 1.5) * reach * random.direction());
    compare(a, X_WA, b, X_WB, random, tally);
  }
  print(GetParam() + ", apart", tally);
  expect_good(tally, 0.98);
}

TEST_P(Kinds, HaveTheDifferencesInOverlap) {
  Random random(101 + static_cast<std::uint64_t>(std::find(kKinds.begin(), kKinds.end(), GetParam()) - kKinds.begin()));
  Tally tally;
  for (int i = 0; i < draws() / 3; ++i) {
    const Shape a = drawn(GetParam(), random);
    const Shape b = drawn(kKinds[static_cast<std::size_t>(i) % kKinds.size()], random);
    const Pose X_WA = random.pose(1.0);
    const Pose X_WB = random.pose(X_WA.position() + 2 * bounding_radius(a) * random.direction());
    const DistanceResult apart = distance(a, X_WA, b, X_WB);
    const double depth = random.uniform(0.01, 0.2) * std::min(inscribed_radius(a), inscribed_radius(b));
    const Pose meeting(X_WB.rotation(), X_WB.position() - (apart.distance + depth) * apart.normal);
    compare(a, X_WA, b, meeting, random, tally);
  }
  print(GetParam() + ", overlapping", tally);
  expect_good(tally, 0.8);
}

INSTANTIATE_TEST_SUITE_P(All, Kinds, testing::ValuesIn(kKinds), [](const auto& named) {
  std::string name = named.param;
  name.erase(std::remove(name.begin(), name.end(), ' '), name.end());
  return name;
});

TEST(Derivatives, OfHalfSpacesHaveTheDifferences) {
  Random random(2);
  Tally tally;
  for (int i = 0; i < draws(); ++i) {
    const HalfSpace plane(random.direction(), random.uniform(-1, 1));
    const Ellipsoid ball({1, 2, 0.7});
    const Box box({1, 2, 0.7});
    compare(plane, random.pose(1.0), ball, random.pose(4.0), random, tally);
    compare(box, random.pose(4.0), plane, random.pose(1.0), random, tally);
  }
  print("half-spaces", tally);
  expect_good(tally, 0.99);
}

TEST(Derivatives, OfPlacedAndAnyShapesHaveTheDifferences) {
  Random random(3);
  Tally tally;
  for (int i = 0; i < draws() / 3; ++i) {
    const Placed<Cone> a(Cone(2, 0.8), random.pose(2.0));
    const AnyConvex b(Placed<Rounded<Ellipsoid>>(Rounded<Ellipsoid>(Ellipsoid({1, 2, 0.7}), 0.3), random.pose(2.0)));
    const Pose X_WA = random.pose(1.0);
    const Pose X_WB = random.pose(X_WA.position() + 9 * random.direction());
    compare(a, X_WA, b, X_WB, random, tally);
  }
  print("placed and any", tally);
  expect_good(tally, 0.98);
}

/// The distance of balls is |r| less both radii.
TEST(Derivatives, OfBallsAreKnown) {
  const Pose X_WB = Pose::translation({3, 4, 12});
  const DistanceDerivatives d = distance_derivatives(Sphere(1), Pose(), Ellipsoid({2, 2, 2}), X_WB);
  ASSERT_TRUE(d.twice());
  const Vector3d n = X_WB.position() / 13;
  const Matrix3d H = (Matrix3d::Identity() - n * n.transpose()) / 13;
  EXPECT_NEAR(d.stiffness, 13, 1e-13);
  EXPECT_LE((d.gradient.segment<3>(6) - n).norm(), 1e-15);
  EXPECT_LE(d.gradient.segment<3>(9).norm(), 1e-15);
  EXPECT_LE((Matrix3d(d.hessian.block<3, 3>(6, 6)) - H).norm(), 1e-15);
  EXPECT_LE(d.hessian.block(9, 0, 3, 12).norm(), 1e-14);
  EXPECT_LE((Matrix3d(d.normal.block<3, 3>(0, 6)) - H).norm(), 1e-15);
}

/// Motions of both bodies together change nothing.
TEST(Derivatives, DoNotChangeWithBothBodies) {
  Random random(4);
  for (int i = 0; i < 1000; ++i) {
    const Shape a = drawn(kKinds[static_cast<std::size_t>(i) % kKinds.size()], random);
    const Shape b = drawn(kKinds[static_cast<std::size_t>(i / 12) % kKinds.size()], random);
    const Pose X_WA = random.pose(1.0);
    const Pose X_WB = random.pose(X_WA.position() + 7 * random.direction());
    const DistanceDerivatives d = distance_derivatives(a, X_WA, b, X_WB);
    if (!d.twice()) continue;
    const double scale = 1e-11 * std::max(1.0, d.hessian.norm());
    EXPECT_LE((d.gradient.segment<3>(0) + d.gradient.segment<3>(6)).norm(), 1e-14);
    EXPECT_LE((d.hessian - d.hessian.transpose()).norm(), 0);
    EXPECT_LE((d.hessian.middleRows<3>(0) + d.hessian.middleRows<3>(6)).norm(), scale);
    const Vector3d r = X_WB.position() - X_WA.position();
    const Vector3d turned = d.gradient.segment<3>(3) + d.gradient.segment<3>(9) + r.cross(d.gradient.segment<3>(6));
    EXPECT_LE(turned.norm(), 1e-12);
  }
}

TEST(Derivatives, AreDeclinedWhereThereAreNone) {
  const auto status = [](const auto& a, const Pose& X_WA, const auto& b, const Pose& X_WB) {
    const DistanceDerivatives d = distance_derivatives(a, X_WA, b, X_WB);
    EXPECT_EQ(d.hessian.allFinite(), d.twice());
    EXPECT_EQ(d.gradient.allFinite(), d.twice() || d.status == DerivativeStatus::once);
    return d.status;
  };
  const Box cube({1, 1, 1});
  const auto at = [](double x, double y, double z) { return Pose::translation({x, y, z}); };
  EXPECT_EQ(status(cube, Pose(), cube, at(3, 0.3, 0.2)), DerivativeStatus::by_position);    // face on face
  EXPECT_EQ(status(cube, Pose(), cube, at(1.9, 0.3, 0.2)), DerivativeStatus::by_position);  // in each other
  EXPECT_EQ(status(cube, Pose(), cube, at(3, 3, 0.2)), DerivativeStatus::by_position);      // parallel edges
  EXPECT_EQ(status(cube, Pose(), cube, at(3, 3, 3)), DerivativeStatus::twice);              // vertex to vertex
  EXPECT_EQ(status(cube, Pose(), cube, Pose()), DerivativeStatus::none);                    // six normals
  EXPECT_EQ(status(Sphere(1), Pose(), Sphere(2), Pose()), DerivativeStatus::none);          // all normals
  EXPECT_EQ(status(cube, Pose(), Sphere(0.5), at(3, 1, 0)), DerivativeStatus::once);        // end of a face
  EXPECT_EQ(status(cube, Pose(), Sphere(0.5), at(3, 0.9, 0)), DerivativeStatus::twice);
  EXPECT_EQ(status(Capsule(1, 0.5), Pose(), Sphere(0.5), at(3, 0, 1)), DerivativeStatus::once);  // end of the side
  EXPECT_EQ(status(Capsule(1, 0.5), Pose(), Capsule(1, 0.5), at(3, 0, 0)), DerivativeStatus::by_position);
  EXPECT_EQ(status(Cylinder(1, 1), Pose(), Cylinder(1, 1), at(0, 0.5, 3)), DerivativeStatus::by_position);
  EXPECT_EQ(status(Cylinder(1, 1), Pose(), Sphere(1), at(0.5, 0, 3)), DerivativeStatus::twice);
  EXPECT_EQ(status(HalfSpace(), Pose(), cube, at(0, 0, 3)), DerivativeStatus::by_position);
  EXPECT_EQ(status(Ellipsoid({1, 1, 1}), Pose(), Ellipsoid({1, 1, 1}), Pose()), DerivativeStatus::none);
}

TEST(Derivatives, AreDeclinedForAnswersOfOtherPairs) {
  const DistanceResult at = distance(Sphere(1), Pose(), Sphere(1), Pose::translation({3, 0, 0}));
  const DistanceDerivatives none = distance_derivatives(Sphere(1), Pose(), Sphere(1), Pose(), DistanceResult());
  EXPECT_EQ(none.status, DerivativeStatus::no_distance);
  EXPECT_FALSE(none.gradient.allFinite());
  const auto refused = [](const auto& a, const auto& b, const Pose& X_WB, const DistanceResult& answer) {
    const DistanceDerivatives d = distance_derivatives(a, Pose(), b, X_WB, answer);
    return d.status == DerivativeStatus::no_distance && !d.gradient.allFinite();
  };
  EXPECT_TRUE(refused(Sphere(1), Sphere(1), Pose::translation({5, 0, 0}), at));
  EXPECT_TRUE(refused(Ellipsoid({1.1, 2, 3}), Ellipsoid({1.1, 2, 3}), Pose::translation({3, 0, 0}), at));
  EXPECT_TRUE(refused(Box({1, 1, 1}), Sphere(1), Pose::translation({0, 4, 0}), at));
  EXPECT_TRUE(refused(HalfSpace(), Sphere(1), Pose::translation({3, 0, 0}), at));
  const Pose X_WB = Pose::translation({3, 0.2, 0.1});
  const DistanceResult sound = distance(Box({1, 1, 1}), Pose(), Sphere(0.5), X_WB);
  EXPECT_FALSE(refused(Box({1, 1, 1}), Sphere(0.5), X_WB, sound));
  for (const double factor : {0.0, 2.0, std::numeric_limits<double>::quiet_NaN()}) {
    DistanceResult bad = sound;
    bad.normal *= factor;
    EXPECT_TRUE(refused(Box({1, 1, 1}), Sphere(0.5), X_WB, bad)) << factor;
  }
  DistanceResult bad = sound;
  bad.distance = 77;
  EXPECT_TRUE(refused(Box({1, 1, 1}), Sphere(0.5), X_WB, bad));
  bad = sound;
  bad.point_b.y() += 0.1;
  EXPECT_TRUE(refused(Box({1, 1, 1}), Sphere(0.5), X_WB, bad));
}

/// A ball deep under the ridge of a roof: both sides are as near, however flat the roof is.
TEST(Derivatives, AreDeclinedUnderARidge) {
  for (const double degrees : {0.1, 0.5, 2.0, 10.0, 16.0, 25.0}) {
    const double fall = std::tan(degrees * 3.14159265358979 / 360);
    std::vector<Vector3d> points;
    for (const double y : {-1.0, 1.0}) {
      for (const double x : {-1.0, 0.0, 1.0}) points.emplace_back(x, y, 1 - fall * std::abs(x));
      for (const double x : {-1.0, 1.0}) points.emplace_back(x, y, -2);
    }
    const Shape roof = ConvexPolyhedron(points);
    const auto status = [&](double x) {
      return distance_derivatives(roof, Pose(), Shape(Sphere(0.05)), Pose::translation({x, 0, 0.7})).status;
    };
    EXPECT_EQ(status(0), DerivativeStatus::none) << degrees;
    EXPECT_EQ(status(0.01), DerivativeStatus::twice) << degrees;
  }
}

TEST(Derivatives, OfDeepOverlapsExistWhereTheSearchIsCoarse) {
  // The depth of the bodies moved apart by the trial is certain to 2e-9 only.
  const Pose X_WB =
      Pose::normalized_quaternion(0.7576046316842783, 0.12153757954718945, -0.5370199336365591, -0.35053306503855697,
                                  {-0.05455689324963755, -0.8924080623426848, 0.1730753138034499});
  EXPECT_EQ(distance_derivatives(Cylinder(0.7, 0.5), Pose(), Box({0.6, 0.8, 1}), X_WB).status, DerivativeStatus::twice);
}

TEST(Derivatives, OfManyPairsAreThoseOfEach) {
  Random random(5);
  std::vector<Shape> shapes;
  std::vector<Pose> poses;
  for (int i = 0; i < 24; ++i) {
    shapes.push_back(drawn(kKinds[static_cast<std::size_t>(i) % kKinds.size()], random));
    poses.push_back(random.pose(8.0));
  }
  const std::vector<Shape> one = {Ellipsoid({1, 2, 3})};
  const std::vector<Pose> here = {Pose()};
  std::vector<DistanceResult> at(shapes.size());
  (void)distance_batch(one, here, shapes, poses, at);
  std::vector<DistanceDerivatives> found(shapes.size());
  std::size_t twice = 0;
  const std::size_t counted = distance_derivatives_batch(one, here, shapes, poses, at, found);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const DistanceDerivatives d = distance_derivatives(one[0], here[0], shapes[i], poses[i], at[i]);
    EXPECT_EQ(d.status, found[i].status);
    if (!d.twice()) continue;
    ++twice;
    EXPECT_EQ(d.hessian, found[i].hessian);
  }
  EXPECT_EQ(counted, twice);
  at.pop_back();
  EXPECT_THROW((void)distance_derivatives_batch(one, here, shapes, poses, at, found), std::invalid_argument);
}

}  // namespace
}  // namespace geom
