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
#include "version.h"

#include <ed/random.h>
#include <ed/simulation.h>
#include <ed/start.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

namespace {

using Eigen::Vector3d;
using hardbody::Checkpoint;
namespace fs = std::filesystem;

constexpr const char* kConfig = "[system]\nnumber = 64\npacking_fraction = 0.02\n[shape]\naspect_ratio = 2\n";

ed::System dilute_state() {
  ed::StartOptions options;
  options.packing_fraction = 0.02;
  return ed::random_start(hardbody::parse_config(kConfig, "memory").components(), options);
}

/// Two different semi-axes, three, exponents, sizes, masses.
constexpr const char* kMixture =
    "[system]\npacking_fraction = 0.02\n"
    "[[species]]\nsemi_axes = [0.5, 0.5, 1.5]\nnumber = 20\n"
    "[[species]]\nsemi_axes = [0.5, 0.7, 1]\nnumber = 20\nmass = 3\n"
    "[[species]]\nkind = \"superellipsoid\"\nsemi_axes = [0.6, 0.7, 0.8]\nexponents = [0.5, 1.2]\nnumber = 24\n"
    "sizes = \"gaussian\"\nwidth = 0.1\n";

ed::System mixed_state() {
  ed::StartOptions options;
  options.packing_fraction = 0.02;
  return ed::random_start(hardbody::parse_config(kMixture, "memory").components(), options);
}

Checkpoint checkpoint_of(const ed::System& system, const char* config = kConfig) {
  Checkpoint checkpoint;
  checkpoint.program_version = "0.0.0";
  checkpoint.config = config;
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
  EXPECT_EQ(read.system.species.at(0).spins, written.system.species.at(0).spins);
}

/// With all that a run needs to go on, but for observables.
Checkpoint with_a_run(Checkpoint checkpoint) {
  const ed::Simulation simulation(dilute_state(), hardbody::parse_config(kConfig, "memory").simulation_options());
  checkpoint.system = simulation.system();
  hardbody::RunState& run = checkpoint.run.emplace();
  run.simulation = simulation.save();
  run.observables = std::string("not read here");
  run.production.planned = 10;
  run.events = {3, 77};
  run.equilibration.kinetic_at_start = ed::kinetic_state(checkpoint.system);
  run.equilibration.failures.resize(2);
  run.equilibration.failures[1].distance.emplace();
  run.monitor = "nor is this";
  checkpoint.upkeep.resumed = 5;
  return checkpoint;
}

TEST(Checkpoint, ARunReadsBackTheSameBits) {
  const Checkpoint written = with_a_run(checkpoint_of(dilute_state()));
  const std::string bytes = hardbody::encode_checkpoint(written);
  const Checkpoint read = hardbody::decode_checkpoint(bytes, "memory");
  EXPECT_EQ(hardbody::encode_checkpoint(read), bytes);
  ASSERT_TRUE(read.run.has_value());
  EXPECT_EQ(read.run->simulation.bytes(), written.run->simulation.bytes());
  EXPECT_EQ(read.run->events.bytes, 77U);
  EXPECT_EQ(read.upkeep.resumed, 5U);
}

/// All numbers of a state.
std::vector<double> numbers_of(const ed::System& system) {
  std::vector<double> all;
  for (const ed::Body& body : system.bodies) {
    for (const Vector3d& v : {body.position, body.velocity, body.angular_velocity})
      all.insert(all.end(), v.begin(), v.end());
    for (const double x : body.rotation.reshaped()) all.push_back(x);
  }
  return all;
}

TEST(Checkpoint, AMixtureGoesOnWithTheSameBits) {
  const ed::System written = mixed_state();
  ASSERT_EQ(written.species.size(), 26U);
  const std::string bytes = hardbody::encode_checkpoint(checkpoint_of(written, kMixture));
  const ed::System read = hardbody::decode_checkpoint(bytes, "memory").system;
  EXPECT_EQ(hardbody::encode_checkpoint(checkpoint_of(read, kMixture)), bytes);
  ed::Simulation before(written);
  ed::Simulation after(read);
  before.run_until(2);
  after.run_until(2);
  EXPECT_GT(after.counters().collisions, 20U);
  EXPECT_EQ(after.counters().collisions, before.counters().collisions);
  EXPECT_EQ(numbers_of(after.system()), numbers_of(before.system()));
}

/// Written by the last version that knew ellipsoids of revolution only: 8 of X0 = 2, uniform, at 0.01.
TEST(Checkpoint, TheOldFormatIsRead) {
  const Checkpoint old = hardbody::read_checkpoint(HARDBODY_OLD_CHECKPOINT);
  ASSERT_EQ(old.system.size(), 8);
  EXPECT_EQ(ed::describe(old.system.species.at(0).shape), "ellipsoid 0.793701 x 0.793701 x 1.5874");
  EXPECT_TRUE(old.system.species.at(0).spins);
  EXPECT_EQ(old.time, 0.1);
  EXPECT_EQ(check_status(old), 0);  // written again, in the new format
}

TEST(Checkpoint, EveryTruncationAndEveryFlippedBitIsRefused) {
  ed::System small = mixed_state();
  small.bodies.resize(2);
  small.species.resize(2);
  small.bodies[1].species = 1;
  Checkpoint checkpoint = with_a_run(checkpoint_of(small));
  checkpoint.system = small;
  checkpoint.run->simulation.bytes().resize(100);
  const std::string good = hardbody::encode_checkpoint(checkpoint);
  for (std::size_t length = 0; length < good.size(); ++length) {
    EXPECT_THROW(hardbody::decode_checkpoint(good.substr(0, length), "memory"), hardbody::InputError) << length;
  }
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::string bad = good;
    bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << (bit % 8)));
    EXPECT_THROW(hardbody::decode_checkpoint(bad, "memory"), hardbody::InputError) << bit;
  }
}

