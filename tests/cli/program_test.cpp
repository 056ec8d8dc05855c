/// The program's parts, as far as test_cli.py cannot reach them: checkpoints of states that no sound run ends in, files
/// of failed pairs, formats.

#include "checkpoint.h"
#include "config.h"
#include "config_text.h"
#include "errors.h"
#include "failure_file.h"
#include "run_record.h"
#include "suggest.h"
#include "table.h"
#include "text_file.h"

#include <ed/random.h>
#include <ed/start.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>

#include <sys/wait.h>
#include <unistd.h>

namespace {

using Eigen::Vector3d;
using hardbody::Checkpoint;
namespace fs = std::filesystem;

constexpr const char* kConfig = "[system]\nnumber = 64\npacking_fraction = 0.02\n[shape]\naspect_ratio = 2\n";

ed::System dilute_state() {
  ed::StartOptions options;
  options.number = 64;
  options.packing_fraction = 0.02;
  return ed::random_start(hardbody::parse_config(kConfig, "memory").species, options);
}

Checkpoint checkpoint_of(const ed::System& system) {
  Checkpoint checkpoint;
  checkpoint.program_version = "0.0.0";
  checkpoint.config = kConfig;
  checkpoint.cpu_features = "fma";
  checkpoint.phase = "production";
  checkpoint.time = 0.1;
  checkpoint.system = system;
  return checkpoint;
}

/// Exit status of `hardbody check` on a run directory with this checkpoint.
int check_status(const Checkpoint& checkpoint) {
  const fs::path directory = fs::path(testing::TempDir()) / ("hardbody_check_" + std::to_string(::getpid()));
  fs::create_directories(directory);
  hardbody::write_file(directory / "checkpoint.bin", hardbody::encode_checkpoint(checkpoint));
  const std::string command = std::string(HARDBODY_PROGRAM) + " check " + directory.string() + " > /dev/null 2>&1";
  const int status = std::system(command.c_str());
  fs::remove_all(directory);
  return WEXITSTATUS(status);
}

TEST(Checkpoint, ReadsBackTheSameBits) {
  const Checkpoint written = checkpoint_of(dilute_state());
  const std::string bytes = hardbody::encode_checkpoint(written);
  const Checkpoint read = hardbody::decode_checkpoint(bytes, "memory");
  EXPECT_EQ(hardbody::encode_checkpoint(read), bytes);
  EXPECT_EQ(read.config, written.config);
  EXPECT_EQ(read.phase, written.phase);
  EXPECT_EQ(read.time, written.time);
  ASSERT_EQ(read.system.size(), written.system.size());
  EXPECT_EQ(read.system.bodies[5].rotation, written.system.bodies[5].rotation);
  EXPECT_EQ(read.system.species.spins, written.system.species.spins);
}

TEST(Checkpoint, EveryTruncationAndEveryFlippedBitIsRefused) {
  ed::System small = dilute_state();
  small.bodies.resize(2);
  const std::string good = hardbody::encode_checkpoint(checkpoint_of(small));
  for (std::size_t length = 0; length < good.size(); ++length) {
    EXPECT_THROW(hardbody::decode_checkpoint(good.substr(0, length), "memory"), hardbody::InputError) << length;
  }
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::string bad = good;
    bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << (bit % 8)));
    EXPECT_THROW(hardbody::decode_checkpoint(bad, "memory"), hardbody::InputError) << bit;
  }
}

TEST(Check, SoundStatePasses) {
  EXPECT_EQ(check_status(checkpoint_of(dilute_state())), 0);
}

TEST(Check, OverlapIsFound) {
  ed::System state = dilute_state();
  // A fifth of the sum of the smallest semi-axes deep, side by side; the rest of the gas is far away on average.
  state.bodies[1] = state.bodies[0];
  state.bodies[1].position += 1.8 * state.species.shape.inscribed_radius() * state.bodies[0].rotation.col(0);
  EXPECT_EQ(check_status(checkpoint_of(state)), 1);
}

TEST(Check, CoincidingBodiesAreFound) {
  ed::System state = dilute_state();
  state.bodies[1] = state.bodies[0];
  EXPECT_EQ(check_status(checkpoint_of(state)), 1);
}

