// Nothing in a run depends on the units: bodies a power of two as large or as heavy make the same run to the last bit,
// from the random start on, with lengths, times and moments in proportion.

#include <common/ed/families.h>

#include <ed/ed.h>

#include <geom/ellipsoid.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace {

/// Factors by which everything is multiplied. The mass is a power of four, so that times are scaled by a power of two.
struct Scale {
  double length;
  double mass;
  double time() const { return length * std::sqrt(mass); }
  double velocity() const { return 1 / std::sqrt(mass); }
};

constexpr std::uint64_t kCollisions = 1000;
/// Collisions of runs that differ by rounding, which the dynamics multiplies: some six a body.
constexpr std::uint64_t kFewCollisions = 300;
constexpr double kPacking = 0.35;

ed::BodyShape scaled(const ed::BodyShape& shape, double length) {
  if (const auto* s = std::get_if<geom::Superellipsoid>(&shape)) {
    return geom::Superellipsoid(length * s->semi_axes(), s->e1(), s->e2());
  }
  return geom::Ellipsoid(length * std::get<geom::Ellipsoid>(shape).semi_axes());
}

ed::System scaled(ed::System system, const Scale& scale) {
  system.box *= scale.length;
  for (ed::Species& species : system.species) {
    species.shape = scaled(species.shape, scale.length);
    species.mass *= scale.mass;
    species.inertia *= scale.mass * scale.length * scale.length;
  }
  for (ed::Body& body : system.bodies) {
    body.position *= scale.length;
    body.velocity *= scale.velocity();
    body.angular_velocity /= scale.time();
  }
  return system;
}

ed::Simulation run(const ed::System& system, const ed::SimulationOptions& options, std::uint64_t collisions) {
  ed::Simulation simulation(system, options);
  simulation.record_collisions(collisions);
  simulation.run_collisions(collisions);
  return simulation;
}

/// `allowed`: of times, relative to the largest; 0: the same bits in everything.
void expect_scaled(const ed::Simulation& one, const ed::Simulation& other, const Scale& scale, double allowed) {
  ASSERT_EQ(one.collisions().size(), allowed > 0 ? kFewCollisions : kCollisions);
  ASSERT_EQ(other.collisions().size(), one.collisions().size());
  for (std::size_t k = 0; k < one.collisions().size(); ++k) {
    const ed::Collision& a = one.collisions()[k];
    const ed::Collision& b = other.collisions()[k];
    ASSERT_TRUE(a.i == b.i && a.j == b.j) << "collision " << k;
    ASSERT_LE(std::abs(b.time / scale.time() - a.time), allowed * one.time()) << "collision " << k;
  }
  EXPECT_EQ(ed::audit(other.system()).overlaps, 0);
  if (allowed > 0) return;
  EXPECT_EQ(one.virial() * scale.time(), other.virial());
  EXPECT_EQ(one.counters().predictions, other.counters().predictions);
  EXPECT_EQ(one.counters().evaluations, other.counters().evaluations);
  const ed::System a = scaled(one.system(), scale);
  const ed::System b = other.system();
  for (int i = 0; i < a.size(); ++i) {
    const ed::Body& body = a.bodies[static_cast<std::size_t>(i)];
    const ed::Body& image = b.bodies[static_cast<std::size_t>(i)];
    ASSERT_EQ(body.position, image.position) << i;
    ASSERT_EQ(body.rotation, image.rotation) << i;
    ASSERT_EQ(body.velocity, image.velocity) << i;
    ASSERT_EQ(body.angular_velocity, image.angular_velocity) << i;
  }
}

void expect_the_same_run(const ed_test::Family& family, double allowed, const ed::SimulationOptions& options = {}) {
  const ed::System system = ed_test::start(family, kPacking);
  const std::uint64_t collisions = allowed > 0 ? kFewCollisions : kCollisions;
  const ed::Simulation one = run(system, options, collisions);
  for (const Scale& scale : {Scale{0x1p-9, 1}, Scale{0x1p9, 1}, Scale{1, 0x1p-18}, Scale{1, 0x1p18},
                             Scale{0x1p-30, 0x1p-60}, Scale{0x1p40, 0x1p20}}) {
    SCOPED_TRACE(family.name + ", lengths times " + std::to_string(scale.length) + ", masses times " +
                 std::to_string(scale.mass));
    const ed::System other = scaled(system, scale);
    EXPECT_EQ(ed::time_unit(other), ed::time_unit(system) * scale.time());
    expect_scaled(one, run(other, options, collisions), scale, allowed);
  }
}

ed_test::Family rods() {
  return {"rods", {{ed::paper_species(ed_test::ellipsoid({1, 1, 3})), 96}}};
}

