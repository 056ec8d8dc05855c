// The state after 10,000 collisions, bit for bit: an unintended change of the arithmetic shows here, however small.
//
// The bits are the same for g++ and clang++, optimised, debug and sanitizer builds: no libm function enters the loop
// and -ffp-contract=off keeps compilers from fusing. One thing does change them: Eigen itself calls fused multiply-add
// in matrix products where the instruction set has it. The hashes are therefore keyed by that, see fingerprint(). A
// build with a fingerprint that is not in the table prints its hashes and must at least agree with itself.
//
// After a change that is meant to alter the arithmetic (another order of operations, another first guess), take the new
// hashes from the failure messages.

#include <common/ed_hash.h>
#include <common/ed_states.h>

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <cinttypes>
#include <cstdio>
#include <map>
#include <string>

namespace {

using ed_test::Inertia;
using ed_test::State;

constexpr std::uint64_t kCollisions = 10000;

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
std::uint64_t state_hash(const State& state, const ed::SimulationOptions& options = {}) {
  ed::Simulation simulation(ed_test::start(state), options);
  simulation.run_collisions(kCollisions);
  EXPECT_EQ(simulation.counters().collisions, kCollisions);
  EXPECT_EQ(simulation.counters().overlaps, 0U);
  return ed_test::hash_of(simulation);
}

std::string hexadecimal(std::uint64_t hash) {
  char text[19];
  std::snprintf(text, sizeof text, "0x%016" PRIx64, hash);
  return text;
}

void expect_hash(const State& state, const std::map<std::string, std::string>& golden,
                 const ed::SimulationOptions& options = {}) {
  const std::string hash = hexadecimal(state_hash(state, options));
  const auto known = golden.find(fingerprint());
  if (known != golden.end()) {
    EXPECT_EQ(hash, known->second) << ed_test::describe(state) << ", " << fingerprint();
    return;
  }
  std::printf("%s: no golden hash for the fingerprint \"%s\"; this build has %s\n", ed_test::describe(state).c_str(),
              fingerprint().c_str(), hash.c_str());
  EXPECT_EQ(hexadecimal(state_hash(state, options)), hash) << "two runs of the same build differ";
}

TEST(Golden, StateOfRods) {
  expect_hash({3, 0.30, 128, Inertia::paper, 7}, {{"x86-64", "0x8ca085c60eb3f144"}});
}

TEST(Golden, StateOfSpinningDiscs) {
  expect_hash({0.5, 0.30, 128, Inertia::uniform, 7}, {{"x86-64", "0x9edf168a0e913608"}});
}

TEST(Golden, StateOfRodsInOrientedBoxes) {
  ed::SimulationOptions options;
  options.neighbours = ed::Neighbours::obp;
  expect_hash({3, 0.30, 128, Inertia::paper, 7}, {{"x86-64", "0xa7642827322361c8"}}, options);
}

TEST(Golden, StateOfRodsInCells) {
  ed::SimulationOptions options;
  options.neighbours = ed::Neighbours::cells;
  expect_hash({2, 0.30, 128, Inertia::paper, 7}, {{"x86-64", "0x1a3901e597054083"}}, options);
}

TEST(Golden, StateOfRodsByThePapersFinder) {
  ed::SimulationOptions options;
  options.contact.finder = ed::Finder::bracketing;
  expect_hash({3, 0.30, 128, Inertia::paper, 7}, {{"x86-64", "0xad28a896b570bb23"}}, options);
}

/// What the hash is made of depends on the seed and on nothing else.
TEST(Golden, RunsOfOneBuildAreAlike) {
  const State state{3, 0.30, 128, Inertia::paper, 8};
  EXPECT_EQ(state_hash(state), state_hash(state));
  EXPECT_NE(state_hash(state), state_hash({3, 0.30, 128, Inertia::paper, 9}));
}

}  // namespace
