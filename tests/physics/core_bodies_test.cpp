// Spheres, capsules, boxes, polyhedra, cylinders, cones and rounded ones in the event loop, alone and mixed: no
// overlap, energy and momentum are kept, every kind of neighbour list gives the same collisions, and a restored run is
// the undisturbed one. HARDBODY_FULL=1: 1,000,000 collisions of each.

#include <common/ed/all_pairs.h>
#include <common/ed/same_collisions.h>
#include <common/full_form.h>
#include <common/geom/shapes.h>

#include <ed/ed.h>

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

namespace {

using Eigen::Vector3d;

struct Fluid {
  std::string name;
  std::vector<ed::Component> components;
};

geom::ConvexPolyhedron solid(const char* name) {
  return geom::ConvexPolyhedron::in_principal_frame(geom::solid_vertices(name));
}

/// Returns fluids of 48 bodies, or of several times as many.
std::vector<Fluid> fluids(int copies = 1) {
  const geom::Box cube({0.5, 0.5, 0.5});
  const auto alone = [copies](const std::string& name, const ed::BodyShape& shape) {
    return Fluid{name, {{ed::uniform_species(shape), 48 * copies}}};
  };
  return {
      alone("spheres", geom::Sphere(0.6)),
      alone("capsules", geom::Capsule(0.8, 0.4)),
      alone("cubes", cube),
      alone("dodecahedra", solid("dodecahedron")),
      alone("rounded boxes", geom::Rounded<geom::Box>(geom::Box({0.6, 0.5, 0.3}), 0.05)),
      alone("rounded octahedra", geom::Rounded<geom::ConvexPolyhedron>(solid("octahedron"), 0.1)),
      alone("cylinders", geom::Cylinder(0.6, 0.4)),
      alone("discs", geom::Cylinder(0.25, 0.5)),
      alone("cones", geom::Cone(0.9, 0.5)),
      alone("rounded cylinders", geom::Rounded<geom::Cylinder>(geom::Cylinder(0.5, 0.3), 0.1)),
      {"cylinders, cones, cubes and spheres",
       {{ed::uniform_species(geom::Cylinder(0.5, 0.3)), 12 * copies},
        {ed::uniform_species(geom::Cone(0.9, 0.5)), 12 * copies},
        {ed::uniform_species(cube), 12 * copies},
        {ed::uniform_species(geom::Sphere(0.5)), 12 * copies}}},
      {"spheres of two sizes",
       {{ed::uniform_species(geom::Sphere(0.6)), 24 * copies}, {ed::uniform_species(geom::Sphere(0.4)), 24 * copies}}},
      {"spheres, capsules and cubes",
       {{ed::uniform_species(geom::Sphere(0.5)), 16 * copies},
        {ed::uniform_species(geom::Capsule(0.6, 0.4)), 16 * copies},
        {ed::uniform_species(cube), 16 * copies}}},
      {"capsules and spheres",
       {{ed::uniform_species(geom::Capsule(0.6, 0.4)), 24 * copies},
        {ed::uniform_species(geom::Sphere(0.3)), 24 * copies}}},
      {"capsules, prolate and oblate ellipsoids of revolution, and spheres",
       {{ed::uniform_species(geom::Capsule(0.6, 0.4)), 16 * copies},
        {ed::uniform_species(geom::Ellipsoid({0.4, 0.4, 0.9})), 12 * copies},
        {ed::uniform_species(geom::Ellipsoid({0.7, 0.7, 0.4})), 12 * copies},
        {ed::uniform_species(geom::Sphere(0.5)), 8 * copies}}},
      {"capsules and ellipsoids",
       {{ed::uniform_species(geom::Capsule(0.6, 0.4)), 24 * copies},
        {ed::uniform_species(geom::Ellipsoid({0.4, 0.6, 0.8})), 24 * copies}}}};
}

ed::System start(const Fluid& fluid) {
  ed::StartOptions options;
  options.packing_fraction = 0.3;
  return ed::random_start(fluid.components, options);
}

/// Returns the least distance of all pairs, by geom::distance, which answers them all.
double least_distance(const ed::System& system) {
  double least = std::numeric_limits<double>::infinity();
  ed_test::for_each_pair(system, [&](const ed::Body& a, const ed::Body& b, const Vector3d& r) {
    const auto shape = [&](const ed::Body& body) {
      return system.species[static_cast<std::size_t>(body.species)].shape;
    };
    const geom::DistanceResult d =
        ed::distance(shape(a), geom::Pose(a.rotation, Vector3d(Vector3d::Zero())), shape(b), geom::Pose(b.rotation, r));
    EXPECT_NE(d.status, geom::DistanceStatus::not_converged);
    // Where the points match, another normal at most has a larger gap; deeper overlaps are certified to 1e-9.
    least = std::min(least, d.residual < 1e-13 ? d.distance : d.distance + d.error_bound);
  });
  return least;
}

TEST(CoreBodies, KeepEnergyAndDoNotOverlap) {
  const int collisions = full_form() ? 1000000 : 5000;
  for (const Fluid& fluid : fluids()) {
    ed::Simulation simulation(start(fluid));
    const ed::KineticState before = simulation.kinetic();
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 10; ++k) {
      simulation.run_collisions(static_cast<std::uint64_t>(collisions) / 10);
      least = std::min(least, least_distance(simulation.system()));
    }
    const ed::KineticState after = simulation.kinetic();
    const double drift = std::abs(after.energy() / before.energy() - 1);
    const double momentum = (after.momentum - before.momentum).norm();
    std::printf("%s: least distance %.1e, energy %.1e, momentum %.1e\n", fluid.name.c_str(), least, drift, momentum);
    EXPECT_EQ(simulation.counters().overlaps, 0U) << fluid.name;
    EXPECT_EQ(simulation.counters().declined, 0U) << fluid.name;
    EXPECT_GE(least, -1e-12) << fluid.name;
    EXPECT_LE(drift, 1e-11) << fluid.name;
    EXPECT_LE(momentum, 1e-10) << fluid.name;
  }
}