/// Message and status of `hardbody resume` on a run that has not finished, with this checkpoint.
struct Refusal {
  int status;
  std::string message;
  bool untouched;
};

Refusal resume(const std::string& checkpoint) {
  const fs::path directory = fs::path(testing::TempDir()) / ("hardbody_resume_" + std::to_string(::getpid()));
  fs::create_directories(directory);
  hardbody::write_file(directory / "config.toml", kConfig);
  hardbody::write_file(directory / "checkpoint.bin", checkpoint);
  const fs::path output = directory.string() + ".txt";
  const std::string command =
      std::string(HARDBODY_PROGRAM) + " resume " + directory.string() + " 2> " + output.string();
  const int status = std::system(command.c_str());
  const auto names = std::distance(fs::directory_iterator(directory), fs::directory_iterator());
  const bool same = hardbody::read_file(directory / "checkpoint.bin", checkpoint.size()) == checkpoint;
  Refusal refusal{WEXITSTATUS(status), hardbody::read_file(output, 1 << 16), names == 2 && same};
  fs::remove_all(directory);
  fs::remove(output);
  return refusal;
}

void expect_refused(const Checkpoint& checkpoint, const std::string& why) {
  const Refusal refusal = resume(hardbody::encode_checkpoint(checkpoint));
  EXPECT_EQ(refusal.status, 2) << refusal.message;
  EXPECT_THAT(refusal.message, testing::HasSubstr(why));
  EXPECT_THAT(refusal.message, testing::HasSubstr("checkpoint.bin: "));
  EXPECT_THAT(refusal.message, testing::HasSubstr("; accepted: "));
  EXPECT_EQ(std::count(refusal.message.begin(), refusal.message.end(), '\n'), 1) << refusal.message;
  EXPECT_TRUE(refusal.untouched) << why;
}

/// Of this program on this processor.
Checkpoint own(Checkpoint checkpoint) {
  checkpoint.program_version = hardbody::version();
  checkpoint.arch = hardbody::build_arch();
  checkpoint.cpu_features = hardbody::cpu_feature_text();
  return checkpoint;
}

TEST(Resume, ForeignCheckpointsAreRefused) {
  const Checkpoint good = own(with_a_run(checkpoint_of(dilute_state())));
  Checkpoint other = good;
  other.program_version = "99.0.0";
  expect_refused(other, "was made by hardbody 99.0.0, here ");
  other = good;
  other.cpu_features = "neon";
  expect_refused(other, "was made on a processor with neon, here ");
  other = good;
  other.arch = "-march=z80";
  expect_refused(other, "was made by a program built with -march=z80, here ");
  other = good;
  other.run.reset();
  expect_refused(other, "is of an older format that holds no running state");
}

TEST(Resume, StatesThatDoNotFitAreRefused) {
  const Checkpoint good = own(with_a_run(checkpoint_of(dilute_state())));
  expect_refused(good, "holds an impossible state (state: has format");  // its observables
  Checkpoint other = good;
  other.phase = "equilibration";
  other.system.species[0].mass = 3;
  expect_refused(other, "holds an impossible state (state: is one of other species)");
  other = good;
  other.phase = "equilibration";
  other.system.bodies[3].velocity.x() += 1e-9;
  expect_refused(other, "holds an impossible state (state: two that should be the same differ)");
  other = good;
  other.phase = "somewhere";
  expect_refused(other, "holds an impossible state");
  other = good;
  other.run->simulation.bytes().resize(other.run->simulation.size() - 1);
  expect_refused(other, "holds an impossible state (state: is cut off)");
}

TEST(Resume, TheOldFormatIsRefused) {
  Checkpoint old = hardbody::read_checkpoint(HARDBODY_OLD_CHECKPOINT);
  EXPECT_FALSE(old.run.has_value());
  old.config = kConfig;
  expect_refused(own(old), "is of an older format that holds no running state");
}

