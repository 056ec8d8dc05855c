// Species, boxes, kinetic energies, and the audit that every claim of "no overlap" rests on.

#include <common/ed/states.h>
#include <common/message_of.h>

#include <ed/ed.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace {

using ed_test::Inertia;
using Eigen::Vector3d;
using ::testing::HasSubstr;

constexpr double kSystemRounding = 1e-14;

ed::System two_bodies(const ed::Species& species, double box, const Vector3d& r, const Eigen::Matrix3d& rotation) {
  ed::System system;
  system.box = box;
  system.species = {species};
  system.bodies.resize(2);
  system.bodies[0].position = Vector3d(0.4 * box, -0.3 * box, 0.1 * box);
  system.bodies[1].position = system.bodies[0].position + r;
  system.bodies[1].rotation = rotation;
  return system;
}

TEST(Species, OfThePaperHasTheInertiaOfItsInscribedSphereAndNoSpin) {
  for (const double X0 : {0.25, 1.0, 4.0}) {
    const geom::Ellipsoid shape = ed_test::spheroid(X0);
    const ed::Species species = ed::paper_species(shape, 2.5);
    const double a = shape.semi_axes().minCoeff();
    EXPECT_NEAR(species.inertia.x(), 0.4 * 2.5 * a * a, kSystemRounding);
    EXPECT_EQ(species.inertia.x(), species.inertia.y());
    EXPECT_EQ(species.mass, 2.5);
    EXPECT_FALSE(species.spins);
  }
}

TEST(Species, OfUniformDensityHasTheInertiaOfAnEllipsoidAndSpins) {
  const ed::Species species = ed::uniform_species(geom::Ellipsoid({1, 1, 3}), 2);
  EXPECT_NEAR(species.inertia.x(), 2 * (1.0 + 9.0) / 5, kSystemRounding);
  EXPECT_NEAR(species.inertia.y(), 2 * (1.0 + 9.0) / 5, kSystemRounding);
  EXPECT_NEAR(species.inertia.z(), 2 * 2.0 / 5, kSystemRounding);
  EXPECT_TRUE(species.spins);
}

/// Returns the moments of equal masses at +- points, whose centre is the origin.
Vector3d moments_of(const std::vector<Vector3d>& points, double mass) {
  Vector3d second = Vector3d::Zero();
  for (const Vector3d& x : points) second += x.cwiseAbs2() * (mass / static_cast<double>(points.size()));
  return Vector3d::Constant(second.sum()) - second;
}

/// Few masses, most of them on the surface: whatever a body can have is accepted.
TEST(Species, MayHaveTheMomentsOfAnyMassWithinTheBody) {
  ed::Random random(7);
  for (const ed::BodyShape& shape :
       {ed::BodyShape(geom::Ellipsoid({1, 2, 3})), ed::BodyShape(geom::Superellipsoid({1, 1, 2}, 0.3, 0.5)),
        ed::BodyShape(geom::Superellipsoid({1, 0.8, 0.6}, 1.6, 1.2))}) {
    for (int trial = 0; trial < 2000; ++trial) {
      std::vector<Vector3d> points;
      for (int k = 0; k < 3; ++k) points.push_back(ed::support(shape, random.direction()).point);
      ed::Species species{shape, 2.5, moments_of(points, 2.5)};
      if (species.inertia.minCoeff() < ed::kLeastMoment * 2.5) continue;
      EXPECT_NO_THROW(ed::check_species(species)) << species.inertia.transpose();
    }
  }
}

TEST(Species, MayNotHaveMomentsOfMassOutsideTheBody) {
  const geom::Ellipsoid flat({1, 2, 0.1});
  const auto message = [&](const Vector3d& inertia, bool spins = true,
                           const ed::BodyShape& shape = geom::Ellipsoid({1, 2, 0.1})) {
    return test_common::message_of([&] { ed::check_species({shape, 1, inertia, spins}); });
  };
  EXPECT_THAT(message({4, 1, 5}), HasSubstr("sum of at most 8"));
  // A sum that would do, but mass a distance of 1 above the plane that the body does not leave.
  EXPECT_THAT(message({2, 2, 2}), HasSubstr("I1 + I2 - I3 at most 0.02"));
  EXPECT_THAT(message({0.5, 1.6, 2}), HasSubstr("I2 + I3 - I1 at most 2,"));
  EXPECT_EQ(message({1, 0.5, 1.5}), "no std::invalid_argument");
  // Across the axis of revolution, all that counts without spin.
  const ed::BodyShape rod = geom::Ellipsoid({1, 1, 3});
  EXPECT_EQ(message({9, 9, 0}, false, rod), "no std::invalid_argument");
  EXPECT_THAT(message({9.1, 9.1, 0}, false, rod), HasSubstr("across the axis"));
  const ed::BodyShape disc = geom::Ellipsoid({3, 3, 0.1});
  EXPECT_THAT(message({5, 5, 0}, false, disc), HasSubstr("across the axis"));
}