// Lists change the order in which pairs are searched, and how far: not the collisions.
TEST(CoreBodies, CollideTheSameWithEveryList) {
  constexpr std::size_t kCollisions = 500;  // some five a body
  for (const Fluid& fluid : fluids(4)) {
    const ed::System system = start(fluid);
    const auto reference = ed_test::first_collisions(system, {}, kCollisions);
    const bool cones = fluid.name.find("cones") != std::string::npos;  // take too little room for boxes around them
    for (const auto neighbours : {ed::Neighbours::obp, ed::Neighbours::cells}) {
      if (cones && neighbours == ed::Neighbours::obp) continue;
      ed::SimulationOptions options;
      options.neighbours = neighbours;
      ed_test::expect_same(reference, ed_test::first_collisions(system, options, kCollisions),
                           fluid.name + ", " + ed::to_string(neighbours));
    }
  }
}

// Contacts never turn a sphere: after any number of collisions, and of epochs of the clock, it is where free rotation
// has brought it, beside capsules too.
TEST(CoreBodies, SpheresTurnFreely) {
  for (const bool alone : {true, false}) {
    std::vector<ed::Component> components{{ed::uniform_species(geom::Sphere(0.5)), 40}};
    if (!alone) components.push_back({ed::uniform_species(geom::Capsule(0.6, 0.4)), 40});
    ed::StartOptions options;
    options.packing_fraction = 0.3;
    const ed::System before = ed::random_start(components, options);
    ed::Simulation simulation(before);
    simulation.run_collisions(2000);
    simulation = ed::Simulation::restore(simulation.save(), before.species);
    simulation.run_until(simulation.time() + 40);
    const ed::System after = simulation.system();
    for (std::size_t k = 0; k < 40; ++k) {
      const Vector3d& omega = before.bodies[k].angular_velocity;
      const Eigen::AngleAxisd turned(omega.norm() * simulation.time(), omega.normalized());
      EXPECT_LE((after.bodies[k].rotation - turned * before.bodies[k].rotation).norm(), 1e-11) << k;
      EXPECT_LE((after.bodies[k].angular_velocity - omega).norm(), 1e-13 * omega.norm()) << k;
    }
    ed::Snapshot snapshot;
    simulation.sample(snapshot);
    for (std::size_t k = 0; k < 40; ++k) {
      EXPECT_LE((snapshot.axis[k] - after.bodies[k].rotation.col(2)).norm(), 1e-12) << k;
    }
  }
}

// The same capsules by their support function alone, in the engine of bodies of any shape.
TEST(CoreBodies, CapsulesCollideAsUsersSpherocylindersDo) {
  const geom::Capsule capsule(0.8, 0.4);
  for (const bool spins : {true, false}) {
    ed::Species species = ed::uniform_species(capsule);
    species.spins = spins;
    ed::StartOptions options;
    options.number = 64;
    options.packing_fraction = 0.3;
    const ed::System system = ed::random_start(species, options);
    ed::System users = system;
    const geom_test::Spherocylinder shape{capsule.half_length(), capsule.radius()};
    users.species[0].shape = ed::CustomShape(shape, {"spherocylinder", capsule.volume(), 2, true});
    constexpr std::size_t kCollisions = 300;
    ed_test::expect_same(ed_test::first_collisions(system, {}, kCollisions),
                         ed_test::first_collisions(users, {}, kCollisions), spins ? "spinning" : "without spin");
  }
}

TEST(CoreBodies, ThinCapsulesDoNotSeemToOverlap) {
  for (const double aspect_ratio : {1000.0, 9000.0}) {
    ed::StartOptions options;
    options.number = 100;
    options.packing_fraction = 4.5 / (aspect_ratio * aspect_ratio);
    ed::Simulation simulation(ed::random_start(ed::uniform_species(geom::Capsule(aspect_ratio, 1)), options));
    simulation.run_collisions(3000);
    EXPECT_EQ(simulation.counters().overlaps, 0U) << aspect_ratio;
    EXPECT_EQ(simulation.counters().declined, 0U) << aspect_ratio;
  }
}

TEST(CoreBodies, SpheresCollideTheSameWithEveryFinder) {
  for (const Fluid& fluid : fluids()) {
    if (fluid.name.find("spheres") != 0 || fluid.name.find("capsules") != std::string::npos) continue;
    const ed::System system = start(fluid);
    ed::SimulationOptions options;
    options.contact.finder = ed::Finder::bracketing;
    constexpr std::size_t kCollisions = 300;
    ed_test::expect_same(ed_test::first_collisions(system, {}, kCollisions),
                         ed_test::first_collisions(system, options, kCollisions), fluid.name + ", bracketing");
  }
}

TEST(CoreBodies, AreRestoredToTheSameBytes) {
  for (const Fluid& fluid : fluids()) {
    const ed::System system = start(fluid);
    ed::Simulation undisturbed(system);
    ed::Simulation again(system);
    undisturbed.run_collisions(500);
    again.run_collisions(500);
    again = ed::Simulation::restore(again.save(), system.species);
    undisturbed.run_collisions(500);
    again.run_collisions(500);
    EXPECT_EQ(again.save(), undisturbed.save()) << fluid.name;
  }
}

}  // namespace
