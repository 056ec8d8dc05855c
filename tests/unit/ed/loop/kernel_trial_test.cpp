// The trial of instruction sets: which it chooses, and that it changes no bit of a run.

#include "loop/parts/kernel_trial.h"

#include <common/ed/states.h>

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

namespace {

using ed::internal::KernelTrial;
using geom::InstructionSet;

/// Runs a trial in pieces of some collisions each, where a collision takes so long with each set.
InstructionSet chosen(double seconds_avx512, double seconds_avx2, std::uint64_t piece, double disturbance = 0) {
  KernelTrial trial(InstructionSet::avx512, InstructionSet::avx2);
  for (int k = 0; !trial.over(); ++k) {
    const std::uint64_t done = std::min(piece, trial.left());
    const bool avx512 = trial.current() == InstructionSet::avx512;
    const double disturbed = k % 5 == 0 ? disturbance : 0;
    trial.add(done, static_cast<double>(done) * (avx512 ? seconds_avx512 : seconds_avx2) + disturbed);
  }
  return trial.current();
}

TEST(KernelTrial, ChoosesTheFasterSet) {
  for (const std::uint64_t piece : {1U, 7U, 500U, 1000U}) {
    EXPECT_EQ(chosen(4e-6, 5e-6, piece), InstructionSet::avx512);
    EXPECT_EQ(chosen(5e-6, 4e-6, piece), InstructionSet::avx2);
    EXPECT_EQ(chosen(5e-6, 5e-6, piece), InstructionSet::avx512) << "the usual one where none is faster";
  }
}

TEST(KernelTrial, IsNotMisledBySlicesThatOthersDisturb) {
  EXPECT_EQ(chosen(4e-6, 5e-6, 500, 1), InstructionSet::avx512);
  EXPECT_EQ(chosen(5e-6, 4e-6, 500, 1), InstructionSet::avx2);
}

TEST(KernelTrial, AlternatesAndIsShort) {
  KernelTrial trial(InstructionSet::avx2, InstructionSet::avx512);
  EXPECT_EQ(trial.current(), InstructionSet::avx2);
  trial.add(KernelTrial::kSlice, 1);
  EXPECT_EQ(trial.current(), InstructionSet::avx512);
  trial.add(KernelTrial::kSlice - 1, 1);
  EXPECT_EQ(trial.current(), InstructionSet::avx512);
  EXPECT_EQ(trial.left(), 1U);
  trial.add(1, 1);
  EXPECT_EQ(trial.current(), InstructionSet::avx2);
  EXPECT_FALSE(trial.over());
}

TEST(KernelTrial, ChangesNoBitOfARun) {
  const ed::System start = ed_test::start({.number = 64});
  ed::SimulationOptions fixed;
  fixed.batches = geom::batch_instruction_set();
  ed::Simulation with_trial(start);
  ed::Simulation without(start, fixed);
  // Several slices with both sets, in pieces that are no slices, then to an end that is given by time.
  for (int k = 0; k < 40; ++k) {
    with_trial.run_collisions(131);
    without.run_collisions(131);
    ASSERT_EQ(with_trial.time(), without.time()) << k;
  }
  EXPECT_TRUE(with_trial.run_until(without.time() + 20));
  EXPECT_TRUE(without.run_until(without.time() + 20));
  EXPECT_EQ(with_trial.counters().collisions, without.counters().collisions);
  EXPECT_GT(without.counters().collisions, 2 * KernelTrial::kSlice * KernelTrial::kSlices);
  EXPECT_EQ(with_trial.save(), without.save());
}

}  // namespace