TEST(Check, SoundStatePasses) {
  EXPECT_EQ(check_status(checkpoint_of(dilute_state())), 0);
}

TEST(Check, SoundMixturePasses) {
  EXPECT_EQ(check_status(checkpoint_of(mixed_state(), kMixture)), 0);
}

TEST(Check, BodiesOfAnotherShapeMassOrInertiaAreFound) {
  const ed::System sound = mixed_state();
  ed::System state = sound;
  std::swap(state.bodies[0].species, state.bodies[20].species);
  EXPECT_EQ(check_status(checkpoint_of(state, kMixture)), 1);
  state = sound;
  state.species[2].shape = geom::Superellipsoid(ed::half_extents(state.species[2].shape), 0.5, 1.25);
  EXPECT_EQ(check_status(checkpoint_of(state, kMixture)), 1);
  state = sound;
  state.species[1].mass *= 2;
  EXPECT_EQ(check_status(checkpoint_of(state, kMixture)), 1);
  // A little: the energy still passes.
  state = sound;
  state.species[1].inertia *= 1 + 1e-11;
  EXPECT_EQ(check_status(checkpoint_of(state, kMixture)), 1);
}

TEST(Check, OverlapIsFound) {
  ed::System state = dilute_state();
  // A fifth of the sum of the smallest semi-axes deep, side by side; the rest of the gas is far away on average.
  state.bodies[1] = state.bodies[0];
  state.bodies[1].position += 1.8 * ed::inscribed_radius(state.species[0].shape) * state.bodies[0].rotation.col(0);
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

/// The pair as written to a file, read, and written again.
hardbody::Failure through_a_file(const hardbody::Failure& failure) {
  const fs::path path = fs::path(testing::TempDir()) / ("hardbody_pair_" + std::to_string(::getpid()) + ".json");
  const std::string text = hardbody::failure_json(failure);
  hardbody::write_file(path, text);
  hardbody::Failure read = hardbody::read_failure(path);
  fs::remove(path);
  EXPECT_EQ(hardbody::failure_json(read), text);
  return read;
}

hardbody::Failure moving_pair(const ed::BodyShape& a, const ed::BodyShape& b) {
  ed::Random random(4);
  hardbody::Failure failure;
  failure.reason = "a \"reason\"";
  ed::FailedPair& pair = failure.pair;
  pair.shape_i = a;
  pair.shape_j = b;
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
  return failure;
}

TEST(FailureFile, ReadsBackTheSameBits) {
  const geom::Ellipsoid a({0.7, 0.7, 1.0 / 3});
  const geom::Ellipsoid b({1.1, 1.1, 2.0 / 7});
  ed::Random random(5);
  hardbody::Failure failure = moving_pair(a, b);
  ed::FailedPair& pair = failure.pair;
  pair.finder = ed::Finder::bracketing;
  pair.eps_d = 1.0 / 3e6;
  pair.distance = ed::FailedDistance{ed::DistanceMethod::newton5,
                                     geom::DistanceStatus::singular,
                                     a,
                                     b,
                                     geom::Pose(random.rotation(), random.normal3()),
                                     geom::Pose(random.rotation(), random.normal3()),
                                     {random.normal3(), random.normal3(), geom::SeedStatus::usable}};
  const hardbody::Failure file = through_a_file(failure);
  const ed::FailedPair& read = file.pair;
  EXPECT_EQ(read.motion_j.velocity, pair.motion_j.velocity);
  EXPECT_EQ(read.motion_i.pose.position(), pair.motion_i.pose.position());
  EXPECT_EQ(file.reason, failure.reason);
  ASSERT_TRUE(read.distance.has_value());
  EXPECT_EQ(read.distance->X_WB.rotation(), pair.distance->X_WB.rotation());
  EXPECT_EQ(read.distance->seed.point_a, pair.distance->seed.point_a);
}

TEST(FailureFile, HoldsEveryShape) {
  const geom::Superellipsoid brick({1, 0.7, 1.0 / 3}, 0.3, 1.0 / 3);
  const hardbody::Failure failure = moving_pair(brick, geom::Ellipsoid({1, 2, 3}));
  const hardbody::Failure file = through_a_file(failure);
  const auto& read = std::get<geom::Superellipsoid>(file.pair.shape_i);
  EXPECT_EQ(read.semi_axes(), brick.semi_axes());
  EXPECT_EQ(read.e2(), brick.e2());
  EXPECT_EQ(std::get<geom::Ellipsoid>(file.pair.shape_j).semi_axes(), Vector3d(1, 2, 3));
}

/// Every bit of them.
void expect_same_bodies(const std::vector<ed::Component>& a, const std::vector<ed::Component>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].number, b[k].number);
    EXPECT_EQ(ed::half_extents(a[k].species.shape), ed::half_extents(b[k].species.shape));
    EXPECT_EQ(ed::describe(a[k].species.shape), ed::describe(b[k].species.shape));
    EXPECT_EQ(a[k].species.mass, b[k].species.mass);
    EXPECT_EQ(a[k].species.inertia, b[k].species.inertia);
    EXPECT_EQ(a[k].species.spins, b[k].species.spins);
  }
}

