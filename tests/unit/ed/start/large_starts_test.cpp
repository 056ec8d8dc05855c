// Starts of many bodies: a compressed box that is repeated, where the species allow it, and the order of the bodies.

#include <common/ed/start_checks.h>
#include <common/ed/states.h>

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace {

using ed_test::expect_sound;

/// Counts bodies with a copy half a box away in x, of the same orientation but another velocity.
int copies_half_a_box_away(const ed::System& system) {
  int copies = 0;
  for (const ed::Body& a : system.bodies) {
    for (const ed::Body& b : system.bodies) {
      Eigen::Vector3d d = b.position - a.position - Eigen::Vector3d(0.5 * system.box, 0, 0);
      d -= system.box * (d / system.box).array().round().matrix();
      if (d.norm() > 1e-12 * system.box) continue;
      ++copies;
      EXPECT_TRUE(a.rotation == b.rotation);
      EXPECT_FALSE(a.velocity == b.velocity);
      EXPECT_FALSE(a.angular_velocity == b.angular_velocity);
    }
  }
  return copies;
}

/// 1001 bodies, of boxes of 130 at most.
ed::System large_start(double packing_fraction) {
  ed::StartOptions options;
  options.number = 1001;
  options.packing_fraction = packing_fraction;
  options.most_compressed = 130;
  ed::System system = ed::random_start(ed::paper_species(ed_test::spheroid(0.6)), options);
  EXPECT_EQ(system.size(), 1001);
  expect_sound(system, packing_fraction);
  return system;
}

TEST(RandomStart, LargeOnesAreRepeated) {
  const ed::System system = large_start(0.3);
  // 126 bodies to each of 8 boxes, 7 of the 1008 taken out: nearly all have a copy.
  const int copies = copies_half_a_box_away(system);
  EXPECT_GE(copies, 1001 - 7);
  EXPECT_LE(copies, 1001);
}

TEST(RandomStart, DiluteOnesAreNotRepeated) {
  EXPECT_EQ(copies_half_a_box_away(large_start(0.03)), 0);
}

TEST(RandomStart, LargeMixturesAreRepeated) {
  ed::StartOptions options;
  options.packing_fraction = 0.3;
  options.most_compressed = 150;
  const std::vector<ed::Component> components = {{ed::paper_species(ed_test::spheroid(2)), 700},
                                                 {ed::uniform_species(ed_test::spheroid(0.8)), 303}};
  const ed::System system = ed::random_start(components, options);
  ASSERT_EQ(system.size(), 1003);
  for (int i = 0; i < system.size(); ++i) {
    EXPECT_EQ(system.bodies[static_cast<std::size_t>(i)].species, i < 700 ? 0 : 1) << i;
  }
  expect_sound(system, 0.3);
}

TEST(RandomStart, LargeOnesOfManySizesAreRepeated) {
  // Sizes of a Gaussian distribution, and another shape with sizes of its own, and 203 of one size.
  std::vector<ed::Component> components;
  const ed::Species rod = ed::paper_species(ed_test::spheroid(2));
  const ed::Species cube = ed::uniform_species(geom::Superellipsoid({0.9, 0.9, 0.9}, 0.5, 0.5));
  for (const double size : ed::draw_sizes(ed::SizeDistribution::gaussian, 0.1, 800, 3)) {
    components.push_back({ed::scaled(rod, size), 1});
  }
  components.push_back({ed::scaled(rod, 0.7), 203});
  for (const double size : ed::draw_sizes(ed::SizeDistribution::uniform, 0.1, 801, 4)) {
    components.push_back({ed::scaled(cube, size), 1});
  }
  ed::StartOptions options;
  options.packing_fraction = 0.3;
  options.most_compressed = 230;
  EXPECT_LE(ed::compressed_together(components, options), 230);
  const ed::System system = ed::random_start(components, options);
  ASSERT_EQ(system.size(), 1804);
  int body = 0;
  for (std::size_t k = 0; k < components.size(); ++k) {
    for (int i = 0; i < components[k].number; ++i) {
      EXPECT_EQ(system.bodies[static_cast<std::size_t>(body++)].species, static_cast<int>(k));
    }
    EXPECT_EQ(ed::volume(system.species[k].shape), ed::volume(components[k].species.shape));
  }
  expect_sound(system, 0.3);
  // Which size stands in which copy of the box is drawn: half of the larger ones in either half of the box.
  int left = 0;
  for (int i = 0; i < 800; ++i) {
    const bool large = ed::volume(system.species_of(i).shape) > ed::volume(rod.shape);
    left += large == (system.bodies[static_cast<std::size_t>(i)].position.x() < 0) ? 1 : 0;
  }
  EXPECT_NEAR(left, 400, 4 * 0.5 * std::sqrt(800.0));
}

/// Two large bodies would be eight in tiles: a tile of three times the wanted volume.
TEST(RandomStart, FewLargeAmongManySmallAreNotRepeated) {
  const ed::Species small = ed::paper_species(ed_test::spheroid(0.9));
  const std::vector<ed::Component> components = {{ed::scaled(small, 5), 2}, {small, 1000}};
  ed::StartOptions options;
  options.packing_fraction = 0.2;
  options.most_compressed = 200;
  EXPECT_EQ(ed::compressed_together(components, options), 1002);
  const std::vector<ed::Component> equal = {{small, 1002}};
  EXPECT_EQ(ed::compressed_together(equal, options), 126);
  // The small ones are inserted between the large ones, where these are already.
  options.packing_fraction = 0.1;
  EXPECT_EQ(ed::compressed_together(components, options), 0);
  EXPECT_EQ(ed::compressed_together({{ed::scaled(small, 5), 50}, {small, 1000}}, options), 50);
  options.packing_fraction = 0.01;
  EXPECT_EQ(ed::compressed_together(equal, options), 0);
}

/// Sizes of 1 to 20: the large bodies find their places first, though they are the last species, and the pairs of small
/// ones are found without looking at all bodies within reach of a large one.
TEST(RandomStart, SizesMayDifferByFactors) {
  const ed::Species small = ed::paper_species(ed_test::spheroid(0.9));
  const std::vector<ed::Component> components = {
      {small, 2500}, {ed::scaled(small, 4.5), 20}, {ed::scaled(small, 20), 3}};
  ed::StartOptions options;
  options.packing_fraction = 0.15;
  const ed::System system = ed::random_start(components, options);
  ASSERT_EQ(system.size(), 2523);
  for (int i = 0; i < system.size(); ++i) {
    EXPECT_EQ(system.bodies[static_cast<std::size_t>(i)].species, i < 2500 ? 0 : (i < 2520 ? 1 : 2)) << i;
  }
  expect_sound(system, 0.15);
  ed::Simulation simulation(system);
  simulation.run_collisions(5000);
  const ed::Counters counters = simulation.counters();
  EXPECT_LT(counters.candidate_tests, 100 * counters.neighbour_rebuilds);
}

/// Mean distance of bodies of one species whose numbers follow each other, in mean distances of neighbours.
double mean_distance_of_successors(const ed::System& system) {
  double sum = 0;
  for (int i = 1; i < system.size(); ++i) {
    const ed::Body& before = system.bodies[static_cast<std::size_t>(i - 1)];
    const ed::Body& body = system.bodies[static_cast<std::size_t>(i)];
    EXPECT_GE(body.species, before.species);
    const Eigen::Vector3d r = body.position - before.position;
    sum += (r - system.box * (r / system.box).array().round().matrix()).norm();
  }
  return sum / system.size() / (system.box / std::cbrt(static_cast<double>(system.size())));
}

/// Measures the distance of successors. In any order it would be half a box: 8 distances of neighbours.
TEST(LargeStarts, NumberNeighboursOneAfterTheOther) {
  const ed::Species species = ed::paper_species(ed_test::spheroid(0.9));
  ed::StartOptions dilute;
  dilute.number = 5000;
  dilute.packing_fraction = 0.02;
  const std::vector<ed::Component> components = {{species, 2500}, {ed::uniform_species(ed_test::spheroid(2)), 2500}};
  const ed::System mixture = ed::random_start(components, dilute);
  expect_sound(mixture, 0.02);
  // Each species has half the bodies, 2^(1/3) times as far apart.
  EXPECT_LT(mean_distance_of_successors(mixture), 2.5);
  ed::LatticeOptions lattice;
  lattice.packing_fraction = 0.3;
  EXPECT_LT(mean_distance_of_successors(ed::lattice_start({{species, 4 * 11 * 11 * 11}}, lattice)), 2);
}

TEST(RandomStart, ManySpeciesAreNotRepeated) {
  ed::StartOptions options;
  options.packing_fraction = 0.1;
  options.most_compressed = 20;
  std::vector<ed::Component> components;
  components.reserve(300);
  for (int k = 0; k < 300; ++k) components.push_back({ed::paper_species(ed_test::spheroid(1 + 0.001 * k)), 1});
  const ed::System system = ed::random_start(components, options);
  ASSERT_EQ(system.size(), 300);
  expect_sound(system, 0.1);
}

}  // namespace