/// A body without spin may have any moment about its axis, also none.
TEST(Species, WithoutSpinHasNoMomentAboutItsAxis) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const ed::BodyShape& shape :
       {ed::BodyShape(geom::Ellipsoid({1, 1, 2})), ed::BodyShape(geom::Superellipsoid({1, 1, 2}, 0.7, 1))}) {
    double time = 0;
    for (const double axial : {0.4, nan, 0.0, std::numeric_limits<double>::infinity()}) {
      ed::StartOptions options;
      options.packing_fraction = 0.3;
      ed::Simulation simulation(
          ed::random_start(std::vector<ed::Component>{{{shape, 1, {0.8, 0.8, axial}, false}, 64}}, options));
      simulation.run_collisions(500);
      const ed::KineticState kinetic = simulation.kinetic();
      EXPECT_NEAR(kinetic.energy(), 0.5 * (3 * 64 - 3 + 2 * 64), 1e-9);
      EXPECT_EQ(kinetic.spin_energy, 0);
      EXPECT_EQ(kinetic.axis_energy.z(), 0);
      if (time == 0) time = simulation.time();
      EXPECT_EQ(simulation.time(), time) << axial;
    }
  }
}

TEST(Box, HoldsItsPackingFraction) {
  const geom::Ellipsoid shape = ed_test::spheroid(3);
  const double box = ed::box_for(shape, 512, 0.4);
  EXPECT_NEAR(512 * 4 * std::numbers::pi / 3 / (box * box * box), 0.4, 1e-14);
  ed::System system = ed_test::grid(ed::paper_species(shape), 8, box / 8);
  EXPECT_NEAR(ed::packing_fraction(system), 0.4, 1e-14);
}

TEST(SmallestNumber, OfNoPackingFractionIsRefusedAndOfLongNeedlesIsTheLargestInt) {
  for (const double bad : {-0.1, -1e-9, 0.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(test_common::message_of([&] { return ed::smallest_number(ed_test::spheroid(3), bad); }),
                HasSubstr("packing_fraction is "));
  }
  EXPECT_EQ(ed::smallest_number(ed_test::spheroid(1e4), 5), std::numeric_limits<int>::max());  // 8.6e9
}

TEST(SmallestNumber, IsTheFirstWhoseBoxIsLargeEnough) {
  for (const double X0 : {0.2, 1.0, 3.0, 8.0}) {
    for (const double phi : {0.05, 0.3, 0.5}) {
      const geom::Ellipsoid shape = ed_test::spheroid(X0);
      const int least = ed::smallest_number(shape, phi);
      ASSERT_GE(least, 2);
      // box / 2 > 2 R + 4 delta_min, with delta_min above nothing.
      const double twice = 4 * shape.bounding_radius();
      EXPECT_GT(ed::box_for(shape, least, phi), twice);
      // The thinnest envelope in use costs 4 % of the box.
      if (least > 2) {
        EXPECT_LT(ed::box_for(shape, least - 1, phi), twice * 1.05);
      }
    }
  }
}

TEST(KineticState, SplitsTheEnergyByKindOfMotion) {
  const ed::Species species = ed::uniform_species(geom::Ellipsoid({1, 1, 3}), 2);
  ed::System system = ed_test::grid(species, 2, 20);
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  system.bodies[0].rotation = turned;
  system.bodies[0].velocity = {1, 2, -2};
  system.bodies[0].angular_velocity = turned * Vector3d(0.5, 0, 3);
  const ed::KineticState state = ed::kinetic_state(system);
  EXPECT_NEAR(state.translational_energy, 0.5 * 2 * 9, kSystemRounding);
  EXPECT_NEAR(state.rotational_energy, 0.5 * 4 * 0.25, kSystemRounding);
  EXPECT_NEAR(state.spin_energy, 0.5 * 0.8 * 9, kSystemRounding);
  EXPECT_NEAR(state.energy(), 9 + 0.5 + 3.6, 1e-13);
  EXPECT_NEAR(state.translational_kT, 2 * 9 / (3.0 * 8 - 3), kSystemRounding);
  EXPECT_NEAR(state.rotational_kT, 2 * 0.5 / (2.0 * 8), kSystemRounding);
  EXPECT_NEAR((state.momentum - Vector3d(2, 4, -4)).norm(), 0, kSystemRounding);
}

TEST(Audit, FindsTheClosestPairAndItsDistance) {
  ed::System system = ed_test::grid(ed::paper_species(geom::Ellipsoid({1, 1, 3})), 3, 7);
  system.bodies[5].position.z() += 0.25;  // towards its neighbour 3 across the face of the box: 7 - 6 - 0.25
  const ed::Audit audit = ed::audit(system);
  EXPECT_NEAR(audit.minimum_distance, 0.75, 1e-13);
  EXPECT_EQ(audit.closest_i, 3);
  EXPECT_EQ(audit.closest_j, 5);
  EXPECT_EQ(audit.overlaps, 0);
  EXPECT_EQ(audit.unanswered, 0);
  EXPECT_TRUE(audit.finite);
}

TEST(Audit, SeesOverlapsBeyondRoundingWhereverTheyAre) {
  // Crossed rods touch at the distance of their two short semi-axes; through the faces of the box as well.
  const ed::Species species = ed::paper_species(geom::Ellipsoid({1, 1, 3}));
  const Eigen::Matrix3d crossed = Eigen::AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitX()).toRotationMatrix();
  constexpr double kBox = 15;
  for (const double sign : {-1.0, 1.0}) {
    for (const double image : {-1.0, 0.0, 1.0}) {
      for (const double gap : {-1e-3, -1e-9, -1e-11, 1e-11, 1e-3}) {
        const Vector3d r(sign * (2 + gap) + image * kBox, 0, -image * kBox);
        const ed::Audit audit = ed::audit(two_bodies(species, kBox, r, crossed));
        // Coordinates of order 10 are rounded to 1e-15 each.
        EXPECT_NEAR(audit.minimum_distance, gap, 2e-14);
        EXPECT_EQ(audit.overlaps, gap < -ed::kAuditOverlap ? 1 : 0) << gap;
      }
    }
  }
}

