// Contact times of spheres, capsules, boxes, polyhedra, rounded ones and users' shapes, as ConvexGap finds them,
// against conservative advancement (convex_flights.h). Pairs of one kind and of two.

#include <common/finder/convex_flights.h>
#include <common/geom/shapes.h>

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

namespace finder_test {
namespace {

class HalvedGap : public FlightGap {
 public:
  explicit HalvedGap(const Flight& f) : FlightGap(f) { curvature_share_ = 0.5; }
};

std::vector<Vector3d> box_directions() {
  return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 1, 1}, {1, 1, 1}};
}

std::vector<Vector3d> icosahedron() {
  const double g = std::numbers::phi;
  std::vector<Vector3d> points;
  for (const double s : {-1.0, 1.0}) {
    for (const double t : {-g, g}) {
      points.emplace_back(0, s, t);
      points.emplace_back(s, t, 0);
      points.emplace_back(t, 0, s);
    }
  }
  return points;
}

geom::ConvexPolyhedron random_hull(Random& random) {
  while (true) {
    std::vector<Vector3d> points;
    const int count = 6 + static_cast<int>(random.uniform() * 10);
    for (int k = 0; k < count; ++k) points.push_back(random.direction());
    try {
      return geom::ConvexPolyhedron::in_principal_frame(points);
    } catch (const std::invalid_argument&) {
      continue;
    }
  }
}

/// Returns a body that a user tells of; `exact`: libgeom's shape, which the reference asks.
template <class Told, class Exact>
TestBody users(const std::string& kind, const Told& told, const Exact& exact, const std::vector<Vector3d>& directions) {
  TestBody body = test_body(kind, told, exact.volume(), exact.inertia(1), directions);
  CustomShape::Properties properties;
  properties.volume = exact.volume();
  body.exact = ConvexBody(CustomShape(exact, properties));
  return body;
}

