// The state after 10,000 collisions, bit for bit: an unintended change of the arithmetic shows here, however small.
//
// The bits are the same for g++ and clang++, optimised, debug and sanitizer builds: no libm function enters the loop
// and -ffp-contract=off keeps compilers from fusing. One thing does change them: Eigen itself calls fused multiply-add
// in matrix products where the instruction set has it. The hashes are therefore keyed by that, see fingerprint(). A
// build with a fingerprint that is not in the table prints its hashes and must at least agree with itself.
//
// After a change that is meant to alter the arithmetic (another order of operations, another first guess), take the new
// hashes from the failure messages and raise kArithmetic, by which checkpoints of the old arithmetic are refused.

#include <common/ed/hash.h>
#include <common/ed/states.h>
#include <common/geom/batch.h>

#include <ed/arithmetic.h>
#include <ed/ed.h>

#include <gtest/gtest.h>

#include <cinttypes>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace {

using ed_test::Inertia;
using ed_test::State;

constexpr std::uint64_t kCollisions = 10000;

/// Version of the arithmetic of the hashes below.
static_assert(ed::kArithmetic == 19);

std::string fingerprint() {
#if !defined(__x86_64__)
  return "other";
#elif defined(__FMA__)
  return "x86-64 with FMA";
#else
  return "x86-64";
#endif
}

/// Positions, rotations, velocities, angular velocities; time, collisions, virial, integrals of the angular velocity.
std::uint64_t state_hash(const ed::System& start, const ed::SimulationOptions& options = {}) {
  ed::Simulation simulation(start, options);
  simulation.run_collisions(kCollisions);
  EXPECT_EQ(simulation.counters().collisions, kCollisions);
  EXPECT_EQ(simulation.counters().overlaps, 0U);
  return ed_test::hash_of(simulation);
}

/// Lists the ways to predict pairs: one by one, and in vectors of every instruction set.
std::vector<std::optional<geom::InstructionSet>> ways_to_look() {
  std::vector<std::optional<geom::InstructionSet>> ways{std::nullopt};
  for (const geom::InstructionSet set : geom_test::instruction_sets()) ways.emplace_back(set);
  return ways;
}

std::string hexadecimal(std::uint64_t hash) {
  char text[19];
  std::snprintf(text, sizeof text, "0x%016" PRIx64, hash);
  return text;
}

void expect_hash(const std::string& what, const ed::System& start, const std::map<std::string, std::string>& golden,
                 const ed::SimulationOptions& options = {}) {
  const std::string hash = hexadecimal(state_hash(start, options));
  for (ed::SimulationOptions other = options; const auto& batches : ways_to_look()) {
    other.batches = batches;
    EXPECT_EQ(hexadecimal(state_hash(start, other)), hash) << (batches ? geom::to_string(*batches) : "one by one");
  }
  const auto known = golden.find(fingerprint());
  if (known != golden.end()) {
    EXPECT_EQ(hash, known->second) << what << ", " << fingerprint();
    return;
  }
  std::printf("%s: no golden hash for the fingerprint \"%s\"; this build has %s\n", what.c_str(), fingerprint().c_str(),
              hash.c_str());
  EXPECT_EQ(hexadecimal(state_hash(start, options)), hash) << "two runs of the same build differ";
}

void expect_hash(const State& state, const std::map<std::string, std::string>& golden,
                 const ed::SimulationOptions& options = {}) {
  expect_hash(ed_test::describe(state), ed_test::start(state), golden, options);
}

/// Bodies on a grid, thermal by libed's own random numbers: nothing that the C library computes enters. (It does in the
/// radii of superellipsoids, by powers, whose last bit depends on the processor.)
ed::System thermal_grid(const geom::Ellipsoid& shape, const Eigen::Vector3d& inertia) {
  ed::System system = ed_test::grid({shape, 1, inertia, true}, 5, 2.2);
  ed::Random random(3);
  for (ed::Body& body : system.bodies) {
    body.rotation = random.rotation();
    body.velocity = random.normal3();
    body.angular_velocity = random.normal3();
  }
  return system;
}

TEST(Golden, StateOfBiaxialEllipsoids) {
  expect_hash("biaxial ellipsoids", thermal_grid(geom::Ellipsoid({1, 0.8, 0.5}), {0.2, 0.3, 0.35}),
              {{"x86-64", "0x83f8f69f63f3c576"}});
}

/// Capsules, ellipsoids of revolution and spheres in turn.
TEST(Golden, StateOfCapsulesEllipsoidsAndSpheres) {
  ed::System system = thermal_grid(geom::Ellipsoid({0.4, 0.4, 1}), {0.2, 0.2, 0.1});
  const ed::Species ellipsoid = system.species[0];
  system.species = {ellipsoid, ellipsoid, ellipsoid};
  system.species[1].shape = geom::Capsule(0.6, 0.4);
  system.species[2].shape = geom::Sphere(0.7);
  system.species[2].inertia.setConstant(0.2);
  for (std::size_t i = 0; i < system.bodies.size(); ++i) system.bodies[i].species = static_cast<int>(i % 3);
  expect_hash("capsules, ellipsoids and spheres", system, {{"x86-64", "0xaecc30f983d422bc"}});
}

TEST(Golden, StateOfRods) {
  expect_hash({3, 0.30, 128, Inertia::paper, 7}, {{"x86-64", "0x9a5d065d279adfdc"}});
}

TEST(Golden, StateOfSpinningDiscs) {
  expect_hash({0.5, 0.30, 128, Inertia::uniform, 7}, {{"x86-64", "0x7058d74c16d59319"}});
}

TEST(Golden, StateOfRodsInOrientedBoxes) {
  ed::SimulationOptions options;
  options.neighbours = ed::Neighbours::obp;
  expect_hash({3, 0.30, 128, Inertia::paper, 7}, {{"x86-64", "0xc2ae1b4ddbd17d08"}}, options);
}

TEST(Golden, StateOfRodsInCells) {
  ed::SimulationOptions options;
  options.neighbours = ed::Neighbours::cells;
  expect_hash({2, 0.30, 128, Inertia::paper, 7}, {{"x86-64", "0xf45cf5f11a6085fa"}}, options);
}

TEST(Golden, StateOfRodsByThePapersFinder) {
  ed::SimulationOptions options;
  options.contact.finder = ed::Finder::bracketing;
  expect_hash({3, 0.30, 128, Inertia::paper, 7}, {{"x86-64", "0x0b68732d8b367788"}}, options);
}

/// Runs with one seed have one hash, runs with another seed another.
TEST(Golden, RunsOfOneBuildAreAlike) {
  const State state{3, 0.30, 128, Inertia::paper, 8};
  EXPECT_EQ(state_hash(ed_test::start(state)), state_hash(ed_test::start(state)));
  EXPECT_NE(state_hash(ed_test::start(state)), state_hash(ed_test::start({3, 0.30, 128, Inertia::paper, 9})));
}

}  // namespace
