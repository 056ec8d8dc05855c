// Spheres, capsules, boxes, polyhedra and rounded shapes as bodies: what libed asks of each kind.

#include "common/message_of.h"

#include <ed/archive.h>
#include <ed/archive_system.h>
#include <ed/polydispersity.h>
#include <ed/system.h>
#include <ed/time_of_contact.h>

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <string>
#include <variant>
#include <vector>

namespace ed {
namespace {

using Eigen::Vector3d;
using geom::Pose;
using test_common::message_of;

geom::ConvexPolyhedron octahedron() {
  return geom::ConvexPolyhedron(
      std::vector<Vector3d>{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}});
}

std::vector<BodyShape> kinds() {
  const geom::Box box({1, 2, 0.5});
  return {geom::Sphere(0.7),
          geom::Capsule(2, 0.5),
          box,
          octahedron(),
          geom::Rounded<geom::Box>(box, 0.3),
          geom::Rounded<geom::ConvexPolyhedron>(octahedron(), 0.3),
          geom::Cylinder(2, 0.5),
          geom::Rounded<geom::Cylinder>(geom::Cylinder(0.5, 2), 0.3)};
}

/// Returns these and cones, which are not symmetric about the plane across their axis.
std::vector<BodyShape> kinds_and_cones() {
  std::vector<BodyShape> all = kinds();
  all.emplace_back(geom::Cone(2, 0.8));
  all.emplace_back(geom::Rounded<geom::Cone>(geom::Cone::in_principal_frame(2, 0.8, 0.3), 0.3));
  return all;
}

TEST(CoreKinds, AreSavedAndRestored) {
  for (const BodyShape& shape : kinds_and_cones()) {
    const std::string bytes = archive::bytes_of(shape);
    archive::Reader reader(bytes);
    BodyShape restored = geom::Sphere(1);
    reader(restored);
    reader.finish();
    EXPECT_EQ(describe(restored), describe(shape));
    EXPECT_EQ(archive::bytes_of(restored), bytes);
    EXPECT_EQ(volume(restored), volume(shape));
  }
}

TEST(CoreKinds, HaveMomentsAndSizes) {
  for (const BodyShape& shape : kinds_and_cones()) {
    const Species species = uniform_species(shape, 2);
    EXPECT_GT(species.inertia.minCoeff(), 0) << describe(shape);
    EXPECT_EQ(is_sphere(shape), std::holds_alternative<geom::Sphere>(shape)) << describe(shape);
    EXPECT_EQ(symmetry_axis(shape).has_value(), shape.index() <= 3 || shape.index() >= 8) << describe(shape);
  }
  const std::string refused = message_of([] {
    return uniform_species(
        geom::ConvexPolyhedron(std::vector<Vector3d>{{-1, -1, -1}, {2, -1, -1}, {-1, 2, -1}, {-1, -1, 3}}));
  });
  EXPECT_EQ(refused,
            "the frame of shape polyhedron of 4 vertices and 4 faces is not that of its principal axes, "
            "from its centre of mass; accepted: a shape of in_principal_frame (of a polyhedron or cone)");
}

TEST(CoreKinds, AreSimulated) {
  for (const BodyShape& shape : kinds_and_cones()) {
    EXPECT_NO_THROW(check_species(uniform_species(shape))) << describe(shape);
  }
}

/// Cylinders fall flat on a face, and a cone's apex meets it.
TEST(CoreKinds, MeetAlongTheirAxes) {
  Motion still, moving;
  moving.pose = Pose::translation({0.1, 0.2, 10});
  moving.velocity = {0, 0, -2};
  const auto time = [&](const BodyShape& a, const BodyShape& b) {
    const ContactResult hit = time_of_contact(a, still, b, moving, 10);
    EXPECT_EQ(hit.status, ContactStatus::hit) << describe(a) << ", " << describe(b);
    return hit.time;
  };
  const BodyShape disc = geom::Cylinder(0.5, 2), rod = geom::Cylinder(2, 0.5), cone = geom::Cone(2, 0.8);
  EXPECT_NEAR(time(disc, rod), 7.5 / 2, 1e-12);
  EXPECT_NEAR(time(disc, cone), (10 - 0.5 - 0.5) / 2, 1e-12);
  EXPECT_NEAR(time(geom::Box({1, 1, 1}), rod), 7.0 / 2, 1e-12);
  EXPECT_NEAR(time(disc, geom::Sphere(1)), 8.5 / 2, 1e-12);
  moving.pose = Pose::from_quaternion(0, 1, 0, 0, {0, 0, 10});  // upside down
  EXPECT_NEAR(time(disc, cone), (10 - 0.5 - 1.5) / 2, 1e-12);
  EXPECT_NEAR(time(cone, cone), (10 - 3) / 2.0, 1e-12);
}

/// Bodies that approach head on along x meet when their extents along x do.
TEST(CoreKinds, MeetHeadOn) {
  for (const BodyShape& a : kinds()) {
    for (const BodyShape& b : kinds()) {
      Motion still, moving;
      moving.pose = Pose::translation({10, 0, 0});
      moving.velocity = {-2, 0, 0};
      const ContactResult hit = time_of_contact(a, still, b, moving, 10);
      ASSERT_EQ(hit.status, ContactStatus::hit) << describe(a) << ", " << describe(b);
      const double gap = 10 - half_extents(a).x() - half_extents(b).x();
      EXPECT_NEAR(hit.time, gap / 2, 1e-12) << describe(a) << ", " << describe(b);
    }
  }
}

TEST(CoreKinds, RefuseThePapersSearch) {
  ContactOptions options;
  options.finder = Finder::bracketing;
  Motion moving;
  moving.pose = Pose::translation({9, 0, 0});
  const BodyShape box = geom::Box({1, 2, 3});
  EXPECT_EQ(
      message_of([&] { return time_of_contact(box, {}, box, moving, 1, options); }),
      "finder \"bracketing\" solves equations of smooth implicit surfaces, and shape box of half extents 1 x 2 x 3 "
      "has none; accepted: \"certified\"");
}

/// A tetrahedron is not centrally symmetric: its bounding sphere is not reached to both sides.
TEST(CoreKinds, KnowTheirCentralSymmetry) {
  EXPECT_TRUE(octahedron().centrally_symmetric());
  EXPECT_FALSE(geom::ConvexPolyhedron(std::vector<Vector3d>{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}})
                   .centrally_symmetric());
}

}  // namespace
}  // namespace ed