TEST(Check, NumbersThatAreNotFiniteAreFound) {
  for (const double number : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    ed::System state = dilute_state();
    state.bodies[7].velocity.y() = number;
    EXPECT_EQ(check_status(checkpoint_of(state)), 1);
    state = dilute_state();
    state.bodies[7].position.y() = number;
    EXPECT_EQ(check_status(checkpoint_of(state)), 1);
  }
}

TEST(Check, StateOfAnotherPackingFractionIsFound) {
  ed::System state = dilute_state();
  state.box *= 1.001;
  EXPECT_EQ(check_status(checkpoint_of(state)), 1);
}

TEST(Check, ImpossibleStatesAreRefused) {
  ed::System state = dilute_state();
  state.bodies[3].rotation *= 2;
  EXPECT_EQ(check_status(checkpoint_of(state)), 2);
  state = dilute_state();
  state.box = -1;
  EXPECT_EQ(check_status(checkpoint_of(state)), 2);
  state = dilute_state();
  state.bodies.clear();
  EXPECT_EQ(check_status(checkpoint_of(state)), 2);
}

TEST(Defects, OverlapsMetOnTheWayCount) {
  hardbody::RunRecord record;
  record.config = hardbody::parse_config(kConfig, "memory");
  record.equilibration.system = dilute_state();
  record.equilibration.kinetic_at_start = ed::kinetic_state(record.equilibration.system);
  hardbody::audit_record(record);
  EXPECT_TRUE(hardbody::defects(record).empty());
  record.equilibration.counters.overlaps = 1;
  EXPECT_EQ(hardbody::defects(record).size(), 1u);
  record.production.counters.overlaps = 1;
  EXPECT_EQ(hardbody::defects(record).size(), 2u);
}

TEST(FailureFile, ReadsBackTheSameBits) {
  ed::Random random(4);
  hardbody::Failure failure;
  failure.reason = "a \"reason\"";
  ed::FailedPair& pair = failure.pair;
  pair.shape_i = geom::Ellipsoid({0.7, 0.7, 1.0 / 3});
  pair.shape_j = geom::Ellipsoid({1.1, 1.1, 2.0 / 7});
  pair.time = 12.345678901234567;
  pair.i = 3;
  pair.j = 500;
  for (ed::Motion* motion : {&pair.motion_i, &pair.motion_j}) {
    motion->pose = geom::Pose(random.rotation(), random.normal3());
    motion->velocity = random.normal3();
    motion->angular_velocity = random.normal3();
    motion->inertia = {0.3, 0.3, 0.1};
    motion->time = random.uniform();
  }
  const fs::path path = fs::path(testing::TempDir()) / ("hardbody_pair_" + std::to_string(::getpid()) + ".json");
  pair.finder = ed::Finder::bracketing;
  pair.eps_d = 1.0 / 3e6;
  pair.distance = ed::FailedDistance{ed::DistanceMethod::newton5,
                                     geom::DistanceStatus::singular,
                                     pair.shape_i,
                                     pair.shape_j,
                                     geom::Pose(random.rotation(), random.normal3()),
                                     geom::Pose(random.rotation(), random.normal3()),
                                     {random.normal3(), random.normal3(), geom::SeedStatus::usable}};
  const std::string text = hardbody::failure_json(failure);
  hardbody::write_file(path, text);
  const hardbody::Failure file = hardbody::read_failure(path);
  const ed::FailedPair& read = file.pair;
  fs::remove(path);
  EXPECT_EQ(hardbody::failure_json(file), text);
  EXPECT_EQ(read.motion_j.velocity, pair.motion_j.velocity);
  EXPECT_EQ(read.motion_i.pose.position(), pair.motion_i.pose.position());
  EXPECT_EQ(file.reason, failure.reason);
  ASSERT_TRUE(read.distance.has_value());
  EXPECT_EQ(read.distance->X_WB.rotation(), pair.distance->X_WB.rotation());
  EXPECT_EQ(read.distance->seed.point_a, pair.distance->seed.point_a);
}