TestBody spherocylinder(Random& random) {
  const geom::Capsule s(random.log_uniform(0.1, 3), random.uniform(0.2, 1));
  return users("spherocylinder", geom_test::Spherocylinder{s.half_length(), s.radius()}, s,
               {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
}

TestBody box(Random& random) {
  const geom::Box s({random.uniform(0.3, 1), random.uniform(0.3, 1), random.uniform(0.3, 1)});
  return test_body("box", s, s.volume(), s.inertia(1), box_directions());
}

TestBody cube(Random& /*random*/) {
  const geom::Box s({0.5, 0.5, 0.5});
  return test_body("cube", s, s.volume(), s.inertia(1), box_directions());
}

TestBody rounded_cube(Random& random) {
  const double r = random.log_uniform(0.01, 0.5);
  const geom::Rounded<geom::Box> s(geom::Box({0.5, 0.5, 0.5}), r);
  const double volume = 1 + 6 * r + std::numbers::pi * r * r * (3 + 4 * r / 3);
  return test_body("rounded cube", s, volume, s.inner().inertia(1), box_directions());
}

std::vector<Vector3d> face_directions(const geom::ConvexPolyhedron& s) {
  std::vector<Vector3d> directions;
  for (const auto& face : s.faces()) {
    const Vector3d a = s.vertex(face[0]), b = s.vertex(face[1]), c = s.vertex(face[2]);
    directions.emplace_back((b - a).cross(c - a).normalized());
  }
  return directions;
}

TestBody polyhedron(Random& random) {
  const auto s = random.coin() ? random_hull(random) : geom::ConvexPolyhedron::in_principal_frame(icosahedron());
  return test_body("polyhedron", s, s.volume(), s.inertia(1), face_directions(s));
}

TestBody users_box(Random& random) {
  const geom::Box s({random.uniform(0.3, 1), random.uniform(0.3, 1), random.uniform(0.3, 1)});
  return users("user's box", geom_test::PlainPolytope<geom::Box>{s}, s, box_directions());
}

TestBody users_polyhedron(Random& random) {
  const auto s = random_hull(random);
  return users("user's polyhedron", geom_test::PlainPolytope<geom::ConvexPolyhedron>{s}, s, face_directions(s));
}

TestBody ellipsoid(Random& random) {
  const geom::Ellipsoid s({random.uniform(0.4, 1), random.uniform(0.4, 1), random.uniform(0.4, 1)});
  return test_body("ellipsoid", geom_test::WrappedEllipsoid{s}, s.volume(), s.inertia(1), {{1, 0, 0}, {0, 0, 1}});
}

std::vector<Vector3d> rim_directions() {
  return {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {1, 0, 1}};
}

TestBody cylinder(Random& random) {
  const geom::Cylinder s(random.log_uniform(0.1, 2), random.uniform(0.2, 1));
  return test_body("cylinder", s, s.volume(), s.inertia(1), rim_directions());
}

TestBody cone(Random& random) {
  const geom::Cone s(random.log_uniform(0.3, 3), random.uniform(0.3, 1));
  std::vector<Vector3d> directions = rim_directions();
  directions.emplace_back(s.height(), 0, s.radius());  // across the side
  return test_body("cone", s, s.volume(), s.inertia(1), directions);
}

TestBody rounded_cylinder(Random& random) {
  const geom::Cylinder inner(random.log_uniform(0.1, 2), random.uniform(0.2, 1));
  const geom::Rounded<geom::Cylinder> s(inner, random.log_uniform(0.01, 0.5));
  return test_body("rounded cylinder", s, s.volume(), s.inertia(1), rim_directions());
}

TEST(ConvexContact, Spheres) {
  expect_none_missed(search("spheres", sphere, sphere));
}
TEST(ConvexContact, Capsules) {
  expect_none_missed(search("capsules", capsule, capsule));
}
TEST(ConvexContact, Boxes) {
  expect_none_missed(search("boxes", box, box));
}
TEST(ConvexContact, Cubes) {
  expect_none_missed(search("cubes", cube, cube));
}
TEST(ConvexContact, RoundedCubes) {
  expect_none_missed(search("rounded cubes", rounded_cube, rounded_cube));
}
TEST(ConvexContact, Polyhedra) {
  expect_none_missed(search("polyhedra", polyhedron, polyhedron));
}
TEST(ConvexContact, Cylinders) {
  expect_none_missed(search("cylinders", cylinder, cylinder));
}
TEST(ConvexContact, Cones) {
  expect_none_missed(search("cones", cone, cone));
}
TEST(ConvexContact, RoundedCylinders) {
  expect_none_missed(search("rounded cylinders", rounded_cylinder, rounded_cylinder));
}
TEST(ConvexContact, UsersSpherocylinders) {
  expect_none_missed(search("users' spherocylinders", spherocylinder, spherocylinder));
}
TEST(ConvexContact, UsersEllipsoids) {
  expect_none_missed(search("users' ellipsoids", ellipsoid, ellipsoid));
}

TEST(ConvexContact, UsersBoxes) {
  expect_none_missed(search("users' boxes", users_box, users_box));
}
TEST(ConvexContact, UsersPolyhedra) {
  expect_none_missed(search("users' polyhedra", users_polyhedron, users_polyhedron));
}

TEST(ConvexContact, MixedKinds) {
  const std::array<Draw, 13> draws{sphere,       capsule,    spherocylinder,  box,  cube,
                                   rounded_cube, polyhedron, cylinder,        cone, rounded_cylinder,
                                   ellipsoid,    users_box,  users_polyhedron};
  const auto any = [&](Random& random) {
    return draws[static_cast<std::size_t>(random.uniform() * draws.size())](random);
  };
  expect_none_missed(search("mixed kinds", any, any));
}

TEST(ConvexContact, IsMissedWithHalfTheCurvature) {
  const auto any = [](Random& random) { return random.coin() ? cube(random) : capsule(random); };
  const Tally tally = search<HalvedGap>("half the curvature", any, any);
  EXPECT_GT(tally.missed + tally.late, 0);
}

}  // namespace
}  // namespace finder_test
