// Systems that a simulation refuses.

#include <common/ed/hash.h>
#include <common/ed/states.h>
#include <common/message_of.h>
#include "common/ed/two_bodies.h"

#include <ed/ed.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using testing::HasSubstr;
using two_bodies::sphere;
using two_bodies::two_bodies;

std::string message_of(const ed::System& system) {
  return test_common::message_of([&system] { const ed::Simulation simulation(system); });
}

TEST(SimulationRefuses, BodiesThatOverlapAtTheStart) {
  const ed::Species rod = ed::paper_species(geom::Ellipsoid({1, 1, 3}));
  EXPECT_EQ(message_of(two_bodies(rod, 20, {2.1, 0, 0})), "no std::invalid_argument");
  for (const double depth : {1e-11, 1e-6, 0.5}) {
    const std::string message = message_of(two_bodies(rod, 20, {2 - depth, 0, 0}));
    EXPECT_THAT(message, HasSubstr("overlap")) << depth;
    EXPECT_THAT(message, HasSubstr("bodies 0 and 1")) << depth;
  }
  // So deep that the distance is not answered, down to bodies in one place.
  for (const double x : {0.5, 0.0}) {
    EXPECT_THAT(message_of(two_bodies(rod, 20, {x, 0, 0})), HasSubstr("1 pairs of bodies overlap"));
  }
}

TEST(SimulationRefuses, SpeedsWhoseSquaresOverflowOrUnderflow) {
  const ed::Species rod = ed::paper_species(geom::Ellipsoid({1, 1, 3}));
  const auto message = [&](double fast, double slow) {
    ed::System system = two_bodies(rod, 20, {5, 0, 0});
    system.bodies[0].velocity = {0, slow, 0};
    system.bodies[1].velocity = {0, fast, 0};
    return message_of(system);
  };
  for (const double speed : {1e155, 1.1 * ed::kMaxSpeed, 0.9 * ed::kMinSpeed, 1e-200}) {
    EXPECT_THAT(message(speed, 0), HasSubstr("velocity of the fastest body, 1, is [0, ")) << speed;
  }
  EXPECT_EQ(message(1, 1e-200), "no std::invalid_argument");
  EXPECT_EQ(message(ed::kMaxSpeed, 0), "no std::invalid_argument");
}

TEST(SimulationRefuses, ABoxTooSmallForNearestImages) {
  const ed::Species rod = ed::paper_species(geom::Ellipsoid({1, 1, 3}));
  for (const double box : {6.1, 9.0, 12.0}) {
    const std::string message = message_of(two_bodies(rod, box, {3, 0, 0}));
    EXPECT_THAT(message, HasSubstr("box")) << box;
    EXPECT_THAT(message, HasSubstr("number")) << box;
  }
}

TEST(SimulationRefuses, ABodyThatMeetsItsOwnImage) {
  // The box is shorter than the body.
  const ed::Species rod = ed::paper_species(geom::Ellipsoid({1, 1, 3}));
  EXPECT_THAT(message_of(two_bodies(rod, 5, {2.4, 0, 0})), HasSubstr("box"));
}

TEST(SimulationRefuses, BoxesAndNumbersThatAreNone) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double box : {0.0, -5.0, infinity, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(message_of(two_bodies(sphere(), box, {3, 0, 0})), HasSubstr("box")) << box;
  }
  ed::System lonely = two_bodies(sphere(), 20, {3, 0, 0});
  lonely.bodies.resize(1);
  EXPECT_THAT(message_of(lonely), HasSubstr("number"));
  lonely.bodies.clear();
  EXPECT_THAT(message_of(lonely), HasSubstr("number"));
}

TEST(SimulationRefuses, BodiesThatHaveNoAxisToSpinAboutWithoutSpin) {
  ed::Species biaxial = ed::uniform_species(geom::Ellipsoid({1, 2, 3}));
  biaxial.spins = false;
  EXPECT_THAT(message_of(two_bodies(biaxial, 40, {8, 0, 0})), HasSubstr("spins"));
  ed::Species asymmetric = ed::uniform_species(geom::Ellipsoid({1, 1, 3}));
  asymmetric.inertia.x() *= 1.1;
  asymmetric.spins = false;
  EXPECT_THAT(message_of(two_bodies(asymmetric, 40, {8, 0, 0})), HasSubstr("spins"));
}

TEST(SimulationRefuses, ExponentsBeyondThoseInMotion) {
  for (const double e : {0.24, 1.0, 1.6}) {
    const ed::Species species = ed::uniform_species(geom::Superellipsoid({1, 1, 1}, e, 1));
    const std::string message = message_of(two_bodies(species, 40, {8, 0, 0}));
    EXPECT_EQ(message.find("accepted of bodies in motion: 0.25 to 1.6") != std::string::npos, e < 0.25) << message;
  }
}

TEST(SimulationRefuses, SpeciesThatAreNotThere) {
  ed::System system = two_bodies(sphere(), 20, {3, 0, 0});
  system.bodies[1].species = 1;
  EXPECT_THAT(message_of(system), HasSubstr("species of a body is 1; accepted: 0 to 0"));
  system.bodies[1].species = -1;
  EXPECT_THAT(message_of(system), HasSubstr("species of a body is -1"));
  system.species.clear();
  EXPECT_THAT(message_of(system), HasSubstr("species: none"));
}

TEST(SimulationRefuses, MassesAndMomentsThatNoBodyHas) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()}) {
    ed::Species species = sphere();
    species.mass = bad;
    EXPECT_THAT(message_of(two_bodies(species, 20, {3, 0, 0})), HasSubstr("mass")) << bad;
    species = sphere();
    species.inertia.setConstant(bad);
    EXPECT_THAT(message_of(two_bodies(species, 20, {3, 0, 0})), HasSubstr("inertia")) << bad;
  }
  // The moment about the axis cannot exceed the sum of the others.
  ed::Species impossible = ed::uniform_species(geom::Ellipsoid({1, 1, 3}));
  impossible.inertia.z() = 3 * impossible.inertia.x();
  EXPECT_THAT(message_of(two_bodies(impossible, 20, {8, 0, 0})), HasSubstr("inertia"));
}

TEST(SimulationRefuses, NumbersThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ed::System sound = two_bodies(sphere(), 20, {3, 0, 0});
  const std::vector<std::function<void(ed::Body&)>> breakages = {
      [&](ed::Body& b) { b.position.x() = nan; }, [&](ed::Body& b) { b.velocity.y() = nan; },
      [&](ed::Body& b) { b.angular_velocity.z() = std::numeric_limits<double>::infinity(); },
      [&](ed::Body& b) { b.rotation(0, 1) = nan; }};
  for (const auto& breakage : breakages) {
    ed::System broken = sound;
    breakage(broken.bodies[1]);
    EXPECT_THAT(message_of(broken), HasSubstr("finite"));
  }
}

TEST(SimulationRefuses, RotationsThatAreNotOrthonormal) {
  ed::System system = two_bodies(sphere(), 20, {3, 0, 0});
  system.bodies[0].rotation *= 1.01;
  EXPECT_NE(message_of(system), "no std::invalid_argument");
}

}  // namespace
