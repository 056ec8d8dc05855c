/// Checkpoints: written and read again, damaged, foreign, of states that no sound run ends in.

#include "base/errors.h"
#include "base/version.h"
#include "checkpoint_states.h"

#include <ed/simulation.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

namespace {

using cli_test::check_status;
using cli_test::checkpoint_of;
using cli_test::dilute_state;
using cli_test::kConfig;
using cli_test::kMixture;
using cli_test::mixed_state;
using Eigen::Vector3d;
using hardbody::Checkpoint;
namespace fs = std::filesystem;

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

/// Adds all that a run needs to resume; observables and monitor are placeholders that cannot be read.
Checkpoint with_a_run(Checkpoint checkpoint) {
  const ed::Simulation simulation(dilute_state(), hardbody::parse_config(kConfig, "memory").simulation_options());
  checkpoint.system = simulation.system();
  hardbody::RunState& run = checkpoint.run.emplace();
  run.simulation = simulation.save();
  run.observables = std::string("not read here");
  run.production.planned = 10;
  run.files.events = {3, 77};
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
  EXPECT_EQ(read.run->files.events.bytes, 77U);
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
  EXPECT_EQ(ed::describe(old.system.species.at(0).shape), "ellipsoid of semi-axes 0.793701 x 0.793701 x 1.5874");
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

Refusal resume(const std::string& checkpoint, const std::string& config = kConfig, const std::string& summary = "") {
  const fs::path directory = fs::path(testing::TempDir()) / ("hardbody_resume_" + std::to_string(::getpid()));
  fs::create_directories(directory);
  hardbody::write_file(directory / "config.toml", config);
  hardbody::write_file(directory / "checkpoint.bin", checkpoint);
  if (!summary.empty()) hardbody::write_file(directory / "summary.json", summary);
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

void expect_refused(const std::string& checkpoint, const std::string& why, const std::string& config = kConfig) {
  const Refusal refusal = resume(checkpoint, config);
  EXPECT_EQ(refusal.status, 2) << refusal.message;
  EXPECT_THAT(refusal.message, testing::HasSubstr(why));
  EXPECT_THAT(refusal.message, testing::HasSubstr("checkpoint.bin: "));
  EXPECT_THAT(refusal.message, testing::HasSubstr("; accepted: "));
  EXPECT_EQ(std::count(refusal.message.begin(), refusal.message.end(), '\n'), 1) << refusal.message;
  EXPECT_TRUE(refusal.untouched) << why;
}

void expect_refused(const Checkpoint& checkpoint, const std::string& why) {
  expect_refused(hardbody::encode_checkpoint(checkpoint), why);
}

/// Returns the bytes of the checkpoint in another format. What a checkpoint of an older format holds of the run is not
/// read.
std::string in_format(const Checkpoint& checkpoint, std::uint32_t format) {
  const std::string bytes = hardbody::encode_checkpoint(checkpoint);
  constexpr std::size_t kHead = 24;
  return hardbody::seal_checkpoint(std::string_view(bytes).substr(kHead, bytes.size() - kHead - 8), format);
}

/// Marks the checkpoint as one of this program on this processor.
Checkpoint own(Checkpoint checkpoint) {
  checkpoint.program_version = hardbody::version();
  checkpoint.arithmetic = hardbody::arithmetic();
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
  other.arithmetic = "-march=z80, arithmetic 1";
  expect_refused(other, "was made by a program with -march=z80, arithmetic 1, here ");
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

TEST(Resume, AnotherFormatsRunIsOfTheProgramThatWroteIt) {
  const Checkpoint good = own(with_a_run(checkpoint_of(dilute_state())));
  for (std::uint32_t format = 3; format < hardbody::kCheckpointFormat; ++format) {
    expect_refused(in_format(good, format), "was made by hardbody " + std::string(hardbody::version()) + " in format " +
                                                std::to_string(format) +
                                                ", from which only that program goes on, here ");
  }
  Checkpoint start = good;  // whose system alone would do, but not what its compression has counted
  start.phase = "start";
  start.run.reset();
  expect_refused(in_format(start, 7), "from which only that program goes on");
}

/// The config of another version may have keys that this one does not know: that is not what is wrong.
TEST(Resume, AnotherVersionIsNamedBeforeItsConfigIsJudged) {
  Checkpoint other = own(with_a_run(checkpoint_of(dilute_state())));
  other.program_version = "99.0.0";
  other.config += "[gravity]\ng = 9.81\n";
  expect_refused(hardbody::encode_checkpoint(other), "was made by hardbody 99.0.0, here ", other.config);
  expect_refused(in_format(other, 7), "was made by hardbody 99.0.0 in format 7", other.config);
  expect_refused(in_format(other, hardbody::kCheckpointFormat + 1), "has format version ", other.config);
}

/// Ends with status 0 whichever program could resume the run, and with 2 if it was interrupted.
TEST(Resume, AFinishedRunOfAnotherVersionIsFinished) {
  Checkpoint other = own(with_a_run(checkpoint_of(dilute_state())));
  other.program_version = "99.0.0";
  other.config += "[gravity]\ng = 9.81\n";
  for (const std::string& checkpoint :
       {hardbody::encode_checkpoint(other), in_format(other, 5), in_format(other, hardbody::kCheckpointFormat + 1)}) {
    EXPECT_EQ(resume(checkpoint, other.config, R"({"interrupted": false})").status, 0);
    EXPECT_EQ(resume(checkpoint, other.config, R"({"interrupted": true})").status, 2);
  }
}

}  // namespace