TEST(Scale, OfEllipsoidsOfRevolution) {
  expect_the_same_run(rods(), 0);
  expect_the_same_run({"spinning discs", {{ed::uniform_species(ed_test::ellipsoid({3, 3, 1})), 96}}}, 0);
}

TEST(Scale, OfTheNeighbourLists) {
  for (const ed::Neighbours neighbours : {ed::Neighbours::obp, ed::Neighbours::cells}) {
    ed::SimulationOptions options;
    options.neighbours = neighbours;
    expect_the_same_run({"short rods", {{ed::paper_species(ed_test::ellipsoid({1, 1, 1.5})), 250}}}, 0, options);
  }
}

/// Logarithms and exponentials of support functions are rounded differently at other lengths.
TEST(Scale, OfGeneralBodies) {
  for (const ed_test::Family& family : ed_test::families(96)) expect_the_same_run(family, 1e-9);
}

/// The random start, which is compressed. Enlarged only: cbrt() of what is below 1 may round otherwise.
TEST(Scale, OfStarts) {
  const ed_test::Family family = rods();
  const ed::System one = ed_test::start(family, kPacking);
  for (const Scale& scale : {Scale{0x1p9, 1}, Scale{0x1p21, 0x1p20}, Scale{1, 0x1p-20}}) {
    ed_test::Family large = family;
    for (ed::Component& component : large.components) {
      ed::Species& species = component.species;
      species.shape = scaled(species.shape, scale.length);
      species.mass *= scale.mass;
      species.inertia *= scale.mass * scale.length * scale.length;
    }
    const ed::System start = ed_test::start(large, kPacking);
    const ed::System wanted = scaled(one, scale);
    ASSERT_EQ(start.box, wanted.box);
    for (std::size_t i = 0; i < start.bodies.size(); ++i) {
      ASSERT_EQ(start.bodies[i].position, wanted.bodies[i].position) << scale.length << " " << scale.mass;
      ASSERT_EQ(start.bodies[i].rotation, wanted.bodies[i].rotation) << scale.length << " " << scale.mass;
    }
  }
}

/// A few very light and small bodies among many do not make epochs of their own.
TEST(Scale, OfAFewFastBodies) {
  const ed::Species large = ed::uniform_species(geom::Ellipsoid(Eigen::Vector3d::Ones()));
  const ed::Species small = ed::uniform_species(geom::Ellipsoid(Eigen::Vector3d::Constant(0.05)), 1e-6);
  ed::StartOptions options;
  options.packing_fraction = 0.2;
  ed::Simulation simulation(ed::random_start(std::vector<ed::Component>{{large, 196}, {small, 4}}, options));
  simulation.run_collisions(20000);
  EXPECT_EQ(simulation.counters().overlaps, 0U);
  EXPECT_EQ(ed::audit(simulation.system()).overlaps, 0);
}

TEST(Scale, TimeUnitIsThatOfTheMeanBody) {
  const ed::Species sphere = ed::uniform_species(geom::Ellipsoid(Eigen::Vector3d::Ones()));
  ed::Species large = ed::uniform_species(geom::Ellipsoid(Eigen::Vector3d::Constant(7)), 16);
  EXPECT_DOUBLE_EQ(ed::thermal_time(large), 28);
  EXPECT_EQ(ed::time_unit(std::vector<ed::Component>{{sphere, 3}}), 1);
  EXPECT_EQ(ed::time_unit(std::vector<ed::Component>{{sphere, 1}, {large, 1}}), 16);  // the mean is 14.5
  EXPECT_EQ(ed::time_unit(std::vector<ed::Component>{{sphere, 99}, {large, 1}}), 1);  // 1.27
}

/// A library user's bodies, in SI units: 400 nm in water's place, at room temperature.
TEST(Scale, OfBodiesAtAnotherTemperature) {
  constexpr double kT = 4.11e-21;
  ed::System system = ed_test::start(rods(), kPacking);
  const Scale scale{2e-7, 3.4e-17};
  system.box *= scale.length;
  system.species[0].shape = scaled(system.species[0].shape, scale.length);
  system.species[0].mass *= scale.mass;
  system.species[0].inertia *= scale.mass * scale.length * scale.length;
  for (ed::Body& body : system.bodies) {
    body.position *= scale.length;
    body.velocity *= std::sqrt(kT / scale.mass);
    body.angular_velocity *= std::sqrt(kT / scale.mass) / scale.length;
  }
  ed::Simulation simulation(system);
  simulation.run_collisions(20000);
  EXPECT_EQ(simulation.counters().collisions, 20000U);
  EXPECT_EQ(simulation.counters().overlaps, 0U);
  EXPECT_EQ(ed::audit(simulation.system()).overlaps, 0);
  EXPECT_NEAR(simulation.kinetic().energy() / ed::kinetic_state(system).energy(), 1, 1e-12);
}

}  // namespace