TEST(Config, ResolvedTextReadsBackAsTheSameConfig) {
  const std::string texts[] = {
      kConfig,
      "seed = 9007199254740993\n[system]\npacking_fraction = 0.1\n[shape]\nsemi_axes = [0.1, 0.7, 0.1]\n"
      "[dynamics]\ninertia = [0.3, 0.1, 0.3]\neps_d = 1e-9\n[equilibration]\ntime = 0.1\n[production]\n"
      "time = 1e6\n[output]\nevents = 3\ncheckpoint_every = \"1.5h\"\n",
      "[system]\npacking_fraction = 0.123456789012345678\n[shape]\naspect_ratio = 0.333333333333333333\n"
      "[dynamics]\ninertia = \"uniform\"\n"};
  for (const std::string& text : texts) {
    const hardbody::Config config = hardbody::parse_config(text, "memory");
    const std::string resolved = hardbody::resolved_text(config);
    const hardbody::Config again = hardbody::parse_config(resolved, "resolved");
    EXPECT_EQ(hardbody::resolved_text(again), resolved);
    EXPECT_EQ(again.seed, config.seed);
    EXPECT_EQ(again.packing_fraction, config.packing_fraction);
    EXPECT_EQ(again.species.shape.semi_axes(), config.species.shape.semi_axes());
    EXPECT_EQ(again.species.inertia, config.species.inertia);
    EXPECT_EQ(again.species.spins, config.species.spins);
    EXPECT_EQ(again.equilibration_time, config.equilibration_time);
    EXPECT_EQ(again.production_time, config.production_time);
  }
}

TEST(Config, PermutesAxesAndMomentsTogether) {
  const hardbody::Config config = hardbody::parse_config(
      "[system]\npacking_fraction = 0.1\n[shape]\nsemi_axes = [4, 2, 2]\n[dynamics]\ninertia = [1, 3, 3]\n", "memory");
  const Vector3d axes = config.species.shape.semi_axes();
  EXPECT_DOUBLE_EQ(axes.x(), std::cbrt(0.5));
  EXPECT_EQ(axes.x(), axes.y());
  EXPECT_DOUBLE_EQ(axes.z(), 2 * std::cbrt(0.5));
  EXPECT_EQ(config.species.inertia, Vector3d(3, 3, 1));
  EXPECT_EQ(config.true_aspect_ratio(), 2);
}

TEST(Suggest, EditDistance) {
  EXPECT_EQ(hardbody::edit_distance("", ""), 0);
  EXPECT_EQ(hardbody::edit_distance("", "abc"), 3);
  EXPECT_EQ(hardbody::edit_distance("number", "nubmer"), 1);
  EXPECT_EQ(hardbody::edit_distance("kitten", "sitting"), 3);
}

TEST(Table, EstimatesShowTwoDigitsOfTheError) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(hardbody::format_estimate({0.28871, 0.00182}), "0.2887 +- 0.0018");
  EXPECT_EQ(hardbody::format_estimate({9.6, 0.0131}), "9.600 +- 0.013");
  EXPECT_EQ(hardbody::format_estimate({9.6, 0.0996}), "9.60 +- 0.10");
  EXPECT_EQ(hardbody::format_estimate({1234.56, 12.3}), "1235 +- 12");
  EXPECT_EQ(hardbody::format_estimate({-1e-3, 2e-4}), "-0.00100 +- 0.00020");
  EXPECT_EQ(hardbody::format_estimate({1, 1e-17}), "1 +- 0");
  EXPECT_EQ(hardbody::format_estimate({0, 0}), "0 +- 0");
  EXPECT_EQ(hardbody::format_estimate({0.5, nan}), "0.5 (no error)");
  EXPECT_EQ(hardbody::format_estimate({nan, nan}), "-");
}

TEST(Check, JudgesEnergyAndMomentum) {
  const ed::System sound = dilute_state();
  EXPECT_EQ(check_status(checkpoint_of(sound)), 0);
  ed::System hot = sound;
  for (ed::Body& body : hot.bodies) body.velocity *= 1 + 1e-8;
  EXPECT_EQ(check_status(checkpoint_of(hot)), 1);
  ed::System drifting = sound;
  for (ed::Body& body : drifting.bodies) body.velocity.x() += 1e-8;
  EXPECT_EQ(check_status(checkpoint_of(drifting)), 1);
  // Spin is part of the energy.
  ed::System spinning = sound;
  spinning.species.spins = true;
  EXPECT_EQ(hardbody::conservation_defects(ed::kinetic_state(spinning), spinning).size(), 1U);
}

}  // namespace
