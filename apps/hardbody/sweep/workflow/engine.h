#pragma once

/// Snakemake, which runs the workflow of a sweep.

#include "sweep/workers.h"

#include <filesystem>
#include <optional>
#include <string>

namespace hardbody {

/// Checks that Snakemake is installed, new enough, and for the profile slurm also Slurm's commands. Throws InputError
/// that says what to install.
void check_engine(const std::string& profile);

/// Process of Snakemake that runs the workflow of a sweep.
class Engine {
 public:
  /// Starts it. `jobs`: number of jobs at once; nullopt: that of the profile. Throws std::runtime_error.
  Engine(const std::filesystem::path& sweep_directory, const std::string& profile, const std::optional<int>& jobs);

  /// Returns its exit status once it has ended; waits for that at most `milliseconds`.
  std::optional<int> ended(int milliseconds);

  /// Stops it, its tasks on this machine, and jobs that it has submitted.
  void stop();

  /// Returns the number of attempts of tasks that have failed: what its log says.
  int failed_attempts() const;

  /// Returns the reason of its failure, in one line: what its log says.
  std::string failure() const;

 private:
  std::filesystem::path log_;
  Workers process_;
};

}  // namespace hardbody