TEST(Config, ResolvedTextReadsBackAsTheSameConfig) {
  const std::string texts[] = {
      kConfig,
      "seed = 9007199254740993\n[system]\npacking_fraction = 0.1\n[shape]\nsemi_axes = [0.1, 0.7, 0.1]\n"
      "[dynamics]\ninertia = [0.3, 0.1, 0.3]\neps_d = 1e-9\n[equilibration]\ntime = 0.1\n[production]\n"
      "time = 1e6\n[output]\nevents = 3\ncheckpoint_every = \"1.5h\"\n",
      "[system]\npacking_fraction = 0.123456789012345678\n[shape]\naspect_ratio = 0.333333333333333333\n"
      "[dynamics]\ninertia = \"uniform\"\n",
      "[system]\npacking_fraction = 0.1\n[shape]\nsemi_axes = [1, 0.7, 2.1]\n[dynamics]\ninertia = [1, 2, 2.5]\n",
      "[system]\npacking_fraction = 0.1\n[shape]\nkind = \"superellipsoid\"\nsemi_axes = [1, 1.1, 0.3]\n"
      "exponents = [0.25, 1.6]\n",
      "[system]\npacking_fraction = 0.1\n[shape]\nkind = \"superellipsoid\"\naspect_ratio = 1.7\n"
      "exponents = [0.3333333333333333, 1]\n",
      "[system]\nnumber = 301\npacking_fraction = 0.1\n[[species]]\nsemi_axes = [0.3, 0.3, 0.9]\nfraction = 0.7\n"
      "[[species]]\nkind = \"superellipsoid\"\nexponents = [0.5, 0.5]\nsemi_axes = [0.5, 0.4, 0.45]\n"
      "fraction = 0.3\nmass = 2.5\ninertia = [0.1, 0.11, 0.12]\nsizes = \"lognormal\"\nwidth = 0.123\n",
      "[system]\npacking_fraction = 0.1\n[[species]]\naspect_ratio = 1\nnumber = 100\nsizes = \"uniform\"\n"
      "width = 0.2\nsize_seed = 17\n[[species]]\nsemi_axes = [1, 2, 1]\nnumber = 33\ninertia = \"uniform\"\n",
      "[system]\npacking_fraction = 0.1\nstart = \"fcc\"\n[shape]\naspect_ratio = 2\n",
      "[system]\npacking_fraction = 0.1\nstart = \"cubic\"\nnematic_order = 0.7\n[shape]\naspect_ratio = 2\n"};
  for (const std::string& text : texts) {
    const hardbody::Config config = hardbody::parse_config(text, "memory");
    const std::string resolved = hardbody::resolved_text(config);
    const hardbody::Config again = hardbody::parse_config(resolved, "resolved");
    EXPECT_EQ(hardbody::resolved_text(again), resolved);
    EXPECT_EQ(again.seed, config.seed);
    EXPECT_EQ(again.start, config.start);
    EXPECT_EQ(again.nematic_order, config.nematic_order);
    EXPECT_EQ(again.packing_fraction, config.packing_fraction);
    expect_same_bodies(again.components(), config.components());
    EXPECT_EQ(again.equilibration_time, config.equilibration_time);
    EXPECT_EQ(again.production_time, config.production_time);
  }
}

TEST(Config, PermutesAxesAndMomentsTogether) {
  const hardbody::Config config = hardbody::parse_config(
      "[system]\npacking_fraction = 0.1\n[shape]\nsemi_axes = [4, 2, 2]\n[dynamics]\ninertia = [0.5, 1.5, 1.5]\n",
      "memory");
  const Vector3d axes = std::get<geom::Ellipsoid>(config.species[0].body.shape).semi_axes();
  EXPECT_DOUBLE_EQ(axes.x(), std::cbrt(0.5));
  EXPECT_EQ(axes.x(), axes.y());
  EXPECT_DOUBLE_EQ(axes.z(), 2 * std::cbrt(0.5));
  EXPECT_EQ(config.species[0].body.inertia, Vector3d(1.5, 1.5, 0.5));
  EXPECT_EQ(config.species[0].shape.true_aspect_ratio(), 2);
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
  spinning.species[0].spins = true;
  EXPECT_EQ(hardbody::conservation_defects(ed::kinetic_state(spinning), spinning).size(), 1U);
}

}  // namespace
