/// events.csv: what is in it and in memory while it can be written, and while it cannot.

#include "run/files/events_file.h"
#include "config/config.h"
#include "io/run_directory.h"
#include "io/text_file.h"

#include <ed/simulation.h>
#include <ed/start.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>

#include <unistd.h>

namespace {

using hardbody::EventsFile;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr const char* kSpheresConfig =
    "[system]\nnumber = 64\npacking_fraction = 0.3\n[shape]\naspect_ratio = 1\n"
    "[equilibration]\ntime = 1\n[production]\ntime = 1\n";
constexpr std::uint64_t kPiece = std::uint64_t{1} << 17;  ///< number of collisions that are appended at a time

class EventsFileTest : public testing::Test {
 protected:
  EventsFileTest() {
    fs::remove_all(path_);
    directory_.emplace(
        hardbody::RunDirectory::create(path_, hardbody::Overwrite::refused, {}, "# as good as any other\n"));
    const hardbody::Config config = hardbody::parse_config(kSpheresConfig, "memory");
    ed::StartOptions options;
    options.packing_fraction = config.packing_fraction;
    simulation_.emplace(ed::random_start(config.components(), options), config.simulation_options());
  }
  ~EventsFileTest() override {
    directory_.reset();
    fs::remove_all(path_);
  }

  std::string events() const { return hardbody::read_file(path_ / "events.csv", 1 << 28); }
  std::string log() const { return hardbody::read_file(path_ / "log.txt", 1 << 20); }
  std::uint64_t rows() const {
    const std::string text = events();
    return static_cast<std::uint64_t>(std::count(text.begin(), text.end(), '\n')) - 1;
  }

  fs::path path_ = fs::path(testing::TempDir()) / ("hardbody_events_" + std::to_string(::getpid()));
  std::optional<hardbody::RunDirectory> directory_;
  std::optional<ed::Simulation> simulation_;
};

TEST_F(EventsFileTest, GrowsInPieces) {
  hardbody::Log log(path_ / "log.txt", hardbody::Log::Begin::afresh);
  EventsFile file(*directory_, 3 * kPiece);
  file.open({}, *simulation_);
  std::uint64_t most = 0;
  for (int k = 0; k < 40; ++k) {
    simulation_->run_collisions(10000);
    file.keep_up(*simulation_, log);
    most = std::max(most, std::uint64_t{simulation_->collisions().size()});
  }
  EXPECT_LE(most, kPiece);
  EXPECT_EQ(file.mark().rows, rows());
  file.take(*simulation_);
  EXPECT_EQ(rows(), 3 * kPiece);
  // The same as all at once.
  const std::string pieces = events();
  ed::StartOptions options;
  options.packing_fraction = 0.3;
  const hardbody::Config config = hardbody::parse_config(kSpheresConfig, "memory");
  ed::Simulation again(ed::random_start(config.components(), options), config.simulation_options());
  EventsFile whole(*directory_, 3 * kPiece);
  whole.open({}, again);
  again.run_collisions(400000);
  whole.take(again);
  EXPECT_TRUE(events() == pieces);
}

TEST_F(EventsFileTest, WaitsForADiskThatTakesNothingButNotForEver) {
  hardbody::Log log(path_ / "log.txt", hardbody::Log::Begin::afresh);
  EventsFile file(*directory_, 100 * kPiece, 3 * kPiece);
  file.open({}, *simulation_);
  const std::string header = events();
  // A directory cannot be written, not even by root.
  fs::rename(path_ / "events.csv", path_ / "aside");
  fs::create_directory(path_ / "events.csv");
  simulation_->run_collisions(kPiece);
  file.keep_up(*simulation_, log);
  simulation_->run_collisions(kPiece);
  file.keep_up(*simulation_, log);
  EXPECT_EQ(simulation_->collisions().size(), 2 * kPiece);
  EXPECT_EQ(file.mark().rows, 0U);
  EXPECT_THAT(this->log(), HasSubstr("collisions wait in memory"));
  EXPECT_THROW(file.take(*simulation_), hardbody::WriteError);
  // It is back.
  fs::remove(path_ / "events.csv");
  fs::rename(path_ / "aside", path_ / "events.csv");
  simulation_->run_collisions(kPiece);
  file.keep_up(*simulation_, log);
  EXPECT_TRUE(simulation_->collisions().empty());
  EXPECT_EQ(rows(), 3 * kPiece);
  EXPECT_THAT(this->log(), HasSubstr("events.csv: written again"));
  // And gone, for too long.
  fs::rename(path_ / "events.csv", path_ / "aside");
  fs::create_directory(path_ / "events.csv");
  for (int k = 0; k < 3; ++k) {
    simulation_->run_collisions(kPiece);
    file.keep_up(*simulation_, log);
  }
  simulation_->run_collisions(kPiece);
  EXPECT_THROW(file.keep_up(*simulation_, log), hardbody::WriteError);
  EXPECT_EQ(hardbody::read_file(path_ / "aside", 1 << 28).substr(0, header.size()), header);
}

}  // namespace