TEST(Audit, TriesAllImagesInASmallBox) {
  // The rod is apart from the nearest image of the ball, and its tip overlaps the next one.
  const Eigen::Matrix3d along = Eigen::AngleAxisd(std::atan2(0.6, 1.4), Vector3d::UnitZ()).toRotationMatrix();
  ed::System system{
      .box = 2.5,
      .species = {ed::uniform_species(geom::Ellipsoid({1.6, 0.1, 0.1})), ed::uniform_species(geom::Sphere(0.1))},
      .bodies = std::vector<ed::Body>(2)};
  system.bodies[0].rotation = along;
  system.bodies[1].position = {1.4, 0.6, 0};
  system.bodies[1].species = 1;
  const ed::Audit audit = ed::audit(system);
  EXPECT_EQ(audit.overlaps, 1);
  const geom::DistanceResult depth = geom::distance(geom::Ellipsoid({1.6, 0.1, 0.1}), geom::Pose(along, {0, 0, 0}),
                                                    geom::Sphere(0.1), geom::Pose::translation({1.4, 0.6, 0}));
  EXPECT_NEAR(audit.minimum_distance, depth.distance, 1e-13);
  EXPECT_LT(depth.distance, -0.05);

  // A sphere and its own images: three pairs of neighbours along the edges, none along the diagonals of faces.
  system = {.box = 1.5, .species = {ed::uniform_species(geom::Sphere(1))}, .bodies = std::vector<ed::Body>(1)};
  const ed::Audit alone = ed::audit(system);
  EXPECT_EQ(alone.overlaps, 3);
  EXPECT_NEAR(alone.minimum_distance, -0.5, 1e-13);
  EXPECT_EQ(alone.closest_i, 0);
  EXPECT_EQ(alone.closest_j, 0);

  for (const double none : {0.0, std::numeric_limits<double>::quiet_NaN()}) {
    system.box = none;
    EXPECT_FALSE(ed::audit(system).finite);
  }
  system.box = 0.2;
  EXPECT_THROW(static_cast<void>(ed::audit(system)), std::invalid_argument);
}

TEST(Audit, CountsOverlapsInTheSizeOfTheBodies) {
  for (const double length : {1e-3, 1.0, 1e3}) {
    const ed::Species species = ed::paper_species(geom::Ellipsoid(length * Vector3d(1, 1, 3)));
    for (const double gap : {-1e-13, -1e-11}) {
      const Vector3d r(length * (2 + gap), 0, 0);
      const ed::Audit audit = ed::audit(two_bodies(species, 15 * length, r, Eigen::Matrix3d::Identity()));
      EXPECT_EQ(audit.overlaps, gap < -1e-12 ? 1 : 0) << length << " " << gap;
    }
  }
}

TEST(Audit, SharesTheRoundingOfTheStateOnly) {
  const ed::Species species = ed::paper_species(geom::Ellipsoid({1, 1, 3}));
  const ed::Audit audit = ed::audit(two_bodies(species, 15, Vector3d(2, 0, 0), Eigen::Matrix3d::Identity()));
  EXPECT_EQ(audit.overlaps, 0);
  EXPECT_NEAR(audit.minimum_distance, 0, 1e-14);
}

TEST(Audit, SaysWhenAStateIsNotFinite) {
  const ed::Species species = ed::paper_species(geom::Ellipsoid({1, 1, 3}));
  const ed::System sound = two_bodies(species, 15, Vector3d(5, 0, 0), Eigen::Matrix3d::Identity());
  EXPECT_TRUE(ed::audit(sound).finite);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ed::System broken = sound;
  broken.bodies[1].position.y() = nan;
  EXPECT_FALSE(ed::audit(broken).finite);
  broken = sound;
  broken.bodies[0].rotation(1, 2) = nan;
  EXPECT_FALSE(ed::audit(broken).finite);
  broken = sound;
  broken.bodies[1].velocity.z() = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(ed::audit(broken).finite);
  broken = sound;
  broken.bodies[0].angular_velocity.x() = nan;
  EXPECT_FALSE(ed::audit(broken).finite);
}

}  // namespace
