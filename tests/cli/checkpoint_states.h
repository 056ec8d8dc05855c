#pragma once

/// Checkpoints for tests: with a few bodies of one kind, and with a mixture.

#include "config/config.h"
#include "io/text_file.h"
#include "run/checkpoint.h"

#include <ed/start.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include <sys/wait.h>
#include <unistd.h>

namespace cli_test {

inline constexpr const char* kConfig = "[system]\nnumber = 64\npacking_fraction = 0.02\n[shape]\naspect_ratio = 2\n";

inline ed::System dilute_state() {
  ed::StartOptions options;
  options.packing_fraction = 0.02;
  return ed::random_start(hardbody::parse_config(kConfig, "memory").components(), options);
}

/// Config of a mixture with two different semi-axes, three, exponents, sizes, masses.
inline constexpr const char* kMixture =
    "[system]\npacking_fraction = 0.02\n"
    "[[species]]\nsemi_axes = [0.5, 0.5, 1.5]\nnumber = 20\n"
    "[[species]]\nsemi_axes = [0.5, 0.7, 1]\nnumber = 20\nmass = 3\n"
    "[[species]]\nkind = \"superellipsoid\"\nsemi_axes = [0.6, 0.7, 0.8]\nexponents = [0.5, 1.2]\nnumber = 24\n"
    "sizes = \"gaussian\"\nwidth = 0.1\n";

inline ed::System mixed_state() {
  ed::StartOptions options;
  options.packing_fraction = 0.02;
  return ed::random_start(hardbody::parse_config(kMixture, "memory").components(), options);
}

inline hardbody::Checkpoint checkpoint_of(const ed::System& system, const char* config = kConfig) {
  hardbody::Checkpoint checkpoint;
  checkpoint.program_version = "0.0.0";
  checkpoint.config = config;
  checkpoint.cpu_features = "fma";
  checkpoint.phase = "production";
  checkpoint.time = 0.1;
  checkpoint.system = system;
  return checkpoint;
}

/// Returns the exit status of `hardbody check` on a run directory with this checkpoint.
inline int check_status(const hardbody::Checkpoint& checkpoint) {
  const std::filesystem::path directory =
      std::filesystem::path(testing::TempDir()) / ("hardbody_check_" + std::to_string(::getpid()));
  std::filesystem::create_directories(directory);
  hardbody::write_file(directory / "checkpoint.bin", hardbody::encode_checkpoint(checkpoint));
  const std::string command = std::string(HARDBODY_PROGRAM) + " check " + directory.string() + " > /dev/null 2>&1";
  const int status = std::system(command.c_str());
  std::filesystem::remove_all(directory);
  return WEXITSTATUS(status);
}

}  // namespace cli_test
